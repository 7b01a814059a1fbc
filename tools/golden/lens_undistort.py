"""lens_undistort(distorted, coefficients): the inverse of lens_distort, before every fold."""

import kornia.geometry.calibration as calibration
import mpmath
import numpy as np
import torch

from . import lens_distort, reals
from .fixture import Case, Draw

NAME, PURPOSE = "lens_undistort", 1241
DIFFERENTIABLE = KORNIA_DIFFERENTIABLE = ("distorted", "coefficients")


def cases():
    """Each lens over a picture, the middle of it, a strong lens, and one close to its fold."""
    for name, lens in lens_distort.LENSES.items():
        yield case(name, Draw(PURPOSE, name).uniform((8, 2), -0.55, 0.55), lens, "over a picture")
    middle = np.array([[0.0, 0.0], [2.0**-40, 0.0], [0.0, -0.5]])
    yield case("middle-LE1", middle, lens_distort.LENSES["phone"], "r = 0 and beside")
    slow = np.array([[1.134, 0.0], [-0.7, 0.9], [0.3, -0.8]])
    yield case("slow-LE2", slow, [-0.45, 0.25, 0.0, 0.0], "five steps of x'/radial(x) are too few")
    fold = np.array([[0.6875, 0.0], [0.4, -0.55]])
    yield case("fold-LE3", fold, [-0.3, 0.0, 0.0, 0.0], "r (1 - 0.3 r^2) has its top at 0.703")


def case(name, distorted, lens, comment):
    """A case from its points and its lens."""
    return Case(name, {"distorted": distorted, "coefficients": np.array(lens)}, comment)


def slopes(x, y, coefficients):
    """The Jacobian of the lens at a point of numbers without history: xx, xy, yy."""
    h = mpmath.mpf(10) ** -20
    values = [k.value for k in coefficients]
    column = lambda dx, dy: [  # noqa: E731
        (a - b) / (2 * h)
        for a, b in zip(lens_distort.bent(x + dx, y + dy, values), lens_distort.bent(x - dx, y - dy, values), strict=True)
    ]
    (xx, yx), (_, yy) = column(h, 0), column(0, h)
    return xx, yx, yy


def solved(target, coefficients):
    """The point at 50 digits by Newton's method, and then one step with history, whose derivatives are those of the solution."""
    values = [k.value for k in coefficients]
    x, y = (z.value for z in target)
    for _ in range(60):
        xx, xy, yy = slopes(x, y, coefficients)
        off = [a - z.value for a, z in zip(lens_distort.bent(x, y, values), target, strict=True)]
        det = xx * yy - xy * xy
        step = (yy * off[0] - xy * off[1]) / det, (xx * off[1] - xy * off[0]) / det
        x, y = x - step[0], y - step[1]
    xx, xy, yy = slopes(x, y, coefficients)
    det = xx * yy - xy * xy
    start = [rounded(x), rounded(y)]
    off = [reals.real(a) - z for a, z in zip(lens_distort.bent(*start, coefficients), target, strict=True)]
    return [
        start[0] - off[0] * reals.constant(yy / det) + off[1] * reals.constant(xy / det),
        start[1] - off[1] * reals.constant(xx / det) + off[0] * reals.constant(xy / det),
    ]


def rounded(x):
    """A coordinate that is known to within its own rounding."""
    return reals.constant(x)


def over_reals(x):
    """Newton's method, point by point."""
    rows = [solved(target, list(x["coefficients"])) for target in x["distorted"]]
    return {"points": np.array(rows, dtype=object)}


def in_torch(x):
    """Newton's method without gradients, and a last step with them."""
    target, lens = x["distorted"], x["coefficients"]
    bend = lambda p, k: torch.stack(lens_distort.bent(*p.unbind(-1), k.unbind()), -1)  # noqa: E731
    p = target.detach().clone()
    for _ in range(40):
        jacobian = torch.func.vmap(torch.func.jacrev(bend), (0, None))(p, lens.detach())
        p = p - torch.linalg.solve(jacobian, bend(p, lens.detach()) - target.detach())
    return {"points": p - torch.linalg.solve(jacobian, bend(p, lens) - target)}


def kornia_cases():
    """The lenses that kornia's fixed point converges for."""
    return [made for made in cases() if made.name in lens_distort.LENSES]


def in_kornia(x):
    """undistort_points with as many steps as it takes, of a camera with focal length 1 and its center at 0."""
    eye = torch.eye(3)[None]
    return {"points": calibration.undistort_points(x["distorted"][None], eye, x["coefficients"][None], eye, num_iters=200)[0]}
