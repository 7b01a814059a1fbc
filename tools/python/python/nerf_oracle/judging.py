"""The judge, in process: functions are asked the hard cases and may be off by what honest arithmetic in their type can cost."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any, Callable

from . import _core
from .adapted import adapt
from .arrays import answered, type_of
from .asked import Asked
from .errors import CandidateError
from .probing import planned
from .report import Report
from .returned import by_output, fitting
from .rows import DTYPES, checked, checked_profile, fits, port_of, row_of
from .truth import bound_inputs

VERDICTS = ("imprecise", "edge", "unproved")
TIERS = ("small", "large")


def judge(
    *,
    dtype: str = "f32",
    profile: str | None = None,
    framework: str | None = None,
    device: str | None = None,
    gradients: bool = True,
    again: bool = True,
    tier: str = "small",
    allow: Sequence[str] = (),
    **functions: Callable[..., Any],
) -> Report:
    """Judges functions by the rows of the contract that they are for.

        report = nerf_oracle.judge(volume_render=my_volrend)
        print(report)
        report["volume_render"].diagnosis[0].name        # 'inclusive_transmittance'

    A function's parameters are found by their names, or by what people call them (`adapt` says the rest); it returns an array,
    a tuple in the contract's order, or a dict. Gradients of torch's and jax's functions are judged too, by autograd; one of
    your own goes in as `volume_render_vjp=f`, which takes the inputs and `grad_<output>` and returns `grad_<input>`.

    Args:
        dtype: what it computes in, "f64", "f32", "tf32", "bf16" or "f16": arrays come in it, and it decides what is allowed.
        profile: pins conventions ("cs180", "nerf2020", ...), so that deviating fails; otherwise those that are followed are
            found.
        framework: "numpy", "torch", "jax" or "cupy"; otherwise found by the function's code and by trying.
        device: where torch's and jax's arrays lie.
        gradients: whether gradients are judged.
        again: whether each question is asked four times, so that answers that depend on chance or on the question before show.
        tier: "small", or "large": cases of real sizes, 100,003 rays and more, for what shows there alone; each is asked twice.
        allow: verdicts that count as passes: "imprecise", "unproved", and "edge", right but for cases that few programs ever
            meet (no samples, an infinite density).
    """
    checked("dtype", dtype, DTYPES)
    checked("tier", tier, TIERS)
    for verdict in allow:
        checked("allow", verdict, VERDICTS)
    if not functions:
        raise CandidateError("judge: no function. Name one by its row: judge(volume_render=my_volrend)")
    adapted = {name: adapt(function, framework=framework, device=device) for name, function in functions.items()}
    asked = Asked(adapted, dtype, checked_profile(profile), gradients)
    return asked.judged_large(allow) if tier == "large" else asked.judged(again, allow)


def assert_pass(**settings_and_functions: Any) -> None:
    """Raises AssertionError with the whole report unless everything passes. Takes what `judge` takes."""
    __tracebackhide__ = True
    report = judge(**settings_and_functions)
    if not report.passed:
        raise AssertionError(f"nerf-oracle\n{report}")


def check_close(
    mine: Any,
    row: str,
    *,
    dtype: str | None = None,
    profile: str | None = None,
    direction: str | None = None,
    **inputs: Any,
) -> Report:
    """A verdict on your own data: whether `mine` is as near to the reference as honest arithmetic in its type allows.

        report = nerf_oracle.check_close((colors, weights), "volume_render", sigmas=sigmas, rgbs=rgbs, deltas=deltas)
        assert report, report

    Args:
        mine: what your code gave: an array, a tuple in the contract's order, a dict by output; or a function, which is called.
        row: the row of the contract.
        dtype: what it was computed in; by itself that of the inputs.
        profile: pins conventions; otherwise those that are followed are found.
        direction: "vjp" for gradients, where the inputs have `grad_<output>` too.
        inputs: the arrays of the row, as your code got them.
    """
    contract = row_of(row)
    direction = checked("direction", direction or contract["kind"], [contract["kind"], "vjp"])
    if contract["statistics"]:
        raise CandidateError(f"{row}: it is judged by the statistics of many draws: judge({row}=f)")
    types = {type_of(x) for name, x in inputs.items() if port_of(contract, name)} - {None}
    dtype = checked("dtype", dtype or next((name for name in ("bf16", "f16", "f32") if name in types), "f64"), DTYPES)
    arrays = bound_inputs(contract, (), inputs, direction)
    fits(contract, arrays)
    exam = _core.Exam.on(row, direction, arrays, dtype, checked_profile(profile))
    (entry,) = json.loads(exam.manifest())["cases"]
    if callable(mine):
        plan = planned(adapt(mine), contract, [(entry, arrays)], dtype, own=direction == "vjp")
        answer = plan.answer(entry, arrays)
    else:
        outputs = [port["name"] for port in entry["outputs"]]
        found = by_output(mine, outputs, fitting(mine, entry["outputs"]), f"{row}: what you handed over")
        answer = {name: answered(x, name) for name, x in found.items()}
    return Report(*exam.judge(lambda *_: answer, {}, False, ["unproved"]), [])
