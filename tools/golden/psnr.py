"""psnr(prediction, target, peak): 10 log10(peak^2 / mse), of several pictures by convention their mean or that of their error."""

import mpmath
import numpy as np
import torch

from . import reals
from .fixture import Case, Draw

NAME, PURPOSE = "psnr", 1016
DIFFERENTIABLE = ()


def cases():
    """Two pictures of unequal error under both conventions, another peak, and equal pictures (ME1)."""
    draw = Draw(PURPOSE, "pictures")
    target = draw.uniform((2, 3, 4, 3), 0.25, 0.75)
    noise = draw.uniform((2, 3, 4, 3), -0.25, 0.25)
    noise[1] *= 0.0625
    inputs = {"prediction": target + noise, "target": target, "peak": 1.0}
    yield Case("mean-of-psnrs", inputs, "the mean of the pictures' PSNRs", conventions={"psnr": "images"})
    yield Case("psnr-of-mean", inputs, "the PSNR of the mean error: the smaller one", conventions={"psnr": "mean_error"})
    one = {"prediction": target[:1] * 255.0, "target": (target + noise)[:1] * 255.0, "peak": 255.0}
    yield Case("bytes", one, "one picture in bytes, peak 255")
    tenth = {"prediction": np.full((1, 2, 2, 3), 0.6), "target": np.full((1, 2, 2, 3), 0.5), "peak": 1.0}
    yield Case("twenty-decibels", tenth, "an error of 0.6 - 0.5 everywhere: 20 dB but for that difference's rounding")
    near_zero = {"prediction": np.full((1, 1, 1, 3), 1.0 - 2.0**-30), "target": np.zeros((1, 1, 1, 3)), "peak": 1.0}
    yield Case("zero-decibels", near_zero, "log of nearly 1: the digits are those of the mean squared error")
    equal = {"prediction": target[:1], "target": target[:1], "peak": 1.0}
    yield Case("equal-ME1", equal, "equal pictures: infinite, never NaN", flags=["infinite"])


def over_reals(x):
    """The definition; +inf where two pictures are equal."""
    errors = []
    for prediction, target in zip(x["prediction"], x["target"]):
        differences = (prediction - target).reshape(-1)
        errors.append(reals.dot(differences, differences) / len(differences))
    peak = x["peak"].item()
    if any(error.value == 0 for error in errors):
        return {"value": np.array(reals.Real(mpmath.inf), dtype=object)}
    if x["conventions"].get("psnr") == "mean_error":
        errors = [reals.total(errors) / len(errors)]
    decibels = [reals.log(peak * peak / error) * reals.constant(10 / mpmath.log(10)) for error in errors]
    return {"value": np.array(reals.total(decibels) / len(decibels), dtype=object)}


def in_torch(x):
    """The same on whole tensors."""
    errors = ((x["prediction"] - x["target"]) ** 2).flatten(1).mean(1)
    errors = errors.mean()[None] if x["conventions"].get("psnr") == "mean_error" else errors
    return {"value": (10.0 * torch.log10(x["peak"] ** 2 / errors)).mean()}
