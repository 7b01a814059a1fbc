"""training_step: some steps of training, each with its own rays, draws and learning rate: nerf_mlp, volume_render, mse, adam_step."""

import numpy as np
import torch

from . import adam_step, loss_gradient, nerf_mlp, reals
from .fixture import Case, Draw
from .loss_curve import fresh

NAME, PURPOSE = "training_step", 1051
DIFFERENTIABLE = ()
OF_STEPS = ("rays_o", "rays_d", "directions", "u", "target")
HYPER = ("beta1", "beta2", "eps", "weight_decay")


def cases():
    """One step, and five with rates that fall, other betas and coupled weight decay; two rays of three samples, width 4."""
    yield Case("one-step", inputs("one-step", 1, {}), "from moments of 0")
    changes = {"beta1": 0.75, "beta2": 0.9, "eps": 0.0625, "weight_decay": 0.0625}
    yield Case("five-steps", inputs("five-steps", 5, changes), "rates that fall, an eps that weighs, other betas, weight decay")


def inputs(name, steps, changes):
    """Rays through the box [-1, 1]^3, draws, colors to meet, and a network whose units are clearly on or off."""
    draw, shape = Draw(PURPOSE, name), (steps, 2, 3)
    arrays = {"rays_o": draw.uniform(shape, -0.5, 0.5), "rays_d": draw.uniform(shape, 0.25, 0.75)}
    arrays |= {"directions": draw.uniform(shape, -0.75, 0.75), "u": draw.uniform(shape), "target": draw.uniform(shape)}
    arrays |= {"near": 0.5, "far": 2.0, "lr": 0.03125 * 0.75 ** np.arange(steps)}
    arrays |= {key: adam_step.DEFAULTS[key] for key in HYPER} | changes
    network = nerf_mlp.parameters(draw, 4, 9, 9)
    network |= {key: value + 0.75 for key, value in network.items() if key.startswith("trunk") and key.endswith("_b")}
    return arrays | network | {"sigma_b": np.array([1.5])}


def parameters(x):
    """The network's arrays, in the order of the contract."""
    names = [*(f"trunk{n}" for n in range(8)), "sigma", "feature", "color0", "color1"]
    return {f"{name}_{part}": x[f"{name}_{part}"] for name in names for part in "wb"}


def row(arrays):
    """Arrays one after the other."""
    return np.concatenate([array.reshape(-1) for array in arrays.values()])


def over_reals(x):
    """Nothing is rounded to f64 between the first parameter and the last; largest terms are those of the last step."""
    params, out, losses = parameters(x), {}, []
    count = len(row(params))
    m, v = reals.lift(np.zeros(count)), reals.lift(np.zeros(count))
    for k in range(len(x["lr"])):
        leaves = {name: fresh(value) for name, value in params.items()}
        seen = loss_gradient.passed_over_reals(x | leaves | {name: x[name][k] for name in OF_STEPS})
        losses.append(seen["value"].item())
        gradient = row(reals.vjp(seen, {"value": np.float64(1.0)}, leaves))
        settings = {name: x[name] for name in HYPER} | {"lr": np.array(x["lr"][k]), "step": reals.lift(k + 1)}
        moved = adam_step.over_reals({"params": row(leaves), "grad": gradient, "m": m, "v": v} | settings)
        flat, m, v = (fresh(moved[name]) for name in ("params_out", "m_out", "v_out"))
        params = refilled(params, flat)
        if k == 0:
            out = {name: seen[name] for name in ("t", "deltas", "colors")} | {"grad": gradient}
            out |= {"params_1": flat, "m_1": m, "v_1": v}
    return out | {"losses": np.array(losses, dtype=object), "params_last": flat, "m_last": m, "v_last": v}


def refilled(params, flat):
    """Arrays of the same names and shapes from a row."""
    ends = np.cumsum([value.size for value in params.values()])
    return {name: part.reshape(params[name].shape) for name, part in zip(params, np.split(flat, ends[:-1]))}


def in_torch(x):
    """torch's autograd and torch.optim.Adam."""
    params = {name: torch.nn.Parameter(value.clone()) for name, value in parameters(x).items()}
    settings = {name: x[name].item() for name in HYPER}
    betas = settings.pop("beta1"), settings.pop("beta2")
    optimizer = torch.optim.Adam(params.values(), betas=betas, **settings)
    out, losses = {}, []

    def flat(of):
        return torch.cat([of(value).detach().reshape(-1) for value in params.values()])

    for k, rate in enumerate(x["lr"]):
        optimizer.param_groups[0]["lr"] = rate.item()
        optimizer.zero_grad()
        seen = loss_gradient.passed_in_torch(x | params | {name: x[name][k] for name in OF_STEPS})
        losses.append(seen["value"].detach())
        seen["value"].backward()
        if k == 0:
            out = {name: seen[name].detach() for name in ("t", "deltas", "colors")} | {"grad": flat(lambda p: p.grad).clone()}
        optimizer.step()
        state = {"params": flat(lambda p: p), "m": flat(lambda p: optimizer.state[p]["exp_avg"])}
        state |= {"v": flat(lambda p: optimizer.state[p]["exp_avg_sq"])}
        if k == 0:
            out |= {f"{name}_1": value.clone() for name, value in state.items()}
    return out | {"losses": torch.stack(losses)} | {f"{name}_last": value for name, value in state.items()}
