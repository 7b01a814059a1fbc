"""pixel_to_camera(K, uv, s): x_c = s K^-1 (u, v, 1) = (s (u - cx) / fx, s (v - cy) / fy, s)."""

import numpy as np
import torch

from .fixture import Case, Draw
from .pixel_to_ray import intrinsics

NAME, PURPOSE = "pixel_to_camera", 1002
DIFFERENTIABLE = ("K", "uv", "s")


def cases():
    """fx != fy, the center off the middle; depths of 0, behind the camera and far away."""
    draw = Draw(PURPOSE, "random")
    yield case("random", intrinsics(), draw.uniform((6, 2), 0.0, 100.0), draw.uniform((6,), 0.5, 6.0), "random pixels")
    uv = np.array([[32.5, 20.25], [32.5, 0.5], [0.0, 0.0], [-10.0, 200.0]])
    yield case("depths-CG9", intrinsics(), uv, np.array([1.0, 0.0, -2.0, 1e6]), "the axis itself; depth 0, negative, 1e6")
    draw = Draw(PURPOSE, "beside-the-center")
    near = np.array([32.5, 20.25]) * (1.0 + draw.uniform((4, 2), -1e-12, 1e-12))
    yield case("beside-the-center", intrinsics(1111.1, 0.001), near, np.ones(4), "u - cx is exact; fx is large, fy small")


def case(name, k, uv, s, comment):
    """A case from its three arrays."""
    return Case(name, {"K": k, "uv": uv, "s": s}, comment)


def over_reals(x):
    """The definition, point by point."""
    k, uv, s = x["K"], x["uv"], x["s"]
    out = np.empty((len(uv), 3), object)
    for m in range(len(uv)):
        for i in range(2):
            out[m, i] = s[m] * (uv[m, i] - k[i, 2]) / k[i, i]
        out[m, 2] = s[m]
    return {"x_c": out}


def in_torch(x):
    """The inverse intrinsics as batched tensor operations."""
    k = x["K"]
    inverse = torch.stack([k[0, 0], k[1, 1]]), torch.stack([k[0, 2], k[1, 2]])
    plane = (x["uv"] - inverse[1]) / inverse[0]
    return {"x_c": torch.cat([plane, torch.ones_like(plane[:, :1])], -1) * x["s"][:, None]}
