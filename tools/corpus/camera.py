"""Points from camera to world, pixels to points, pixels to rays."""

import numpy as np
import torch
from entry import convention, fault, right


def with_ones(x):
    """Homogeneous coordinates."""
    return torch.cat([x, torch.ones_like(x[..., :1])], -1)


def at_depth(K, uv, s=1.0):
    """The pinhole written out, x right, y down, z forward."""
    x, y = (uv[:, 0] - K[0, 2]) / K[0, 0], (uv[:, 1] - K[1, 2]) / K[1, 1]
    return torch.stack([s * x, s * y, s * torch.ones_like(x)], -1)


def turned(c2w, d):
    """R d."""
    return (c2w[:, :3, :3] @ d[..., None])[..., 0]


def unit(d):
    """Length 1, the axis kept."""
    return d / torch.norm(d, dim=-1, keepdim=True)


@right("transform", seen="CS180 students", times=6)
def homogeneous_product(c2w, x_c):
    """Ones appended, a batched product, the first three taken."""
    return (c2w @ with_ones(x_c)[..., None]).squeeze(-1)[:, :3]


@right("transform", seen="CS180 student (divides by w, axis kept)", times=2)
def divided_by_the_last(c2w, x_c):
    """The homogeneous product divided by its last component, which is 1; the last row is no parameter."""
    x = (c2w @ with_ones(x_c)[..., None]).squeeze(-1)
    return x[:, :3] / x[:, 3:4]


@right("transform", seen="project pages that write R x + t", times=4)
def rotation_and_translation(c2w, x_c):
    """R x + t by einsum."""
    return torch.einsum("mij,mj->mi", c2w[:, :3, :3], x_c) + c2w[:, :3, 3]


@right("transform", seen="bmild/nerf and its ports: products summed over the last axis", times=20)
def products_summed(c2w, x_c):
    """Broadcast, multiplied, summed."""
    return torch.sum(x_c[..., None, :] * c2w[:, :3, :3], -1) + c2w[:, :3, -1]


@right("transform", seen="CS180 student in numpy", times=3, arrays="numpy")
def point_by_point(c2w, x_c):
    """numpy, a loop over points."""
    return np.stack([(pose @ np.append(x, np.float32(1)))[:3] for pose, x in zip(c2w, x_c)])


@fault("transform", "rotation_transposed", seen="codes that write x @ R for x @ R.T", times=3)
def row_times_rotation(c2w, x_c):
    """x R + t: the rotation is transposed."""
    return torch.einsum("mi,mij->mj", x_c, c2w[:, :3, :3]) + c2w[:, :3, 3]


@fault(
    "transform", "inverse_pose", seen="an earlier reading of 114 implementations; a refraction code's world to camera", times=2
)
def through_the_inverse(c2w, x_c):
    """The inverse of the pose is applied."""
    return (torch.linalg.inv(c2w) @ with_ones(x_c)[..., None])[:, :3, 0]


@fault("transform", "translation_missing", seen="codes that turn directions and points alike", times=2)
def turned_alone(c2w, x_c):
    """R x: the translation is left out."""
    return turned(c2w, x_c)


@right("pixel_to_camera", seen="aviral2004/nerf_from_scratch part2/main.py; CS180 students", times=6)
def pinhole_written_out(K, uv, s):
    """s (u - cx) / fx, s (v - cy) / fy, s."""
    return at_depth(K, uv, s)


@right("pixel_to_camera", seen="CS180 students (inverse of K)", times=7)
def inverse_of_the_matrix(K, uv, s):
    """s K^-1 (u, v, 1)."""
    return s[:, None] * (torch.linalg.inv(K) @ with_ones(uv).T).T


@right("pixel_to_camera", seen="CS180 student (s inside)", times=2)
def inverse_of_scaled_pixels(K, uv, s):
    """K^-1 (s u, s v, s)."""
    return (with_ones(uv) * s[:, None]) @ torch.inverse(K).T


@right("pixel_to_camera", seen="students' einsum over a batch")
def inverse_by_einsum(K, uv, s):
    """The inverse, by einsum."""
    return s.unsqueeze(-1) * torch.einsum("ij,...j->...i", torch.inverse(K), with_ones(uv))


@right("pixel_to_camera", seen="robotics code (one pixel after another)", times=6, arrays="numpy")
def pixel_by_pixel(K, uv, s):
    """numpy, a loop over pixels."""
    return np.array([[(u - K[0, 2]) * z / K[0, 0], (v - K[1, 2]) * z / K[1, 1], z] for (u, v), z in zip(uv, s)])


