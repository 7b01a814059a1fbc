"""The second implementation's lenses: Horner's scheme over columns, derivatives as matrices of each point. See second.py."""

import numpy as np


def read(coefficients, wrong=()):
    """k1, k2, p1, p2, k3, k4, k5, k6 as they are taken, and where each comes from."""
    kind = coefficients.dtype.type
    k = np.zeros(8, coefficients.dtype)
    k[: len(coefficients)] = coefficients
    places = np.arange(8)
    if "k3_third" in wrong:
        places[[2, 3, 4]] = [3, 4, 2]
    if "tangential_swapped" in wrong:
        places[[2, 3]] = places[[3, 2]]
    taken = k[places]
    if "tangential_missing" in wrong:
        taken[2:4] = 0
    if "denominator_dropped" in wrong:
        taken[5:] = 0
    return taken * kind(-1 if "signs_flipped" in wrong else 1)


def horner(k, x):
    """k[0] x + k[1] x^2 + ..."""
    total = np.zeros_like(x)
    for entry in k[::-1]:
        total = x * (entry + total)
    return total


def parts(p, k, wrong=()):
    """Powers of r^2, numerator, denominator."""
    r2 = (p * p).sum(1)
    q = np.sqrt(r2) if "radius_not_squared" in wrong else r2
    above, below = [k[0], k[1], k[4]], [k[5], k[6], k[7]]
    if "k4_in_the_numerator" in wrong:
        above, below = [*above, k[5]], [0, 0, 0]
    return q, 1 + horner(above, q), 1 + horner([p.dtype.type(b) for b in below], q)


def bend(p, k, wrong=()):
    """The distorted points: a matrix of tangential coefficients times (2 x y, r^2 + 2 x^2, r^2 + 2 y^2)."""
    _, above, below = parts(p, k, wrong)
    x, y = p.T
    r2 = (p * p).sum(1)
    monomials = np.stack([2 * x * y, r2 + 2 * x * x, r2 + 2 * y * y], 1)
    tangential = np.array([[k[2], k[3], 0], [k[3], 0, k[2]]], p.dtype)
    return p * (above / below)[:, None] + monomials @ tangential.T


def jacobians(p, k):
    """dx'_i / dx_j of each point, (M, 2, 2)."""
    r2, above, below = parts(p, k)
    d_above, d_below = (a + r2 * (2 * b + r2 * 3 * c) for a, b, c in ((k[0], k[1], k[4]), (k[5], k[6], k[7])))
    slope = (d_above * below - above * d_below) / (below * below)
    x, y = p.T
    bent = np.array([[2 * k[2] * y + 6 * k[3] * x, 2 * k[2] * x + 2 * k[3] * y], [2 * k[2] * x + 2 * k[3] * y, 6 * k[2] * y + 2 * k[3] * x]])
    return np.eye(2, dtype=p.dtype) * (above / below)[:, None, None] + 2 * slope[:, None, None] * p[:, :, None] * p[:, None, :] + bent.transpose(2, 0, 1)


def complex_steps(p, k, wrong):
    """The same of whatever the lens is taken for: the imaginary part of a step along i."""
    h = 1e-30
    steps = [p + 1j * h * e for e in np.eye(2)]
    return np.stack([bend(step, k.astype(complex), wrong).imag / h for step in steps], 2)


def solved(target, k, wrong=()):
    """Newton's method for all points at once, on whatever the lens is taken for."""
    p = target
    for _ in range(25):
        j = complex_steps(p, k, wrong) if wrong else jacobians(p, k)
        p = p - np.linalg.solve(j, (bend(p, k, wrong) - target)[:, :, None])[:, :, 0].astype(p.dtype)
    return p


def lens_distort(a, c, wrong):
    """The lens."""
    k, p = read(a["coefficients"], wrong), a["points"]
    return {"distorted": solved(p, k) if "undone_instead" in wrong else bend(p, k, wrong)}


def of_lens(p, k, g, n):
    """The gradients of the first n coefficients."""
    r2, above, below = parts(p, k)
    x, y = p.T
    along = (p * g).sum(1) / below
    down = -along * above / below
    tangential = [2 * x * y * g[:, 0] + (r2 + 2 * y * y) * g[:, 1], (r2 + 2 * x * x) * g[:, 0] + 2 * x * y * g[:, 1]]
    columns = [along * r2, along * r2**2, *tangential, along * r2**3, down * r2, down * r2**2, down * r2**3]
    return np.array([column.sum() for column in columns[:n]], p.dtype)


def lens_distort_vjp(a, c, wrong):
    """J^T g."""
    k, p, g = read(a["coefficients"]), a["points"], a["grad_distorted"]
    g_p = (jacobians(p, k).transpose(0, 2, 1) @ g[:, :, None])[:, :, 0]
    if "radius_not_differentiated" in wrong:
        _, above, below = parts(p, k)
        g_p = g * (above / below)[:, None]
    g_k = of_lens(p, k, g, len(a["coefficients"]))
    return {"grad_points": g_p, "grad_coefficients": g_k * 0 if "lens_held_constant" in wrong else g_k}


def steps(target, k, n):
    """x = (x' - tangential) / radial, n times."""
    p = target
    for _ in range(n):
        _, above, below = parts(p, k)
        radial = (above / below)[:, None]
        p = (target - (bend(p, k) - p * radial)) / radial
    return p


def lens_undistort(a, c, wrong):
    """Newton's method."""
    k, target = read(a["coefficients"], wrong), a["distorted"]
    if "distorted_again" in wrong or "signs_flipped" in wrong:
        return {"points": bend(target, k)}
    for name, n in (("one_step", 1), ("few_steps", 5)):
        if name in wrong:
            return {"points": steps(target, k, n)}
    return {"points": solved(target, k, wrong)}


def lens_undistort_vjp(a, c, wrong):
    """J^-T g at the solution."""
    k, target, g = read(a["coefficients"]), a["distorted"], a["grad_points"]
    p = solved(target, k)
    j = jacobians(p, k).transpose(0, 2, 1)
    h = np.linalg.solve(j, g[:, :, None])[:, :, 0]
    g_k = -of_lens(p, k, h, len(a["coefficients"]))
    if "handed_through" in wrong:
        h = g
    if "jacobian_not_inverted" in wrong:
        h = (j @ g[:, :, None])[:, :, 0]
    return {"grad_distorted": h, "grad_coefficients": g_k * 0 if "lens_held_constant" in wrong else g_k}
