"""trunc_exp(x): e^x, with the surrogate gradient g e^clamp(x, -15, 15) of Instant-NGP, which is not the derivative outside."""

import numpy as np
import torch

from . import reals
from .fixture import Case, Draw

NAME, PURPOSE = "trunc_exp", 1111
DIFFERENTIABLE = ("x",)
LIMIT = 15.0


def cases():
    """Inside, beside and beyond the limits, and the row VR6 of the hard cases."""
    yield case("usual", Draw(PURPOSE, "usual").uniform((16,), -8.0, 8.0), "raw densities of a trained field")
    yield case("zero", np.array([0.0, -0.0, 2.0**-30, -(2.0**-30)]), "beside 0")
    beside = np.array([np.nextafter(LIMIT, 0.0), LIMIT, np.nextafter(LIMIT, 20.0)])
    yield case("limits", np.concatenate([-beside, beside]), "the limits and their neighbors")
    yield case("outside", np.concatenate([Draw(PURPOSE, "outside").uniform((8,), 15.0, 80.0), np.array([-16.0, -40.0])]), "")
    yield case("extremes-VR6", np.array([88.0, 89.0, 709.0, -708.0, -740.0]), "where single and double precision end")
    overflow = case("overflow-VR6", np.array([710.0, 1e300, -746.0, -1e300]), "infinite and 0, the gradient finite")
    overflow.flags = ["infinite"]
    yield overflow


def case(name, x, comment):
    """A case from its argument."""
    return Case(name, {"x": x}, comment)


def surrogate(x):
    """e^x on the tape with the stated slope instead of its own."""
    slope = reals.mp.exp(min(max(x.value, -LIMIT), LIMIT))
    curvature = slope if abs(x.value) <= LIMIT else reals.mpf(0)
    return x.function(reals.mp.exp(x.value), slope, curvature)


def over_reals(x):
    """The definition."""
    return {"sigmas": np.array([surrogate(value) for value in x["x"]], dtype=object)}


class TruncExp(torch.autograd.Function):
    """e^x forward, the surrogate backward."""

    @staticmethod
    def forward(ctx, x):
        """e^x."""
        ctx.save_for_backward(x)
        return torch.exp(x)

    @staticmethod
    def backward(ctx, g):
        """g e^clamp(x, -15, 15)."""
        (x,) = ctx.saved_tensors
        return g * torch.exp(torch.clamp(x, -LIMIT, LIMIT))


def in_torch(x):
    """A function of its own for autograd."""
    return {"sigmas": TruncExp.apply(x["x"])}
