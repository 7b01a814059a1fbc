"""distortion_loss(weights, t): sum_ij w_i w_j |m_i - m_j| + 1/3 sum_i w_i^2 delta_i (mip-NeRF 360, equation 15), ray by ray."""

import numpy as np
import torch

from . import reals
from .fixture import Case, Draw

NAME, PURPOSE = "distortion_loss", 1236
DIFFERENTIABLE = ("weights", "t")


def cases():
    """Lengths and normalized distances, surfaces and fog, far from 0, intervals without length."""
    for name, rays, samples, near, step in (("usual", 3, 8, 2.0, 0.5), ("normalized", 3, 8, 0.0, 0.1), ("long", 1, 24, 0.0, 0.2)):
        draw = Draw(PURPOSE, name)
        lengths = step * draw.uniform((rays, samples), 0.2, 1.8)
        yield case(name, draw.uniform((rays, samples), 0.0, 2.0 / samples), lengths, near, "random")
    draw = Draw(PURPOSE, "far")
    yield case("far-VR8", draw.uniform((2, 8), 0.0, 0.25), draw.uniform((2, 8), 0.2, 1.8), 1e4, "from 1e4 on")
    yield case("surface", np.array([[0.0, 1.0, 0.0]]), np.array([[0.3, 0.01, 4.0]]), 1.0, "all weight in one place")
    yield case("no-length-VR11", np.array([[0.3, 0.4, 0.2]]), np.array([[0.5, 0.0, 0.25]]), 1.0, "an interval without length")


def case(name, weights, lengths, near, comment):
    """A case from weights and lengths."""
    t = np.concatenate([np.full((len(lengths), 1), near), near + np.cumsum(lengths, 1)], 1)
    return Case(name, {"weights": weights, "t": t}, comment)


def over_reals(x):
    """The definition: all pairs."""
    losses = []
    for w, t in zip(x["weights"], x["t"]):
        terms = []
        for i in range(len(w)):
            for j in range(i):
                # In ascending order the later middle is the larger one.
                apart = ((t[i] - t[j]) + (t[i + 1] - t[j + 1])) * 0.5
                terms.append(2 * (w[i] * w[j] * apart))
            terms.append(w[i] * w[i] * (t[i + 1] - t[i]) * reals.constant(reals.mpf(1) / 3))
        losses.append(reals.total(terms))
    return {"loss": np.array(losses, dtype=object)}


def in_torch(x):
    """As multinerf writes it: a matrix of distances."""
    w, t = x["weights"], x["t"]
    middles = (t[:, 1:] + t[:, :-1]) / 2
    apart = (middles[:, :, None] - middles[:, None, :]).abs()
    return {"loss": (w * (w[:, None, :] * apart).sum(-1)).sum(-1) + (w * w * t.diff()).sum(-1) / 3}
