"""The second implementation's volume rendering: cumulative products. See second.py."""

import numpy as np

EPS = {"none": 0.0, "1e-10": 1e-10, "1e-9": 1e-9, "1e-8": 1e-8, "1e-7": 1e-7}


def composite(alphas, rgbs, eps, wrong, shown=None, opaque=None):
    """Weights by the cumulative product of 1 - alpha + eps, with everything that goes wrong there; `shown` and `opaque` stand for T and
    alpha where the caller has made them wrong already."""
    ones = np.ones((len(alphas), 1), alphas.dtype)
    product = np.cumprod(np.concatenate([ones, 1 - alphas + alphas.dtype.type(eps)], 1), 1)
    shade, behind = product[:, :-1].copy(), product[:, -1]
    if "inclusive_transmittance" in wrong:
        shade = product[:, 1:].copy()
    if "inclusive_behind_the_first" in wrong:
        shade[:, 1:] = product[:, 2:]
    if "own_light_alone" in wrong:
        shade = 1 - alphas
    if "neighbors_light_alone" in wrong:
        shade = np.concatenate([ones, 1 - alphas[:, :-1]], 1)[:, : alphas.shape[1]]
    if "whole_rays_light" in wrong:
        shade = np.broadcast_to(behind[:, None], alphas.shape)
    if "rolled_transmittance" in wrong:
        shade[:, :1] = behind[:, None]
    if "rolled_but_in_first_ray" in wrong:
        shade[1:, :1] = behind[1:, None]
    if "first_transmittance_zero" in wrong:
        shade[:, :1] = 0
    if "opacity_as_transmittance" in wrong:
        shade = 1 - product[:, 1:]
    if "opacity_in_front_as_transmittance" in wrong:
        shade = 1 - shade
    if "transmittance_moved_twice" in wrong:
        shade = np.concatenate([ones, shade[:, :-1]], 1)[:, : shade.shape[1]]
    if "divided_by_own_factor" in wrong:
        with np.errstate(invalid="ignore"):
            shade = product[:, 1:] / (1 - alphas)
    if "back_to_front" in wrong:
        shade = np.cumprod(np.concatenate([ones, 1 - alphas[:, ::-1] + alphas.dtype.type(eps)], 1), 1)[:, :-1][:, ::-1]
    if "transmittance_over_rays" in wrong:
        shade = np.cumprod(np.concatenate([np.ones_like(alphas[:1]), 1 - alphas], 0), 0)[:-1]
    if "eps_in_product" in wrong:
        product = np.cumprod(np.concatenate([ones, 1 - alphas + alphas.dtype.type(1e-5)], 1), 1)
        shade, behind = product[:, :-1].copy(), product[:, -1]
    if "transmittance_before_last" in wrong and alphas.shape[1]:
        behind = shade[:, -1]
    shade = shade if shown is None else shown
    alphas = alphas if opaque is None else opaque
    weights = shade if "alpha_forgotten" in wrong else shade * (1 - alphas if "light_for_alpha" in wrong else alphas)
    colors, opacity = np.einsum("rn,rnk->rk", weights, rgbs), weights.sum(1)
    if "weights_normalized" in wrong or "weights_of_unit_length" in wrong:
        length = opacity if "weights_normalized" in wrong else np.sqrt((weights * weights).sum(1))
        with np.errstate(invalid="ignore", divide="ignore"):
            weights, colors = weights / length[:, None], colors / length[:, None]
        opacity = weights.sum(1)
    if "colors_of_next_sample" in wrong:
        colors = np.einsum("rn,rnk->rk", weights[:, :-1], rgbs[:, 1:])
    if "divided_by_opacity" in wrong:
        with np.errstate(invalid="ignore", divide="ignore"):
            colors = colors / opacity[:, None]
    if "clamped" in wrong:
        colors = np.clip(colors, 0, 1)
    return {"colors": colors, "weights": weights, "opacity": opacity, "transmittance": behind}


def over(c, out):
    """In front of white, where that is the convention; then the opacity without the last sample, where that is."""
    if c["backdrop"] == "white":
        out["colors"] = out["colors"] + (1 - out["opacity"])[:, None]
    if c["opacity_sum"] == "without_last":
        out["opacity"] = out["weights"][:, :-1].sum(1)
    return out


def before_white(c, a):
    """White loses what all weights gain; where the opacity is without the last sample, the others' weights have its gradient."""
    if c["opacity_sum"] == "without_last":
        weights = a["grad_weights"].copy()
        weights[:, :-1] += a["grad_opacity"][:, None]
        a = a | {"grad_weights": weights, "grad_opacity": np.zeros_like(a["grad_opacity"])}
    if c["backdrop"] == "white":
        a = a | {"grad_opacity": a["grad_opacity"] - a["grad_colors"].sum(1)}
    return a


