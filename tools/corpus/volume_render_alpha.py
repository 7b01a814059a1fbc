"""Compositing from opacities: splats, and codes that keep alpha."""

import numpy as np
import torch
from entry import convention, fault, right


def summed(weights, rgbs):
    """Colors, weights, opacity."""
    return (weights[..., None] * rgbs).sum(-2), weights, weights.sum(-1)


def factors(alphas, eps=0.0):
    """1, 1 - alpha_0, 1 - alpha_1, ..."""
    return torch.cat([torch.ones(len(alphas), 1), 1 - alphas + eps], 1)


@right("volume_render_alpha", seen="a layered-image code (alpha_composite); two splat tutorials", times=4)
def padded_product(alphas, rgbs):
    """Ones in front, the product, its last behind the ray."""
    product = torch.cumprod(factors(alphas), 1)
    return *summed(product[:, :-1] * alphas, rgbs), product[:, -1]


@right("volume_render_alpha", seen="graphdeco-inria/gaussian-splatting forward.cu without its thresholds; a C# renderer", times=5)
def loop_over_splats(alphas, rgbs):
    """Front to back, T carried along."""
    left, weights = torch.ones_like(alphas[:, :1].sum(1)), []
    for i in range(alphas.shape[1]):
        weights.append(left * alphas[:, i])
        left = left * (1 - alphas[:, i])
    return *summed(torch.stack(weights, 1) if weights else alphas * 0, rgbs), left


@right("volume_render_alpha", seen="a numpy check of a splat renderer", arrays="numpy")
def numpy_product_of_splats(alphas, rgbs):
    """numpy, one in front of the product."""
    product = np.cumprod(1 - alphas, 1)
    front = np.concatenate([np.ones_like(product[:, :1]), product[:, :-1]], 1)[:, : alphas.shape[1]]
    weights = alphas * front
    return (weights[..., None] * rgbs).sum(1), weights, weights.sum(1)


@right("volume_render_alpha", seen="splat tutorials multiply a matrix of weights by the colors", times=2)
def weights_as_a_matrix(alphas, rgbs):
    """Colors alone, ray by ray as a product of weights and colors."""
    front = torch.cumprod(factors(alphas), 1)[:, :-1]
    return torch.stack([w @ c for w, c in zip(front * alphas, rgbs)])


@convention("volume_render_alpha", {"last_sample": "opaque"}, seen="multiplane images: tinghuiz/stereo-magnification's over, ported to torch")
def farthest_layer_is_opaque(alphas, rgbs):
    """Back to front: the first layer that is laid down covers all, whatever its opacity."""
    seen = rgbs[:, -1] if alphas.shape[1] else torch.zeros(len(alphas), 3)
    for i in reversed(range(alphas.shape[1] - 1)):
        seen = rgbs[:, i] * alphas[:, i, None] + seen * (1 - alphas[:, i, None])
    return seen


@convention("volume_render_alpha", {"product_eps": "1e-10"}, seen="a generative scene code with opacities", times=2)
def padded_product_with_1e_10(alphas, rgbs):
    """1e-10 in the factors."""
    product = torch.cumprod(factors(alphas, 1e-10), 1)
    return *summed(product[:, :-1] * alphas, rgbs), product[:, -1]


@convention("volume_render_alpha", {"product_eps": "1e-7"}, seen="Totoro97/NeuS models/renderer.py; nerfstudio", times=3)
def padded_product_with_1e_7(alphas, rgbs):
    """1e-7 in the factors."""
    return summed(torch.cumprod(factors(alphas, 1e-7), 1)[:, :-1] * alphas, rgbs)


@convention("volume_render_alpha", {"product_eps": "1e-8"}, seen="a splat renderer in torch (rolled and reset)")
def rolled_product_with_1e_8(alphas, rgbs):
    """1e-8 in the factors, rolled, the first set to 1."""
    shade = torch.roll(torch.cumprod(1 - alphas + 1e-8, 1), 1, 1)
    shade[:, :1] = 1
    return summed(alphas * shade, rgbs)


@fault("volume_render_alpha", "inclusive_transmittance", seen="NeuS-like plots; a splat tutorial", times=3)
def splats_shade_themselves(alphas, rgbs):
    """The product isn't moved."""
    return *summed(torch.cumprod(1 - alphas, 1) * alphas, rgbs), torch.prod(1 - alphas, 1)


@fault("volume_render_alpha", "rolled_transmittance", seen="a splat renderer in torch")
def splats_rolled(alphas, rgbs):
    """Rolled, not reset."""
    return *summed(torch.roll(torch.cumprod(1 - alphas, 1), 1, 1) * alphas, rgbs), torch.prod(1 - alphas, 1)


