"""The background behind a ray, and its depth."""

import numpy as np
import torch
from entry import convention, fault, right


@right("composite_background", seen="nerfacc volrend.py; nearly everybody", times=20)
def what_is_left_of_one(colors, opacity, background):
    """C + (1 - A) b."""
    return colors + background * (1.0 - opacity[:, None])


@right("composite_background", seen="100-line NeRF and its ports (white), as c + 1 - sum", times=6)
def opacity_taken_off_the_background(colors, opacity, background):
    """C + b - A b."""
    return colors + background - opacity.unsqueeze(-1) * background


@right("composite_background", seen="a torch splat renderer")
def linear_interpolation(colors, opacity, background):
    """torch.addcmul of what is left."""
    return torch.addcmul(colors, 1 - opacity[:, None], background.expand_as(colors))


@right("composite_background", seen="numpy ports", times=2, arrays="numpy")
def numpy_outer(colors, opacity, background):
    """An outer product."""
    return colors + np.outer(1 - opacity, background)


@right("composite_background", seen="GLSL and WGSL renderers", times=4, arrays="numpy")
def channel_by_channel(colors, opacity, background):
    """A loop over rays and channels."""
    return np.array([[c[k] + (1 - a) * background[k] for k in range(3)] for c, a in zip(colors, opacity)])


@fault("composite_background", "attenuated_twice", seen="nerfstudio#2165, instant-nsr-pl#54", times=2)
def mixed_as_if_not_multiplied(colors, opacity, background):
    """A C + (1 - A) b: C was multiplied by its weights before."""
    return opacity[:, None] * colors + (1 - opacity[:, None]) * background


@fault("composite_background", "background_always", seen="an earlier reading of 114 implementations")
def background_added(colors, opacity, background):
    """C + b."""
    return colors + background.expand(len(colors), 3)


@fault("composite_background", "background_by_opacity", seen="a splat renderer in torch (1 - (1 - prod))")
def background_by_opacity(colors, opacity, background):
    """C + A b: opacity in the place of what is left."""
    return colors + opacity[:, None] * background


@fault("composite_background", "one_channel", seen="an earlier reading of 114 implementations")
def first_channel_alone(colors, opacity, background):
    """The background goes into the first channel."""
    return torch.cat([colors[:, :1] + (1 - opacity[:, None]) * background[0], colors[:, 1:]], 1)


@fault("composite_background", "background_255", seen="an earlier reading of 114 implementations")
def background_in_bytes(colors, opacity, background):
    """The background counts from 0 to 255."""
    return colors + (1 - opacity[:, None]) * (background * 255)


@right("depth", seen="jaxnerf and mip-NeRF (far where there is nothing)", times=2)
def mean_distance_or_far(weights, t, far):
    """The mean distance, far for an empty ray."""
    total = weights.sum(-1)
    return torch.where(total > 0, (weights * t).sum(-1) / total.clamp_min(1e-30), torch.full_like(total, far))


@convention(
    "depth", {"depth": "plain"}, seen="bmild/nerf, krrish94, kwea123/nerf_pl, keras-io, CMU, CS180 (volrend_depth)", times=14
)
def summed_distance(weights, t):
    """sum w t, not divided."""
    return torch.sum(weights * t, dim=-1)


@convention("depth", {"depth": "plain"}, seen="kornia-like and MLX ports", times=3, arrays="numpy")
def summed_distance_in_numpy(weights, t):
    """sum w t in numpy."""
    return np.einsum("rn,rn->r", weights, t)


@convention("depth", {"empty_depth": "zero"}, seen="nerfstudio-project/nerfacc volrend.py")
def divided_by_at_least_eps(weights, t):
    """Divided by max(A, machine epsilon): 0 for an empty ray."""
    return (weights * t).sum(-1) / weights.sum(-1).clamp_min(torch.finfo(weights.dtype).eps)


