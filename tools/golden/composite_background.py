"""composite_background(colors, opacity, background): colors_out = colors + (1 - opacity) background."""

import numpy as np

from . import reals
from .fixture import Case, Draw

NAME, PURPOSE = "composite_background", 1013
DIFFERENTIABLE = ("colors", "opacity", "background")


def cases():
    """Random rays; A of 0, 1/2 and 1 over a background of three colors."""
    draw = Draw(PURPOSE, "random")
    yield case("random", draw.uniform((6, 3)), draw.uniform((6,)), draw.uniform((3,)), "any opacity")
    colors = np.array([[0.0, 0.0, 0.0], [0.25, 0.5, 0.125], [1.0, 0.25, 0.0]])
    yield case("ends", colors, np.array([0.0, 0.5, 1.0]), np.array([1.0, 0.25, 0.5]), "empty, half and opaque")
    thin = np.array([2.0**-60, 1.0 - 2.0**-53])
    yield case("thin", colors[:2], thin, np.array([0.1, 1.0, 0.7]), "1 - A rounds to 1; A one bit below 1")


def case(name, colors, opacity, background, comment):
    """A case from its three arrays."""
    return Case(name, {"colors": colors, "opacity": opacity, "background": background}, comment)


def over_reals(x):
    """The definition, entry by entry."""
    out = np.empty(x["colors"].shape, object)
    for r, c in np.ndindex(out.shape):
        out[r, c] = reals.total([x["colors"][r, c], (1 - x["opacity"][r]) * x["background"][c]])
    return {"colors_out": out}


def in_torch(x):
    """The same on whole tensors."""
    return {"colors_out": x["colors"] + (1.0 - x["opacity"])[:, None] * x["background"]}
