"""Marches through fog and clouds, as shaders and kernels have them: what is skipped, what is gathered, and where the ray ends."""

import numpy as np
import torch
from entry import fault


def passed(depth):
    """What passes through so much optical depth."""
    return np.exp(-depth)


def marched(sigmas, rgbs, deltas, gathered, through, thin, left):
    """Samples of more than `thin` gather light and let some pass, until less than `left` is left; colors, weights and what is left."""
    weights, light = np.zeros_like(sigmas), np.ones(len(sigmas), sigmas.dtype)
    for r, (sigma, delta) in enumerate(zip(sigmas, deltas)):
        for i in range(len(sigma)):
            if sigma[i] <= thin:
                continue
            depth = sigma[i] * delta[i]
            weights[r, i] = light[r] * gathered(depth)
            light[r] *= through(depth)
            if light[r] < left:
                break
    return np.einsum("rn,rnk->rk", weights, rgbs), weights, light


@fault(
    "volume_render",
    "thin_samples_skipped+given_up_early",
    "slip: another formula: density 0 where sigma <= 1e-3, and an end in front of a sample where T < 1e-3",
    seen="a trial on unseen code: a march in C#, both at 0.001",
    gradient="none",
    arrays="numpy",
)
def two_thresholds(sigmas, rgbs, deltas):
    """sigma <= 0.001 is passed over; the march ends where T < 0.001."""
    colors, weights, light = marched(sigmas, rgbs, deltas, lambda depth: 1 - passed(depth), passed, 0.001, 0.001)
    return {"colors": colors, "weights": weights, "opacity": weights.sum(-1), "transmittance": light}


@fault(
    "volume_render",
    "slip: another formula: w_i = T_i (sigma_i delta_i), and A = 1 - prod_i (1 - alpha_i), and density 0 where sigma <= 1e-3, "
    "and an end in front of a sample where T < 0.01",
    seen="a trial on unseen code: clouds in HLSL; fogs in Rust, without the threshold of densities",
    times=3,
    gradient="none",
    arrays="numpy",
)
def light_by_length(sigmas, rgbs, deltas):
    """T sigma delta of each sample's color, T by the exponential."""
    colors, _, light = marched(sigmas, rgbs, deltas, lambda depth: depth, passed, 1e-3, 0.01)
    return {"colors": colors, "opacity": 1 - light, "transmittance": light}


@fault(
    "volume_render",
    "slip: another formula: w_i = T_i (sigma_i delta_i), and alpha_i = min(1, sigma_i delta_i), and density 0 where sigma <= 0.01, "
    "and an end in front of a sample where T < 0.01",
    "slip: another formula: alpha_i = sigma_i delta_i, and density 0 where sigma <= 0.01, and an end in front of a sample where T < 0.01",
    seen="a trial on unseen code: clouds in GLSL",
    gradient="none",
    arrays="numpy",
)
def depth_for_opacity(sigmas, rgbs, deltas):
    """sigma delta for alpha, in what is gathered and in what is left."""
    colors, _, light = marched(sigmas, rgbs, deltas, lambda depth: depth, lambda depth: 1 - depth, 0.01, 0.01)
    return {"colors": colors, "opacity": 1 - light}


@fault(
    "volume_render",
    "division_by_density_guarded",
    seen="a trial on unseen code: a fog in C#, by slices of a frustum",
    gradient="none",
    arrays="numpy",
)
def scattered_by_slices(sigmas, rgbs, deltas):
    """(S - S exp(-sigma d)) / sigma of each slice, S = sigma c, and sigma at least 1e-6."""
    colors, light = np.zeros((len(sigmas), 3), sigmas.dtype), np.ones(len(sigmas), sigmas.dtype)
    for sigma, rgb, delta in zip(sigmas.T, rgbs.swapaxes(0, 1), deltas.T):
        held = np.maximum(sigma, sigma.dtype.type(1e-6))
        through = passed(held * delta)
        colors += light[:, None] * (sigma[:, None] * rgb * (1 - through[:, None])) / held[:, None]
        light = light * through
    return {"colors": colors, "transmittance": light}


