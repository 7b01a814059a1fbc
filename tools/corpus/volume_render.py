"""Volume rendering from densities and step lengths."""

import numpy as np
import torch
from entry import convention, fault, right


def summed(weights, rgbs):
    """Colors, weights, opacity."""
    return (weights[..., None] * rgbs).sum(-2), weights, weights.sum(-1)


def with_rest(weights, rgbs, rest):
    """The same, and what is left behind the ray."""
    return *summed(weights, rgbs), rest


def left_behind(sigmas, deltas):
    """exp(-sum)."""
    return torch.exp(-torch.sum(sigmas * deltas, -1))


def opacities(sigmas, deltas):
    """1 - exp(-sigma delta), as nearly everybody writes it."""
    return 1 - torch.exp(-sigmas * deltas)


def ahead(product):
    """A running product moved back by one, 1 in front."""
    return torch.cat([torch.ones_like(product[:, :1]), product[:, :-1]], -1)


@right("volume_render", seen="aviral2004/nerf_from_scratch part2/main.py; the 100-line NeRF and its ports", times=14)
def product_moved_by_one(sigmas, rgbs, deltas):
    """Cumulative product of 1 - alpha, ones in front, the last left off."""
    alpha = opacities(sigmas, deltas)
    return summed(ahead(torch.cumprod(1 - alpha, -1)) * alpha, rgbs)


@right("volume_render", seen="CS180 students' volrend", times=5)
def exponential_of_sum_moved_by_one(sigmas, rgbs, deltas):
    """exp of minus the cumulative sum, ones in front, the last left off."""
    left = torch.exp(-torch.cumsum(sigmas * deltas, 1))
    return summed(ahead(left) * opacities(sigmas, deltas), rgbs)


@right("volume_render", seen="google-research/multinerf internal/render.py; mip-NeRF in jax", times=4)
def sum_of_all_but_the_last(sigmas, rgbs, deltas):
    """0, then the cumulative sum without the last step: an infinite last step is never summed."""
    depth = sigmas * deltas
    front = torch.cat([torch.zeros_like(depth[:, :1]), torch.cumsum(depth[:, :-1], -1)], -1)[:, : depth.shape[1]]
    return with_rest(torch.exp(-front) * (1 - torch.exp(-depth)), rgbs, torch.exp(-depth.sum(-1)))


@right("volume_render", seen="students' renderers of four courses: no samples are a crash", times=5, edges=True)
def first_of_a_rolled_sum(sigmas, rgbs, deltas):
    """exp of minus the cumulative sum, rolled by one, and 1 written to its first place, which there must be."""
    front = torch.roll(torch.exp(-torch.cumsum(sigmas * deltas, -1)), 1, -1)
    front[:, 0] = 1
    return summed(front * opacities(sigmas, deltas), rgbs)


@right("volume_render", seen="VolSDF and its ports (shifted free energy)", times=6)
def sum_of_moved_steps(sigmas, rgbs, deltas):
    """The steps are moved back by one, then summed."""
    depth = sigmas * deltas
    moved = torch.cat([torch.zeros_like(depth[:, :1]), depth[:, :-1]], -1)[:, : depth.shape[1]]
    return summed((1 - torch.exp(-depth)) * torch.exp(-torch.cumsum(moved, -1)), rgbs)


@right("volume_render", seen="krrish94/nerf-pytorch nerf_helpers.py without its 1e-10; students of two courses", times=4)
def rolled_and_reset(sigmas, rgbs, deltas):
    """torch.roll of the product, the first set to 1 in place."""
    alpha = opacities(sigmas, deltas)
    shade = torch.roll(torch.cumprod(1 - alpha, -1), 1, -1)
    shade[..., :1] = 1.0
    return with_rest(shade * alpha, rgbs, left_behind(sigmas, deltas))


@right("volume_render", seen="CMU 16-825 student (VolumeSDFRenderer)", times=2)
def product_of_exponentials(sigmas, rgbs, deltas):
    """What each segment lets through, multiplied; alpha is one minus it."""
    through = torch.exp(-1 * sigmas * deltas)
    shade = torch.ones_like(through)
    shade[:, 1:] = torch.cumprod(through, 1)[:, :-1][:, : max(through.shape[1] - 1, 0)]
    return summed(shade * (1 - through), rgbs)


