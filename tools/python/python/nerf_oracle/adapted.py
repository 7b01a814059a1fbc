"""A function with what can't be seen in it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Callable

from .errors import CandidateError
from .frameworks import NAMES
from .rows import checked


@dataclass(frozen=True)
class Adapted:
    """What `adapt` returns: a function on its way to the judge."""

    function: Callable[..., Any]
    names: dict[str, str] = field(default_factory=dict)
    framework: str | None = None
    device: str | None = None
    returns: tuple[str, ...] | None = None
    each: bool | None = None
    trailing: tuple[str, ...] | None = None

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        """The function itself."""
        return self.function(*args, **kwargs)


def adapt(
    function: Callable[..., Any],
    *,
    framework: str | None = None,
    device: str | None = None,
    returns: Sequence[str] | None = None,
    each: bool | None = None,
    trailing: Sequence[str] | None = None,
    **names: str,
) -> Adapted:
    """Says what the judge can't find out about a function.

    Further keywords map its parameters to the contract's arrays: `adapt(f, density="sigmas", depth_values="t")`.

    Args:
        framework: "numpy", "torch", "jax" or "cupy": what it takes.
        device: where its arrays lie: "cuda", "mps" of torch, "gpu" of jax.
        returns: the outputs that it returns, in its order; one that isn't the contract's is "_".
        each: whether it takes one ray or point at a time.
        trailing: the inputs that it takes with a last axis of length one: ("sigmas",) for (R, N, 1).
    """
    if not callable(function):
        raise CandidateError(f"adapt: found {type(function).__name__}, expected a function")
    if framework is not None:
        checked("framework", framework, NAMES)
    inner = function if isinstance(function, Adapted) else Adapted(function)
    first = lambda new, old: old if new is None else new  # noqa: E731
    return Adapted(
        inner.function,
        {**inner.names, **names},
        first(framework, inner.framework),
        first(device, inner.device),
        first(None if returns is None else tuple(returns), inner.returns),
        first(each, inner.each),
        first(None if trailing is None else tuple(trailing), inner.trailing),
    )
