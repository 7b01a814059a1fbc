"""torch's own optimizers in each of their forms, clips, losses and gradient scaler."""

from asked import adapters


def stepping(torch, optimizer, **how):
    """One step of an optimizer, with the state put in place. Its count is f32 where torch keeps it on the device."""

    def step_of(params, grad, m, v, step, lr, beta1, beta2, eps, weight_decay):
        params = torch.nn.Parameter(params.clone())
        params.grad = grad.clone()
        adam = optimizer([params], lr=lr, betas=(beta1, beta2), eps=eps, weight_decay=weight_decay, **how)
        on_device = how.get("fused") or how.get("capturable")
        kind = torch.float64 if params.dtype == torch.float64 and not on_device else torch.float32
        count = torch.tensor(float(step - 1), dtype=kind, device=params.device if on_device else "cpu")
        adam.state[params] = {"step": count, "exp_avg": m.clone(), "exp_avg_sq": v.clone()}
        adam.step()
        return params.detach(), adam.state[params]["exp_avg"], adam.state[params]["exp_avg_sq"]

    return step_of


def answer(asked):
    """A candidate for each form."""
    torch = asked.torch()
    own = adapters("torch")
    forms = {"loop": {"foreach": False}, "foreach": {"foreach": True}, "fused": {"fused": True}}
    if asked.device == "cuda":
        forms["capturable"] = {"foreach": True, "capturable": True}
    for form, how in forms.items():
        adam, adamw = (stepping(torch, optimizer, **how) for optimizer in (torch.optim.Adam, torch.optim.AdamW))
        asked.hand(f"torch_{form}", adam_step=adam, adamw_step=adamw)
    asked.hand("torch_clips", clip_by_global_norm=own.clip_by_global_norm, clip_by_value=own.clip_by_value)
    asked.hand("torch_huber_loss", huber=own.huber)
    asked.hand("torch_smooth_l1_loss", huber=own.smooth_l1)
    if asked.dtype in ("f32", "bf16"):
        asked.hand("torch_scaler", loss_scale_update=own.loss_scale_update)
    if asked.dtype == "f32":
        asked.hand("torch_scaler", unscale_gradients=own.unscale_gradients)
