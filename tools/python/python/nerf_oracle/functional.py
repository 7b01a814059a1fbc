"""Modules of torch that hold their weights, as functions that take them."""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from typing import Any, Callable

from .errors import CandidateError
from .rows import rows


def functional(module: Any, weights: Mapping[str, str] | None = None) -> Callable[..., Any]:
    """A module as a function of the contract's arrays, its weights among them (`torch.func.functional_call`):

        nerf_oracle.judge(mlp=nerf_oracle.functional(lambda x, **layers: MyMLP(depth=len(layers) // 2)))

    Args:
        module: a module of torch, or a function that makes one for a case's arrays, where its size depends on theirs.
        weights: the array of each of the module's parameters: {"layers.0.weight": "w0", ...}; by itself both in their order.
    """
    torch_func = __import__("torch.func", fromlist=["functional_call"])

    def call(**arrays: Any) -> Any:
        made = module if hasattr(module, "named_parameters") else module(**arrays)
        own = {name: tuple(x.shape) for name, x in made.named_parameters()}
        inputs = {name: x for name, x in arrays.items() if name in taken(made)}
        named = dict(weights) if weights is not None else in_order(own, [name for name in arrays if name not in inputs])
        for name, array in named.items():
            if name not in own or array not in arrays:
                what = f"parameter {name!r} of the module" if name not in own else f"array {array!r} of the case"
                raise CandidateError(f"functional: no {what}; parameters: {', '.join(own)}; arrays: {', '.join(arrays)}")
            if tuple(arrays[array].shape) != own[name]:
                shapes = f"{own[name]}, where {array} is {tuple(arrays[array].shape)}"
                raise CandidateError(
                    f"functional: {name} has the shape {shapes}: hand over a function that makes the module for a case"
                )
        return torch_func.functional_call(made, {name: arrays[array] for name, array in named.items()}, kwargs=inputs)

    call.__name__ = getattr(module, "__name__", type(module).__name__)
    return call


def taken(module: Any) -> list[str]:
    """The parameters of a module's forward that are inputs, no weights, of some row."""
    names = {port["name"] for row in rows().values() for port in row["inputs"]}
    return [name for name in inspect.signature(module.forward).parameters if name in names]


def in_order(own: Mapping[str, Any], arrays: list[str]) -> dict[str, str]:
    """Parameters and arrays, both in their order."""
    if len(own) != len(arrays):
        counts = f"{len(own)} parameters ({', '.join(own)}), the case {len(arrays)} arrays for them ({', '.join(arrays)})"
        raise CandidateError(f"functional: the module has {counts}: say which is which, functional(module, {{parameter: array}})")
    return dict(zip(own, arrays))
