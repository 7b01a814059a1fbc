"""The second implementation's Gaussians: axes turned one by one as v + 2 w (r x v) + 2 r x (r x v), and summed as outer products. See
second.py."""

import numpy as np
import second_harmonics


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


PAIRS = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)]
SIX = [0, 1, 2, 1, 3, 4, 2, 4, 5]


def camera(a, c, wrong):
    """What a camera sees of means: t, slopes, what the Jacobian has of them, which are held there, f / z and the focal lengths."""
    kind, w2c, k = a["means"].dtype, a["w2c"], a["K"]
    t = a["means"] @ w2c[:3, :3].T + w2c[:3, 3]
    focal, center = k[[0, 1], [0, 1]], k[:2, 2]
    slopes = t[:, :2] / t[:, 2:]
    sizes = np.array([a["width"], a["height"]], kind)
    half = sizes / (2 * focal)
    low, high = {
        "picture": (-(center / focal + kind.type(0.3) * half), (sizes - center) / focal + kind.type(0.3) * half),
        "centered": (-kind.type(1.3) * half, kind.type(1.3) * half),
        "none": (np.full(2, -np.inf, kind), np.full(2, np.inf, kind)),
    }[c["splat_clamp"]]
    held = np.clip(slopes, low, high)
    own = focal[[0, 0]] if "one_focal" in wrong else focal
    return t, slopes, held, held != slopes, own / t[:, 2:], focal


def jacobians(t, held, scale, wrong):
    """(M, 2, 3)."""
    along = -scale * held
    if "jacobian_signs" in wrong:
        along = -along
    if "jacobian_not_squared" in wrong:
        along = along * t[:, 2:]
    if "clamped_without_depth" in wrong:
        along = along / t[:, 2:]
    zero = np.zeros_like(along[:, 0])
    rows = [np.stack([scale[:, 0], zero, along[:, 0]], -1), np.stack([zero, scale[:, 1], along[:, 1]], -1)]
    return np.stack(rows, 1)


def three(m):
    """xx, xy, yy of 2 x 2 matrices."""
    return np.stack([m[:, 0, 0], m[:, 0, 1], m[:, 1, 1]], -1)


def gaussian_projection(a, c, wrong):
    """Sigma in the camera's axes, then J Sigma J^T; eigenvalues by the trace and the determinant."""
    kind = a["means"].dtype.type
    t, slopes, held, _, scale, focal = camera(a, c, wrong)
    turn = a["w2c"][:3, :3]
    turn = np.eye(3, dtype=turn.dtype) if "not_turned" in wrong else turn.T if "turned_back" in wrong else turn
    sigma = turn @ a["covariances"][:, SIX].reshape(-1, 3, 3) @ turn.T
    j = jacobians(t, held, scale, wrong)
    before = j @ sigma @ j.transpose(0, 2, 1)
    h = kind(0 if "not_dilated" in wrong else float(c["splat_dilation"]))
    after = before + h * (np.ones((2, 2), kind) if "every_entry_dilated" in wrong else np.eye(2, dtype=kind))
    x, y, z = three(after).T
    dets = [m[:, 0, 0] * m[:, 1, 1] - m[:, 0, 1] * m[:, 0, 1] for m in (before, after)]
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.maximum(np.divide(*held_up(dets, c)), 0)
        sign = 1 if "conic_sign" in wrong else -1
        ends = (x, z) if "conic_not_swapped" in wrong else (z, x)
        conic = np.stack([ends[0], sign * y, ends[1]], -1) / dets[1][:, None]
    least = kind(0 if c["radius_floor"] == "none" else float(c["radius_floor"]))
    apart = np.sqrt(np.maximum((x - z) ** 2 / 4 + y * y, least))
    larger = (x + z) / 2 + (-apart if "radius_of_the_short_axis" in wrong else apart)
    floor = kind(0.005 if c["compensation_floor"] == "0.005" else 0)
    seen = held if "mean_clamped_too" in wrong else slopes
    found = {
        "means2d": seen * focal + a["K"][:2, 2] - kind(0.5 if c["splat_center"] == "integer" else 0),
        "covariances2d": three(after),
        "conics": conic,
        "depths": np.linalg.norm(t, axis=1) if "distance_for_depth" in wrong else t[:, 2],
        "radii": np.ceil(3 * (larger if "radius_of_variance" in wrong else np.sqrt(np.maximum(larger, 0)))),
        "compensations": np.maximum(ratio if "compensation_squared" in wrong else np.sqrt(ratio), floor),
    }
    kept = not_culled(found["means2d"], found["radii"], a, c)
    return {name: np.where(kept[:, None] if each.ndim == 2 else kept, each, 0) for name, each in found.items()}


def held_up(dets, c):
    """Determinants, at least their floor."""
    floor = c["compensation_floor"]
    return [np.maximum(det, det.dtype.type(float(floor[13:]))) for det in dets] if floor.startswith("determinants_") else dets