@convention("depth", {"empty_depth": "first"}, seen="nerfstudio model_components/renderers.py, method expected")
def divided_and_clipped(weights, t):
    """Divided by A + 1e-10, clipped to the smallest and largest t: the smallest for an empty ray."""
    return torch.clip((weights * t).sum(-1) / (weights.sum(-1) + 1e-10), t.min(), t.max())


@convention("depth", {"empty_depth": "zero"}, seen="google/nerfies and a jax port of it", times=2)
def divided_by_at_least_1e_12(weights, t):
    """Divided by max(A, 1e-12)."""
    return (weights * t).sum(-1) / weights.sum(-1).clamp(1e-12)


@convention("depth", {"empty_depth": "last"}, seen="mip-NeRF in jax: nan to infinity, clipped to the ray", gradient="none")
def nan_to_the_far_end(weights, t, near=0.0, far=None):
    """0 / 0 becomes infinite and is cut at the last sample's place."""
    mean = torch.nan_to_num((weights * t).sum(-1) / weights.sum(-1), float("inf"))
    return torch.minimum(torch.maximum(mean, t[:, 0]), t[:, -1])


@convention("depth", {"empty_depth": "zero"}, seen="renderers with 1e-6 or 1e-8 beside the opacity", times=3)
def divided_by_a_little_more(weights, t):
    """Divided by A + 1e-6."""
    return (weights * t).sum(-1) / (weights.sum(-1) + 1e-6)


@fault("depth", "zero_by_zero", seen="krrish94/nerf-pytorch volume_rendering_utils.py (its disparity)", times=2)
def divided_as_it_comes(weights, t):
    """0 / 0 for an empty ray."""
    return (weights * t).sum(-1) / weights.sum(-1)


@fault("depth", "median_depth", gradient="none", seen="nerfstudio model_components/renderers.py, method median: another quantity")
def median_distance(weights, t):
    """Where half of the light is spent, not the mean."""
    index = torch.searchsorted(torch.cumsum(weights, -1), torch.full((len(weights), 1), 0.5), side="left")
    return torch.gather(t, -1, index.clamp(0, t.shape[1] - 1))[:, 0]


@fault("depth", "disparity", gradient="none", seen="yenchenlin/nerf-pytorch run_nerf.py: disparity, where depth is asked for", times=3)
def disparity(weights, t):
    """One over the depth."""
    depth = (weights * t).sum(-1)
    return 1 / torch.clamp(depth / weights.sum(-1).clamp_min(1e-30), min=1e-10)


@fault("depth", "far_by_opacity", seen="a renderer and its copies")
def far_where_something_is(weights, t, far):
    """far is added times A, for 1 - A."""
    return (weights * t).sum(-1) + far * weights.sum(-1)


@convention("depth", {"depth": "far_behind"}, seen="renderers that end what passes at far, as with a background", times=3)
def far_for_what_passes(weights, t, far):
    """sum w t + (1 - A) far."""
    return (weights * t).sum(-1) + (1 - weights.sum(-1)) * far


@convention("depth", {"depth": "far_behind"}, seen="the weights' rest as one more sample", times=1, arrays="numpy", gradient="none")
def far_as_one_more_sample(weights, t, far):
    """The rest of the light is a weight of its own."""
    rest = 1 - weights.sum(-1, keepdims=True)
    weights = np.concatenate([weights, rest], -1)
    t = np.concatenate([t, np.full_like(rest, far)], -1)
    return (weights * t).sum(-1)


def step_ends(t, far):
    """Where each step ends: at the next sample, the last one at far."""
    return torch.cat([t[:, 1:], torch.full_like(t[:, :1], far)], 1)[:, : t.shape[1]]


@fault("depth", "steps_summed_for_t", seen="a trial on unseen code: weights times cumsum(deltas)", gradient="none")
def sum_of_the_steps(weights, t, far):
    """The steps' cumulative sum in the place of t."""
    return (weights * (step_ends(t, far) - t[:, :1])).sum(-1)


