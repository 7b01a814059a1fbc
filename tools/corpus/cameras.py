"""Lenses and poses: what calibrations and structures from motion hand over, and how it is read."""

import numpy as np
import torch
from entry import convention, fault, right


def padded(coefficients):
    """Eight coefficients in OpenCV's order."""
    return torch.cat([coefficients, coefficients.new_zeros(8 - len(coefficients))])


@right("lens_distort", seen="OpenCV's projectPoints in torch (kornia): a1, a2, a3", times=3)
def three_monomials(points, coefficients):
    """2 x y, r^2 + 2 x^2 and r^2 + 2 y^2 first."""
    k = padded(coefficients)
    x, y = points.unbind(-1)
    r2 = x * x + y * y
    r4, r6 = r2 * r2, r2**3
    radial = (1 + k[0] * r2 + k[1] * r4 + k[4] * r6) / (1 + k[5] * r2 + k[6] * r4 + k[7] * r6)
    a1, a2, a3 = 2 * x * y, r2 + 2 * x * x, r2 + 2 * y * y
    return torch.stack([x * radial + k[2] * a1 + k[3] * a2, y * radial + k[2] * a3 + k[3] * a1], -1)


@right("lens_distort", seen="instant-ngp common_device.cuh: the shift alone, added to the point", times=2)
def shift_added(points, coefficients):
    """du, dv of a polynomial lens, and a quotient only where there is one."""
    k = padded(coefficients)
    x, y = points.unbind(-1)
    r2 = x * x + y * y
    shift = r2 * (k[0] + r2 * (k[1] + r2 * k[4]))
    below = 1 + r2 * (k[5] + r2 * (k[6] + r2 * k[7]))
    shift = (1 + shift - below) / below
    du = x * shift + 2 * k[2] * x * y + k[3] * (r2 + 2 * x * x)
    dv = y * shift + 2 * k[3] * x * y + k[2] * (r2 + 2 * y * y)
    return torch.stack([x + du, y + dv], -1)


@fault("lens_distort", "k4_in_the_numerator", seen="nerfstudio, multinerf and descendants: a k4 of r^8", times=7)
def four_radial_powers(points, coefficients):
    """1 + r (k1 + r (k2 + r (k3 + r k4))), p1, p2; the rest isn't read."""
    k = padded(coefficients)
    x, y = points.unbind(-1)
    r = x * x + y * y
    d = 1 + r * (k[0] + r * (k[1] + r * (k[4] + r * k[5])))
    u = d * x + 2 * k[2] * x * y + k[3] * (r + 2 * x * x)
    v = d * y + 2 * k[3] * x * y + k[2] * (r + 2 * y * y)
    return torch.stack([u, v], -1)


@fault("lens_distort", "k3_third", seen="cameras whose radial coefficients come first", times=1)
def radial_first(points, coefficients):
    """k1, k2, k3, p1, p2."""
    k = padded(coefficients)
    return three_monomials(points, torch.cat([k[:2], k[3:5], k[2:3], k[5:]]))


@fault("lens_distort", "tangential_swapped", seen="not met in this reading", times=0)
def other_tangential(points, coefficients):
    """p2 for p1."""
    k = padded(coefficients)
    return three_monomials(points, torch.cat([k[:2], k[3:4], k[2:3], k[4:]]))


@fault("lens_distort", "denominator_dropped", seen="readers of five coefficients", times=1)
def five_are_read(points, coefficients):
    """k4, k5, k6 are cut off."""
    return three_monomials(points, coefficients[:5])


def newton(distorted, coefficients, steps):
    """Newton's method with the Jacobian of automatic differentiation."""
    p = distorted
    for _ in range(steps):
        off = three_monomials(p, coefficients) - distorted
        jacobian = torch.func.vmap(torch.func.jacrev(three_monomials), (0, None))(p, coefficients)
        p = p - torch.linalg.solve(jacobian, off)
    return p


@right("lens_undistort", seen="nerfstudio camera_utils.py, multinerf camera_utils.py: Newton's method", times=7)
def newtons_method(distorted, coefficients):
    """Ten steps, all of them differentiated."""
    return newton(distorted, coefficients, 10)


@fault("lens_undistort", "few_steps", seen="OpenCV's undistortPoints without criteria", times=2, gradient="none")
def five_fixed_point_steps(distorted, coefficients):
    """x = (x' - tangential) / radial, five times."""
    p = distorted
    for _ in range(5):
        k = padded(coefficients)
        r2 = (p * p).sum(-1, keepdim=True)
        radial = (1 + k[0] * r2 + k[1] * r2**2 + k[4] * r2**3) / (1 + k[5] * r2 + k[6] * r2**2 + k[7] * r2**3)
        p = (distorted - (three_monomials(p, coefficients) - p * radial)) / radial
    return p


