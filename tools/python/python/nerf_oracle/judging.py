"""The judge, in process: functions are asked the hard cases and may be off by what honest arithmetic in their type can cost."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any, Callable

import numpy as np

from . import _core
from .adapted import Adapted, adapt
from .arrays import answered, type_of
from .errors import CandidateError, hint
from .plan import Plan, crash
from .probing import askable, planned
from .report import Report
from .returned import by_output
from .rows import DTYPES, checked, checked_profile, fits, port_of, row_of, rows
from .truth import bound_inputs

VERDICTS = ("imprecise", "unproved")

# On so many of the smallest cases a function may have no gradient before it is said to have none.
TRIES = 8


def judge(
    *,
    dtype: str = "f32",
    profile: str | None = None,
    framework: str | None = None,
    device: str | None = None,
    gradients: bool = True,
    again: bool = True,
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
        allow: verdicts that count as passes: "imprecise", "unproved".
    """
    checked("dtype", dtype, DTYPES)
    for verdict in allow:
        checked("allow", verdict, VERDICTS)
    if not functions:
        raise CandidateError("judge: no function. Name one by its row: judge(volume_render=my_volrend)")
    own = {
        name: adapt(f, framework=framework, device=device) if framework or device else adapt(f) for name, f in functions.items()
    }
    asked = Asked(own, dtype, checked_profile(profile), gradients)
    return asked.judged(again, allow)


def assert_pass(**settings_and_functions: Any) -> None:
    """Raises AssertionError with the whole report unless everything passes. Takes what `judge` takes."""
    __tracebackhide__ = True
    report = judge(**settings_and_functions)
    if not report.passed:
        raise AssertionError(f"nerf-oracle\n{report}")


class Asked:
    """Functions on their way through an exam."""

    def __init__(self, functions: dict[str, Adapted], dtype: str, profile: str | None, gradients: bool) -> None:
        self.plans: dict[str, Plan] = {}
        self.returns: dict[str, list[str]] = {}
        self.notes: list[str] = []
        directions = [pair for name in functions for pair in self.directions(name, functions, gradients)]
        everything = _core.Exam([(row, kind) for row, kind, _ in directions], dtype, profile)
        self.entries = {(f"{e['component']}/{e['kind']}", e["id"]): e for e in json.loads(everything.manifest())["cases"]}
        self.everything, self.dtype, self.profile = everything, dtype, profile
        for name, kind, function in directions:
            self.plan(name, kind, functions[function])
        kept = [tuple(row.split("/")) for row in self.plans]
        self.exam = everything if len(kept) == len(directions) else _core.Exam(kept, dtype, profile)

    def directions(self, name: str, functions: dict[str, Adapted], gradients: bool) -> list[tuple[str, str, str]]:
        """(row, direction, which function answers it) of a keyword."""
        if name not in rows() and name.endswith("_vjp") and rows().get(name[:-4], {}).get("vjp"):
            return [(name[:-4], "vjp", name)]
        if name not in rows():
            raise CandidateError(f"{name}: no row of the contract, and no setting of judge; {hint(name, rows())}")
        row = rows()[name]
        forward = [(name, row["kind"], name)]
        return forward + [(name, "vjp", name)] * (row["vjp"] and gradients and f"{name}_vjp" not in functions)

    def cases(self, key: str) -> list[Any]:
        """A row's cases."""
        entries = [entry for (row, _), entry in self.entries.items() if row == key]
        return [(entry, self.everything.inputs(key, entry["id"])) for entry in entries]

    def plan(self, name: str, kind: str, candidate: Adapted) -> None:
        """Finds out how a function answers a row, if it can."""
        row, key = row_of(name), f"{name}/{kind}"
        by_autograd = (
            kind == "vjp" and f"{name}/{row['kind']}" in self.plans and self.plans[f"{name}/{row['kind']}"].candidate is candidate
        )
        if not by_autograd:
            self.plans[key] = planned(candidate, row, self.cases(key), self.dtype, own=kind == "vjp")
            self.told(self.plans[key], kind)
            return
        forward = self.plans[f"{name}/{row['kind']}"]
        reason = self.differentiable(forward, key)
        if reason is None:
            self.plans[key] = forward
        else:
            self.notes.append(f"{name}: its gradient isn't judged: {reason}; one of your own goes in as {name}_vjp=...")

    def told(self, plan: Plan, kind: str) -> None:
        """Notes what isn't as the contract has it."""
        said = [f"{p} as {name}" for p, name in (plan.match.names or {}).items() if p != name and name != "#N"]
        said += [f"{name} with a last axis of one" for name in plan.trailing]
        said += (
            ["one at a time"] * plan.each
            + ["one alone as two of the same, as it crashes on one"] * plan.twice
            + ["its random numbers are dealt to it"] * plan.draws
        )
        ignored = plan.ignored()
        said += [f"and doesn't take {', '.join(ignored)}: where that matters its answers are off"] if ignored else []
        told = "".join(f", {what}" for what in said)
        self.notes.append(f"{plan.row['name']} {kind}: {plan.function} was asked with arrays of {plan.framework.name}{told}")

    def differentiable(self, plan: Plan, key: str) -> str | None:
        """Why a function's gradient can't be judged; None where it can."""
        if plan.framework.name not in ("torch", "jax"):
            return f"{plan.framework.name} has no gradients"
        outputs, tried = self.outputs(plan.row), None
        cases = [case for case in askable(self.cases(key), plan.match) if all(x.size for x in case[1].values())]
        for entry, inputs in sorted(cases, key=lambda case: sum(x.size for x in case[1].values()))[:TRIES]:
            try:
                _, self.returns[key], smooth = plan.gradient(entry, inputs, outputs)
            except KeyboardInterrupt:
                raise
            except BaseException as error:
                tried = tried or f"{type(error).__name__}: {(str(error).strip() or '-').splitlines()[0][:120]}"
                continue
            if smooth:
                return None
            tried = "the result isn't differentiable"
        return tried

    def outputs(self, row: dict[str, Any]) -> list[str]:
        """The forward outputs of a row."""
        return [port["name"] for port in row["outputs"]]

    def ask(self, key: str, case: str, inputs: dict[str, np.ndarray]) -> Any:
        """Answers a question; a text where the function crashed. What the user interrupts ends the exam."""
        plan, entry = self.plans[key], self.entries[key, case]
        try:
            if key in self.returns:
                return plan.gradient(entry, inputs, self.outputs(plan.row))[0]
            return plan.answer(entry, inputs)
        except KeyboardInterrupt:
            raise
        except BaseException as error:
            return crash(error, plan)

    def judged(self, again: bool, allow: Sequence[str]) -> Report:
        """The verdicts."""
        if not self.plans:
            raise CandidateError(f"nothing can be judged. {' '.join(self.notes)}")
        declared = {key: (plan.takes(), self.returns.get(key)) for key, plan in self.plans.items()}
        return Report(*self.exam.judge(self.ask, declared, again, list(allow)), self.notes)


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
        answer, notes = plan.answer(entry, arrays), []
    else:
        found = by_output(mine, [port["name"] for port in entry["outputs"]], None, f"{row}: what you handed over")
        answer, notes = {name: answered(x, name) for name, x in found.items()}, []
    return Report(*exam.judge(lambda *_: answer, {}, False, ["unproved"]), notes)