@fault("depth", "middles_of_steps", seen="a trial on unseen code", gradient="none")
def middles_of_steps_and_far(weights, t, far):
    """sum w (t + delta / 2) + (1 - A) far."""
    return (weights * 0.5 * (t + step_ends(t, far))).sum(-1) + (1 - weights.sum(-1)) * far


@fault("depth", "thin_rays_left_out", seen="a trial on unseen code: 0 where the opacity is below 0.1", gradient="none")
def nothing_for_thin_rays(weights, t):
    """Divided by the opacity, and 0 for rays of less than a tenth."""
    opacity = weights.sum(-1)
    depth = (weights * t).sum(-1) / (opacity + 1e-10)
    return torch.where(opacity < 0.1, torch.zeros_like(depth), depth)


@fault("depth", "one_where_light_is_left", seen="a trial on unseen code: white_bkgd over depths, too", gradient="none")
def white_depth(weights, t):
    """A mean, 0 on empty rays, to which the white background's share is added."""
    opacity = weights.sum(-1)
    return (weights * t).sum(-1) / (opacity + 1e-10) + (1 - opacity)


@fault("depth", "kept_between_the_samples", seen="a trial on unseen code: a port of mip-NeRF", gradient="none")
def clipped_to_the_samples(weights, t):
    """Not divided by the opacity, as the division was commented out; then clipped."""
    return torch.clamp((weights * t).sum(-1), t[:, 0], t[:, -1])


@fault(
    "composite_background",
    "no_background_behind_the_nearly_opaque",
    seen="a trial on unseen code: a splat renderer in CUDA",
    gradient="none",
)
def thin_light_left_out(colors, opacity, background):
    """(1 - A) b below 0.999, nothing above."""
    left = torch.where(opacity < 0.999, 1 - opacity, torch.zeros_like(opacity))
    return colors + left[:, None] * background


@fault("depth", "median_depth_or_none", seen="a trial on unseen code: a port of HyperNeRF", gradient="none")
def half_of_the_light_or_nothing(weights, t):
    """The first t where the sum reaches 1/2; 0 where it never does."""
    reached = torch.cumsum(weights, -1) >= 0.5
    first = (reached & (torch.cumsum(reached, -1) == 1)).to(t.dtype)
    return (first * t).sum(-1)


@fault("depth", "not_a_number_everywhere", seen="a trial on unseen code: a port of TensoRF", gradient="none")
def masked_infinity(weights, t):
    """A mask times distances that end with infinity."""
    mask = torch.nn.functional.pad(torch.cumsum(weights, -1) >= 0.5, (0, 1)).to(t.dtype)
    return (mask * torch.nn.functional.pad(t, (0, 1), value=torch.inf)).sum(-1)


@fault(
    "depth_vjp",
    "nan_behind_a_choice",
    seen="a trial on unseen code: a port of mip-NeRF",
    arrays="numpy",
)
def a_quotient_that_is_not_chosen(weights, t, far, grad_depth):
    """far where nan_to_num finds 0 / 0, clipped; the quotient's gradient stays."""
    w, at = (torch.from_numpy(a.copy()).requires_grad_() for a in (weights, t))
    distance = torch.nan_to_num((w * at).sum(-1) / w.sum(-1), float("inf"))
    torch.clip(distance, max=float(far)).backward(torch.from_numpy(grad_depth.copy()))
    return {"grad_weights": w.grad.numpy(), "grad_t": at.grad.numpy()}


@fault("composite_background", "attenuated_twice+rendered_color_clamped", seen="a trial on unseen code: clouds in GLSL")
def light_clamped_and_mixed(colors, opacity, background):
    """mix(clamp(light, 0, 1), background, T)."""
    left = 1 - opacity[:, None]
    return colors.clamp(0, 1) * (1 - left) + background * left


@fault("composite_background", "background_forgotten", seen="a trial on unseen code: a renderer that has none")
def color_alone(colors, opacity, background):
    """C."""
    return colors + 0 * background
