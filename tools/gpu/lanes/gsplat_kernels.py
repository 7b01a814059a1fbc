"""gsplat's CUDA kernels, unchanged. It compiles them with -use_fast_math, but where NO_FAST_MATH=1 is in the environment."""

import torch
from asked import Absent
from gsplat.cuda import _wrapper as kernels


def spherical_harmonics(d, degree):
    """Of one coefficient at a time, so that what comes out is the basis."""
    count = (int(degree) + 1) ** 2
    one = torch.eye(count, dtype=d.dtype)[..., None].expand(len(d), count, count, 3)
    return kernels.spherical_harmonics(int(degree), d[:, None].expand(-1, count, -1), one)[..., 0]


def gaussian_covariance(quaternions, scales):
    """Without the inverse."""
    return kernels.quat_scale_to_covar_preci(quaternions, scales, True, False)[0]


def gaussian_color(means, camera_center, coefficients):
    """As its rasterization calls the harmonics: half added, cut at 0."""
    degree = int(coefficients.shape[1] ** 0.5) - 1
    return torch.clamp_min(kernels.spherical_harmonics(degree, means - camera_center, coefficients) + 0.5, 0.0)


def projection_fused(means, covariances, w2c, K, width, height):
    """The kernel that its rasterization calls. What it culls it leaves unwritten."""
    sizes = int(width), int(height)
    _, means2d, depths, conics, compensations = kernels.fully_fused_projection(
        means, covariances, None, None, w2c[None], K[None], *sizes, calc_compensations=True
    )
    return {"means2d": means2d[0], "conics": conics[0], "depths": depths[0], "compensations": compensations[0]}


def projection_simple(means, covariances, w2c, K, width, height):
    """Moved to the camera by torch; the dilation is added here."""
    R, t = w2c[:3, :3], w2c[:3, 3]
    sigma = covariances[:, [0, 1, 2, 1, 3, 4, 2, 4, 5]].reshape(-1, 3, 3)
    seen = means @ R.T + t
    means2d, covars2d = kernels.proj(seen[None], (R @ sigma @ R.T)[None], K[None], int(width), int(height))
    c = covars2d[0]
    dilated = torch.stack([c[:, 0, 0] + 0.3, c[:, 0, 1], c[:, 1, 1] + 0.3], -1)
    return {"means2d": means2d[0], "covariances2d": dilated, "depths": seen[:, 2]}


def drawn(means2d, conics, colors, opacities, width, height):
    """rasterize_to_pixels of I images of N splats, in the order given; every splat reaches every tile."""
    images, n = means2d.shape[:2]
    tiles = -(-width // 16), -(-height // 16)
    far = torch.full((images, n, 2), 100000, dtype=torch.int32)
    depths = torch.arange(1, n + 1, dtype=torch.float32).expand(images, n).contiguous()
    _, ids, flat = kernels.isect_tiles(torch.full((images, n, 2), 8.0), far, depths, 16, *tiles)
    offsets = kernels.isect_offset_encode(ids, images, *tiles)
    return kernels.rasterize_to_pixels(means2d, conics, colors, opacities, width, height, 16, offsets, flat)


def gaussian_alpha(pixels, means2d, conics, opacities):
    """A picture for each splat. Its pixels are at halves: for others a picture of one pixel each, splats moved."""
    at, n = (pixels - 0.5).round().long(), len(means2d)
    white = torch.ones(n, 1, 1, dtype=pixels.dtype)
    if bool(((at + 0.5).to(pixels) == pixels).all() and (at >= 0).all() and (at < 4096).all()):
        width, height = (int(size) for size in at.max(0).values + 1)
        colors, _ = drawn(means2d[:, None], conics[:, None], white, opacities[:, None], width, height)
        return colors[:, at[:, 1], at[:, 0], 0].T
    alphas = []
    for pixel in pixels.double():
        moved = (means2d.double() - (pixel - 0.5)).to(means2d)
        alphas.append(drawn(moved[:, None], conics[:, None], white, opacities[:, None], 1, 1)[0][:, 0, 0, 0])
    return torch.stack(alphas)


def volume_render_alpha(alphas, rgbs):
    """A ray is a picture of one pixel, its samples are splats without an edge."""
    rays, n = alphas.shape
    if n == 0:
        return {"colors": rgbs.sum(1), "opacity": alphas.sum(1)}
    middle, flat = torch.full((rays, n, 2), 0.5, dtype=alphas.dtype), torch.zeros(rays, n, 3, dtype=alphas.dtype)
    colors, opacity = drawn(middle, flat, rgbs, alphas, 1, 1)
    return {"colors": colors[:, 0, 0], "opacity": opacity[:, 0, 0, 0]}


def answer(asked):
    """f32, and f64, for which its kernels are compiled too."""
    asked.cuda()
    if asked.dtype not in ("f32", "f64"):
        raise Absent(f"it has no {asked.dtype}")
    rows = spherical_harmonics, gaussian_covariance, gaussian_color, gaussian_alpha, volume_render_alpha
    asked.hand("gsplat", gaussian_projection=projection_simple, **{row.__name__: row for row in rows})
    asked.hand("gsplat_fused", gaussian_projection=projection_fused)
