"""interlevel_loss(weights, t, proposal_weights, proposal_t, eps): what a proposal fails to cover (mip-NeRF 360, equation 13)."""

import numpy as np
import torch

from . import reals
from .fixture import Case, Draw

NAME, PURPOSE = "interlevel_loss", 1323
DIFFERENTIABLE = ("proposal_weights",)


def cases():
    """Finer and coarser proposals, edges in common, intervals without length, empty ones."""
    for name, n, m, total in (("usual", 8, 6, 0.4), ("finer", 4, 12, 0.3), ("coarser", 12, 4, 0.05), ("covered", 5, 6, 4.0)):
        draw = Draw(PURPOSE, name)
        weights, proposal = draw.uniform((3, n), 0.0, 2.0 / n), draw.uniform((3, m), 0.0, 2.0 * total / m)
        yield case(name, weights, edges(draw, n), proposal, edges(draw, m), 1e-7, "random")
    draw = Draw(PURPOSE, "same")
    t = edges(draw, 5)
    yield case("same", draw.uniform((3, 5)), t, draw.uniform((3, 5), 0.0, 0.5), t, 1e-3, "edges in common")
    thin = np.array([[0.0, 0.3, 0.3, 0.6, 1.0]])
    weights, proposal = np.array([[0.3, 0.4, 0.2, 0.1]]), np.array([[0.1, 0.05, 0.2]])
    yield case("no-length", weights, thin, proposal, np.array([[0.0, 0.3, 0.3, 1.0]]), 1e-3, "no length")
    t, s = edges(draw, 3)[:1], edges(draw, 4)[:1]
    yield case("empty", np.array([[0.3, 0.0, 0.7]]), t, np.zeros((1, 4)), s, 0.01, "an empty proposal")


def edges(draw, n):
    """Three rows of edges from 0 to 1."""
    inner = np.sort(draw.uniform((3, n - 1), 0.05, 0.95), 1)
    return np.concatenate([np.zeros((3, 1)), inner, np.ones((3, 1))], 1)


def case(name, weights, t, proposal_weights, proposal_t, eps, comment):
    """A case from both histograms."""
    inputs = {"weights": weights, "t": t, "proposal_weights": proposal_weights, "proposal_t": proposal_t}
    return Case(name, inputs | {"eps": np.array(eps)}, comment)


def over_reals(x):
    """The definition: all intervals of the proposal that overlap, half open."""
    eps, losses = x["eps"][()], []
    for w, t, v, s in zip(*(x[name] for name in ("weights", "t", "proposal_weights", "proposal_t"))):
        terms = [reals.real(0)]
        for i in range(len(w)):
            over = [j for j in range(len(v)) if s[j].value <= t[i + 1].value and t[i].value < s[j + 1].value]
            missing = w[i] - reals.total([reals.real(0)] + [v[j] for j in over])
            if missing.value > 0:
                terms.append(missing * missing / (w[i] + eps))
        losses.append(reals.total(terms) / len(w))
    return {"loss": np.array(losses, dtype=object)}


def in_torch(x):
    """By torch's searches through the edges, from the right, and differences of cumulative sums."""
    w, t, v, s = (x[name].contiguous() for name in ("weights", "t", "proposal_weights", "proposal_t"))
    total = torch.nn.functional.pad(v.cumsum(1), (1, 0))
    place = torch.searchsorted(s.detach(), t.detach(), right=True)
    first, last = (place[:, :-1] - 1).clamp_min(0), place[:, 1:].clamp_max(v.shape[1])
    bound = total.gather(1, last) - total.gather(1, first)
    return {"loss": ((w - bound).clamp_min(0) ** 2 / (w + x["eps"])).mean(1)}
