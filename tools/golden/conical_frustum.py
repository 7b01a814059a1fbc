"""conical_frustum(origins, directions, radii, starts, ends): the Gaussian of a cone's piece (Barron et al. 2021, equations 7 and 8)."""

import numpy as np
import torch

from . import reals
from .fixture import Case, Draw

NAME, PURPOSE = "conical_frustum", 1324
DIFFERENTIABLE = ("origins", "directions", "radii", "starts", "ends")


def cases():
    """Usual ones, thin and empty ones, whole cones, cylinders, and what lies far away."""
    for name, starts, lengths, conventions in (
        ("usual", (0.5, 4.0), (0.1, 2.0), {}),
        ("cylinders", (0.5, 4.0), (0.1, 2.0), {"ray_shape": "cylinder"}),
        ("apex", (0.0, 0.0), (0.1, 3.0), {}),
        ("PE5-thin", (1.0, 3.0), (1e-5, 1.1e-5), {}),
        ("PE5-thinner", (1.0, 3.0), (1e-12, 2e-12), {}),
        ("PE5-empty", (1.0, 3.0), (0.0, 0.0), {}),
        ("far", (0.05, 5.0), (100.0, 1000.0), {}),
    ):
        draw = Draw(PURPOSE, name)
        t = draw.uniform((6,), *starts)
        ends = t + draw.uniform((6,), *lengths)
        o, d, r = draw.uniform((6, 3), -2.0, 2.0), draw.uniform((6, 3), -1.5, 1.5), draw.uniform((6,), 0.001, 0.5)
        inputs = {"origins": o, "directions": d, "radii": r, "starts": t, "ends": ends}
        yield Case(name, inputs, f"lengths from {lengths[0]:g} to {lengths[1]:g}", conventions=conventions)
    axes = {"origins": np.zeros((3, 3)), "directions": np.diag([1.0, -2.0, 0.5]), "radii": np.full(3, 0.25)}
    yield Case("axes", axes | {"starts": np.full(3, 0.75), "ends": np.full(3, 1.5)}, "rays along axes")


def moments(start, end, cylinder):
    """Mean, variance, and variance across over the squared radius, by the middle and half of the width."""
    middle, half = (start + end) / 2, (end - start) / 2
    mm, hh = middle * middle, half * half
    if cylinder:
        return middle, hh / 3, reals.real(1) / 4
    total = mm * 3 + hh
    mean = middle + middle * hh * 2 / total
    along = hh / 3 - hh * hh * (mm * 12 - hh) * 4 / (total * total * 15)
    return mean, along, mm / 4 + hh * 5 / 12 - hh * hh * 4 / (total * 15)


def over_reals(x):
    """The paper's form, one by one."""
    names = ("t_mean", "t_variance", "r_variance", "means", "variances")
    out = {name: [] for name in names}
    cylinder = x["conventions"].get("ray_shape") == "cylinder"
    for o, d, r, start, end in zip(*(x[name] for name in DIFFERENTIABLE)):
        mean, along, across = moments(start, end, cylinder)
        across = r * r * across
        squares = [a * a for a in d]
        length = reals.total(squares)
        beside = [squares[(i + 1) % 3] + squares[(i + 2) % 3] for i in range(3)]
        variances = [along * squares[i] + across * beside[i] / length for i in range(3)]
        for name, value in zip(names, (mean, along, across, [a + mean * b for a, b in zip(o, d)], variances)):
            out[name].append(value)
    return {name: np.array(values, dtype=object) for name, values in out.items()}


def in_torch(x):
    """The volume's integrals by Gauss's three points, exact for these polynomials; the projection as a matrix."""
    o, d, r, start, end = (x[name] for name in DIFFERENTIABLE)
    middle, half = (start + end) / 2, (end - start) / 2
    root = 0.6**0.5
    offsets = half[:, None] * torch.tensor([-root, 0.0, root])
    t = middle[:, None] + offsets
    weights = torch.tensor([5.0, 8.0, 5.0]) * (torch.ones_like(t) if x["conventions"].get("ray_shape") == "cylinder" else t * t)
    weights = weights / weights.sum(1, keepdim=True)
    shift = (weights * offsets).sum(1)
    along = (weights * (offsets - shift[:, None]) ** 2).sum(1)
    radii = r[:, None] * (torch.ones_like(t) if x["conventions"].get("ray_shape") == "cylinder" else t)
    across = (weights * radii**2 / 4).sum(1)
    unit = d / d.norm(dim=1, keepdim=True)
    projection = torch.eye(3) - unit[:, :, None] * unit[:, None, :]
    covariance = along[:, None, None] * d[:, :, None] * d[:, None, :] + across[:, None, None] * projection @ projection
    return {
        "t_mean": middle + shift,
        "t_variance": along,
        "r_variance": across,
        "means": o + (middle + shift)[:, None] * d,
        "variances": covariance.diagonal(dim1=1, dim2=2),
    }
