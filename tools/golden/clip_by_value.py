"""clip_by_value(g, limit): each number clipped to [-limit, limit]."""

import numpy as np
import torch

from .fixture import Case, Draw

NAME, PURPOSE = "clip_by_value", 1345
DIFFERENTIABLE = ()


def cases():
    """Inside and beyond, at the limit and at its neighbors."""
    yield case("batch", Draw(PURPOSE, "batch").uniform((6, 4), -1.0, 1.0), 0.3, "some of them beyond")
    yield case("inside", Draw(PURPOSE, "inside").uniform((3, 2, 2), -1.0, 1.0), 2.0, "all inside")
    beside = np.array([np.nextafter(0.3, 0.0), 0.3, np.nextafter(0.3, 1.0), 0.0, 1e300])
    yield case("limit", np.concatenate([beside, -beside]), 0.3, "the limit and its neighbors")


def case(name, gradient, limit, comment):
    """A case from its array."""
    return Case(name, {"g": gradient, "limit": np.array(limit)}, comment)


def over_reals(x):
    """The definition."""
    limit, out = x["limit"][()], np.empty(x["g"].shape, object)
    for index in np.ndindex(out.shape):
        g = x["g"][index]
        out[index] = limit if g.value > limit.value else -limit if g.value < -limit.value else g
    return {"g_out": out}


def in_torch(x):
    """torch's own function."""
    parameter = torch.nn.Parameter(torch.zeros_like(x["g"]))
    parameter.grad = x["g"].clone()
    torch.nn.utils.clip_grad_value_([parameter], float(x["limit"]))
    return {"g_out": parameter.grad}
