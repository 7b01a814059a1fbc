"""The second implementation's contraction and normalized device coordinates: a scale for each coordinate with the whole Jacobian, and a
perspective matrix. See second.py."""

import numpy as np


def scales(x, norm, wrong=()):
    """What each coordinate is multiplied by, and the length of each point."""
    sizes = np.abs(x)
    axis = None if "norm_of_all_points" in wrong else -1
    r = np.sqrt((x * x).sum(axis, keepdims=True)) if norm == "l2" else sizes.max(axis, keepdims=True)
    r = np.broadcast_to(r, (len(x), 1))
    r = r * r if "norm_squared" in wrong else r
    limit = 1 if "ends_at_one" in wrong else 2
    with np.errstate(divide="ignore", invalid="ignore"):
        inverse = 1 / r
        far = np.broadcast_to(limit - inverse if "not_divided_by_norm" in wrong else (limit - inverse) * inverse, x.shape)
        if norm == "merf" and not (set(wrong) & {"not_divided_by_norm", "norm_of_all_points", "norm_squared", "ends_at_one"}):
            first = np.arange(3) == sizes.argmax(-1)[:, None]
            far = np.where(first, far, inverse)
    return far, r


def spread(y, c):
    """The range of the convention."""
    return {"two": y, "one": y / 2, "unit": (y + 2) / 4}[c["contraction_range"]]


def contraction(a, c, wrong):
    """A scale times x."""
    x = 2 * a["x"] - 1 if "box_mapped_twice" in wrong else a["x"]
    if "coordinate_by_coordinate" in wrong:
        sizes = np.maximum(np.abs(x), 1)
        return {"contracted": spread(np.where(np.abs(x) > 1, np.sign(x) * (2 - 1 / sizes), x), c)}
    far, r = scales(x, c["contraction_norm"], wrong)
    with np.errstate(invalid="ignore"):
        outside = far * x
        if {"contracted_inside_too", "pieces_exchanged"} & set(wrong):
            with np.errstate(divide="ignore"):
                inside = (2 - 1 / r) / r * x
            outside = x if "pieces_exchanged" in wrong else outside
        else:
            inside = x
        y = np.where(r <= 1, inside, outside)
    if "not_a_number_at_origin" in wrong:
        y = np.where(r == 0, np.nan, y)
    if "half_of_the_range" in wrong:
        return {"contracted": (y + 1) / 2}
    return {"contracted": spread(y, c)}


def jacobians(x, norm):
    """dy_i / dx_j of each point, (M, 3, 3)."""
    far, r = scales(x, norm)
    safe = np.maximum(r, 1)
    k = np.abs(x).argmax(-1)
    pick = (np.arange(3) == k[:, None]).astype(x.dtype)
    slope = x / safe if norm == "l2" else pick * np.sign(x)
    of_scale = np.broadcast_to((2 / safe - 2) / (safe * safe), x.shape)
    if norm == "merf":
        of_scale = np.where(pick > 0, of_scale, -1 / (safe * safe))
    j = np.eye(3, dtype=x.dtype) * np.where(r > 1, far, 1)[:, :, None] + (of_scale * x)[:, :, None] * slope[:, None, :]
    return np.where((r > 1)[:, :, None], j, np.eye(3, dtype=x.dtype))


def contraction_vjp(a, c, wrong):
    """J^T g."""
    x = a["x"]
    g = a["grad_contracted"] * x.dtype.type({"two": 1, "one": 0.5, "unit": 0.25}[c["contraction_range"]])
    far, r = scales(x, "l2" if c["contraction_norm"] == "l2" else "linf")
    if "jacobian_dropped" in wrong:
        return {"grad_x": g}
    if "norm_held_constant" in wrong:
        return {"grad_x": np.where(r > 1, far, 1) * g}
    j = jacobians(x, c["contraction_norm"])
    if "diagonal_alone" in wrong:
        return {"grad_x": np.diagonal(j, axis1=1, axis2=2) * g}
    out = (j * g[:, :, None]).sum(1)
    return {"grad_x": np.where(r == 0, np.nan, out) if "gradient_not_a_number_at_origin" in wrong else out}


def ndc_rays(a, c, wrong):
    """Two points of each ray through a perspective matrix whose far plane is at infinity: on the near plane, and at infinity."""
    o, d = a["rays_o"], a["rays_d"]
    kind = o.dtype
    near = kind.type(1 if "near_taken_as_one" in wrong else a["near"])
    sign = kind.type(-1 if c["ndc_depth"] == "negative" else 1)
    sizes = [a["height"], a["width"]] if "size_swapped" in wrong else [a["width"], a["height"]]
    x, y = (kind.type((1 if "half_size_forgotten" in wrong else 2) * a["focal"] / size) for size in sizes)
    twice = 2 * near if "depth_of_the_other_axes" in wrong else -2 * near
    # Divided by z, whose sign the scales take, as codes do: what is divided by 0 has their infinity.
    matrix = np.array([[sign * x, 0, 0, 0], [0, sign * y, 0, 0], [0, 0, 1, sign * twice], [0, 0, 1, 0]], kind)
    plane = -sign * near if "moved_behind" in wrong else sign * near
    eps = kind.type(1e-5 if "eps_in_depth" in wrong else 0)
    p = o if "origin_not_moved" in wrong else o + ((plane - o[:, 2]) / (d[:, 2] + eps))[:, None] * d
    with np.errstate(divide="ignore", invalid="ignore"):
        start, end = (
            (h := np.concatenate([q, np.full_like(q[:, :1], w)], 1) @ matrix.T)[:, :3] / h[:, 3:] for q, w in ((p, 1), (d, 0))
        )
        ahead = end - start
        if "origin_not_subtracted" in wrong:
            ahead[:, :2] = end[:, :2]
        if "direction_normalized" in wrong:
            ahead = ahead / np.linalg.norm(ahead, axis=1, keepdims=True)
    return {"rays_o_ndc": start, "rays_d_ndc": ahead}


def ndc_rays_vjp(a, c, wrong):
    """Slopes u = d_x/|d_z| and starts p_x/near, and how both move with the ray."""
    o, d, kind = a["rays_o"], a["rays_d"], a["rays_o"].dtype
    sign, near = kind.type(-1 if c["ndc_depth"] == "negative" else 1), kind.type(a["near"])
    scales = np.array([2 * a["focal"] / a["width"], 2 * a["focal"] / a["height"]], kind)
    g_start = (a["grad_rays_o_ndc"] - a["grad_rays_d_ndc"])[:, :2] * scales / near
    g_slope = a["grad_rays_d_ndc"][:, :2] * scales * sign / d[:, 2:]
    if "slope_not_differentiated" in wrong:
        g_slope = np.zeros_like(g_slope)
    t = ((sign * near - o[:, 2]) / d[:, 2])[:, None]
    tilt = d[:, :2] / d[:, 2:]
    by_depth = -(g_start * tilt).sum(1, keepdims=True)
    g_t = -(g_slope * tilt).sum(1, keepdims=True) + t * by_depth
    if "shift_not_differentiated" in wrong:
        by_depth, g_t = np.zeros_like(by_depth), -(g_slope * tilt).sum(1, keepdims=True)
    return {"grad_rays_o": np.concatenate([g_start, by_depth], 1), "grad_rays_d": np.concatenate([t * g_start + g_slope, g_t], 1)}
