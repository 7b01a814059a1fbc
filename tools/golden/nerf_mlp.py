"""nerf_mlp: the network of Mildenhall et al. 2020, figure 7, on encoded positions and directions.

8 trunk layers with ReLU, [h, encoding] into the fifth; sigma = max(w h + b, 0); feature without activation;
rgb = sigmoid(color1 relu(color0 [feature, encoded direction])). L follows from the widths: columns = 3 + 6 L.
"""

import numpy as np
import torch
from kornia.nerf.nerf_model import MLP
from kornia.nerf.positional_encoder import PositionalEncoder

from . import reals
from .fixture import Case, Draw
from .mlp import activate, affine, layer
from .positional_encoding import encode, encode_torch

NAME, PURPOSE = "nerf_mlp", 1009
DIFFERENTIABLE = KORNIA_DIFFERENTIABLE = ("positions", "*_w", "*_b")


def cases():
    """PyTorch's initial values at width 16 (L 10 and 4) and 32 (L 2 and 1); a density head that died (TR1)."""
    yield Case("width-16", inputs("width-16", 3, 16, 10, 4), "63 and 27 columns, as in the paper")
    yield Case("width-32", inputs("width-32", 2, 32, 2, 1), "width 32, short encodings", vjp=False)
    dead = inputs("dead-TR1", 2, 16, 1, 1)
    dead["sigma_b"] = np.array([-50.0])
    yield Case("dead-TR1", dead, "sigma is 0 everywhere and its head has no gradient")
    soft = {"density": "softplus"}
    yield Case("softplus", inputs("softplus", 2, 16, 1, 1), "density by softplus", conventions=soft)


def kornia_cases():
    """kornia's encoder and trunk of two units of four layers, with the paper's heads behind them."""
    comment = "PositionalEncoder, MLP(num_units=2, num_unit_layers=4); its skip goes into the fifth layer as [h, encoding]"
    yield Case("trunk", inputs("trunk", 2, 16, 2, 1), comment, conventions={"frequency": "one"})


def inputs(name, points, width, position_levels, direction_levels):
    """Parameters, positions in [-1, 1) and directions, which are not normalized here."""
    draw = Draw(PURPOSE, name)
    position, direction = 3 + 6 * position_levels, 3 + 6 * direction_levels
    arrays = {"positions": draw.uniform((points, 3), -1.0, 1.0), "directions": draw.uniform((points, 3), -1.0, 1.0)}
    # The bias keeps the density head alive: its initial value is negative as often as not.
    return arrays | parameters(draw, width, position, direction) | {"sigma_b": np.array([0.75])}


def parameters(draw, width, position, direction):
    """All layers at PyTorch's initial values, under their names in the contract."""
    sizes = {f"trunk{n}": (width, width) for n in range(8)}
    sizes["trunk0"], sizes["trunk4"] = (position, width), (width + position, width)
    sizes |= {"sigma": (width, 1), "feature": (width, width)}
    sizes |= {"color0": (width + direction, width // 2), "color1": (width // 2, 3)}
    arrays = {}
    for name, (fan_in, fan_out) in sizes.items():
        arrays |= layer(draw, f"{name}_w", f"{name}_b", fan_in, fan_out)
    return arrays


def levels(columns):
    """L from the columns 3 + 6 L."""
    return (columns - 3) // 6


def density(conventions):
    """The density head's activation, over the reals."""
    return reals.softplus if conventions.get("density") == "softplus" else reals.relu


def over_reals(x):
    """The definition, point by point."""
    color_columns = x["color0_w"].shape[1] - x["feature_w"].shape[0]
    positions = encode(x["positions"], levels(x["trunk0_w"].shape[1]), x["conventions"])
    directions = encode(x["directions"], levels(color_columns), x["conventions"])
    sigmas, rgbs = np.empty(len(positions), object), np.empty((len(positions), 3), object)
    for m, (position, direction) in enumerate(zip(positions, directions)):
        h = position
        for n in range(8):
            h = np.concatenate([h, position]) if n == 4 else h
            h = activate(reals.relu, affine(x[f"trunk{n}_w"], x[f"trunk{n}_b"], h))
        sigmas[m] = density(x["conventions"])(affine(x["sigma_w"], x["sigma_b"], h)[0])
        feature = affine(x["feature_w"], x["feature_b"], h)
        hidden = activate(reals.relu, affine(x["color0_w"], x["color0_b"], np.concatenate([feature, direction])))
        rgbs[m] = activate(reals.sigmoid, affine(x["color1_w"], x["color1_b"], hidden))
    return {"sigmas": sigmas, "rgbs": rgbs}


def in_torch(x):
    """Batched linear layers."""
    color_columns = x["color0_w"].shape[1] - x["feature_w"].shape[0]
    position = encode_torch(x["positions"], levels(x["trunk0_w"].shape[1]))
    direction = encode_torch(x["directions"], levels(color_columns))
    h = position
    for n in range(8):
        h = torch.relu(linear(x, f"trunk{n}", torch.cat([h, position], -1) if n == 4 else h))
    activation = torch.nn.functional.softplus if x["conventions"].get("density") == "softplus" else torch.relu
    sigmas = activation(linear(x, "sigma", h))[:, 0]
    hidden = torch.relu(linear(x, "color0", torch.cat([linear(x, "feature", h), direction], -1)))
    return {"sigmas": sigmas, "rgbs": torch.sigmoid(linear(x, "color1", hidden))}


def linear(x, name, h):
    """One named layer."""
    return torch.nn.functional.linear(h, x[f"{name}_w"], x[f"{name}_b"])


def in_kornia(x):
    """kornia.nerf's encoder and MLP, their parameters put in place; heads by torch."""
    width, columns = x["feature_w"].shape[0], x["trunk0_w"].shape[1]
    direction_columns = x["color0_w"].shape[1] - width
    trunk = MLP(columns, num_units=2, num_unit_layers=4, num_hidden=width)
    names = [f"_mlp.{n}.0.{part}" for n in range(8) for part in ("weight", "bias")]
    given = [x[f"trunk{n}_{part}"] for n in range(8) for part in ("w", "b")]
    encoded = PositionalEncoder(3, levels(columns), log_space=True)(x["positions"])
    h = torch.func.functional_call(trunk, dict(zip(names, given)), encoded)
    direction = PositionalEncoder(3, levels(direction_columns), log_space=True)(x["directions"])
    hidden = torch.relu(linear(x, "color0", torch.cat([linear(x, "feature", h), direction], -1)))
    return {"sigmas": torch.relu(linear(x, "sigma", h))[:, 0], "rgbs": torch.sigmoid(linear(x, "color1", hidden))}