@fault("volume_render_alpha", "first_transmittance_zero", seen="a NeuS plot in numpy", arrays="numpy")
def nothing_reaches_the_first(alphas, rgbs):
    """Zero in front of the product."""
    front = np.concatenate([np.zeros_like(alphas[:, :1]), np.cumprod(1 - alphas, 1)], 1)[:, :-1]
    weights = front * alphas
    return (weights[..., None] * rgbs).sum(1), weights, weights.sum(1)


@fault("volume_render_alpha", "divided_by_own_factor+transmittance_before_last", seen="a 3DGS re-implementation in torch")
def divided_by_its_own_factor(alphas, rgbs):
    """The inclusive product over 1 - alpha: right but for 0 / 0 at opaque samples; what is left is T in front of the last one."""
    front = torch.cumprod(1 - alphas, 1) / (1 - alphas)
    left = front[:, -1] if alphas.shape[1] else torch.ones_like(alphas.sum(1))
    return *summed(front * alphas, rgbs), left


@fault("volume_render_alpha", "transmittance_before_last", seen="a 3DGS re-implementation in torch, without its division")
def light_left_one_sample_early(alphas, rgbs):
    """Colors are right; the light left behind the ray is T in front of the last sample."""
    product = torch.cumprod(factors(alphas), 1)
    return *summed(product[:, :-1] * alphas, rgbs), product[:, -2] if alphas.shape[1] else product[:, -1]


@fault("volume_render_alpha", "last_factor_once_more", seen="a splat renderer's final T", times=1)
def last_sample_shades_twice(alphas, rgbs):
    """The loop's T has the last sample in it already; behind the loop it is multiplied once more."""
    product = torch.cumprod(factors(alphas), 1)
    left = product[:, -1] * (1 - alphas[:, -1]) if alphas.shape[1] else product[:, -1]
    return *summed(product[:, :-1] * alphas, rgbs), left


@fault("volume_render_alpha", "opacity_as_transmittance", "opacity_in_front_as_transmittance", seen="a teaching code's fine samples", times=3)
def hidden_shows(alphas, rgbs):
    """One minus T stands for T."""
    product = torch.cumprod(factors(alphas), 1)
    return *summed((1 - product[:, :-1]) * alphas, rgbs), product[:, -1]


@fault("volume_render_alpha", "divided_by_opacity", seen="2D splat fits that normalize their weights", times=2)
def splats_normalized(alphas, rgbs):
    """Colors by weights that sum to one."""
    colors, weights, opacity = padded_product(alphas, rgbs)[:3]
    return colors / (opacity[:, None] + 1e-6), weights, opacity


@convention("volume_render_alpha", seen="graphdeco-inria/gaussian-splatting forward.cu and its ports", times=6)
def opacity_capped(alphas, rgbs):
    """alpha is cut at 0.99: nothing is ever opaque."""
    return padded_product(alphas.clamp(max=0.99), rgbs)


@convention("volume_render_alpha", seen="gsplat and ports of 3DGS", times=4)
def faint_splats_skipped(alphas, rgbs):
    """alphas below 1 / 255 are left out."""
    return padded_product(torch.where(alphas < 1 / 255, torch.zeros_like(alphas), alphas), rgbs)


@fault("volume_render_alpha", "back_to_front", seen="a splat renderer from scratch: argsort(z, descending=True)", times=2)
def farthest_first(alphas, rgbs):
    """The sum from front to back, of samples from back to front; the color, and what is left."""
    flipped = padded_product(alphas.flip(1), rgbs.flip(1))
    return flipped[0], flipped[1].flip(1), *flipped[2:]


@fault("volume_render_alpha_vjp", "shade_gradient_forgotten", seen="a splat renderer's own backward pass", arrays="numpy")
def own_weight_alone(alphas, rgbs, grad_colors, grad_weights, grad_opacity, grad_transmittance):
    """grad_alpha = T (g.c): nothing of what the sample hides."""
    front = np.cumprod(np.concatenate([np.ones_like(alphas[:, :1]), 1 - alphas], 1), 1)[:, :-1]
    value = (grad_colors[:, None] * rgbs).sum(-1) + grad_weights + grad_opacity[:, None]
    return {"grad_alphas": front * value, "grad_rgbs": (front * alphas)[..., None] * grad_colors[:, None]}


