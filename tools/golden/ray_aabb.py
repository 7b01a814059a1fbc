"""ray_aabb(rays_o, rays_d, low, high, near, far): the part of [near, far] in which o + t d lies in the closed box; far, far, 0 on a miss."""

import numpy as np
import torch

from .fixture import Case, Draw
from .reals import Real

NAME, PURPOSE = "ray_aabb", 1122
DIFFERENTIABLE = ("rays_o", "rays_d")
LOW, HIGH = np.array([-1.0, -2.0, 0.5]), np.array([1.0, 0.5, 3.0])


def cases():
    """Random rays, origins inside, near and far inside the box, and the rows CG1 and CG2 of the hard cases."""
    draw = Draw(PURPOSE, "random")
    o, inside = draw.uniform((8, 3), -9.0, 9.0), LOW + (HIGH - LOW) * draw.uniform((8, 3), 0.2, 0.8)
    d = (inside - o) * draw.uniform((8, 1), 0.1, 2.0)
    yield case("hits", o, d, LOW, HIGH, 0.0, 64.0, "from outside, directions of any length")
    yield case("behind", np.concatenate([o, o[:3]]), np.concatenate([d, -d[:3]]), LOW, HIGH, 0.0, 64.0, "three boxes behind")
    yield case("inside", inside, d, LOW, HIGH, 0.0, 64.0, "entered at near")
    yield case("line", o[:3], d[:3], LOW, HIGH, -64.0, 64.0, "near far behind the origin")
    unit = np.zeros(3), np.ones(3)
    cut = np.array([[-1.0, 0.5, 0.4], [-1.0, 0.2, 0.5]]), np.array([[1.0, 0.125, 0.1], [2.1, 0.1, 0.125]])
    yield case("cut", *cut, *unit, 1.25, 1.3, "near and far inside the box")
    faces = np.array([[0.0, 0.5, -1.0], [1.0, 0.5, -1.0], [1.0, 1.0, -1.0], [-(2.0**-60), 0.5, -1.0], [0.5, 1 + 2.0**-52, -1.0]])
    up = np.broadcast_to([0.0, 0.0, 1.0], faces.shape)
    yield case("faces-CG1", faces, up, *unit, 0.0, 8.0, "in faces and edges of the closed box, and just beside", vjp=False)
    tiny = np.array([[-1e-6, 0.0, 0.0], [-1e-6, 0.0, 1.0]])
    yield case("tiny-CG2", np.array([[2.0, 0.5, 0.5], [0.5, 0.3, -1.0]]), tiny, *unit, 0.0, 4e6, "d = -1e-6")


def case(name, o, d, low, high, near, far, comment, vjp=True):
    """A case from its arrays."""
    inputs = {"rays_o": o, "rays_d": d, "low": low, "high": high, "near": near, "far": far}
    return Case(name, inputs, comment, vjp=vjp)


def over_reals(x):
    """The definition: the largest entry and the smallest exit."""
    near, far = x["near"].item(), x["far"].item()
    out = {name: np.empty(len(x["rays_o"]), object) for name in ("t_near", "t_far", "hit")}
    for r, (o, d) in enumerate(zip(x["rays_o"], x["rays_d"])):
        enter, leave, beside = near, far, False
        for a in range(3):
            low, high = x["low"][a], x["high"][a]
            if d[a].value == 0:
                beside |= not low.value <= o[a].value <= high.value
                continue
            first, last = (low - o[a]) / d[a], (high - o[a]) / d[a]
            first, last = (first, last) if d[a].value > 0 else (last, first)
            enter = first if first.value > enter.value else enter
            leave = last if last.value < leave.value else leave
        hit = not beside and enter.value <= leave.value
        row = (enter, leave, Real(1)) if hit else (far, far, Real(0))
        out["t_near"][r], out["t_far"][r], out["hit"][r] = row
    return out


def in_torch(x):
    """The same on whole tensors; the division sees 1 where d is 0."""
    o, d, near, far = x["rays_o"], x["rays_d"], x["near"], x["far"]
    flat = d == 0.0
    whole = torch.where(flat, 1.0, d)
    a, b = (x["low"] - o) / whole, (x["high"] - o) / whole
    inside = ((x["low"] <= o) & (o <= x["high"]) | ~flat).all(-1)
    enter = torch.where(flat, -torch.inf, torch.minimum(a, b)).amax(-1).maximum(near)
    leave = torch.where(flat, torch.inf, torch.maximum(a, b)).amin(-1).minimum(far)
    hit = inside & (enter <= leave)
    return {"t_near": torch.where(hit, enter, far), "t_far": torch.where(hit, leave, far), "hit": hit * torch.ones_like(enter)}