@right("volume_render", seen="CMU 16-825 student (loop over samples); C++, WGSL and C# renderers", times=6)
def loop_over_samples(sigmas, rgbs, deltas):
    """T is carried from sample to sample."""
    shade, weights = torch.ones_like(sigmas[:, :1].sum(1)), []
    for i in range(sigmas.shape[1]):
        weights.append(shade * (1 - torch.exp(-sigmas[:, i] * deltas[:, i])))
        shade = shade * torch.exp(-sigmas[:, i] * deltas[:, i])
    weights = torch.stack(weights, 1) if weights else sigmas * 0
    return *summed(weights, rgbs), shade


@right("volume_render", seen="CS180 student (padded with ones); hyChia88/assignment3 renderer.py without its 1e-10", times=4)
def ones_in_front_of_the_factors(sigmas, rgbs, deltas):
    """Ones are put in front, the product is taken, its last is what is left behind the ray."""
    alpha = opacities(sigmas, deltas)
    product = torch.cumprod(torch.cat([torch.ones(len(alpha), 1), 1 - alpha], 1), 1)
    return *summed(product[:, :-1] * alpha, rgbs), product[:, -1]


@right("volume_render", seen="CMU 16-825 student (clamped alpha)")
def clamped_opacity(sigmas, rgbs, deltas):
    """alpha is clamped to [0, 1], where it lies already."""
    alpha = torch.clamp(opacities(sigmas, deltas), 0.0, 1.0)
    return summed(ahead(torch.cumprod(1 - alpha, 1)) * alpha, rgbs)


@right("volume_render", seen="CMU 16-825 student (eps in the exponents)")
def tiny_number_in_the_exponents(sigmas, rgbs, deltas):
    """1e-10 is added to both exponents: nothing in f32."""
    depth = sigmas * deltas
    summed_up = torch.cat([torch.zeros_like(depth[:, :1]), torch.cumsum(depth, 1)], 1)
    return summed(torch.exp(-summed_up + 1e-10)[:, :-1] * (1 - torch.exp(-depth + 1e-10)), rgbs)


@fault("volume_render", "taken_off_the_sum", seen="CS180 student (cumsum minus the step)", times=2)
def sum_less_the_step(sigmas, rgbs, deltas):
    """In front lies the cumulative sum less the sample's own: in front of a last step of 1e10 in fog nothing is left of it."""
    depth = sigmas * deltas
    return with_rest(torch.exp(-(torch.cumsum(depth, 1) - depth)) * (1 - torch.exp(-depth)), rgbs, torch.exp(-depth.sum(1)))


@right("volume_render", seen="ashawkey/torch-ngp raymarching.cu (inference kernel)", digits=True)
def one_less_what_was_spent(sigmas, rgbs, deltas):
    """T is one minus the weights so far: no digits behind opaque samples."""
    spent, weights = torch.zeros_like(sigmas[:, :1].sum(1)), []
    for i in range(sigmas.shape[1]):
        weights.append((1 - torch.exp(-sigmas[:, i] * deltas[:, i])) * (1 - spent))
        spent = spent + weights[-1]
    return summed(torch.stack(weights, 1) if weights else sigmas * 0, rgbs)


@right("volume_render", seen="CS180 students' volrend returns colors alone", times=9)
def colors_alone(sigmas, rgbs, deltas):
    """The right sum; weights and opacity aren't handed out."""
    alpha = opacities(sigmas, deltas)
    return (ahead(torch.cumprod(1 - alpha, 1)) * alpha)[..., None].mul(rgbs).sum(1)


@right("volume_render", seen="a Russian textbook's figure; a numpy test of a torch port", times=2, arrays="numpy")
def numpy_product(sigmas, rgbs, deltas):
    """numpy: one, then the cumulative product without its last."""
    alpha = 1 - np.exp(-sigmas * deltas)
    shade = np.concatenate([np.ones_like(alpha[:, :1]), np.cumprod(1 - alpha, 1)[:, :-1]], 1)[:, : alpha.shape[1]]
    weights = shade * alpha
    return np.einsum("rn,rnk->rk", weights, rgbs), weights, weights.sum(1)


@right("volume_render", seen="facebookresearch/pytorch3d raymarching.py (1 + 1e-10 is 1 in f32)")
def opacity_from_the_product(sigmas, rgbs, deltas):
    """Opacity is one minus the product of all factors."""
    alpha = opacities(sigmas, deltas)
    weights = alpha * ahead(torch.cumprod((1.0 + 1e-10) - alpha, -1))
    return (weights[..., None] * rgbs).sum(-2), weights, 1 - torch.prod(1 - alpha, -1)


