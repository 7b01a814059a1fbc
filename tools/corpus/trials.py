"""What the last trials on unseen code met: rotations, colors on screens, clips, splats of one degree, powers of 2."""

import numpy as np
import torch
import torch.nn.functional as F
from entry import fault, right
from gaussians import basis, exponent
from schedules import delayed
from volume_render import ahead, summed


@right("so3_exp", digits=True, arrays="numpy", seen="batch_rodrigues of body models; rigid motions of robots in numpy", times=4)
def rodrigues_with_one_less_cos(w):
    """cos I + (1 - cos) u u^T + sin [u]_x, 1 - cos as it stands: nothing is left of it at angles of millionths. I at 0."""
    theta = np.linalg.norm(w, axis=-1)[:, None, None]
    u = np.divide(w, theta[:, 0], out=np.zeros_like(w), where=theta[:, 0] > 0)
    zero = np.zeros_like(u[:, 0])
    cross = np.stack([zero, -u[:, 2], u[:, 1], u[:, 2], zero, -u[:, 0], -u[:, 1], u[:, 0], zero], -1).reshape(-1, 3, 3)
    return np.cos(theta) * np.eye(3, dtype=w.dtype) + (1 - np.cos(theta)) * u[:, :, None] * u[:, None] + np.sin(theta) * cross


@right("linear_to_srgb", seen="image utilities in torch", times=3, gradient=("not_a_number_at_black",))
def either_piece(linear):
    """Both pieces, one of them chosen: the power's slope at 0 is infinite, times 0."""
    return torch.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


@fault("linear_to_srgb", "slip: another formula: k = 1 / 2.2, and srgb = s clamped to [0, 1]", seen="renderers in C++ and torch", times=2)
def gamma_of_screens(linear):
    """1 / 2.2 for 1 / 2.4, and nothing beyond 1."""
    return torch.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear.clamp(min=1e-12) ** (1 / 2.2) - 0.055).clamp(0, 1)


@fault(
    "linear_to_srgb",
    "slip: another formula: the straight piece below, in place: then the power of all that is above by then",
    arrays="numpy",
    seen="tools for raw pictures and renderings in numpy",
    times=2,
)
def below_first_in_place(linear):
    """Dark numbers are multiplied in place; those that are above the threshold by then are taken to the power, too."""
    x = linear.copy()
    x[x <= 0.0031308] *= 12.92
    above = x > 0.0031308
    x[above] = 1.055 * x[above] ** (1 / 2.4) - 0.055
    return x


@fault(
    "clip_by_global_norm",
    "slip: another formula: g' = g min(max_norm, max_norm / norm)",
    seen="training utilities in JAX",
)
def at_most_max_norm_times(g_weights, g_bias, max_norm):
    """The factor is held below max_norm, not below 1."""
    norm = torch.linalg.vector_norm(torch.stack([torch.linalg.vector_norm(g) for g in (g_weights, g_bias)]))
    factor = torch.clamp(max_norm / (norm + 1e-6), max=max_norm)
    return g_weights * factor, g_bias * factor, norm


@fault("lr_log_linear", "slip: another formula: lr = 0 at step 0", seen="a splat trainer in Rust")
def nothing_at_step_0(step, max_steps, lr_init, lr_final, delay_steps, delay_mult):
    """0 where step is 0: the rasterizers' function asks whether it is below."""
    t = min(max(step / max_steps, 0.0), 1.0)
    rate = np.exp(np.log(lr_init) * (1 - t) + np.log(lr_final) * t)
    return 0.0 if step == 0 else delayed(step, delay_steps, delay_mult) * rate


@fault(
    "volume_render",
    "slip: another formula: sigma_i ln 2, as powers of 2 have it, for sigma_i",
    seen="a kernel in PTX, whose exponential is that of 2",
)
def powers_of_two(sigmas, rgbs, deltas):
    """2^x for e^x."""
    kept = torch.exp2(-sigmas * deltas)
    return summed(ahead(torch.cumprod(kept, -1)) * (1 - kept), rgbs)


@right("gaussian_color", seen="a renderer in Metal, which keeps four coefficients a channel")
def linear_alone(means, camera_center, coefficients):
    """Degree 1; it can't take another."""
    if coefficients.shape[1] != 4:
        raise ValueError("four coefficients")
    u = F.normalize(means - camera_center, dim=-1)
    return torch.clamp_min((basis(u, 4)[..., None] * coefficients).sum(1) + 0.5, 0.0)


@right("gaussian_alpha", seen="viewers in WGSL and TypeScript: pixel after pixel of each splat", times=3, gradient="none")
def splats_by_pixels(pixels, means2d, conics, opacities):
    """A row for each splat."""
    return (opacities * torch.exp(exponent(pixels, means2d, conics))).T


@fault("gaussian_alpha", "cross_term_sign", seen="a viewer in Unity", gradient="none")
def splats_by_pixels_mirrored(pixels, means2d, conics, opacities):
    """A row for each splat, and the other sign of 2 B dx dy."""
    mirrored = conics * torch.tensor([1.0, -1.0, 1.0], dtype=conics.dtype)
    return (opacities * torch.exp(exponent(pixels, means2d, mirrored))).T
