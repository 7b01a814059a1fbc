"""image_rays(height, width, focal, cx, cy, c2w): pixel_to_ray through every pixel's center, uv[j, i] = (i + 0.5, j + 0.5)."""

import numpy as np
import torch
from kornia.nerf.samplers import UniformRaySampler

from . import pixel_to_ray, reals
from .fixture import Case, Draw
from .reals import Real

NAME, PURPOSE = "image_rays", 1004
DIFFERENTIABLE = KORNIA_DIFFERENTIABLE = ()


def cases():
    """Pictures that are not square, with their center off the middle."""
    for name, height, width, cx, comment in [
        ("wide", 3, 5, 2.75, "swapped height and width show"),
        ("tall", 4, 2, 1.0, "center in the middle"),
        ("one-pixel", 1, 1, 0.5, "the pixel looks down the axis"),
    ]:
        inputs = {"height": height, "width": width, "focal": 4.375, "cx": cx, "cy": 0.5 * height}
        yield Case(name, inputs | {"c2w": pixel_to_ray.poses(Draw(PURPOSE, name), 1)[0]}, comment)


def kornia_cases():
    """UniformRaySampler: integer pixels; rays begin on the plane z = near and are as long as the way to z = far."""
    inputs = {
        "height": 3,
        "width": 4,
        "focal": 4.375,
        "cx": 1.75,
        "cy": 1.5,
        "c2w": pixel_to_ray.poses(Draw(PURPOSE, "kornia"), 1)[0],
    }
    conventions = {"pixel_center": "integer", "directions": "depth"}
    quirks = {"rays_from_near_to_far": [2.0, 6.0], "homogeneous_eps": 1e-8}
    yield Case("uniform-sampler", inputs, "calc_ray_params over all pixels", conventions=conventions, quirks=quirks)


def over_reals(x):
    """The definition, pixel by pixel."""
    height, width = int(x["height"].item().value), int(x["width"].item().value)
    zero, one = Real(0), Real(1)
    focal, cx, cy = x["focal"].item(), x["cx"].item(), x["cy"].item()
    k = np.array([[focal, zero, cx], [zero, focal, cy], [zero, zero, one]], dtype=object)
    uv, rays_o, rays_d = (np.empty((height, width, n), object) for n in (2, 3, 3))
    center = 0.0 if x["conventions"].get("pixel_center") == "integer" else 0.5
    unit = x["conventions"].get("directions") != "depth"
    for j, i in np.ndindex(height, width):
        uv[j, i] = [Real(i + center), Real(j + center)]
        rays_o[j, i] = x["c2w"][:3, 3]
        rays_d[j, i] = pixel_to_ray.direction(k, x["c2w"], uv[j, i], unit)
        if "rays_from_near_to_far" in x["quirks"]:
            rays_o[j, i], rays_d[j, i] = kornia_ray(rays_o[j, i], rays_d[j, i], x["quirks"])
    return {"uv": uv, "rays_o": rays_o, "rays_d": rays_d}


def kornia_ray(o, d, quirks):
    """From the plane z = near to the plane z = far, both points divided by 1 + eps."""
    near, far = quirks["rays_from_near_to_far"]
    scale = Real(1 + reals.mpf(quirks["homogeneous_eps"]))
    return [(a + b * near) / scale for a, b in zip(o, d)], [b * (far - near) / scale for b in d]


def in_torch(x):
    """A mesh of centers, then the batched rays."""
    height, width = int(x["height"]), int(x["width"])
    v, u = torch.meshgrid(torch.arange(height) + 0.5, torch.arange(width) + 0.5, indexing="ij")
    uv = torch.stack([u, v], -1).double()
    k = torch.zeros(3, 3, dtype=torch.float64)
    k[0, 0], k[1, 1], k[0, 2], k[1, 2], k[2, 2] = x["focal"], x["focal"], x["cx"], x["cy"], 1.0
    poses = x["c2w"].expand(height * width, 4, 4)
    rays = pixel_to_ray.in_torch({"K": k, "c2w": poses, "uv": uv.reshape(-1, 2)})
    return {"uv": uv} | {name: value.reshape(height, width, 3) for name, value in rays.items()}


def in_kornia(x):
    """kornia.nerf.samplers.UniformRaySampler on a PinholeCamera, whose extrinsics are world to camera."""
    near, far = x["quirks"]["rays_from_near_to_far"]
    height, width = int(x["height"]), int(x["width"])
    camera = pixel_to_ray.kornia_camera(x["focal"], x["focal"], x["cx"], x["cy"], x["c2w"], height, width)
    sampler = UniformRaySampler(near, far, ndc=False, device="cpu", dtype=torch.float64)
    sampler.calc_ray_params(camera)
    shape = (height, width, 3)
    uv = sampler.points_2d.double().reshape(height, width, 2)
    return {"uv": uv, "rays_o": sampler.origins.reshape(shape), "rays_d": sampler.directions.reshape(shape)}
