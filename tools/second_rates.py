"""The second implementation's learning rates and clipped gradients: powers of ten, half angles, norms of norms. See second.py."""

import numpy as np

HALF_TURN = float(np.pi)


def scalars(a, *names):
    """Hyper-parameters as floats."""
    return [float(a[name]) for name in names]


def step_of(a, wrong):
    """The step that is taken."""
    return float(a["step"]) + (1 if "step_from_one" in wrong else 0)


def share(step, steps, held, wrong):
    """The part of the way."""
    t = step / steps
    if held and t > 1:
        t = 1.0
    return float(np.floor(t)) if "whole_steps" in wrong else t


def lr_exponential(a, c, wrong):
    """10^(log10(lr) + t log10(decay))."""
    steps, lr, decay = scalars(a, "decay_steps", "lr_init", "decay")
    t = share(step_of(a, wrong), steps, c["rate_end"] == "held", wrong)
    if "linear_decay" in wrong:
        return {"rate": lr * (1 + (decay - 1) * t)}
    if "natural_exponent" in wrong:
        return {"rate": lr * np.exp(-t)}
    if "factor_every_step" in wrong:
        t = t * steps
    if "compounded" in wrong:
        t = t * (t * steps + 1) / 2
    return {"rate": 10 ** (np.log10(lr) + t * np.log10(decay))}


def lr_cosine(a, c, wrong):
    """The first rate by the squared cosine of half the angle, the last by the squared sine."""
    most, first, last, warmup = scalars(a, "max_steps", "lr_init", "lr_final", "warmup_steps")
    step = step_of(a, wrong)
    if step < warmup:
        return {"rate": first * (0.0 if "whole_steps" in wrong else step / warmup)}
    begin = 0.0 if "warmup_counted" in wrong else warmup
    length = most if {"warmup_counted", "warmup_not_taken_off"} & set(wrong) else most - warmup
    p = share(step - begin, length, c["rate_end"] == "held", wrong)
    turn = 2 * HALF_TURN if "full_turn" in wrong else 1.0 if "pi_forgotten" in wrong else HALF_TURN
    left, lost = np.cos(turn * p / 2) ** 2, np.sin(turn * p / 2) ** 2
    if "half_forgotten" in wrong:
        left, lost = 2 * left, 1 - 2 * left
    if "last_rate_forgotten" in wrong:
        lost = 0.0
    if "last_rate_on_top" in wrong:
        lost = 1.0
    return {"rate": first * left + last * lost}


def lr_log_linear(a, c, wrong):
    """Logarithms by np.interp, the delay's factor by the cosine of what is left of its quarter turn."""
    most, first, last, wait, mult = scalars(a, "max_steps", "lr_init", "lr_final", "delay_steps", "delay_mult")
    step = step_of(a, wrong)
    begin = wait if c["rate_delay"] == "before" else 0.0
    t = share(max(step - begin, 0.0), most - begin, "not_clamped" not in wrong, wrong)
    if "linear_for_log" in wrong:
        rate = first + (last - first) * t
    elif "last_rate_for_factor" in wrong:
        rate = first * last**t
    else:
        rate = np.exp2(np.log2(first) + (np.log2(last) - np.log2(first)) * t)
    if wait == 0:
        return {"rate": rate}
    risen = step / wait if "delay_not_clamped" in wrong else min(step / wait, 1.0)
    if c["rate_ramp"] == "sine":
        risen = np.sin(risen) if "half_pi_forgotten" in wrong else np.cos(HALF_TURN / 2 * (1 - risen))
    if "mult_forgotten" in wrong:
        mult = 0.0
    return {"rate": rate * (mult + risen - (0 if "mult_on_top" in wrong else mult * risen))}


def norm_of(x, wrong):
    """The norm of one array, or what is taken for it."""
    if "sum_for_norm" in wrong:
        return np.abs(x).sum()
    if "largest_for_norm" in wrong:
        return np.abs(x).max(initial=0)
    if "root_forgotten" in wrong:
        return np.vdot(x, x)
    return np.linalg.norm(x.reshape(-1)) / (np.sqrt(x.dtype.type(x.size)) if "mean_for_sum" in wrong else 1)


def clip_by_global_norm(a, c, wrong):
    """Divided by what the norm is of the limit, where that is more than 1."""
    weights, bias = a["g_weights"], a["g_bias"]
    kind, most = weights.dtype.type, float(a["max_norm"])
    eps = {"none": 0.0, "1e-8": 1e-8, "1e-7": 1e-7, "float32": 2.0**-23, "1e-6": 1e-6}[c["clip_eps"]]
    every = weights.reshape(-1) if "bias_left_out" in wrong else np.concatenate([weights.reshape(-1), bias])
    norm = norm_of(every, wrong)

    def clipped(g, norm):
        excess = (norm + kind(eps)) / kind(most)
        if "stretched" in wrong:
            clips = norm > 0
        elif "square_compared" in wrong:
            clips = norm * norm > most
        else:
            clips = excess > 1
        return np.divide(g, excess, out=g.copy(), where=clips)

    if "numbers_clipped" in wrong:
        out = [np.clip(g, -kind(most), kind(most)) for g in (weights, bias)]
    elif "norm_of_each_tensor" in wrong:
        out = [clipped(g, norm_of(g, wrong)) for g in (weights, bias)]
    elif "norm_of_each_row" in wrong:
        out = [np.stack([clipped(g, norm_of(g, wrong)) for g in weights]), clipped(bias, norm_of(bias, wrong))]
    else:
        out = [clipped(weights, norm), bias if "bias_left_out" in wrong else clipped(bias, norm)]
    if "norm_of_clipped" in wrong:
        norm = norm_of(np.concatenate([g.reshape(-1) for g in out]), wrong)
    return {"g_weights_out": out[0], "g_bias_out": out[1], "norm": kind(norm)}


def clip_by_value(a, c, wrong):
    """The sign times the smaller size."""
    g = a["g"]
    limit, size = g.dtype.type(a["limit"]), np.abs(g)
    beyond = size > limit
    if "above_alone" in wrong:
        beyond = g > limit
    if "below_alone" in wrong:
        beyond = g < -limit
    if "scaled_together" in wrong:
        largest = size.max()
        return {"g_out": g * (limit / largest) if largest > limit else g}
    edge = limit if "sign_forgotten" in wrong else g.dtype.type(0) if "dropped" in wrong else np.sign(g) * limit
    return {"g_out": np.where(beyond, edge, g).astype(g.dtype)}
