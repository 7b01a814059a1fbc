"""A right implementation, as anybody might write it in torch: `python right.py CASES ANSWERS`."""

import math
import sys
from pathlib import Path

import torch

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from candidate import run  # noqa: E402


def positional_encoding(x, L):
    """x, then sin and cos of 2^k pi x."""
    bands = [x]
    for k in range(L):
        bands += [torch.sin(2**k * math.pi * x), torch.cos(2**k * math.pi * x)]
    return torch.cat(bands, -1)


def volume_render(sigmas, rgbs, deltas):
    """Colors, weights, opacity, and what is left behind the last sample."""
    depth = sigmas * deltas
    alpha = -torch.expm1(-depth)
    # What lies in front of each sample. Not cumsum(depth) - depth, which is 0 in front of a last step of 1e10.
    front = torch.cumsum(torch.nn.functional.pad(depth, (1, 0))[..., :-1], -1)
    shade = torch.exp(-front)
    weights = shade * alpha
    return (weights[..., None] * rgbs).sum(-2), weights, weights.sum(-1), torch.exp(-depth.sum(-1))


def composite_background(colors, opacity, background):
    """C + (1 - A) b."""
    return colors + (1 - opacity)[:, None] * background


def sample_along_rays(rays_o, rays_d, near, far, u):
    """One sample in each of N equal intervals."""
    n = u.shape[-1]
    t = near + (torch.arange(n, dtype=u.dtype, device=u.device) + u) * ((far - near) / n)
    return t, rays_o[:, None] + t[..., None] * rays_d[:, None]


if __name__ == "__main__":
    for what, became in run(
        *sys.argv[1:],
        positional_encoding=positional_encoding,
        volume_render=volume_render,
        composite_background=composite_background,
        sample_along_rays=sample_along_rays,
    ).items():
        print(f"{what:30} {became}")
