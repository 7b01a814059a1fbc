"""ssim(prediction, target, peak): structural similarity, Gaussian windows of 11 x 11 in the picture (Wang et al. 2004)."""

import mpmath
import numpy as np
import torch

from . import reals
from .fixture import Case, Draw

NAME, PURPOSE = "ssim", 1320
DIFFERENTIABLE = ("prediction",)


def cases():
    """Pictures of several windows: noise, low contrast, flat ones, bytes, equal ones."""
    for name, shape, low, high, noise, peak in (
        ("noise", (12, 13, 1), 0.1, 0.9, 0.3, 1.0),
        ("faint", (11, 12, 2), 0.45, 0.55, 0.05, 1.0),
        ("bytes", (12, 11, 1), 20.0, 230.0, 50.0, 255.0),
    ):
        draw = Draw(PURPOSE, name)
        target = draw.uniform(shape, low, high)
        yield case(name, target + draw.uniform(shape, -noise / 2, noise / 2), target, peak, "noise on noise")
    yield case("flat", np.full((11, 11, 1), 0.4), np.full((11, 11, 1), 0.7), 1.0, "luminance alone")
    target = Draw(PURPOSE, "equal").uniform((11, 11, 1), 0.0, 1.0)
    yield case("equal", target, target, 1.0, "1, and a gradient of 0")


def case(name, prediction, target, peak, comment):
    """A case from two pictures."""
    return Case(name, {"prediction": prediction, "target": target, "peak": np.array(peak)}, comment)


def over_reals(x):
    """The definition, window by window, with central moments."""
    a, b, peak = x["prediction"], x["target"], x["peak"][()]
    line = [mpmath.exp(-mpmath.mpf(n * n) / (2 * mpmath.mpf(1.5) ** 2)) for n in range(-5, 6)]
    line = [w / mpmath.fsum(line) for w in line]
    weights = [reals.constant(p * q) for p in line for q in line]
    c1, c2 = (peak * peak * reals.constant(mpmath.mpf(k) / 10000) for k in (1, 9))
    height, width, channels = a.shape
    values = []
    for j in range(height - 10):
        for i in range(width - 10):
            for c in range(channels):
                p, q = (list(y[j : j + 11, i : i + 11, c].reshape(-1)) for y in (a, b))
                mean_p, mean_q = reals.dot(weights, p), reals.dot(weights, q)
                p, q = [y - mean_p for y in p], [y - mean_q for y in q]
                pairs = (p, p), (q, q), (p, q)
                var_p, var_q, cov = (reals.total([w * u * v for w, u, v in zip(weights, s, t)]) for s, t in pairs)
                above = (mean_p * mean_q * 2 + c1) * (cov * 2 + c2)
                values.append(above / ((mean_p * mean_p + mean_q * mean_q + c1) * (var_p + var_q + c2)))
    return {"value": np.array(reals.total(values) / len(values), dtype=object)}


def in_torch(x):
    """By torch's convolutions, as splatting code: means of squares less squares of means, of pictures less peak / 2."""
    a, b = (x[name].permute(2, 0, 1)[:, None] for name in ("prediction", "target"))
    peak = x["peak"]
    middle = peak / 2
    line = torch.exp(-(torch.arange(-5.0, 6.0) ** 2) / (2 * 1.5**2))
    line = line / line.sum()
    window = (line[:, None] * line[None, :])[None, None]

    def mean(y):
        return torch.nn.functional.conv2d(y, window)

    p, q = a - middle, b - middle
    var_p, var_q, cov = (mean(u * v) - mean(u) * mean(v) for u, v in ((p, p), (q, q), (p, q)))
    mean_a, mean_b = mean(a), mean(b)
    c1, c2 = (0.01 * peak) ** 2, (0.03 * peak) ** 2
    above = (2 * mean_a * mean_b + c1) * (2 * cov + c2)
    return {"value": (above / ((mean_a**2 + mean_b**2 + c1) * (var_p + var_q + c2))).mean()}
