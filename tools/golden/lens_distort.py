"""lens_distort(points, coefficients): OpenCV's lens, four, five or eight coefficients."""

import kornia.geometry.calibration as calibration
import numpy as np
import torch

from . import reals
from .fixture import Case, Draw

NAME, PURPOSE = "lens_distort", 1240
DIFFERENTIABLE = KORNIA_DIFFERENTIABLE = ("points", "coefficients")
LENSES = {
    "phone": [-0.2812, 0.0742, 0.0011, -0.00079],
    "five": [-0.334, 0.1309, 0.0011, -0.0013, -0.0322],
    "eight": [0.418, -0.127, -0.0007, 0.0013, 0.0254, 0.6484, -0.0771, 0.0186],
    "none": [0.0] * 4,
    "tangential": [0.0, 0.0, 0.03, -0.02],
}


def cases():
    """Each lens over a picture, the middle of it, and a strong one far off the axis."""
    for name, lens in LENSES.items():
        yield case(name, Draw(PURPOSE, name).uniform((8, 2), -0.7, 0.7), lens, "over a picture")
    yield case("middle-LE1", np.array([[0.0, 0.0], [2.0**-40, 0.0], [0.0, -0.5]]), LENSES["phone"], "r = 0 and beside")
    wide = np.array([[1.25, 0.0], [-0.7, 1.0], [0.3, -1.2]])
    yield case("wide-LE2", wide, [-0.45, 0.25, 0.0, 0.0], "far off the axis")


kornia_cases = cases


def case(name, points, lens, comment):
    """A case from its points and its lens."""
    return Case(name, {"points": points, "coefficients": np.array(lens)}, comment)


def named(coefficients):
    """k1, k2, p1, p2, k3, k4, k5, k6 of any kind of number."""
    given = list(coefficients)
    return given + [0.0] * (8 - len(given))


def bent(x, y, coefficients):
    """The definition, for any kind of number."""
    k1, k2, p1, p2, k3, k4, k5, k6 = named(coefficients)
    r2 = x * x + y * y
    r4 = r2 * r2
    r6 = r4 * r2
    radial = (r2 * k1 + r4 * k2 + r6 * k3 + 1) / (r2 * k4 + r4 * k5 + r6 * k6 + 1)
    return [
        x * radial + x * y * p1 * 2.0 + (r2 + x * x * 2.0) * p2,
        y * radial + (r2 + y * y * 2.0) * p1 + x * y * p2 * 2.0,
    ]


def over_reals(x):
    """The definition, point by point."""
    rows = [[reals.real(1) * z for z in bent(*point, x["coefficients"])] for point in x["points"]]
    return {"distorted": np.array(rows, dtype=object)}


def in_torch(x):
    """The same on columns."""
    return {"distorted": torch.stack(bent(*x["points"].unbind(-1), x["coefficients"].unbind()), -1)}


def in_kornia(x):
    """distort_points of a camera with focal length 1 and its center at 0."""
    lens = x["coefficients"]
    return {"distorted": calibration.distort_points(x["points"][None], torch.eye(3)[None], lens[None])[0]}
