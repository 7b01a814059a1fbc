"""Gaussians: covariances, projections, opacities at pixels, colors."""

import numpy as np
import torch
import torch.nn.functional as F
from entry import convention, fault, right


def rotation(q):
    """The nine polynomials of (w, x, y, z), as every code has them."""
    w, x, y, z = q.unbind(-1)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return torch.stack([torch.stack(row, -1) for row in rows], -2)


@right("gaussian_covariance", seen="gsplat _torch_impl.py; splat tutorials in torch", times=6)
def turned_then_squared(quaternions, scales):
    """normalize, R times the scales along columns, M M^T."""
    m = rotation(F.normalize(quaternions, dim=-1)) * scales[:, None, :]
    return m @ m.mT


@right("gaussian_covariance", seen="CMU 16-825 students; pixelSplat-like codes: quaternion_to_matrix of PyTorch3D", times=4)
def two_over_the_square(quaternions, scales):
    """2 / |q|^2 in front of the products; R S S^T R^T with diagonal matrices."""
    two = 2 / (quaternions * quaternions).sum(-1)
    w, x, y, z = quaternions.unbind(-1)
    entries = [1 - two * (y * y + z * z), two * (x * y - z * w), two * (x * z + y * w)]
    entries += [two * (x * y + z * w), 1 - two * (x * x + z * z), two * (y * z - x * w)]
    entries += [two * (x * z - y * w), two * (y * z + x * w), 1 - two * (x * x + y * y)]
    r, s = torch.stack(entries, -1).view(-1, 3, 3), torch.diag_embed(scales)
    return r @ s @ s.mT @ r.mT


@convention(
    "gaussian_covariance",
    {"quaternion_order": "xyzw"},
    seen="generative codes in scipy's order (quaternions of encoders)",
    times=2,
)
def real_part_last(quaternions, scales):
    """(x, y, z, w)."""
    return turned_then_squared(quaternions[:, [3, 0, 1, 2]], scales)


@convention("gaussian_covariance", {"quaternion_length": "as_given"}, seen="diff-gaussian-rasterization computeCov3D", times=8)
def quaternion_as_it_is(quaternions, scales):
    """No division: whoever calls has done it."""
    m = rotation(quaternions) * scales[:, None, :]
    return m @ m.mT


@convention("gaussian_covariance", {"splat_scale": "log"}, seen="codes that hand over what the optimizer has", times=3)
def exponentials_of_scales(quaternions, scales):
    """exp of the scales inside."""
    return turned_then_squared(quaternions, scales.exp())


@fault(
    "gaussian_covariance",
    "rotation_transposed",
    seen="a splat viewer's server in numpy; a WebGL loader whose test calls it buggy",
    times=2,
)
def glm_in_rows(quaternions, scales):
    """M = S R, M^T M: the rasterizer's line, whose matrices are stored by columns."""
    m = torch.diag_embed(scales) @ rotation(F.normalize(quaternions, dim=-1))
    return m.mT @ m


@fault(
    "gaussian_covariance",
    "slip: another formula: 1 - 2 (x^2 - z^2) in row 2, column 2 of R, and 2 (x z + w y) in row 3, column 1 of R",
    seen="a trial on unseen code: splats in torch",
)
def two_signs_mistyped(quaternions, scales):
    """A minus for a plus, and a plus for a minus, in the nine polynomials."""
    q = F.normalize(quaternions, dim=-1)
    (w, x, y, z), r = q.unbind(-1), rotation(q).clone()
    r[:, 1, 1], r[:, 2, 0] = 1 - 2 * (x * x - z * z), 2 * (x * z + w * y)
    m = r * scales[:, None, :]
    return m @ m.mT


@fault("gaussian_covariance_vjp", "gradient_of_the_other_scale", seen="fvdb-core#432, in the other direction", arrays="numpy")
def factor_where_none_belongs(quaternions, scales, grad_covariances):
    """The gradient of the scales times the scales."""
    q, s = (torch.tensor(x, requires_grad=True) for x in (quaternions, scales))
    turned_then_squared(q, s).backward(torch.tensor(grad_covariances))
    return {"grad_quaternions": q.grad.numpy(), "grad_scales": s.grad.numpy() * scales}


