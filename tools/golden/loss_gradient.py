"""The loss of the whole pipeline and its gradient: sample_along_rays, nerf_mlp, step_sizes, volume_render, mse, and all the way back."""

import numpy as np

from . import nerf_mlp, reals, sample_along_rays, step_sizes, volume_render
from .fixture import Case, Draw

NAME, PURPOSE = "loss_gradient", 1101
DIFFERENTIABLE = ("*_w", "*_b")
OUTPUTS = ("colors", "value")
SETTINGS = {"conventions": {}, "quirks": {}}


def cases():
    """Two rays of four samples at width 16, with L of 10 and 4, and with short encodings."""
    yield Case("usual-levels", inputs("usual-levels", 2, 4, 10, 4), "63 and 27 columns", cotangents={"value": np.float64(1.0)})
    yield Case("short-levels", inputs("short-levels", 3, 6, 2, 1), "15 and 9 columns", cotangents={"value": np.float64(1.0)})


def inputs(name, rays, samples, position_levels, direction_levels):
    """Rays through the box [-1, 1]^3, a draw for every sample, colors to meet, and a network."""
    arrays = nerf_mlp.inputs(name, rays, 16, position_levels, direction_levels)
    arrays["rays_o"], arrays["rays_d"] = arrays.pop("positions"), unit(arrays.pop("directions"))
    draw = Draw(PURPOSE, name)
    return {"target": draw.uniform((rays, 3)), "u": draw.uniform((rays, samples)), "near": 0.25, "far": 2.25} | arrays


def unit(d):
    """Directions of length 1, rounded to f64."""
    return d / np.sqrt(d[:, 0] ** 2 + d[:, 1] ** 2 + d[:, 2] ** 2)[:, None]


def forward(x, basis, repeat):
    """The pipeline in one basis, `repeat(array, n)` giving n copies of every row."""
    rays, samples = x["u"].shape
    sampled = basis(sample_along_rays)(x | SETTINGS)
    points = {"positions": sampled["points"].reshape(-1, 3), "directions": repeat(x.get("directions", x["rays_d"]), samples)}
    field = basis(nerf_mlp)({name: value for name, value in x.items() if name.endswith(("_w", "_b"))} | points | SETTINGS)
    deltas = basis(step_sizes)({"t": sampled["t"], "near": x["near"], "far": x["far"]} | SETTINGS)["deltas"]
    shaped = {"sigmas": field["sigmas"].reshape(rays, samples), "rgbs": field["rgbs"].reshape(rays, samples, 3)}
    return sampled["t"], deltas, basis(volume_render)(shaped | {"deltas": deltas} | SETTINGS)["colors"]


def over_reals(x):
    """The definition."""
    return {name: y for name, y in passed_over_reals(x).items() if name in OUTPUTS}


def in_torch(x):
    """The torch counterparts of the same components."""
    return {name: y for name, y in passed_in_torch(x).items() if name in OUTPUTS}


def passed_over_reals(x):
    """Every array on the way to the loss, over the reals."""
    t, deltas, colors = forward(x, lambda component: component.over_reals, lambda rows, n: np.repeat(rows, n, axis=0))
    differences = (colors - x["target"]).reshape(-1)
    value = np.array(reals.dot(differences, differences) / len(differences), dtype=object)
    return {"t": t, "deltas": deltas, "colors": colors, "value": value}


def passed_in_torch(x):
    """The same in torch."""
    t, deltas, colors = forward(x, lambda component: component.in_torch, lambda rows, n: rows.repeat_interleave(n, 0))
    return {"t": t, "deltas": deltas, "colors": colors, "value": ((colors - x["target"]) ** 2).mean()}
