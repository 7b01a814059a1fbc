"""lr_exponential(step, decay_steps, lr_init, decay): lr_init decay^(step / decay_steps), as bmild/nerf's run_nerf.py has it."""

import numpy as np
import torch

from . import reals
from .fixture import Case

NAME, PURPOSE = "lr_exponential", 1341
DIFFERENTIABLE = ()


def cases():
    """Both ends, the middle, what is after the end, and a factor of each step."""
    yield case("begin", 0, 10, 0.5, 0.1, "the first rate")
    yield case("seventh", 7, 23, 0.3, 0.3, "no round numbers")
    yield case("end", 10, 10, 0.75, 0.1, "the whole decay")
    yield case("beyond", 25, 10, 0.75, 0.25, "it goes on")
    yield case("held", 25, 10, 0.75, 0.2, "it is held", {"rate_end": "held"})
    yield case("each-step", 7, 1, 0.5, 0.9, "a factor a step")
    yield case("paper", 20_000, 250_000, 5e-4, 0.1, "NeRF's")


def case(name, step, decay_steps, lr_init, decay, comment, conventions=None):
    """A case from its scalars."""
    scalars = {"step": step, "decay_steps": decay_steps, "lr_init": lr_init, "decay": decay}
    return Case(name, {n: np.array(float(x)) for n, x in scalars.items()}, comment, conventions=conventions or {})


def taken(x):
    """The steps that count."""
    step, steps = (float(x[name].item()) for name in ("step", "decay_steps"))
    return min(step, steps) if x["conventions"].get("rate_end") == "held" else step


def over_reals(x):
    """The definition: e to the logarithm times the part of the way."""
    lr, decay, steps = (x[name].item() for name in ("lr_init", "decay", "decay_steps"))
    step = x["step"].item()
    if x["conventions"].get("rate_end") == "held" and step.value > steps.value:
        step = steps
    t = step / steps
    value = decay.value**t.value
    # The slope by t is that of e^(t ln decay); by decay it is less than the power's own rounding.
    logarithm = reals.mpmath.log(decay.value)
    power = t.function(value, value * logarithm, value * logarithm**2)
    return {"rate": np.array(lr * power, dtype=object)}


def in_torch(x):
    """torch's own scheduler, stepped; its factor is that of one step. Of long schedules the power, as each step rounds."""
    lr, decay, steps = (float(x[name].item()) for name in ("lr_init", "decay", "decay_steps"))
    if taken(x) > 100:
        return {"rate": x["lr_init"] * torch.pow(x["decay"], taken(x) / steps)}
    optimizer = torch.optim.SGD([torch.nn.Parameter(torch.zeros(1))], lr=lr)
    scheduler = torch.optim.lr_scheduler.ExponentialLR(optimizer, gamma=decay ** (1 / steps))
    for _ in range(int(taken(x))):
        optimizer.step()
        scheduler.step()
    return {"rate": torch.tensor(scheduler.get_last_lr()[0])}