@fault("lens_undistort", "distorted_again", seen="not met in this reading", times=0)
def bent_twice(distorted, coefficients):
    """The wrong way."""
    return three_monomials(distorted, coefficients)


@fault("lens_undistort", "signs_flipped", seen="not met in this reading", times=0)
def negative_coefficients(distorted, coefficients):
    """Bent by the opposite lens."""
    return three_monomials(distorted, -coefficients)


@fault("lens_undistort_vjp", "handed_through", seen="iterations under no_grad", times=1, arrays="numpy")
def straight_through(distorted, coefficients, grad_points):
    """The gradient of what was found is that of what was given."""
    k, p, g = (torch.from_numpy(np.array(x, np.float64)) for x in (coefficients, distorted, grad_points))
    found, lens = newton(p, k, 20).detach(), k.clone().requires_grad_()
    jacobian = torch.func.vmap(torch.func.jacrev(three_monomials), (0, None))(found, k)
    h = torch.linalg.solve(jacobian.transpose(1, 2), g)
    (g_k,) = torch.autograd.grad((-h * three_monomials(found, lens)).sum(), lens)
    return grad_points, g_k.numpy().astype(distorted.dtype)


def entries(q):
    """COLMAP's qvec2rotmat: the entries, for unit quaternions."""
    w, x, y, z = q.unbind(-1)
    rows = [
        [1 - 2 * y**2 - 2 * z**2, 2 * x * y - 2 * w * z, 2 * z * x + 2 * w * y],
        [2 * x * y + 2 * w * z, 1 - 2 * x**2 - 2 * z**2, 2 * y * z - 2 * w * x],
        [2 * z * x - 2 * w * y, 2 * y * z + 2 * w * x, 1 - 2 * x**2 - 2 * y**2],
    ]
    return torch.stack([torch.stack(row, -1) for row in rows], -2)


def whole(rotation, place):
    """4x4."""
    upper = torch.cat([rotation, place[..., None]], -1)
    last = torch.tensor([0.0, 0.0, 0.0, 1.0], dtype=rotation.dtype).expand(len(rotation), 1, 4)
    return torch.cat([upper, last], -2)


@right("pose_from_colmap", seen="normalized and inverted by torch.linalg.inv or numpy's", times=6)
def inverse_of_the_matrix(q, t):
    """[R t; 0 1]^-1."""
    return torch.linalg.inv(whole(entries(torch.nn.functional.normalize(q, dim=-1)), t))


@right("pose_from_colmap", seen="read_write_model.py qvec2rotmat and its copies", times=8)
def taken_for_unit(q, t):
    """R^T and -R^T t, without a look at the length."""
    back = entries(q).transpose(1, 2)
    return whole(back, -(back @ t[..., None])[..., 0])


@right("pose_from_colmap", seen="colmap2nerf.py of instant-ngp, nerfstudio: numpy's inverse of what qvec2rotmat gives", times=4, gradient="none")
def taken_for_unit_and_inverted(q, t):
    """The inverse of a matrix that is a rotation for unit quaternions."""
    return torch.linalg.inv(whole(entries(q), t))


@convention("pose_from_colmap", {"axes": "opengl"}, seen="nerfstudio: c2w[0:3, 1:3] *= -1", times=5)
def for_opengl(q, t):
    """The second and the third column turned about."""
    return inverse_of_the_matrix(q, t) * torch.tensor([1, -1, -1, 1], dtype=q.dtype)


@fault("pose_from_colmap", "sign_of_w_z_above", seen="a matrix typed by hand", times=1)
def one_sign_wrong(q, t):
    """2 (x y + w z) in both places."""
    rotation = entries(torch.nn.functional.normalize(q, dim=-1)).clone()
    rotation[:, 0, 1] = rotation[:, 1, 0]
    back = rotation.transpose(1, 2)
    return whole(back, -(back @ t[..., None])[..., 0])


@fault("pose_from_colmap", "scalar_last", seen="scipy's Rotation.from_quat(qvec)", times=1)
def as_scipy_has_it(q, t):
    """x, y, z, w."""
    return inverse_of_the_matrix(q.roll(1, -1), t)


@fault("pose_from_colmap", "not_inverted", seen="kornia's NerfModelRenderer", times=1)
def as_it_is_written(q, t):
    """World to camera."""
    return whole(entries(torch.nn.functional.normalize(q, dim=-1)), t)


@fault("pose_from_colmap", "rotation_alone_inverted", seen="not met in this reading", times=0)
def translation_as_it_is(q, t):
    """R^T and t."""
    return whole(entries(torch.nn.functional.normalize(q, dim=-1)).transpose(1, 2), t)


