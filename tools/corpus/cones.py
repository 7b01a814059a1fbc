"""Frustums as Gaussians, and their encoding."""

import torch
from entry import convention, fault, right


def lifted(origins, directions, t_mean, t_variance, r_variance):
    """Along the ray and across it."""
    outer = directions**2
    length = outer.sum(-1, keepdim=True).clamp(min=1e-10)
    means = origins + t_mean[:, None] * directions
    return means, t_variance[:, None] * outer + r_variance[:, None] * (1 - outer / length)


@right("conical_frustum", seen="google/mipnerf internal/mip.py, stable; nerfstudio", digits=True)
def middle_and_half_width(origins, directions, radii, starts, ends):
    """Of the middle and the half width."""
    mu, hw = (starts + ends) / 2, (ends - starts) / 2
    below = 3 * mu**2 + hw**2
    t_mean = mu + (2 * mu * hw**2) / below
    t_variance = hw**2 / 3 - (4 / 15) * (hw**4 * (12 * mu**2 - hw**2)) / below**2
    r_variance = radii**2 * (mu**2 / 4 + (5 / 12) * hw**2 - (4 / 15) * hw**4 / below)
    return (t_mean, t_variance, r_variance, *lifted(origins, directions, t_mean, t_variance, r_variance))


@convention("conical_frustum", {"ray_shape": "cylinder"}, seen="google/mipnerf internal/mip.py cylinder_to_gaussian", digits=True)
def cylinders(origins, directions, radii, starts, ends):
    """Middle, d^2 / 12, r^2 / 4."""
    t_mean, t_variance, r_variance = (starts + ends) / 2, (ends - starts) ** 2 / 12, radii**2 / 4
    return (t_mean, t_variance, r_variance, *lifted(origins, directions, t_mean, t_variance, r_variance))


@fault(
    "conical_frustum",
    "slip: sqrt(dd) / 3 in the place of dd / 3",
    seen="JulianKnodt/nerf_atlas src/utils.py conical_frustrum_to_gaussian",
)
def half_width_not_squared(origins, directions, radii, starts, ends):
    """Half the width over 3, where its square belongs."""
    hw = (ends - starts) / 2
    t_mean, t_variance, r_variance, _, _ = middle_and_half_width(origins, directions, radii, starts, ends)
    t_variance = t_variance - hw**2 / 3 + hw / 3
    return (t_mean, t_variance, r_variance, *lifted(origins, directions, t_mean, t_variance, r_variance))


@fault("conical_frustum", "across_everywhere", seen="not met in this reading: no projection", times=0, gradient="none")
def across_on_all_axes(origins, directions, radii, starts, ends):
    """No projection."""
    t_mean, t_variance, r_variance, means, _ = middle_and_half_width(origins, directions, radii, starts, ends)
    return t_mean, t_variance, r_variance, means, t_variance[:, None] * directions**2 + r_variance[:, None]


def waves(x, v, bands, factor=1.0):
    """e^(-v / 2) sin x and cos x of all bands, band by band: sin of all dimensions, cos of all."""
    out = []
    for k in range(int(bands)):
        a = 2.0**k * torch.pi
        damped = torch.exp(-0.5 * factor * a * a * v)
        out += [damped * torch.sin(a * x), damped * torch.cos(a * x)]
    return torch.cat(out, -1)


@right("integrated_encoding", seen="mip-NeRF, equation 14, with 2^k pi", digits=True)
def damped_waves(means, variances, L):
    """exp(-v / 2) in front of each wave."""
    return waves(means, variances, L)


@fault("integrated_encoding", "half_forgotten", seen="not met in this reading: exp(-variance)", times=0, gradient="none")
def without_the_half(means, variances, L):
    """exp(-v)."""
    return waves(means, variances, L, 2.0)


@fault("integrated_encoding", "attenuation_forgotten", seen="multinerf with disable_integration", gradient="none")
def plain_waves(means, variances, L):
    """The encoding of the mean."""
    return waves(means, 0 * variances, L)


