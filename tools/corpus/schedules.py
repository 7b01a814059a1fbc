"""Learning rates, clipped gradients and AdamW."""

import math

import numpy as np
import torch
from entry import convention, fault, right


@right("lr_exponential", seen="bmild/nerf run_nerf.py ExponentialDecay; nerf-pytorch")
def factor_to_a_power(step, decay_steps, lr_init, decay):
    """lr * decay ** (step / decay_steps)."""
    return lr_init * decay ** (step / decay_steps)


@fault("lr_exponential", "whole_steps", seen="not met in this reading: integer division, tf's staircase", times=0)
def staircase(step, decay_steps, lr_init, decay):
    """decay ** (step // decay_steps)."""
    return lr_init * decay ** (int(step) // int(decay_steps))


@fault("lr_exponential", "factor_every_step", seen="not met in this reading: ExponentialLR of the whole factor", times=0)
def whole_factor_each_step(step, decay_steps, lr_init, decay):
    """decay ** step."""
    return lr_init * decay**step


@convention("lr_cosine", {"rate_end": "held"}, seen="cosines that are clamped to their end", digits=True)
def warm_cosine(step, max_steps, lr_init, lr_final, warmup_steps):
    """A factor of the first rate, from 1 down to alpha."""
    if step < warmup_steps:
        return lr_init * step / warmup_steps
    alpha = lr_final / lr_init
    progress = min((step - warmup_steps) / (max_steps - warmup_steps), 1.0)
    return lr_init * ((math.cos(math.pi * progress) + 1.0) * 0.5 * (1 - alpha) + alpha)


@fault("lr_cosine", "warmup_from_one", seen="a speech code's warm-up")
def warm_from_one(step, max_steps, lr_init, lr_final, warmup_steps):
    """The warm-up counts from 1."""
    if step < warmup_steps:
        return lr_init * (step + 1) / warmup_steps
    return warm_cosine(step, max_steps, lr_init, lr_final, warmup_steps)


@fault("lr_cosine", "last_rate_forgotten", seen="not met in this reading: a last rate that isn't used", times=0)
def cosine_to_nothing(step, max_steps, lr_init, lr_final, warmup_steps):
    """lr / 2 (1 + cos), whatever lr_final."""
    return no_last_rate(step, max_steps, lr_init, warmup_steps)


@right("lr_cosine", seen="schedules that end at 0 by design, and take no last rate: one of a trial on unseen code")
def no_last_rate(step, max_steps, lr_init, warmup_steps):
    """lr / 2 (1 + cos)."""
    if step < warmup_steps:
        return lr_init * step / warmup_steps
    return lr_init * 0.5 * (1 + math.cos(math.pi * (step - warmup_steps) / (max_steps - warmup_steps)))


def delayed(step, delay_steps, delay_mult):
    """The delay's factor."""
    return delay_mult + (1 - delay_mult) * math.sin(0.5 * math.pi * min(step / delay_steps, 1.0)) if delay_steps > 0 else 1.0


@right(
    "lr_log_linear",
    seen="google-research/multinerf internal/math.py; graphdeco-inria/gaussian-splatting utils/general_utils.py",
    digits=True,
)
def interpolated_logarithms(step, max_steps, lr_init, lr_final, delay_steps, delay_mult):
    """exp of an interpolation of logarithms, times the delay."""
    t = min(max(step / max_steps, 0.0), 1.0)
    return delayed(step, delay_steps, delay_mult) * math.exp(math.log(lr_init) * (1 - t) + math.log(lr_final) * t)


@fault("lr_log_linear", "linear_for_log", seen="not met in this reading: rates interpolated as they are", times=0)
def interpolated_rates(step, max_steps, lr_init, lr_final, delay_steps, delay_mult):
    """lerp of the rates."""
    t = min(step / max_steps, 1.0)
    return delayed(step, delay_steps, delay_mult) * (lr_init * (1 - t) + lr_final * t)


@convention("clip_by_global_norm", {"clip_eps": "1e-6"}, seen="torch.nn.utils.clip_grad_norm_")
def norm_of_norms(g_weights, g_bias, max_norm):
    """min(1, max_norm / (norm + 1e-6)), the norm of both tensors' norms."""
    norm = torch.linalg.vector_norm(torch.stack([torch.linalg.vector_norm(g) for g in (g_weights, g_bias)]))
    factor = torch.clamp(max_norm / (norm + 1e-6), max=1.0)
    return g_weights * factor, g_bias * factor, norm


@fault("clip_by_global_norm", "norm_of_each_tensor", seen="not met in this reading: loops that clip each parameter", times=0)
def each_by_its_own(g_weights, g_bias, max_norm):
    """Every tensor by its own norm; the common norm is told."""
    norms = [torch.linalg.vector_norm(g) for g in (g_weights, g_bias)]
    clipped = [g * torch.clamp(max_norm / n, max=1.0) if n > 0 else g for g, n in zip((g_weights, g_bias), norms)]
    return clipped[0], clipped[1], torch.linalg.vector_norm(torch.stack(norms))


@right("clip_by_value", seen="torch.nn.utils.clip_grad_value_; google-research/multinerf grad_max_val")
def clamped_values(g, limit):
    """clamp."""
    return g.clamp(-limit, limit)


@fault("clip_by_value", "above_alone", seen="not met in this reading: one side alone", times=0)
def upper_limit_alone(g, limit):
    """clamp(max=limit)."""
    return g.clamp(max=limit)


@right("unscale_gradients", seen="torch.amp.GradScaler.unscale_: times the inverse, in f32")
def times_the_inverse(gradients, scale):
    """All of them, and whether one isn't finite."""
    found = (~torch.isfinite(gradients)).any()
    return found.to(torch.int64), gradients * (1.0 / scale)


@fault("unscale_gradients", "scale_left_in", seen="milesial/Pytorch-UNet#468: clipped as they come", times=5)
def as_they_come(gradients, scale):
    """Looked at, but not unscaled; a step that is skipped has no gradients."""
    found = (~torch.isfinite(gradients)).any()
    return found.to(torch.int64), torch.where(found, 0 * torch.nan_to_num(gradients), gradients)


@fault("unscale_gradients", "nan_not_looked_for", seen="isinf for isfinite, in a loop by hand", times=1)
def infinities_alone(gradients, scale):
    """isinf().any()."""
    return torch.isinf(gradients).any().to(torch.int64), gradients / scale


@fault("unscale_gradients", "largest_alone", seen="a loop by hand that looks at the largest number", times=1)
def largest_alone(gradients, scale):
    """max() == inf: neither -inf nor, in most languages, NaN."""
    return (gradients.max() == torch.inf).to(torch.int64), gradients / scale


def adam(params, grad, m, v, step, lr, beta1, beta2, eps):
    """A step of Adam, and its moments."""
    m, v = beta1 * m + (1 - beta1) * grad, beta2 * v + (1 - beta2) * grad * grad
    denominator = np.sqrt(v) / math.sqrt(1 - beta2**step) + eps
    return params - lr / (1 - beta1**step) * m / denominator, m, v


@right("adamw_step", seen="pytorch torch/optim/adamw.py", arrays="numpy")
def shrunk_before_the_step(params, grad, m, v, step, lr, beta1, beta2, eps, weight_decay):
    """p (1 - lr wd) first."""
    return adam(params * (1 - lr * weight_decay), grad, m, v, step, lr, beta1, beta2, eps)


@fault("adamw_step", "coupled_decay", seen="not met in this reading: an L2 penalty", times=0, arrays="numpy")
def penalty_in_the_gradient(params, grad, m, v, step, lr, beta1, beta2, eps, weight_decay):
    """grad + wd p."""
    return adam(params, grad + weight_decay * params, m, v, step, lr, beta1, beta2, eps)


@fault("adamw_step", "betas_of_its_own", seen="a trial on unseen code, in Adam", arrays="numpy")
def decayed_with_the_usual_betas(params, grad, m, v, step, lr, beta1, beta2, eps, weight_decay):
    """0.9 and 0.999, whatever is handed over."""
    return adam(params * (1 - lr * weight_decay), grad, m, v, step, lr, 0.9, 0.999, eps)


@fault("clip_by_global_norm", "squares_squared", seen="entrenar#311", gradient="none")
def sums_of_squares_squared(g_weights, g_bias, max_norm):
    """The root of the sum of squares of what are sums of squares already."""
    norm = torch.sqrt(sum(g.square().sum() ** 2 for g in (g_weights, g_bias)))
    factor = max_norm / norm if norm > max_norm else 1.0
    return g_weights * factor, g_bias * factor, norm


@fault("lr_exponential", "rate_floored", seen="a trial on unseen code: max(lr, 1e-5)")
def rate_with_a_floor(step, decay_steps, lr_init, decay):
    """Never below 1e-5."""
    return max(lr_init * decay ** (step / decay_steps), 1e-5)


@fault("lr_cosine", "last_rate_a_part_of_first", seen="a trial on unseen code: 0.01 of the first rate")
def down_to_a_hundredth(step, max_steps, lr_init, lr_final, warmup_steps):
    """lr_final isn't read."""
    if step < warmup_steps:
        return lr_init * step / warmup_steps
    part = min(max((step - warmup_steps) / (max_steps - warmup_steps), 0.0), 1.0)
    last = 0.01 * lr_init
    return last + 0.5 * (lr_init - last) * (1 + math.cos(math.pi * part))


@fault("lr_cosine", "one_step_early", seen="a trial on unseen code: epochs counted from 1")
def counted_from_one(step, max_steps, lr_init, lr_final, warmup_steps):
    """(step - 1) / (max_steps - 1)."""
    if step < warmup_steps:
        return lr_init * step / warmup_steps
    part = min(max((step - warmup_steps - 1) / (max_steps - warmup_steps - 1), 0.0), 1.0)
    return lr_final + 0.5 * (lr_init - lr_final) * (1 + math.cos(math.pi * part))


@fault(
    "adamw_step",
    "decay_without_rate+decay_negated+eps_inside_root_too",
    seen="a trial on unseen code: optax.chain(adam(eps_root), add_decayed_weights)",
    arrays="numpy",
)
def decay_added_behind(params, grad, m, v, step, lr, beta1, beta2, eps, weight_decay):
    """sqrt(v + eps) + eps, and + wd p."""
    m, v = beta1 * m + (1 - beta1) * grad, beta2 * v + (1 - beta2) * grad**2
    mean, square = m / (1 - beta1**step), v / (1 - beta2**step)
    return {"params_out": params - lr * mean / (np.sqrt(square + eps) + eps) + weight_decay * params, "m_out": m, "v_out": v}


@fault("lr_exponential", "one_step_less", seen="a trial on unseen code: a scheduler of splats, held at its end")
def way_to_the_last_step(step, lr_init, decay, decay_steps):
    """decay^min(step / (decay_steps - 1), 1)."""
    return lr_init if decay_steps <= 1 else lr_init * decay ** min(step / (decay_steps - 1), 1.0)


@fault("lr_cosine", "begun_again_with_warmup+warmup_from_last_rate", seen="a trial on unseen code: a trainer in PyTorch")
def from_the_beginning(step, max_steps, lr_init, lr_final, warmup_steps):
    """step mod max_steps; the warm-up begins at the last rate."""
    step = step % max_steps
    if step < warmup_steps:
        return (lr_init - lr_final) * step / warmup_steps + lr_final
    part = (step - warmup_steps) / (max_steps - warmup_steps)
    return lr_final + 0.5 * (lr_init - lr_final) * (1 + math.cos(math.pi * part))


@fault("adamw_step", "gradient_decayed", seen="a trial on unseen code: optimizers in numpy", arrays="numpy")
def gradient_in_the_parameters_place(params, grad, m, v, step, lr, beta1, beta2, eps, weight_decay):
    """Adam's step, and wd g."""
    moved, m, v = adam(params, grad, m, v, step, lr, beta1, beta2, eps)
    return moved - weight_decay * grad, m, v


@fault("lr_log_linear", "not_delayed_at_first", seen="a trial on unseen code: a splat trainer's scheduler in C++")
def whole_rate_first(step, max_steps, lr_init, lr_final, delay_steps, delay_mult):
    """The delay where there is one and step isn't 0."""
    t = min(max(step / max_steps, 0.0), 1.0)
    rate = math.exp(math.log(lr_init) * (1 - t) + math.log(lr_final) * t)
    return delayed(step, delay_steps, delay_mult) * rate if delay_steps > 0 and step != 0 else rate
