"""Points, boxes and grids."""

import adapters.nerfacc as nerfacc_
import cv2
import kornia
import numpy as np
import torch
import trimesh
from bases import beside, of_convention, plain
from gsplat.cuda._torch_impl import _world_to_cam
from nerfacc.grid import _ray_aabb_intersect
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


@beside(
    "ndc_rays",
    "trimesh",
    "transformations.clip_matrix",
    "OpenGL's frustum to 1e30, of the moved origin and of the direction's end",
    of_convention(ndc_depth="positive"),
    within=2**14,
)
def ndc_rays(rays_o, rays_d, width, height, focal, near):
    """The cube's point on the near plane, and from there to the one at infinity, by homogeneous coordinates."""
    x, y = near * width / (2 * focal), near * height / (2 * focal)
    frustum = torch.from_numpy(trimesh.transformations.clip_matrix(-x, x, -y, y, near, 1e30, perspective=True))
    start = rays_o + ((near - rays_o[:, 2]) / rays_d[:, 2])[:, None] * rays_d
    seen = [torch.nn.functional.pad(p, (0, 1), value=w) @ frustum.T for p, w in ((start, 1.0), (rays_d, 0.0))]
    start, end = (p[:, :3] / p[:, 3:] for p in seen)
    return {"rays_o_ndc": start, "rays_d_ndc": end - start}


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


def in_no_plane(case, x):
    """Rays that lie in no plane between cells: 0 / 0 there."""
    return not np.any((x["rays_d"] == 0) & (x["rays_o"] * x["resolution"] % 1 == 0))


@beside("grid_traversal", "nerfacc", "_ray_aabb_intersect", "of every cell's box, none of them skipped", in_no_plane)
def grid_traversal(rays_o, rays_d, near, far, resolution):
    """Index [z, y, x]; a length is how far both ends are apart."""
    z, y, x = torch.meshgrid(3 * [torch.arange(resolution)], indexing="ij")
    low = torch.stack([x, y, z], -1).reshape(-1, 3).to(rays_o)
    boxes = torch.cat([low, low + 1], -1) / resolution
    t_near, t_far, hit = _ray_aabb_intersect(rays_o, rays_d, boxes, near, far)
    lengths = torch.where(hit, t_far - t_near, 0).reshape(-1, *3 * [resolution])
    return {"lengths": lengths, "visited": (lengths > 0).sum((1, 2, 3))}
