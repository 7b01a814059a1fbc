"""JAX, jitted, gradients by jax.vjp: with the products of its default precision, and of the highest."""

import os
import sys

import numpy as np
from asked import Absent

os.environ.setdefault("XLA_PYTHON_CLIENT_PREALLOCATE", "false")

import jax  # noqa: E402
import jax.numpy as jnp  # noqa: E402


def volume_render(sigmas, rgbs, deltas):
    """By the depths in front."""
    x = sigmas * deltas
    front = jnp.cumsum(jnp.pad(x, ((0, 0), (1, 0)))[:, :-1], -1)
    w = jnp.exp(-front) * -jnp.expm1(-x)
    return {"colors": (w[..., None] * rgbs).sum(1), "weights": w, "opacity": w.sum(-1), "transmittance": jnp.exp(-x.sum(-1))}


def volume_render_alpha(alphas, rgbs):
    """By the product."""
    product = jnp.cumprod(jnp.pad(1 - alphas, ((0, 0), (1, 0)), constant_values=1), -1)
    w = product[:, :-1] * alphas
    return {"colors": (w[..., None] * rgbs).sum(1), "weights": w, "opacity": w.sum(-1), "transmittance": product[:, -1]}


def mlp(x, **p):
    """Linear layers, ReLU between, sigmoid after."""
    for i in range(sum(k.startswith("w") for k in p)):
        x = (x if i == 0 else jax.nn.relu(x)) @ p[f"w{i}"].T + p[f"b{i}"]
    return {"y": jax.nn.sigmoid(x)}


def encoding(x, bands):
    """Sines and cosines behind x."""
    waves = [f(2**k * np.pi * x) for k in range(bands) for f in (jnp.sin, jnp.cos)]
    return jnp.concatenate([x, *waves], -1)


def nerf_mlp(positions, directions, **p):
    """Figure 7; the numbers of bands follow from the widths."""
    layer = lambda name, h: h @ p[f"{name}_w"].T + p[f"{name}_b"]  # noqa: E731
    x = encoding(positions, (p["trunk0_w"].shape[1] - 3) // 6)
    d = encoding(directions, (p["color0_w"].shape[1] - len(p["feature_w"]) - 3) // 6)
    h = x
    for n in range(8):
        h = jax.nn.relu(layer(f"trunk{n}", jnp.concatenate([h, x], -1) if n == 4 else h))
    color = jax.nn.relu(layer("color0", jnp.concatenate([layer("feature", h), d], -1)))
    return {"sigmas": jax.nn.relu(layer("sigma", h))[:, 0], "rgbs": jax.nn.sigmoid(layer("color1", color))}


def transform(c2w, x_c):
    """R x + o."""
    return {"x_w": jnp.einsum("mij,mj->mi", c2w[:, :3, :3], x_c) + c2w[:, :3, 3]}


def composite_background(colors, opacity, background):
    """What is left shows the background."""
    return {"colors_out": colors + (1 - opacity)[:, None] * background}


def linear_to_srgb(linear):
    """The double where keeps the power's gradient out of the linear part."""
    big = linear > 0.0031308
    return {"srgb": jnp.where(big, 1.055 * jnp.where(big, linear, 1) ** (1 / 2.4) - 0.055, 12.92 * linear)}


ALL = volume_render, volume_render_alpha, mlp, nerf_mlp, transform, composite_background, linear_to_srgb
ROWS = {f.__name__: f for f in ALL}


def gradients(function, case, inputs):
    """By jax.vjp, of the inputs that the contract asks for."""
    cotangents = {name[5:]: x for name, x in inputs.items() if name.startswith("grad_")}
    wanted = {port["name"][5:]: inputs[port["name"][5:]] for port in case["outputs"]}
    rest = {name: x for name, x in inputs.items() if not name.startswith("grad_") and name not in wanted}

    @jax.jit
    def pulled(wanted, cotangents, rest):
        y, back = jax.vjp(lambda smooth: function(**smooth, **rest), wanted)
        return back({name: cotangents[name].astype(x.dtype).reshape(x.shape) for name, x in y.items()})[0]

    found = {f"grad_{name}": g for name, g in pulled(wanted, cotangents, rest).items()}
    if "grad_c2w" in found:
        # The contract's pose has three rows.
        found["grad_c2w"] = found["grad_c2w"].at[..., 3, :].set(0)
    return found


def answer(asked):
    """Two candidates. XLA compiles for every shape, which takes most of the time."""
    from candidate import inputs_of, read_manifest, write

    jax.config.update("jax_enable_x64", asked.dtype == "f64")
    if asked.device == "cuda" and jax.default_backend() != "gpu":
        raise Absent("jax finds no CUDA device")
    names = {"f64": "float64", "f32": "float32", "tf32": "float32", "bf16": "bfloat16", "f16": "float16"}
    kind, failed = jnp.dtype(names[asked.dtype]), False
    for case in read_manifest(asked.cases)["cases"]:
        function = ROWS.get(case["component"])
        for precision in ("default", "highest") if function else ():
            given = inputs_of(asked.cases, case, asked.dtype, "numpy", "cpu")
            inputs = {name: jnp.asarray(x, kind) if isinstance(x, np.ndarray) else x for name, x in given.items()}
            try:
                with jax.default_matmul_precision(precision):
                    found = gradients(function, case, inputs) if case["kind"] == "vjp" else jax.jit(function)(**inputs)
                told = {name: x.astype(jnp.float32) if x.dtype == jnp.bfloat16 else x for name, x in found.items()}
                write(asked.answers / f"jax_{precision}" / case["file"], told)
            except Exception as error:
                print(f"jax_{precision} {case['file']}: {type(error).__name__}: {str(error)[:200]}", file=sys.stderr, flush=True)
                failed = True
    return int(failed)
