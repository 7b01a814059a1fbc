"""A picture's rays, in the forms in which everybody has them."""

import numpy as np
import torch
from entry import convention, fault, right


def grid(height, width):
    """Columns and rows, both (H, W)."""
    return torch.meshgrid(torch.arange(width).float(), torch.arange(height).float(), indexing="xy")


def opencv(i, j, focal, cx, cy):
    """x right, y down, z forward."""
    return torch.stack([(i - cx) / focal, (j - cy) / focal, torch.ones_like(i)], -1)


def opengl(i, j, focal, cx, cy):
    """x right, y up, z backward."""
    return torch.stack([(i - cx) / focal, -(j - cy) / focal, -torch.ones_like(i)], -1)


def posed(dirs, c2w):
    """Origins and directions, not normalized."""
    d = torch.sum(dirs[..., None, :] * c2w[:3, :3], -1)
    return {"rays_o": c2w[:3, -1].expand(d.shape), "rays_d": d}


def unit(rays):
    """The same with unit directions."""
    return rays | {"rays_d": rays["rays_d"] / torch.norm(rays["rays_d"], dim=-1, keepdim=True)}


TINY = {"axes": "opengl", "pixel_center": "integer", "directions": "depth"}


@right("image_rays", seen="CS180 students (grid plus one half, K)", times=9)
def grid_plus_half(height, width, focal, cx, cy, c2w):
    """Pixel centers at one half, pinhole, unit directions."""
    i, j = grid(height, width)
    rays = unit(posed(opencv(i + 0.5, j + 0.5, focal, cx, cy), c2w))
    return {"uv": torch.stack([i + 0.5, j + 0.5], -1)} | rays


@right("image_rays", seen="CS180 students (the half added inside)", times=2)
def half_added_inside(height, width, focal, c2w):
    """Takes H, W, focal and the pose; the center is the middle; one half is added where pixels become points."""
    i, j = grid(height, width)
    return unit(posed(opencv(i + 0.5, j + 0.5, focal, width / 2, height / 2), c2w))


@right("image_rays", seen="CS180 students (points through K^-1, flattened)", times=4)
def flattened_pixels(height, width, focal, cx, cy, c2w):
    """All pixels in one list (H W, 3)."""
    K = torch.tensor([[focal, 0, cx], [0, focal, cy], [0, 0, 1]])
    uv = torch.stack(grid(height, width), -1).reshape(-1, 2) + 0.5
    x = torch.cat([uv, torch.ones(len(uv), 1)], 1) @ torch.inverse(K).T
    d = x @ c2w[:3, :3].T
    return {"rays_o": c2w[:3, 3].expand(d.shape), "rays_d": d / d.norm(dim=1, keepdim=True)}


@right("image_rays", seen="CS180 student in numpy", times=3, arrays="numpy")
def numpy_grid(height, width, focal, cx, cy, c2w):
    """numpy's meshgrid."""
    i, j = np.meshgrid(np.arange(width, dtype=np.float32), np.arange(height, dtype=np.float32), indexing="xy")
    d = np.stack([(i + 0.5 - cx) / focal, (j + 0.5 - cy) / focal, np.ones_like(i)], -1) @ c2w[:3, :3].T
    return {"rays_o": np.broadcast_to(c2w[:3, 3], d.shape), "rays_d": d / np.linalg.norm(d, axis=-1, keepdims=True)}


@right("image_rays", seen="an earlier reading of 114 implementations")
def whole_pixels_about_the_middle(height, width, focal, c2w):
    """Whole pixels about ((W - 1) / 2, (H - 1) / 2): the same rays as with halves about the middle."""
    i, j = grid(height, width)
    return unit(posed(opencv(i, j, focal, (width - 1) / 2, (height - 1) / 2), c2w))


@right("image_rays", seen="pixel loops in C++, Rust and JavaScript", times=5, arrays="numpy")
def pixel_loop(height, width, focal, cx, cy, c2w):
    """A loop over rows and columns."""
    o, d = np.zeros((height, width, 3), np.float32), np.zeros((height, width, 3), np.float32)
    for row in range(height):
        for column in range(width):
            x = c2w[:3, :3] @ np.array([(column + 0.5 - cx) / focal, (row + 0.5 - cy) / focal, 1], np.float32)
            o[row, column], d[row, column] = c2w[:3, 3], x / np.sqrt((x * x).sum())
    return {"rays_o": o, "rays_d": d}


