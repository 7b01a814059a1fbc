"""The second implementation's robust losses: a limited difference and the rest of it, and hypotenuses. See second.py."""

import numpy as np


def reduced(x, c):
    """A sum or mean."""
    return x.sum() if c["loss_reduction"] == "sum" else x.mean()


def share(a, c):
    """The cotangent of an entry."""
    return a["grad_value"] / (1 if c["loss_reduction"] == "sum" else a["prediction"].size)


def huber(a, c, wrong):
    """q^2 / 2 + delta (|d| - q), q = min(|d|, delta)."""
    d = a["prediction"] - a["target"]
    kind, delta = d.dtype.type, d.dtype.type(a["delta"])
    size = np.abs(d)
    limited = np.minimum(size, delta)
    value = limited * limited / 2 + delta * (size - limited)
    beyond = size > delta
    if "half_forgotten" in wrong:
        value = np.where(beyond, value, d * d)
    if "offset_forgotten" in wrong:
        value = np.where(beyond, delta * size, value)
    if "slope_one_beyond" in wrong:
        value = np.where(beyond, size - delta / 2, value)
    if "sign_kept" in wrong:
        value = np.where(d <= delta, d * d / 2, value)
    if "square_compared" in wrong:
        value = np.where(d * d <= delta, d * d / 2, delta * (size - delta / 2))
    return {"value": kind(reduced(value, c) / (delta if c["huber_slope"] == "one" else 1))}


def huber_vjp(a, c, wrong):
    """d, or delta with its sign."""
    d = a["prediction"] - a["target"]
    delta = d.dtype.type(a["delta"])
    beyond = np.abs(d) > delta
    outside = delta * np.sign(d)
    if "slope_not_limited" in wrong:
        outside = d
    if "sign_forgotten" in wrong:
        outside = np.abs(outside)
    if "no_slope_beyond" in wrong:
        outside = outside * 0
    scale = share(a, c) / (delta if c["huber_slope"] == "one" else 1)
    return {"grad_prediction": (np.where(beyond, outside, d) * scale).astype(d.dtype)}


def charbonnier(a, c, wrong):
    """The hypotenuse of d and eps."""
    d = a["prediction"] - a["target"]
    kind, eps = d.dtype.type, a["eps"] if c["charbonnier_eps"] == "square" else np.sqrt(a["eps"])
    if "root_of_mean" in wrong:
        return {"value": np.hypot(np.sqrt(reduced(d * d, c)), kind(eps))}
    value = np.hypot(d, kind(eps))
    if "eps_outside" in wrong:
        value = np.abs(d) + kind(a["eps"])
    if "root_forgotten" in wrong:
        value = d * d + kind(eps * eps)
    if "square_forgotten" in wrong:
        value = np.sqrt(np.abs(d) + kind(eps * eps))
    return {"value": kind(reduced(value, c))}


def charbonnier_vjp(a, c, wrong):
    """The sine of the hypotenuse's angle."""
    d = a["prediction"] - a["target"]
    eps = a["eps"] if c["charbonnier_eps"] == "square" else np.sqrt(a["eps"])
    slope = d / np.hypot(d, d.dtype.type(eps))
    if "eps_forgotten" in wrong:
        slope = np.sign(d)
    if "slope_halved" in wrong:
        slope = slope / 2
    if "not_a_number_at_zero" in wrong:
        slope = np.where(d == 0, np.nan, slope)
    return {"grad_prediction": (slope * share(a, c)).astype(d.dtype)}