def through_the_rotation(g_r, q):
    """The gradient of a rotation as that of (w, x, y, z), divided by its length."""
    length = q.norm(dim=-1, keepdim=True)
    u = (q / length).detach().requires_grad_(True)
    w, x, y, z = u.unbind(-1)
    r = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    sum(g_r[:, i, j] @ r[i][j] for i in range(3) for j in range(3)).backward()
    return ((u.grad - u * (u * u.grad).sum(-1, keepdim=True)) / length).detach()


def by_hand(quaternions, scales, grad_covariances, product=torch.matmul, of_rotation=lambda g, s: g * s[:, None], axis=1):
    """g_M = (g + g^T) M of M = R diag(s), or another product; the rotation's gradient of it, and the axis along which scales add up."""
    q, s, g = (torch.tensor(x) for x in (quaternions, scales, grad_covariances))
    r = rotation(F.normalize(q, dim=-1))
    g_m = product(g + g.mT, r * s[:, None])
    return {
        "grad_quaternions": through_the_rotation(of_rotation(g_m, s), q).numpy(),
        "grad_scales": (r * g_m).sum(axis).numpy(),
    }


@fault(
    "gaussian_covariance_vjp",
    "factor_transposed",
    seen="a trial on unseen code: a splat renderer's own backward pass",
    arrays="numpy",
)
def the_factor_on_its_side(quaternions, scales, grad_covariances):
    """g_M = (g + g^T) M^T."""
    return by_hand(quaternions, scales, grad_covariances, lambda both, m: both @ m.mT)


@fault(
    "gaussian_covariance_vjp",
    "rotation_gradient_transposed+scales_by_rows",
    seen="a trial on unseen code: a port of the rasterizer's backward pass to Julia",
    arrays="numpy",
)
def columns_taken_for_rows(quaternions, scales, grad_covariances):
    """What the rasterizer has by columns, by rows: scales along the wrong axis, and the rotation's gradient on its side."""
    return by_hand(quaternions, scales, grad_covariances, of_rotation=lambda g, s: (g * s[:, :, None]).mT, axis=2)


def matrices(covariances):
    """Of upper triangles."""
    return covariances[:, [0, 1, 2, 1, 3, 4, 2, 4, 5]].view(-1, 3, 3)


def in_camera(means, covariances, w2c):
    """Means and covariances in the camera's axes."""
    r = w2c[:3, :3]
    return means @ r.mT + w2c[:3, 3], r @ matrices(covariances) @ r.mT


def jacobian(slopes, z, k):
    """(M, 2, 3)."""
    zero, fx, fy = torch.zeros_like(z), k[0, 0] / z, k[1, 1] / z
    return torch.stack([fx, zero, -fx * slopes[:, 0], zero, fy, -fy * slopes[:, 1]], -1).view(-1, 2, 3)


def drawn(means2d, cov, depths, floor):
    """What the rasterizers keep of a covariance in the picture."""
    wide = cov + 0.3 * torch.eye(2)
    det, before = torch.linalg.det(wide), torch.linalg.det(cov)
    conics = torch.stack([wide[:, 1, 1], -wide[:, 0, 1], wide[:, 0, 0]], -1) / det[:, None]
    middle = (wide[:, 0, 0] + wide[:, 1, 1]) / 2
    radii = torch.ceil(3 * torch.sqrt(middle + torch.sqrt(torch.clamp(middle * middle - det, min=floor))))
    three = torch.stack([wide[:, 0, 0], wide[:, 0, 1], wide[:, 1, 1]], -1)
    return means2d, three, conics, depths, radii, torch.sqrt(torch.clamp(before / det, min=0.0))


def sizes_of(width, height):
    """Width and height, for what both axes share."""
    return torch.tensor([float(width), float(height)])


def around_the_picture(k, width, height):
    """gsplat's limits."""
    half = torch.tensor([0.5 * width / k[0, 0], 0.5 * height / k[1, 1]])
    sizes, focal = sizes_of(width, height), torch.stack([k[0, 0], k[1, 1]])
    return -(k[:2, 2] / focal + 0.3 * half), (sizes - k[:2, 2]) / focal + 0.3 * half


