"""Habits that shapes don't show: one row of positions for all rays, depths among opacities, random numbers put into strata."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from . import _core
from .plan import Plan
from .rows import counted

# More than any fraction, however it was rounded.
CLEARLY = 1.05

# Answers are as good as equal within these parts of their largest number.
SAME = 1e-3
NEAR = 0.02


def tried(plan: Plan, entry: dict[str, Any], inputs: dict[str, np.ndarray]) -> Any:
    """What a function answers, or what it raises: that is told where it is asked again."""
    try:
        return plan.answer(entry, inputs)
    except KeyboardInterrupt:
        raise
    except BaseException as error:
        return error


def believable(plan: Plan, entry: dict[str, Any], inputs: dict[str, np.ndarray], answer: dict[str, Any]) -> list[str]:
    """The order of outputs without a depth among opacities: where fewer come than the contract has of a shape, one that stands
    where a fraction is due, and clearly is more; and anywhere, what is a length."""
    if plan.candidate.returns or not plan.order:
        return plan.order
    shapes = {p["name"]: tuple(p["shape"]) for p in entry["outputs"]}
    siblings = lambda name, names: [n for n in names if shapes.get(n) == shapes[name]]  # noqa: E731
    spare = [n for n in answer if n in plan.order and len(siblings(n, answer)) < len(siblings(n, shapes))]
    over = beyond_fractions(plan, inputs, answer) if spare else []
    order = ["_" if name in spare and name in over else name for name in plan.order]
    several = [n for n in answer if len(siblings(n, shapes)) > 1]
    lengths = doubled(plan, entry, inputs, {n: answer[n] for n in several})
    for group in dict.fromkeys(tuple(siblings(name, shapes)) for name in lengths):
        # What comes behind a length is as if it weren't there: an opacity behind a depth is the first fraction.
        rest = iter(group)
        order = [n if n not in group else "_" if n in lengths else next(rest) for n in order]
    return order


def beyond_fractions(plan: Plan, inputs: dict[str, np.ndarray], answer: dict[str, Any]) -> list[str]:
    """The outputs that clearly are more than the fractions that are due in their places."""
    truth = _core.oracle(plan.row["name"], "forward", {name: x.astype(np.float64) for name, x in inputs.items()}, None)

    def more(name: str) -> bool:
        given, true = answer[name][0], np.asarray(truth[name])
        due = np.all((true >= 0) & (true <= 1))
        return bool(due and np.all(np.isfinite(given)) and np.all(given >= 0) and np.max(given, initial=0) > CLEARLY)

    return [name for name in answer if name in truth and more(name)]


def doubled(plan: Plan, entry: dict[str, Any], inputs: dict[str, np.ndarray], answer: dict[str, Any]) -> list[str]:
    """The outputs that are lengths: twice as large where steps are twice as long and densities half as large; no fractions."""
    if not answer or not {"sigmas", "deltas"} <= inputs.keys():
        return []
    larger = tried(plan, entry, {**inputs, "sigmas": inputs["sigmas"] / 2, "deltas": inputs["deltas"] * 2})
    if not isinstance(larger, dict):
        return []
    sized = [n for n, (x, _) in answer.items() if n in larger and np.any(x) and np.all(np.isfinite(x))]
    return [n for n in sized if alike(2 * answer[n][0], larger[n][0], SAME)]


def with_habits(plan: Plan, entry: dict[str, Any], inputs: dict[str, np.ndarray], cases: list[Any]) -> Plan:
    """The plan, with what the function does by habit: by a telling case, or where few cases show it by any."""
    plan = sharing(plan, entry, inputs)
    strata = plan.draws and not plan.row["statistics"] and any(puts_into_strata(plan, *case) for case in cases)
    return replace(plan, strata=True) if strata else plan


def sharing(plan: Plan, entry: dict[str, Any], inputs: dict[str, np.ndarray]) -> Plan:
    """The plan, or where a row of positions for each ray mixes the rays, and one row for all of them doesn't, one that says so:
    `t[1:] - t[:-1]` is right for positions of (N,) alone, and goes through with (R, N)."""
    steps = "t" if "t" in inputs else "deltas"
    items = [name for name in inputs if counted(plan.row, name)]
    if not (plan.match.takes("t") and steps in items and len(items) > 1) or not mixes(plan, entry, inputs):
        return plan
    shared = replace(plan, alone=(steps,), twice=False, order=[], settled=False)
    answer = tried(shared, entry, inputs)
    if not isinstance(answer, dict):
        return plan
    # What it returns shows itself where it is asked as it should be.
    shared.order, shared.settled = believable(shared, entry, inputs, answer), True
    return plan if mixes(shared, entry, inputs) else shared


def mixes(plan: Plan, entry: dict[str, Any], inputs: dict[str, np.ndarray]) -> bool:
    """Whether the answers to some rays are others when these come in the reverse order."""
    turned = {name: x[::-1].copy() if counted(plan.row, name) else x for name, x in inputs.items()}
    forth, back = tried(plan, entry, inputs), tried(plan, entry, turned)
    if not isinstance(forth, dict) or not isinstance(back, dict):
        return True
    names = [name for name in forth if counted(plan.row, name, "outputs")]
    return not all(alike(forth[name][0][::-1], back[name][0], SAME) for name in names)


def alike(a: np.ndarray, b: np.ndarray, part: float) -> bool:
    """Whether numbers differ by no more than a part of the largest."""
    size = np.max(np.abs(b[np.isfinite(b)]), initial=0.0)
    return a.shape == b.shape and bool(np.allclose(a, b, rtol=0, atol=part * size, equal_nan=True))


def puts_into_strata(plan: Plan, entry: dict[str, Any], inputs: dict[str, np.ndarray]) -> bool:
    """Whether a function makes (i + r) / N of the numbers r that it draws, where the row's u come as they are."""
    if not inputs["u"].size:
        return False
    shape = inputs["u"].shape

    def of(u: Any) -> dict[str, np.ndarray]:
        return {**inputs, "u": np.broadcast_to(u, shape).astype(inputs["u"].dtype)}

    def right(u: Any) -> dict[str, Any]:
        return _core.oracle(plan.row["name"], "forward", {name: x.astype(np.float64) for name, x in of(u).items()}, None)

    # Rows that have strata of their own spread equal numbers out.
    if not all(np.ptp(x, axis=-1).max() == 0 for x in map(np.asarray, right(0.5).values()) if x.shape == shape):
        return False

    def answers(drawn: float, meant: np.ndarray) -> bool:
        given, truth = tried(plan, entry, of(drawn)), right(meant)
        return isinstance(given, dict) and all(alike(given[name][0], np.asarray(truth[name]), NEAR) for name in given)

    strata = lambda r: (np.arange(shape[-1]) + r) / shape[-1]  # noqa: E731
    return answers(0.0, strata(0.0)) and answers(0.5, strata(0.5)) and not answers(0.5, np.array(0.5))
