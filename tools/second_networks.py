"""The second implementation's encoding and networks: batches and matrix products. See second.py."""

import numpy as np

FACTORS = {"pi": np.pi, "one": 1.0, "two_pi": 2 * np.pi}


def bands(levels, c, wrong):
    """Factor times f_k."""
    f = 2.0 ** np.arange(levels) if c["bands"] == "octaves" else np.linspace(1, 2 ** max(levels - 1, 0), levels)
    if c["bands"] == "stretched":
        f = 2.0 ** np.linspace(0, max(levels - 2, 0), levels)
    if c["bands"] == "widened":
        f = 2.0 ** np.linspace(0, levels, levels)
    if "first_band_twice" in wrong and levels:
        f[0] = 2.0
    if "powers_exchanged" in wrong:
        f = np.arange(levels, dtype=float) ** 2
    if "bands_one_by_one" in wrong:
        f = np.arange(1, levels + 1, dtype=float)
    if "linear_ladder" in wrong:
        f = np.arange(levels, dtype=float)
    return f * FACTORS[c["frequency"]]


def order(waves, c):
    """Columns (M, ...) of waves (M, 2, L, D): sine and cosine, bands, dimensions."""
    axes = {
        "band_sin_cos": (0, 2, 1, 3),
        "dim_sin_cos": (0, 3, 1, 2),
        "dim_interleaved": (0, 3, 2, 1),
        "all_sin_all_cos": (0, 1, 3, 2),
        "all_sin_all_cos_by_band": (0, 1, 2, 3),
        "band_interleaved": (0, 2, 3, 1),
    }[c["columns"]]
    return np.transpose(waves, axes).reshape(len(waves), waves[0].size)


def disorder(columns, levels, dims, c):
    """The inverse of `order`."""
    places = order(np.arange(2 * levels * dims).reshape(1, 2, levels, dims), c)[0]
    waves = np.empty_like(columns)
    waves[:, places] = columns
    return waves.reshape(len(columns), 2, levels, dims)


# A network's columns are its own: x in front, and every digit.
OF_NETWORKS = {"identity_place": "first", "cosine": "own"}


def encode(x, levels, c, wrong=()):
    """x, then the waves."""
    if "input_normalized" in wrong:
        with np.errstate(invalid="ignore"):
            x = x / np.linalg.norm(x, axis=1, keepdims=True)
    angle = x[:, None, :] * bands(levels, c, wrong).astype(x.dtype)[:, None]
    cosine = np.sin(angle + x.dtype.type(np.pi / 2)) if c["cosine"] == "shifted_sine" else np.cos(angle)
    waves = np.stack([np.sin(angle), np.sin(angle) if "cosine_missing" in wrong else cosine], 1)
    if "last_band_missing" in wrong and levels > 0:
        waves[:, :, -1] = 0
    parts = [x, order(waves, c)] if c["identity"] == "true" else [order(waves, c)]
    return np.concatenate(parts[::-1] if c["identity_place"] == "last" else parts, 1)


def encode_vjp(x, levels, g, c, wrong=()):
    """g_x."""
    dims = x.shape[1]
    own = np.zeros_like(x)
    if c["identity"] == "true":
        g, own = (g[:, :-dims], g[:, -dims:]) if c["identity_place"] == "last" else (g[:, dims:], g[:, :dims])
    waves = disorder(g, levels, dims, c)
    f = bands(levels, c, wrong).astype(x.dtype)[:, None]
    angle = x[:, None, :] * f
    sign = 1 if "cosine_gradient_sign" in wrong else -1
    slope = np.cos(angle) * waves[:, 0] + sign * np.sin(angle) * waves[:, 1]
    if "chain_factor_forgotten" not in wrong:
        slope = slope * f
    return slope.sum(1) + (0 if "identity_gradient_forgotten" in wrong else own)


def positional_encoding(a, c, wrong):
    """Equation 4."""
    return {"encoding": encode(a["x"], a["L"], c, wrong)}


def positional_encoding_vjp(a, c, wrong):
    """Its gradient."""
    return {"grad_x": encode_vjp(a["x"], a["L"], a["grad_encoding"], c, wrong)}


def sigmoid(z):
    """1 / (1 + e^-z), from the side that doesn't overflow."""
    e = np.exp(-np.abs(z))
    return np.where(z >= 0, 1 / (1 + e), e / (1 + e)).astype(z.dtype)


def head(z, wrong):
    """The color head's activation."""
    if "relu_before_sigmoid" in wrong:
        z = np.maximum(z, 0)
    return z if "sigmoid_missing" in wrong else sigmoid(z)


def spoiled(layers, wrong):
    """(w, b) of each layer as the mistakes have them."""
    out = []
    for n, (w, b) in enumerate(layers):
        square = w.shape[0] == w.shape[1]
        b = np.zeros_like(b) if "bias_forgotten" in wrong else b
        w = w.T if "weights_transposed" in wrong and square else w
        if "layer_never_applied" in wrong and square and n == 1:
            w, b = np.eye(len(w), dtype=w.dtype), np.zeros_like(b)
        out.append((w, b))
    return out


def plain_layers(a):
    """w0, b0, w1, ..."""
    count = sum(name[0] == "w" and name[1:].isdigit() for name in a)
    return [(a[f"w{n}"], a[f"b{n}"]) for n in range(count)]


def mlp(a, c, wrong):
    """ReLU between, sigmoid after."""
    h = a["x"]
    *hidden, (w, b) = spoiled(plain_layers(a), wrong)
    for v, d in hidden:
        z = h @ v.T + d
        h = np.maximum(z, 0)
        if "leaky_units" in wrong:
            h = np.where(z > 0, z, z.dtype.type(0.01) * z)
        if "smooth_units" in wrong:
            h = z * sigmoid(z)
    return {"y": head(h @ w.T + b, wrong)}