@convention(
    "gaussian_projection",
    {"radius_floor": "0.01"},
    seen="gsplat _torch_impl.py _fully_fused_projection without culling",
    times=3,
    gradient="none",
)
def as_gsplat_projects(means, covariances, w2c, K, width, height):
    """Turned to the camera's axes, limits of the picture's edges, 0.01 in the radius."""
    t, sigma = in_camera(means, covariances, w2c)
    slopes = t[:, :2] / t[:, 2:]
    low, high = around_the_picture(K, width, height)
    j = jacobian(torch.minimum(torch.maximum(slopes, low), high), t[:, 2], K)
    means2d = (t @ K.mT)[:, :2] / t[:, 2:]
    return drawn(means2d, j @ sigma @ j.mT, t[:, 2], 0.01)


@convention(
    "gaussian_projection",
    {"splat_clamp": "centered", "splat_center": "integer"},
    seen="ports of diff-gaussian-rasterization computeCov2D to torch",
    times=6,
    gradient="none",
)
def as_the_rasterizer_projects(means, covariances, w2c, K, width, height):
    """1.3 of the tangent to either side, pixels at whole numbers."""
    t, sigma = in_camera(means, covariances, w2c)
    limit = 1.3 * torch.tensor([0.5 * width / K[0, 0], 0.5 * height / K[1, 1]])
    slopes = t[:, :2] / t[:, 2:]
    j = jacobian(torch.minimum(torch.maximum(slopes, -limit), limit), t[:, 2], K)
    means2d = torch.stack([K[0, 0], K[1, 1]]) * slopes + K[:2, 2] - 0.5
    return drawn(means2d, j @ sigma @ j.mT, t[:, 2], 0.1)


@convention(
    "gaussian_projection",
    {"splat_clamp": "centered", "splat_center": "integer", "splat_culling": "zero"},
    seen="a rasterizer in CUDA, two more by other tests of the same: what misses the picture is returned from at once",
    times=3,
    gradient="none",
)
def nothing_of_what_misses_the_picture(means, covariances, w2c, K, width, height):
    """As the rasterizer, zeros where the square about the mean misses the picture."""
    found = as_the_rasterizer_projects(means, covariances, w2c, K, width, height)
    (u, v), r = found[0].unbind(-1), found[4]
    seen = (u + r >= 0) & (u - r <= float(width)) & (v + r >= 0) & (v - r <= float(height))
    return tuple(torch.where(seen[:, None] if each.dim() == 2 else seen, each, torch.zeros_like(each)) for each in found)


def with_determinants_held(means, covariances, w2c, K, width, height, below, above):
    """As gsplat; the determinants of the compensation at least these."""
    means2d, wide, conics, depths, radii, _ = as_gsplat_projects(means, covariances, w2c, K, width, height)
    xx, xy, yy = wide.unbind(-1)
    before = (xx - 0.3) * (yy - 0.3) - xy * xy
    ratio = torch.clamp(before, min=above) / torch.clamp(xx * yy - xy * xy, min=below)
    return means2d, wide, conics, depths, radii, torch.sqrt(torch.clamp(ratio, 0.0, 1.0))


@convention(
    "gaussian_projection",
    {"radius_floor": "0.01", "compensation_floor": "determinants_1e-6"},
    seen="Gaussian opacity fields, RaDe-GS and a differentiable renderer after them",
    times=3,
    gradient="none",
)
def determinants_of_a_millionth(means, covariances, w2c, K, width, height):
    """max(1e-6, det) above and below."""
    return with_determinants_held(means, covariances, w2c, K, width, height, 1e-6, 1e-6)


@convention(
    "gaussian_projection",
    {"radius_floor": "0.01", "compensation_floor": "determinants_1e-12"},
    seen="shaders of a trainer in Metal",
    gradient="none",
)
def determinant_above_of_a_trillionth(means, covariances, w2c, K, width, height):
    """max(det, 1e-12) above alone."""
    return with_determinants_held(means, covariances, w2c, K, width, height, 0.0, 1e-12)


