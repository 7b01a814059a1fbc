"""mse(prediction, target): the mean of the squared differences over all entries."""

import numpy as np
import torch

from . import reals
from .fixture import Case, Draw

NAME, PURPOSE = "mse", 1015
DIFFERENTIABLE = ("prediction",)


def cases():
    """A batch of colors, a picture, nearly equal and equal ones."""
    draw = Draw(PURPOSE, "batch")
    yield case("batch", draw.uniform((8, 3)), draw.uniform((8, 3)), "eight rays")
    draw = Draw(PURPOSE, "picture")
    yield case("picture", draw.uniform((2, 6, 5, 3)), draw.uniform((2, 6, 5, 3)), "two pictures of 6 x 5")
    target = Draw(PURPOSE, "close").uniform((4, 3), 0.25, 0.75)
    yield case("close", target + Draw(PURPOSE, "closer").uniform((4, 3), 0.0, 1e-12), target, "differences of 1e-12 are exact")
    yield case("equal-ME1", target, target, "exactly 0, gradient too")
    yield case("tiny", np.array([1e-170, 2e-200]), np.array([0.0, 0.0]), "squares underflow: within the least subnormal")


def case(name, prediction, target, comment):
    """A case from its two arrays."""
    return Case(name, {"prediction": prediction, "target": target}, comment)


def over_reals(x):
    """The definition."""
    differences = (x["prediction"] - x["target"]).reshape(-1)
    return {"value": np.array(reals.dot(differences, differences) / len(differences), dtype=object)}


def in_torch(x):
    """torch's own loss."""
    return {"value": torch.nn.functional.mse_loss(x["prediction"], x["target"])}