def back(name, g_z, h, w, out):
    """One layer: stores g_w and g_b, returns g_h."""
    weight, bias = name
    out[f"grad_{weight}"], out[f"grad_{bias}"] = g_z.T @ h, g_z.sum(0)
    return g_z @ w


def mlp_vjp(a, c, wrong):
    """From the last layer to the first."""
    layers, hs, zs = plain_layers(a), [a["x"]], []
    for w, b in layers:
        zs.append(hs[-1] @ w.T + b)
        hs.append(np.maximum(zs[-1], 0))
    g, out = a["grad_y"], {}
    if "sigmoid_gradient_missing" not in wrong:
        # sigmoid(z) sigmoid(-z): 1 - y would lose the digits of a saturated y.
        g = g * sigmoid(zs[-1]) * sigmoid(-zs[-1])
    for n in reversed(range(len(layers))):
        g = back((f"w{n}", f"b{n}"), g, hs[n], layers[n][0], out)
        if n > 0 and "relu_mask_on_output" not in wrong:
            g = g * (zs[n - 1] > 0)
    return out | {"grad_x": g}


def density(z, kind):
    """Density and its slope."""
    if kind == "exp":
        return np.exp(z), np.exp(z)
    if kind == "softplus":
        return np.logaddexp(z, np.zeros_like(z)), sigmoid(z)
    return np.maximum(z, 0), (z > 0).astype(z.dtype)


NAMES = [f"trunk{n}" for n in range(8)] + ["sigma", "feature", "color0", "color1"]


def nerf_tape(a, c, wrong):
    """Everything that forward and backward need."""
    layers = dict(zip(NAMES, spoiled([(a[f"{n}_w"], a[f"{n}_b"]) for n in NAMES], wrong)))
    own = 3 if c["identity"] == "true" else 0
    columns, width = a["trunk0_w"].shape[1], len(a["feature_w"])
    levels = ((columns - own) // 6, (a["color0_w"].shape[1] - width - own) // 6)
    c = c | OF_NETWORKS
    x, d = encode(a["positions"], levels[0], c, wrong), encode(a["directions"], levels[1], c, wrong)
    if "no_view_direction" in wrong:
        d = np.zeros_like(d)
    again = np.zeros_like(x) if "skip_omitted" in wrong else x
    h, hs, zs = x, [], []
    for n in range(8):
        w, b = layers[f"trunk{n}"]
        if n > 0 and w.shape[1] > width:
            h = np.concatenate([h, again] if c["skip_order"] == "hidden_first" else [again, h], 1)
        hs.append(h)
        zs.append(h @ w.T + b)
        h = zs[-1] if n == 7 and c["last_trunk"] == "none" else np.maximum(zs[-1], 0)
    apply = lambda name, h: h @ layers[name][0].T + layers[name][1]  # noqa: E731
    z_feature = apply("feature", h)
    feature = np.maximum(z_feature, 0) if c["feature"] == "relu" else z_feature
    inputs = np.concatenate([feature, d] if c["color_order"] == "feature_first" else [d, feature], 1)
    z0 = apply("color0", inputs)
    z1 = apply("color1", np.maximum(z0, 0))
    return dict(hs=hs, zs=zs, h=h, z_sigma=apply("sigma", h), z_feature=z_feature, inputs=inputs, z0=z0, z1=z1, level=levels[0])


def nerf_mlp(a, c, wrong):
    """Figure 7."""
    tape = nerf_tape(a, c, wrong)
    sigma = tape["z_sigma"] if "density_without_relu" in wrong else density(tape["z_sigma"], c["density"])[0]
    return {"sigmas": sigma[:, 0], "rgbs": head(tape["z1"], wrong)}


def nerf_mlp_vjp(a, c, wrong):
    """From the last layer to the first."""
    tape, out = nerf_tape(a, c, ()), {}
    opened = "relu_mask_on_output" in wrong
    g = a["grad_rgbs"]
    if "sigmoid_gradient_missing" not in wrong:
        g = g * sigmoid(tape["z1"]) * sigmoid(-tape["z1"])
    g = back(("color1_w", "color1_b"), g, np.maximum(tape["z0"], 0), a["color1_w"], out)
    g = back(("color0_w", "color0_b"), g if opened else g * (tape["z0"] > 0), tape["inputs"], a["color0_w"], out)
    width = len(a["feature_w"])
    g = g[:, :width] if c["color_order"] == "feature_first" else g[:, -width:]
    g = g * (tape["z_feature"] > 0) if c["feature"] == "relu" else g
    g = back(("feature_w", "feature_b"), g, tape["h"], a["feature_w"], out)
    g_sigma = a["grad_sigmas"][:, None] * density(tape["z_sigma"], c["density"])[1]
    g = g + back(("sigma_w", "sigma_b"), g_sigma, tape["h"], a["sigma_w"], out)
    columns, g_x = a["trunk0_w"].shape[1], 0
    for n in reversed(range(8)):
        linear = opened or (n == 7 and c["last_trunk"] == "none")
        g = back((f"trunk{n}_w", f"trunk{n}_b"), g if linear else g * (tape["zs"][n] > 0), tape["hs"][n], a[f"trunk{n}_w"], out)
        if n > 0 and a[f"trunk{n}_w"].shape[1] > width:
            first = c["skip_order"] != "hidden_first"
            g_again, g = (g[:, :columns], g[:, columns:]) if first else (g[:, width:], g[:, :width])
            g_x = 0 if "skip_gradient_forgotten" in wrong else g_again
    return out | {"grad_positions": encode_vjp(a["positions"], tape["level"], g + g_x, c | OF_NETWORKS)}