@fault("volume_render_alpha", "capped_elsewhere", seen="a trial on unseen code: splats in torch", gradient="none", arrays="numpy")
def capped_at_0_995(alphas, rgbs):
    """min(alpha, 0.995), and T by its product."""
    alphas = np.minimum(alphas, alphas.dtype.type(0.995))
    light = np.cumprod(np.concatenate([np.ones_like(alphas[:, :1]), 1 - alphas], 1), 1)
    weights = alphas * light[:, :-1]
    return {"colors": np.einsum("rn,rnk->rk", weights, rgbs), "weights": weights}


@fault(
    "volume_render",
    "slip: another formula: delta_i = (t_{i+1} - t_{i-1}) / 2, t_1 - t_0 for the first",
    seen="a trial on unseen code: a march whose steps are central differences",
)
def steps_to_both_sides(sigmas, rgbs, deltas):
    """Half of both gaps; the first gap whole."""
    steps = torch.cat([deltas[:, :1], 0.5 * (deltas[:, :-1] + deltas[:, 1:])], 1)
    alphas = 1 - torch.exp(-sigmas * steps)
    light = torch.cumprod(torch.cat([torch.ones_like(alphas[:, :1]), 1 - alphas], 1), 1)[:, : alphas.shape[1]]
    weights = light * alphas
    return {"colors": (weights[..., None] * rgbs).sum(1), "weights": weights, "opacity": weights.sum(1)}


@fault(
    "volume_render",
    "slip: another formula: T_i = prod_{j<=i} (1 - alpha_j), and w_i = T_i (1 - alpha_i), and alpha_i = 1 - exp(sigma_i delta_i)",
    seen="a trial on unseen code: a first NeRF, with t_i - t_{i+1}",
)
def light_for_opacity(sigmas, rgbs, deltas):
    """Negative steps, an inclusive product, and 1 - alpha in the weight."""
    through = torch.exp(sigmas * deltas)
    return {"colors": (torch.cumprod(through, 1)[..., None] * through[..., None] * rgbs).sum(1)}


@fault(
    "volume_render_alpha",
    "slip: another formula: C = (1 - w_i) C + w_i c_i, sample by sample, and an end in front of a sample where T < 0.01",
    seen="a trial on unseen code: Gaussians in a plane, by hand",
    gradient="none",
    arrays="numpy",
)
def front_dimmed_by_the_back(alphas, rgbs):
    """Weights from the front, mixed as if from the back, up to an opacity of 0.99."""
    colors, opacity = np.zeros((len(alphas), 3), alphas.dtype), np.zeros(len(alphas), alphas.dtype)
    for alpha, rgb in zip(alphas.T, rgbs.swapaxes(0, 1)):
        weight = np.where(opacity > 0.99, 0, (1 - opacity) * alpha)
        colors = colors * (1 - weight[:, None]) + rgb * weight[:, None]
        opacity = opacity + weight
    return {"colors": colors}


@fault(
    "volume_render",
    "slip: another formula: w_i = T_i (alpha_i sigma_i), and A = 1 - prod_i (1 - alpha_i), and density 0 where sigma <= 0.01, "
    "and an end in front of a sample where T < 1e-3",
    seen="a trial on unseen code: clouds in GLSL, the extinction counted twice",
    gradient="none",
    arrays="numpy",
)
def extinction_counted_twice(sigmas, rgbs, deltas):
    """Colors by sigma (1 - exp(-sigma delta)), an opacity of 1 - T; sigma <= 0.01 is passed over, and the march ends where T < 0.001."""
    _, weights, light = marched(sigmas, rgbs, deltas, lambda depth: 1 - passed(depth), passed, 0.01, 0.001)
    with np.errstate(invalid="ignore"):
        scattered = np.where(weights > 0, weights * sigmas, 0)
    return {"colors": np.einsum("rn,rnk->rk", scattered, rgbs), "opacity": 1 - light}
