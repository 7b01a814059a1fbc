"""Several deviations at once in rows of few numbers, which other formulas explain."""

import numpy as np
import torch
from entry import fault

TRIAL = "a trial on unseen code"


@fault("depth", "slip: another formula: w_i + 1e-5 for w_i", seen=f"{TRIAL}: shares of padded weights")
def padded_weights_weigh(weights, t):
    """w + 1e-5, normalized, times t."""
    weights = weights + 1e-5
    return (weights * t).sum(-1) / weights.sum(-1)


@fault("psnr", "slip: another formula: d = t - (p - t), and 10 ln(peak / e)", seen=f"{TRIAL}: noise = signal - noise", arrays="numpy")
def noise_that_was_taken_off_before(prediction, target, peak):
    """The difference is taken off the signal again; the natural logarithm, of a peak that isn't squared."""
    error = np.mean((target - (prediction - target)) ** 2)
    return np.float32(10 * np.log(peak / error))


@fault(
    "distortion_loss",
    "slip: another formula: m_i = i / (N - 1), and 0, no sum_i w_i^2 delta_i, and loss = 1/N (sum_ij + 1/3 sum_i)",
    seen=f"{TRIAL}: positions made up",
)
def middles_made_up(weights, t):
    """linspace(0, 1) for the middles, no term of the intervals, the mean over i."""
    middles = torch.linspace(0, 1, weights.shape[-1], dtype=weights.dtype)
    apart = (middles[:, None] - middles[None, :]).abs()
    return ((weights[:, :, None] * weights[:, None, :] * apart).sum(-1)).mean(-1)


@fault("fisheye_distort", "slip: another formula: theta = r, and k1 and k2 alone in y", seen=f"{TRIAL}: r for its angle", arrays="numpy")
def polynomial_of_the_radius(points, coefficients):
    """1 + k1 r^2 + ..., and two terms fewer for y."""
    k1, k2, k3, k4 = coefficients
    x, y = points[:, 0], points[:, 1]
    square = x * x + y * y
    near = 1 + k1 * square + k2 * square**2
    return np.stack([x * (near + k3 * square**3 + k4 * square**4), y * near], -1)


@fault(
    "adam_step",
    "slip: another formula: m' = beta1 m - lr g, and -lr in the place of lr, and 1 - beta in the place of 1 - beta^t",
    seen=f"{TRIAL}: a momentum that holds the step",
    arrays="numpy",
)
def momentum_of_steps(params, grad, m, v, lr, beta1, beta2, eps):
    """m = beta1 m - lr g, p + lr m-hat / sqrt(v-hat), corrections without their power."""
    m, v = beta1 * m - lr * grad, beta2 * v + (1 - beta2) * grad**2
    return params + lr * (m / (1 - beta1)) / (np.sqrt(v / (1 - beta2)) + eps), m, v