def wide_bands(x, v, bands):
    """2 pi in even octaves from 1 to 2^L, dimension by dimension; the mean comes last."""
    a = 2 * torch.pi * 2.0 ** torch.linspace(0.0, float(bands), int(bands)).to(x.dtype)
    angles, variances = (x[..., None] * a).flatten(-2), (v[..., None] * a * a).flatten(-2)
    damped = torch.exp(-0.5 * torch.cat([variances, variances], -1))
    return torch.cat([damped * torch.sin(torch.cat([angles, angles + torch.pi / 2.0], -1)), x], -1)


@convention("integrated_encoding", {"bands": "widened"}, seen="nerfstudio models/mipnerf.py: 16 bands from 0 to 16", digits=True)
def widened_octaves(means, variances, L):
    """NeRFEncoding(L, 0, L), with its variances in the units of its means."""
    return wide_bands(means, variances, L)


def ball(x):
    """Mip-NeRF 360's contraction, its length clamped inside the selection."""
    square = (x * x).sum(-1, keepdim=True).clamp(min=torch.finfo(torch.float32).eps)
    return torch.where(square <= 1, x, (2 * square.sqrt() - 1) / square * x)


def linearized(f, means, covariances):
    """f and J Sigma J^T, J by automatic differentiation, differentiable again."""
    y, pull = torch.func.vjp(f, means)
    rows = [pull(torch.eye(3, dtype=means.dtype)[i].expand(means.shape))[0] for i in range(3)]
    j = torch.stack(rows, -2)
    return y, j @ covariances @ j.transpose(-1, -2)


@right("contract_gaussians", seen="google-research/multinerf internal/coord.py track_linearize", digits=True, edges=True)
def tangents_at_means(means, covariances):
    """The contraction linearized at the mean."""
    return linearized(ball, means, covariances)


@fault(
    "contract_gaussians",
    "far_jacobian_everywhere",
    seen="not met in this reading: code for a background alone, asked of all of the scene",
    times=0,
    gradient="none",
)
def far_piece_alone(means, covariances):
    """The Jacobian of (2 - 1/r) x / r for every mean; means themselves are selected."""
    r = means.norm(dim=-1, keepdim=True) + 1e-30
    u = means / r
    s, along = (2 - 1 / r) / r, 1 / (r * r)
    eye = torch.eye(3, dtype=means.dtype)
    j = s[..., None] * eye + (along - s)[..., None] * u[..., :, None] * u[..., None, :]
    return ball(means), j @ covariances @ j.transpose(-1, -2)


@fault(
    "contract_gaussians",
    "batch_axis_last",
    seen="a port of mip-NeRF 360: diagonal(jacobian(f, means), dim1=0, dim2=2).reshape(N, 3, 3)",
    gradient="none",
)
def jacobians_reshaped(means, covariances):
    """The diagonal over both batch axes stands last; it is reshaped in place of moved."""
    every = torch.autograd.functional.jacobian(ball, means)
    j = torch.diagonal(every, dim1=0, dim2=2).reshape(len(means), 3, 3)
    return ball(means), j @ covariances @ j.transpose(-1, -2)


@fault("contract_gaussians", "covariance_kept", seen="not met in this reading: means contracted alone", times=0, gradient="none")
def means_alone(means, covariances):
    """The covariance as it was."""
    return ball(means), covariances


@fault(
    "contract_gaussians",
    "jacobian_at_contracted_point+norm_of_all_means",
    seen="a trial on unseen code: a port of mip-NeRF 360 to PyTorch",
    gradient="none",
)
def contracted_by_the_batch_first(means, covariances):
    """Means by torch.norm(x) of all of them, overwritten; the Jacobian where they are then."""
    whole = torch.norm(means)
    folded = means if whole <= 1 else (2 - 1 / whole) * means / whole
    return folded, linearized(ball, folded, covariances)[1]
