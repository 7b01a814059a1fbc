"""depth(weights, t, far): sum_i w_i t_i / A with A = sum_i w_i, far where A = 0; by convention the sum alone."""

import numpy as np
import torch

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
    one = {"weights": np.array([[0.0, 1.0, 0.0], [1e-300, 0.0, 1e-300]]), "t": np.array([[2.5, 3.7, 4.0]] * 2), "far": 6.0}
    yield Case("one-hot", one, "one opaque sample; weights of 1e-300")
    empty = {"weights": np.zeros((2, 3)), "t": np.array([[2.5, 3.7, 4.0]] * 2), "far": 5.75}
    yield Case("empty-VR7", empty, "nothing met: far, and no gradient; never 0/0")


def case(name, rays, samples, largest, comment, conventions=None):
    """Random weights below `largest`, sorted t in [2, 6)."""
    draw = Draw(PURPOSE, name)
    t = 2.0 + (np.arange(samples) + draw.uniform((rays, samples))) * (4.0 / samples)
    inputs = {"weights": draw.uniform((rays, samples), 0.0, largest), "t": t, "far": 6.0}
    return Case(name, inputs, comment, conventions=conventions or {})


def over_reals(x):
    """The definition, ray by ray."""
    out = np.empty(len(x["t"]), object)
    for r, (weights, t) in enumerate(zip(x["weights"], x["t"])):
        weighted, opacity = reals.dot(weights, t), reals.total(weights)
        if x["conventions"].get("depth") == "plain":
            out[r] = weighted
        else:
            out[r] = weighted / opacity if opacity.value else x["far"].item()
    return {"depth": out}


def in_torch(x):
    """The same on whole tensors; the division sees 1 where A is 0."""
    weighted, opacity = (x["weights"] * x["t"]).sum(-1), x["weights"].sum(-1)
    if x["conventions"].get("depth") == "plain":
        return {"depth": weighted}
    empty = opacity == 0.0
    return {"depth": torch.where(empty, x["far"], weighted / torch.where(empty, 1.0, opacity))}
