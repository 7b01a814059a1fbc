"""charbonnier(prediction, target, eps): the mean over all entries of sqrt(d^2 + eps^2) (Charbonnier et al. 1994)."""

import numpy as np
import torch

from . import reals
from .fixture import Case, Draw

NAME, PURPOSE = "charbonnier", 1322
DIFFERENTIABLE = ("prediction",)


def cases():
    """Colors, differences of about eps, equal entries, large ones."""
    draw = Draw(PURPOSE, "batch")
    yield case("batch", draw.uniform((8, 3)), draw.uniform((8, 3)), 1e-3, "eight rays")
    near = Draw(PURPOSE, "near").uniform((12,), -3e-3, 3e-3)
    yield case("near", near, np.zeros(12), 1e-3, "differences of about eps")
    yield case("equal", np.array([0.3, 0.7, 0.1]), np.array([0.3, 0.7, 0.4]), 0.05, "eps, and a gradient of 0")
    yield case("large", np.array([300.0, -40.0, 2.0]), np.array([1.0, 5.0, 0.0]), 1e-3, "linear light")


def case(name, prediction, target, eps, comment):
    """A case from its arrays and eps."""
    return Case(name, {"prediction": prediction, "target": target, "eps": np.array(eps)}, comment)


def over_reals(x):
    """The definition."""
    eps = x["eps"][()]
    differences = (x["prediction"] - x["target"]).reshape(-1)
    terms = [reals.sqrt(d * d + eps * eps) for d in differences]
    return {"value": np.array(reals.total(terms) / len(terms), dtype=object)}


def in_torch(x):
    """Through torch's hypot."""
    return {"value": torch.hypot(x["prediction"] - x["target"], x["eps"].expand_as(x["prediction"])).mean()}
