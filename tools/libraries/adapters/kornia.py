"""kornia: points and cameras, PSNR, the sRGB curve. `kornia.nerf` has gone since 0.8.2, whose verdicts are further up this
page."""

import torch
from entry import answers
from kornia.color import linear_rgb_to_rgb
from kornia.geometry.camera.perspective import unproject_points
from kornia.geometry.linalg import transform_points
from kornia.metrics import psnr as kornia_psnr


@answers("kornia", "transform", "geometry.linalg.transform_points")
def transform(c2w, x_c):
    """A matrix a point."""
    return transform_points(c2w, x_c[:, None])[:, 0]


@answers("kornia", "pixel_to_camera", "geometry.camera.perspective.unproject_points")
def pixel_to_camera(K, uv, s):
    """One camera."""
    return unproject_points(uv, s[:, None], K[None])


@answers("kornia", "psnr", "metrics.psnr")
def psnr(prediction, target, peak):
    """All pictures at once."""
    return kornia_psnr(prediction, target, peak)


@answers("kornia", "linear_to_srgb", "color.linear_rgb_to_rgb")
def linear_to_srgb(linear):
    """Each number as a gray picture of one pixel, whose first channel counts."""
    return linear_rgb_to_rgb(torch.stack([linear, linear.detach(), linear.detach()], -1)[..., None, None])[:, 0, 0, 0]