def not_culled(means, radii, a, c):
    """Whether a splat's circle reaches into the picture, where others are culled."""
    sizes, reach = np.array([a["width"], a["height"]]), radii[:, None]
    return ((means + reach > 0) & (means - reach < sizes)).all(1) | (c["splat_culling"] == "kept")


def gaussian_projection_vjp(a, c, wrong):
    """Matrices differentiated as matrices: of an inverse, of a determinant, of J Sigma J^T."""
    kind = a["means"].dtype.type
    t, slopes, held, clamped, scale, focal = camera(a, c, wrong)
    turn = a["w2c"][:3, :3]
    sigma = turn @ a["covariances"][:, SIX].reshape(-1, 3, 3) @ turn.T
    j = jacobians(t, held, scale, [])
    before = j @ sigma @ j.transpose(0, 2, 1)
    after = before + kind(float(c["splat_dilation"])) * np.eye(2, dtype=kind)
    dets = [m[:, 0, 0] * m[:, 1, 1] - m[:, 0, 1] * m[:, 0, 1] for m in (before, after)]

    def symmetric(g):
        return np.stack([g[:, 0], g[:, 1] / 2, g[:, 1] / 2, g[:, 2]], -1).reshape(-1, 2, 2)

    def adjugate(m):
        return np.stack([m[:, 1, 1], -m[:, 0, 1], -m[:, 1, 0], m[:, 0, 0]], -1).reshape(-1, 2, 2)

    inverse = adjugate(after) / dets[1][:, None, None]
    g = symmetric(a["grad_covariances2d"]) - inverse @ symmetric(a["grad_conics"]) @ inverse
    up = held_up(dets, c)
    ratio = np.maximum(up[0] / up[1], 0)
    root = np.sqrt(ratio)
    learns = root > kind(0.005 if c["compensation_floor"] == "0.005" else 0)
    if "compensation_not_differentiated" not in wrong:
        with np.errstate(divide="ignore", invalid="ignore"):
            g_ratio = np.where(learns, a["grad_compensations"] / (2 * root), 0)
        # What is held up doesn't learn.
        of_dets = [np.where(own == at_least, g_ratio / up[1], 0) for own, at_least in zip(dets, up)]
        g = g + of_dets[0][:, None, None] * adjugate(before) - (of_dets[1] * ratio)[:, None, None] * adjugate(after)
    g_sigma = turn.T @ (j.transpose(0, 2, 1) @ g @ j) @ turn
    g_six = np.stack([g_sigma[:, n, m] + (g_sigma[:, m, n] if n != m else 0) for n, m in PAIRS], -1)
    if "off_diagonal_once" in wrong:
        g_six[:, [1, 2, 4]] /= 2
    # J's entries: f / z and -(f / z) slope.
    g_j = 2 * g @ j @ sigma
    own, along = g_j[:, [0, 1], [0, 1]], g_j[:, :, 2]
    free = np.ones_like(clamped) if "clamp_not_differentiated" in wrong else ~clamped
    by_depth = scale / t[:, 2:]
    g_slopes = np.where(free, -scale * along, 0)
    of_z = (by_depth * (held * along - own)).sum(1)
    if c["splat_clamp_gradient"] == "held":
        of_z = of_z + np.where(free, 0, by_depth * held * along).sum(1)
    g_shape = np.concatenate([g_slopes / t[:, 2:], (of_z - (g_slopes * held / t[:, 2:]).sum(1))[:, None]], 1)
    g_place = a["grad_means2d"] * focal / t[:, 2:]
    g_t = np.concatenate([g_place, (a["grad_depths"] - (g_place * slopes).sum(1))[:, None]], 1)
    if "jacobian_held" not in wrong:
        g_t = g_t + g_shape
    g_means = g_t if "gradient_not_turned_back" in wrong else g_t @ turn
    kept = gaussian_projection(a, c, [])["radii"][:, None] > 0
    return {"grad_means": np.where(kept, g_means, 0), "grad_covariances": np.where(kept, g_six, 0)}


def at_pixels(a, c, wrong):
    """Offsets, exponents, Gaussians, opacities before they are cut, and which are seen."""
    kind = a["pixels"].dtype.type
    pixels = a["pixels"][:, ::-1] if "axes_swapped" in wrong else a["pixels"]
    d = pixels[:, None] - a["means2d"][None]
    conic = a["conics"][:, [0, 1, 1, 2]].reshape(-1, 2, 2)
    if "covariance_for_conic" in wrong:
        conic = np.linalg.inv(conic)
    if "cross_term_halved" in wrong:
        conic = conic * np.array([[1, 0.5], [0.5, 1]], kind)
    power = -np.einsum("pgi,gij,pgj->pg", d, conic, d) * kind(1 if "half_forgotten" in wrong else 0.5)
    gaussian = np.exp(power)
    opacity = np.ones_like(a["opacities"]) if "opacity_forgotten" in wrong else a["opacities"]
    alpha = gaussian * opacity
    if "gaussian_normalized" in wrong:
        det = a["conics"][:, 0] * a["conics"][:, 2] - a["conics"][:, 1] ** 2
        alpha = alpha * np.sqrt(np.maximum(det, 0)) / kind(2 * np.pi)
    cap = kind(np.inf if c["alpha_cap"] == "none" else float(c["alpha_cap"]))
    seen = np.ones_like(alpha, bool)
    if c["faint"] == "skipped":
        seen &= ~(np.minimum(alpha, cap) < kind(1 / 255))
    if c["positive_power"] == "skipped":
        seen &= ~(power > 0)
    if "cut_at_three_sigmas" in wrong:
        seen &= power >= kind(-4.5)
    return d, conic, gaussian, alpha, cap, seen


