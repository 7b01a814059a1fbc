"""The second implementation's fisheyes: the angle by atan2, derivatives as matrices of each point. See second.py."""

import numpy as np
import second_lens as lens


def even(k, wrong=()):
    """Coefficients of theta^1, theta^2, ... after the 1."""
    zero = np.zeros_like(k)
    return list(k) if "every_power" in wrong else list(np.stack([zero, k], 1).ravel())


def bent(theta, k, wrong=()):
    """theta_d."""
    return theta * (1 + lens.horner(even(k, wrong), theta))


def slope(theta, k, wrong=()):
    """d theta_d / d theta."""
    terms = even(k, wrong)
    return 1 + lens.horner([theta.dtype.type(n + 2) * entry for n, entry in enumerate(terms)], theta)


def scaled(p, to, length, wrong):
    """p times to / length, p itself in the middle."""
    with np.errstate(divide="ignore", invalid="ignore"):
        out = p * (to / length)[:, None]
    return out if "not_a_number_in_the_middle" in wrong else np.where(length[:, None] == 0, p, out)


def angle(target, k, wrong=()):
    """Newton's method for all points at once."""
    theta_d = np.hypot(*target.T)
    theta = theta_d
    for _ in range(30):
        theta = theta - (bent(theta, k, wrong) - theta_d) / slope(theta, k, wrong)
    return theta, theta_d


def straight(target, k, wrong=()):
    """The ideal points."""
    theta, theta_d = angle(target, k, wrong)
    return scaled(target, np.tan(theta), theta_d, wrong)


def padded(k):
    """As the other model's coefficients."""
    return lens.read(k)


def fisheye_distort(a, c, wrong):
    """The fisheye."""
    p, k = a["points"], a["coefficients"]
    if "opencv_lens" in wrong:
        return {"distorted": lens.bend(p, padded(k))}
    if "undone_instead" in wrong:
        return {"distorted": straight(p, k)}
    r = np.hypot(*p.T)
    theta = r if "radius_for_angle" in wrong else np.arctan2(r, np.ones_like(r))
    theta_d = bent(theta, k, wrong)
    if "not_divided_by_radius" in wrong:
        return {"distorted": p * theta_d[:, None] if "not_a_number_in_the_middle" in wrong else np.where(r[:, None] == 0, p, p * theta_d[:, None])}
    return {"distorted": scaled(p, theta_d, r, wrong)}


def stretches(p, k):
    """Unit vectors, the stretches along and across them, and the angle; in the middle neither."""
    r = np.hypot(*p.T)
    theta = np.arctan2(r, np.ones_like(r))
    away = np.where(r == 0, 1, r)
    u = p / away[:, None]
    across = np.where(r == 0, 1, bent(theta, k) / away)
    return u, slope(theta, k) / (1 + r * r), across, theta


def both(u, along, across, g):
    """along u u^T g + across (I - u u^T) g."""
    outer = u[:, :, None] * u[:, None, :]
    matrix = along[:, None, None] * outer + across[:, None, None] * (np.eye(2, dtype=u.dtype) - outer)
    return (matrix @ g[:, :, None])[:, :, 0]


def fisheye_distort_vjp(a, c, wrong):
    """The Jacobian of each point."""
    p, k, g = a["points"], a["coefficients"], a["grad_distorted"]
    u, along, across, theta = stretches(p, k)
    if "radius_not_differentiated" in wrong:
        along = across
    g_p = both(u, along, across, g)
    if "gradient_not_a_number_in_the_middle" in wrong:
        g_p = np.where((p == 0).all(1, keepdims=True), np.nan, g_p)
    radial = (u * g).sum(1)
    g_k = np.array([(theta ** (2 * n + 3) * radial).sum() for n in range(4)], p.dtype)
    return {"grad_points": g_p, "grad_coefficients": g_k * 0 if "lens_held_constant" in wrong else g_k}


def fisheye_undistort(a, c, wrong):
    """Newton's method."""
    target, k = a["distorted"], a["coefficients"]
    if "opencv_lens" in wrong:
        return {"points": lens.solved(target, padded(k))}
    if "distorted_again" in wrong:
        return {"points": fisheye_distort({"points": target, "coefficients": k}, c, ())["distorted"]}
    theta, theta_d = angle(target, k, wrong)
    if "polynomial_not_inverted" in wrong:
        theta = theta_d
    return {"points": scaled(target, theta if "angle_for_radius" in wrong else np.tan(theta), theta_d, wrong)}


def fisheye_undistort_vjp(a, c, wrong):
    """The inverse Jacobian at the solution."""
    target, k, g = a["distorted"], a["coefficients"], a["grad_points"]
    u, along, across, theta = stretches(straight(target, k), k)
    h = both(u, 1 / along, 1 / across, g)
    radial = (u * h).sum(1)
    g_k = -np.array([(theta ** (2 * n + 3) * radial).sum() for n in range(4)], target.dtype)
    if "handed_through" in wrong:
        h = g
    if "gradient_not_a_number_in_the_middle" in wrong:
        h = np.where((target == 0).all(1, keepdims=True), np.nan, h)
    return {"grad_distorted": h, "grad_coefficients": g_k * 0 if "lens_held_constant" in wrong else g_k}
