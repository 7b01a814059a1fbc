"""unscale_gradients(gradients, scale): g / scale, and whether one of them isn't finite."""

import math

import numpy as np
import torch

from . import reals
from .fixture import Case, Draw

NAME, PURPOSE = "unscale_gradients", 1362
DIFFERENTIABLE = ()


def cases():
    """Powers of two, whose inverses torch's f32 has exactly, and others. Overflows are no numbers that a fixture holds."""
    for scale in (1024.0, 65536.0, 0.25):
        g = Draw(PURPOSE, f"g-{scale:g}").uniform((16,), -100.0, 100.0)
        yield case(f"scale-{scale:g}", g.astype(np.float32), scale, "a power of two, in torch's own kernel")
    for scale in (1000.3, 0.37):
        yield case(f"scale-{scale:g}", Draw(PURPOSE, f"g-{scale:g}").uniform((64,), -100.0, 100.0), scale, "no power of two")


def case(name, gradients, scale, comment):
    """A case from gradients."""
    return Case(name, {"gradients": gradients.astype(np.float64), "scale": np.array(scale)}, comment)


def over_reals(x):
    """The definition, of numbers that are finite."""
    scale = x["scale"].item()
    unscaled = [g / scale for g in x["gradients"]]
    return {"found_inf": np.array(reals.real(0), dtype=object), "unscaled": np.array(unscaled, dtype=object)}


def in_torch(x):
    """torch's own kernel, which GradScaler.unscale_ calls, where f32 has the inverse; elsewhere a division in f64."""
    scale, found = float(x["scale"]), torch.zeros(1, dtype=torch.float32)
    if math.frexp(scale)[0] != 0.5:
        return {"found_inf": found.double()[0], "unscaled": x["gradients"] / scale}
    g, inverse = x["gradients"].float(), torch.tensor(scale).double().reciprocal().float()
    torch._amp_foreach_non_finite_check_and_unscale_([g], found, inverse)
    return {"found_inf": found.double()[0], "unscaled": g.double()}
