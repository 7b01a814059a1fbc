"""Two mistakes: the sample shades itself, and the bands have no pi."""

import numpy as np


def positional_encoding(x, L):
    bands = [x] + [f(2.0**k * x) for k in range(L) for f in (np.sin, np.cos)]
    return np.concatenate(bands, axis=-1).astype(x.dtype)


def volrend(density, color, step_sizes):
    alpha = 1 - np.exp(-density * step_sizes)
    weights = np.cumprod(1 - alpha, axis=1) * alpha
    return np.sum(weights[..., None] * color, axis=1)


def composite_background(colors, opacity, background):
    return colors + (1 - opacity)[:, None] * background