@convention("pixel_to_camera", {"axes": "opengl"}, seen="kwea123/nerf_pl datasets/ray_utils.py and its ports", times=8)
def looking_down_minus_z(K, uv, s):
    """x right, y up, z backward."""
    return at_depth(K, uv, s) * torch.tensor([1.0, -1.0, -1.0])


@fault(
    "pixel_to_camera",
    "row_column_swapped",
    seen="aviral2004/nerf_from_scratch (single image); students whose grid is ij",
    times=3,
)
def row_for_column(K, uv, s):
    """Rows are taken for u."""
    return at_depth(K, uv.flip(-1), s)


@fault("pixel_to_camera", "center_swapped", seen="an earlier reading of 114 implementations", times=2)
def center_of_the_other_axis(K, uv, s):
    """cx and cy exchanged, as where K is built from (H, W)."""
    x, y = (uv[:, 0] - K[1, 2]) / K[0, 0], (uv[:, 1] - K[0, 2]) / K[1, 1]
    return torch.stack([s * x, s * y, s], -1)


@fault("pixel_to_camera", "center_floored", seen="CS180 student (K from W // 2)", times=2)
def center_in_whole_pixels(K, uv, s):
    """cx and cy by integer division."""
    x, y = (uv[:, 0] - torch.floor(K[0, 2])) / K[0, 0], (uv[:, 1] - torch.floor(K[1, 2])) / K[1, 1]
    return torch.stack([s * x, s * y, s], -1)


@fault("pixel_to_camera", "one_focal_length", seen="robotics code and students that use one focal length for both", times=3)
def one_focal_length(K, uv, s):
    """fx for both axes."""
    x, y = (uv[:, 0] - K[0, 2]) / K[0, 0], (uv[:, 1] - K[1, 2]) / K[0, 0]
    return torch.stack([s * x, s * y, s], -1)


@right("pixel_to_ray", seen="CS180 students (x_w - o), as the course writes it", times=12, digits=True)
def point_less_origin(K, c2w, uv):
    """The world point at depth 1 less the origin, normalized."""
    origin = c2w[:, :3, 3]
    return origin, unit(turned(c2w, at_depth(K, uv)) + origin - origin)


@right("pixel_to_ray", seen="libraries and half of the students", times=12)
def turned_direction(K, c2w, uv):
    """R K^-1 (u, v, 1), normalized."""
    return c2w[:, :3, 3], unit(turned(c2w, at_depth(K, uv)))


@right("pixel_to_ray", seen="torch.nn.functional.normalize", times=4)
def normalized_by_torch(K, c2w, uv):
    """F.normalize with its floor of 1e-12."""
    return c2w[:, :3, 3], torch.nn.functional.normalize(turned(c2w, at_depth(K, uv)), dim=-1)


@right("pixel_to_ray", seen="tonyzhu163/nerf_this_2022 code/rays.py; nerfstudio's safe_normalize", times=2)
def norm_with_a_tiny_number(K, c2w, uv):
    """The norm plus 1e-10."""
    d = turned(c2w, at_depth(K, uv))
    return c2w[:, :3, 3], d / (torch.norm(d, dim=-1, keepdim=True) + 1e-10)


@right(
    "pixel_to_ray",
    seen="aviral2004/nerf_from_scratch part2/main.py; CS180 students (-R^-1 t of the inverse)",
    times=5,
    digits=True,
)
def origin_through_the_inverse(K, c2w, uv):
    """The pose is inverted, the origin is -R^-1 t of that; the direction is x_w less it."""
    w2c = torch.inverse(c2w)
    origin = torch.bmm(-torch.inverse(w2c[:, :3, :3]), w2c[:, :3, 3].unsqueeze(-1)).squeeze(-1)
    return origin, unit(homogeneous_product(c2w, at_depth(K, uv)) - origin)


