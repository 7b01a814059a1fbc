"""The second implementation's cameras, rays and samples: the textbook's matrix products. See second.py."""

import numpy as np


def turned(c2w):
    """R^T in the place of R."""
    out = c2w.copy()
    out[..., :3, :3] = np.swapaxes(c2w[..., :3, :3], -1, -2)
    return out


def flip(x, wrong):
    """Axes turned around."""
    axes = next((name.removeprefix("flipped_") for name in wrong if name.startswith("flipped_")), "")
    return x * np.array([-1 if axis in axes else 1 for axis in "xyz"], x.dtype)


def inverse(m):
    """Inverse matrices; in a longer type, which LAPACK hasn't got, by Newton's steps from its own."""
    out = np.linalg.inv(m.astype(m.dtype if m.dtype != np.longdouble else np.float64)).astype(m.dtype)
    for _ in range(2 if m.dtype == np.longdouble else 0):
        out = out @ (2 * np.eye(m.shape[-1], dtype=m.dtype) - m @ out)
    return out


def transform(a, c, wrong):
    """x_w = R x_c + o."""
    m = turned(a["c2w"]) if "rotation_transposed" in wrong else a["c2w"].copy()
    if "inverse_pose" in wrong:
        m = inverse(m)
    if "translation_missing" in wrong:
        m[:, :3, 3] = 0
    x = np.concatenate([flip(a["x_c"], wrong), np.ones_like(a["x_c"][:, :1])], 1)
    return {"x_w": (m @ x[..., None])[:, :3, 0]}


def transform_vjp(a, c, wrong):
    """g_R = g x^T, g_o = g, g_x = R^T g."""
    g, x = a["grad_x_w"], a["x_c"]
    g_c2w = np.zeros_like(a["c2w"])
    g_c2w[:, :3, :3] = g[:, :, None] * x[:, None, :]
    g_c2w[:, :3, 3] = g
    return {"grad_c2w": g_c2w, "grad_x_c": (np.swapaxes(a["c2w"][:, :3, :3], 1, 2) @ g[..., None])[..., 0]}


def point(k, uv, wrong):
    """K^-1 (u, v, 1) by the matrix."""
    k = k.copy()
    if "center_swapped" in wrong:
        k[0, 2], k[1, 2] = k[1, 2], k[0, 2]
    if "center_floored" in wrong:
        k[:2, 2] = np.floor(k[:2, 2])
    if "focal_ignored" in wrong:
        k[0, 0] = k[1, 1] = 1
    if "one_focal_length" in wrong:
        k[1, 1] = k[0, 0]
    if "focals_swapped" in wrong:
        k[0, 0], k[1, 1] = k[1, 1], k[0, 0]
    if "intrinsics_not_rescaled" in wrong:
        k[:2] *= 2
    if "focal_scaled" in wrong:
        k[0, 0], k[1, 1] = 2 * k[0, 0], 2 * k[1, 1]
    uv = uv - (0.5 if "no_half_pixel" in wrong else 1 if "minus_half_pixel" in wrong else 0)
    uv = uv[..., ::-1] if "row_column_swapped" in wrong else uv
    ones = np.ones_like(uv[..., :1])
    if "K_transposed" in wrong:
        x = uv / np.diag(k)[:2]
        return np.concatenate([x, ones - x @ k[:2, 2:]], -1)
    if "K_for_inverse" in wrong:
        return np.concatenate([uv, ones], -1) @ k.T
    return np.concatenate([(uv - k[:2, 2]) / np.diag(k)[:2], ones], -1)


def pixel_to_camera(a, c, wrong):
    """s K^-1 (u, v, 1)."""
    s = np.ones_like(a["s"]) if "depth_forgotten" in wrong else a["s"]
    axes = np.array([1, 1, 1] if c["camera_axes"] == "opencv" else [1, -1, -1], s.dtype)
    return {"x_c": flip(point(a["K"], a["uv"], wrong) * s[:, None], wrong) * axes}


def pixel_to_camera_vjp(a, c, wrong):
    """By the chain rule through x = (u - cx) / fx."""
    focal, center, s, g = np.diag(a["K"])[:2], a["K"][:2, 2], a["s"][:, None], a["grad_x_c"]
    g = g * np.array([1, 1, 1] if c["camera_axes"] == "opencv" else [1, -1, -1], g.dtype)
    x = (a["uv"] - center) / focal
    g_uv = g[:, :2] * s / focal
    g_k = np.zeros_like(a["K"])
    g_k[0, 0], g_k[1, 1] = -(g_uv * x).sum(0)
    g_k[:2, 2] = -g_uv.sum(0)
    return {"grad_K": g_k, "grad_uv": g_uv, "grad_s": (g[:, :2] * x).sum(1) + g[:, 2]}