OPAQUE = {"sigmas": 1, "deltas": 1e10, "alphas": 1}


def closed(a, c):
    """Samples, the last of each ray opaque where that is the convention."""
    if c["last_sample"] == "as_it_is":
        return a
    n = a["rgbs"].shape[1]
    last = np.arange(n) == n - 1
    return a | {name: np.where(last, a[name].dtype.type(OPAQUE[name]), a[name]) for name in OPAQUE if name in a}


def of_closed(c, gradients):
    """An opaque last sample has no gradient."""
    if c["last_sample"] == "opaque":
        for name in OPAQUE:
            if f"grad_{name}" in gradients:
                gradients[f"grad_{name}"][:, -1:] = 0
    return gradients


def volume_render(a, c, wrong):
    """alpha = 1 - exp(-sigma delta), then the product."""
    a = closed(a, c)
    sigmas, deltas = a["sigmas"], a["deltas"]
    n = sigmas.shape[1]
    if "first_ray_deltas" in wrong:
        deltas = np.broadcast_to(deltas[:1], deltas.shape)
    if "delta_missing" in wrong:
        deltas = np.ones_like(deltas)
    if "delta_unit_interval" in wrong:
        deltas = np.full_like(deltas, 1 / max(n, 1))
    if "delta_over_n_minus_1" in wrong and n > 1:
        deltas = deltas * (n / (n - 1))
    if "backward_delta" in wrong:
        deltas = np.concatenate([np.zeros_like(deltas[:, :1]), deltas[:, :-1]], 1)
    if "delta_differenced_twice" in wrong:
        deltas = np.concatenate([np.diff(deltas), np.full_like(deltas[:, :1], 1e10)], 1)
    if "first_gap_for_all" in wrong:
        deltas = np.broadcast_to(deltas[:, :1], deltas.shape)
    if "delta_scaled" in wrong:
        deltas = 2 * deltas
    eps = EPS[c["product_eps"]]
    with np.errstate(over="ignore", invalid="ignore"):
        passed = np.exp(-(sigmas * deltas))
        alphas = 1 - (sigmas.dtype.type(0.99) * passed if "scaled_exponential" in wrong else passed)
        if "eps_on_alpha" in wrong:
            alphas, eps = alphas + sigmas.dtype.type(1e-10), 1e-10
        shown = None
        if "density_with_step_before" in wrong and n:
            ahead = np.concatenate([np.zeros_like(sigmas[:, :1]), sigmas[:, 1:] * deltas[:, :-1]], 1)
            shown = np.exp(-np.cumsum(ahead, 1))
        opaque = sigmas if "density_for_opacity" in wrong else None
        if "optical_depth_for_alpha" in wrong:
            opaque = sigmas * deltas
        if "exponent_without_minus" in wrong:
            opaque = 1 - np.exp(sigmas * deltas)
        if "depth_for_transmittance" in wrong and n:
            depths = np.cumsum(sigmas * deltas, 1)
            shown = np.concatenate([np.zeros_like(sigmas[:, :1]), depths[:, :-1]], 1)
        out = composite(alphas, a["rgbs"], eps, wrong, shown, opaque)
    return over(c, out)


def volume_render_alpha(a, c, wrong):
    """From opacities, those that count."""
    a = closed(a, c)
    alphas, _ = counted(a["alphas"], c)
    return over(c, composite(alphas, a["rgbs"], EPS[c["product_eps"]], wrong))


def counted(alphas, c):
    """Opacities under the cap, 0 where they are too faint, and whether they have a gradient."""
    cap = alphas.dtype.type({"none": 1, "0.99": 0.99, "0.999": 0.999}[c["alpha_cap"]])
    faint = (c["faint"] == "skipped") & (alphas < alphas.dtype.type(1 / 255))
    capped = np.where(faint, 0, np.minimum(alphas, cap))
    live = np.cumprod(1 - capped, 1) >= 1e-4 if c["alpha_stop"] == "in_front" else True
    held = (c["cap_gradient"] == "stopped") & (alphas > cap)
    return np.where(live, capped, 0), ~faint & ~held & live


def from_behind(alphas, factors, a):
    """T in front of each sample, each weight's cotangent, and what a unit of light is worth behind each sample."""
    ones = np.ones((len(alphas), 1), alphas.dtype)
    front = np.cumprod(np.concatenate([ones, factors], 1), 1)[:, :-1]
    g_w = np.einsum("rk,rnk->rn", a["grad_colors"], a["rgbs"]) + a["grad_weights"] + a["grad_opacity"][:, None]
    worth = np.empty_like(alphas)
    value = a["grad_transmittance"]
    for i in reversed(range(alphas.shape[1])):
        worth[:, i] = value
        value = alphas[:, i] * g_w[:, i] + factors[:, i] * value
    return front, g_w, worth


