"""Losses, pictures, the optimizer."""

import jax
import kornia
import numpy as np
import optax
import skimage.metrics
import skimage.util
import torch
from bases import beside, of_convention, plain

jax.config.update("jax_platforms", "cpu")
jax.config.update("jax_enable_x64", True)


@beside("mse", "scikit-image", "mean_squared_error", arrays="numpy")
def mse(prediction, target):
    """As it comes."""
    return {"value": skimage.metrics.mean_squared_error(target, prediction)}


@beside(
    "psnr", "scikit-image", "peak_signal_noise_ratio", "picture by picture, then the mean", of_convention(psnr="images"), "numpy"
)
def psnr(prediction, target, peak):
    """The mean of the pictures' own."""
    with np.errstate(divide="ignore"):
        each = [skimage.metrics.peak_signal_noise_ratio(b, a, data_range=peak) for a, b in zip(prediction, target)]
    return {"value": np.mean(each)}


@beside("to_uint8", "scikit-image", "img_as_ubyte", "of what is clipped", plain, "numpy")
def to_uint8(image):
    """Rounded."""
    return {"bytes": skimage.util.img_as_ubyte(np.clip(image, 0, 1))}


@beside("linear_to_srgb", "kornia", "linear_rgb_to_rgb", only=plain)
def linear_to_srgb(linear):
    """Each number as a gray pixel."""
    pixels = torch.stack([linear, linear.detach(), linear.detach()], -1)[..., None, None]
    return {"srgb": kornia.color.linear_rgb_to_rgb(pixels)[:, 0, 0, 0]}


@beside("adam_step", "optax", "adam", "in 64 bits; decay added to the gradient", arrays="numpy")
def adam_step(params, grad, m, v, step, lr, beta1, beta2, eps, weight_decay):
    """One update from a given state."""
    grad, _ = optax.add_decayed_weights(weight_decay).update(grad, optax.EmptyState(), params)
    adam = optax.adam(lr, b1=beta1, b2=beta2, eps=eps)
    first, *rest = adam.init(params)
    state = first._replace(count=np.int32(step - 1), mu=m, nu=v), *rest
    update, state = adam.update(grad, state, params)
    return {"params_out": optax.apply_updates(params, update), "m_out": state[0].mu, "v_out": state[0].nu}


@beside("adam", "optax", "adam", "in 64 bits; decay added to the gradient", arrays="numpy")
def adam(params, grads, lr, beta1, beta2, eps, weight_decay):
    """Twenty updates from the start."""
    chain = optax.chain(optax.add_decayed_weights(weight_decay), optax.adam(lr, b1=beta1, b2=beta2, eps=eps))
    state, steps = chain.init(params), []
    for grad in grads:
        update, state = chain.update(grad, state, params)
        params = optax.apply_updates(params, update)
        steps.append(params)
    return {"params_out": np.stack(steps)}
