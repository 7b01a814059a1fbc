"""torch's optimizers, clips, losses and gradient scaler. What its operators do elsewhere is further up this page."""

import torch
from entry import answers


def stepped(params, grad, m, v, step, lr, beta1, beta2, eps, weight_decay, optimizer=torch.optim.Adam, **how):
    """One step, with the state put in place."""
    params = torch.nn.Parameter(params.clone())
    params.grad = grad.clone()
    adam = optimizer([params], lr=lr, betas=(beta1, beta2), eps=eps, weight_decay=weight_decay, **how)
    count = torch.tensor(float(step - 1), dtype=torch.float64 if params.dtype == torch.float64 else torch.float32)
    adam.state[params] = {"step": count, "exp_avg": m.clone(), "exp_avg_sq": v.clone()}
    adam.step()
    return params.detach(), adam.state[params]["exp_avg"], adam.state[params]["exp_avg_sq"]


@answers("torch", "adam_step", "optim.Adam(foreach=False)")
def adam_step(params, grad, m, v, step, lr, beta1, beta2, eps, weight_decay):
    """Tensor by tensor."""
    return stepped(params, grad, m, v, step, lr, beta1, beta2, eps, weight_decay, foreach=False)


@answers("torch", "adam_step", "optim.Adam(foreach=True)")
def adam_foreach(params, grad, m, v, step, lr, beta1, beta2, eps, weight_decay):
    """All tensors at once."""
    return stepped(params, grad, m, v, step, lr, beta1, beta2, eps, weight_decay, foreach=True)


@answers("torch", "adam_step", "optim.Adam(fused=True)")
def adam_fused(params, grad, m, v, step, lr, beta1, beta2, eps, weight_decay):
    """In one kernel."""
    return stepped(params, grad, m, v, step, lr, beta1, beta2, eps, weight_decay, fused=True)


@answers("torch", "adamw_step", "optim.AdamW(foreach=False)")
def adamw_step(params, grad, m, v, step, lr, beta1, beta2, eps, weight_decay):
    """Tensor by tensor."""
    how = {"optimizer": torch.optim.AdamW, "foreach": False}
    return stepped(params, grad, m, v, step, lr, beta1, beta2, eps, weight_decay, **how)


@answers("torch", "clip_by_global_norm", "nn.utils.clip_grad_norm_")
def clip_by_global_norm(g_weights, g_bias, max_norm):
    """Two parameters, whose gradients are clipped in place."""
    parameters = [torch.nn.Parameter(torch.zeros_like(g)) for g in (g_weights, g_bias)]
    for parameter, g in zip(parameters, (g_weights, g_bias)):
        parameter.grad = g.clone()
    norm = torch.nn.utils.clip_grad_norm_(parameters, max_norm)
    return parameters[0].grad, parameters[1].grad, norm


@answers("torch", "clip_by_value", "nn.utils.clip_grad_value_")
def clip_by_value(g, limit):
    """One parameter, whose gradient is clipped in place."""
    parameter = torch.nn.Parameter(torch.zeros_like(g))
    parameter.grad = g.clone()
    torch.nn.utils.clip_grad_value_(parameter, limit)
    return parameter.grad


@answers("torch", "huber", "nn.functional.huber_loss")
def huber(prediction, target, delta):
    """Its mean."""
    return torch.nn.functional.huber_loss(prediction, target, delta=delta)


@answers("torch", "huber", "nn.functional.smooth_l1_loss")
def smooth_l1(prediction, target, delta):
    """The same over delta."""
    return torch.nn.functional.smooth_l1_loss(prediction, target, beta=delta)


@answers("torch", "loss_scale_update", "_amp_update_scale_, which GradScaler.update calls", dtypes=("f32", "bf16"))
def loss_scale_update(scale, growth_tracker, found_inf, growth_factor, backoff_factor, growth_interval):
    """Scales are f32 there."""
    single = lambda x: torch.tensor(float(x), dtype=torch.float32)  # noqa: E731
    tracker = torch.tensor(int(growth_tracker), dtype=torch.int32)
    after = torch._amp_update_scale_(
        single(scale), tracker, single(found_inf), float(growth_factor), float(backoff_factor), int(growth_interval)
    )
    return after, tracker


@answers("torch", "unscale_gradients", "_amp_foreach_non_finite_check_and_unscale_, as GradScaler calls it", dtypes=("f32",))
def unscale_gradients(gradients, scale):
    """Times the inverse of the scale, in f32."""
    found, unscaled = torch.zeros(1, dtype=torch.float32), gradients.clone()
    inverse = torch.tensor(float(scale), dtype=torch.float32).double().reciprocal().float()
    torch._amp_foreach_non_finite_check_and_unscale_([unscaled], found, inverse)
    return found[0].to(torch.int64), unscaled
