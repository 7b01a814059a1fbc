"""spherical_harmonics(d, degree): real, orthonormal, with the sign (-1)^m; Sloan 2008, appendix A2.

Band by band, m ascending, as polynomials that are taken as they stand where d is not unit.
"""

import numpy as np
import torch

from . import reals
from .fixture import Case, Draw

NAME, PURPOSE = "spherical_harmonics", 1101
DIFFERENTIABLE = ("d",)


def cases():
    """Axes, random directions at every degree, and the row PE7 of the hard cases."""
    axes = np.concatenate([np.eye(3), -np.eye(3)])
    yield case("axes", axes, 4, "along the axes, both ways")
    for degree in range(5):
        d = Draw(PURPOSE, f"degree-{degree}").uniform((4, 3), -1.0, 1.0)
        yield case(f"degree-{degree}", d / np.linalg.norm(d, axis=1, keepdims=True), degree, "unit up to rounding")
    yield case("not-unit-PE7", np.array([[0.25, -0.375, 0.125], [1.0, -1.5, 0.5]]), 4, "lengths 1/2 and 2")


def case(name, d, degree, comment):
    """A case from directions and the last band."""
    return Case(name, {"d": d, "degree": np.float64(degree)}, comment)


def polynomials(x, y, z, root):
    """All 25, factored; `root(a, b)` is sqrt(a / (b pi))."""
    return [
        root(1, 4) + x * 0,
        -1 * root(3, 4) * y,
        root(3, 4) * z,
        -1 * root(3, 4) * x,
        root(15, 4) * (x * y),
        -1 * root(15, 4) * (y * z),
        root(5, 16) * (3 * (z * z) - 1),
        -1 * root(15, 4) * (x * z),
        root(15, 16) * (x * x - y * y),
        -1 * root(35, 32) * (y * (3 * (x * x) - y * y)),
        root(105, 4) * (x * y * z),
        -1 * root(21, 32) * (y * (5 * (z * z) - 1)),
        root(7, 16) * (z * (5 * (z * z) - 3)),
        -1 * root(21, 32) * (x * (5 * (z * z) - 1)),
        root(105, 16) * (z * (x * x - y * y)),
        -1 * root(35, 32) * (x * (x * x - 3 * (y * y))),
        root(315, 16) * (x * y * (x * x - y * y)),
        -1 * root(315, 32) * (y * z * (3 * (x * x) - y * y)),
        root(45, 16) * (x * y * (7 * (z * z) - 1)),
        -1 * root(45, 32) * (y * z * (7 * (z * z) - 3)),
        root(9, 256) * (35 * (z * z * z * z) - 30 * (z * z) + 3),
        -1 * root(45, 32) * (x * z * (7 * (z * z) - 3)),
        root(45, 64) * ((x * x - y * y) * (7 * (z * z) - 1)),
        -1 * root(315, 32) * (x * z * (x * x - 3 * (y * y))),
        root(315, 256) * (x * x * (x * x - 3 * (y * y)) - y * y * (3 * (x * x) - y * y)),
    ]


def over_reals(x):
    """The definition."""
    one = reals.Real(1)

    def root(a, b):
        return one * reals.mp.sqrt(reals.mpf(a) / (b * reals.mp.pi))

    width = (int(x["degree"].item().value) + 1) ** 2
    rows = [[one * value for value in polynomials(*d, root)[:width]] for d in x["d"]]
    return {"harmonics": np.array(rows, dtype=object)}


def in_torch(x):
    """The same in torch."""
    d, width = x["d"], (int(x["degree"]) + 1) ** 2

    def root(a, b):
        return torch.sqrt(torch.tensor(a / (b * torch.pi), dtype=torch.float64)).expand(d.shape[0])

    return {"harmonics": torch.stack(polynomials(d[:, 0], d[:, 1], d[:, 2], root)[:width], -1)}
