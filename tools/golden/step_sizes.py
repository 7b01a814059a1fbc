"""step_sizes(t, near, far): (far - near) / N for every sample; by convention differences t_{i+1} - t_i with a stated last one."""

import numpy as np
import torch
from kornia.nerf.samplers import calc_ray_t_vals
from kornia.nerf.volume_renderer import IrregularRenderer

from .fixture import Case, Draw
from .reals import Real

NAME, PURPOSE = "step_sizes", 1006
DIFFERENTIABLE = KORNIA_DIFFERENTIABLE = ()
DIFFERENCES = {"delta": "differences"}


def cases():
    """The profile's constant width, and differences with each common last step."""
    draw = Draw(PURPOSE, "t")
    t = 2.0 + (np.arange(6) + draw.uniform((3, 6))) * 0.625
    inputs = {"t": t, "near": 2.0, "far": 5.75}
    yield Case("width", inputs, "constant width, whatever t is")
    yield Case("thirds", {"t": np.array([[0.25, 0.5, 0.75]]), "near": 0.0, "far": 1.0}, "1/3, rounded once")
    yield Case("to-far", inputs, "differences, the last one to far", conventions=DIFFERENCES | {"last_delta": "to_far"})
    yield Case("1e10", inputs, "differences, the last one 1e10", conventions=DIFFERENCES | {"last_delta": "1e10"})


def kornia_cases():
    """The spacing that IrregularRenderer works with."""
    t = np.concatenate([np.zeros((2, 1)), np.cumsum(Draw(PURPOSE, "kornia").uniform((2, 5), 0.05, 1.0), axis=1)], axis=1)
    comment = "calc_ray_t_vals and IrregularRenderer: differences, the last one 1e10"
    yield Case("irregular", {"t": t, "near": 0.0, "far": 6.0}, comment, conventions=DIFFERENCES | {"last_delta": "1e10"})


def over_reals(x):
    """The definition; the conventions are told apart by `last` alone."""
    near, far, t = x["near"].item(), x["far"].item(), x["t"]
    if x["conventions"].get("delta") != "differences":
        width = (far - near) / t.shape[1]
        return {"deltas": np.full(t.shape, width, dtype=object)}
    last = [far - row[-1] if x["conventions"]["last_delta"] == "to_far" else Real(10**10) for row in t]
    deltas = [[b - a for a, b in zip(row, row[1:])] + [end] for row, end in zip(t, last)]
    return {"deltas": np.array(deltas, dtype=object)}


def in_torch(x):
    """The same on whole tensors."""
    t = x["t"]
    if x["conventions"].get("delta") != "differences":
        return {"deltas": ((x["far"] - x["near"]) / t.shape[1]).expand(t.shape)}
    to_far = x["conventions"]["last_delta"] == "to_far"
    last = x["far"] - t[:, -1:] if to_far else torch.full_like(t[:, :1], 1e10)
    return {"deltas": torch.cat([t[:, 1:] - t[:, :-1], last], -1)}


def in_kornia(x):
    """kornia.nerf.samplers.calc_ray_t_vals on points along an axis, then the renderer's own two lines."""
    points = torch.nn.functional.pad(x["t"][..., None], (0, 2))
    t = calc_ray_t_vals(points)
    far = torch.full_like(t[..., :1], IrregularRenderer._huge)
    return {"deltas": torch.cat([t[..., 1:] - t[..., :-1], far], -1)}
