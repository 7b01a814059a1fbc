"""early_stop(sigmas, rgbs, deltas, offsets, eps): packed rays, each up to the first sample behind which T < eps.

The samples that are left are rendered as volume_render does (Max 1995); nothing is renormalized. Where a ray stops is piecewise
constant, so that samples behind have no gradient.
"""

import numpy as np
import torch

from . import reals
from .fixture import Case, Draw
from .volume_render import opacity, without_eps

NAME, PURPOSE = "early_stop", 1121
DIFFERENTIABLE = ("sigmas", "rgbs", "deltas")


def cases():
    """Rays of every length and thickness, and the rows VR5 and VR9 of the hard cases. No T lies beside eps."""
    yield random("mixed", [7, 3, 12, 1, 9], (0.0, 6.0), 0.1, "some rays stop, some do not")
    yield random("thin", [6, 4], (0.0, 0.5), 0.25, "nothing stops")
    yield random("opaque", [8, 8], (20.0, 60.0), 0.01, "all stop within a few samples")
    yield random("usual", [48, 17], (0.0, 8.0), 1e-4, "the usual eps")
    yield random("never", [5, 9], (0.0, 8.0), 0.0, "eps = 0: packed volume_render")
    yield random("ragged-VR9", [0, 5, 0, 0, 1, 6, 0], (0.0, 8.0), 0.05, "rays without samples, and with one")
    white = np.ones((6, 3))
    yield case("white-VR5", np.full(6, 1.375), white, np.full(6, 0.5), [6], 0.35, "stops at T = .25: the color is .75, not 1")
    front = np.array([0.0, 0.0, 0.7, 1e4, 0.3, 0.2])
    yield case("wall", front, white, np.ones(6), [6], 0.01, "empty space, then a wall")


def random(name, lengths, sigma_range, eps, comment):
    """Uniform densities, colors and steps."""
    draw, n = Draw(PURPOSE, name), sum(lengths)
    sigmas, rgbs = draw.uniform((n,), *sigma_range), draw.uniform((n, 3))
    return case(name, sigmas, rgbs, draw.uniform((n,), 0.05, 0.25), lengths, eps, comment)


def case(name, sigmas, rgbs, deltas, lengths, eps, comment):
    """A case from its arrays and the rays' lengths. `live` has no gradient."""
    offsets = np.concatenate([[0], np.cumsum(lengths)]).astype(float)
    inputs = {"sigmas": sigmas, "rgbs": rgbs, "deltas": deltas, "offsets": offsets, "eps": np.float64(eps)}
    return Case(name, inputs, comment, cotangents={"live": np.zeros(len(lengths))})


def over_reals(x):
    """The definition, ray by ray."""
    ends = [int(end.value) for end in x["offsets"]]
    rays, eps = len(ends) - 1, x["eps"].item().value
    out = {"live": np.empty(rays, object), "colors": np.empty((rays, 3), object)}
    out |= {"weights": np.array([reals.Real(0) for _ in x["sigmas"]], dtype=object)}
    out |= {"opacity": np.empty(rays, object), "transmittance": np.empty(rays, object)}
    for r in range(rays):
        first, end = ends[r], ends[r + 1]
        steps = [s.value * d.value for s, d in zip(x["sigmas"][first:end], x["deltas"][first:end])]
        behind = [reals.mp.exp(-reals.mp.fsum(steps[: n + 1])) for n in range(end - first)]
        assert all(abs(t - eps) > 1e-9 * eps for t in behind if eps > 0), "a T too near to eps"
        live = next((n + 1 for n, t in enumerate(behind) if t < eps), end - first)
        last = first + live
        weights, out["opacity"][r], out["transmittance"][r] = without_eps(x["sigmas"][first:last], x["deltas"][first:last])
        out["live"][r] = reals.Real(live)
        for n, weight in enumerate(weights):
            out["weights"][first + n] = weight
        for c in range(3):
            out["colors"][r, c] = reals.dot(weights, x["rgbs"][first:last, c])
    return out


def in_torch(x):
    """Masks over the packed arrays: what is live, and to which ray it belongs."""
    ends = x["offsets"].to(int)
    lengths = ends[1:] - ends[:-1]
    ray = torch.repeat_interleave(torch.arange(len(lengths)), lengths)
    member = ray[:, None] == ray[None, :]
    upto = member & torch.ones_like(member).tril()
    steps = x["sigmas"] * x["deltas"]
    behind = torch.exp(-(upto * steps[None, :]).sum(1))
    front = torch.exp(-((upto & ~torch.eye(len(steps), dtype=bool)) * steps[None, :]).sum(1))
    live = (front >= x["eps"]).detach()
    weights = torch.where(live, front * opacity(steps), 0.0)
    sums = torch.zeros(len(lengths), len(steps)).index_put((ray, torch.arange(len(steps))), live.double())
    depth = sums @ steps
    assert not torch.any(behind == x["eps"])
    return {
        "live": sums.sum(1),
        "colors": sums @ (weights[:, None] * x["rgbs"]),
        "weights": weights,
        "opacity": opacity(depth),
        "transmittance": torch.exp(-depth),
    }
