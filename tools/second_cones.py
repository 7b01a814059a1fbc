"""The second implementation's cones: mip-NeRF's middle and half width, the other two squares for the projection, and what is left of
each band. See second.py."""

import numpy as np
import second_networks as networks


def along_ray(start, end, c, wrong=()):
    """Mean, variance, and variance across over the squared radius, each with its slopes by middle and half width."""
    middle, half = (start + end) / 2, (end - start) / 2
    if "width_for_half_width" in wrong:
        half = 2 * half
    mm, hh = middle * middle, half * half
    cylinder, none = c["ray_shape"] == "cylinder", 0 * middle
    if cylinder:
        mean, along, across = middle, hh / 3, none + middle.dtype.type(0.25)
    else:
        total = 3 * mm + hh
        safe = np.where(total == 0, 1, total)
        part = hh / safe
        mean = middle + 2 * middle * part
        along = hh / 3 - part * part * (12 * mm - hh) * 4 / 15
        across = mm / 4 + hh * 5 / 12 - hh * part * 4 / 15
    if "middle_for_mean" in wrong:
        mean = middle
    if "fifths_forgotten" in wrong:
        along = (end - start) ** 2 / 12
    if "radius_at_middle" in wrong and not cylinder:
        across = mm / 4
    one = none + 1
    if cylinder:
        return (mean, along, across), (one, none, none), (none, 2 * half / 3, none)
    # part = hh / total: its slopes.
    held = "ratio_held" in wrong
    by_middle = none if held else -6 * middle * part / safe
    by_half = none if held else 2 * half * (1 - part) / safe
    # A held ratio is that of the sum and the difference: `part` is the same number.
    outer = 12 * mm - hh
    if held:
        of_middle = (1 + 2 * part, -part * part * 24 * middle * 4 / 15, middle / 2)
        of_half = (none, half * 2 / 3 + part * part * 2 * half * 4 / 15, half * 5 / 6 - 2 * half * part * 4 / 15)
        return (mean, along, across), of_middle, of_half
    of_middle = (
        1 + 2 * part + 2 * middle * by_middle,
        -(2 * part * by_middle * outer + part * part * 24 * middle) * 4 / 15,
        middle / 2 - hh * by_middle * 4 / 15,
    )
    of_half = (
        2 * middle * by_half,
        half * 2 / 3 - (2 * part * by_half * outer - part * part * 2 * half) * 4 / 15,
        half * 5 / 6 - (2 * half * part + hh * by_half) * 4 / 15,
    )
    return (mean, along, across), of_middle, of_half


def beside(d):
    """Its diagonal, with the two other squares summed."""
    squares = d * d
    return (np.roll(squares, 1, 1) + np.roll(squares, 2, 1)) / squares.sum(1, keepdims=True)


def conical_frustum(a, c, wrong):
    """Moments, then the diagonal of mean and covariance in space."""
    d, r = a["directions"], a["radii"]
    (mean, along, across), *_ = along_ray(a["starts"], a["ends"], c, wrong)
    if "quarter_forgotten" in wrong:
        across = 4 * across
    across = across * (r if "radius_not_squared" in wrong else r * r)
    squares, part = d * d, beside(d)
    if "across_everywhere" in wrong:
        part = np.ones_like(d)
    if "projection_of_unit_direction" in wrong:
        part = 1 - d * d
    if "direction_normalized" in wrong:
        squares = d * d / (d * d).sum(1, keepdims=True)
    if "direction_not_squared" in wrong:
        squares = np.abs(d)
    means = mean[:, None] * d + (0 if "origin_forgotten" in wrong else a["origins"])
    variances = along[:, None] * squares + across[:, None] * part
    return {"t_mean": mean, "t_variance": along, "r_variance": across, "means": means, "variances": variances}