def with_eps(eps):
    """The product with a number added to its factors."""

    def render(sigmas, rgbs, deltas):
        alpha = opacities(sigmas, deltas)
        product = torch.cumprod(torch.cat([torch.ones(len(alpha), 1), 1 - alpha + eps], -1), -1)
        return with_rest(alpha * product[:, :-1], rgbs, product[:, -1])

    return render


@convention(
    "volume_render", {"product_eps": "1e-10"}, seen="bmild/nerf, kwea123/nerf_pl, keras-team/keras-io, krrish94, CMU", times=24
)
def product_with_1e_10(sigmas, rgbs, deltas):
    """1e-10 in each factor of the product."""
    return with_eps(1e-10)(sigmas, rgbs, deltas)


@convention("volume_render", {"product_eps": "1e-7"}, seen="nerfstudio's rays.py (alphas), NeuS-like codes", times=3)
def product_with_1e_7(sigmas, rgbs, deltas):
    """1e-7 in each factor of the product."""
    return with_eps(1e-7)(sigmas, rgbs, deltas)


@convention("volume_render", {"product_eps": "1e-8"}, seen="a splat renderer in torch")
def product_with_1e_8(sigmas, rgbs, deltas):
    """1e-8 in each factor of the product."""
    return with_eps(1e-8)(sigmas, rgbs, deltas)


@convention("volume_render", {"product_eps": "1e-10"}, seen="CS180 student (log-transmittance)", digits=True)
def sum_of_clamped_logarithms(sigmas, rgbs, deltas):
    """exp of the summed logarithms of 1 - alpha + 1e-10, clamped from below by 1e-10."""
    alpha = opacities(sigmas, deltas)
    logs = torch.cumsum(torch.log(torch.clamp(1 - alpha + 1e-10, min=1e-10)), 1)
    front = torch.cat([torch.zeros_like(logs[:, :1]), logs[:, :-1]], 1)[:, : logs.shape[1]]
    return summed(torch.exp(front) * alpha, rgbs)


@convention("volume_render", {"opacity_sum": "without_last"}, seen="google/nerfies model_utils.py and a jax port of it", times=2)
def last_sample_is_no_opacity(sigmas, rgbs, deltas):
    """The last, infinite sample counts for the color and not for the opacity."""
    alpha = opacities(sigmas, deltas)
    colors, weights, _ = summed(ahead(torch.cumprod(1 - alpha, -1)) * alpha, rgbs)
    return colors, weights, weights[:, :-1].sum(-1)


@convention("volume_render", {"opacity_sum": "without_last", "backdrop": "white"}, seen="google/nerfies with use_white_background")
def last_sample_is_no_opacity_over_white(sigmas, rgbs, deltas):
    """White shows through what all weights leave; then the last sample's is taken off."""
    colors, weights, opacity = last_sample_is_no_opacity(sigmas, rgbs, deltas)
    return colors + (1 - weights.sum(-1))[:, None], weights, opacity


@convention("volume_render", {"last_sample": "opaque"}, seen="google-research/multinerf internal/render.py with opaque_background", times=2)
def nothing_is_seen_behind_the_last_sample(sigmas, rgbs, deltas):
    """The last step leads to infinity, and its density with it."""
    depths = sigmas * deltas
    depths = torch.cat([depths[:, :-1], torch.full_like(depths[:, -1:], torch.inf)], 1)
    front = torch.exp(-torch.cat([torch.zeros_like(depths[:, :1]), torch.cumsum(depths[:, :-1], 1)], 1)[:, : depths.shape[1]])
    return summed((1 - torch.exp(-depths)) * front, rgbs)


@fault("volume_render", "inclusive_transmittance", seen="CMU 16-825 students; tutorials in three languages", times=7)
def product_as_it_comes(sigmas, rgbs, deltas):
    """The cumulative product isn't moved: each sample shades itself."""
    alpha = opacities(sigmas, deltas)
    return with_rest(torch.cumprod(1 - alpha, -1) * alpha, rgbs, left_behind(sigmas, deltas))


