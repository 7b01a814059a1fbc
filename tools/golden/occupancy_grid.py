"""occupancy_grid(density, points, sigmas, queries, decay, threshold): max(decay density, sigmas) in cells with points; above the smaller of threshold and mean is occupied.

Cells are floor(x R), the last one closed, outside points the nearest cell's; index [z, y, x].
"""

import mpmath
import numpy as np
import torch

from .fixture import Case, Draw
from .reals import Real

NAME, PURPOSE = "occupancy_grid", 1123
DIFFERENTIABLE = ()


def cases():
    """Random points in grids of 2 to 5 cells, several in a cell, on faces, and outside."""
    for resolution in (2, 3, 5):
        draw = Draw(PURPOSE, f"random-{resolution}")
        yield case(f"random-{resolution}", draw.uniform((resolution,) * 3, 0.0, 2.0), draw.uniform((3 * resolution, 3)), draw)
    draw = Draw(PURPOSE, "faces")
    faces = np.array([[0.5, 0.25, 0.0], [0.75, 0.5, 1.0], [1.0, 1.0, 1.0], [0.25, 0.0, 0.25]])
    yield case("faces-CG3", draw.uniform((4, 4, 4)), faces, draw)
    yield case("outside", draw.uniform((2, 2, 2)), draw.uniform((8, 3), -1.0, 2.0), draw)
    draw = Draw(PURPOSE, "unseen")
    density = draw.uniform((3, 3, 3), 0.0, 2.0)
    density[draw.uniform((3, 3, 3)) < 0.4] = -1.0
    yield case("unseen", density, draw.uniform((6, 3)), draw)
    yield case("thin", 0.1 * draw.uniform((3, 3, 3)), draw.uniform((0, 3)), draw)
    empty = np.where(draw.uniform((2, 2, 2)) < 0.5, -1.0, 0.0)
    yield case("empty", empty, draw.uniform((0, 3)), draw)


def case(name, density, points, draw):
    """Sigmas at random, queries the points and as many others."""
    queries = np.concatenate([points, draw.uniform(points.shape)])
    inputs = {"density": density, "points": points, "sigmas": draw.uniform(len(points), 0.0, 3.0), "queries": queries}
    return Case(name, inputs | {"decay": np.float64(0.95), "threshold": np.float64(1.0)}, "cells are floor(x R)")


def over_reals(x):
    """The definition, cell by cell."""
    resolution = len(x["density"])

    def cell(point):
        i, j, k = (int(min(max(mpmath.floor(c.value * resolution), 0), resolution - 1)) for c in point)
        return k, j, i

    density = np.empty(x["density"].shape, object)
    for index in np.ndindex(density.shape):
        inside = [s for p, s in zip(x["points"], x["sigmas"]) if cell(p) == index]
        before = x["density"][index]
        density[index] = before
        if inside and before.value >= 0:
            density[index] = max([x["decay"].item() * before, *inside], key=lambda d: d.value)
    known = [d.value for d in density.flat if d.value > 0]
    threshold = x["threshold"].item().value
    if known:
        threshold = min(threshold, mpmath.fsum(known) / len(known))
    if not any(d > threshold for d in known):
        threshold = -1
    occupied = np.empty(density.shape, object)
    for index in np.ndindex(density.shape):
        occupied[index] = Real(int(density[index].value > threshold))
    found = np.array([occupied[cell(q)] for q in x["queries"]], object)
    return {"density_out": density, "occupied": occupied, "found": found}


def in_torch(x):
    """The same by scatter_reduce."""
    resolution = len(x["density"])

    def cells(points):
        i, j, k = (points * resolution).floor().clamp(0, resolution - 1).long().unbind(-1)
        return (k * resolution + j) * resolution + i

    before = x["density"].flatten()
    found = torch.full_like(before, -1.0).scatter_reduce(0, cells(x["points"]), x["sigmas"], "amax")
    risen = torch.maximum(x["decay"] * before, found)
    density = torch.where((found >= 0) & (before >= 0), risen, before).reshape(x["density"].shape)
    known = density[density > 0]
    threshold = torch.minimum(x["threshold"], known.mean()) if len(known) else x["threshold"]
    if not (known > threshold).any():
        threshold = torch.tensor(-1.0)
    occupied = (density > threshold).double()
    return {"density_out": density, "occupied": occupied, "found": occupied.flatten()[cells(x["queries"])]}
