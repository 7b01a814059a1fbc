"""optax on jax's CPU backend. Decay is added to the gradient in front of adam, as torch's Adam has it."""

import jax
import jax.numpy as jnp
import numpy as np
import optax
from entry import answers

jax.config.update("jax_platforms", "cpu")
jax.config.update("jax_enable_x64", True)


def stepped(params, grad, m, v, step, lr, beta1, beta2, eps, weight_decay):
    """One update, with the state put in place."""
    decayed = optax.add_decayed_weights(weight_decay)
    adam = optax.adam(lr, b1=beta1, b2=beta2, eps=eps)
    params, grad, m, v = (jnp.asarray(x) for x in (params, grad, m, v))
    grad, _ = decayed.update(grad, decayed.init(params), params)
    state = adam.init(params)
    state = (state[0]._replace(count=jnp.asarray(step - 1, dtype=jnp.int32), mu=m, nu=v), *state[1:])
    update, state = adam.update(grad, state, params)
    return tuple(np.asarray(x) for x in (optax.apply_updates(params, update), state[0].mu, state[0].nu))


@answers("optax", "adam_step", "adam, with jax_enable_x64", dtypes=("f64", "f32"), arrays="numpy")
def adam_step(params, grad, m, v, step, lr, beta1, beta2, eps, weight_decay):
    """jax with 64-bit types: the corrections 1 - beta^t are in f64."""
    return stepped(params, grad, m, v, step, lr, beta1, beta2, eps, weight_decay)


@answers("optax", "adam_step", "adam, as jax comes", dtypes=("f32",), arrays="numpy")
def adam_in_32_bits(params, grad, m, v, step, lr, beta1, beta2, eps, weight_decay):
    """Without 64-bit types: everything is in f32."""
    with jax.enable_x64(False):
        return stepped(params, grad, m, v, step, lr, beta1, beta2, eps, weight_decay)


@answers("optax", "adamw_step", "adamw, with jax_enable_x64", dtypes=("f64", "f32"), arrays="numpy")
def adamw_step(params, grad, m, v, step, lr, beta1, beta2, eps, weight_decay):
    """One update, with the state put in place."""
    adamw = optax.adamw(lr, b1=beta1, b2=beta2, eps=eps, weight_decay=weight_decay)
    params, grad, m, v = (jnp.asarray(x) for x in (params, grad, m, v))
    state = adamw.init(params)
    state = (state[0]._replace(count=jnp.asarray(step - 1, dtype=jnp.int32), mu=m, nu=v), *state[1:])
    update, state = adamw.update(grad, state, params)
    return tuple(np.asarray(x) for x in (optax.apply_updates(params, update), state[0].mu, state[0].nu))


@answers("optax", "clip_by_global_norm", "clip_by_global_norm, global_norm", dtypes=("f64", "f32"), arrays="numpy")
def clip_by_global_norm(g_weights, g_bias, max_norm):
    """Both tensors at once."""
    gradients = [jnp.asarray(g_weights), jnp.asarray(g_bias)]
    clip = optax.clip_by_global_norm(float(max_norm))
    (weights, bias), _ = clip.update(gradients, clip.init(gradients))
    return np.asarray(weights), np.asarray(bias), np.asarray(optax.global_norm(gradients))


@answers("optax", "clip_by_value", "clip", dtypes=("f64", "f32"), arrays="numpy")
def clip_by_value(g, limit):
    """Number by number."""
    clip = optax.clip(float(limit))
    return np.asarray(clip.update(jnp.asarray(g), clip.init(jnp.asarray(g)))[0])


@answers("optax", "huber", "huber_loss", dtypes=("f64", "f32"), arrays="numpy")
def huber(prediction, target, delta):
    """The mean of its entries."""
    return np.asarray(optax.huber_loss(jnp.asarray(prediction), jnp.asarray(target), delta=float(delta)).mean())


@answers("optax", "lr_cosine", "warmup_cosine_decay_schedule", dtypes=("f64", "f32"), arrays="numpy")
def lr_cosine(step, max_steps, lr_init, lr_final, warmup_steps):
    """From 0 to the first rate, and down to the last."""
    schedule = optax.warmup_cosine_decay_schedule(
        0.0, float(lr_init), int(warmup_steps), int(max_steps), end_value=float(lr_final)
    )
    return np.asarray(schedule(jnp.asarray(int(step))))


@answers("optax", "lr_exponential", "exponential_decay", dtypes=("f64", "f32"), arrays="numpy")
def lr_exponential(step, decay_steps, lr_init, decay):
    """A factor to the power of the share of the steps."""
    return np.asarray(optax.exponential_decay(float(lr_init), int(decay_steps), float(decay))(jnp.asarray(int(step))))