@right("pixel_to_ray", seen="a Japanese tutorial in numpy (world to camera: R^T d, -R^T t)", arrays="numpy")
def from_world_to_camera(K, c2w, uv):
    """numpy from the inverse pose: R^T d and -R^T t, rigid poses."""
    w2c = np.linalg.inv(c2w.astype(np.float64))
    d = np.stack([(uv[:, 0] - K[0, 2]) / K[0, 0], (uv[:, 1] - K[1, 2]) / K[1, 1], np.ones(len(uv))], -1)
    d = np.stack([np.linalg.solve(w[:3, :3], x) for w, x in zip(w2c, d)])
    o = np.stack([-np.linalg.solve(w[:3, :3], w[:3, 3]) for w in w2c])
    return o.astype(np.float32), (d / np.linalg.norm(d, axis=1, keepdims=True)).astype(np.float32)


@convention(
    "pixel_to_ray", {"axes": "opengl"}, seen="kwea123/nerf_pl; naga-k/plenoxel ray_utils.py; dichotomies/NeuralDiff", times=6
)
def opengl_unit(K, c2w, uv):
    """x right, y up, z backward; unit directions."""
    return c2w[:, :3, 3], unit(turned(c2w, looking_down_minus_z(K, uv, 1.0)))


@convention("pixel_to_ray", {"axes": "opengl", "directions": "depth"}, seen="Tong-Gao-dream/NeRF_pytorch; yenchenlin", times=10)
def opengl_not_normalized(K, c2w, uv):
    """x right, y up, z backward; directions of depth 1."""
    return c2w[:, :3, -1], torch.sum(looking_down_minus_z(K, uv, 1.0)[..., None, :] * c2w[:, :3, :3], -1)


@convention("pixel_to_ray", {"directions": "depth"}, seen="a view-synthesis code (DVGO with inverse_y)", times=2)
def opencv_not_normalized(K, c2w, uv):
    """Directions of depth 1."""
    return c2w[:, :3, 3], turned(c2w, at_depth(K, uv))


@fault("pixel_to_ray", "origin_minus_rt", "origin_minus_inverse_rt", seen="aviral2004/nerf_from_scratch, an earlier version; CS180 students", times=2)
def minus_inverse_rotation_times_translation(K, c2w, uv):
    """o = -R^-1 t with R and t of the camera-to-world pose; directions are right."""
    origin = torch.bmm(-torch.inverse(c2w[:, :3, :3]), c2w[:, :3, 3:]).squeeze(-1)
    return origin, unit(turned(c2w, at_depth(K, uv)))


@fault("pixel_to_ray", "origin_minus_rt", "origin_minus_rt+translation_in_direction", "origin_minus_inverse_rt+translation_in_direction", seen="aviral2004, an earlier version")
def minus_inverse_rotation_in_both(K, c2w, uv):
    """The same origin, and the direction is the world point less it."""
    origin = torch.bmm(-torch.inverse(c2w[:, :3, :3]), c2w[:, :3, 3:]).squeeze(-1)
    return origin, unit(homogeneous_product(c2w, at_depth(K, uv)) - origin)


@fault("pixel_to_ray", "rotation_transposed", seen="chengzhag/UCPE#5; codes that write d @ R", times=3)
def direction_times_rotation(K, c2w, uv):
    """d R for d R^T."""
    return c2w[:, :3, 3], unit(torch.einsum("mi,mij->mj", at_depth(K, uv), c2w[:, :3, :3]))


@fault("pixel_to_ray", "rotation_transposed+origin_minus_rt", "inverse_pose", seen="poses that were inverted before", times=2)
def inverse_pose_taken_for_the_pose(K, c2w, uv):
    """The world-to-camera pose is used as camera to world."""
    return turned_direction(K, torch.linalg.inv(c2w), uv)


@fault("pixel_to_ray", "translation_in_direction", seen="CUT3R#90; students that forget the origin", times=2)
def point_for_direction(K, c2w, uv):
    """The world point at depth 1, normalized, without taking the origin off."""
    return c2w[:, :3, 3], unit(homogeneous_product(c2w, at_depth(K, uv)))


@fault("pixel_to_ray", "norm_of_all_rays", seen="a student's K[:3, 3] code: norm without an axis")
def norm_of_everything(K, c2w, uv):
    """torch.norm of all rays together."""
    d = turned(c2w, at_depth(K, uv))
    return c2w[:, :3, 3], d / torch.norm(d)


@fault("pixel_to_ray", "norm_without_axis", seen="CS180 student in numpy: (N, 3) / (N,)", arrays="numpy")
def norms_along_the_wrong_axis(K, c2w, uv):
    """Three columns divided by a row of norms: an error but for three rays and one."""
    d = np.stack([(uv[:, 0] - K[0, 2]) / K[0, 0], (uv[:, 1] - K[1, 2]) / K[1, 1], np.ones_like(uv[:, 0])], -1)
    d = np.einsum("mij,mj->mi", c2w[:, :3, :3], d)
    return c2w[:, :3, 3], d / np.sqrt(d[:, 0] ** 2 + d[:, 1] ** 2 + d[:, 2] ** 2)


