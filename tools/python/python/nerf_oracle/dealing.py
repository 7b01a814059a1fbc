"""Functions with randomness of their own: the numbers that they draw are dealt to them."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Iterator
from typing import Any

import numpy as np

from .arrays import host
from .errors import CandidateError

DRAWS = {
    "torch": ("rand", "rand_like"),
    "numpy.random": ("rand", "random", "random_sample", "uniform", "default_rng"),
    "jax.random": ("uniform",),
}


@contextlib.contextmanager
def dealt(u: Any) -> Iterator[None]:
    """Inside, uniform random numbers of torch, numpy and jax are `u`, in the shape and between the ends that are asked for:

        def sample(rays_o, rays_d, near, far, u):
            with nerf_oracle.dealt(u):
                return my_sampler(rays_o, rays_d, near, far, n_samples=u.shape[-1])

    A function of a row with `u` that doesn't take it is dealt it by itself. Generators that were made before keep their own
    numbers.
    """
    with contextlib.ExitStack() as stack:
        for module in DRAWS:
            if module in sys.modules:
                for name in DRAWS[module]:
                    replaced(stack, sys.modules[module], name, stand_in(module, name, u))
        if "torch" in sys.modules:
            replaced(stack, sys.modules["torch"].Tensor, "uniform_", uniform_(u))
        yield


def replaced(stack: contextlib.ExitStack, owner: Any, name: str, value: Any) -> None:
    """Puts a value in the place of another until the stack ends."""
    stack.callback(setattr, owner, name, getattr(owner, name))
    setattr(owner, name, value)


def stand_in(module: str, name: str, u: Any) -> Any:
    """What is called in place of a function that draws."""
    if module == "torch":
        if name == "rand_like":
            return lambda x, **_: torch_numbers(u, tuple(x.shape), x)
        return lambda *size, **settings: torch_numbers(u, shape_of(settings.get("size", size)), None, settings)
    if module == "jax.random":
        return jax_uniform(u)
    stream = Stream(u)
    return (lambda *_: stream) if name == "default_rng" else getattr(stream, name)


class Stream:
    """A generator of numpy's that deals."""

    def __init__(self, u: Any) -> None:
        self.u = u

    def rand(self, *size: int) -> Any:
        """As numpy.random.rand."""
        return numbers(self.u, shape_of(size))

    def random(self, size: Any = (), dtype: Any = None, out: Any = None) -> Any:
        """As Generator.random."""
        return numbers(self.u, shape_of(size))

    random_sample = random

    def uniform(self, low: Any = 0.0, high: Any = 1.0, size: Any = None) -> Any:
        """As Generator.uniform."""
        shape = np.broadcast(np.asarray(low), np.asarray(high)).shape if size is None else shape_of(size)
        return low + (high - low) * numbers(self.u, shape)


def shape_of(size: Any) -> tuple[int, ...]:
    """A shape from rand(2, 3), rand((2, 3)), random(5), random(None)."""
    if size is None:
        return ()
    if isinstance(size, (int, np.integer)):
        return (int(size),)
    size = tuple(size)
    return tuple(int(n) for n in (size[0] if len(size) == 1 and not isinstance(size[0], (int, np.integer)) else size))


def reshaped(u: Any, shape: tuple[int, ...]) -> Any:
    """The numbers in another shape of as many, or one ray's numbers where all are alike."""
    if int(np.prod(shape)) != int(np.prod(u.shape)):
        raise CandidateError(
            f"dealt: {shape} random numbers are drawn, where u has the shape {tuple(u.shape)}: one for every sample"
        )
    return u.reshape(shape)


def numbers(u: Any, shape: tuple[int, ...]) -> Any:
    """For numpy."""
    return reshaped(host(u), shape)


def torch_numbers(u: Any, shape: tuple[int, ...], like: Any, settings: Any = None) -> Any:
    """For torch, in the type and on the device that are asked for."""
    torch = sys.modules["torch"]
    given = u if isinstance(u, torch.Tensor) else torch.as_tensor(host(u))
    where = {name: value for name, value in (settings or {}).items() if name in ("dtype", "device") and value is not None}
    given = reshaped(given, shape)
    return given.to(like) if like is not None else given.to(**where) if where else given.clone()


def uniform_(u: Any) -> Any:
    """Tensor.uniform_."""

    def fill(self, low=0.0, high=1.0, **_):
        return self.copy_(low + (high - low) * torch_numbers(u, tuple(self.shape), self))

    return fill


def jax_uniform(u: Any) -> Any:
    """jax.random.uniform."""

    def uniform(key=None, shape=(), dtype=None, minval=0.0, maxval=1.0, **_):
        given = reshaped(u, shape_of(shape))
        return minval + (maxval - minval) * (given if dtype is None else given.astype(dtype))

    return uniform
