"""Splats as renderers of their own draw them: cuts, caps, dilations and colors with other numbers."""

import numpy as np
import torch
from entry import convention, fault
from gaussians import around_the_picture, as_the_rasterizer_colors, colored_with_signs, drawn, exponent, in_camera, jacobian


def long_deviation(conics):
    """The deviation along the long axis of the covariances."""
    covariances = torch.linalg.inv(torch.stack([conics[:, 0], conics[:, 1], conics[:, 1], conics[:, 2]], -1).view(-1, 2, 2))
    return torch.linalg.eigvalsh(covariances)[:, 1].sqrt()


def seen(power, opacities, cap):
    """Capped, and left out where it is faint or grows."""
    alpha = (opacities * torch.exp(power)).clamp(max=cap)
    return torch.where((power > 0) | (alpha < 1 / 255), torch.zeros_like(alpha), alpha)


@fault("gaussian_alpha", "cut_at_a_square", seen="a trial on unseen code: a wgpu rasterizer", gradient="none")
def within_the_square(pixels, means2d, conics, opacities):
    """Nothing outside of ceil(3 sigma) to either side; up to 0.99, faint ones skipped."""
    reach = torch.ceil(3 * long_deviation(conics))
    outside = (pixels[:, None] - means2d[None]).abs().amax(-1) > reach
    return torch.where(outside, 0.0, seen(exponent(pixels, means2d, conics), opacities, 0.99))


@fault("gaussian_alpha", "cut_at_a_radius", seen="a trial on unseen code: a rasterizer in WGSL, by tiles", gradient="none")
def within_the_circle(pixels, means2d, conics, opacities):
    """Nothing further off than the radius that finds the tiles; up to 0.99, faint ones skipped."""
    reach = torch.ceil(3 * long_deviation(conics))
    far = torch.linalg.vector_norm(pixels[:, None] - means2d[None], dim=-1) > reach
    return torch.where(far, 0.0, seen(exponent(pixels, means2d, conics), opacities, 0.99))


@fault("gaussian_alpha", "covariance_dilated_again", seen="a trial on unseen code: a renderer in Python, 1e-4", gradient="none")
def dilated_where_it_is_inverted(pixels, means2d, conics, opacities):
    """1e-4 on the diagonal of the covariance before its inverse is taken; up to 0.99."""
    pairs = torch.stack([conics[:, 0], conics[:, 1], conics[:, 1], conics[:, 2]], -1).view(-1, 2, 2).double()
    wider = torch.linalg.inv(torch.linalg.inv(pairs) + 1e-4 * torch.eye(2).double())
    d = (pixels[:, None] - means2d[None]).double()
    power = -0.5 * (d[:, :, None] @ wider @ d[..., None])[..., 0, 0]
    return (opacities * torch.exp(power)).float().clamp(max=0.99)


@fault("gaussian_alpha", "cut_at_three_sigmas", seen="a trial on unseen code: a fragment shader in Metal", gradient="none")
def shader_to_three_sigmas(pixels, means2d, conics, opacities):
    """Discarded where the power is below -4.5 or above 0, and below 1/255; no cap."""
    power = exponent(pixels, means2d, conics)
    return torch.where(power < -4.5, 0.0, seen(power, opacities, torch.inf))


@fault(
    "gaussian_alpha",
    "conic_in_another_order+cut_at_a_radius",
    seen="a trial on unseen code: a Vulkan rasterizer, two sigmas",
    gradient="none",
)
def conic_with_its_cross_term_last(pixels, means2d, conics, opacities):
    """(A, B, C) read as (A, C, B), and nothing outside of two deviations."""
    reach = torch.ceil(2 * long_deviation(conics))
    far = torch.linalg.vector_norm(pixels[:, None] - means2d[None], dim=-1) > reach
    return torch.where(far, 0.0, seen(exponent(pixels, means2d, conics[:, [0, 2, 1]]), opacities, 0.99))


@fault("gaussian_alpha", "cut_below_an_opacity", seen="a trial on unseen code: a WGSL shader, 0.02", gradient="none")
def nothing_below_a_fiftieth(pixels, means2d, conics, opacities):
    """0 where alpha is below 0.02; no cap."""
    alpha = opacities * torch.exp(exponent(pixels, means2d, conics))
    return torch.where(alpha < 0.02, torch.zeros_like(alpha), alpha)


