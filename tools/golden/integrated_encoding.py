"""integrated_encoding(means, variances, L): the encoding's mean over a Gaussian (Barron et al. 2021, equations 11 to 16).

columns: for k = 0..L-1: sin(2^k pi x) e over all dimensions, cos(2^k pi x) e over all dimensions, e = exp(-(2^k pi)^2 v / 2).
"""

import math

import numpy as np
import torch

from . import reals
from .fixture import Case, Draw
from .portable import power_of_ten

NAME, PURPOSE = "integrated_encoding", 1325
DIFFERENTIABLE = ("means", "variances")


def cases():
    """Narrow and wide Gaussians, points, sheets; without pi, and with the mean kept."""
    for name, levels, low, high, conventions in (
        ("usual", 4, -4.0, -1.5, {}),
        ("pixels", 16, -9.0, -4.0, {}),
        ("wide", 4, -1.0, 1.0, {}),
        ("one", 10, -6.0, 0.0, {"frequency": "one"}),
        ("kept", 4, -4.0, -1.5, {"frequency": "two_pi", "integrated_identity": "true"}),
    ):
        draw = Draw(PURPOSE, name)
        means, variances = draw.uniform((4, 3), -1.5, 1.5), power_of_ten(draw.uniform((4, 3), low, high))
        yield case(name, means, variances, levels, f"variances of 1e{low:g} to 1e{high:g}", conventions)
    means = Draw(PURPOSE, "points").uniform((3, 2), -2.0, 2.0)
    yield case("points", means, np.zeros((3, 2)), 6, "no variance: the encoding of points")
    yield case("sheet", np.array([[0.25, -0.7, 0.6]]), np.array([[0.0, 0.4, 1e-5]]), 5, "one dimension fades")
    yield case("faded", np.array([[0.4], [-0.6]]), np.array([[20.0], [140.0]]), 6, "down to the least numbers, and beyond")


def case(name, means, variances, levels, comment, conventions=None):
    """A case from Gaussians and the number of bands."""
    inputs = {"means": means, "variances": variances, "L": np.float64(levels)}
    return Case(name, inputs, comment, conventions=conventions or {})


def over_reals(x):
    """The definition."""
    frequency = x["conventions"].get("frequency", "pi")
    times = 2 if frequency == "two_pi" else 1
    waves = (reals.sin, reals.cos) if frequency == "one" else (reals.sin_pi, reals.cos_pi)
    factor = 1 if frequency == "one" else times * reals.mp.pi
    columns = [x["means"]] if x["conventions"].get("integrated_identity") == "true" else []
    for k in range(int(x["L"].item().value)):
        square = (factor * 2**k) ** 2 / 2
        square = reals.real(-square) if frequency == "one" else reals.constant(-square)
        for wave in waves:
            column = np.empty(x["means"].shape, object)
            for index in np.ndindex(column.shape):
                column[index] = wave(x["means"][index], times * 2**k) * reals.exp(x["variances"][index] * square)
            columns.append(column)
    return {"encoding": np.concatenate(columns, axis=1)}


def in_torch(x):
    """By complex exponentials: e^(i a x - a^2 v / 2), the characteristic function of a normal number."""
    factor = {"pi": math.pi, "one": 1.0, "two_pi": 2 * math.pi}[x["conventions"].get("frequency", "pi")]
    turn = 2 * math.pi / factor
    columns = [x["means"]] if x["conventions"].get("integrated_identity") == "true" else []
    for k in range(int(x["L"])):
        # What is left after whole turns, which is exact where a turn is 1 or 2.
        reduced = 2.0**k * x["means"]
        angle = factor * (torch.fmod(reduced, turn) if factor != 1.0 else reduced)
        power = torch.exp(torch.complex(-0.5 * (factor * 2.0**k) ** 2 * x["variances"], angle))
        columns += [power.imag, power.real]
    return {"encoding": torch.cat(columns, 1)}