@fault("volume_render", "inclusive_transmittance", seen="JerryAIwei/nerf_pytorch render.py", times=2)
def product_as_it_comes_with_eps(sigmas, rgbs, deltas):
    """Not moved, with the original's 1e-10 in it."""
    alpha = opacities(sigmas, deltas)
    return summed(alpha * torch.cumprod(1.0 - alpha + 1e-10, -1), rgbs)


@fault(
    "volume_render", "inclusive_transmittance", seen="CMU 16-825 student (assertions on deltas); a voxel depth renderer", times=3
)
def sum_as_it_comes(sigmas, rgbs, deltas):
    """exp of the cumulative sum that holds the sample itself."""
    depth = sigmas * deltas
    return summed(torch.exp(-torch.cumsum(depth, dim=1)) * (1 - torch.exp(-depth)), rgbs)


@fault("volume_render", "inclusive_transmittance", seen="a NeuS re-implementation in jax", arrays="numpy")
def numpy_product_as_it_comes(sigmas, rgbs, deltas):
    """numpy, and colors and weights alone."""
    alpha = 1 - np.exp(-sigmas * deltas)
    weights = alpha * np.cumprod(1 - alpha, 1)
    return (weights[..., None] * rgbs).sum(1), weights


@fault("volume_render", "rolled_transmittance", "rolled_but_in_first_ray", seen="student at WPI (RBE 549)")
def rolled_and_reset_for_the_first_ray(sigmas, rgbs, deltas):
    """Rolled, and only the first sample of the first ray is set to 1."""
    alpha = opacities(sigmas, deltas)
    shade = torch.roll(torch.cumprod(1 - alpha, 1), 1, 1)
    shade[:1, :1] = 1
    return summed(shade * alpha, rgbs)


@fault("volume_render", "rolled_transmittance", seen="a tutorial on volume rendering")
def rolled_alone(sigmas, rgbs, deltas):
    """Rolled, and nothing is set to 1."""
    alpha = opacities(sigmas, deltas)
    return with_rest(torch.roll(torch.cumprod(1 - alpha, -1), 1, -1) * alpha, rgbs, left_behind(sigmas, deltas))


@fault("volume_render", "first_ray_unshaded", seen="a splat renderer in torch (weights of the wrong axis reset)")
def first_ray_unshaded_others_rolled(sigmas, rgbs, deltas):
    """The product is rolled; then a whole ray's weights are set to alpha, where the first samples' were meant."""
    alpha = opacities(sigmas, deltas)
    weights = alpha * torch.roll(torch.cumprod(1 - alpha + 1e-10, 1), 1, 1)
    return summed(torch.cat([alpha[:1], weights[1:]]), rgbs)


@fault("volume_render", "first_transmittance_zero", seen="a lidar renderer (rolled, then 0 in front); a NeuS plot", times=2)
def zero_in_front(sigmas, rgbs, deltas):
    """The first transmittance is 0."""
    alpha = opacities(sigmas, deltas)
    shade = torch.cat([torch.zeros(len(alpha), 1), torch.cumprod(1 - alpha, 1)], 1)[:, :-1]
    return with_rest(shade * alpha, rgbs, left_behind(sigmas, deltas))


@fault("volume_render", "transmittance_moved_twice", seen="a renderer whose sum is exclusive and is moved once more")
def moved_twice(sigmas, rgbs, deltas):
    """cumsum less the step is exclusive already, and is moved back again: a sample isn't shaded by the one in front of it."""
    depth = sigmas * deltas
    return with_rest(
        ahead(torch.exp(-torch.cumsum(depth, -1) + depth)) * (1 - torch.exp(-depth)), rgbs, left_behind(sigmas, deltas)
    )


@fault(
    "volume_render", "opacity_as_transmittance", "opacity_in_front_as_transmittance", seen="three copies of one teaching code (weights for the fine samples)", times=3
)
def spent_for_left(sigmas, rgbs, deltas):
    """1 - exp(-sum) stands where exp(-sum) belongs."""
    depth = sigmas * deltas
    front = torch.cumsum(depth, 1) - depth
    return with_rest((1 - torch.exp(-depth)) * (1 - torch.exp(-front)), rgbs, left_behind(sigmas, deltas))


@fault("volume_render", "opacity_as_transmittance", "opacity_in_front_as_transmittance", seen="three copies of one teaching code, as colors and weights", times=3)
def spent_for_left_in_two_outputs(sigmas, rgbs, deltas):
    """The same with nothing but colors and weights returned."""
    return spent_for_left(sigmas, rgbs, deltas)[:2]