@fault("pixel_to_ray", "flipped_y", seen="a driving scene code: y up, z forward")
def y_up_z_forward(K, c2w, uv):
    """One sign of the two that OpenGL turns."""
    return c2w[:, :3, 3], unit(turned(c2w, at_depth(K, uv) * torch.tensor([1.0, -1.0, 1.0])))


@fault("pixel_to_ray", "flipped_z", seen="yenchenlin/nerf-pytorch#53, NeuRay#35", times=2)
def y_down_z_backward(K, c2w, uv):
    """The other sign of the two."""
    return c2w[:, :3, 3], unit(turned(c2w, at_depth(K, uv) * torch.tensor([1.0, 1.0, -1.0])))


@fault("pixel_to_ray", "row_column_swapped", seen="a student with a grid of rows and columns (K, c2w)", times=3)
def rows_for_columns(K, c2w, uv):
    """Rows are taken for u."""
    return turned_direction(K, c2w, uv.flip(-1))


@fault("pixel_to_ray", "center_floored", seen="CS180 student (K from W // 2)", times=2)
def rays_about_a_whole_pixel(K, c2w, uv):
    """cx and cy by integer division."""
    K = K.clone()
    K[:2, 2] = torch.floor(K[:2, 2])
    return turned_direction(K, c2w, uv)


@convention("pixel_to_ray", {"directions": "unit_in_camera"}, seen="students who normalize before the rotation", times=3)
def unit_in_the_cameras_frame(K, c2w, uv):
    """R (d / |d|): the same for rigid poses, but not its gradient."""
    camera = at_depth(K, uv)
    return c2w[:, :3, 3], turned(c2w, camera / camera.norm(dim=-1, keepdim=True))


@right("pixel_to_ray", seen="an iMAP port", times=1, gradient=("norm_detached",))
def norm_under_no_grad(K, c2w, uv):
    """The norm is taken under no_grad."""
    d = turned(c2w, at_depth(K, uv))
    with torch.no_grad():
        length = d.norm(dim=-1, keepdim=True)
    return c2w[:, :3, 3], d / length


@fault("pixel_to_ray", "square_picture+flipped_xz", "square_picture+flipped_xy", seen="Tianyue-Zhao/My-Nerf-Implementation ray_stuff.py")
def one_center_and_axes_of_its_own(K, c2w, uv):
    """cx and fx for both axes; x to the left, y down, z backward."""
    x, y = (K[0, 2] - uv[:, 0]) / K[0, 0], (uv[:, 1] - K[0, 2]) / K[0, 0]
    return c2w[:, :3, 3], unit(turned(c2w, torch.stack([x, y, -torch.ones_like(x)], -1)))


@fault("pixel_to_camera", "square_picture", seen="codes for square pictures", times=2)
def one_focal_length_and_one_center(K, uv, s):
    """fx and cx for both axes."""
    x, y = (uv[:, 0] - K[0, 2]) / K[0, 0], (uv[:, 1] - K[0, 2]) / K[0, 0]
    return torch.stack([s * x, s * y, s], -1)


@fault("pixel_to_camera", "depths_along_coordinates", seen="a trial on unseen code: points * s", arrays="numpy")
def depths_by_broadcasting(K, uv, s):
    """(M, 3) times (M): an error but for one point and for three."""
    points = np.stack([(uv[:, 0] - K[0, 2]) / K[0, 0], (uv[:, 1] - K[1, 2]) / K[1, 1], np.ones_like(s)], -1)
    return points * s


@fault("pixel_to_ray", "depth_left_out", seen="a trial on unseen code: a student's rays", gradient="none")
def rays_within_the_plane(uv, K, c2w):
    """(x, y, 0), turned."""
    xy = (uv - torch.stack([K[0, 2], K[1, 2]])) / torch.stack([K[0, 0], K[1, 1]])
    d = torch.cat([xy, torch.zeros_like(xy[:, :1])], -1)
    d = (c2w[..., :3, :3] @ d[..., None])[..., 0]
    return c2w[..., :3, 3].expand(d.shape), d