@fault("gaussian_alpha", "exponent_scaled", seen="a trial on unseen code, without its cut: a WebGPU viewer", gradient="none")
def an_eighth_of_the_exponent(pixels, means2d, conics, opacities):
    """exp(-q / 16) where exp(-q / 2) belongs."""
    return opacities * torch.exp(exponent(pixels, means2d, conics) / 8)


@fault("gaussian_alpha", "capped_elsewhere", seen="a trial on unseen code: a renderer on CPUs", gradient="none")
def capped_at_995(pixels, means2d, conics, opacities):
    """0.995 at most."""
    return (opacities * torch.exp(exponent(pixels, means2d, conics))).clamp(max=0.995)


def flat(means, covariances, w2c, k, width, height):
    """Means, depths and undilated covariances in the picture, with gsplat's limits."""
    t, sigma = in_camera(means, covariances, w2c)
    low, high = around_the_picture(k, width, height)
    slopes = t[:, :2] / t[:, 2:]
    j = jacobian(torch.minimum(torch.maximum(slopes, low), high), t[:, 2], k)
    return (t @ k.mT)[:, :2] / t[:, 2:], t[:, 2], j @ sigma @ j.mT


def three(cov):
    """(a, b, c)."""
    return torch.stack([cov[:, 0, 0], cov[:, 0, 1], cov[:, 1, 1]], -1)


@fault("gaussian_projection", "compensation_held", seen="a trial on unseen code: a renderer in Metal", gradient="none")
def a_quarter_at_least(means, covariances, w2c, K, width, height):
    """The compensation is sqrt(max(0.0625, det / det'))."""
    middle, depths, cov = flat(means, covariances, w2c, K, width, height)
    wide = cov + 0.3 * torch.eye(2)
    ratio = torch.linalg.det(cov) / torch.linalg.det(wide)
    return {"means2d": middle, "depths": depths, "covariances2d": three(wide), "compensations": ratio.clamp(min=0.0625).sqrt()}


@fault("gaussian_projection", "compensation_of_flat_ones", seen="a trial on unseen code: a renderer in WebGPU", gradient="none")
def full_light_for_lines(means, covariances, w2c, K, width, height):
    """Not compensated where the determinant isn't positive."""
    middle, depths, cov = flat(means, covariances, w2c, K, width, height)
    cov = cov.double()
    before, after = torch.linalg.det(cov), torch.linalg.det(cov + 0.3 * torch.eye(2))
    rounded = before.abs() < 1e-6 * after.abs()
    ratio = torch.where(rounded, 1.0, before / after).sqrt().float()
    return {"means2d": middle, "depths": depths, "compensations": ratio}


@fault("gaussian_projection", "radius_held", seen="a trial on unseen code: a renderer in Metal", gradient="none")
def never_beyond_512(means, covariances, w2c, K, width, height):
    """min(ceil(3 sigma), 512), of slopes without limits."""
    t, sigma = in_camera(means, covariances, w2c)
    j = jacobian(t[:, :2] / t[:, 2:], t[:, 2], K)
    depths, cov = t[:, 2], j @ sigma @ j.mT
    a, b, c = three(cov + 0.3 * torch.eye(2)).unbind(-1)
    mid = (a + c) / 2
    radii = torch.ceil(3 * torch.sqrt(mid + torch.sqrt(torch.clamp(mid * mid - (a * c - b * b), min=0.1))))
    return {"depths": depths, "radii": radii.clamp(max=512.0)}


@fault("gaussian_projection", "dilated_by_another_number", seen="a trial on unseen code: a trainer in C#, with 1e-6", gradient="none")
def next_to_no_dilation(means, covariances, w2c, K, width, height):
    """A thousandth on the diagonal."""
    middle, depths, cov = flat(means, covariances, w2c, K, width, height)
    return {"means2d": middle, "depths": depths, "covariances2d": three(cov + 1e-3 * torch.eye(2))}


