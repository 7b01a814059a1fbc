"""Functions on their way through an exam."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from . import _core
from .adapted import Adapted
from .errors import CandidateError, hint
from .plan import Plan, crash
from .probing import askable, planned
from .report import Report
from .rows import resized, row_of, rows

# On so many of the smallest cases a function may have no gradient before it is said to have none.
TRIES = 8


class Asked:
    """An exam: a plan for each row and direction, then its questions."""

    def __init__(self, functions: dict[str, Adapted], dtype: str, profile: str | None, gradients: bool) -> None:
        self.plans: dict[str, Plan] = {}
        self.returns: dict[str, list[str]] = {}
        self.reshapes: dict[str, bool] = {}
        self.notes: list[str] = []
        directions = [pair for name in functions for pair in self.directions(name, functions, gradients)]
        everything = _core.Exam([(row, kind) for row, kind, _ in directions], dtype, profile)
        self.entries = {(f"{e['component']}/{e['kind']}", e["id"]): e for e in json.loads(everything.manifest())["cases"]}
        self.everything, self.dtype, self.profile = everything, dtype, profile
        for name, kind, function in directions:
            self.plan(name, kind, functions[function])
        kept = [(row, kind) for row, kind, _ in directions if f"{row}/{kind}" in self.plans]
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
        forward = self.plans.get(f"{name}/{row['kind']}")
        if kind == "vjp" and forward is not None and forward.candidate is candidate:
            reason = self.undifferentiable(forward, key)
            if reason is None:
                self.plans[key] = forward
            else:
                self.notes.append(f"{name}: its gradient isn't judged: {reason}; one of your own goes in as {name}_vjp=...")
        else:
            plan = planned(candidate, row, self.cases(key), self.dtype, own=kind == "vjp")
            self.plans[key] = plan
            self.notes.append(f"{name} {kind}: {plan.function} was asked with arrays of {plan.framework.name}{told(plan)}")

    def undifferentiable(self, plan: Plan, key: str) -> str | None:
        """Why a function's gradient can't be judged; None where it can."""
        if plan.framework.name not in ("torch", "jax"):
            return f"{plan.framework.name} has no gradients"
        outputs, tried = outputs_of(plan.row), None
        cases = [case for case in askable(self.cases(key), plan.match) if all(x.size for x in case[1].values())]
        for entry, inputs in sorted(cases, key=lambda case: sum(x.size for x in case[1].values()))[:TRIES]:
            try:
                # Its outputs may have other shapes than the exam's.
                _, self.returns[key], smooth = plan.gradient(entry, inputs, outputs, probing=True)
            except KeyboardInterrupt:
                raise
            except BaseException as error:
                tried = tried or f"{type(error).__name__}: {(str(error).strip() or '-').splitlines()[0][:120]}"
                continue
            if smooth:
                self.reshapes[key] = not self.fits(plan, entry, inputs, outputs)
                return None
            tried = "the result isn't differentiable"
        return tried

    def fits(self, plan: Plan, entry: dict[str, Any], inputs: dict[str, np.ndarray], outputs: list[str]) -> bool:
        """Whether the exam's own cotangents have the shapes of what it returns."""
        try:
            plan.gradient(entry, inputs, outputs)
        except Exception:
            return False
        return True

    def ask(self, key: str, case: str, inputs: dict[str, np.ndarray], strided: bool) -> Any:
        """Answers a question, the whole case or a tile of it; a text where the function crashed. What the user interrupts ends the
        exam. `strided`: with arrays that have gaps between their elements, where the framework has such."""
        plan = self.plans[key]
        if strided and not plan.framework.gaps:
            return None
        entry = resized(plan.row, self.entries[key, case], inputs)
        try:
            if key in self.returns:
                return plan.gradient(entry, inputs, outputs_of(plan.row), strided)[0]
            return plan.answer(entry, inputs, strided)
        except KeyboardInterrupt:
            raise
        except BaseException as error:
            return crash(error, plan)

    def judged(self, again: bool, allow: Sequence[str]) -> Report:
        """The verdicts."""
        if not self.plans:
            raise CandidateError(f"nothing can be judged. {' '.join(self.notes)}")
        return Report(*self.exam.judge(self.ask, self.declared(self.plans), again, list(allow)), self.notes)

    def judged_large(self, allow: Sequence[str]) -> Report:
        """The verdicts on cases of real sizes, by the plans that the small ones showed."""
        # Large cases have the shapes of the contract's conventions alone.
        rows = [(key.rpartition("/")[0], key.rpartition("/")[2]) for key in self.plans if not self.reshapes.get(key)]
        large = _core.LargeExam(rows, self.dtype, self.profile)
        entries = {(f"{e['component']}/{e['kind']}", e["id"]): e for e in json.loads(large.manifest())["cases"]}
        self.entries.update(entries)
        return Report(*large.judge(self.ask, self.declared({key for key, _ in entries}), list(allow)), self.notes)

    def declared(self, keys: Iterable[str]) -> dict[str, tuple[list[str] | None, list[str] | None]]:
        """What the functions of some rows take, and what their gradients go through."""
        return {key: (self.plans[key].takes(), self.returns.get(key, self.plans[key].through())) for key in keys}


def outputs_of(row: dict[str, Any]) -> list[str]:
    """The forward outputs of a row."""
    return [port["name"] for port in row["outputs"]]


def told(plan: Plan) -> str:
    """What isn't as the contract has it, in words."""
    said = [f"{p} as {name}" for p, name in (plan.match.names or {}).items() if p != name and name != "#N"]
    why = f", as otherwise it raises {plan.refused}" if plan.refused else ""
    said += [f"{' and '.join(plan.trailing)} with a last axis of one{why}"] if plan.trailing else []
    said += [f"one at a time{why}"] if plan.each else []
    said += ["in batches of one, as it has one number for all"] if plan.alone == () else []
    shared = ["t" if name == "deltas" else name for name in plan.alone or ()]
    said += [f"in batches that share {' and '.join(shared)}"] if shared else []
    said += ["one alone as two of the same, as it crashes on one"] if plan.twice else []
    said += ["its random numbers are dealt to it"] if plan.draws else []
    said += ["without the strata into which it puts them"] if plan.strata else []
    usual = plan.order == outputs_of(plan.row)[: len(plan.order)]
    said += [f"what it returns taken for {', '.join(plan.order)}"] if plan.settled and not usual else []
    ignored = plan.ignored()
    said += [f"and doesn't take {', '.join(ignored)}: where that matters its answers are off"] if ignored else []
    return "".join(f", {what}" for what in said)
