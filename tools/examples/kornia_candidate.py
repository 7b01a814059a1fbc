"""kornia 0.8.2 as a candidate: `python kornia_candidate.py CASES ANSWERS`. Verdicts, and why, in ../README.md."""

import sys

import torch
from kornia.geometry.camera import PinholeCamera
from kornia.geometry.camera.perspective import unproject_points
from kornia.geometry.linalg import transform_points
from kornia.metrics import psnr as kornia_psnr
from kornia.nerf.positional_encoder import PositionalEncoder
from kornia.nerf.samplers import UniformRaySampler, sample_lengths, sample_ray_points
from kornia.nerf.volume_renderer import IrregularRenderer
from right import run


def transform(c2w, x_c):
    """kornia.geometry.linalg.transform_points."""
    return transform_points(c2w, x_c[:, None])[:, 0]


def pixel_to_camera(K, uv, s):
    """kornia.geometry.camera.perspective.unproject_points."""
    return unproject_points(uv, s[:, None], K[None])


def image_rays(height, width, focal, cx, cy, c2w):
    """UniformRaySampler on a PinholeCamera, whose extrinsics are world to camera."""
    intrinsics, extrinsics = torch.eye(4, dtype=c2w.dtype)[None], torch.eye(4, dtype=c2w.dtype)[None]
    intrinsics[0, :2, :3] = torch.tensor([[focal, 0, cx], [0, focal, cy]])
    extrinsics[0, :3, :3], extrinsics[0, :3, 3] = c2w[:3, :3].T, -c2w[:3, :3].T @ c2w[:3, 3]
    sampler = UniformRaySampler(0.0, 1.0, ndc=False, device="cpu", dtype=c2w.dtype)
    sampler.calc_ray_params(PinholeCamera(intrinsics, extrinsics, torch.tensor([height]), torch.tensor([width])))
    shape = (height, width, 3)
    uv = sampler.points_2d.to(c2w.dtype).reshape(height, width, 2)
    return uv, sampler.origins.reshape(shape), sampler.directions.reshape(shape)


def sample_along_rays(rays_o, rays_d, near, far, u):
    """sample_lengths and sample_ray_points. It draws its own u: here it is handed the case's."""
    if u.shape[1] < 2:  # which kornia refuses
        return near + (far - near) * u, rays_o[:, None] + (near + (far - near) * u)[..., None] * rays_d[:, None]
    own, torch.rand = torch.rand, lambda *_, **__: u
    try:
        t = near + (far - near) * sample_lengths(*u.shape, device="cpu", dtype=u.dtype, irregular=True)
    finally:
        torch.rand = own
    return t, sample_ray_points(rays_o, rays_d, t)


def positional_encoding(x, L):
    """PositionalEncoder as it comes."""
    return PositionalEncoder(x.shape[1], L)(x)


def volume_render(sigmas, rgbs, deltas):
    """IrregularRenderer, on points along an axis whose distances are the steps."""
    if deltas.shape[1] == 0:  # kornia ends in an IndexError
        return torch.zeros(len(deltas), 3, dtype=rgbs.dtype)
    t = torch.nn.functional.pad(torch.cumsum(deltas, -1), (1, 0))[:, :-1]
    return IrregularRenderer()(rgbs, sigmas[..., None], torch.nn.functional.pad(t[..., None], (0, 2)))


def volume_render_alpha(alphas, rgbs):
    """VolumeRenderer._render, which both of its renderers end in."""
    return IrregularRenderer()._render(alphas[..., None], rgbs)


def psnr(prediction, target, peak):
    """kornia.metrics.psnr."""
    return kornia_psnr(prediction, target, peak)


ROWS = (transform, pixel_to_camera, image_rays, sample_along_rays, positional_encoding, volume_render, volume_render_alpha, psnr)

if __name__ == "__main__":
    for what, became in run(*sys.argv[1:], **{row.__name__: row for row in ROWS}).items():
        print(f"{what:30} {became}")
