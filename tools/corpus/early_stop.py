"""Packed samples, stopped where little light is left."""

import numpy as np
import torch
from entry import convention, fault, right


def ranges(offsets):
    """(first, end) of each ray."""
    ends = [int(x) for x in offsets]
    return list(zip(ends, ends[1:]))


def named(colors, weights, opacity, behind):
    """By name: nobody hands out how many samples a ray used."""
    return {"colors": colors, "weights": weights, "opacity": opacity, "transmittance": behind}


def marched(sigmas, rgbs, deltas, offsets, stop, carried=False, rectangles=False):
    """Colors, weights, opacity and T behind each ray. `stop(T, next_T, weight)` gives (use this sample, go on)."""
    weights, colors, opacity, behind = torch.zeros_like(sigmas), [], [], []
    left = torch.ones_like(sigmas.sum())
    for first, end in ranges(offsets):
        left = left if carried else torch.ones_like(sigmas.sum())
        color, total = torch.zeros(3), torch.zeros(())
        for i in range(first, end):
            alpha = 1 - torch.exp(-sigmas[i] * deltas[i])
            use, go_on = stop(float(left), float(left * (1 - alpha)), float(left * alpha))
            if use:
                weight = left * (sigmas[i] * deltas[i] if rectangles else alpha)
                weights = weights.index_put((torch.tensor(i),), weight)
                color, total = color + weight * rgbs[i], total + weight
                left = left * (1 - alpha)
            if not go_on:
                break
        colors.append(color)
        opacity.append(total)
        behind.append(left)
    return named(torch.stack(colors), weights, torch.stack(opacity), torch.stack(behind))


@right("early_stop", seen="ashawkey/torch-ngp composite_rays, kwea123/ngp_pl, ports in C++ and Metal", times=5)
def tested_behind_the_sample(sigmas, rgbs, deltas, offsets, eps):
    """T is tested behind the sample that was just added."""
    return marched(sigmas, rgbs, deltas, offsets, lambda left, behind, weight: (True, behind >= eps))


@right("early_stop", seen="shaders and C++: if (T < 0.01) break, written in", times=6)
def threshold_of_its_own(sigmas, rgbs, deltas, offsets):
    """Nobody is asked where to stop: at 1e-2."""
    return marched(sigmas, rgbs, deltas, offsets, lambda left, behind, weight: (True, behind >= 0.01))


@right("early_stop", seen="shaders: if (T < eps) break at the loop's head", times=6)
def tested_at_the_head(sigmas, rgbs, deltas, offsets, eps):
    """T is tested in front of the next sample."""
    return marched(sigmas, rgbs, deltas, offsets, lambda left, behind, weight: (left >= eps, left >= eps))


@fault("early_stop", "optical_depth_for_alpha", seen="volumes in GLSL: color += c sigma T step; T *= exp(-sigma step)", times=3)
def rectangles(sigmas, rgbs, deltas, offsets, eps):
    """w = T sigma delta."""
    return marched(sigmas, rgbs, deltas, offsets, lambda left, behind, weight: (True, behind >= eps), rectangles=True)


@right("early_stop", seen="a numpy check of a splat renderer; C# and Metal loops", times=3, arrays="numpy")
def numpy_cut(sigmas, rgbs, deltas, offsets, eps):
    """numpy: the first T below eps, found and cut behind."""
    weights = np.zeros_like(sigmas)
    colors, opacity, behind = [], [], []
    for first, end in ranges(offsets):
        alpha = 1 - np.exp(-sigmas[first:end] * deltas[first:end])
        product = np.cumprod(np.concatenate([np.ones(1, alpha.dtype), 1 - alpha]))
        low = np.flatnonzero(product[1:] < eps)
        n = low[0] + 1 if len(low) else end - first
        weights[first : first + n] = product[:n] * alpha[:n]
        colors.append((weights[first:end, None] * rgbs[first:end]).sum(0))
        opacity.append(weights[first:end].sum())
        behind.append(product[n])
    return named(np.stack(colors), weights, np.stack(opacity), np.stack(behind))


@convention("early_stop", seen="graphdeco-inria/gaussian-splatting forward.cu, gsplat and ports of both", times=8)
def tested_before_the_sample_is_added(sigmas, rgbs, deltas, offsets, eps):
    """The sample that takes T below eps isn't added."""
    return marched(sigmas, rgbs, deltas, offsets, lambda left, behind, weight: (behind >= eps, behind >= eps))


@convention("early_stop", {"stopped": "made_opaque"}, seen="NVlabs/instant-ngp testbed_nerf.cu; PlenOctrees' kernel", times=3)
def stopped_rays_made_opaque(sigmas, rgbs, deltas, offsets, eps):
    """A ray that stops is divided by its opacity."""
    colors, weights, opacity, behind = tested_behind_the_sample(sigmas, rgbs, deltas, offsets, eps).values()
    scale = torch.where(behind < eps, 1 / opacity.clamp_min(1e-10), torch.ones_like(opacity))
    spread = torch.cat([scale[r].expand(end - first) for r, (first, end) in enumerate(ranges(offsets))] or [scale[:0]])
    return named(
        colors * scale[:, None], weights * spread, opacity * scale, torch.where(behind < eps, torch.zeros_like(behind), behind)
    )


@convention("early_stop", {"stop": "one_more"}, seen="ashawkey/torch-ngp's inference kernel and copies of it", times=2)
def one_sample_more(sigmas, rgbs, deltas, offsets, eps):
    """T in front of the sample is tested behind it."""
    return marched(sigmas, rgbs, deltas, offsets, lambda left, behind, weight: (True, left >= eps))


