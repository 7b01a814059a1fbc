"""pixel_to_ray(K, c2w, uv): o = c2w[:3, 3], d = v / |v| with v = R K^-1 (u, v, 1), R = c2w[:3, :3].

K^-1 (u, v, 1) = ((u - cx) / fx, (v - cy) / fy, 1): OpenCV axes, pixel centers are in uv already.
"""

import numpy as np
import torch
from kornia.geometry.camera import PinholeCamera
from kornia.nerf.nerf_model import NerfModelRenderer

from . import reals
from .fixture import Case, Draw

NAME, PURPOSE = "pixel_to_ray", 1003
KORNIA_DIFFERENTIABLE = ()
DIFFERENTIABLE = ("K", "c2w", "uv")


def cases():
    """A camera per ray, fx != fy, the center off the middle; poses that no capture should have (CG9)."""
    draw = Draw(PURPOSE, "random")
    yield case("random", intrinsics(), poses(draw, 6), draw.uniform((6, 2), 0.0, 100.0), "random poses, non-square pixels")
    identity = np.tile(np.eye(4), (3, 1, 1))
    corners = np.array([[32.5, 20.25], [0.5, 0.5], [99.5, 59.5]])
    yield case("identity", intrinsics(), identity, corners, "the principal point looks down +z exactly")
    draw = Draw(PURPOSE, "not-rigid-CG9")
    odd = poses(draw, 3)
    odd[0, :3, 0] *= -1.0
    odd[1, :3, :3] *= 2.0
    odd[2, 0, :3] += 0.25
    yield case("not-rigid-CG9", intrinsics(), odd, draw.uniform((3, 2), 0.0, 60.0), "det -1; scale 2; sheared")
    draw = Draw(PURPOSE, "far-away-CG9")
    far = poses(draw, 3)
    far[:, :3, 3] *= 1e6
    comment = "camera at 1e6: (x_w - o) has lost 6 digits, R K^-1 uv has lost none"
    yield case("far-away-CG9", intrinsics(), far, draw.uniform((3, 2), 0.0, 60.0), comment)


def kornia_cases():
    """NerfModelRenderer, right for a camera at the world's origin alone."""
    centered = poses(Draw(PURPOSE, "centered"), 1)
    centered[:, :3, 3] = 0.0
    corners = np.array([[0.0, 0.0], [3.0, 0.0], [0.0, 2.0], [3.0, 2.0]])
    k = intrinsics(4.5, 4.25, 1.75, 1.5)
    yield case("centered", k, np.tile(centered, (4, 1, 1)), corners, "camera at the origin: nothing to confuse")
    moved = np.tile(poses(Draw(PURPOSE, "moved"), 1), (4, 1, 1))
    wrong = case("moved", k, moved, corners, "camera elsewhere: the origin is that of the inverse pose, and directions follow it")
    wrong.quirks = {"origin_from_w2c": True, "homogeneous_eps": 1e-8}
    yield wrong


def case(name, k, c2w, uv, comment):
    """A case from its three arrays."""
    return Case(name, {"K": k, "c2w": c2w, "uv": uv}, comment)


def intrinsics(fx=81.25, fy=77.5, cx=32.5, cy=20.25):
    """A pinhole matrix."""
    return np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])


def poses(draw, count):
    """Rotations of random unit quaternions, rounded to f64, and translations within 4 of the origin."""
    c2w = np.zeros((count, 4, 4))
    q = draw.uniform((count, 4), -1.0, 1.0)
    w, x, y, z = (q / np.sqrt(q[:, 0] ** 2 + q[:, 1] ** 2 + q[:, 2] ** 2 + q[:, 3] ** 2)[:, None]).T
    c2w[:, 0, :3] = np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)], -1)
    c2w[:, 1, :3] = np.stack([2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)], -1)
    c2w[:, 2, :3] = np.stack([2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)], -1)
    c2w[:, :3, 3], c2w[:, 3, 3] = draw.uniform((count, 3), -4.0, 4.0), 1.0
    return c2w


