"""Twenty training steps with Adam on a tiny scene: the loss before every step and all parameters at the end."""

import numpy as np
import torch

from . import adam_step, reals, loss_gradient
from .fixture import Case, Draw

NAME, PURPOSE = "loss_curve", 1103
DIFFERENTIABLE = ()
STEPS = 20


def cases():
    """Two rays of four samples, jittered anew in every step, width 16, L of 2 and 1."""
    inputs = loss_gradient.inputs("tiny-scene", 2, 4, 2, 1)
    inputs["u"] = Draw(PURPOSE, "tiny-scene").uniform((STEPS, 2, 4))
    yield Case("tiny-scene", inputs | adam_step.DEFAULTS | {"lr": 5e-3}, "20 steps at lr 5e-3")


def parameters(x):
    """The network's arrays."""
    return {name: value for name, value in x.items() if name.endswith(("_w", "_b"))}


def over_reals(x):
    """Nothing is rounded to f64 between the first parameter and the last; largest terms are those of the last step."""
    params = parameters(x)
    settings = {name: x[name] for name in adam_step.DEFAULTS}
    zeros = {name: reals.lift(np.zeros(value.shape)) for name, value in params.items()}
    m, v, losses = dict(zeros), dict(zeros), []
    for step, u in enumerate(x["u"], start=1):
        leaves = {name: fresh(value) for name, value in params.items()}
        loss = loss_gradient.over_reals(x | leaves | {"u": u})["value"]
        losses.append(loss.item())
        gradients = reals.vjp({"value": loss}, {"value": np.float64(1.0)}, leaves)
        for name, value in leaves.items():
            flat = {"params": value, "grad": gradients[name], "m": m[name], "v": v[name]}
            flat = {key: array.reshape(-1) for key, array in flat.items()} | settings | {"step": reals.lift(step)}
            out = {key: array.reshape(value.shape) for key, array in adam_step.over_reals(flat).items()}
            params[name], m[name], v[name] = (fresh(out[key]) for key in ("params_out", "m_out", "v_out"))
    return {"losses": np.array(losses, dtype=object)} | params


def fresh(array):
    """The same numbers without the tape behind them."""
    out = np.empty(array.shape, object)
    for index in np.ndindex(array.shape):
        out[index] = reals.Real(array[index].value, array[index].term)
    return out


def in_torch(x):
    """torch's autograd and torch.optim.Adam."""
    params = {name: torch.nn.Parameter(value.clone()) for name, value in parameters(x).items()}
    settings = {name: x[name].item() for name in adam_step.DEFAULTS}
    betas = settings.pop("beta1"), settings.pop("beta2")
    optimizer = torch.optim.Adam(params.values(), betas=betas, **settings)
    losses = []
    for u in x["u"]:
        optimizer.zero_grad()
        loss = loss_gradient.in_torch(x | params | {"u": u})["value"]
        losses.append(loss.detach())
        loss.backward()
        optimizer.step()
    return {"losses": torch.stack(losses)} | {name: value.detach() for name, value in params.items()}