@fault("early_stop", "weight_tested", seen="a shader that leaves its loop at a small alpha", times=1)
def stopped_at_a_small_weight(sigmas, rgbs, deltas, offsets, eps):
    """The weight is tested, not what is left."""
    return marched(sigmas, rgbs, deltas, offsets, lambda left, behind, weight: (True, weight >= eps))


@fault("early_stop", "not_reset_between_rays", seen="a loop over packed rays whose T is set once", times=1)
def light_of_the_ray_before(sigmas, rgbs, deltas, offsets, eps):
    """T goes on from ray to ray."""
    return marched(sigmas, rgbs, deltas, offsets, lambda left, behind, weight: (True, behind >= eps), carried=True)


@fault("early_stop", "ends_taken_for_counts", seen="offsets (start, end) read as (start, count)", times=1)
def counts_for_ends(sigmas, rgbs, deltas, offsets, eps):
    """A ray has offsets[r + 1] samples from offsets[r]."""
    ends = [int(x) for x in offsets]
    rays = [
        marched(sigmas, rgbs, deltas, [a, min(a + b, len(sigmas))], lambda left, behind, weight: (True, behind >= eps))
        for a, b in zip(ends, ends[1:])
    ]
    colors, weights, opacity, behind = zip(*(ray.values() for ray in rays))
    return named(torch.cat(colors), sum(weights), torch.cat(opacity), torch.cat(behind))


def backward(sigmas, rgbs, deltas, offsets, eps, cotangents, last=True):
    """The kernel's backward pass: the sum less what was met lies behind a sample. `last`: the last live sample learns."""
    g_colors, g_weights, g_opacity, g_behind = cotangents
    g_x, g_rgbs = np.zeros_like(sigmas), np.zeros_like(rgbs)
    for r, (first, end) in enumerate(ranges(offsets)):
        through = np.exp(-(sigmas[first:end] * deltas[first:end]).astype(np.float64))
        product = np.cumprod(np.concatenate([[1.0], through]))
        low = np.flatnonzero(product[1:] < eps)
        n = int(low[0]) + 1 if len(low) else end - first
        weights = product[:n] * (1 - through[:n])
        worth = rgbs[first : first + n] @ g_colors[r] + g_weights[first : first + n] + g_opacity[r]
        rest = (weights * worth).sum() - np.cumsum(weights * worth) + product[n] * g_behind[r]
        slope = product[1 : n + 1] * worth - rest
        used = n if last or not len(low) else n - 1
        g_x[first : first + used] = slope[:used]
        g_rgbs[first : first + used] = weights[:used, None] * g_colors[r]
    return {"grad_sigmas": g_x * deltas, "grad_rgbs": g_rgbs, "grad_deltas": g_x * sigmas}


@right("early_stop_vjp", seen="ashawkey/torch-ngp raymarching.cu, kwea123/ngp_pl composite_train_bw", times=3, arrays="numpy")
def sum_less_what_was_met(sigmas, rgbs, deltas, offsets, eps, grad_colors, grad_weights, grad_opacity, grad_transmittance):
    """By hand: delta (T c - what lies behind)."""
    return backward(sigmas, rgbs, deltas, offsets, eps, (grad_colors, grad_weights, grad_opacity, grad_transmittance))


@fault(
    "early_stop_vjp", "last_sample_learns_nothing",
    seen="an earlier ashawkey/torch-ngp raymarching.cu: the loop is left before it writes",
    times=2,
    arrays="numpy",
)
def last_sample_learns_nothing(sigmas, rgbs, deltas, offsets, eps, grad_colors, grad_weights, grad_opacity, grad_transmittance):
    """The sample behind which a ray stops has no gradient."""
    return backward(sigmas, rgbs, deltas, offsets, eps, (grad_colors, grad_weights, grad_opacity, grad_transmittance), last=False)


@fault("early_stop", "divided_by_light_in_front", seen="a trial on unseen code: a renderer of sparse voxels", gradient="none")
def divided_by_what_was_spent_in_front(sigmas, rgbs, deltas, offsets, eps):
    """Where a ray stops, its color is divided by 1 - T, T in front of the last sample."""
    colors, weights, opacity, behind = tested_behind_the_sample(sigmas, rgbs, deltas, offsets, eps).values()
    colors = colors.clone()
    for r, (first, end) in enumerate(ranges(offsets)):
        used = weights[first:end].nonzero()
        if behind[r] < eps and len(used):
            colors[r] = colors[r] / weights[first : first + int(used[-1])].sum()
    return named(colors, weights, opacity, behind)


@fault("early_stop", "opacity_of_first_order+eps_of_its_own", seen="a trial on unseen code: clouds in GLSL", gradient="none", arrays="numpy")
def clouds_of_first_order(sigmas, rgbs, deltas, offsets):
    """alpha = sigma step, T *= 1 - alpha, up to a T of 0.025."""
    colors, opacity, behind = [], [], []
    for first, end in ranges(offsets):
        color, total, left = np.zeros(3, sigmas.dtype), sigmas.dtype.type(0), sigmas.dtype.type(1)
        for i in range(first, end):
            alpha = sigmas[i] * deltas[i]
            color, total = color + left * alpha * rgbs[i], total + left * alpha
            left = left * (1 - alpha)
            if left < 0.025:
                break
        colors.append(color)
        opacity.append(total)
        behind.append(left)
    return {"colors": np.stack(colors), "opacity": np.array(opacity), "transmittance": np.array(behind)}
