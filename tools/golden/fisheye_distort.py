"""fisheye_distort(points, coefficients): the angle off the axis, with a polynomial (Kannala and Brandt 2006; OpenCV)."""

import mpmath
import numpy as np
import torch
from kornia.geometry.camera.distortion_kannala_brandt import distort_points_kannala_brandt

from . import reals
from .fixture import Case, Draw

NAME, PURPOSE = "fisheye_distort", 1243
DIFFERENTIABLE = KORNIA_DIFFERENTIABLE = ("points", "coefficients")
LENSES = {"fisheye": [0.0298, -0.0102, 0.0057, -0.0014], "equidistant": [0.0] * 4, "strong": [-0.11, 0.06, -0.02, 0.004]}


def cases():
    """Each lens over a picture, far off the axis, in the middle and beside it."""
    for name, lens in LENSES.items():
        yield case(name, Draw(PURPOSE, name).uniform((8, 2), -0.9, 0.9), lens, "over a picture")
    yield case("wide-LE2", np.array([[3.0, 0.0], [-8.0, 6.0], [20.0, 99.0]]), LENSES["fisheye"], "to 89 degrees")
    yield case("middle-LE1", np.array([[0.0, 0.0], [2.0**-30, 0.0], [0.0, -(2.0**-10)]]), LENSES["fisheye"], "r = 0 and beside")


def kornia_cases():
    """Without the middle, where kornia has a threshold of its own."""
    return [made for made in cases() if "LE1" not in made.name]


def case(name, points, lens, comment):
    """A case from its points and its lens."""
    return Case(name, {"points": points, "coefficients": np.array(lens)}, comment)


def polynomial(theta, k):
    """theta (1 + k1 theta^2 + ...) of any kind of number."""
    t2 = theta * theta
    t4 = t2 * t2
    return theta * (t2 * k[0] + t4 * k[1] + t4 * t2 * k[2] + t4 * t4 * k[3] + 1)


def atan(x):
    """The arc tangent."""
    slope = 1 / (1 + x.value**2)
    return x.function(mpmath.atan(x.value), slope, -2 * x.value * slope**2)


def over_reals(x):
    """The definition, point by point."""
    rows = []
    for p in x["points"]:
        squares = reals.dot(p, p)
        if squares.value == 0:
            rows.append([z * 1 for z in p])
            continue
        r = reals.sqrt(squares)
        scale = polynomial(atan(r), x["coefficients"]) / r
        rows.append([z * scale for z in p])
    return {"distorted": np.array(rows, dtype=object)}


def in_torch(x):
    """The same on columns; r is held off 0 inside of the selection."""
    p, k = x["points"], x["coefficients"]
    squares = (p * p).sum(-1, keepdim=True)
    away = squares > 0
    r = torch.where(away, squares, torch.ones_like(squares)).sqrt()
    return {"distorted": torch.where(away, p * (polynomial(torch.atan(r), k) / r), p)}


def in_kornia(x):
    """Its camera with focal length 1 and center 0."""
    params = torch.cat([torch.tensor([1.0, 1.0, 0.0, 0.0]), x["coefficients"]])
    return {"distorted": distort_points_kannala_brandt(x["points"], params)}
