"""The second implementation's poses: quaternion products, and the 4x4 matrix inverted. See second.py."""

import numpy as np


def matrices(q):
    """L(q) and M(q) with q p = L p and p q = M p, for quaternions (w, x, y, z)."""
    w, x, y, z = q.T
    left = np.array([[w, -x, -y, -z], [x, w, -z, y], [y, z, w, -x], [z, -y, x, w]]).transpose(2, 0, 1)
    right = np.array([[w, -x, -y, -z], [x, w, z, -y], [y, -z, w, x], [z, y, -x, w]]).transpose(2, 0, 1)
    return left, right


def rotations(q, c):
    """q p q* of the axes, divided by |q|^2; as given: I less what is missing of it."""
    left, right = matrices(q)
    sizes = (q * q).sum(1)[:, None, None]
    turned = (left @ right.transpose(0, 2, 1))[:, 1:, 1:]
    eye = np.eye(3, dtype=q.dtype)
    return turned / sizes if c["quaternion"] == "normalized" else turned + (1 - sizes) * eye


def signs(c, kind):
    """Of the columns."""
    return np.array([1, 1, 1] if c["axes"] == "opencv" else [1, -1, -1], kind)


def pose_from_colmap(a, c, wrong):
    """The inverse of [R t; 0 1]; as given R isn't quite a rotation, and is transposed."""
    q, t = a["q"], a["t"][:, :, None]
    if "scalar_last" in wrong:
        q = np.roll(q, 1, 1)
    if "conjugated" in wrong:
        q = q * np.array([1, -1, -1, -1], q.dtype)
    r = rotations(q, c)
    back = r.transpose(0, 2, 1)
    place = -back @ t
    for name, other in (
        ("translation_not_turned", -t),
        ("translation_not_negated", back @ t),
        ("rotation_alone_inverted", t),
        ("not_inverted", t),
    ):
        if name in wrong:
            place = other
    if {"rotation_not_transposed", "not_inverted"} & set(wrong):
        back = r
    if not wrong and c["quaternion"] == "normalized":
        full = np.zeros((len(q), 4, 4), q.dtype)
        full[:, :3, :3], full[:, :3, 3:], full[:, 3, 3] = r, t, 1
        inverse = np.linalg.inv(full)
        back, place = inverse[:, :3, :3], inverse[:, :3, 3:]
    if "place_flipped" in wrong:
        place = place * np.array([1, -1, -1], q.dtype)[:, None]
    upper = np.concatenate([back * signs(c, q.dtype), place], 2)
    if "world_axes_flipped" in wrong:
        upper = upper * np.array([1, -1, -1], q.dtype)[:, None]
    last = np.zeros((len(q), 1, 4), q.dtype)
    last[:, 0, 3] = 1
    return {"c2w": np.concatenate([upper, last], 1)}


def pose_from_colmap_vjp(a, c, wrong):
    """The gradient of L(q) M(q)^T by both factors, and of the division."""
    q, t, g = a["q"], a["t"], a["grad_c2w"]
    r = rotations(q, c)
    place = g[:, :3, 3]
    pull = (g[:, :3, :3] * signs(c, q.dtype)).transpose(0, 2, 1)
    if "place_held_constant" not in wrong:
        pull = pull - t[:, :, None] * place[:, None, :]
    left, right = matrices(q)
    full = np.zeros((len(q), 4, 4), q.dtype)
    full[:, 1:, 1:] = pull
    on_left, on_right = full @ right, (full.transpose(0, 2, 1) @ left)
    basis = np.eye(4, dtype=q.dtype)
    l_basis, r_basis = matrices(basis)
    g_q = np.einsum("nij,kij->nk", on_left, l_basis) + np.einsum("nij,kij->nk", on_right, r_basis)
    sizes = (q * q).sum(1, keepdims=True)
    if c["quaternion"] == "normalized":
        g_q = g_q / sizes - 2 * q * (pull * r).sum((1, 2))[:, None] / sizes
    else:
        g_q = g_q - 2 * q * np.trace(pull, axis1=1, axis2=2)[:, None]
    return {"grad_q": g_q, "grad_t": -(r @ place[:, :, None])[:, :, 0]}
