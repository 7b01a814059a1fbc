"""The second implementation's loss, metric, bytes and optimizer. See second.py."""

import numpy as np


def mse(a, c, wrong):
    """Mean of squares."""
    p = a["prediction"]
    scale = p.size if "sum_for_mean" in wrong else p.shape[-1] if "mean_over_rays" in wrong else 1
    off = p - a["target"]
    value = (np.abs(off).sum() if "absolute_error" in wrong else np.vdot(off, off)) / p.size * scale
    return {"value": np.sqrt(value) if "root_of_mean" in wrong else value}


def mse_vjp(a, c, wrong):
    """2 (p - t) / n."""
    p = a["prediction"]
    scale = (1 if "factor_two_missing" in wrong else 2) / (1 if "mean_forgotten" in wrong else p.size)
    return {"grad_prediction": (p - a["target"]) * (scale * a["grad_value"])}


def psnr(a, c, wrong):
    """20 log10(peak) - 10 log10(mse)."""
    p, t, peak = a["prediction"], a["target"], a["peak"]
    if c["psnr_peak"] == "one":
        peak = 1.0
    if "peak_255" in wrong:
        peak = 255.0
    if "peak_of_target" in wrong:
        peak = t.max()
    if "few_pixels" in wrong:
        p, t = p[:, :1], t[:, :1]
    errors = ((p - t) ** 2).mean((1, 2, 3))
    if c["psnr"] == "mean_error":
        errors = errors.mean(keepdims=True)
    if c["psnr_floor"] == "small":
        errors = np.maximum(errors, p.dtype.type(1e-10 * peak**2))
    with np.errstate(divide="ignore"):
        value = p.dtype.type((20 * np.log10(peak) - 10 * np.log10(errors)).mean())
    if "peak_scaled" in wrong:
        value = value + p.dtype.type(20 * np.log10(8))
    if "regularized_psnr" in wrong:
        value = -10 * np.log10(10 ** (-value / 10) + 1e-3 / peak**2)
    value = value * (2 if "doubled_psnr" in wrong else 1) * (np.log(10) if "natural_log_psnr" in wrong else 1)
    return {"value": value}


def to_uint8(a, c, wrong):
    """255 x, clipped, rounded or cut off."""
    x = a["image"] * 255
    if "uint8_without_clipping" not in wrong:
        x = np.clip(x, 0, 255)
    whole = np.trunc(x) if c["bytes"] == "truncate" else np.sign(x) * np.floor(np.abs(x) + x.dtype.type(0.5))
    x = np.mod(whole, 256).astype(np.uint8)
    if "times_256" in wrong:
        x = np.minimum(np.floor(256 * np.clip(a["image"], 0, 1)), 255).astype(np.uint8)
    if "stretched_to_the_range" in wrong:
        low, high = a["image"].min(), a["image"].max()
        with np.errstate(invalid="ignore"):
            x = to_uint8({"image": (a["image"] - low) / (high - low)}, c, ())["bytes"]
    if "red_and_blue_exchanged" in wrong:
        x = x[..., ::-1]
    if "picture_flipped" in wrong:
        x = x[::-1]
    if "picture_transposed" in wrong:
        x = np.swapaxes(x, 0, 1).reshape(x.shape)
    return {"bytes": x}


def linear_to_srgb(a, c, wrong):
    """Both pieces, one selected; the power as e^(ln x / 2.4)."""
    x = a["linear"]
    if "clamped" in wrong:
        x = np.clip(x, 0, 1)
    if "applied_twice" in wrong:
        x = linear_to_srgb({"linear": x}, c, ())["srgb"]
    with np.errstate(divide="ignore"):
        log = np.log(x)
    if "gamma_2_2" in wrong:
        return {"srgb": np.exp(log / x.dtype.type(2.2))}
    if "way_back" in wrong:
        return {"srgb": np.where(x <= 0.04045, x / 12.92, ((x + 0.055) / 1.055) ** 2.4).astype(x.dtype)}
    exponent = 2.4 if "exponent_swapped" in wrong else 0.41666 if "exponent_rounded" in wrong else 5 / 12
    exponent -= 0.055 if "offset_in_the_exponent" in wrong else 0
    inside = float(np.log(1.055)) if "scale_under_the_power" in wrong else 0
    scale = 1 if "scale_under_the_power" in wrong else 1.055
    offset = 0 if {"offset_forgotten", "offset_in_the_exponent"} & set(wrong) else 0.055
    curved = (np.exp((log + inside) * exponent) * scale - offset).astype(x.dtype)
    if "straight_piece_forgotten" in wrong:
        return {"srgb": curved}
    threshold = 0.04045 if "threshold_of_the_way_back" in wrong else 0.0031308
    return {"srgb": np.where(x <= threshold, x * x.dtype.type(12.92), curved)}