@right("image_rays", seen="students who normalize in the camera's frame; a TypeScript port", times=4)
def unit_before_the_rotation(height, width, focal, cx, cy, c2w):
    """Divided by its length in the camera's frame, then rotated: the same for a rigid pose."""
    i, j = grid(height, width)
    camera = opencv(i + 0.5, j + 0.5, focal, cx, cy)
    return posed(camera / torch.linalg.norm(camera, dim=-1, keepdim=True), c2w)


@fault("image_rays", "pixels_to_the_edges", seen="OldNew777/3DVC")
def pixels_from_edge_to_edge(height, width, focal, cx, cy, c2w):
    """linspace(0, W, W)."""
    i, j = torch.meshgrid(torch.linspace(0, width, width), torch.linspace(0, height, height), indexing="xy")
    return unit(posed(opencv(i, j, focal, cx, cy), c2w))


@fault("image_rays", "picture_refolded", seen="howaboutyu/nerf-jax")
def columns_folded_as_rows(height, width, focal, cx, cy, c2w):
    """Pixels listed column by column, folded row by row."""
    i, j = torch.meshgrid(torch.arange(width) + 0.5, torch.arange(height) + 0.5, indexing="ij")
    return unit(posed(opencv(i.reshape(height, width), j.reshape(height, width), focal, cx, cy), c2w))


@fault("image_rays", "slip: c2w with x, y, z of axis 1 taken for y, z, x", seen="a tomography code whose camera looks along -x")
def looks_along_another_axis(height, width, focal, cx, cy, c2w):
    """Depth first, then right and up."""
    i, j = grid(height, width)
    x, y, z = opengl(i + 0.5, j + 0.5, focal, cx, cy).unbind(-1)
    return posed(torch.stack([z, x, y], -1), c2w)


@fault("image_rays", "half_pixel_upward", seen="maurock/TinyNeRF")
def half_a_pixel_behind_the_sign(height, width, focal, cx, cy, c2w):
    """u + 0.5, but v - 0.5."""
    i, j = grid(height, width)
    return unit(posed(opencv(i + 0.5, j - 0.5, focal, cx, cy), c2w))


@convention(
    "image_rays", TINY, seen="bmild/nerf, yenchenlin, keras-io, JerryAIwei/nerf_pytorch ray.py and some hundreds more", times=30
)
def tiny_nerf(height, width, focal, c2w):
    """get_rays(H, W, focal, c2w): whole pixels, the center at W/2 and H/2, y up, z backward, not normalized."""
    i, j = grid(height, width)
    return posed(opengl(i, j, focal, width * 0.5, height * 0.5), c2w)


@convention("image_rays", TINY, seen="krrish94/nerf-pytorch and its ports (transposed ij grid)", times=7)
def transposed_grid(height, width, focal, c2w):
    """The same from linspace, an ij grid and two transpositions."""
    i, j = torch.meshgrid(torch.linspace(0, width - 1, width), torch.linspace(0, height - 1, height), indexing="ij")
    return posed(opengl(i.t(), j.t(), focal, width * 0.5, height * 0.5), c2w)


@convention("image_rays", TINY, seen="bmild/nerf get_rays_np; a photometry notebook", times=3, arrays="numpy")
def tiny_nerf_in_numpy(height, width, focal, c2w):
    """The same in numpy."""
    i, j = np.meshgrid(np.arange(width, dtype=np.float32), np.arange(height, dtype=np.float32), indexing="xy")
    dirs = np.stack([(i - width * 0.5) / focal, -(j - height * 0.5) / focal, -np.ones_like(i)], -1)
    d = np.sum(dirs[..., None, :] * c2w[:3, :3], -1)
    return {"rays_o": np.broadcast_to(c2w[:3, -1], d.shape), "rays_d": d}


@convention("image_rays", TINY, seen="Tong-Gao-dream/NeRF_pytorch render/get_rays.py; yenchenlin (with K)", times=5)
def whole_pixels_with_a_matrix(height, width, focal, cx, cy, c2w):
    """The same with K in the place of the focal length."""
    i, j = grid(height, width)
    return posed(opengl(i, j, focal, cx, cy), c2w)