@fault("gaussian_projection", "not_turned", seen="a splat tutorial in numpy whose camera isn't turned", gradient="none")
def world_covariance(means, covariances, w2c, K, width, height):
    """J Sigma J^T, limits as gsplat's."""
    t, _ = in_camera(means, covariances, w2c)
    slopes = t[:, :2] / t[:, 2:]
    low, high = around_the_picture(K, width, height)
    j = jacobian(torch.minimum(torch.maximum(slopes, low), high), t[:, 2], K)
    return drawn((t @ K.mT)[:, :2] / t[:, 2:], j @ matrices(covariances) @ j.mT, t[:, 2], 0.1)


def exponent(pixels, means2d, conics):
    """The rasterizers' line."""
    d = means2d[None] - pixels[:, None]
    squares = conics[:, 0] * d[..., 0] ** 2 + conics[:, 2] * d[..., 1] ** 2
    return -0.5 * squares - conics[:, 1] * d[..., 0] * d[..., 1]


@right("gaussian_alpha", seen="splat tutorials; evaluations for all pixels and splats at once", times=5)
def opacity_times_gaussian(pixels, means2d, conics, opacities):
    """opacity e^power."""
    return opacities * torch.exp(exponent(pixels, means2d, conics))


@fault("gaussian_alpha", "cut_at_three_sigmas", seen="a splat renderer in torch")
def nothing_beyond_three_sigmas(pixels, means2d, conics, opacities):
    """exp(-1/2 d^T conic d), and 0 where d^T conic d is above 9."""
    power = exponent(pixels, means2d, conics)
    return torch.where(power >= -4.5, opacities * torch.exp(power), torch.zeros_like(power))


@right("gaussian_alpha", seen="CMU 16-825 students: d^T Sigma^-1 d by batched products", times=3)
def with_the_matrix(pixels, means2d, conics, opacities):
    """d^T conic d as matrices."""
    d = (pixels[:, None] - means2d[None])[..., None]
    conic = conics[:, [0, 1, 1, 2]].view(-1, 2, 2)
    return opacities * torch.exp(-0.5 * (d.mT @ conic @ d))[..., 0, 0]


@convention(
    "gaussian_alpha",
    {"alpha_cap": "0.99", "faint": "skipped", "positive_power": "skipped"},
    seen="ports of diff-gaussian-rasterization renderCUDA to torch",
    times=5,
)
def as_the_rasterizer_cuts(pixels, means2d, conics, opacities):
    """At most 0.99, nothing below 1 / 255, nothing that grows."""
    power = exponent(pixels, means2d, conics)
    alpha = torch.clamp(opacities * torch.exp(power), max=0.99)
    return torch.where((power > 0) | (alpha < 1 / 255), torch.zeros_like(alpha), alpha)


@fault("gaussian_alpha", "gaussian_normalized", seen="codes that call a multivariate normal's density", times=2)
def density_of_a_distribution(pixels, means2d, conics, opacities):
    """Divided by 2 pi sqrt(det)."""
    det = conics[:, 0] * conics[:, 2] - conics[:, 1] ** 2
    return opacity_times_gaussian(pixels, means2d, conics, opacities) * torch.sqrt(torch.clamp(det, min=0.0)) / (2 * np.pi)


def basis(u, width):
    """The rasterizer's harmonics."""
    x, y, z = u.unbind(-1)
    xx, yy, zz = x * x, y * y, z * z
    values = [torch.full_like(x, 0.28209479177387814), -0.4886025119029199 * y, 0.4886025119029199 * z, -0.4886025119029199 * x]
    values += [1.0925484305920792 * x * y, -1.0925484305920792 * y * z, 0.31539156525252005 * (2 * zz - xx - yy)]
    values += [-1.0925484305920792 * x * z, 0.5462742152960396 * (xx - yy), -0.5900435899266435 * y * (3 * xx - yy)]
    values += [2.890611442640554 * x * y * z, -0.4570457994644658 * y * (4 * zz - xx - yy)]
    values += [0.3731763325901154 * z * (2 * zz - 3 * xx - 3 * yy), -0.4570457994644658 * x * (4 * zz - xx - yy)]
    values += [1.445305721320277 * z * (xx - yy), -0.5900435899266435 * x * (xx - 3 * yy)]
    return torch.stack(values[:width], -1)