@fault(
    "volume_render_alpha_vjp",
    "product_gradient_zero_at_opaque",
    seen="nerfstudio-project/nerfacc volrend.py (its FIXME)",
    arrays="numpy",
)
def gradient_by_division(alphas, rgbs, grad_colors, grad_weights, grad_opacity, grad_transmittance):
    """The product's gradient divides by 1 - alpha, and is 0 where that is 0."""
    product = np.cumprod(np.concatenate([np.ones_like(alphas[:, :1]), 1 - alphas], 1), 1)
    front, left = product[:, :-1], product[:, -1]
    value = (grad_colors[:, None] * rgbs).sum(-1) + grad_weights + grad_opacity[:, None]
    behind = (
        np.cumsum((value * alphas * front)[:, ::-1], 1)[:, ::-1] - value * alphas * front + (left * grad_transmittance)[:, None]
    )
    rest = 1 - alphas
    hidden = np.divide(behind, rest, out=np.zeros_like(behind), where=rest != 0)
    return {"grad_alphas": front * value - hidden, "grad_rgbs": (front * alphas)[..., None] * grad_colors[:, None]}


@convention("volume_render_alpha", {"backdrop": "white"}, seen="an MIT 6.S980 student", times=1)
def splats_over_white(alphas, rgbs):
    """1 - A added to the color."""
    product = torch.cumprod(factors(alphas), 1)
    colors, weights, opacity = summed(product[:, :-1] * alphas, rgbs)
    return colors + (1 - opacity)[:, None], weights, opacity


@fault("volume_render_alpha", "eps_in_product", seen="a renderer with 1e-4 in its product")
def much_added_to_the_factors(alphas, rgbs):
    """1e-4 added to every factor."""
    product = torch.cumprod(factors(alphas, 1e-4), 1)
    return summed(product[:, :-1] * alphas, rgbs)


@fault("volume_render_alpha", "clamped", seen="splat viewers whose compositing writes the picture")
def splats_clamped(alphas, rgbs):
    """The color is clamped to [0, 1]."""
    product = torch.cumprod(factors(alphas), 1)
    colors, weights, opacity = summed(product[:, :-1] * alphas, rgbs)
    return colors.clamp(0, 1), weights, opacity


@fault("volume_render_alpha", "given_up_early", seen="shaders that march until an opacity of 0.99", times=4, arrays="numpy", gradient="none")
def marched_until_opaque(alphas, rgbs):
    """Front to back, until the opacity is 0.99."""
    colors, opacity = np.zeros((alphas.shape[0], 3), np.float32), np.zeros(alphas.shape[0], np.float32)
    for ray in range(alphas.shape[0]):
        for alpha, color in zip(alphas[ray], rgbs[ray]):
            if opacity[ray] >= 0.99:
                break
            colors[ray] += (1 - opacity[ray]) * alpha * color
            opacity[ray] += (1 - opacity[ray]) * alpha
    return {"colors": colors, "opacity": opacity}


@fault(
    "volume_render_alpha",
    "nothing_hides+light_behind_the_last_alone",
    seen="a trial on unseen code: a renderer of splats in Python",
    gradient="none",
)
def light_begins_again(alphas, rgbs):
    """T = 1 in front of each splat."""
    weights = alphas
    last = torch.ones_like(alphas[:, 0]) if alphas.shape[1] else alphas.sum(-1) + 1
    for alpha in alphas.T:
        last = torch.where(alpha > 0, 1 - alpha, last)
    return (weights[..., None] * rgbs).sum(1), weights, weights.sum(-1), last


@fault("volume_render_alpha", "given_up_together", seen="a trial on unseen code: two splat renderers in torch", times=2)
def all_rays_end_at_once(alphas, rgbs):
    """A loop over splats that ends where each ray has gathered more than 0.99."""
    light, gathered, weights = torch.ones(len(alphas)), torch.zeros(len(alphas)), []
    for i in range(alphas.shape[1]):
        weights.append(torch.zeros(len(alphas)) if (gathered > 0.99).all() else light * alphas[:, i])
        gathered, light = gathered + weights[-1], light * (1 - alphas[:, i])
    return summed(torch.stack(weights, 1) if weights else alphas * 0, rgbs)


@fault(
    "volume_render_alpha",
    "slip: another formula: T_i = prod_{1<j<=i} (1 - alpha_j)",
    seen="a trial on unseen code: 1 - alpha[1:] for 1 - alpha[:-1]",
)
def product_from_the_second(alphas, rgbs):
    """The ones stand in front, and the first opacity is left out in the place of the last."""
    light = torch.cumprod(torch.cat([torch.ones_like(alphas[:, :1]), 1 - alphas[:, 1:]], 1), 1)
    return summed(alphas * light[:, : alphas.shape[1]], rgbs)