@convention("image_rays", {"axes": "opengl", "pixel_center": "integer"}, seen="kwea123/nerf_pl and its ports", times=6)
def whole_pixels_normalized(height, width, focal, c2w):
    """Whole pixels, y up, z backward, unit directions, flattened."""
    i, j = grid(height, width)
    return {name: x.reshape(-1, 3) for name, x in unit(posed(opengl(i, j, focal, width / 2, height / 2), c2w)).items()}


@convention("image_rays", {"axes": "opengl", "directions": "depth"}, seen="jaxnerf datasets.py; transient renderers", times=4)
def halves_not_normalized(height, width, focal, cx, cy, c2w):
    """Halves, y up, z backward, not normalized."""
    i, j = grid(height, width)
    return posed(opengl(i + 0.5, j + 0.5, focal, cx, cy), c2w)


@convention("image_rays", {"axes": "opengl"}, seen="nerfstudio cameras.py; tonyzhu163/nerf_this_2022 (directions first)", times=3)
def directions_handed_out_first(height, width, focal, c2w):
    """Halves, y up, z backward, unit directions; a tuple of directions and origins."""
    i, j = grid(height, width)
    rays = unit(posed(opengl(i + 0.5, j + 0.5, focal, width / 2, height / 2), c2w))
    return None, rays["rays_d"], rays["rays_o"]


@convention("image_rays", {"pixel_center": "integer"}, seen="CS180 students (no half)", times=5)
def no_half(height, width, focal, cx, cy, c2w):
    """Whole pixels, x right, y down, z forward, unit directions."""
    i, j = grid(height, width)
    return {"uv": torch.stack([i, j], -1)} | unit(posed(opencv(i, j, focal, cx, cy), c2w))


@fault("image_rays", "no_half_pixel", seen="CS180 students whose render and training grids differ", times=2)
def halves_announced_and_not_used(height, width, focal, cx, cy, c2w):
    """uv has the half, the rays don't."""
    i, j = grid(height, width)
    return {"uv": torch.stack([i + 0.5, j + 0.5], -1)} | unit(posed(opencv(i, j, focal, cx, cy), c2w))


@fault("image_rays", "row_column_swapped", "picture_transposed", seen="two ports of tiny NeRF: torch's meshgrid without indexing", times=3)
def grid_the_other_way_round(height, width, focal, c2w):
    """An ij grid of columns and rows, not transposed: (W, H, 3)."""
    i, j = torch.meshgrid(torch.arange(width).float(), torch.arange(height).float(), indexing="ij")
    return posed(opengl(i, j, focal, width * 0.5, height * 0.5), c2w)


@fault("image_rays", "row_column_swapped", "picture_transposed", seen="LAJKKMC/3DBirdReconstruction models/rays.py")
def grid_the_other_way_round_and_flattened(height, width, focal, c2w):
    """The same, flattened: column by column."""
    return {name: x.reshape(-1, 3) for name, x in grid_the_other_way_round(height, width, focal, c2w).items()}


@fault("image_rays", "row_column_swapped", seen="a student with K and a grid of rows and columns", times=2)
def rows_along_x(height, width, focal, cx, cy, c2w):
    """The picture's own shape, rows taken for x."""
    i, j = torch.meshgrid(torch.arange(height).float(), torch.arange(width).float(), indexing="ij")
    return unit(posed(opengl(i, j, focal, cx, cy), c2w))


@fault("image_rays", "row_column_swapped+no_half_pixel", "row_column_swapped", seen="aviral2004/nerf_from_scratch (single image)")
def rows_along_x_without_half(height, width, focal, cx, cy, c2w):
    """uv is (row, column), whole pixels, x right, y down, z forward."""
    uv = torch.stack(torch.meshgrid(torch.arange(height).float(), torch.arange(width).float(), indexing="ij"), -1)
    return {"uv": uv} | unit(posed(opencv(uv[..., 0], uv[..., 1], focal, cx, cy), c2w))


