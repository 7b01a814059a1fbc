"""clip_by_global_norm(g_weights, g_bias, max_norm): times min(1, max_norm / norm), of all numbers together."""

import numpy as np
import torch

from . import reals
from .fixture import Case, Draw

NAME, PURPOSE = "clip_by_global_norm", 1344
DIFFERENTIABLE = ()
EPS = {"none": 0.0, "1e-7": 1e-7, "float32": 2.0**-23, "1e-6": 1e-6}


def cases():
    """Above and below the limit, whole numbers, small gradients with what is added to their norm, and none."""
    for name, most in (("long", 0.3), ("short", 7.0)):
        draw = Draw(PURPOSE, name)
        yield case(name, draw.uniform((5, 3), -1.0, 1.0), draw.uniform((5,), -1.0, 1.0), most, f"{name} ones")
    yield case("thirteen", np.array([[3.0, -4.0]]), np.array([12.0]), 6.5, "a norm of 13")
    for eps in EPS:
        draw = Draw(PURPOSE, "small")
        weights, bias = draw.uniform((2, 3), -1e-5, 1e-5), draw.uniform((2,), -1e-5, 1e-5)
        conventions = {} if eps == "none" else {"clip_eps": eps}
        yield case(f"small-{eps}", weights, bias, 5e-6, "what is added to the norm shows", conventions)
    draw = Draw(PURPOSE, "torch")
    weights, bias = draw.uniform((4, 6), -1.0, 1.0), draw.uniform((4,), -1.0, 1.0)
    yield case("torch", weights, bias, 1.0, "as PyTorch has it", {"clip_eps": "1e-6"})
    yield case("nothing", np.zeros((2, 2)), np.zeros(2), 1.0, "no gradient")


def case(name, weights, bias, most, comment, conventions=None):
    """A case from its arrays."""
    inputs = {"g_weights": weights, "g_bias": bias, "max_norm": np.array(most)}
    return Case(name, inputs, comment, conventions=conventions or {})


def eps_of(x):
    """What is added to the norm."""
    return EPS[x["conventions"].get("clip_eps", "none")]


def over_reals(x):
    """The definition."""
    weights, bias, most = x["g_weights"], x["g_bias"], x["max_norm"][()]
    squares = reals.total([g * g for g in [*weights.reshape(-1), *bias]])
    norm = reals.sqrt(squares) if squares.value else squares
    under = reals.total([norm, reals.Real(eps_of(x))]) if eps_of(x) else norm
    out = {"norm": np.array(norm, dtype=object), "g_weights_out": weights, "g_bias_out": bias}
    if under.value > most.value:
        scale = most / under
        out |= {"g_weights_out": weights * scale, "g_bias_out": bias * scale}
    return out


def in_torch(x):
    """torch's own function, which adds 1e-6; the others by norms of norms."""
    weights, bias, most = x["g_weights"], x["g_bias"], float(x["max_norm"])
    if eps_of(x) == 1e-6:
        parameters = [torch.nn.Parameter(torch.zeros_like(g)) for g in (weights, bias)]
        for parameter, g in zip(parameters, (weights, bias)):
            parameter.grad = g.clone()
        norm = torch.nn.utils.clip_grad_norm_(parameters, most)
        return {"g_weights_out": parameters[0].grad, "g_bias_out": parameters[1].grad, "norm": norm}
    norm = torch.hypot(torch.linalg.vector_norm(weights), torch.linalg.vector_norm(bias))
    scale = torch.clamp(most / (norm + eps_of(x)), max=1.0)
    return {"g_weights_out": weights * scale, "g_bias_out": bias * scale, "norm": norm}
