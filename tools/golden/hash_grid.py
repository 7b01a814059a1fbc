"""hash_grid(x, table0, table1, ..., base, finest): Mueller et al. 2022, equations 1 to 4, N rounded to the nearest whole number.

Level l of L has N = round(base (finest / base)^(l / (L - 1))) cells along an edge. A point lies in the cell floor(x N), the last one
closed; its features are the trilinear mean of the entries at the cell's corners. At faces the derivative is that of this cell.
"""

import itertools

import numpy as np
import torch

from . import reals
from .fixture import Case, Draw

NAME, PURPOSE = "hash_grid", 1131
DIFFERENTIABLE = ("x", "table*")
PRIMES = (1, 2654435761, 805459861)


def cases():
    """Dense, hashed and colliding levels, and the row PE6 of the hard cases."""
    yield random("dense", 12, (5, 5), [216], 2, "one level, every vertex with its own entry")
    yield random("hashed", 12, (11, 11), [64], 2, "one level whose vertices share entries")
    yield random("three-levels", 16, (3, 25), [64, 64, 64], 2, "3, 8.66 and 25 cells: the second has 9")
    yield random("usual", 16, (4, 61), [125, 128, 128, 128], 2, "one dense and three hashed levels")
    yield random("collisions", 24, (7, 9), [8, 8], 1, "corners of one cell collide, gradients add up")
    faces = np.array([[0.25, 0.3, 0.4], [0.7, 0.5, 0.75], [0.25, 0.5, 0.75], [0.0, 0.1, 1.0], [1.0, 0.75, 0.2], [1, 1, 1], [0, 0, 0]])
    yield case("faces-PE6", faces, (4, 8), [125, 128], 2, "faces, edges, vertices: the derivative is that of the cell above")
    yield random("switch-PE6", 8, (3, 4), [64, 64], 1, "4^3 vertices are just dense in 64 entries, 5^3 are not")


def random(name, points, shape, entries, features, comment):
    """Uniform points."""
    return case(name, Draw(PURPOSE, name).uniform((points, 3)), shape, entries, features, comment)


def case(name, x, shape, entries, features, comment):
    """A case from its points, (base, finest) and the tables' sizes; their entries are uniform."""
    draw = Draw(PURPOSE, f"{name} tables")
    tables = {f"table{n}": draw.uniform((size, features), -1.0, 1.0) for n, size in enumerate(entries)}
    return Case(name, {"x": x, "base": np.float64(shape[0]), "finest": np.float64(shape[1])} | tables, comment)


def resolutions(base, finest, levels):
    """N of every level, at 50 digits."""
    exact = [base * (reals.mpf(finest) / base) ** (reals.mpf(n) / max(levels - 1, 1)) for n in range(levels)]
    assert all(abs(n - reals.mp.floor(n) - 0.5) > 1e-3 for n in exact), "a resolution between two whole numbers"
    return [int(reals.mp.nint(n)) for n in exact]


def index(vertex, side, size):
    """The entry of a vertex (integers or arrays of them)."""
    x, y, z = vertex
    if side**3 <= size:
        return x + side * (y + side * z)
    return ((x * PRIMES[0]) ^ (y * PRIMES[1]) ^ (z * PRIMES[2])) % size


def tables_of(x):
    """table0, table1, ..."""
    return [x[f"table{n}"] for n in range(sum(name.startswith("table") for name in x))]


def over_reals(x):
    """The definition."""
    tables = tables_of(x)
    sizes = resolutions(int(x["base"].item().value), int(x["finest"].item().value), len(tables))
    return {"encoding": np.array([encoded(point, tables, sizes) for point in x["x"]], dtype=object)}


def encoded(point, tables, sizes):
    """All features of one point."""
    row = []
    for table, n in zip(tables, sizes):
        cells, fractions = [], []
        for coordinate in point:
            cells.append(min(int(reals.mp.floor(coordinate.value * n)), n - 1))
            fractions.append(coordinate * n - cells[-1])
        weights, entries = [], []
        for upper in itertools.product((0, 1), repeat=3):
            a, b, c = [f if up else 1 - f for f, up in zip(fractions, upper)]
            weights.append(a * b * c)
            entries.append(table[index([cell + up for cell, up in zip(cells, upper)], n + 1, len(table))])
        row += [reals.dot(weights, [entry[f] for entry in entries]) for f in range(table.shape[1])]
    return row


def in_torch(x):
    """All points of a level at once; the gradient is autograd's."""
    tables = tables_of(x)
    columns = []
    for table, n in zip(tables, resolutions(int(x["base"]), int(x["finest"]), len(tables))):
        scaled = x["x"] * n
        cells = torch.clamp(torch.floor(scaled.detach()), max=n - 1)
        fractions, cells = scaled - cells, cells.long()
        total = 0
        for upper in itertools.product((0, 1), repeat=3):
            sides = [fractions[:, a] if up else 1 - fractions[:, a] for a, up in enumerate(upper)]
            at = index([cells[:, a] + up for a, up in enumerate(upper)], n + 1, len(table))
            total = total + (sides[0] * sides[1] * sides[2])[:, None] * table[at]
        columns.append(total)
    return {"encoding": torch.cat(columns, 1)}
