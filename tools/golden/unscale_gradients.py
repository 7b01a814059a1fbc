"""unscale_gradients(gradients, scale): g / scale, and whether one of them isn't finite."""

import numpy as np
import torch

from . import reals
from .fixture import Case, Draw

NAME, PURPOSE = "unscale_gradients", 1362
DIFFERENTIABLE = ()


def cases():
    """Powers of two, whose inverses torch's f32 has exactly, with overflows and without; another scale for the reals alone."""
    for scale in (1024.0, 65536.0, 0.25):
        g = Draw(PURPOSE, f"g-{scale:g}").uniform((16,), -100.0, 100.0)
        yield case(f"scale-{scale:g}", g.astype(np.float32), scale, "a power of two")
    for name, x in (("inf", np.inf), ("negative-inf", -np.inf), ("nan", np.nan)):
        g = Draw(PURPOSE, name).uniform((8,), -100.0, 100.0).astype(np.float32)
        g[3] = x
        yield case(name, g, 1024.0, "an overflow")


def case(name, gradients, scale, comment):
    """A case from gradients of f32, in which torch unscales."""
    return Case(name, {"gradients": gradients.astype(np.float64), "scale": np.array(scale)}, comment)


def over_reals(x):
    """The definition; zeros stand for the gradients of a step that is skipped."""
    found = any(not np.isfinite(float(g.value)) for g in x["gradients"])
    scale = x["scale"].item()
    unscaled = [reals.real(0) if found else g / scale for g in x["gradients"]]
    return {"found_inf": np.array(reals.real(int(found)), dtype=object), "unscaled": np.array(unscaled, dtype=object)}


def in_torch(x):
    """torch's own kernel, which GradScaler.unscale_ calls."""
    g, found = x["gradients"].float(), torch.zeros(1, dtype=torch.float32)
    inverse = torch.tensor(float(x["scale"])).double().reciprocal().float()
    torch._amp_foreach_non_finite_check_and_unscale_([g], found, inverse)
    unscaled = g.double() * 0 if found.item() else g.double()
    return {"found_inf": found.double()[0], "unscaled": torch.nan_to_num(unscaled, nan=0.0)}
