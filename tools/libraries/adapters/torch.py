"""torch.optim.Adam in its three implementations. What its operators do in the rest of the contract is further up this page."""

import torch
from entry import answers


def stepped(params, grad, m, v, step, lr, beta1, beta2, eps, weight_decay, **how):
    """One step, with the state put in place."""
    params = torch.nn.Parameter(params.clone())
    params.grad = grad.clone()
    adam = torch.optim.Adam([params], lr=lr, betas=(beta1, beta2), eps=eps, weight_decay=weight_decay, **how)
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