def volume_render_vjp(a, c, wrong):
    """d w_i / d x_i = T_i e^-x_i; everything behind is shaded by the same factor."""
    a = closed(before_white(c, a), c)
    passed = np.exp(-(a["sigmas"] * a["deltas"]))
    alphas = -np.expm1(-(a["sigmas"] * a["deltas"]))
    front, g_w, worth = from_behind(alphas, passed + passed.dtype.type(EPS[c["product_eps"]]), a)
    g_x = front * passed * (g_w if "shade_gradient_forgotten" in wrong else g_w - worth)
    g_sigmas = g_x * a["deltas"]
    if c["sigma_relu"] == "inside":
        g_sigmas = np.where(a["sigmas"] > 0, g_sigmas, 0)
    g_rgbs = (front * alphas)[..., None] * a["grad_colors"][:, None]
    return of_closed(c, {"grad_sigmas": g_sigmas, "grad_rgbs": g_rgbs, "grad_deltas": g_x * a["sigmas"]})


def volume_render_alpha_vjp(a, c, wrong):
    """The same without the exponential."""
    a = closed(before_white(c, a), c)
    alphas, count = counted(a["alphas"], c)
    front, g_w, worth = from_behind(alphas, 1 - alphas + alphas.dtype.type(EPS[c["product_eps"]]), a)
    g = front * (g_w - worth)
    if "product_gradient_zero_at_opaque" in wrong:
        g = np.where(alphas == 1, front * g_w, g)
    if "shade_gradient_forgotten" in wrong:
        g = front * g_w
    return of_closed(c, {"grad_alphas": np.where(count, g, 0), "grad_rgbs": (front * alphas)[..., None] * a["grad_colors"][:, None]})


def composite_background(a, c, wrong):
    """C + (1 - A) b."""
    colors, rest, b = a["colors"], 1 - a["opacity"], a["background"]
    if "attenuated_twice" in wrong:
        colors = colors * a["opacity"][:, None]
    if "one_channel" in wrong:
        b = b * np.array([1, 0, 0], b.dtype)
    if "background_255" in wrong:
        b = b * 255
    if "background_by_opacity" in wrong:
        rest = a["opacity"]
    if "background_always" in wrong:
        rest = np.ones_like(rest)
    if "clamped" in wrong:
        return {"colors_out": np.clip(colors + rest[:, None] * b, 0, 1)}
    return {"colors_out": colors + np.outer(rest, b)}


def composite_background_vjp(a, c, wrong):
    """Linear in each of the three."""
    g = a["grad_colors_out"]
    return {"grad_colors": g, "grad_opacity": -(g @ a["background"]), "grad_background": (1 - a["opacity"]) @ g}


def depth(a, c, wrong):
    """sum w t, divided by sum w or not, or with far where light is left."""
    w, t = a["weights"], a["t"]
    if "depth_of_index" in wrong:
        t = np.broadcast_to(np.arange(t.shape[1], dtype=t.dtype), t.shape)
    out = np.einsum("rn,rn->r", w, t)
    if c["depth"] == "divided":
        total = w.sum(1)
        with np.errstate(invalid="ignore", divide="ignore"):
            out = out / total
        if "zero_by_zero" not in wrong:
            far = w.dtype.type(a["far"])
            empty = {"far": far, "zero": w.dtype.type(0), "first": t[:, 0], "last": t[:, -1]}[c["empty_depth"]]
            out = np.where(total == 0, empty, out)
    if c["depth"] == "far_behind":
        out = out + (1 - w.sum(1)) * w.dtype.type(a["far"])
    if "far_by_opacity" in wrong:
        out = np.einsum("rn,rn->r", w, t) + w.dtype.type(a["far"]) * w.sum(1)
    if "median_depth" in wrong:
        reached = np.cumsum(w, 1) >= 0.5
        at = np.where(reached.any(1), reached.argmax(1), t.shape[1] - 1)
        out = np.take_along_axis(t, at[:, None], 1)[:, 0]
    if "disparity" in wrong:
        out = 1 / np.maximum(out, out.dtype.type(1e-10))
    return {"depth": out}


def depth_vjp(a, c, wrong):
    """d/dw = (t - depth) / A, d/dt = w / A."""
    w, t, g = a["weights"], a["t"], a["grad_depth"][:, None]
    if c["depth"] != "divided":
        return {"grad_weights": g * (t - (a["far"] if c["depth"] == "far_behind" else 0)), "grad_t": g * w}
    total = w.sum(1, keepdims=True)
    scale = np.divide(g, total, out=np.zeros_like(g), where=total != 0)
    g_t = scale * w
    if c["empty_depth"] in ("first", "last"):
        g_t[:, {"first": 0, "last": -1}[c["empty_depth"]]] += np.where(total == 0, g, 0)[:, 0]
    return {"grad_weights": scale * (t - depth(a, c, ())["depth"][:, None]), "grad_t": g_t}