def rays(k, c2w, uv, c, wrong):
    """The textbook's way: a point at depth 1 to world space, minus the origin, divided by its length."""
    x = flip(point(k, uv, wrong), wrong) * np.array([1, 1, 1] if c["axes"] == "opencv" else [1, -1, -1], uv.dtype)
    if c["directions"] == "unit_in_camera":
        x = x / np.linalg.norm(x, axis=-1, keepdims=True)
    c2w = inverse(c2w) if "inverse_pose" in wrong else c2w
    m = turned(c2w) if "rotation_transposed" in wrong else c2w
    o = np.broadcast_to(c2w[..., :3, 3], x.shape)
    x_w = (m[..., :3, :3] @ x[..., None])[..., 0] + o
    d = x_w if "translation_in_direction" in wrong else x_w - o
    if c["directions"] == "unit":
        norms = np.linalg.norm(d, axis=None if "norm_of_all_rays" in wrong else -1, keepdims=True)
        d = d / (norms[..., 0] if "norm_without_axis" in wrong and d.shape == (3, 3) else norms)
    if "origin_minus_rt" in wrong:
        o = -(np.swapaxes(c2w[..., :3, :3], -1, -2) @ o[..., None])[..., 0]
    if "origin_minus_inverse_rt" in wrong:
        o = -(inverse(c2w[..., :3, :3]) @ o[..., None])[..., 0]
    if "origin_normalized" in wrong:
        with np.errstate(invalid="ignore"):
            o = o / np.linalg.norm(o, axis=-1, keepdims=True)
    return o, d


def pixel_to_ray(a, c, wrong):
    """Origin and direction."""
    o, d = rays(a["K"], a["c2w"], a["uv"], c, wrong)
    return {"rays_o": o, "rays_d": d}


def pixel_to_ray_vjp(a, c, wrong):
    """Through d = q / |q|, q = R x, x = K^-1 (u, v, 1)."""
    focal, r = np.diag(a["K"])[:2], a["c2w"][:, :3, :3]
    signs = np.array([1, 1, 1] if c["axes"] == "opencv" else [1, -1, -1], focal.dtype)
    x = point(a["K"], a["uv"], ()) * signs
    if c["directions"] == "unit_in_camera":
        length = np.linalg.norm(x, axis=1, keepdims=True)
        x, ray = x / length, x
    q = (r @ x[..., None])[..., 0]
    g = a["grad_rays_d"]
    if c["directions"] == "unit":
        norm = np.linalg.norm(q, axis=1, keepdims=True)
        d = q / norm
        g = g / norm if "norm_detached" in wrong else (g - d * (d * g).sum(1, keepdims=True)) / norm
    g_c2w = np.zeros_like(a["c2w"])
    g_c2w[:, :3, :3], g_c2w[:, :3, 3] = g[:, :, None] * x[:, None, :], a["grad_rays_o"]
    g_x = (np.swapaxes(r, 1, 2) @ g[..., None])[..., 0]
    if c["directions"] == "unit_in_camera":
        g_x = (g_x - x * (x * g_x).sum(1, keepdims=True)) / length
        x = ray
    g_x = g_x * signs
    g_uv = g_x[:, :2] / focal
    g_k = np.zeros_like(a["K"])
    g_k[0, 0], g_k[1, 1] = -(g_uv * x[:, :2] * signs[:2]).sum(0)
    g_k[:2, 2] = -g_uv.sum(0)
    return {"grad_K": g_k, "grad_c2w": g_c2w, "grad_uv": g_uv}


def image_rays(a, c, wrong):
    """Rays of all pixels."""
    kind = a["c2w"].dtype
    v, u = np.indices((a["height"], a["width"])).astype(kind) + (0.5 if c["pixel_center"] == "half" else 0)
    uv = np.stack([u, v], -1)
    if "grid_size_swapped" in wrong:
        u, v = np.meshgrid(np.arange(a["height"], dtype=kind), np.arange(a["width"], dtype=kind))
        uv = np.stack([u, v], -1).reshape(uv.shape) + (0.5 if c["pixel_center"] == "half" else 0)
    if "pixels_to_the_edges" in wrong and min(uv.shape[:2]) > 1:
        ends = [np.linspace(0, size, size, dtype=kind) for size in (a["width"], a["height"])]
        uv = np.stack(np.meshgrid(*ends), -1)
    if "half_pixel_upward" in wrong:
        v, u = np.indices((a["height"], a["width"])).astype(kind)
        uv = np.stack([u + kind.type(0.5), v - kind.type(0.5)], -1)
    if "picture_refolded" in wrong:
        uv = np.swapaxes(uv, 0, 1).reshape(uv.shape)
    if "picture_transposed" in wrong:
        uv = np.swapaxes(uv, 0, 1)
    k = np.array([[a["focal"], 0, a["cx"]], [0, a["focal"], a["cy"]], [0, 0, 1]], kind)
    if "one_angle_for_both_axes" in wrong:
        k[1, 1] = k[1, 1] * kind.type(a["height"]) / kind.type(a["width"])
    o, d = rays(k, a["c2w"], uv, c, wrong)
    return {"uv": uv[..., ::-1] if "row_column_swapped" in wrong else uv, "rays_o": o, "rays_d": d}


