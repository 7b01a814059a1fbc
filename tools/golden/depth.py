"""depth(weights, t): sum_i w_i t_i / A with A = sum_i w_i; by convention the sum alone."""

import numpy as np

from . import reals
from .fixture import Case, Draw

NAME, PURPOSE = "depth", 1014
DIFFERENTIABLE = ("weights", "t")


def cases():
    """Random weights; nearly empty rays; one opaque sample; the undivided convention."""
    yield case("random", 3, 8, 0.1, "A between 0 and 1")
    yield case("thin-VR7", 2, 8, 1e-12, "A below 1e-11: the quotient keeps its digits")
    yield case("long", 1, 128, 0.01, "128 samples")
    yield case("plain", 3, 8, 0.1, "sum w t alone", {"depth": "plain"})
    one = np.array([[0.0, 1.0, 0.0], [1e-300, 0.0, 1e-300]])
    yield Case("one-hot", {"weights": one, "t": np.array([[2.5, 3.7, 4.0]] * 2)}, "one opaque sample; weights of 1e-300")


def case(name, rays, samples, largest, comment, conventions=None):
    """Random weights below `largest`, sorted t in [2, 6)."""
    draw = Draw(PURPOSE, name)
    t = 2.0 + (np.arange(samples) + draw.uniform((rays, samples))) * (4.0 / samples)
    return Case(name, {"weights": draw.uniform((rays, samples), 0.0, largest), "t": t}, comment, conventions=conventions or {})


def over_reals(x):
    """The definition, ray by ray."""
    out = np.empty(len(x["t"]), object)
    for r, (weights, t) in enumerate(zip(x["weights"], x["t"])):
        weighted = reals.dot(weights, t)
        out[r] = weighted if x["conventions"].get("depth") == "plain" else weighted / reals.total(weights)
    return {"depth": out}


def in_torch(x):
    """The same on whole tensors."""
    weighted = (x["weights"] * x["t"]).sum(-1)
    return {"depth": weighted if x["conventions"].get("depth") == "plain" else weighted / x["weights"].sum(-1)}
