"""How a function is asked: in which framework, with which of its parameters as which array, in which shapes."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from .adapted import Adapted
from .arrays import answered
from .dealing import dealt
from .forms import in_other_forms
from .frameworks import Framework
from .names import Match, called
from .returned import by_output
from .rows import counted, covers, ordered, port_of

# What a gradient has no entries for: the contract's K is (fx, fy, cx, cy) alone, and its pose the upper three rows.
MASKS = {"grad_K": [[1, 0, 1], [0, 1, 1], [0, 0, 0]], "grad_c2w": [[1], [1], [1], [0]]}

Answer = dict[str, tuple[np.ndarray, str]]


@dataclass
class Plan:
    """A function of a row, and how it is called."""

    candidate: Adapted
    row: dict[str, Any]
    framework: Framework
    match: Match
    trailing: tuple[str, ...] = ()
    each: bool = False
    # Whether it can't take one ray or point alone, as after a `squeeze()`: it gets that one twice.
    twice: bool = False
    # What it was handed last, for messages.
    handed: dict[str, Any] = field(default_factory=dict)

    @property
    def function(self) -> str:
        """The function's name."""
        return called(self.candidate.function)

    @property
    def draws(self) -> bool:
        """Whether it draws the row's random numbers itself, so that they are dealt to it."""
        return port_of(self.row, "u") is not None and not self.match.all and not self.match.takes("u")

    def takes(self) -> list[str] | None:
        """The inputs that it takes, in the contract's form or another; None: all of them."""
        if self.match.all:
            return None
        taken = [name for name in (self.match.names or {}).values() if name != "#N"] + (["u"] if self.draws else [])
        ports = {port["name"] for port in self.row["inputs"] if any(covers(port, name) for name in taken)}
        return sorted({*ports, *(name for name in taken if port_of(self.row, name) is None)})

    def through(self) -> list[str] | None:
        """The outputs through which a gradient of one's own goes, where it takes not all of their cotangents."""
        asked = [f"grad_{port['name']}" for port in self.row["outputs"] if port["gradient"]]
        taken = [name[len("grad_") :] for name in asked if name in (self.takes() or asked)]
        return taken if 0 < len(taken) < len(asked) else None

    def ignored(self) -> list[str]:
        """The inputs that it neither takes nor, as the contract's forms have it, needn't."""
        taken = self.takes()
        if taken is None:
            return []
        forms = [form for form in self.row["forms"] if form["takes"] is None or form["takes"] in taken]
        known = {*taken, *(name for form in forms for name in form["without"])}
        return [port["name"] for port in self.row["inputs"] if port["name"] not in known]

    def answer(self, entry: dict[str, Any], inputs: dict[str, np.ndarray], strided: bool = False) -> Answer:
        """What it returns on a case, by output."""
        with self.framework.around():
            result = self.call(entry, self.arrays(entry, inputs, strided), [port["name"] for port in entry["outputs"]])
            return {name: answered(x, name) for name, x in result.items()}

    def gradient(
        self, entry: dict[str, Any], inputs: dict[str, np.ndarray], outputs: list[str], strided: bool = False
    ) -> tuple[Answer, list[str], bool]:
        """The gradients of a case by the framework's own differentiation; the outputs that they go through; whether there are
        any."""
        # What is taken in another form has no gradient in the contract's.
        gone = self.match.replaced(self.row)
        wanted = [name for name in (port["name"][len("grad_") :] for port in entry["outputs"]) if name not in gone]
        cotangents = {name[len("grad_") :]: x for name, x in inputs.items() if name.startswith("grad_")}
        with self.framework.around():
            forward = {name: x for name, x in inputs.items() if not name.startswith("grad_")}
            arrays = self.arrays(entry, forward, strided)
            leaves = {name: arrays[name] for name in wanted if hasattr(arrays[name], "reshape")}
            through = lambda x: self.call(entry, {**arrays, **x}, outputs)  # noqa: E731
            found, returned = self.framework.gradient(through, leaves, cotangents, strided)
            gradients = found or {name: np.zeros(inputs[name].shape, np.float64) for name in leaves}
            out = {f"grad_{name}": answered(x, name) for name, x in gradients.items()}
        masked = {name: (x * np.array(MASKS[name]) if name in MASKS else x, dtype) for name, (x, dtype) in out.items()}
        return masked, returned, found is not None

    def arrays(self, entry: dict[str, Any], inputs: dict[str, np.ndarray], strided: bool = False) -> dict[str, Any]:
        """Arrays in the framework, scalars as Python numbers."""
        stored = {port["name"]: port["dtype"] for port in entry["inputs"]}

        def given(name: str, x: np.ndarray) -> Any:
            if x.ndim:
                array = self.framework.array(x, stored[name])
                return self.framework.with_gaps(array) if strided else array
            return int(x) if stored[name] == "i64" else float(x)

        return {name: given(name, x) for name, x in inputs.items()}

    def call(self, entry: dict[str, Any], arrays: dict[str, Any], outputs: list[str]) -> dict[str, Any]:
        """Whole, or each ray or point alone."""
        items = [name for name in arrays if counted(self.row, name)]
        count = len(arrays[items[0]]) if items else 0
        if self.twice and count == 1:
            both = self.one(entry, {n: x[np.zeros(2, int)] if n in items else x for n, x in arrays.items()}, outputs)
            return {name: x[:1] if counted(self.row, name, "outputs") else x for name, x in both.items()}
        if not self.each:
            return self.one(entry, arrays, outputs)
        if count == 0:
            like = arrays[items[0]]
            return {port["name"]: self.framework.zeros(tuple(port["shape"]), like) for port in entry["outputs"]}
        answers = [self.one(entry, {n: x[i] if n in items else x for n, x in arrays.items()}, outputs) for i in range(count)]
        return {name: self.framework.stacked([answer[name] for answer in answers]) for name in answers[0]}

    def one(self, entry: dict[str, Any], arrays: dict[str, Any], outputs: list[str]) -> dict[str, Any]:
        """A call, and what it returns by output."""
        forms = {form["takes"] for form in entry["forms"] if form["holds"] and self.match.takes(form["takes"])}
        given = {**arrays, **in_other_forms(self.framework, arrays, forms)}
        given.update({name: given[name].reshape((*given[name].shape, 1)) for name in self.trailing})
        if "u" in given:
            given["#N"] = int(given["u"].shape[-1])
        self.handed = self.match.handed(given, ordered(self.row, arrays))
        first = list(self.handed) if self.match.names is None else self.match.positional
        rest = {name: x for name, x in self.handed.items() if name not in first}
        with dealt(arrays["u"]) if self.draws else contextlib.nullcontext():
            result = self.candidate.function(*(self.handed[name] for name in first), **rest)
        found = by_output(result, ports(entry, arrays, outputs), self.candidate.returns, f"{self.row['name']}: {self.function}")
        if "t" in forms and "weights" in found:
            found["weights"] = found["weights"][:, : arrays["deltas"].shape[-1]]
        return found