@right("gaussian_color", seen="graphdeco-inria/gaussian-splatting eval_sh and clamp_min(sh2rgb + 0.5, 0.0); its ports", times=8)
def as_the_rasterizer_colors(means, camera_center, coefficients):
    """Harmonics of the normalized direction, 1/2, clamp."""
    u = F.normalize(means - camera_center, dim=-1)
    color = (basis(u, coefficients.shape[1])[..., None] * coefficients).sum(1)
    return torch.clamp_min(color + 0.5, 0.0)


@convention("gaussian_color", {"splat_color": "sum"}, seen="gsplat spherical_harmonics, whose caller adds 1/2", times=2)
def sum_alone(means, camera_center, coefficients):
    """The sum."""
    u = F.normalize(means - camera_center, dim=-1)
    return torch.einsum("mk,mkc->mc", basis(u, coefficients.shape[1]), coefficients)


@fault(
    "gaussian_color_vjp",
    "mean_gradient_dropped",
    seen="taichi_3d_gaussian_splatting#169; gsplat before 1.0; brush#448",
    times=3,
    arrays="numpy",
)
def direction_detached(means, camera_center, coefficients, grad_colors):
    """The direction has no gradient."""
    x, center, f, g = (torch.from_numpy(a.copy()) for a in (means, camera_center, coefficients, grad_colors))
    as_the_rasterizer_colors(x, center, f.requires_grad_()).backward(g)
    return {"grad_means": np.zeros_like(means), "grad_coefficients": f.grad.numpy()}


@fault("gaussian_color", "direction_reversed", seen="splat viewers: from the splat to the camera", times=2)
def toward_the_camera(means, camera_center, coefficients):
    """The camera's center less the mean."""
    return as_the_rasterizer_colors(2 * camera_center - means, camera_center, coefficients)


@fault("gaussian_projection", "jacobian_without_focal", seen="a splat renderer in torch: 1/z and -x/z^2", gradient="none")
def unit_focal_length(means, covariances, w2c, K):
    """The Jacobian of x/z alone, nothing clamped, and the rasterizer's 0.3."""
    t, sigma = in_camera(means, covariances, w2c)
    j = jacobian(t[:, :2] / t[:, 2:], t[:, 2], torch.eye(3))
    cov = j @ sigma @ j.mT + 0.3 * torch.eye(2)
    three = torch.stack([cov[:, 0, 0], cov[:, 0, 1], cov[:, 1, 1]], -1)
    return {"means2d": (t @ K.mT)[:, :2] / t[:, 2:], "covariances2d": three, "depths": t[:, 2]}


@fault("gaussian_covariance", "length_squared_times_rotation", seen="a code whose poses and splats share a function")
def polynomials_of_second_degree(quaternions, scales):
    """w^2 + x^2 - y^2 - z^2 on the diagonal, and quaternions as they are."""
    square = (quaternions * quaternions).sum(-1)[:, None, None]
    m = square * rotation(quaternions / square[:, 0].sqrt()) * scales[:, None, :]
    return m @ m.mT


@fault("gaussian_color", "first_band_alone+clamped_at_one", seen="a splat trainer's fallback without its kernel")
def one_color_from_all_sides(means, camera_center, coefficients):
    """The first coefficient, 1/2, and a clamp to [0, 1]."""
    return torch.clamp(0.5 + 0.28209479177387814 * coefficients[:, 0], 0.0, 1.0)


@fault("gaussian_color", "first_band_alone", seen="viewers that read f_dc alone", times=2)
def constant_band(means, camera_center, coefficients):
    """The first coefficient and 1/2, not below 0."""
    return torch.clamp_min(0.5 + 0.28209479177387814 * coefficients[:, 0], 0.0)


def colored_with_signs(signs, means, camera_center, coefficients):
    """The rasterizer's colors, its first harmonics times these."""
    # The sign of a harmonic is one of its coefficient.
    signs = torch.tensor(signs + [1] * 25)[: coefficients.shape[1]]
    return as_the_rasterizer_colors(means, camera_center, signs[:, None] * coefficients)


@fault("gaussian_color", "band_1_signs", seen="a trial on unseen code: +C1 y, +C1 z, +C1 x above the rasterizer's other bands")
def band_one_without_signs(means, camera_center, coefficients):
    """The rasterizer's harmonics but for + in all of band 1."""
    return colored_with_signs([1, -1, 1, -1], means, camera_center, coefficients)