def positions(near, far, u, grid):
    """t of samples (..., N)."""
    n = u.shape[-1]
    i, width = np.arange(n, dtype=u.dtype), (far - near) / n
    spacing = (far - near) / (n - 1) if n > 1 else 0.0
    if grid == "intervals":
        return near + (i + u) * width
    if grid == "ends_plus_width":
        return near + i * spacing + u * width
    if grid == "ends_plus_spacing":
        return near + (i + u) * spacing
    ends = near + i * spacing
    mids = (ends[1:] + ends[:-1]) / 2
    lower, upper = np.concatenate([ends[:1], mids]), np.concatenate([mids, ends[-1:]])
    return lower + (upper - lower) * u


def sample_along_rays(a, c, wrong):
    """t and o + t d."""
    u, near, far = a["u"], a["near"], a["far"]
    if "one_jitter_for_all_rays" in wrong:
        u = np.broadcast_to(u[:1], u.shape)
    if "unit_interval" in wrong:
        near, far = 0.0, 1.0
    grid = c["grid"]
    if "never_jittered" in wrong:
        u = np.full_like(u, 0.5 if grid == "intervals" else 0)
        grid = grid if grid == "intervals" else "ends_plus_width"
    if "left_edges_alone" in wrong:
        u = np.zeros_like(u)
    if "one_bin_early" in wrong:
        u = u - 1
    if "jitter_centered_on_edges" in wrong:
        u = u - 0.5
    for name in wrong:
        if name.startswith("jitter_width"):
            width = 0.05 if name == "jitter_width" else float(name.removeprefix("jitter_width_"))
            u = u * (width * u.shape[-1] / (far - near))
    t = positions(near, far, u, grid)
    if "middles_not_halved" in wrong:
        edges = near + np.arange(u.shape[-1] + 1, dtype=u.dtype) * ((far - near) / u.shape[-1])
        t = np.broadcast_to(edges[:-1] + edges[1:] / 2, u.shape)
    o = np.zeros_like(a["rays_o"]) if "points_without_origin" in wrong else a["rays_o"]
    d = a["rays_d"]
    if "unit_directions" in wrong:
        d = d / np.sqrt((d * d).sum(1, keepdims=True))
    points = o[:, None] + t[..., None] * d[:, None]
    if "flattened_in_wrong_order" in wrong:
        points = np.swapaxes(points, 0, 1).reshape(points.shape)
    return {"t": t, "points": points}


def step_sizes(a, c, wrong):
    """D, or differences of t."""
    t, near, far = a["t"], a["near"], a["far"]
    n = t.shape[-1]
    gaps = np.concatenate([np.diff(t), far - t[:, -1:]], 1)
    deltas = np.full_like(t, (far - near) / n)
    if c["delta"] == "midpoints":
        ends = [np.full_like(t[:, :1], x) for x in (near, far)]
        deltas = np.diff(np.concatenate([ends[0], (t[:, 1:] + t[:, :-1]) / 2, ends[1]], 1))
    elif c["delta"] == "central":
        between = gaps[:, :-1]
        if n > 1:
            deltas = np.concatenate([between[:, :1], (between[:, 1:] + between[:, :-1]) / 2, between[:, -1:]], 1)
    elif c["delta"] != "width":
        between = gaps[:, :-1]
        last = {"width": (far - near) / n, "1e10": 1e10, "1e9": 1e9, "1e-3": 1e-3, "to_far": gaps[:, -1]}
        if n > 1:
            last |= {"repeated": between[:, -1], "mean": between.mean(1)}
        deltas = gaps.copy()
        deltas[:, -1] = last.get(c["last_delta"], last["width"])
    if "delta_missing" in wrong:
        deltas = np.ones_like(t)
    if "delta_unit_interval" in wrong:
        deltas = np.full_like(t, 1 / n)
    if "delta_over_n_minus_1" in wrong and n > 1:
        deltas = np.full_like(t, (far - near) / (n - 1))
    if "backward_delta" in wrong:
        deltas = np.concatenate([np.zeros_like(t[:, :1]), np.diff(t)], 1)
    if "delta_differenced_twice" in wrong:
        deltas = np.concatenate([np.diff(gaps), np.full_like(t[:, :1], 1e10)], 1)
    if "last_gap_too_early" in wrong and n > 2:
        deltas = np.concatenate([deltas[:, :-1], gaps[:, n - 3 : n - 2]], 1)
    if "first_gap_for_all" in wrong and n > 1:
        deltas = np.broadcast_to(gaps[:, :1], t.shape)
    if "first_ray_deltas" in wrong:
        deltas = np.broadcast_to((gaps if n > 1 else deltas)[:1], t.shape)
    return {"deltas": deltas}