def ports(entry: dict[str, Any], arrays: dict[str, Any], outputs: list[str]) -> list[dict[str, Any]]:
    """Outputs with their shapes: the case's own, or those of the cotangents that a gradient is asked for."""
    known = {port["name"]: port["shape"] for port in entry["outputs"]}
    cotangents = {name: list(arrays[f"grad_{name}"].shape) for name in outputs if f"grad_{name}" in arrays}
    return [{"name": name, "shape": known.get(name) or cotangents.get(name, [])} for name in outputs]


def crash(error: BaseException, plan: Plan) -> str:
    """What a function raised, at which line of its own file, and what it was handed."""
    code, trace, where = getattr(plan.candidate.function, "__code__", None), error.__traceback__, ""
    while trace is not None:
        if code is not None and trace.tb_frame.f_code.co_filename == code.co_filename:
            where = f" (line {trace.tb_lineno})"
        trace = trace.tb_next
    said = (str(error).strip() or "no words").splitlines()[0][:200]
    shapes = [f"{name} {type(x).__name__}{tuple(x.shape) if hasattr(x, 'shape') else ''}" for name, x in plan.handed.items()]
    handed = f"; it was handed {', '.join(shapes[:8])}{', ...' if len(shapes) > 8 else ''}" if shapes else ""
    return f"{type(error).__name__}: {said}{where}{handed}"