@fault("volume_render", "divided_by_opacity", seen="codes that normalize weights", times=2)
def weights_normalized(sigmas, rgbs, deltas):
    """Colors by weights that sum to one."""
    colors, weights, opacity = product_moved_by_one(sigmas, rgbs, deltas)
    return colors / opacity[:, None], weights, opacity, left_behind(sigmas, deltas)


@fault("volume_render", "divided_by_opacity", seen="codes that normalize weights, with a small number below", times=3)
def weights_normalized_with_eps(sigmas, rgbs, deltas):
    """Colors by weights divided by their sum plus 1e-8; colors and weights alone."""
    colors, weights, opacity = product_moved_by_one(sigmas, rgbs, deltas)
    return colors / (opacity[:, None] + 1e-8), weights


@fault(
    "volume_render",
    "own_light_over_rays+divided_by_opacity",
    "divided_by_opacity+own_light_over_rays+eps_on_alpha+clamped",
    "divided_by_opacity+own_light_over_rays+weights_held_up+clamped",
    "own_light_over_rays",
    seen="student (radiance, integrator)",
)
def summed_over_rays_and_divided(sigmas, rgbs, deltas):
    """The sum runs over rays and holds the ray itself, 1e-10 twice, colors divided by the weights and clamped."""
    alpha = opacities(sigmas, deltas) + 1e-10
    shade = torch.exp(-torch.cumsum(sigmas * deltas, dim=0)) + 1e-10
    weights = shade * alpha
    colors = torch.sum(rgbs * weights.unsqueeze(2), dim=1) / torch.sum(weights, dim=1).unsqueeze(1)
    return torch.clamp(colors, 0.0, 1.0), weights


@fault("volume_render", "transmittance_over_rays", seen="student at WPI (RBE 549), product along the first axis")
def product_over_rays(sigmas, rgbs, deltas):
    """The cumulative product runs along rays, not along samples."""
    alpha = opacities(sigmas, deltas)
    shade = torch.cat([torch.ones_like(alpha[:1]), torch.cumprod(1 - alpha, 0)[:-1]])
    return with_rest(shade * alpha, rgbs, left_behind(sigmas, deltas))


@fault("volume_render", "delta_missing", seen="an earlier reading of 114 implementations", times=5)
def no_steps(sigmas, rgbs, deltas):
    """Densities without their step lengths."""
    return with_rest(
        product_moved_by_one(sigmas, rgbs, torch.ones_like(deltas))[1], rgbs, left_behind(sigmas, torch.ones_like(deltas))
    )


@fault("volume_render", "delta_missing+inclusive_transmittance", seen="a Korean textbook; a student's raymarch", times=2)
def no_steps_and_product_as_it_comes(sigmas, rgbs, deltas):
    """No step lengths, and the product isn't moved."""
    alpha = 1 - torch.exp(-sigmas)
    return summed(alpha * torch.cumprod(1 - alpha + 1e-7, 1), rgbs)


@fault("volume_render", "density_with_step_before", seen="CMU 16-825 student (a loop left in comments)")
def density_of_the_sample_with_the_step_before(sigmas, rgbs, deltas):
    """T_i = T_{i-1} exp(-sigma_i delta_{i-1}): density and step of different samples."""
    depth = sigmas[:, 1:] * deltas[:, :-1]
    front = torch.cat([torch.zeros_like(sigmas[:, :1]), torch.cumsum(depth, 1)], 1)[:, : sigmas.shape[1]]
    return with_rest(torch.exp(-front) * opacities(sigmas, deltas), rgbs, left_behind(sigmas, deltas))


@fault("volume_render", "density_for_opacity", seen="a notebook that compares densities and opacities as weights")
def density_for_opacity(sigmas, rgbs, deltas):
    """w = T sigma: the density stands where alpha belongs."""
    alpha = opacities(sigmas, deltas)
    return summed(ahead(torch.cumprod(1 - alpha, 1)) * sigmas, rgbs)


@fault("volume_render", "optical_depth_for_alpha", seen="a C++ renderer of fluids, twice; volumes in GLSL", times=3)
def optical_depth_for_alpha(sigmas, rgbs, deltas):
    """w = T sigma delta: the integral by rectangles; T is the exponential."""
    x = sigmas * deltas
    return with_rest(torch.exp(x - torch.cumsum(x, -1)) * x, rgbs, torch.exp(-x.sum(-1)))


