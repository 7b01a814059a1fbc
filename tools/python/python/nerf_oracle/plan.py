"""How a function is asked: in which framework, with which of its parameters as which array, in which shapes."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from .adapted import Adapted
from .arrays import answered
from .dealing import dealt
from .errors import CandidateError
from .forms import in_other_forms
from .frameworks import Framework
from .names import Match, called
from .returned import by_output, fitting
from .rows import counted, covers, ordered, port_of

# What a gradient has no entries for: the contract's K is (fx, fy, cx, cy) alone, and its pose the upper three rows.
MASKS = {"grad_K": [[1, 0, 1], [0, 1, 1], [0, 0, 0]], "grad_c2w": [[1], [1], [1], [0]]}

# So many pixels share a camera: none of the lengths that broadcast by chance.
SHARING = 5

# How far a sum of all rays may be from that of their own numbers, in parts of these, by type.
COARSE = {"f64": 1e-9, "f32": 1e-4, "short": 0.02}

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
    # Where it gets batches of one: the inputs that come without their axis then, as the camera that all pixels share. None: elsewhere.
    alone: tuple[str, ...] | None = None
    # Whether it puts the random numbers that it draws into strata itself, where the row has none.
    strata: bool = False
    # What it raised when it was asked with whole arrays of the contract's shapes.
    refused: str = ""
    # The outputs in the order in which they come, and whether that is known: a case of few rays would show another.
    order: list[str] = field(default_factory=list)
    settled: bool = False
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
            arrays = self.arrays(entry, inputs, strided)
            result = self.call(entry, arrays)
            if self.alone == () and any(counted(self.row, name) and len(x) > 1 for name, x in inputs.items()):
                self.adds_up(result, self.one(entry, arrays))
            return {name: answered(x, name) for name, x in result.items()}

    def gradient(
        self,
        entry: dict[str, Any],
        inputs: dict[str, np.ndarray],
        outputs: list[str],
        strided: bool = False,
        probing: bool = False,
    ) -> tuple[Answer, list[str], bool]:
        """The gradients of a case by the framework's own differentiation; the outputs that they go through; whether there are
        any. `probing`: of the sum of all outputs, whatever the shapes of the case's cotangents."""
        # What is taken in another form has no gradient in the contract's.
        gone = self.match.replaced(self.row)
        wanted = [name for name in (port["name"][len("grad_") :] for port in entry["outputs"]) if name not in gone]
        cotangents = {name[len("grad_") :]: x for name, x in inputs.items() if name.startswith("grad_")}
        returned = [{"name": name, "shape": list(cotangents[name].shape)} for name in outputs if name in cotangents]
        asked = {**entry, "outputs": returned + [{"name": name, "shape": []} for name in outputs if name not in cotangents]}
        with self.framework.around():
            forward = {name: x for name, x in inputs.items() if not name.startswith("grad_")}
            arrays = self.arrays(entry, forward, strided)
            leaves = {name: arrays[name] for name in wanted if hasattr(arrays[name], "reshape")}
            through = lambda x: self.call(asked, {**arrays, **x})  # noqa: E731
            found, through_these = self.framework.gradient(through, leaves, {} if probing else cotangents, strided)
            gradients = found or {name: np.zeros(inputs[name].shape, np.float64) for name in leaves}
            out = {f"grad_{name}": answered(x, name) for name, x in gradients.items()}
        masked = {name: (x * np.array(MASKS[name]) if name in MASKS else x, dtype) for name, (x, dtype) in out.items()}
        return masked, through_these, found is not None

    def arrays(self, entry: dict[str, Any], inputs: dict[str, np.ndarray], strided: bool = False) -> dict[str, Any]:
        """Arrays in the framework, scalars as Python numbers."""
        stored = {port["name"]: port["dtype"] for port in entry["inputs"]}

        def given(name: str, x: np.ndarray) -> Any:
            if x.ndim:
                array = self.framework.array(x, stored[name])
                return self.framework.with_gaps(array) if strided else array
            return int(x) if stored[name] == "i64" else float(x)

        return {name: given(name, x) for name, x in inputs.items()}

    def call(self, entry: dict[str, Any], arrays: dict[str, Any]) -> dict[str, Any]:
        """Whole, or each ray or point alone."""
        items = [name for name in arrays if counted(self.row, name)]
        count = len(arrays[items[0]]) if items else 0
        if self.twice and count == 1 and not any(1 in arrays[name].shape[1:] for name in items):
            both = {n: x[np.zeros(2, int)] if n in items else x for n, x in arrays.items()}
            both = self.one(self.of(entry, [2]), both)
            return {name: x[:1] if counted(self.row, name, "outputs") else x for name, x in both.items()}
        if not self.each and self.alone is None:
            return self.shared(entry, self.one(entry, arrays), count)
        if count == 0:
            like = arrays[items[0]]
            return {port["name"]: self.framework.zeros(tuple(port["shape"]), like) for port in entry["outputs"]}
        answers = [self.single(entry, arrays, i, count) for i in range(count)]
        return {name: self.framework.stacked([answer[name] for answer in answers]) for name in answers[0]}

    def shared(self, entry: dict[str, Any], answer: dict[str, Any], count: int) -> dict[str, Any]:
        """What all rays or points share, an output without their axis, is the answer of each."""
        shapes = {port["name"]: list(port["shape"]) for port in entry["outputs"] if counted(self.row, port["name"], "outputs")}

        def bare(name: str, x: Any) -> bool:
            shape = shapes.get(name, [])
            return count > 1 and len(shape) > 1 and list(getattr(x, "shape", ())) == shape[1:]

        return {name: self.framework.stacked([x] * count) if bare(name, x) else x for name, x in answer.items()}

    def adds_up(self, found: dict[str, Any], whole: dict[str, Any]) -> None:
        """Whether one number for all rays is the sum or mean of theirs. What it is by itself can't be judged beyond that."""
        for name, x in whole.items():
            parts, number = answered(found[name], name)[0], float(answered(x, name)[0].reshape(()))
            within = COARSE.get(self.framework.dtype, max(COARSE.values())) * np.abs(parts).sum()
            near = lambda y: not np.isfinite(y) or abs(number - y) <= within  # noqa: E731
            if not (near(parts.sum()) or near(parts.mean())):
                raise CandidateError(f"{name}: {number:.7g} for all is neither the sum nor the mean of {parts.tolist()}")

    def single(self, entry: dict[str, Any], arrays: dict[str, Any], i: int, count: int) -> dict[str, Any]:
        """The answer to one ray or point: without their axis, in a batch of one, or first among others that share its camera."""
        # Its place among the others is another one each time.
        place = (i + 1) % SHARING if self.alone else 0
        batch = [(i + k - place) % count for k in range(SHARING)] if self.alone else [i]
        bare = [name for name in arrays if counted(self.row, name) and (self.each or name in (self.alone or ()))]
        part = {n: x[i] if n in bare else x[np.array(batch)] if counted(self.row, n) else x for n, x in arrays.items()}
        if self.each:
            return self.one(self.of(entry, []), part)
        asked = self.of(entry, [len(batch)])
        answer = self.shared(asked, self.one(asked, part), len(batch))
        each = lambda name, x: counted(self.row, name, "outputs") and getattr(x, "ndim", 0)  # noqa: E731
        return {name: x[place] if each(name, x) else x for name, x in answer.items()}

    def of(self, entry: dict[str, Any], axis: list[int]) -> dict[str, Any]:
        """The entry of a case for as many rays or points, or for one without their axis."""
        each = lambda port: counted(self.row, port["name"], "outputs")  # noqa: E731
        return {**entry, "outputs": [{**p, "shape": axis + p["shape"][1:]} if each(p) else p for p in entry["outputs"]]}

    def one(self, entry: dict[str, Any], arrays: dict[str, Any]) -> dict[str, Any]:
        """A call, and what it returns by output."""
        forms = {form["takes"] for form in entry["forms"] if form["holds"] and self.match.takes(form["takes"])}
        given = {**arrays, **in_other_forms(self.framework, arrays, forms)}
        given.update({name: given[name].reshape((*given[name].shape, 1)) for name in self.trailing})
        if "u" in given:
            given["#N"] = int(given["u"].shape[-1])
        self.handed = self.match.handed(given, ordered(self.row, arrays))
        first = list(self.handed) if self.match.names is None else self.match.positional
        rest = {name: x for name, x in self.handed.items() if name not in first}
        with dealt(self.numbers(entry, arrays["u"])) if self.draws else contextlib.nullcontext():
            result = self.candidate.function(*(self.handed[name] for name in first), **rest)
        # Positions have one sample more, an empty one.
        more = ["weights"] if "t" in forms else []
        ports = [{**p, "shape": [*p["shape"][:-1], p["shape"][-1] + 1]} if p["name"] in more else p for p in entry["outputs"]]
        if not self.settled:
            by_name = isinstance(result, dict) or hasattr(result, "_asdict")
            self.order = [] if by_name else list(self.candidate.returns or fitting(result, ports))
        found = by_output(result, [port["name"] for port in ports], self.order, f"{self.row['name']}: {self.function}")
        return {name: x[..., : arrays["deltas"].shape[-1]] if name in more else x for name, x in found.items()}

    def numbers(self, entry: dict[str, Any], u: Any) -> Any:
        """The numbers that are dealt to it: those from which it makes the row's."""
        if not self.strata:
            return u
        count, stored = u.shape[-1], next(port["dtype"] for port in entry["inputs"] if port["name"] == "u")
        return u * count - self.framework.array(np.arange(float(count)), stored)


def crash(error: BaseException, plan: Plan) -> str:
    """What a function raised, at which line of its own file, and what it was handed; what isn't its doing by itself."""
    if isinstance(error, CandidateError):
        return str(error)
    code, trace, where = getattr(plan.candidate.function, "__code__", None), error.__traceback__, ""
    while trace is not None:
        if code is not None and trace.tb_frame.f_code.co_filename == code.co_filename:
            where = f" (line {trace.tb_lineno})"
        trace = trace.tb_next
    said = (str(error).strip() or "no words").splitlines()[0][:200]
    shapes = [f"{name} {type(x).__name__}{tuple(x.shape) if hasattr(x, 'shape') else ''}" for name, x in plan.handed.items()]
    handed = f"; it was handed {', '.join(shapes[:8])}{', ...' if len(shapes) > 8 else ''}" if shapes else ""
    return f"{type(error).__name__}: {said}{where}{handed}"