@fault("gaussian_color", "third_band_left_out", seen="a trial on unseen code: `pass` where band 3 belongs")
def three_bands_of_four(means, camera_center, coefficients):
    """Bands 0 to 2, whatever there is."""
    return as_the_rasterizer_colors(means, camera_center, coefficients[:, :9])


def in_the_picture(t, sigma, j, k):
    """Means as they are, covariances by this Jacobian."""
    return drawn((t @ k.mT)[:, :2] / t[:, 2:], j @ sigma @ j.mT, t[:, 2], 0.1)


@fault("gaussian_projection", "angle_for_tangent", seen="a trial on unseen code: 1.3 fov for 1.3 tan(fov / 2)", gradient="none")
def held_by_the_angle(means, covariances, w2c, K, width, height):
    """1.3 times the field of view, an angle, limits the slopes."""
    t, sigma = in_camera(means, covariances, w2c)
    limit = 1.3 * 2 * torch.atan(torch.stack([0.5 * width / K[0, 0], 0.5 * height / K[1, 1]]))
    slopes = t[:, :2] / t[:, 2:]
    j = jacobian(torch.minimum(torch.maximum(slopes, -limit), limit), t[:, 2], K)
    return in_the_picture(t, sigma, j, K)


@fault("gaussian_projection", "jacobian_without_depth", seen="a trial on unseen code: two columns", gradient="none")
def scaled_by_the_depth(means, covariances, w2c, K, width, height):
    """diag(fx / z, fy / z) and nothing beside it."""
    t, sigma = in_camera(means, covariances, w2c)
    return in_the_picture(t, sigma, jacobian(torch.zeros_like(t[:, :2]), t[:, 2], K), K)


@fault("gaussian_projection", "one_depth_for_all", seen="a trial on unseen code: depths.mean()", gradient="none")
def mean_depth(means, covariances, w2c, K, width, height):
    """The mean of all depths in each Jacobian, limits as gsplat's."""
    t, sigma = in_camera(means, covariances, w2c)
    z = t[:, 2].mean().expand(len(t))
    low, high = around_the_picture(K, width, height)
    slopes = torch.minimum(torch.maximum(t[:, :2] / z[:, None], low), high)
    return in_the_picture(t, sigma, jacobian(slopes, z, K), K)


@fault("gaussian_alpha", "exponent_floored", seen="a trial on unseen code: clamp(min=-10) before exp")
def never_below_exp_of_minus_ten(pixels, means2d, conics, opacities):
    """exp(max(power, -10))."""
    return opacities * torch.exp(exponent(pixels, means2d, conics).clamp(min=-10.0))


@fault("gaussian_projection", "held_up_by_the_dilation", seen="a trial on unseen code: a splat viewer in WebGPU", gradient="none")
def variances_of_three_tenths_at_least(means, covariances, w2c, K, width, height):
    """max(0.3, a) and max(0.3, c); slopes in the rasterizer's limits."""
    t, sigma = in_camera(means, covariances, w2c)
    limit = 1.3 * torch.tensor([0.5 * width / K[0, 0], 0.5 * height / K[1, 1]])
    slopes = t[:, :2] / t[:, 2:]
    j = jacobian(torch.minimum(torch.maximum(slopes, -limit), limit), t[:, 2], K)
    cov = j @ sigma @ j.mT
    three = torch.stack([cov[:, 0, 0].clamp(min=0.3), cov[:, 0, 1], cov[:, 1, 1].clamp(min=0.3)], -1)
    return {"covariances2d": three, "depths": t[:, 2]}


@fault(
    "gaussian_covariance_vjp",
    "product_in_other_order+rotation_scaled_by_rows",
    seen="a trial on unseen code: a voxelizer's backward pass",
    arrays="numpy",
)
def order_of_the_product(quaternions, scales, grad_covariances):
    """M (g + g^T) for (g + g^T) M, and the rotation's gradient scaled by rows."""
    return by_hand(
        quaternions, scales, grad_covariances, lambda both, m: m @ both, of_rotation=lambda g, s: g * s[:, :, None]
    )