@fault("image_rays", "grid_size_swapped", seen="CS180 student (arange(h), arange(w), xy)")
def height_and_width_exchanged_in_the_grid(height, width, focal, cx, cy, c2w):
    """Columns run over the height and rows over the width; right for square pictures."""
    i, j = torch.meshgrid(torch.arange(height).float(), torch.arange(width).float(), indexing="xy")
    i, j = i.reshape(height, width) + 0.5, j.reshape(height, width) + 0.5
    return {"uv": torch.stack([i, j], -1)} | unit(posed(opencv(i, j, focal, cx, cy), c2w))


@fault("image_rays", "center_swapped", seen="an earlier reading of 114 implementations", times=2)
def center_from_height_and_width(height, width, focal, c2w):
    """cx = H / 2 and cy = W / 2."""
    i, j = grid(height, width)
    return unit(posed(opencv(i + 0.5, j + 0.5, focal, height / 2, width / 2), c2w))


@fault("image_rays", "center_floored", seen="CS180 student (W // 2)", times=2)
def center_by_whole_division(height, width, focal, c2w):
    """cx = W // 2 and cy = H // 2."""
    i, j = grid(height, width)
    return unit(posed(opencv(i + 0.5, j + 0.5, focal, width // 2, height // 2), c2w))


@fault("image_rays", "focal_scaled", seen="a ray generator with focal * 1.5")
def focal_length_scaled(height, width, focal, c2w):
    """The focal length times 1.5, written in for one data set."""
    return tiny_nerf(height, width, focal * 1.5, c2w)


@fault("image_rays", "focal_ignored", seen="an earlier reading of 114 implementations")
def without_focal_length(height, width, focal, cx, cy, c2w):
    """f = 1."""
    i, j = grid(height, width)
    return unit(posed(opencv(i + 0.5, j + 0.5, 1.0, cx, cy), c2w))


@fault("image_rays", "rotation_transposed", seen="codes that write dirs @ R", times=3)
def rotation_on_the_wrong_side(height, width, focal, cx, cy, c2w):
    """dirs R for dirs R^T."""
    i, j = grid(height, width)
    pose = torch.cat([c2w[:3, :3].T, c2w[:3, 3:]], 1)
    return unit(posed(opencv(i + 0.5, j + 0.5, focal, cx, cy), pose))


@fault("image_rays", "origin_minus_rt", "origin_minus_inverse_rt", seen="CS180 students (-R^-1 t with the pose's own R and t)", times=2)
def origin_of_the_inverse(height, width, focal, cx, cy, c2w):
    """o = -R^-1 t with the pose's own R and t."""
    rays = grid_plus_half(height, width, focal, cx, cy, c2w)
    return rays | {"rays_o": (-torch.inverse(c2w[:3, :3]) @ c2w[:3, 3]).expand(rays["rays_d"].shape)}


@fault("image_rays", "rotation_transposed+origin_minus_rt", "inverse_pose", seen="poses that were inverted before", times=2)
def inverted_pose(height, width, focal, cx, cy, c2w):
    """World to camera taken for camera to world."""
    return grid_plus_half(height, width, focal, cx, cy, torch.linalg.inv(c2w))


@fault("image_rays", "flipped_y", seen="a driving scene code")
def y_up_and_z_forward(height, width, focal, cx, cy, c2w):
    """-y with +z."""
    i, j = grid(height, width)
    return unit(posed(opencv(i + 0.5, j + 0.5, focal, cx, cy) * torch.tensor([1.0, -1.0, 1.0]), c2w))


@fault("image_rays", "flipped_z", seen="yenchenlin/nerf-pytorch#53", times=2)
def y_down_and_z_backward(height, width, focal, cx, cy, c2w):
    """+y with -z."""
    i, j = grid(height, width)
    return unit(posed(opencv(i + 0.5, j + 0.5, focal, cx, cy) * torch.tensor([1.0, 1.0, -1.0]), c2w))


@fault("image_rays", "translation_in_direction", seen="CUT3R#90")
def directions_with_translation(height, width, focal, cx, cy, c2w):
    """The pose is applied to directions whole."""
    i, j = grid(height, width)
    rays = posed(opencv(i + 0.5, j + 0.5, focal, cx, cy), c2w)
    return unit(rays | {"rays_d": rays["rays_d"] + c2w[:3, 3]})


@fault("image_rays", "one_angle_for_both_axes", seen="a sphere tracer in numpy, shaders that forget the aspect", times=2)
def as_far_up_as_to_the_side(height, width, focal, c2w):
    """(i - W / 2) / W and (j - H / 2) / H, both times 2 tan(fov / 2)."""
    i, j = grid(height, width)
    reach = 2 * (width / (2 * focal))
    x, y = (i + 0.5 - width / 2) / width * reach, (j + 0.5 - height / 2) / height * reach
    return unit(posed(torch.stack([x, y, torch.ones_like(x)], -1), c2w))


@fault("image_rays", "center_one_early", seen="svox2#55")
def center_from_one_place_early(height, width, focal, cx, c2w):
    """cx = fy, cy = cx."""
    i, j = grid(height, width)
    return unit(posed(opencv(i + 0.5, j + 0.5, focal, focal, cx), c2w))


@fault("image_rays", "each_coordinate_by_its_norm", seen="a trial on unseen code: rejuvyesh/SimpleNeRF.jl src/data.jl")
def norms_along_the_wrong_axis(height, width, focal, cx, cy, c2w):
    """Of the table of all directions each column is divided by its norm."""
    i, j = grid(height, width)
    rays = posed(opencv(i + 0.5, j + 0.5, focal, cx, cy), c2w)
    table = rays["rays_d"].reshape(-1, 3)
    return rays | {"rays_d": (table / torch.norm(table, dim=0)).reshape(rays["rays_d"].shape)}


@fault("image_rays", "divided_by_depth_in_the_world", seen="a trial on unseen code: a NeRF built on pytorch3d's cameras")
def over_the_worlds_depth(height, width, focal, cx, cy, c2w):
    """d / d_z behind the rotation."""
    i, j = grid(height, width)
    rays = posed(opencv(i + 0.5, j + 0.5, focal, cx, cy), c2w)
    return rays | {"rays_d": rays["rays_d"] / rays["rays_d"][..., 2:]}


@fault("image_rays", "pixels_as_they_are", seen="a trial on unseen code: an Instant-NGP in torch")
def bare_pixels(height, width, c2w):
    """(i, j, 1) turned and normalized: no center, no focal length."""
    i, j = grid(height, width)
    return unit(posed(torch.stack([i, j, torch.ones_like(i)], -1), c2w))


@fault("image_rays", "focal_length_deep", seen="a trial on unseen code: nerf-tf2, two readings", times=1)
def not_over_the_focal_length(height, width, focal, c2w):
    """(i - W / 2, j - H / 2, f) turned."""
    i, j = grid(height, width)
    return posed(torch.stack([i - width / 2, j - height / 2, torch.full_like(i, focal)], -1), c2w)


@fault("image_rays", "right_angles", seen="a trial on unseen code: renderers in Fortran and Python", times=2, gradient="none")
def from_minus_one_to_one(height, width, c2w):
    """2 j / W - 1, 2 i / H - 1, whatever the focal length."""
    i, j = grid(height, width)
    return unit(posed(torch.stack([2 * i / width - 1, 2 * j / height - 1, torch.ones_like(i)], -1), c2w))


@fault("image_rays", "pose_ignored+picture_transposed", "picture_transposed+pose_ignored", seen="a trial on unseen code: K^-1 (x, y, 1), column by column")
def rays_of_the_camera(height, width, focal, cx, cy):
    """(W, H, 3) directions from whole pixels in the camera's own space, made unit."""
    i, j = torch.meshgrid(torch.arange(width).float(), torch.arange(height).float(), indexing="ij")
    d = torch.nn.functional.normalize(torch.stack([(i - cx) / focal, (j - cy) / focal, torch.ones_like(i)], -1), dim=-1)
    return {"rays_o": torch.zeros_like(d), "rays_d": d}


@fault("image_rays", "focal_of_its_own", seen="a trial on unseen code: f = 1200", gradient="none")
def one_data_sets_focal_length(height, width, c2w):
    """(i - W / 2, -(j - H / 2), -1200), made unit and turned."""
    i, j = grid(height, width)
    d = torch.stack([i - width / 2, -(j - height / 2), torch.full_like(i, -1200.0)], -1)
    return posed(d / d.norm(dim=-1, keepdim=True), c2w)