@fault("gaussian_color", "second_band_left_out", seen="a trial on unseen code: a renderer in Metal", times=2)
def two_bands(means, camera_center, coefficients):
    """Bands 0 and 1, whatever there is."""
    return as_the_rasterizer_colors(means, camera_center, coefficients[:, :4])


def blended(alphas, rgbs):
    """Weights and the light that is left: up to 0.99, faint ones skipped, ended in front of what leaves less than 1e-4."""
    weights, left = np.zeros_like(alphas), np.ones(len(alphas), np.float32)
    for ray, row in enumerate(np.minimum(alphas, np.float32(0.99))):
        for k in np.flatnonzero(row >= np.float32(1 / 255)):
            if left[ray] * (1 - row[k]) < np.float32(1e-4):
                break
            weights[ray, k] = left[ray] * row[k]
            left[ray] *= 1 - row[k]
    return weights, left


@convention(
    "volume_render_alpha_vjp",
    {"cap_gradient": "through"},
    seen="graphdeco-inria/diff-gaussian-rasterization backward.cu; a port in Slang",
    times=2,
    digits=True,
    arrays="numpy",
)
def through_the_cap(alphas, rgbs, grad_colors):
    """From behind, by division; the gradient passes through min(0.99, alpha) as it is."""
    grad_alphas, grad_rgbs = np.zeros_like(alphas), np.zeros_like(rgbs)
    weights, left = blended(alphas, rgbs)
    for ray, row in enumerate(np.minimum(alphas, np.float32(0.99))):
        light, behind = left[ray], np.zeros(3, np.float32)
        for k in reversed(np.flatnonzero(weights[ray])):
            light = light / (1 - row[k])
            grad_rgbs[ray, k] = row[k] * light * grad_colors[ray]
            grad_alphas[ray, k] = light * ((rgbs[ray, k] - behind) * grad_colors[ray]).sum()
            behind = row[k] * rgbs[ray, k] + (1 - row[k]) * behind
    return {"grad_alphas": grad_alphas, "grad_rgbs": grad_rgbs}


def backward_by_hand(alphas, rgbs, grad_colors, least, late=False, sign=1):
    """From behind, by division; of the samples that are used while more light than `least` is left."""
    grad_alphas, grad_rgbs = np.zeros_like(alphas), np.zeros_like(rgbs)
    for ray, row in enumerate(alphas):
        light, used = np.float32(1), []
        for k, alpha in enumerate(row):
            if light < least:
                break
            used.append(k)
            light *= 1 - alpha
        behind, kept = np.float32(0), np.float32(0)
        for k in reversed(used):
            in_front = np.float32(np.prod(1 - row[:k], dtype=np.float32))
            q = np.float32((rgbs[ray, k] * grad_colors[ray]).sum())
            grad_rgbs[ray, k] = row[k] * in_front * grad_colors[ray]
            grad_alphas[ray, k] = in_front * (q - (kept if late else behind))
            if row[k] > 0:
                kept = behind
                behind = sign * row[k] * q + (1 - row[k]) * behind
    return {"grad_alphas": grad_alphas, "grad_rgbs": grad_rgbs}


@fault(
    "volume_render_alpha_vjp",
    "hidden_one_late",
    seen="a trial on unseen code: a port of the rasterizer to Warp",
    arrays="numpy",
)
def accumulated_after_its_use(alphas, rgbs, grad_colors):
    """What lies behind a sample is known one sample too late."""
    return backward_by_hand(alphas, rgbs, grad_colors, 0, late=True)


@fault(
    "volume_render_alpha_vjp",
    "hidden_added+stopped_behind_the_sample",
    "slip: another formula: the gradient of alpha_i loses -S_i / (1 - alpha_i), S_i = sum_{j>i} w_j q_j, and an end in front of a sample where T < 1e-3",
    seen="a trial on unseen code: a splat renderer in Crystal",
    arrays="numpy",
)
def taken_off_to_a_thousandth(alphas, rgbs, grad_colors):
    """The sum over what lies behind has the other sign, and the march back has the forward march's end."""
    return backward_by_hand(alphas, rgbs, grad_colors, np.float32(1e-3), sign=-1)


