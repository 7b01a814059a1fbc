"""positional_encoding(x, L): Mildenhall et al. 2020 eq. 4 with the identity kept.

columns: x, then for k = 0..L-1: sin(2^k pi x) over all dimensions, cos(2^k pi x) over all dimensions.
"""

import math

import numpy as np
import torch
from kornia.nerf.positional_encoder import PositionalEncoder

from . import reals
from .fixture import Case, Draw

NAME, PURPOSE = "positional_encoding", 1007
DIFFERENTIABLE = KORNIA_DIFFERENTIABLE = ("x",)


def cases():
    """Positions, directions and pixels at their usual levels, and the rows PE1 to PE3 of the hard cases."""
    for name, dims, levels, low in [("positions", 3, 10, -4.0), ("directions", 3, 4, -1.0), ("pixels", 2, 10, 0.0)]:
        yield case(name, Draw(PURPOSE, name).uniform((4, dims), low, -low or 1.0), levels, "a usual width")
    yield case("identity-only", np.array([[0.25, -3.0]]), 0, "L = 0: the input alone")
    halves = np.array([[0.0, -0.0], [0.5, -0.5], [1.0, -1.0], [2.0, 0.25], [math.sqrt(2.0) / 3.0, 0.75]])
    yield case("zeros-PE3", halves, 6, "exact zeros and ones: sin(pi) is 0, cos(pi/2) is 0")
    yield case("multiples-of-pi-PE3", np.array([[math.pi, 2 * math.pi], [3 * math.pi, 100 * math.pi]]), 12, "x near k pi")
    tiny = np.array([[5e-324, -5e-324], [2.2e-308, 1e-310], [1e-300, -1e-200]])
    yield case("subnormal-PE3", tiny, 4, "2^k pi x is accurate for subnormal x too, and cos is 1")
    high = Draw(PURPOSE, "high-bands-PE1").uniform((3, 2), -1.0, 1.0)
    yield case("high-bands-PE1", high, 31, "reduction at 2^30 x: a rounded product loses 9 digits")
    huge = np.array([[1e15 + 0.5, 2.0**52 + 1.0], [4503599627370495.5, -1e300], [2.0**53, 123456789.0625]])
    yield case("huge-PE3", huge, 3, "x so large that only its last bits matter")
    quarter = np.array([[0.5 - 2.0**-54, 0.5 + 2.0**-53, 0.25 + 2.0**-54], [1.5 - 2.0**-52, 1.0 + 2.0**-52, 1.0 - 2.0**-53]])
    yield case("quarters-PE2", quarter, 10, "one bit beside the zeros of cos and sin: cos as sin(x + pi/2) has no digit left")


def kornia_cases():
    """Its default, linear bands, and its octaves: both without pi."""
    for name, levels, spacing in [("linear", 10, "linear"), ("linear-exact", 9, "linear"), ("octaves", 10, "octaves")]:
        conventions = {"frequency": "one"} | ({"bands": "linear"} if spacing == "linear" else {})
        points = Draw(PURPOSE, name).uniform((3, 3), -1.0, 1.0)
        yield Case(name, {"x": points, "L": np.float64(levels)}, f"PositionalEncoder, bands {spacing}", conventions=conventions)


def case(name, x, levels, comment):
    """A case from points and the number of bands."""
    return Case(name, {"x": x, "L": np.float64(levels)}, comment)


def over_reals(x):
    """The definition, with the argument reduced exactly."""
    return {"encoding": encode(x["x"], int(x["L"].item().value), x["conventions"])}


def encode(points, levels, conventions):
    """Columns of an (M,D) array of reals; frequency pi or 1, bands octaves or linear."""
    waves = (reals.sin, reals.cos) if conventions.get("frequency") == "one" else (reals.sin_pi, reals.cos_pi)
    columns = [points]
    for k in range(levels):
        linear = conventions.get("bands") == "linear" and levels > 1
        band = 1 + k * reals.mpf(2 ** (levels - 1) - 1) / (levels - 1) if linear else 2**k
        for wave in waves:
            column = np.empty(points.shape, object)
            for index in np.ndindex(points.shape):
                column[index] = wave(points[index], band)
            columns.append(column)
    return np.concatenate(columns, axis=1)


def in_torch(x):
    """remainder(2^k x, 2) is exact, so that torch's error stays that of pi times a number below 2."""
    return {"encoding": encode_torch(x["x"], int(x["L"]))}


def encode_torch(points, levels):
    """Columns of an (M,D) tensor, at frequencies 2^k pi."""
    bands = [points]
    for k in range(levels):
        angle = math.pi * torch.fmod(2.0**k * points, 2.0)
        bands += [torch.sin(angle), torch.cos(angle)]
    return torch.cat(bands, -1)


def in_kornia(x):
    """kornia.nerf.positional_encoder.PositionalEncoder."""
    octaves = x["conventions"].get("bands") != "linear"
    return {"encoding": PositionalEncoder(x["x"].shape[1], int(x["L"]), log_space=octaves)(x["x"])}
