"""optax.adam on jax's CPU backend. Decay is added to the gradient in front of it, as torch's Adam has it."""

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