def over_reals(x):
    """The definition, ray by ray."""
    count = len(x["uv"])
    rays_o, rays_d = np.empty((count, 3), object), np.empty((count, 3), object)
    if "origin_from_w2c" in x["quirks"]:
        return kornia_rays(x)
    for m in range(count):
        rays_o[m] = x["c2w"][m, :3, 3]
        rays_d[m] = direction(x["K"], x["c2w"][m], x["uv"][m])
    return {"rays_o": rays_o, "rays_d": rays_d}


def direction(k, c2w, uv, unit=True):
    """The direction through one pixel, of unit length or of depth 1."""
    camera = [(uv[0] - k[0, 2]) / k[0, 0], (uv[1] - k[1, 2]) / k[1, 1]]
    world = [reals.total([c2w[i, 0] * camera[0], c2w[i, 1] * camera[1], c2w[i, 2]]) for i in range(3)]
    if not unit:
        return world
    length = reals.sqrt(reals.dot(world, world))
    return [v / length for v in world]


def kornia_rays(x):
    """What NerfModelRenderer shoots: from o' = -R^T o, the translation of world to camera, through x_w / (1 + eps) at depth 1."""
    rays_o, rays_d = (np.empty((len(x["uv"]), 3), object) for _ in range(2))
    scale = reals.Real(1 + reals.mpf(x["quirks"]["homogeneous_eps"]))
    for m, (pose, uv) in enumerate(zip(x["c2w"], x["uv"])):
        world = direction(x["K"], pose, uv, unit=False)
        rays_o[m] = [-reals.dot(pose[:3, i], pose[:3, 3]) for i in range(3)]
        along = [(o + v) / scale - wrong for o, v, wrong in zip(pose[:3, 3], world, rays_o[m])]
        length = reals.sqrt(reals.dot(along, along))
        rays_d[m] = [v / length for v in along]
    return {"rays_o": rays_o, "rays_d": rays_d}


def in_torch(x):
    """Inverse intrinsics, rotation and normalization as batched tensor operations."""
    k, uv, rotation = x["K"], x["uv"], x["c2w"][:, :3, :3]
    centered = uv - torch.stack([k[0, 2], k[1, 2]])
    camera = centered / torch.stack([k[0, 0], k[1, 1]])
    camera = torch.cat([camera, torch.ones_like(camera[:, :1])], -1)
    world = torch.einsum("mij,mj->mi", rotation, camera)
    return {"rays_o": x["c2w"][:, :3, 3], "rays_d": torch.nn.functional.normalize(world, dim=-1, eps=0.0)}


def kornia_camera(fx, fy, cx, cy, c2w, height, width):
    """A batch of one PinholeCamera."""
    intrinsics_, extrinsics = torch.eye(4)[None], torch.eye(4)[None]
    intrinsics_[0, 0, 0], intrinsics_[0, 1, 1], intrinsics_[0, 0, 2], intrinsics_[0, 1, 2] = fx, fy, cx, cy
    extrinsics[0, :3, :3] = c2w[:3, :3].T
    extrinsics[0, :3, 3] = -c2w[:3, :3].T @ c2w[:3, 3]
    return PinholeCamera(intrinsics_, extrinsics, torch.tensor([height]), torch.tensor([width]))


def in_kornia(x):
    """kornia.nerf.nerf_model.NerfModelRenderer's rays through the corners of a picture of 3 x 4."""
    k = x["K"]
    camera = kornia_camera(k[0, 0], k[1, 1], k[0, 2], k[1, 2], x["c2w"][0], 3, 4)
    rays = NerfModelRenderer(None, (3, 4), None, torch.float64)._create_rays(camera)
    rows = [4 * int(v) + int(u) for u, v in x["uv"].tolist()]
    return {"rays_o": rays.origin[rows], "rays_d": rays.direction[rows]}
