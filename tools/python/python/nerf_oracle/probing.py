"""Finding out how a function wants to be asked: what its signature doesn't say is tried on one case."""

from __future__ import annotations

import itertools
import sys
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from .adapted import Adapted
from .errors import CandidateError
from .frameworks import framework, likely
from .habits import believable, tried, with_habits
from .names import Match, matched
from .plan import Plan
from .rows import counted, letter, ordered, resized

# Which inputs get a last axis of one, whether it goes ray by ray, and what all rays of a batch share.
Layout = tuple[tuple[str, ...], bool, "tuple[str, ...] | None"]

Case = tuple[dict[str, Any], dict[str, np.ndarray]]


def planned(candidate: Adapted, row: dict[str, Any], cases: list[Case], dtype: str, own: bool) -> Plan:
    """The way to ask: the first in which the function returns an output of the right shape, else the first in which it returns
    anything, else the first. `cases` are (entry of cases.json, inputs); `own`: it is a gradient, which takes cotangents."""
    arrays = list(cases[0][1])
    names = ordered(row, [name for name in arrays if own or not name.startswith("grad_")])
    match = matched(candidate.function, row, names, candidate.names)
    entry, inputs = widened(row, *telling(cases, match))
    inputs = {name: x for name, x in inputs.items() if own or not name.startswith("grad_")}
    first, ran, said = None, None, None
    for place, trailing, each, alone in ways(candidate, row, match, entry, inputs, dtype):
        plan = Plan(candidate, row, place, match, trailing, each, alone=alone)
        first = first or plan
        answer = tried(plan, entry, inputs)
        if isinstance(answer, dict):
            plan.order = plan.order if own else believable(plan, entry, inputs, answer)
            answer = {name: x for name, x in answer.items() if name in plan.order or not plan.order}
            plan.settled = True
        if isinstance(answer, dict) and right_shapes(entry, answer):
            plan.refused = refusal(said) if each or trailing else ""
            return plan if own or each or alone is not None else with_habits(singly(plan, cases), entry, inputs, askable(cases, match))
        if isinstance(answer, dict) and not own and one_for_all(row, inputs, answer):
            return replace(plan, alone=())
        if isinstance(answer, dict):
            ran = ran or plan
        else:
            said = said or answer
    if first is None:
        raise CandidateError(f"{row['name']}: no framework to ask it in: name it, nerf_oracle.adapt(f, framework=...)")
    if ran is None and isinstance(said, CandidateError):
        raise said
    return ran or first


def refusal(error: BaseException | None) -> str:
    """What arrays as the contract has them raise, in short."""
    said = (str(error).strip().splitlines() or ["no words"])[0]
    return "" if error is None else f"{type(error).__name__}: {said[:100]}"


def singly(plan: Plan, cases: list[Case]) -> Plan:
    """The plan, or where a batch of one crashes and two of the same don't, one that says so."""
    for entry, inputs in askable(cases, plan.match):
        inputs = {name: x for name, x in inputs.items() if not name.startswith("grad_")}
        counts = {len(x) for name, x in inputs.items() if counted(plan.row, name)}
        if counts == {1} and all(x.size for x in inputs.values()):
            twice = replace(plan, twice=True)
            crashes = isinstance(tried(plan, entry, inputs), BaseException)
            return twice if crashes and isinstance(tried(twice, entry, inputs), dict) else plan
    return plan


def ways(candidate: Adapted, row: dict[str, Any], match: Match, entry: Any, inputs: Any, dtype: str) -> Iterator[Any]:
    """Frameworks, each with whole arrays first, then with a last axis of one, then ray by ray, then with one camera."""
    names = [candidate.framework] if candidate.framework else likely(candidate.function)
    places = [framework(name, dtype, candidate.device) for name in names if name == candidate.framework or name in sys.modules]
    shapes = list(layouts(candidate, row, match, inputs))
    for place in places:
        for shape in shapes:
            yield place, *shape


