"""ndc_rays(rays_o, rays_d, width, height, focal, near): rays in the cube of a view; NeRF (2020), appendix C."""

import numpy as np
import torch

from . import reals
from .fixture import Case, Draw

NAME, PURPOSE = "ndc_rays", 1232
DIFFERENTIABLE = ("rays_o", "rays_d")


def cases():
    """Cameras about the origin, on, before and behind the near plane; both signs of z."""
    for depth, way in (("negative", -1.0), ("positive", 1.0)):
        draw = Draw(PURPOSE, "rays")
        o, d = draw.uniform((8, 3), -1.0, 1.0), draw.uniform((8, 3), -1.0, 1.0)
        d[:, 2] = way * draw.uniform((8,), 0.25, 2.0)
        yield case(f"usual-{depth}", o, d, 1.0, "cameras about the origin", depth)
        yield case(f"near-{depth}", o, d, 0.3, "another near plane", depth)
        yield case(f"beyond-{depth}", o + [0.0, 0.0, 5.0 * way], d, 1.0, "moved back", depth)
        yield case(f"flat-CG10-{depth}", o * [1.0, 1.0, 0.0], d * [1.0, 1.0, 2.0**-7], 1.0, "o_z = 0, grazing", depth)
        yield case(f"behind-CG9-{depth}", o - [0.0, 0.0, 1e4 * way], d, 1.0, "far behind the near plane", depth)


def case(name, o, d, near, comment, depth):
    """A case from its rays."""
    sizes = {"width": np.float64(504.0), "height": np.float64(378.0), "focal": np.float64(407.5), "near": np.float64(near)}
    return Case(name, {"rays_o": o, "rays_d": d} | sizes, comment, conventions={"ndc_depth": depth})


def over_reals(x):
    """The definition: two points of the cube, on the near plane and at infinity."""
    sign = -1 if x["conventions"]["ndc_depth"] == "negative" else 1
    near, focal = x["near"].item(), x["focal"].item()
    scales = [2 * focal / x["width"].item(), 2 * focal / x["height"].item()]
    origins, directions = [], []
    for o, d in zip(x["rays_o"], x["rays_d"]):
        t = (sign * near - o[2]) / d[2]
        start = [scales[j] * ((o[j] + t * d[j]) / near) for j in range(2)]
        ahead = [scales[j] * (sign * (d[j] / d[2]) - (o[j] + t * d[j]) / near) for j in range(2)]
        origins.append([*start, reals.Real(-1)])
        directions.append([*ahead, reals.Real(2)])
    return {"rays_o_ndc": np.array(origins, dtype=object), "rays_d_ndc": np.array(directions, dtype=object)}


def in_torch(x):
    """By the z of the moved origin, as codes have it."""
    sign = -1.0 if x["conventions"]["ndc_depth"] == "negative" else 1.0
    o, d, near = x["rays_o"], x["rays_d"], x["near"]
    p = o + ((sign * near - o[:, 2]) / d[:, 2])[:, None] * d
    scales = sign * 2 * x["focal"] / torch.stack([x["width"], x["height"]])
    start, slope = p[:, :2] / p[:, 2:], d[:, :2] / d[:, 2:]
    depth = 2 * sign * near / p[:, 2:]
    return {"rays_o_ndc": torch.cat([scales * start, 1 - depth], -1), "rays_d_ndc": torch.cat([scales * (slope - start), depth], -1)}
