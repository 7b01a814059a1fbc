"""huber(prediction, target, delta): d^2 / 2 for |d| <= delta, else delta (|d| - delta / 2), the mean (Huber 1964)."""

import numpy as np
import torch

from . import reals
from .fixture import Case, Draw

NAME, PURPOSE = "huber", 1321
DIFFERENTIABLE = ("prediction",)


def cases():
    """Inside, outside, at delta, and equal entries."""
    for name, delta in (("batch", 0.3), ("mostly-outside", 0.05), ("inside", 2.0)):
        draw = Draw(PURPOSE, name)
        yield case(name, draw.uniform((8, 3)), draw.uniform((8, 3)), delta, "eight rays")
    p = np.array([0.25, -0.25, 0.0, 1.25, -3.0])
    yield case("at-delta", p, np.zeros(5), 0.25, "where the pieces meet, and no error")


def case(name, prediction, target, delta, comment):
    """A case from its arrays and delta."""
    return Case(name, {"prediction": prediction, "target": target, "delta": np.array(delta)}, comment)


def over_reals(x):
    """The definition."""
    delta, terms = x["delta"][()], []
    for p, t in zip(x["prediction"].reshape(-1), x["target"].reshape(-1)):
        d = p - t if (p - t).value > 0 else t - p
        inside = d.value <= delta.value
        terms.append(d * d * 0.5 if inside else delta * (d - delta * 0.5))
    return {"value": np.array(reals.total(terms) / len(terms), dtype=object)}


def in_torch(x):
    """torch's own loss."""
    return {"value": torch.nn.functional.huber_loss(x["prediction"], x["target"], delta=float(x["delta"]))}
