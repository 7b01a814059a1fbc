"""pack_info(ray_ids, rays): how many samples each ray has, and how many all those in front of it."""

import numpy as np
import torch

from . import reals
from .fixture import Case

NAME, PURPOSE = "pack_info", 1233
DIFFERENTIABLE = ()
LENGTHS = {"ragged": [5, 3, 1, 8], "first-empty": [0, 0, 4], "middle-empty": [3, 0, 0, 2], "last-empty": [4, 0], "all-empty": [0, 0]}


def cases():
    """Rays of every length, with empty ones everywhere."""
    for name, lengths in LENGTHS.items():
        ids = np.repeat(np.arange(len(lengths), dtype=np.float64), lengths)
        yield Case(name, {"ray_ids": ids, "rays": np.float64(len(lengths))}, "PK1: lengths " + str(lengths), vjp=False)


def over_reals(x):
    """Counted one by one."""
    ids, rays = [int(i.value) for i in x["ray_ids"]], int(x["rays"].item().value)
    counts = [ids.count(r) for r in range(rays)]
    starts = [sum(i < r for i in ids) for r in range(rays)]
    return {name: np.array([reals.Real(n) for n in numbers], dtype=object) for name, numbers in (("starts", starts), ("counts", counts))}


def in_torch(x):
    """By a histogram and its running sum."""
    counts = torch.bincount(x["ray_ids"].long(), minlength=int(x["rays"])).double()
    return {"starts": counts.cumsum(0) - counts, "counts": counts}
