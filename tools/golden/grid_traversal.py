"""grid_traversal(rays_o, rays_d, near, far, resolution): how long a ray stays in each cell of the unit box, and in how many it is.

A cell is [i, i+1) / R in each axis; the outermost ones take what lies beside the box. Each cell is one box of its own: nothing is stepped.
"""

import numpy as np
import torch

from . import reals
from .fixture import Case, Draw
from .reals import Real

NAME, PURPOSE = "grid_traversal", 1124
DIFFERENTIABLE = ()


def cases():
    """Rays from place to place, along axes, and from a face of the box (CG3)."""
    for resolution in (1, 3, 4):
        draw = Draw(PURPOSE, f"through-{resolution}")
        o = draw.uniform((4, 3))
        yield case(f"through-{resolution}", o, (draw.uniform((4, 3)) - o) * 2.0, 0.1, 0.4, resolution, "from place to place")
    axes = np.array([[0.0, 0.3, 0.7], [0.3, 1.0, 0.1]]), np.array([[1.0, 0.0, 0.0], [0.0, -1.3, 0.2]])
    yield case("axes", *axes, 0.0, 0.7, 4, "directions with zeros")
    faces = np.array([[1.0, 0.0, 0.0]] * 3), np.array([[-1.0, -1e-16, 0.0], [-1.0, 0.0, 0.0], [-1.0, 1e-16, 0.0]])
    yield case("face-CG3", *faces, 0.0, 1.0, 8, "nerfacc#265: all 8 cells")


def case(name, o, d, near, far, resolution, comment):
    """A case from its arrays."""
    inputs = {"rays_o": o, "rays_d": d, "near": near, "far": far, "resolution": np.float64(resolution)}
    return Case(name, inputs, comment)


def over_reals(x):
    """Every cell's box."""
    near, far, n = x["near"].item(), x["far"].item(), int(x["resolution"].item().value)
    lengths = np.empty((len(x["rays_o"]), n, n, n), object)
    for r, k, j, i in np.ndindex(lengths.shape):
        enter, leave = near, far
        for o, d, cell in zip(x["rays_o"][r], x["rays_d"][r], (i, j, k)):
            if d.value == 0:
                inside = (cell == 0 or o.value >= reals.mpf(cell) / n) and (cell == n - 1 or o.value < reals.mpf(cell + 1) / n)
                leave = leave if inside else near
                continue
            faces = [(Real(c) / n - o) / d if 0 < c < n else None for c in (cell, cell + 1)]
            first, last = faces if d.value > 0 else reversed(faces)
            enter = first if first is not None and first.value > enter.value else enter
            leave = last if last is not None and last.value < leave.value else leave
        lengths[r, k, j, i] = leave - enter if leave.value > enter.value else Real(0)
    counts = [Real(sum(length.value > 0 for length in ray.flat)) for ray in lengths]
    return {"lengths": lengths, "visited": np.array(counts, object)}


def in_torch(x):
    """The same for all cells at once."""
    n = int(x["resolution"])
    o, d = x["rays_o"][:, None], x["rays_d"][:, None]
    faces = torch.arange(n + 1)[:, None] / n
    whole = torch.where(d == 0.0, 1.0, d)
    t = (faces - o) / whole
    t[:, 0], t[:, n] = -torch.inf * d.sign()[:, 0], torch.inf * d.sign()[:, 0]
    first, last = torch.minimum(t[:, :-1], t[:, 1:]), torch.maximum(t[:, :-1], t[:, 1:])
    low, high = faces[:-1].expand(n, 3).clone(), faces[1:].expand(n, 3).clone()
    low[0], high[-1] = -torch.inf, torch.inf
    inside = (low <= o) & (o < high)
    first = torch.where(d == 0.0, torch.where(inside, -torch.inf, torch.inf), first)
    last = torch.where(d == 0.0, torch.where(inside, torch.inf, -torch.inf), last)

    def cube(s):
        return s[:, None, None, :, 0], s[:, None, :, None, 1], s[:, :, None, None, 2]

    ex, ey, ez = cube(first)
    lx, ly, lz = cube(last)
    enter, leave = ex.maximum(ey).maximum(ez).maximum(x["near"]), lx.minimum(ly).minimum(lz).minimum(x["far"])
    lengths = (leave - enter).clamp(min=0.0)
    return {"lengths": lengths, "visited": (lengths > 0).sum((1, 2, 3)).double()}
