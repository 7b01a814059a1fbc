"""The reference and its bounds as functions: `nerf_oracle.oracle.<row>` and `nerf_oracle.bound.<row>`, made from the registry."""

from __future__ import annotations

import collections
import functools
import inspect
from typing import Any, Callable

import numpy as np

from . import _core
from .arrays import f64
from .errors import CandidateError, hint
from .rows import DTYPES, checked, checked_profile, covers, fits, ordered, port_of, row_of, rows

# What computes: row, direction, inputs, profile, further settings -> outputs.
Compute = Callable[..., dict[str, np.ndarray]]


def bound_inputs(row: dict[str, Any], args: tuple[Any, ...], given: dict[str, Any], direction: str) -> dict[str, np.ndarray]:
    """Arguments as named arrays in f64: each is there, none is there twice, whole numbers are whole. Cotangents that are left
    off are zeros."""
    name, ports = row["name"], row["inputs"]
    gradients = [f"grad_{port['name']}" for port in row["outputs"] if port["gradient"]] if direction == "vjp" else []
    expected = [port["name"] for port in ports] + gradients
    if len(args) > len(ports):
        raise CandidateError(f"{name}: {len(args)} arguments by position; {hint('', expected)}")
    inputs = dict(zip(expected, args))
    for key, x in given.items():
        if key in inputs:
            raise CandidateError(f"{name}: {key} is given twice")
        if key not in gradients and port_of(row, key) is None:
            raise CandidateError(f"{name}: {key} is no input; {hint(key, expected)}")
        inputs[key] = x
    arrays = {key: f64(x, f"{name}: {key}") for key, x in inputs.items() if x is not None}
    absent = [port for port in ports if not any(covers(port, key) for key in arrays)]
    if absent:
        raise CandidateError(f"{name}: {absent[0]['name']} is missing: {absent[0]['meaning']}")
    for key, array in arrays.items():
        port = port_of(row, key)
        if port is not None and port["whole"] and not np.all(array == np.round(array)):
            raise CandidateError(f"{name}: {key} = {array}, expected whole numbers: {port['meaning']}")
    if direction == "vjp" and any(key not in arrays for key in gradients):
        fits(row, arrays)
        outputs = _core.oracle(name, "forward", {key: x for key, x in arrays.items() if key not in gradients}, None)
        arrays.update({key: np.zeros(outputs[key[len("grad_") :]].shape) for key in gradients if key not in arrays})
    return arrays


def returned(row: dict[str, Any], direction: str, found: dict[str, np.ndarray]) -> Any:
    """One output as it is, several as a named tuple in the contract's order; a dict where a row's arrays are numbered."""
    if direction == "vjp":
        names = [f"grad_{name}" for name in ordered(row, [name[len("grad_") :] for name in found])]
    else:
        names = [port["name"] for port in row["outputs"]]
    values = [x.item() if x.ndim == 0 else x for x in (found[name] for name in names)]
    if direction == "vjp" and any(port["name"].endswith("*") for port in row["inputs"]):
        return dict(zip(names, values))
    return values[0] if len(values) == 1 else named_tuple(row["name"], direction, tuple(names))(*values)


@functools.cache
def named_tuple(name: str, direction: str, fields: tuple[str, ...]) -> Any:
    """VolumeRender(colors, weights, ...)."""
    return collections.namedtuple(class_name(name, direction), fields)


def class_name(name: str, direction: str) -> str:
    """volume_render -> VolumeRender, VolumeRenderGradients."""
    return "".join(part.capitalize() for part in name.split("_")) + ("Gradients" if direction == "vjp" else "")


class Function:
    """A row as a function of arrays, computed in f64. `vjp` is its gradient, where it has one."""

    def __init__(self, name: str, compute: Compute, settings: dict[str, Any], says: str, direction: str = "forward") -> None:
        self.__name__ = self.__qualname__ = name if direction == "forward" else f"{name}.vjp"
        self.__doc__ = documented(row_of(name), direction, says)
        self._row, self._compute, self._settings, self._direction = row_of(name), compute, settings, direction
        self.__signature__ = self._signature()
        if direction == "forward" and self._row["vjp"]:
            self.vjp = Function(name, compute, settings, says, "vjp")

    def _signature(self) -> inspect.Signature:
        kinds, empty = inspect.Parameter, inspect.Parameter.empty
        names = [port["name"] for port in self._row["inputs"] if not port["name"].endswith("*")]
        parameters = [kinds(name, kinds.POSITIONAL_OR_KEYWORD) for name in names]
        if self._direction == "vjp":
            outputs = [port["name"] for port in self._row["outputs"] if port["gradient"]]
            parameters += [kinds(f"grad_{name}", kinds.KEYWORD_ONLY, default=None) for name in outputs]
        parameters += [kinds(name, kinds.KEYWORD_ONLY, default=x) for name, x in {"profile": None, **self._settings}.items()]
        layers = [kinds("layers", kinds.VAR_KEYWORD, default=empty)] * (len(names) < len(self._row["inputs"]))
        return inspect.Signature(parameters + layers)

    def __call__(self, *args: Any, profile: str | None = None, **given: Any) -> Any:
        """The row on these arrays."""
        settings = {name: given.pop(name, default) for name, default in self._settings.items()}
        if "dtype" in settings:
            checked("dtype", settings["dtype"], DTYPES)
        arrays = bound_inputs(self._row, args, given, self._direction)
        fits(self._row, arrays)
        found = self._compute(self._row["name"], self._direction, arrays, profile=checked_profile(profile), **settings)
        return returned(self._row, self._direction, found)

    def __repr__(self) -> str:
        return f"<{self.__name__}{self.__signature__}>"


def documented(row: dict[str, Any], direction: str, says: str) -> str:
    """A docstring from the registry: formula, source, shapes, units."""
    line = lambda port, name: f"    {name} ({port['shape'] or 'a number'}): {port['meaning']}"  # noqa: E731
    inputs = [line(port, port["name"]) for port in row["inputs"]]
    outputs = [line(port, port["name"]) for port in row["outputs"]]
    if direction == "vjp":
        smooth = [port for port in row["outputs"] if port["gradient"]]
        inputs += [
            f"    grad_{port['name']} ({port['shape'] or 'a number'}): of the loss, by {port['name']}; zeros where left off"
            for port in smooth
        ]
        wanted = [port for port in row["inputs"] if port["gradient"]]
        outputs = [f"    grad_{port['name']} ({port['shape'] or 'a number'}): of the loss, by {port['name']}" for port in wanted]
    head = f"{says}{' of the gradient' if direction == 'vjp' else ''}: {row['formula']}"
    source = f"{row['source']}. Conventions: those of `profile`, cs180 if None."
    return "\n".join([head, "", source, "", "Args:", *inputs, "", "Returns:", *outputs])


def resolver(compute: Compute, settings: dict[str, Any], says: str) -> tuple[Callable[[str], Function], Callable[[], list[str]]]:
    """`__getattr__` and `__dir__` of a module whose functions are the rows."""

    @functools.cache
    def attribute(name: str) -> Function:
        if name not in names():
            raise AttributeError(f"{name}: no row of the contract; {hint(name, names())}")
        return Function(name, compute, settings, says)

    def names() -> list[str]:
        return [name for name, row in rows().items() if not row["statistics"]]

    return attribute, names
