"""contraction(x): x for |x| <= 1, (2 - 1/|x|) x/|x| beyond (mip-NeRF 360, equation 10); norm and range by convention."""

import numpy as np
import torch

from . import reals
from .fixture import Case, Draw
from .portable import power_of_ten

NAME, PURPOSE = "contraction", 1231
DIFFERENTIABLE = ("x",)


def cases():
    """Inside, outside, far away, the origin and both surfaces; each in its norms and ranges."""
    for norm, scale in [("l2", "two"), ("l2", "unit"), ("linf", "unit"), ("linf", "two"), ("merf", "two"), ("merf", "one")]:
        conventions = {"contraction_norm": norm, "contraction_range": scale}
        tag = f"{norm}-{scale}"
        yield case(f"inside-{tag}", Draw(PURPOSE, "inside").uniform((4, 3), -0.5, 0.5), "stays", conventions)
        yield case(f"outside-{tag}", Draw(PURPOSE, "outside").uniform((8, 3), -9.0, 9.0), "a few lengths out", conventions)
        far = Draw(PURPOSE, "far").uniform((4, 3), -1.0, 1.0) * power_of_ten(Draw(PURPOSE, "size").uniform((4, 1), 1.0, 15.0))
        yield case(f"far-{tag}", far, "to 1e15", conventions)
    yield case("origin-CG6", np.array([[0.0, 0.0, 0.0], [-0.0, 2.0**-60, 0.0]]), "0 and beside", {})
    surface = np.array([[1.0, 0.0, 0.0], [0.0, -1.0 - 2.0**-52, 0.0], [0.0, 0.0, 1.0 - 2.0**-53]])
    yield case("surface-CG7", surface, "r = 1 and its neighbors", {})
    yield case("surface-linf-CG7", surface + [0.0, 0.25, 0.125], "the same on a cube", {"contraction_norm": "linf"})


def case(name, x, comment, conventions):
    """A case from its points."""
    return Case(name, {"x": x}, comment, conventions=conventions)


def settings(x):
    """Norm and range of a case."""
    return x["conventions"].get("contraction_norm", "l2"), x["conventions"].get("contraction_range", "two")


def magnitude(x):
    """|x| of a real number."""
    return -x if x.value < 0 else x


def folded(point, norm):
    """The definition of one point, before it is scaled."""
    sizes = [magnitude(x) for x in point]
    k = max(range(3), key=lambda j: sizes[j].value)
    r = sizes[k]
    if norm == "l2":
        squares = reals.dot(point, point)
        if squares.value == 0:
            return list(point)
        r = reals.sqrt(squares)
    if r.value <= 1:
        return list(point)
    disparity = r.reciprocal()
    far = [(2 - disparity) * (x * disparity) for x in point]
    if norm == "merf":
        return [far[j] if j == k else point[j] * disparity for j in range(3)]
    return far


def over_reals(x):
    """The definition, point by point."""
    norm, scale = settings(x)
    rows = [folded(point, norm) for point in x["x"]]
    if scale == "one":
        rows = [[y * 0.5 for y in row] for row in rows]
    if scale == "unit":
        rows = [[y * 0.25 + 0.5 for y in row] for row in rows]
    return {"contracted": np.array([[reals.real(1) * y for y in row] for row in rows], dtype=object)}


def in_torch(x):
    """Both pieces and a selection; r is held off 0 inside of it, so that its slope stays finite there."""
    norm, scale = settings(x)
    points = x["x"]
    inside = (points * points).sum(-1, keepdim=True) <= 1 if norm == "l2" else points.abs().amax(-1, keepdim=True) <= 1
    away = torch.where(inside, torch.ones_like(points), points)
    r = torch.linalg.vector_norm(away, ord=2 if norm == "l2" else torch.inf, dim=-1, keepdim=True)
    far = (2 - 1 / r) * (away / r)
    if norm == "merf":
        first = torch.nn.functional.one_hot(away.abs().argmax(-1), 3).bool()
        far = torch.where(first, far, away / r)
    y = torch.where(inside, points, far)
    return {"contracted": {"two": y, "one": y / 2, "unit": y / 4 + 0.5}[scale]}
