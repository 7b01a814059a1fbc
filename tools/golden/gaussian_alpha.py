"""gaussian_alpha(pixels, means2d, conics, opacities): min(cap, opacity e^power) (Kerbl et al. 2023, equations 3 and 4)."""

import numpy as np
import torch

from . import reals
from .fixture import Case, Draw

NAME, PURPOSE = "gaussian_alpha", 1307
DIFFERENTIABLE = ("means2d", "conics", "opacities")
CAPS = {"none": float("inf"), "0.99": 0.99, "0.999": 0.999}
DEFAULTS = {"alpha_cap": "none", "faint": "kept", "positive_power": "kept", "cap_gradient": "stopped"}


def cases():
    """Around splats, opaque and faint ones, in the cuts of either code base; needles, and conics that aren't positive."""
    inria = {"alpha_cap": "0.99", "faint": "skipped", "positive_power": "skipped"}
    for conventions in [{}, inria, inria | {"alpha_cap": "0.999"}]:
        tag = "-".join(conventions.values()) or "usual"
        yield case(f"in-{tag}", 1.0, 4.0, (0.1, 0.9), "splats of some pixels", conventions)
        yield case(f"opaque-{tag}", 20.0, 60.0, (0.98, 1.0), "opacities near 1", conventions)
        yield case(f"faint-{tag}-GS5", 2.0, 6.0, (0.0, 0.05), "opacities around 1 / 255", conventions)
        grown = case(f"growing-{tag}-GS5", 1.0, 2.0, (0.1, 0.5), "conics that aren't positive", conventions)
        grown.inputs["conics"][:, 1] = np.sqrt(grown.inputs["conics"][:, 0] * grown.inputs["conics"][:, 2]) * 1.5
        yield grown
    yield case("needles-GS2", 0.05, 20.0, (0.1, 1.0), "hairs")


def case(name, low, high, opacities, comment, conventions=None):
    """Six splats with deviations in a range, seen from five pixels."""
    deviations = Draw(PURPOSE, name).uniform((6, 2), low, high)
    share = Draw(PURPOSE, name + "b").uniform((6,), -0.9, 0.9)
    a, c = (1 / deviations**2).T
    inputs = {
        "pixels": Draw(PURPOSE, name + "p").uniform((5, 2), 0.0, 8.0),
        "means2d": Draw(PURPOSE, name + "m").uniform((6, 2), 0.0, 8.0),
        "conics": np.stack([a, share * np.sqrt(a * c), c], 1),
        "opacities": Draw(PURPOSE, name + "o").uniform((6,), *opacities),
    }
    return Case(name, inputs, comment, conventions=conventions or {})


def alpha(pixel, mean, conic, opacity, c):
    """The definition of one pair."""
    x, y = pixel[0] - mean[0], pixel[1] - mean[1]
    power = reals.total([x * x * conic[0] * -0.5, -(x * y * conic[1]), y * y * conic[2] * -0.5])
    cap = CAPS[c["alpha_cap"]]
    found = reals.exp(power) * opacity
    if found.value > cap:
        found = reals.constant(cap)
    faint = c["faint"] == "skipped" and found.value * 255 < 1
    return reals.real(0) if faint or (c["positive_power"] == "skipped" and power.value > 0) else found


def over_reals(x):
    """The definition, pair by pair."""
    c = DEFAULTS | x["conventions"]
    splats = list(zip(x["means2d"], x["conics"], x["opacities"]))
    return {"alphas": np.array([[alpha(pixel, *splat, c) for splat in splats] for pixel in x["pixels"]], dtype=object)}


def in_torch(x):
    """The exponent as d^T conic d with the conic's matrix."""
    c = DEFAULTS | x["conventions"]
    d = x["pixels"][:, None, :] - x["means2d"][None, :, :]
    conic = x["conics"][:, [0, 1, 1, 2]].view(-1, 2, 2)
    power = -0.5 * torch.einsum("pgi,gij,pgj->pg", d, conic, d)
    found = torch.clamp(x["opacities"] * torch.exp(power), max=CAPS[c["alpha_cap"]])
    if c["faint"] == "skipped":
        found = torch.where(found * 255 < 1, torch.zeros_like(found), found)
    if c["positive_power"] == "skipped":
        found = torch.where(power > 0, torch.zeros_like(found), found)
    return {"alphas": found}
