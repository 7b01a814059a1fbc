"""importance_sampling(edges, weights, padding, u): the inverse of a piecewise-constant distribution, NeRF (2020) section 5.2.

F_k = sum_{j<k} (w_j + padding) / sum_j (w_j + padding); t = e_k + (u - F_k) / (F_{k+1} - F_k) (e_{k+1} - e_k) in the last bin with
some weight that begins at or below u. Where all weights are 0 they count as equal.
"""

import numpy as np
import torch

from . import reals
from .fixture import Case, Draw
from .reals import Real

NAME, PURPOSE = "importance_sampling", 1121
DIFFERENTIABLE = ("edges", "u")


def cases():
    """Random rays, the rows SA1 to SA3 of the hard cases, and the ends of [0, 1] without a gradient."""
    yield case("random", 3, 8, 6, 0.0, "uneven bins, u in any order")
    yield case("paper", 1, 64, 16, 0.0, "64 coarse samples")
    yield case("padded", 2, 8, 6, 1e-5, "1e-5 added to every weight")
    gaps = np.array([[0.0, 0.4, 0.0, 0.0, 0.3, 0.1, 0.0]])
    inner = np.array([[0.1, 0.3, 0.55, 0.7, 0.95]])
    edges = np.array([[2.0, 2.3, 3.1, 3.2, 4.5, 5.0, 5.4, 6.0]])
    yield of("gaps-SA1", edges, gaps, 0.0, inner, "bins without weight in front, between and behind")
    yield of("empty-SA1", edges, 0 * gaps, 0.0, inner, "no weight anywhere: all bins weigh the same")
    opaque = np.zeros((1, 62))
    opaque[0, 40] = 1.0
    faint = (np.arange(5) * 9 + 0.5)[None] * 1e-5 / 1.00062
    yield of("opaque-SA2", np.linspace(2.0, 6.0, 63)[None], opaque, 1e-5, faint, "differences of F below 1e-5")
    flat = np.array([[2.0, 3.0, 3.0, 4.5]])
    yield of("zero-width-SA3", flat, np.array([[1.0, 2.0, 1.0]]), 0.0, np.array([[0.1, 0.4, 0.6, 0.9]]), "two edges in one place")
    ends = np.array([[0.0, 1.0]])
    yield of("ends-SA3", edges, gaps, 0.0, ends, "u = 0 and 1: where the weights begin and end", vjp=False)


def case(name, rays, bins, samples, padding, comment):
    """Edges by uneven steps, weights and u at random."""
    draw = Draw(PURPOSE, name)
    steps = draw.uniform((rays, bins), 0.05, 0.5)
    edges = np.concatenate([np.full((rays, 1), 2.0), 2.0 + np.cumsum(steps, axis=1)], axis=1)
    return of(name, edges, draw.uniform((rays, bins)), padding, draw.uniform((rays, samples)), comment)


def of(name, edges, weights, padding, u, comment, vjp=True):
    """A case from its arrays."""
    inputs = {"edges": edges, "weights": weights, "padding": np.float64(padding), "u": u}
    return Case(name, inputs, comment, vjp=vjp)


def over_reals(x):
    """The definition, ray by ray."""
    padding = x["padding"].item()
    t = np.empty(x["u"].shape, object)
    for r, i in np.ndindex(t.shape):
        edges, u = x["edges"][r], x["u"][r, i]
        padded = [w + padding for w in x["weights"][r]]
        if not any(w.value for w in padded):
            padded = [Real(1) for _ in padded]
        total = reals.total(padded)
        f = [Real(0)] + [reals.total(padded[: k + 1]) / total for k in range(len(padded))]
        heavy = [k for k, w in enumerate(padded) if w.value > 0]
        k = max([k for k in heavy if f[k].value <= u.value], default=heavy[0])
        s = (u - f[k]) / (f[k + 1] - f[k])
        t[r, i] = edges[k] + s * (edges[k + 1] - edges[k])
    return {"t": t}


def in_torch(x):
    """The same on whole tensors, by searchsorted: the last edge at or below u, or the last bin with weight."""
    padded = x["weights"] + x["padding"]
    padded = torch.where(padded.sum(-1, keepdim=True) == 0.0, torch.ones_like(padded), padded)
    sums = torch.cumsum(padded, -1)
    f = torch.nn.functional.pad(sums / sums[:, -1:], (1, 0))
    last = padded.shape[1] - 1 - (padded.flip(-1) > 0).int().argmax(-1, keepdim=True)
    k = torch.minimum(torch.searchsorted(f, x["u"].detach(), right=True) - 1, last)
    below, above = f.gather(1, k), f.gather(1, k + 1)
    a, b = x["edges"].gather(1, k), x["edges"].gather(1, k + 1)
    return {"t": a + (x["u"] - below) / (above - below) * (b - a)}
