"""linear_to_srgb(linear): 12.92 x for x <= 0.0031308, else 1.055 x^(1/2.4) - 0.055 (IEC 61966-2-1)."""

import numpy as np
import torch

from . import reals
from .fixture import Case, Draw

NAME, PURPOSE = "linear_to_srgb", 1230
DIFFERENTIABLE = ("linear",)
THRESHOLD = 0.0031308


def cases():
    """Both pieces, the threshold and its neighbors, black, white and highlights."""
    yield case("usual", Draw(PURPOSE, "usual").uniform((16,)), "any light")
    yield case("dark", Draw(PURPOSE, "dark").uniform((8,), 0.0, THRESHOLD), "the straight piece")
    yield case("shadows", Draw(PURPOSE, "shadows").uniform((8,), THRESHOLD, 0.04045), "the power, below the other threshold")
    beside = np.array([np.nextafter(THRESHOLD, 0.0), THRESHOLD, np.nextafter(THRESHOLD, 1.0)])
    yield case("threshold", beside, "0.0031308 in f64 and its neighbors")
    yield case("ends", np.array([0.0, -0.0, 2.0**-40, 1.0 - 2.0**-53, 1.0, 1.0 + 2.0**-52]), "beside black and white")
    yield case("highlights", Draw(PURPOSE, "highlights").uniform((8,), 1.0, 1000.0), "not clamped")


def case(name, x, comment):
    """A case from its argument."""
    return Case(name, {"linear": x}, comment)


def decimal(digits):
    """A constant of the standard: a decimal, which f64 rounds."""
    return reals.constant(reals.mpf(digits))


def power(x):
    """x^(5/12), for a positive x."""
    k = reals.mpf(5) / 12
    p = x.value**k
    return x.function(p, k * p / x.value, k * (k - 1) * p / x.value**2)


def curve(x):
    """The definition; the threshold is f64's, so that both sides of it are numbers."""
    if x.value <= THRESHOLD:
        return decimal("12.92") * x
    return decimal("1.055") * power(x) - decimal("0.055")


def over_reals(x):
    """The definition, number by number."""
    return {"srgb": np.array([curve(value) for value in x["linear"]], dtype=object)}


def in_torch(x):
    """Both pieces and a selection; the clamp inside of it keeps the power's slope finite at 0."""
    linear = x["linear"]
    curved = 1.055 * linear.clamp(min=THRESHOLD) ** (1 / 2.4) - 0.055
    return {"srgb": torch.where(linear <= THRESHOLD, 12.92 * linear, curved)}
