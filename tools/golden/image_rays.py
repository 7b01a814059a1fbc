"""image_rays(height, width, focal, cx, cy, c2w): pixel_to_ray through every pixel's centre, uv[j, i] = (i + 0.5, j + 0.5)."""

import numpy as np
import torch

from . import pixel_to_ray
from .fixture import Case, Draw
from .reals import Real

NAME, PURPOSE = "image_rays", 1004
DIFFERENTIABLE = ()


def cases():
    """Pictures that are not square, with their centre off the middle."""
    for name, height, width, cx, comment in [
        ("wide", 3, 5, 2.75, "swapped height and width show"),
        ("tall", 4, 2, 1.0, "centre in the middle"),
        ("one-pixel", 1, 1, 0.5, "the pixel looks down the axis"),
    ]:
        inputs = {"height": height, "width": width, "focal": 4.375, "cx": cx, "cy": 0.5 * height}
        yield Case(name, inputs | {"c2w": pixel_to_ray.poses(Draw(PURPOSE, name), 1)[0]}, comment)


def over_reals(x):
    """The definition, pixel by pixel."""
    height, width = int(x["height"].item().value), int(x["width"].item().value)
    zero, one = Real(0), Real(1)
    focal, cx, cy = x["focal"].item(), x["cx"].item(), x["cy"].item()
    k = np.array([[focal, zero, cx], [zero, focal, cy], [zero, zero, one]], dtype=object)
    uv, rays_o, rays_d = (np.empty((height, width, n), object) for n in (2, 3, 3))
    for j, i in np.ndindex(height, width):
        uv[j, i] = [Real(i + 0.5), Real(j + 0.5)]
        rays_o[j, i] = x["c2w"][:3, 3]
        rays_d[j, i] = pixel_to_ray.direction(k, x["c2w"], uv[j, i])
    return {"uv": uv, "rays_o": rays_o, "rays_d": rays_d}


def in_torch(x):
    """A mesh of centres, then the batched rays."""
    height, width = int(x["height"]), int(x["width"])
    v, u = torch.meshgrid(torch.arange(height) + 0.5, torch.arange(width) + 0.5, indexing="ij")
    uv = torch.stack([u, v], -1).double()
    k = torch.zeros(3, 3, dtype=torch.float64)
    k[0, 0], k[1, 1], k[0, 2], k[1, 2], k[2, 2] = x["focal"], x["focal"], x["cx"], x["cy"], 1.0
    poses = x["c2w"].expand(height * width, 4, 4)
    rays = pixel_to_ray.in_torch({"K": k, "c2w": poses, "uv": uv.reshape(-1, 2)})
    return {"uv": uv} | {name: value.reshape(height, width, 3) for name, value in rays.items()}