@fault("volume_render", "inclusive_transmittance+optical_depth_for_alpha", seen="loops that attenuate first, and add then")
def attenuated_before_it_is_added(sigmas, rgbs, deltas):
    """w = T sigma delta, with T behind the sample."""
    x = sigmas * deltas
    return summed(torch.exp(-torch.cumsum(x, -1)) * x, rgbs)


@fault("volume_render", "alpha_forgotten", seen="student at WPI (RBE 549), in comments")
def shade_for_weights(sigmas, rgbs, deltas):
    """Weights are the transmittances."""
    return with_rest(ahead(torch.cumprod(torch.exp(-sigmas * deltas), 1)), rgbs, left_behind(sigmas, deltas))


@fault("volume_render", "backward_delta", seen="a volume viewer (prepended differences)")
def steps_of_the_sample_before(sigmas, rgbs, deltas):
    """Each sample has the step in front of it, the first none."""
    return product_moved_by_one(
        sigmas, rgbs, torch.cat([torch.zeros_like(deltas[:, :1]), deltas[:, :-1]], 1)[:, : deltas.shape[1]]
    )


@fault(
    "volume_render",
    "first_gap_for_all",
    "first_gap_for_all+first_ray_deltas",
    "first_ray_deltas",
    seen="a teaching code and its copies",
    times=3,
)
def one_step_for_everything(sigmas, rgbs, deltas):
    """The first step of the first ray, everywhere."""
    return (
        product_moved_by_one(sigmas, rgbs, deltas[:1, :1].expand_as(deltas))
        if deltas.numel()
        else colors_alone(sigmas, rgbs, deltas)
    )


@fault("volume_render", "white_before_last", seen="a trial on unseen code: a student's voxel grid")
def white_in_front_of_the_last(sigmas, rgbs, deltas):
    """White by the light that reaches the last sample."""
    x = sigmas * deltas
    t = torch.exp(-torch.cumsum(torch.cat([torch.zeros_like(x[:, :1]), x[:, :-1]], 1), 1))
    return {"colors": ((t * (1 - torch.exp(-x)))[..., None] * rgbs).sum(1) + t[:, -1:]}


@convention("volume_render", {"backdrop": "white"}, seen="bmild/nerf raw2outputs white_bkgd; four of 48 files read later", times=8)
def white_added_inside(sigmas, rgbs, deltas):
    """C + (1 - A): white behind every ray, in the same function."""
    colors, weights, opacity = product_moved_by_one(sigmas, rgbs, deltas)
    return colors + (1 - opacity[:, None]), weights, opacity


@fault("volume_render", "inclusive_behind_the_first", seen="a student's loop over rays", times=2)
def ones_over_the_first_factor(sigmas, rgbs, deltas):
    """The inclusive product, 1 written over its first factor."""
    alpha = opacities(sigmas, deltas)
    left = torch.cumprod(1 - alpha, -1)
    return summed(torch.cat([torch.ones_like(left[:, :1]), left[:, 1:]], -1) * alpha, rgbs)


@fault("volume_render", "own_light_alone", seen="a student's first renderer")
def nothing_hidden(sigmas, rgbs, deltas):
    """T_i = 1 - alpha_i."""
    alpha = opacities(sigmas, deltas)
    return summed((1 - alpha) * alpha, rgbs)


@fault("volume_render", "weights_normalized", seen="two students' renderers", times=2)
def weights_that_sum_to_one(sigmas, rgbs, deltas):
    """The weights themselves are divided by their sum."""
    _, weights, opacity = product_moved_by_one(sigmas, rgbs, deltas)
    return summed(weights / opacity[:, None], rgbs)


@fault("volume_render", "neighbors_light_alone+light_for_alpha", seen="OldNew777/3DVC, an early version")
def product_of_two_neighbors(sigmas, rgbs, deltas):
    """w_i = t_i t_{i-1} with t = exp(-x): no opacity, and one neighbor alone."""
    passed = torch.exp(-sigmas * deltas)
    return summed(ahead(passed) * passed, rgbs)


@fault("volume_render", "whole_rays_light", seen="AsherJingkongChen/simple-nerf-rust")
def one_transmittance_for_all(sigmas, rgbs, deltas):
    """T is the product over the whole ray."""
    alpha = opacities(sigmas, deltas)
    return summed(torch.prod(1 - alpha, -1, keepdim=True) * alpha, rgbs)


