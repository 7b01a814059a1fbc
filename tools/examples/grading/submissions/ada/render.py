"""Everything right, in a package of two files."""

import numpy as np


def volrend(density, color, step_sizes):
    alpha = -np.expm1(-density * step_sizes)
    # What lies in front of each sample.
    front = np.cumsum(np.pad(density * step_sizes, ((0, 0), (1, 0)))[:, :-1], axis=1, dtype=density.dtype)
    weights = np.exp(-front) * alpha
    return (weights[..., None] * color).sum(axis=1)


def composite_background(colors, opacity, background):
    return colors + (1 - opacity)[:, None] * background


def composite_background_vjp(opacity, background, grad_colors_out):
    return {
        "grad_colors": grad_colors_out,
        "grad_opacity": -(grad_colors_out * background).sum(axis=1),
        "grad_background": ((1 - opacity)[:, None] * grad_colors_out).sum(axis=0),
    }
