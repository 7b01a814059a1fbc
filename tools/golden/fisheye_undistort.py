"""fisheye_undistort(distorted, coefficients): the inverse of fisheye_distort, before every fold and 90 degrees."""

import mpmath
import numpy as np
import torch

from . import fisheye_distort, reals
from .fixture import Case, Draw

NAME, PURPOSE = "fisheye_undistort", 1244
DIFFERENTIABLE = ("distorted", "coefficients")


def cases():
    """Each lens over a picture, nearly 90 degrees, close to a fold, in the middle and beside it."""
    for name, lens in fisheye_distort.LENSES.items():
        yield case(name, Draw(PURPOSE, name).uniform((8, 2), -0.6, 0.6), lens, "over a picture")
    yield case("wide-LE2", np.array([[1.2, 0.0], [-1.0, 1.1]]), fisheye_distort.LENSES["fisheye"], "to 85 degrees")
    yield case("fold-LE3", np.array([[0.97, 0.0], [0.4, -0.85]]), [-0.15, 0.0, 0.0, 0.0], "the top is at 0.994")
    middle = np.array([[0.0, 0.0], [2.0**-30, 0.0], [0.0, -(2.0**-10)]])
    yield case("middle-LE1", middle, fisheye_distort.LENSES["fisheye"], "0 and beside")


def case(name, distorted, lens, comment):
    """A case from its points and its lens."""
    return Case(name, {"distorted": distorted, "coefficients": np.array(lens)}, comment)


def slope(theta, k):
    """d theta_d / d theta."""
    return 1 + sum((2 * n + 3) * k[n] * theta ** (2 * n + 2) for n in range(4))


def tangent(x):
    """The tangent."""
    t = mpmath.tan(x.value)
    return x.function(t, 1 + t * t, 2 * t * (1 + t * t))


def over_reals(x):
    """The angle at 50 digits, and then one step with history, whose derivatives are those of the solution."""
    k, rows = list(x["coefficients"]), []
    values = [z.value for z in k]
    for p in x["distorted"]:
        squares = reals.dot(p, p)
        if squares.value == 0:
            rows.append([z * 1 for z in p])
            continue
        bent = reals.sqrt(squares)
        theta = bent.value
        for _ in range(60):
            theta -= (fisheye_distort.polynomial(theta, values) - bent.value) / slope(theta, values)
        start = reals.constant(theta)
        off = fisheye_distort.polynomial(start, k) - bent
        found = start - off * reals.constant(1 / slope(theta, values))
        rows.append([z * (tangent(found) / bent) for z in p])
    return {"points": np.array(rows, dtype=object)}


def in_torch(x):
    """Newton's method without gradients, and a last step with them."""
    p, k = x["distorted"], x["coefficients"]
    squares = (p * p).sum(-1, keepdim=True)
    away = squares > 0
    bent = torch.where(away, squares, torch.ones_like(squares) / 4).sqrt()
    theta, fixed = bent.detach().clone(), k.detach()
    for _ in range(40):
        theta = theta - (fisheye_distort.polynomial(theta, fixed) - bent.detach()) / slope(theta, fixed)
    theta = theta - (fisheye_distort.polynomial(theta, k) - bent) / slope(theta, fixed)
    return {"points": torch.where(away, p * (torch.tan(theta) / bent), p)}