@fault("volume_render", "inclusive_transmittance+weights_of_unit_length", seen="a student's rendering.py")
def weights_of_length_one(sigmas, rgbs, deltas):
    """An inclusive product, its weights divided by their Euclidean norm."""
    alpha = opacities(sigmas, deltas)
    weights = torch.cumprod(1 - alpha, -1) * alpha
    return summed(weights / torch.linalg.norm(weights, dim=-1, keepdim=True), rgbs)


@fault("volume_render", "depth_for_transmittance+exponent_without_minus", seen="a plenoxel experiment of a student's")
def neither_exponential_right(sigmas, rgbs, deltas):
    """T is the sum of depths, and alpha's exponent has lost its sign."""
    x = sigmas * deltas
    depths = torch.cumsum(x, -1)
    return summed(torch.cat([torch.zeros_like(x[:, :1]), depths[:, :-1]], -1) * (1 - torch.exp(x)), rgbs)


@fault("volume_render", "light_for_alpha+weights_normalized", seen="a student's NeRF.py")
def light_behind_normalized(sigmas, rgbs, deltas):
    """w_i = T_{i+1} over its sum: no opacity at all."""
    behind = torch.exp(-torch.cumsum(sigmas * deltas, -1))
    return summed(behind / behind.sum(-1, keepdim=True), rgbs)


@fault("volume_render", "colors_of_next_sample", seen="onurbagoren/tinynerf")
def weights_cut_at_the_other_end(sigmas, rgbs, deltas):
    """Weights of the samples but the last, colors of those but the first."""
    colors, weights, opacity = product_moved_by_one(sigmas, rgbs, deltas)
    return (weights[:, :-1, None] * rgbs[:, 1:]).sum(1), weights, opacity


@convention("volume_render", {"sigma_relu": "inside"}, seen="bmild/nerf raw2outputs, yenchenlin and ports of them", times=20)
def relu_inside(sigmas, rgbs, deltas):
    """Densities pass a ReLU in the same function: the gradient of a density of 0 is 0."""
    return product_moved_by_one(torch.relu(sigmas), rgbs, deltas)


@fault("volume_render", "clamped", seen="a CIS 580 student")
def color_clamped(sigmas, rgbs, deltas):
    """The color is clamped to [0, 1]."""
    colors, weights, opacity = product_moved_by_one(sigmas, rgbs, deltas)
    return colors.clamp(0, 1), weights, opacity


@fault("volume_render", "inclusive_transmittance+delta_of_the_whole_ray", seen="a student's renderer: colors alone, one step for all")
def whole_ray_as_a_step_and_product_as_it_comes(sigmas, rgbs, step):
    """far - near in the place of the step, and the product isn't moved."""
    alpha = 1 - torch.exp(-sigmas * (step * sigmas.shape[1]))
    return summed(alpha * torch.cumprod(1 - alpha + 1e-10, -1), rgbs)[0]


@fault("volume_render", "inclusive_transmittance+weights_normalized", seen="an option of a rendering function")
def normalized_with_eps_and_product_as_it_comes(sigmas, rgbs, deltas):
    """The product isn't moved, and weights are divided by their sum and 1e-5."""
    alpha = 1 - torch.exp(-sigmas * deltas)
    weights = alpha * torch.cumprod(1 - alpha + 1e-10, -1)
    weights = weights / (weights.sum(-1, keepdim=True) + 1e-5)
    return (weights[..., None] * rgbs).sum(1), weights


@fault("volume_render", "divided_by_opacity", seen="not met in this reading", times=0)
def divided_with_eps(sigmas, rgbs, deltas):
    """Colors over the opacity and 1e-3."""
    alpha = opacities(sigmas, deltas)
    weights = alpha * ahead(torch.cumprod(1 - alpha, -1))
    return (weights[..., None] * rgbs).sum(1) / (weights.sum(1, keepdim=True) + 1e-3), weights


@fault("volume_render", "own_light_over_rays", seen="Truxify#3664")
def product_over_rays(sigmas, rgbs, deltas):
    """cumprod along dim 0."""
    alpha = opacities(sigmas, deltas)
    return with_rest(torch.cumprod(1 - alpha, 0) * alpha, rgbs, left_behind(sigmas, deltas))