@fault("pose_from_colmap", "translation_not_turned", seen="not met in this reading", times=0)
def minus_t(q, t):
    """R^T and -t."""
    return whole(entries(torch.nn.functional.normalize(q, dim=-1)).transpose(1, 2), -t)


def bent(theta, k):
    """theta (1 + k1 theta^2 + ...)."""
    t2 = theta * theta
    return theta * (1 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))))


@right("fisheye_distort", seen="OpenCV's fisheye::projectPoints in torch: 1 / r where r > 1e-8", times=4)
def selected_radius(points, coefficients):
    """atan, a polynomial, and 1 in the middle; the radius is held off 0 inside of the selection."""
    squares = (points * points).sum(-1, keepdim=True)
    away = squares > 0
    r = torch.sqrt(torch.where(away, squares, torch.ones_like(squares)))
    return torch.where(away, points * bent(torch.atan(r), coefficients) / r, points)


@fault("fisheye_distort", "not_a_number_in_the_middle", seen="copies without the test of r", times=1, gradient="none")
def radius_as_it_is(points, coefficients):
    """theta_d / r, 0 / 0 in the middle."""
    r = torch.linalg.vector_norm(points, dim=-1, keepdim=True)
    return points * (bent(torch.atan(r), coefficients) / r)


@fault("fisheye_distort", "radius_for_angle", seen="not met in this reading", times=0, gradient="none")
def radius_in_the_polynomial(points, coefficients):
    """r for theta."""
    r = torch.linalg.vector_norm(points, dim=-1, keepdim=True).clamp_min(1e-20)
    return points * (bent(r, coefficients) / r)


@fault("fisheye_distort", "opencv_lens", seen="readers that know one model", times=1)
def other_model(points, coefficients):
    """k1, k2, k3, k4 as k1, k2, p1, p2."""
    return three_monomials(points, coefficients)


def straightened(distorted, coefficients, steps):
    """theta and theta_d."""
    theta_d = torch.linalg.vector_norm(distorted, dim=-1, keepdim=True)
    theta, k = theta_d, coefficients
    for _ in range(steps):
        t2 = theta * theta
        slope = 1 + t2 * (3 * k[0] + t2 * (5 * k[1] + t2 * (7 * k[2] + t2 * 9 * k[3])))
        theta = theta - (bent(theta, k) - theta_d) / slope
    return theta, theta_d


@right("fisheye_undistort", seen="OpenCV's fisheye::undistortPoints: Newton's method for theta", times=4, gradient="none")
def angle_first(distorted, coefficients):
    """theta, and tan theta / theta_d away from the middle."""
    theta, theta_d = straightened(distorted, coefficients, 10)
    return torch.where(theta_d > 0, distorted * (torch.tan(theta) / theta_d), distorted)


@fault("fisheye_undistort", "polynomial_not_inverted", seen="not met in this reading", times=0, gradient="none")
def bent_angle(distorted, coefficients):
    """tan theta_d / theta_d."""
    theta_d = torch.linalg.vector_norm(distorted, dim=-1, keepdim=True)
    return torch.where(theta_d > 0, distorted * (torch.tan(theta_d) / theta_d), distorted)


@fault("fisheye_undistort", "angle_for_radius", seen="not met in this reading", times=0, gradient="none")
def angle_as_radius(distorted, coefficients):
    """theta / theta_d."""
    theta, theta_d = straightened(distorted, coefficients, 10)
    return torch.where(theta_d > 0, distorted * (theta / theta_d), distorted)


@fault("lens_distort", "tangential_swapped_in_y", seen="kalibr#698")
def second_line_with_the_others_coefficients(points, coefficients):
    """y' reads p1 and p2 as x' does."""
    k = padded(coefficients)
    x, y = points.unbind(-1)
    r2 = x * x + y * y
    radial = (1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]))) / (1 + r2 * (k[5] + r2 * (k[6] + r2 * k[7])))
    u = x * radial + 2 * k[2] * x * y + k[3] * (r2 + 2 * x * x)
    v = y * radial + 2 * k[2] * x * y + k[3] * (r2 + 2 * y * y)
    return torch.stack([u, v], -1)


@fault("lens_distort", "two_radial_coefficients", seen="a trial on unseen code: 1 + k1 r^2 + k2 r^4")
def first_two_alone(points, coefficients):
    """k1 and k2; the rest isn't read."""
    r2 = (points * points).sum(-1, keepdim=True)
    return points * (1 + r2 * (coefficients[0] + r2 * coefficients[1]))


@fault("lens_undistort", "two_radial_coefficients", seen="a trial on unseen code, forth")
def undone_by_the_first_two(distorted, coefficients):
    """Newton's method for a lens of k1 and k2."""
    return newton(distorted, coefficients[:2], 10)
