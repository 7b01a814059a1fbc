"""Twenty steps of Adam on eight parameters, the gradients given: adam_step, one after the other."""

import numpy as np
import torch

from . import adam_step
from .fixture import Case, Draw

NAME, PURPOSE = "adam", 1102
DIFFERENTIABLE = ()
STEPS = 20


def cases():
    """torch's defaults, a small beta2 with a large eps, and coupled weight decay."""
    yield case("defaults", {}, "lr 5e-4, betas .9 and .999, eps 1e-8")
    yield case("other-betas", {"lr": 0.0625, "beta1": 0.5, "beta2": 0.75, "eps": 1e-3}, "short memory, large eps")
    yield case("weight-decay", {"weight_decay": 0.125, "lr": 0.01}, "coupled weight decay")


def case(name, changes, comment):
    """Gradients of a wide range of sizes, one parameter that has none."""
    draw = Draw(PURPOSE, name)
    grads = draw.uniform((STEPS, 8), -1.0, 1.0) * np.array([1.0, 0.1, 1e-3, 1e-6, 1e3, 1.0, 1.0, 1.0])
    grads[:, 7] = 0.0
    inputs = {"params": draw.uniform((8,), -1.0, 1.0), "grads": grads}
    return Case(name, inputs | adam_step.DEFAULTS | changes, comment)


def run(x, one_step, zeros):
    """The parameters behind every step."""
    state = {"params": x["params"], "m": zeros, "v": zeros}
    history = []
    settings = {name: x[name] for name in adam_step.DEFAULTS}
    for step, grad in enumerate(x["grads"], start=1):
        out = one_step(state | settings | {"grad": grad, "step": step})
        state = {"params": out["params_out"], "m": out["m_out"], "v": out["v_out"]}
        history.append(state["params"])
    return history


def over_reals(x):
    """adam_step over the reals, nothing rounded in between."""
    zeros = adam_step.reals.lift(np.zeros(8))
    history = run(x, lambda y: adam_step.over_reals(y | {"step": adam_step.reals.lift(y["step"])}), zeros)
    return {"params_out": np.array(history, dtype=object)}


def in_torch(x):
    """torch.optim.Adam with its own state."""
    params = torch.nn.Parameter(x["params"].clone())
    settings = {name: x[name].item() for name in adam_step.DEFAULTS}
    betas = settings.pop("beta1"), settings.pop("beta2")
    optimizer = torch.optim.Adam([params], betas=betas, **settings)
    history = []
    for grad in x["grads"]:
        params.grad = grad.clone()
        optimizer.step()
        history.append(params.detach().clone())
    return {"params_out": torch.stack(history)}
