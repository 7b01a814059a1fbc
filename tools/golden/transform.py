"""transform(c2w, x_c): x_w = R x_c + o, the upper 3x4 of c2w times (x_c, 1)."""

import numpy as np
import torch

from . import reals
from .fixture import Case, Draw
from .pixel_to_ray import poses

NAME, PURPOSE = "transform", 1001
DIFFERENTIABLE = ("c2w", "x_c")


def cases():
    """Rigid poses, poses that are not, and points far away (CG9)."""
    draw = Draw(PURPOSE, "random")
    yield case("random", poses(draw, 6), draw.uniform((6, 3), -2.0, 2.0), "a pose and a point each")
    draw = Draw(PURPOSE, "affine-CG9")
    affine = np.concatenate([draw.uniform((4, 3, 4), -2.0, 2.0), np.tile([0.0, 0.0, 0.0, 1.0], (4, 1, 1))], axis=1)
    affine[0, :3, :3] = 0.0
    yield case("affine-CG9", affine, draw.uniform((4, 3), -2.0, 2.0), "singular, sheared, scaled, of determinant -1")
    draw = Draw(PURPOSE, "far-away-CG9")
    far = poses(draw, 3)
    far[:, :3, 3] *= 1e6
    yield case("far-away-CG9", far, draw.uniform((3, 3), -1e6, 1e6), "R x_c + o cancels: measured on its largest term")
    draw = Draw(PURPOSE, "canceling-CG9")
    near = poses(draw, 2)
    points = draw.uniform((2, 3), -2.0, 2.0)
    for m in range(2):
        for i in range(3):
            near[m, i, 3] = -(near[m, i, 0] * points[m, 0] + near[m, i, 1] * points[m, 1] + near[m, i, 2] * points[m, 2])
    yield case("canceling-CG9", near, points, "the point falls on the world's origin, to rounding")


def case(name, c2w, x_c, comment):
    """A case from its two arrays."""
    return Case(name, {"c2w": c2w, "x_c": x_c}, comment)


def over_reals(x):
    """The definition, point by point."""
    out = np.empty(x["x_c"].shape, object)
    for m, i in np.ndindex(out.shape):
        out[m, i] = reals.total([x["c2w"][m, i, j] * x["x_c"][m, j] for j in range(3)] + [x["c2w"][m, i, 3]])
    return {"x_w": out}


def in_torch(x):
    """One batched product in homogeneous coordinates."""
    homogeneous = torch.cat([x["x_c"], torch.ones_like(x["x_c"][:, :1])], -1)
    return {"x_w": torch.einsum("mij,mj->mi", x["c2w"][:, :3], homogeneous)}
