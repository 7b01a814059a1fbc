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
    dealer = Dealer(u)
    with contextlib.ExitStack() as stack:
        for module in DRAWS:
            if module in sys.modules:
                for name in DRAWS[module]:
                    replaced(stack, sys.modules[module], name, stand_in(module, name, dealer))
        if "torch" in sys.modules:
            replaced(stack, sys.modules["torch"].Tensor, "uniform_", uniform_(dealer))
        yield


def replaced(stack: contextlib.ExitStack, owner: Any, name: str, value: Any) -> None:
    """Puts a value in the place of another until the stack ends."""
    stack.callback(setattr, owner, name, getattr(owner, name))
    setattr(owner, name, value)


class Dealer:
    """Gives the numbers out: all at once, or ray after ray, sample after sample, one after another. Who draws those of one ray
    for all rays gets those of the first."""

    def __init__(self, u: Any) -> None:
        self.u = u
        self.drawn: dict[tuple[int, ...], int] = {}

    def numbers(self, u: Any, shape: tuple[int, ...]) -> Any:
        """The next ones in this shape, of `u` as an array of some framework."""
        own, size = tuple(u.shape), int(np.prod(shape))
        if size == int(np.prod(own)):
            return (u.T if len(own) == 2 and shape == own[::-1] != own else u).reshape(shape)
        part = part_of(shape, own)
        if part is None or not all(own):
            raise CandidateError(f"dealt: {shape} random numbers are drawn, where u has the shape {own}: one for every sample")
        k = self.drawn.get(part, 0)
        self.drawn[part] = k + 1
        rows = u.reshape((-1, size)) if part[0] != own[0] else u.T
        return rows[k % rows.shape[0]].reshape(shape)


def part_of(shape: tuple[int, ...], own: tuple[int, ...]) -> tuple[int, ...] | None:
    """What a smaller draw is: the numbers of one ray, of one sample of all rays, or one number."""
    size = int(np.prod(shape))
    if len(own) == 2:
        rays, samples = own
        column = len(shape) > 1 and shape[-1] == 1
        if size == samples and not (column and rays == samples):
            return 1, samples
        if size == rays:
            return rays, 1
    return (1,) if size == 1 else None


def stand_in(module: str, name: str, dealer: Dealer) -> Any:
    """What is called in place of a function that draws."""
    if module == "torch":
        if name == "rand_like":
            return lambda x, **_: torch_numbers(dealer, tuple(x.shape), x)
        return lambda *size, **settings: torch_numbers(dealer, shape_of(settings.get("size", size)), None, settings)
    if module == "jax.random":
        return jax_uniform(dealer)
    stream = Stream(dealer)
    return (lambda *_: stream) if name == "default_rng" else getattr(stream, name)


class Stream:
    """A generator of numpy's that deals."""

    def __init__(self, dealer: Dealer) -> None:
        self.dealer = dealer

    def numbers(self, shape: tuple[int, ...]) -> Any:
        """The next ones."""
        return self.dealer.numbers(host(self.dealer.u), shape)

    def rand(self, *size: int) -> Any:
        """As numpy.random.rand."""
        return self.numbers(shape_of(size))

    def random(self, size: Any = (), dtype: Any = None, out: Any = None) -> Any:
        """As Generator.random."""
        return self.numbers(shape_of(size))

    random_sample = random

    def uniform(self, low: Any = 0.0, high: Any = 1.0, size: Any = None) -> Any:
        """As Generator.uniform."""
        shape = np.broadcast(np.asarray(low), np.asarray(high)).shape if size is None else shape_of(size)
        return low + (high - low) * self.numbers(shape)


def shape_of(size: Any) -> tuple[int, ...]:
    """A shape from rand(2, 3), rand((2, 3)), random(5), random(None)."""
    if size is None:
        return ()
    if isinstance(size, (int, np.integer)):
        return (int(size),)
    size = tuple(size)
    return tuple(int(n) for n in (size[0] if len(size) == 1 and not isinstance(size[0], (int, np.integer)) else size))


def torch_numbers(dealer: Dealer, shape: tuple[int, ...], like: Any, settings: Any = None) -> Any:
    """For torch, in the type and on the device that are asked for."""
    torch, u = sys.modules["torch"], dealer.u
    given = u if isinstance(u, torch.Tensor) else torch.as_tensor(host(u))
    where = {name: value for name, value in (settings or {}).items() if name in ("dtype", "device") and value is not None}
    given = dealer.numbers(given, shape)
    return given.to(like) if like is not None else given.to(**where) if where else given.clone()


def uniform_(dealer: Dealer) -> Any:
    """Tensor.uniform_."""

    def fill(self, *ends, **named):
        # Its parameters are called `from` and `to`.
        low, high = [*ends, *[named.get("from", 0.0), named.get("to", 1.0)][len(ends) :]]
        return self.copy_(low + (high - low) * torch_numbers(dealer, tuple(self.shape), self))

    return fill


def jax_uniform(dealer: Dealer) -> Any:
    """jax.random.uniform."""

    def uniform(key=None, shape=(), dtype=None, minval=0.0, maxval=1.0, **_):
        given = dealer.numbers(dealer.u, shape_of(shape))
        return minval + (maxval - minval) * (given if dtype is None else given.astype(dtype))

    return uniform
