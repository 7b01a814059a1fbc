"""accumulate_along_rays(weights, values, offsets): the weighted sum of each ray's values; 0 for a ray without samples."""

import numpy as np
import torch

from . import reals
from .fixture import Case, Draw

NAME, PURPOSE = "accumulate_along_rays", 1235
DIFFERENTIABLE = ("weights", "values")


def cases():
    """Rays of every length, with empty ones everywhere."""
    for name, lengths in {
        "ragged": [5, 3, 1, 8],
        "first-empty": [0, 0, 4],
        "middle-empty": [3, 0, 0, 2],
        "last-empty": [4, 0],
        "long": [60, 40],
    }.items():
        draw, n = Draw(PURPOSE, name), sum(lengths)
        inputs = {"weights": draw.uniform((n,)), "values": draw.uniform((n, 3), -0.5, 1.0)}
        yield Case(name, inputs | {"offsets": np.concatenate([[0.0], np.cumsum(lengths)])}, "PK1: lengths " + str(lengths))


def over_reals(x):
    """The definition, ray by ray."""
    offsets = [int(o.value) for o in x["offsets"]]
    rows = [[reals.real(1) * reals.dot(x["weights"][a:b], x["values"][a:b, c]) for c in range(3)] for a, b in zip(offsets, offsets[1:])]
    return {"sums": np.array(rows, dtype=object)}


def in_torch(x):
    """By the ray of each sample."""
    counts = x["offsets"].diff().long()
    ids = torch.repeat_interleave(torch.arange(len(counts)), counts)
    return {"sums": torch.zeros(len(counts), 3).index_add(0, ids, x["weights"][:, None] * x["values"])}
