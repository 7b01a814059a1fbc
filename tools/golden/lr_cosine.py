"""lr_cosine(step, max_steps, lr_init, lr_final, warmup_steps): a linear warm-up, then half of a cosine."""

import numpy as np
import torch

from . import reals
from .fixture import Case

NAME, PURPOSE = "lr_cosine", 1342
DIFFERENTIABLE = ()
NAMES = ("step", "max_steps", "lr_init", "lr_final", "warmup_steps")


def cases():
    """Both ends, the middle, what is after the end; in and after a warm-up."""
    yield case("begin", (0, 100, 0.5, 0.01, 0), "the first rate")
    yield case("seventh", (7, 23, 0.3, 0.07, 0), "no round numbers")
    yield case("middle", (50, 100, 0.7, 0.1, 0), "the mean of both")
    yield case("late", (99, 100, 0.7, 0.0, 0), "nearly nothing")
    yield case("end", (100, 100, 0.7, 0.1, 0), "the last rate")
    yield case("beyond", (130, 100, 0.7, 0.1, 0), "it rises again")
    yield case("held", (130, 100, 0.7, 0.1, 0), "it is held", {"rate_end": "held"})
    yield case("warming", (37, 1000, 0.7, 0.1, 120), "in the warm-up")
    yield case("warm", (120, 1000, 0.7, 0.1, 120), "its end")
    yield case("after", (371, 1000, 0.7, 0.1, 120), "after it")
    yield case("usual", (100_000, 300_000, 5e-4, 2.5e-5, 5000), "NeuS")


def case(name, scalars, comment, conventions=None):
    """A case from its scalars."""
    return Case(name, {n: np.array(float(x)) for n, x in zip(NAMES, scalars)}, comment, conventions=conventions or {})


def over_reals(x):
    """The definition."""
    step, most, first, last, warmup = (x[name].item() for name in NAMES)
    if step.value < warmup.value:
        return {"rate": np.array(first * (step / warmup), dtype=object)}
    if x["conventions"].get("rate_end") == "held" and step.value > most.value:
        step = most
    p = (step - warmup) / (most - warmup)
    half = reals.total([reals.Real(1), reals.cos_pi(p, 1)]) * 0.5
    return {"rate": np.array(reals.total([last, (first - last) * half]), dtype=object)}


def in_torch(x):
    """torch's own scheduler, stepped, after the warm-up; in it an interpolation."""
    step, most, first, last, warmup = (float(x[name].item()) for name in NAMES)
    if step < warmup:
        return {"rate": torch.lerp(torch.tensor(0.0), torch.tensor(first), step / warmup)}
    if x["conventions"].get("rate_end") == "held":
        step = min(step, most)
    if step - warmup > 500:
        # Of long schedules the formula, as each step rounds.
        angle = x["max_steps"].new_tensor(torch.pi * (step - warmup) / (most - warmup))
        return {"rate": torch.lerp(x["lr_final"], x["lr_init"], (1 + torch.cos(angle)) / 2)}
    optimizer = torch.optim.SGD([torch.nn.Parameter(torch.zeros(1))], lr=first)
    scheduler = torch.optim.lr_scheduler.CosineAnnealingLR(optimizer, T_max=int(most - warmup), eta_min=last)
    for _ in range(int(step - warmup)):
        optimizer.step()
        scheduler.step()
    return {"rate": torch.tensor(scheduler.get_last_lr()[0])}
