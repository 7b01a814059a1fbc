"""The second implementation's Gaussians: axes turned one by one as v + 2 w (r x v) + 2 r x (r x v), and summed as outer products. See
second.py."""

import numpy as np


def lengths(q, c, wrong):
    """What quaternions are divided by."""
    if c["quaternion_length"] == "as_given":
        return np.ones_like(q[:, :1])
    axis = None if "norm_of_all" in wrong else -1
    square = np.broadcast_to((q * q).sum(axis, keepdims=True), (len(q), 1))
    return square if "norm_squared" in wrong else np.sqrt(square)


def turned(q, v):
    """v turned by the quaternion (w, r): v + 2 w (r x v) + 2 r x (r x v)."""
    w, r = q[:, :1], q[:, 1:]
    once = np.cross(r, v)
    return v + 2 * w * once + 2 * np.cross(r, once)


def rotations(q):
    """(M, 3, 3): column k is where axis k goes."""
    return np.stack([turned(q, np.broadcast_to(axis, (len(q), 3))) for axis in np.eye(3, dtype=q.dtype)], -1)


def deviations(a, c):
    """Standard deviations."""
    return np.exp(a["scales"]) if c["splat_scale"] == "log" else a["scales"]


def real_first(a, c):
    """Quaternions as (w, x, y, z)."""
    return a["quaternions"] if c["quaternion_order"] == "wxyz" else np.roll(a["quaternions"], 1, -1)


def gaussian_covariance(a, c, wrong):
    """The sum of s_k^2 times the outer product of axis k with itself."""
    q, s = real_first(a, c), deviations(a, c)
    r = rotations(q / lengths(q, c, wrong))
    if "rotation_transposed" in wrong:
        r = r.transpose(0, 2, 1)
    if "rotation_cancels" in wrong:
        return {"covariances": s[:, :, None] * (r @ r.transpose(0, 2, 1)) * s[:, None, :]}
    variances = s if "scale_not_squared" in wrong else s * s
    outer = r[:, :, None, :] * r[:, None, :, :]
    return {"covariances": (outer * variances[:, None, None, :]).sum(-1)}


def gaussian_covariance_vjp(a, c, wrong):
    """Turns and squares of axes, differentiated one after the other."""
    q, s, g = real_first(a, c), deviations(a, c), a["grad_covariances"]
    if "off_diagonal_twice" in wrong:
        diagonal = np.eye(3, dtype=g.dtype)
        g = (g + g.transpose(0, 2, 1)) - diagonal * g
    length = lengths(q, c, [])
    u = q / length
    r = rotations(u)
    # Of axis k, a column: s_k^2 (g + g^T) r_k; of s_k: 2 s_k r_k^T g r_k.
    both = g if "one_factor_alone" in wrong else g + g.transpose(0, 2, 1)
    of_axes = np.einsum("mij,mjk->mik", both, r) * (s * s)[:, None, :]
    g_s = np.einsum("mik,mij,mjk->mk", r, both, r) * s
    w, v = u[:, :1], u[:, 1:]
    g_w, g_v = np.zeros_like(w), np.zeros_like(v)
    for k, axis in enumerate(np.eye(3, dtype=q.dtype)):
        e, g_k = np.broadcast_to(axis, v.shape), of_axes[:, :, k]
        once = np.cross(v, e)
        g_w += 2 * (once * g_k).sum(-1, keepdims=True)
        g_once = 2 * w * g_k + 2 * np.cross(g_k, v)
        g_v += np.cross(e, g_once) + 2 * np.cross(once, g_k)
    g_u = np.concatenate([g_w, g_v], -1)
    if c["quaternion_length"] == "divided" and "normalization_not_differentiated" not in wrong:
        g_u = (g_u - (g_u * u).sum(-1, keepdims=True) * u) / length
    if c["quaternion_order"] == "xyzw":
        g_u = np.roll(g_u, -1, -1)
    if (c["splat_scale"] == "log") != ("gradient_of_the_other_scale" in wrong):
        g_s = g_s * s
    return {"grad_quaternions": g_u, "grad_scales": g_s}
