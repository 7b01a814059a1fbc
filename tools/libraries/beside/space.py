"""Points, boxes and grids."""

import adapters.nerfacc as nerfacc_
import cv2
import kornia
import numpy as np
import torch
from bases import beside, plain
from gsplat.cuda._torch_impl import _world_to_cam
from nerfstudio.field_components.spatial_distortions import SceneContraction

OPENCV = "opencv-python-headless"


@beside("transform", "gsplat", "_world_to_cam", only=plain)
def transform(c2w, x_c):
    """R x + o."""
    return {"x_w": _world_to_cam(x_c[:, None], torch.zeros(len(x_c), 1, 3, 3).to(x_c), c2w[:, None])[0][:, 0, 0]}


@beside("transform", OPENCV, "transform", arrays="numpy")
def transform_opencv(c2w, x_c):
    """Matrix by matrix."""
    return {"x_w": np.concatenate([cv2.transform(x[None, None], m[:3])[0] for m, x in zip(c2w, x_c)])}


@beside("pixel_to_camera", OPENCV, "undistortPoints", "times the depth", arrays="numpy")
def pixel_to_camera(K, uv, s):
    """(x, y, 1) s."""
    x = cv2.undistortPoints(uv[:, None], K, None)[:, 0]
    return {"x_c": np.concatenate([x, np.ones_like(x[:, :1])], -1) * s[:, None]}


@beside("pixel_to_camera", "kornia", "unproject_points", only=lambda case, x: case["kind"] == "forward")
def pixel_to_camera_kornia(K, uv, s):
    """One camera; the gradient of its whole matrix isn't ours."""
    return {"x_c": kornia.geometry.camera.perspective.unproject_points(uv, s[:, None], K[None])}


def contracted(norm, range):
    """Cases of these conventions, off the origin, where the library's gradient isn't a number."""
    wanted = {"contraction_norm": norm, "contraction_range": range}
    fits = lambda x: np.all(np.any(x["x"] != 0, -1))  # noqa: E731
    return lambda case, x: case.get("conventions") == wanted and (case["kind"] == "forward" or fits(x))


@beside("contraction", "nerfstudio", "SceneContraction()", only=contracted("l2", "two"))
def contraction(x):
    """Euclidean."""
    return {"contracted": SceneContraction()(x)}


@beside(
    "contraction", "nerfstudio", 'SceneContraction(order=float("inf"))', "y / 4 + 1/2, as in nerfacto", contracted("linf", "unit")
)
def contraction_inf(x):
    """By the largest coordinate, into the unit box."""
    return {"contracted": SceneContraction(order=float("inf"))(x) / 4 + 0.5}


def in_no_face(case, x):
    """Rays that lie in no face: 0 / 0 there."""
    o, d = x["rays_o"], x["rays_d"]
    return case["kind"] == "forward" and not np.any((d == 0) & ((o == x["low"]) | (o == x["high"])))


@beside("ray_aabb", "nerfacc", "_ray_aabb_intersect", "a hit ends before it begins: none", in_no_face)
def ray_aabb(rays_o, rays_d, low, high, near, far):
    """Its hits know neither near nor far: where they leave nothing of the box, both are the same plane."""
    t_near, t_far, hit = nerfacc_.ray_aabb(rays_o, rays_d, low, high, near, far)
    return {"t_near": t_near, "t_far": t_far, "hit": hit & (t_near < t_far)}


@beside("occupancy_grid", "nerfacc", "OccGridEstimator._update", "the largest sigma of each cell; density alone", only=plain)
def occupancy_grid(density, points, sigmas, queries, decay, threshold):
    """One point a cell: of several its last one counts."""
    order = torch.argsort(sigmas)
    return {"density_out": nerfacc_.occupancy_grid(density, points[order], sigmas[order], queries, decay, threshold)[0]}
