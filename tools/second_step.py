"""The second implementation's whole training step. See second.py."""

import numpy as np
import second_geometry as geometry
import second_networks as networks
import second_rendering as rendering
import second_training as training

OF_STEPS = ("rays_o", "rays_d", "directions", "u", "target")
HYPER = ("beta1", "beta2", "eps", "weight_decay")
# The network is the paper's and nothing lies behind a ray.
USUAL = {
    "identity": "true",
    "identity_place": "first",
    "bands": "octaves",
    "cosine": "own",
    "columns": "band_sin_cos",
    "last_trunk": "relu",
    "feature": "none",
    "product_eps": "none",
    "sigma_relu": "none",
    "backdrop": "none",
    "opacity_sum": "all",
    "last_sample": "as_it_is",
}
NAMES = [f"{layer}_{part}" for layer in networks.NAMES for part in "wb"]


def row(arrays, prefix=""):
    """All parameters one after the other."""
    return np.concatenate([np.asarray(arrays[prefix + name]).reshape(-1) for name in NAMES])


def filled(a, params):
    """The parameters' arrays from a row."""
    ends = np.cumsum([a[name].size for name in NAMES])
    return {name: part.reshape(a[name].shape) for name, part in zip(NAMES, np.split(params, ends[:-1]))}


def passed(a, params, batch, draws, c, wrong):
    """Forth and back over the rays of a step."""
    x = {name: a[name][batch] for name in OF_STEPS} | {"u": a["u"][draws], "near": a["near"], "far": a["far"]}
    rays, n = x["u"].shape
    along = geometry.sample_along_rays(x, c, ())
    deltas = geometry.step_sizes(x | {"t": along["t"]}, c, ())["deltas"]
    if c["delta"] == "differences_times_norm":
        deltas = deltas * np.linalg.norm(x["rays_d"], axis=1, keepdims=True)
    field = params | {"positions": along["points"].reshape(-1, 3), "directions": np.repeat(x["directions"], n, 0)}
    seen = networks.nerf_mlp(field, c, ())
    ray = {"sigmas": seen["sigmas"].reshape(rays, n), "rgbs": seen["rgbs"].reshape(rays, n, 3), "deltas": deltas}
    colors = rendering.volume_render(ray, c, ())["colors"]
    loss = {"prediction": colors, "target": x["target"], "grad_value": colors.dtype.type(1)}
    scale = (colors.size if "sum_for_mean" in wrong else 1) * (3 if "mean_over_rays" in wrong else 1)
    g = training.mse_vjp(loss, c, ())["grad_prediction"] * colors.dtype.type(scale)
    zeros = {
        name: np.zeros(shape, g.dtype) for name, shape in (("weights", (rays, n)), ("opacity", rays), ("transmittance", rays))
    }
    back = rendering.volume_render_vjp(ray | {"grad_colors": g} | {f"grad_{name}": z for name, z in zeros.items()}, c, ())
    g_sigmas = back["grad_sigmas"].reshape(-1) * (0 if "weights_detached" in wrong else 1)
    field |= {"grad_sigmas": g_sigmas, "grad_rgbs": back["grad_rgbs"].reshape(-1, 3)}
    gradient = row(networks.nerf_mlp_vjp(field, c, ()), "grad_")
    return along["t"], deltas, colors, training.mse(loss, c, ())["value"] * scale, gradient


def training_step(a, c, wrong):
    """Step after step."""
    c, steps = {**c, **USUAL}, len(a["lr"])
    params, out, losses = row(a), {}, []
    m, v, total = np.zeros_like(params), np.zeros_like(params), np.zeros_like(params)
    colors_first = np.concatenate([np.full(a[name].size, name.startswith(("color0", "color1"))) for name in NAMES])
    biases = np.concatenate([np.full(a[name].size, name.endswith("_b")) for name in NAMES])
    for k in range(steps):
        seen = [0 if name in wrong else k for name in ("first_batch_for_ever", "first_draws_for_ever")]
        rate = min(k + 1, steps - 1) if "rate_of_next_step" in wrong else max(k - 1, 0) if "rate_of_step_before" in wrong else k
        if "moments_forgotten" in wrong:
            m, v = np.zeros_like(m), np.zeros_like(v)
        settings = {name: a[name] for name in HYPER} | {"lr": a["lr"][rate], "step": 1 if "moments_forgotten" in wrong else k + 1}
        t, deltas, colors, loss, g = passed(a, filled(a, params), *seen, c, wrong)
        if "one_half_after_the_other" in wrong:
            half = training.adam_step({"params": params, "grad": g, "m": m, "v": v} | settings, c, wrong)["params_out"]
            half = filled(a, np.where(colors_first, half, params))
            g = np.where(colors_first, g, passed(a, half, *seen, c, wrong)[4])
        if "gradients_accumulate" in wrong:
            g = total = total + g
        moved = training.adam_step({"params": params, "grad": g, "m": m, "v": v} | settings, c, wrong)
        keep = biases & ("biases_left_out" in wrong)
        before = zip((params, m, v), ("params_out", "m_out", "v_out"))
        params, m, v = (np.where(keep, old, moved[name]).astype(old.dtype) for old, name in before)
        losses.append(passed(a, filled(a, params), *seen, c, wrong)[3] if "loss_after_step" in wrong else loss)
        if k == 0:
            out = {"t": t, "deltas": deltas, "colors": colors, "grad": g, "params_1": params, "m_1": m, "v_1": v}
    return out | {"losses": np.array(losses, params.dtype), "params_last": params, "m_last": m, "v_last": v}