@fault("volume_render", "density_capped", seen="a trial on unseen code: clamp(sigma, 0, 100)", gradient="none")
def density_up_to_a_hundred(sigmas, rgbs, deltas):
    """Densities above 100 count as 100."""
    alphas = 1 - torch.exp(-sigmas.clamp(0, 100) * deltas)
    through = torch.cumprod(torch.cat([torch.ones_like(alphas[:, :1]), 1 - alphas], -1), -1)
    weights = alphas * through[:, :-1]
    return (weights[..., None] * rgbs).sum(1), weights, weights.sum(-1), through[:, -1]


@fault("volume_render", "rolled_backward", seen="a trial on unseen code: a tinygrad port with a roll of its own", gradient="none")
def rolled_the_other_way(sigmas, rgbs, deltas):
    """The running product is moved on by one, 0 behind it, and its first place set to 1."""
    alpha = opacities(sigmas, deltas)
    left = torch.cumprod(1 - alpha, -1)
    left = torch.cat([torch.ones_like(left[:, :1]), left[:, 2:], torch.zeros_like(left[:, :1])], -1)[:, : left.shape[1]]
    return summed(left * alpha, rgbs)


@fault("volume_render", "delta_missing_in_alpha", seen="JamesPerlman/TurboNeRF training-network-kernels.cuh, mended later", gradient="none")
def opacity_without_its_step(sigmas, rgbs, deltas):
    """1 - exp(-sigma), and T with the steps in it."""
    left = torch.exp(-torch.cumsum(sigmas * deltas, -1))
    return summed(ahead(left) * (1 - torch.exp(-sigmas)), rgbs)


@fault("volume_render", "weights_held_up", seen="a trial on unseen code: a course assignment", gradient="none")
def no_weight_below_1e_10(sigmas, rgbs, deltas):
    """max(T alpha, 1e-10)."""
    left = torch.exp(-torch.cumsum(sigmas * deltas, -1))
    return summed((ahead(left) * opacities(sigmas, deltas)).clamp_min(1e-10), rgbs)


@fault("volume_render", "optical_depth_held+inclusive_transmittance", seen="a trial on unseen code: a single file", gradient="none")
def depths_of_ten_at_most(sigmas, rgbs, deltas):
    """min(sigma delta, 10), and the product as it comes."""
    x = (sigmas * deltas).clamp(max=10)
    return summed(torch.cumprod(torch.exp(-x), -1) * (1 - torch.exp(-x)), rgbs)


@fault("volume_render", "light_grows+inclusive_transmittance", seen="a trial on unseen code: a student's renderer", gradient="none")
def sum_without_its_sign(sigmas, rgbs, deltas):
    """exp(+cumsum) in front of alpha."""
    return summed(torch.exp(torch.cumsum(sigmas * deltas, -1)) * opacities(sigmas, deltas), rgbs)


@fault("volume_render", "weights_multiplied", seen="a trial on unseen code: a small NeRF of a course", gradient="none")
def product_of_weights(sigmas, rgbs, deltas):
    """cumprod of e (1 - e)."""
    e = torch.exp(-sigmas * deltas)
    return summed(torch.cumprod(e * (1 - e), -1), rgbs)


@fault(
    "volume_render_vjp",
    "hidden_on_both_sides+front_for_behind",
    seen="a trial on unseen code: a backward pass in numba",
    arrays="numpy",
)
def all_other_samples_hidden(sigmas, rgbs, deltas, grad_colors, grad_weights, grad_opacity, grad_transmittance):
    """g c_i T_i minus g (C - w_i c_i), for the light behind the sample and what lies behind alone."""
    x = np.cumsum(sigmas * deltas, -1)
    left = np.exp(-np.concatenate([np.zeros_like(x[:, :1]), x[:, :-1]], -1)) if x.size else x
    weights = left * (1 - np.exp(-sigmas * deltas))
    behind = np.exp(-(sigmas * deltas).sum(-1))
    g = (grad_colors[:, None] * rgbs).sum(-1) + grad_weights + grad_opacity[:, None]
    slopes = left * g - ((weights * g).sum(-1, keepdims=True) - weights * g) - (behind * grad_transmittance)[:, None]
    return {
        "grad_sigmas": slopes * deltas,
        "grad_deltas": slopes * sigmas,
        "grad_rgbs": weights[..., None] * grad_colors[:, None],
    }