def linear_to_srgb_vjp(a, c, wrong):
    """The slope from what the forward pass returns: (srgb + 0.055) / (2.4 x)."""
    x, g = a["linear"], a["grad_srgb"]
    dark = x <= 0.0031308
    y = linear_to_srgb(a, c, ())["srgb"]
    curved = (y + x.dtype.type(0.055)) / (x.dtype.type(2.4) * np.where(dark, x.dtype.type(1), x))
    if "exponent_not_lowered" in wrong:
        curved = curved * x
    slope = np.where(dark, x.dtype.type(0 if "straight_slope_missing" in wrong else 12.92), curved)
    if "gradient_clamped" in wrong:
        slope = np.where(x > 1, x.dtype.type(0), slope)
    if "not_a_number_at_black" in wrong:
        slope = np.where(x == 0, x.dtype.type(np.nan), slope)
    return {"grad_linear": g if "slope_dropped" in wrong else g * slope}


def adam_step(a, c, wrong):
    """Kingma and Ba's algorithm 1."""
    p, step, b1, b2, decay = a["params"], a["step"], a["beta1"], a["beta2"], a["weight_decay"]
    if "step_from_zero" in wrong:
        step = max(step - 1, 1)
    decoupled = "decoupled_decay" in wrong
    g = a["grad"] + (0 if decoupled else decay) * p
    m, v = b1 * a["m"] + (1 - b1) * g, b2 * a["v"] + (1 - b2) * g**2
    eps = a["eps"] / np.sqrt(1 - b2**step) if c["adam_eps"] == "uncorrected" else a["eps"]
    power = 1 if "corrected_as_in_first_step" in wrong else step
    corrected = "no_bias_correction" not in wrong
    m_hat = m / (1 - b1**power) if corrected else m
    v_hat = v / (1 - b2**power) if corrected else v
    root = np.sqrt(v_hat + eps) if "eps_inside_root" in wrong else np.sqrt(v_hat) + eps
    rate = a["lr"] * (np.sqrt(1 - b2**step) / (1 - b1**step) if "corrected_twice" in wrong else 1)
    out = p - rate * m_hat / root
    out = out - a["lr"] * decay * p if decoupled else out
    stays = (a["grad"] == 0) & (c["adam_zero"] == "left")
    after = {"params_out": (p, out), "m_out": (a["m"], m), "v_out": (a["v"], v)}
    return {name: np.where(stays, *pair) for name, pair in after.items()}


def adamw_step(a, c, wrong):
    """Algorithm 2: the decay of what was before, and Adam's step without one."""
    if "coupled_decay" in wrong:
        return adam_step(a, c, wrong)
    before, step, decay = a["params"], a["step"], a["lr"] * a["weight_decay"]
    plain = adam_step(a | {"weight_decay": 0.0}, c, wrong)
    if "decay_under_the_root" in wrong:
        b1, b2 = a["beta1"], a["beta2"]
        eps = a["eps"] / np.sqrt(1 - b2**step) if c["adam_eps"] == "uncorrected" else a["eps"]
        root = np.sqrt(plain["v_out"] / (1 - b2**step)) + eps
        moved = before - (a["lr"] * plain["m_out"] / (1 - b1**step) + decay * before) / root
        return plain | {"params_out": moved}
    if "decay_of_new_parameter" in wrong:
        return plain | {"params_out": plain["params_out"] * (1 - decay)}
    if "decay_without_rate" in wrong:
        decay = a["weight_decay"]
    if "decay_corrected" in wrong:
        decay = decay / (1 - a["beta1"] ** step)
    if "decay_negated" in wrong:
        decay = -decay
    stays = (a["grad"] == 0) & (c["adam_zero"] == "left")
    return plain | {"params_out": np.where(stays, before, plain["params_out"] - decay * before)}
