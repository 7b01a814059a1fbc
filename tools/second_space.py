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


def far_jacobians(x, norm):
    """Those of the far piece, whatever the length: as of a point that is far, with its own length's factors."""
    sizes = np.abs(x)
    r = np.sqrt((x * x).sum(-1)) if norm == "l2" else sizes.max(-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        u, k = x / r[:, None], sizes.argmax(-1)
        pick = (np.arange(3) == k[:, None]).astype(x.dtype)
        slope = u if norm == "l2" else pick * np.sign(x)
        s, along = (2 - 1 / r) / r, 1 / (r * r)
        across = np.broadcast_to(s[:, None], x.shape) if norm != "merf" else np.where(pick > 0, s[:, None], 1 / r[:, None])
        bent = np.where(pick > 0, (along - s)[:, None], -1 / r[:, None]) if norm == "merf" else (along - s)[:, None]
        return np.eye(3, dtype=x.dtype) * across[:, :, None] + (bent * u)[:, :, None] * slope[:, None, :]


def wrong_jacobians(x, norm, wrong):
    """J of each mean, with mistakes in it."""
    length = {"l2": np.sqrt((x * x).sum(-1)), "linf": np.abs(x).max(-1)}
    own, other = ("l2", "linf") if norm == "l2" else ("linf", "l2")
    eye = np.broadcast_to(np.eye(3, dtype=x.dtype), (len(x), 3, 3))
    if "jacobian_at_contracted_point" in wrong:
        far, r = scales(x, norm)
        with np.errstate(invalid="ignore"):
            x = np.where(r > 1, far * x, x)
    if "jacobian_of_another_norm" in wrong:
        return jacobians(x, other)
    if "far_jacobian_everywhere" in wrong:
        return far_jacobians(x, norm)
    if "branch_by_another_norm" in wrong:
        return np.where((length[other] < 1)[:, None, None], eye, far_jacobians(x, norm))
    if "shrunk_as_a_ball" in wrong:
        r = np.maximum(length[own], 1)
        return eye * ((2 - 1 / r) / r)[:, None, None]
    j = jacobians(x, norm)
    if "covariance_not_a_number_at_origin" in wrong:
        return np.where((length[own] == 0)[:, None, None], np.nan, j)
    return j


def contract_gaussians(a, c, wrong):
    """Means as points; covariances by products of stacks."""
    x, sigma = a["means"], a["covariances"]
    norm, kind = c["contraction_norm"], x.dtype.type
    means = contraction({"x": x}, c, ())["contracted"]
    j = wrong_jacobians(x, norm, wrong) * kind({"two": 1, "one": 0.5, "unit": 0.25}[c["contraction_range"]])
    if "batch_axis_last" in wrong:
        j = j.transpose(1, 2, 0).reshape(j.shape)
    if "covariance_kept" in wrong:
        return {"contracted_means": means, "contracted_covariances": sigma}
    if "diagonal_contracted" in wrong:
        sigma = sigma * np.eye(3, dtype=x.dtype)
    if "covariance_taken_for_points" in wrong:
        rows = contraction({"x": sigma.reshape(-1, 3)}, {**c, "contraction_range": "two"}, ())["contracted"].reshape(sigma.shape)
        sigma = np.where((scales(x, norm)[1] > 1)[:, :, None], rows, sigma)
    half = j @ sigma
    return {"contracted_means": means, "contracted_covariances": half if "one_side_alone" in wrong else half @ j.transpose(0, 2, 1)}


def bends(x, norm):
    """d J_ij / d x_a of each point, (M, 3, 3, 3), 0 inside."""
    _, r = scales(x, "l2" if norm == "l2" else "linf")
    far, r, eye = r[:, 0] > 1, np.maximum(r[:, 0], 1), np.eye(3, dtype=x.dtype)
    k = np.abs(x).argmax(-1)
    pick = (np.arange(3) == k[:, None]).astype(x.dtype)
    u, slope = x / r[:, None], x / r[:, None] if norm == "l2" else pick * np.sign(x)
    p = -1 / (r * r) if norm == "merf" else -2 * (1 - 1 / r) / (r * r)
    t = np.einsum("ma,ij->mija", slope, eye) + np.einsum("mj,ia->mija", slope, eye)
    if norm == "l2":
        t = t + np.einsum("mi,ja->mija", slope, eye)
        of_p = (6 - 8 / r) / (r * r)
    else:
        of_p = (4 - 6 / r) / (r * r) if norm == "linf" else 2 / (r * r)
    t = p[:, None, None, None] * t + of_p[:, None, None, None] * np.einsum("mi,mj,ma->mija", u, slope, slope)
    if norm == "merf":
        rows = np.einsum("m,mj,ma->mja", -2 / r**3, slope, pick)
        t = np.where(pick[:, :, None, None] > 0, rows[:, None] * np.ones((1, 3, 1, 1), x.dtype), t)
    return np.where(far[:, None, None, None], t, 0)


def contract_gaussians_vjp(a, c, wrong):
    """Both factors' gradients through the whole tensor of second derivatives."""
    x, sigma, kind = a["means"], a["covariances"], a["means"].dtype.type
    norm, scale = c["contraction_norm"], kind({"two": 1, "one": 0.5, "unit": 0.25}[c["contraction_range"]])
    g, j = a["grad_contracted_covariances"] * scale * scale, jacobians(x, norm)
    across = j.transpose(0, 2, 1)
    mean = (across * (scale * a["grad_contracted_means"])[:, None, :]).sum(-1)
    once, twice = g @ j @ sigma.transpose(0, 2, 1), g.transpose(0, 2, 1) @ j @ sigma
    if "one_factor_differentiated" in wrong:
        twice = np.zeros_like(twice)
    if "jacobian_detached" not in wrong:
        mean = mean + np.einsum("mij,mija->ma", once + twice, bends(x, norm))
    covariance = a["grad_contracted_covariances"] if "gradient_of_covariance_kept" in wrong else across @ g @ j
    return {"grad_means": mean, "grad_covariances": covariance}


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