@fault("gaussian_alpha", "faint_opacity_skipped", seen="a trial on unseen code: a renderer in Python", gradient="none")
def faint_splats_left_out(pixels, means2d, conics, opacities):
    """0 where the opacity is below 1 / 255."""
    alpha = opacities * torch.exp(exponent(pixels, means2d, conics))
    return torch.where((opacities < 1 / 255).expand(alpha.shape), torch.zeros_like(alpha), alpha)


@fault(
    "volume_render_alpha_vjp",
    "light_recovered_by_division",
    "divided_by_own_factor",
    seen="a trial on unseen code: a check of a kernel",
    arrays="numpy",
)
def light_by_division(alphas, rgbs, grad_colors):
    """T / (1 - alpha) from behind: 0 / 0 where something is opaque."""
    grad_alphas, grad_rgbs = np.zeros_like(alphas), np.zeros_like(rgbs)
    for ray, row in enumerate(alphas):
        light, behind = np.prod(1 - row, dtype=np.float32), np.zeros(3, np.float32)
        for k in reversed(range(len(row))):
            with np.errstate(all="ignore"):
                light = np.float32(light) / np.float32(1 - row[k])
            grad_rgbs[ray, k] = row[k] * light * grad_colors[ray]
            grad_alphas[ray, k] = light * ((rgbs[ray, k] - behind) * grad_colors[ray]).sum()
            behind = row[k] * rgbs[ray, k] + (1 - row[k]) * behind
    return {"grad_alphas": grad_alphas, "grad_rgbs": grad_rgbs}


@fault(
    "volume_render_alpha_vjp",
    "thin_samples_learn_nothing+stopped_behind_the_sample",
    seen="a trial on unseen code: two kernels in Rust",
    times=2,
    arrays="numpy",
)
def empty_splats_left_alone(alphas, rgbs, grad_colors):
    """Splats of alpha below 1e-6 are passed over on the way back; a ray ends where 1e-4 is left."""
    out = backward_by_hand(alphas, rgbs, grad_colors, np.float32(1e-4))
    thin = alphas < 1e-6
    return {"grad_alphas": np.where(thin, 0, out["grad_alphas"]), "grad_rgbs": np.where(thin[..., None], 0, out["grad_rgbs"])}


@fault("gaussian_projection", "mean_in_the_camera", seen="a trial on unseen code: a renderer in torch", gradient="none")
def means_as_they_are(means, covariances, w2c, K, width, height):
    """x and y in the camera for the pixel."""
    _, depths, cov = flat(means, covariances, w2c, K, width, height)
    return drawn(in_camera(means, covariances, w2c)[0][:, :2], cov, depths, 0.1)


@fault(
    "gaussian_color",
    "slip: another formula: the other sign of harmonic 4, and the other sign of harmonic 5, and the other sign of harmonic 7",
    seen="a trial on unseen code: - xy, + yz, + xz",
)
def second_band_the_other_way_round(means, camera_center, coefficients):
    """The rasterizer's harmonics but for the signs of xy, yz and xz."""
    return colored_with_signs([1, 1, 1, 1, -1, -1, 1, -1], means, camera_center, coefficients)


@fault(
    "gaussian_alpha",
    "slip: another formula: 0 outside of the box of whole pixels about the square of three deviations of its long axis",
    "cut_at_a_square",
    seen="a trial on unseen code: splats in torch, box by box",
    gradient="none",
)
def box_of_whole_pixels(pixels, means2d, conics, opacities):
    """From floor(mean - 3 sigma) to ceil(mean + 3 sigma); no cap."""
    reach = 3 * long_deviation(conics)[:, None]
    low, high = torch.floor(means2d - reach), torch.ceil(means2d + reach)
    inside = ((pixels[:, None] >= low) & (pixels[:, None] <= high)).all(-1)
    return torch.where(inside, opacities * torch.exp(exponent(pixels, means2d, conics)), 0.0)


@fault("gaussian_alpha", "middle_skipped", seen="a trial on unseen code: splats for a course", gradient="none")
def hole_in_the_middle(pixels, means2d, conics, opacities):
    """exp(power) >= 1 becomes 0; up to 0.99, faint ones skipped."""
    power = exponent(pixels, means2d, conics)
    return torch.where(torch.exp(power) >= 1, 0.0, seen(power, opacities, 0.99))