def gaussian_alpha(a, c, wrong):
    """The exponent as a product of d with the conic's matrix."""
    _, _, _, alpha, cap, seen = at_pixels(a, c, wrong)
    return {"alphas": np.where(seen, np.minimum(alpha, cap), 0)}


def gaussian_alpha_vjp(a, c, wrong):
    """All pairs, then sums over pixels."""
    d, conic, gaussian, alpha, cap, seen = at_pixels(a, c, wrong)
    if c["cap_gradient"] == "stopped":
        seen = seen & ~(alpha > cap)
    g = np.where(seen, a["grad_alphas"], 0)
    g_power = g * alpha
    g_means = np.einsum("pg,gij,pgj->pgi", g_power, conic, d)
    squares = d[:, :, [0, 0, 1]] * d[:, :, [0, 1, 1]] * np.array([-0.5, -0.5 if c["conic_gradient"] == "entry" else -1, -0.5], d.dtype)
    g_conics, g_opacities = g_power[:, :, None] * squares, g * gaussian
    if "mean_gradient_negated" in wrong:
        g_means = -g_means
    if "opacity_gradient_of_alpha" in wrong:
        g_opacities = g_power
    if "gradient_by_division" in wrong:
        with np.errstate(divide="ignore", invalid="ignore"):
            g_opacities = g_power / a["opacities"]
    if "power_held" in wrong:
        g_means, g_conics = 0 * g_means, 0 * g_conics
    gather = (lambda x: x[-1]) if "last_pixel_alone" in wrong else (lambda x: x.sum(0))
    return {"grad_means2d": gather(g_means), "grad_conics": gather(g_conics), "grad_opacities": gather(g_opacities)}


def seen_from(a, c, wrong):
    """Directions' lengths, unit directions and harmonics; those are second_harmonics'."""
    d = a["means"] - a["camera_center"]
    d = -d if "direction_reversed" in wrong else d
    length = np.linalg.norm(d, axis=1, keepdims=True)
    u = d if "direction_not_normalized" in wrong else d / length
    degree = int(np.sqrt(a["coefficients"].shape[1])) - 1
    asked = {"d": u, "degree": np.float64(degree)}
    y = second_harmonics.spherical_harmonics(asked, c | {"harmonic_form": "sphere"}, [])["harmonics"]
    if "constant_forgotten" in wrong:
        y = np.concatenate([np.ones_like(y[:, :1]), y[:, 1:]], 1)
    return length, u, asked, y


def gaussian_color(a, c, wrong):
    """A product of harmonics with a matrix of coefficients."""
    f = a["coefficients"]
    if "channels_first" in wrong:
        f = f.reshape(len(f), 3, -1).transpose(0, 2, 1)
    color = np.einsum("mk,mkc->mc", seen_from(a, c, wrong)[3], f)
    color = color if c["splat_color"] == "sum" or "half_forgotten" in wrong else color + color.dtype.type(0.5)
    color = np.maximum(color, 0) if c["splat_color"] == "clamped" else color
    return {"colors": np.clip(color, 0, 1) if "clamped_at_one" in wrong else color}


def gaussian_color_vjp(a, c, wrong):
    """Back through the product, then through the harmonics of unit directions."""
    length, u, asked, y = seen_from(a, c, [])
    g, f = a["grad_colors"], a["coefficients"]
    if c["splat_color"] == "clamped" and "clamp_not_differentiated" not in wrong:
        g = np.where(np.einsum("mk,mkc->mc", y, f) + g.dtype.type(0.5) < 0, 0, g)
    g_y = np.einsum("mc,mkc->mk", g, f)
    back = c | {"harmonic_form": "homogeneous"}
    g_u = second_harmonics.spherical_harmonics_vjp(asked | {"grad_harmonics": g_y}, back, [])["grad_d"]
    g_d = g_u if "normalization_not_differentiated" in wrong else (g_u - (g_u * u).sum(1, keepdims=True) * u) / length
    sign = {"mean_gradient_dropped": 0, "mean_gradient_negated": -1}
    return {"grad_means": g_d * next((s for n, s in sign.items() if n in wrong), 1), "grad_coefficients": g[:, None] * y[:, :, None]}
