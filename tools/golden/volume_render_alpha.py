"""volume_render_alpha(alphas, rgbs): T_i = prod_{j<i} (1 - alpha_j), w_i = T_i alpha_i; sums as in volume_render."""

import numpy as np
import torch

from . import reals
from .fixture import Case, Draw

NAME, PURPOSE = "volume_render_alpha", 1012
DIFFERENTIABLE = ("alphas", "rgbs")


def cases():
    """Random opacities; alpha exactly 0 and 1 (VR4, VR9)."""
    yield case("mixed", Draw(PURPOSE, "mixed-alphas").uniform((3, 12)), "opacities in [0, 1)")
    yield case("thin-VR1", Draw(PURPOSE, "thin-alphas").uniform((2, 16), 0.0, 1e-9), "opacities below 1e-9")
    yield case("long", Draw(PURPOSE, "long-alphas").uniform((1, 128), 0.0, 0.05), "128 samples")
    yield case("long-1024", Draw(PURPOSE, "long-1024-alphas").uniform((1, 1024), 0.0, 0.02), "1,024 samples", vjp=False)
    comment = "alpha exactly 1: a gradient by dividing through 1 - alpha is 0 or NaN there"
    # Cotangents of T are alpha_i times those of w: (1, 2, 3, 4), for which dT/d(1 - alpha) is (2, 2.9, 0, 0).
    vr4 = {"weights": np.array([[2.0, 2.0, 10.0, 20.0]]), "colors": np.zeros((1, 3))}
    vr4 |= {"opacity": np.zeros(1), "transmittance": np.zeros(1)}
    yield case("opaque-VR4", np.array([[0.5, 1.0, 0.3, 0.2]]), comment, cotangents=vr4)
    ends = np.array([[1.0, 1.0, 1.0], [0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 1.0]])
    yield case("zeros-and-ones-VR4", ends, "only 0 and 1")
    yield case("one-sample-VR9", np.array([[0.3], [1.0]]), "one sample")
    yield case("no-samples-VR9", np.zeros((2, 0)), "no samples: black, T = 1")
    yield case("underflow-VR9", np.array([[1 - 2.0**-53] * 22]), "T falls through the subnormals to 0 in steps of 2^-53")


def case(name, alphas, comment, **more):
    """Random colors to given opacities."""
    return Case(name, {"alphas": alphas, "rgbs": Draw(PURPOSE, name).uniform((*alphas.shape, 3))}, comment, **more)


def over_reals(x):
    """The definition, ray by ray."""
    rays, samples = x["alphas"].shape
    out = {"colors": np.empty((rays, 3), object), "weights": np.empty((rays, samples), object)}
    out |= {"opacity": np.empty(rays, object), "transmittance": np.empty(rays, object)}
    for r in range(rays):
        transmittance = reals.Real(1)
        for i in range(samples):
            out["weights"][r, i] = transmittance * x["alphas"][r, i]
            transmittance = transmittance * (1 - x["alphas"][r, i])
        for c in range(3):
            out["colors"][r, c] = reals.dot(out["weights"][r], x["rgbs"][r, :, c])
        out["opacity"][r] = reals.total(out["weights"][r])
        out["transmittance"][r] = transmittance
    return out


def in_torch(x):
    """cumprod, whose backward torch computes without dividing by zeros."""
    alphas = x["alphas"]
    products = torch.cumprod(torch.nn.functional.pad(1.0 - alphas, (1, 0), value=1.0), -1)
    weights = products[:, :-1] * alphas
    colors = (weights[..., None] * x["rgbs"]).sum(-2)
    return {"colors": colors, "weights": weights, "opacity": weights.sum(-1), "transmittance": products[:, -1]}