def layouts(candidate: Adapted, row: dict[str, Any], match: Match, inputs: Any) -> Iterator[Layout]:
    """The shapes in which arrays can be handed over."""
    scalars = [name for name in inputs if match.all or match.takes(name)]
    shape = {port["name"]: port["shape"] for port in row["inputs"]}
    scalars = [name for name in scalars if name in shape and counted(row, name) and shape[name].split(",")[-1].isupper()]
    if candidate.trailing is not None:
        subsets = [tuple(candidate.trailing)]
    else:
        every = range(len(scalars), 0, -1) if len(scalars) <= 3 else [len(scalars)]
        subsets = [(), *(s for n in every if n for s in itertools.combinations(scalars, n))]
    if candidate.each is not True:
        yield from ((trailing, False, None) for trailing in subsets)
    if candidate.each is not False and any(counted(row, name) for name in inputs):
        yield subsets[0], True, None
        cameras = tuple(name for name in shape if counted(row, name) and shape[name].endswith(",4,4"))
        yield from ((trailing, False, cameras) for trailing in subsets if cameras)


def telling(cases: list[Case], match: Match) -> Case:
    """A case whose axes have different lengths, none of them 0, 1 or 3, so that no wrong shape broadcasts by chance; of those
    that can be had in the function's form the smallest."""

    def badness(case: Case) -> tuple[int, int]:
        arrays = [x for x in case[1].values() if x.ndim]
        chance = sum(10 * sum(n in (0, 1) for n in x.shape) + (x.shape[0] == 3) + (len({*x.shape}) < x.ndim) for x in arrays)
        return chance, sum(x.size for x in arrays)

    return min(askable(cases, match), key=badness)


def askable(cases: list[Case], match: Match) -> list[Case]:
    """The cases that can be had in the function's form; all where none can, so that there is one to try."""
    return [case for case in cases if all(form["holds"] for form in case[0]["forms"] if match.takes(form["takes"]))] or cases


def widened(row: dict[str, Any], entry: dict[str, Any], inputs: dict[str, np.ndarray]) -> Case:
    """The case with so many rays or points, the same ones over again, as no other axis is long."""
    axes = [axis for port in (*row["inputs"], *row["outputs"]) for axis in port["shape"].split(",")]
    items = [name for name in inputs if counted(row, name)]
    if not items or any(letter(row) in axis and axis != letter(row) for axis in axes) or len(inputs[items[0]]) == 0:
        return entry, inputs
    others = {n for name, x in inputs.items() for n in (x.shape[1:] if name in items else x.shape)}
    count = next(n for n in (5, 7, 11, 13, 17, 19) if n not in others)
    again = np.arange(count) % len(inputs[items[0]])
    longer = {name: x[again] if name in items else x for name, x in inputs.items()}
    return resized(row, entry, longer), longer


def one_for_all(row: dict[str, Any], inputs: dict[str, np.ndarray], answer: dict[str, Any]) -> bool:
    """Whether one number came back, the sum or mean of all rays or points, where each has its own."""
    only = [port["shape"] for port in row["outputs"]] == [letter(row)]
    many = any(counted(row, name) and len(x) > 1 for name, x in inputs.items())
    return only and many and all(x.size == 1 for x, _ in answer.values())


def right_shapes(entry: dict[str, Any], answer: dict[str, Any]) -> bool:
    """Whether outputs have the shapes of the contract, or flat ones, axes of length one aside."""
    longer = lambda shape: [n for n in shape if n != 1]  # noqa: E731
    shapes = {port["name"]: port["shape"] for port in entry["outputs"]}
    fits = lambda x, shape: x.shape == tuple(shape) or longer(x.shape) == longer(shape) or x.size == np.prod(shape)  # noqa: E731
    return bool(answer) and all(fits(x, shapes[name]) for name, (x, _) in answer.items())
