"""sample_along_rays(rays_o, rays_d, near, far, u): D = (far - near) / N, t_i = near + (i + u_i) D, points = o + t d."""

from unittest import mock

import numpy as np
import torch
from kornia.nerf.samplers import sample_lengths, sample_ray_points

from . import reals
from .fixture import Case, Draw
from .reals import Real

NAME, PURPOSE = "sample_along_rays", 1005
DIFFERENTIABLE = KORNIA_DIFFERENTIABLE = ()


def cases():
    """Jittered samples, samples at rest, and the rays of cameras far away (CG9)."""
    yield case("jittered", 4, 8, 2.0, 6.0, "an independent u for every ray and sample")
    yield case("rest", 2, 64, 2.0, 6.0, "u = 0.5 everywhere: no jitter", u=0.5)
    yield case("one-sample", 2, 1, 0.1, 3.7, "N = 1: D is the whole interval")
    yield case("near-zero-SA4", 2, 5, 0.0, 0.7, "near = 0")
    yield case("far-away-CG9", 3, 6, 2.0, 6.0, "origin at 1e6: o + t d cancels", origin=1e6)


def kornia_cases():
    """Its regular samples stand on both ends of [0, 1], its irregular ones in N intervals."""
    regular = case("regular", 2, 7, 0.0, 1.0, "sample_lengths: linspace(0, 1, N), no jitter", u=0.0)
    regular.conventions = {"grid": "ends_plus_spacing"}
    yield regular
    yield case("irregular", 3, 8, 0.0, 1.0, "sample_lengths(irregular=True), torch.rand replaced by u")


def case(name, rays, samples, near, far, comment, u=None, origin=4.0):
    """Random rays with directions of any length."""
    draw = Draw(PURPOSE, name)
    inputs = {"rays_o": draw.uniform((rays, 3), -origin, origin), "rays_d": draw.uniform((rays, 3), -1.0, 1.0)}
    drawn = draw.uniform((rays, samples)) if u is None else np.full((rays, samples), u)
    return Case(name, inputs | {"near": near, "far": far, "u": drawn}, comment)


def over_reals(x):
    """The definition, sample by sample."""
    near, far, u = x["near"].item(), x["far"].item(), x["u"]
    rays, samples = u.shape
    intervals = samples - 1 if x["conventions"].get("grid") == "ends_plus_spacing" else samples
    t, points = np.empty(u.shape, object), np.empty((*u.shape, 3), object)
    for r, i in np.ndindex(rays, samples):
        t[r, i] = near + (Real(i) + u[r, i]) * ((far - near) / intervals)
        for c in range(3):
            points[r, i, c] = reals.total([x["rays_o"][r, c], t[r, i] * x["rays_d"][r, c]])
    return {"t": t, "points": points}


def in_torch(x):
    """The same on whole tensors."""
    samples = x["u"].shape[1]
    t = x["near"] + (torch.arange(samples) + x["u"]) * ((x["far"] - x["near"]) / samples)
    return {"t": t, "points": x["rays_o"][:, None] + t[..., None] * x["rays_d"][:, None]}


def in_kornia(x):
    """kornia.nerf.samplers.sample_lengths and sample_ray_points."""
    irregular = x["conventions"].get("grid") is None
    with mock.patch("torch.rand", lambda *_, **__: x["u"]):
        t = sample_lengths(*x["u"].shape, device="cpu", dtype=torch.float64, irregular=irregular)
    return {"t": t, "points": sample_ray_points(x["rays_o"], x["rays_d"], t)}
