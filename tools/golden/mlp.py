"""mlp(x, w0, b0, ...): h_0 = x, z_n = w_n h_n + b_n, h_{n+1} = max(z_n, 0), y = sigmoid(z_last)."""

import math

import numpy as np
import torch
from kornia.nerf.nerf_model import MLP

from . import reals
from .fixture import Case, Draw

NAME, PURPOSE = "mlp", 1008
DIFFERENTIABLE = KORNIA_DIFFERENTIABLE = ("x", "w*", "b*")


def cases():
    """PyTorch's initial values at two sizes; a dead layer; logits at both ends of the sigmoid."""
    yield random("two-hidden", [6, 16, 16, 3], 4, "two hidden layers of 16")
    yield random("wide", [10, 32, 32, 32, 3], 2, "three hidden layers of 32")
    yield random("one-layer", [3, 2], 3, "no hidden layer")
    dead = random("dead-TR1", [3, 8, 3], 2, "every hidden unit negative: no gradient passes, y is sigmoid(b)")
    dead.inputs |= {"b0": np.full(8, -100.0)}
    yield dead
    saturated = random("saturated", [1, 3], 2, "logits near -700, 0 and 40: small y keeps its digits")
    saturated.inputs |= {"w0": np.array([[-700.0], [1e-3], [40.0]]), "b0": np.zeros(3)}
    saturated.inputs |= {"x": np.array([[1.0], [0.96875]])}
    yield saturated


def kornia_cases():
    """One unit of kornia's MLP with a sigmoid layer behind it."""
    yield random("one-unit", [6, 16, 16, 16, 3], 3, "MLP(num_units=1, num_unit_layers=3), then an affine layer and a sigmoid")


def random(name, sizes, points, comment):
    """Layers with PyTorch's default initial values, points in [-1, 1)."""
    draw = Draw(PURPOSE, name)
    inputs = {"x": draw.uniform((points, sizes[0]), -1.0, 1.0)}
    for n, (fan_in, fan_out) in enumerate(zip(sizes, sizes[1:])):
        inputs |= layer(draw, f"w{n}", f"b{n}", fan_in, fan_out)
    return Case(name, inputs, comment)


def layer(draw, w, b, fan_in, fan_out):
    """Weights and biases uniform in (-1/sqrt(fan_in), 1/sqrt(fan_in))."""
    bound = 1.0 / math.sqrt(fan_in)
    return {w: draw.uniform((fan_out, fan_in), -bound, bound), b: draw.uniform((fan_out,), -bound, bound)}


def affine(w, b, h):
    """w h + b for one point."""
    return np.array([reals.total([*(w[o] * h), b[o]]) for o in range(len(b))], dtype=object)


def activate(f, z):
    """f of every entry of a vector."""
    return np.array([f(entry) for entry in z], dtype=object)


def over_reals(x):
    """The definition, point by point."""
    layers = sum(name.startswith("w") for name in x)
    rows = []
    for h in x["x"]:
        for n in range(layers):
            z = affine(x[f"w{n}"], x[f"b{n}"], h)
            h = activate(reals.relu if n + 1 < layers else reals.sigmoid, z)
        rows.append(h)
    return {"y": np.array(rows, dtype=object)}


def in_torch(x):
    """Batched linear layers."""
    layers = sum(name.startswith("w") for name in x)
    h = x["x"]
    for n in range(layers):
        z = torch.nn.functional.linear(h, x[f"w{n}"], x[f"b{n}"])
        h = torch.relu(z) if n + 1 < layers else torch.sigmoid(z)
    return {"y": h}


def in_kornia(x):
    """kornia.nerf.nerf_model.MLP, its parameters put in place, as the hidden layers."""
    hidden = sum(name.startswith("w") for name in x) - 1
    width, columns = x["w0"].shape
    names = [f"_mlp.{n}.0.{part}" for n in range(hidden) for part in ("weight", "bias")]
    given = [x[f"{part}{n}"] for n in range(hidden) for part in ("w", "b")]
    trunk = MLP(columns, num_units=1, num_unit_layers=hidden, num_hidden=width)
    h = torch.func.functional_call(trunk, dict(zip(names, given)), x["x"])
    return {"y": torch.sigmoid(torch.nn.functional.linear(h, x[f"w{hidden}"], x[f"b{hidden}"]))}
