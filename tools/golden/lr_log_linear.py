"""lr_log_linear(step, max_steps, lr_init, lr_final, delay_steps, delay_mult): multinerf's learning_rate_decay.

m + (1 - m) sin(pi / 2 step / delay_steps) up to `delay_steps`, times e to what lies between the logarithms of both rates.
"""

import numpy as np
import torch

from . import reals
from .fixture import Case

NAME, PURPOSE = "lr_log_linear", 1343
DIFFERENTIABLE = ()
NAMES = ("step", "max_steps", "lr_init", "lr_final", "delay_steps", "delay_mult")


def cases():
    """Both ends, the middle, what is after the end; in and after a delay, in each convention."""
    yield case("begin", (0, 100, 0.5, 0.01, 0, 1), "the first rate")
    yield case("seventh", (7, 23, 0.3, 0.07, 0, 1), "no round numbers")
    yield case("end", (100, 100, 0.7, 0.1, 0, 1), "the last rate")
    yield case("beyond", (130, 100, 0.7, 0.1, 0, 1), "it stays")
    yield case("delayed-begin", (0, 100, 0.7, 0.1, 24, 0.01), "the first step of a delay")
    for tag, conventions in {
        "": {},
        "-before": {"rate_delay": "before"},
        "-even": {"rate_ramp": "linear"},
        "-before-even": {"rate_delay": "before", "rate_ramp": "linear"},
    }.items():
        yield case(f"delayed{tag}", (7, 100, 0.7, 0.1, 24, 0.05), "in a delay", conventions)
        yield case(f"after{tag}", (57, 100, 0.7, 0.1, 24, 0.05), "after it", conventions)
    yield case("usual", (128, 250_000, 2e-3, 2e-5, 512, 0.01), "multinerf's")


def case(name, scalars, comment, conventions=None):
    """A case from its scalars."""
    return Case(name, {n: np.array(float(x)) for n, x in zip(NAMES, scalars)}, comment, conventions=conventions or {})


def before(x):
    """Whether the delay lies before the decay."""
    return x["conventions"].get("rate_delay") == "before"


def even(x):
    """Whether it is a straight line."""
    return x["conventions"].get("rate_ramp") == "linear"


def over_reals(x):
    """The definition, the power as e^(t ln(lr_final / lr_init))."""
    step, most, first, last, wait, mult = (x[name].item() for name in NAMES)
    begin = wait if before(x) else reals.Real(0)
    t = reals.Real(0) if step.value <= begin.value else (step - begin) / (most - begin)
    t = reals.Real(1) if t.value > 1 else t
    ratio = last / first
    # By the ratio first: what it is off by, times t; then by t.
    slope = ratio.function(ratio.value**t.value, t.value * ratio.value ** (t.value - 1), reals.mpf(0))
    logarithm, value = reals.mpmath.log(ratio.value), slope.value
    both = t.function(value, value * logarithm, value * logarithm**2)
    power = reals.Real(value, max(slope.term, both.term))
    rate = first * power
    if step.value < wait.value:
        part = step / wait
        risen = part if even(x) else reals.sin_pi(part, 0.5)
        rate = rate * reals.total([mult, (1 - mult) * risen])
    return {"rate": np.array(rate, dtype=object)}


def in_torch(x):
    """Tensors: an interpolation of logarithms, and one from `delay_mult` to 1."""
    step, most, first, last, wait, mult = (x[name] for name in NAMES)
    begin = wait if before(x) else torch.zeros(())
    t = torch.clamp((step - begin) / (most - begin), 0, 1)
    rate = torch.exp(torch.lerp(torch.log(first), torch.log(last), t))
    if wait > 0:
        part = torch.clamp(step / wait, 0, 1)
        rate = rate * torch.lerp(mult, torch.ones(()), part if even(x) else torch.sin(part * (torch.pi / 2)))
    return {"rate": rate}