def conical_frustum_vjp(a, c, wrong):
    """Through variances and means to the moments, and to both ends."""
    d, r, g_means = a["directions"], a["radii"], a["grad_means"]
    (mean, along, across), of_middle, of_half = along_ray(a["starts"], a["ends"], c, wrong)
    off = 0 if "variances_detached" in wrong else 1
    g = off * a["grad_variances"]
    n, length = beside(d), (d * d).sum(1, keepdims=True)
    to = [
        a["grad_t_mean"] + (g_means * d).sum(1),
        off * a["grad_t_variance"] + (g * d * d).sum(1),
        off * a["grad_r_variance"] + (g * n).sum(1),
    ]
    directions = mean[:, None] * g_means
    if "directions_by_mean_alone" not in wrong:
        directions = directions + 2 * along[:, None] * d * g
        if "projection_held" not in wrong:
            spread = ((g[:, None, :] - g[:, :, None]) * (d * d)[:, None, :]).sum(2) / length
            directions = directions + (r * r * across)[:, None] * 2 * d / length * spread
    radii = (1 if "radius_slope_halved" in wrong else 2) * r * across * to[2]
    to[2] = r * r * to[2]
    middles = [slope * g for slope, g in zip(of_middle, to)]
    halves = [slope * g for slope, g in zip(of_half, to)]
    if "ends_by_halves" in wrong:
        middles[0], halves[0] = to[0], 0 * to[0]
    middle, half = sum(middles) / 2, sum(halves) / 2
    return {
        "grad_origins": g_means,
        "grad_directions": directions,
        "grad_radii": radii,
        "grad_starts": middle - half,
        "grad_ends": middle + half,
    }


def settings(c):
    """The encoding's conventions, with the identity of this one."""
    return c | {"identity": c["integrated_identity"]}


def left(v, levels, c, wrong=()):
    """What is left of each band, (M, L, D), and of the cosines."""
    f = networks.bands(levels, c, ()).astype(v.dtype)[:, None]
    bare = f / v.dtype.type(networks.FACTORS[c["frequency"]])
    v = v[:, None, :]
    x = v * (f * f)
    if "factor_forgotten_in_variance" in wrong:
        x = v * (bare * bare)
    if "variance_scaled_once" in wrong:
        x = v * f
    if "variance_not_scaled" in wrong:
        x = v * np.ones_like(f)
    if "half_forgotten" in wrong:
        x = 2 * x
    if "attenuation_forgotten" in wrong:
        x = 0 * x
    if "variance_taken_for_deviation" in wrong:
        x = (v * f) ** 2
    if "deviation_for_variance" in wrong:
        x = np.sqrt(v) * (f * f)
    e = np.exp(-x / 2)
    return e, np.ones_like(e) if "cosine_not_attenuated" in wrong else e


def waves(x, levels, c):
    """(sin, cos), each (M, L, D)."""
    angle = x[:, None, :] * networks.bands(levels, c, ()).astype(x.dtype)[:, None]
    cosine = np.sin(angle + x.dtype.type(np.pi / 2)) if c["cosine"] == "shifted_sine" else np.cos(angle)
    return np.sin(angle), cosine


def integrated_encoding(a, c, wrong):
    """Waves times what is left of them."""
    c, x, levels = settings(c), a["means"], int(a["L"])
    (sin, cos), (of_sin, of_cos) = waves(x, levels, c), left(a["variances"], levels, c, wrong)
    columns = networks.order(np.stack([of_sin * sin, of_cos * cos], 1), c)
    parts = [x, columns] if c["identity"] == "true" else [columns]
    return {"encoding": np.concatenate(parts[::-1] if c["identity_place"] == "last" else parts, 1)}


def integrated_encoding_vjp(a, c, wrong):
    """Band by band; None where the cotangent isn't one of these columns, as cases have it in which nothing is pinned."""
    c, x, levels, g = settings(c), a["means"], int(a["L"]), a["grad_encoding"]
    dims, own = x.shape[1], 0
    if g.shape[1] != 2 * levels * dims + (dims if c["identity"] == "true" else 0):
        return None
    if c["identity"] == "true":
        g, own = (g[:, :-dims], g[:, -dims:]) if c["identity_place"] == "last" else (g[:, dims:], g[:, :dims])
    g = networks.disorder(g, levels, dims, c)
    f = networks.bands(levels, c, ()).astype(x.dtype)[:, None]
    (sin, cos), (e, _) = waves(x, levels, c), left(a["variances"], levels, c)
    sign = 1 if "cosine_gradient_sign" in wrong else -1
    slope = g[:, 0] * cos + sign * g[:, 1] * sin
    slope = slope * (1 if "chain_factor_forgotten" in wrong else f)
    slope = slope * (1 if "attenuation_forgotten_in_gradient" in wrong else e)
    share = -f * f / 2
    if "variances_detached" in wrong:
        share = 0 * share
    if "variance_slope_scaled_once" in wrong:
        share = -f / 2
    if "variance_slope_sign" in wrong:
        share = -share
    if "variance_slope_doubled" in wrong:
        share = 2 * share
    of_variance = share * e * (g[:, 0] * sin + g[:, 1] * cos)
    return {"grad_means": slope.sum(1) + own, "grad_variances": of_variance.sum(1)}
