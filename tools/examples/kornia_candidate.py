"""kornia 0.8.2 as a candidate: `python kornia_candidate.py CASES ANSWERS [--control]`. Verdicts, and why, in ../README.md.

With `--control` the same code runs without the three lines that make it fail: what is left must pass.
"""

import sys
from functools import partial

import torch
from kornia.geometry.camera import PinholeCamera
from kornia.geometry import linalg
from kornia.geometry.camera.perspective import unproject_points
from kornia.geometry.conversions import convert_points_from_homogeneous
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
    pose = torch.eye(4, dtype=torch.float64)
    pose[:3] = c2w[:3]
    intrinsics, extrinsics = torch.eye(4, dtype=c2w.dtype)[None], torch.linalg.inv(pose).to(c2w.dtype)[None]
    intrinsics[0, :2, :3] = torch.tensor([[focal, 0, cx], [0, focal, cy]], dtype=torch.float64)
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
    """IrregularRenderer, on points along an axis. Its last step is always 1e10: an empty sample behind the last one takes it."""
    pad = torch.nn.functional.pad
    t = pad(torch.cumsum(deltas, -1), (1, 0))
    return IrregularRenderer()(pad(rgbs, (0, 0, 0, 1)), pad(sigmas, (0, 1))[..., None], pad(t[..., None], (0, 2)))


def volume_render_alpha(alphas, rgbs):
    """VolumeRenderer._render, which both of its renderers end in."""
    return IrregularRenderer()._render(alphas[..., None], rgbs)


def psnr(prediction, target, peak):
    """kornia.metrics.psnr."""
    return kornia_psnr(prediction, target, peak)


def controlled():
    """Takes out what makes kornia fail: the fourth coordinate with its 1e-8; origins by the inverse of an inverse, and directions as
    differences of points, which lose digits when the camera stands far away; bands that are made in f32."""
    global transform, image_rays, positional_encoding
    linalg.convert_points_from_homogeneous = partial(convert_points_from_homogeneous, eps=0.0)
    default, moved = positional_encoding, image_rays

    def transform(c2w, x_c):
        last = c2w.new_tensor([[[0, 0, 0, 1]]]).expand(len(c2w), 1, 4)
        return transform_points(torch.cat([c2w[:, :3], last], 1), x_c[:, None])[:, 0]

    def image_rays(height, width, focal, cx, cy, c2w):
        turned = c2w.clone()
        turned[:3, 3] = 0
        uv, origins, d = moved(height, width, focal, cx, cy, turned)
        return uv, c2w[:3, 3].expand(origins.shape), d

    def positional_encoding(x, L):
        before = torch.get_default_dtype()
        torch.set_default_dtype(torch.float64 if x.dtype == torch.float64 else torch.float32)
        try:
            return default(x, L)
        finally:
            torch.set_default_dtype(before)


NAMES = "transform pixel_to_camera image_rays sample_along_rays positional_encoding volume_render volume_render_alpha psnr".split()

if __name__ == "__main__":
    if "--control" in sys.argv:
        sys.argv.remove("--control")
        controlled()
    for what, became in run(*sys.argv[1:], **{name: globals()[name] for name in NAMES}).items():
        print(f"{what:30} {became}")
