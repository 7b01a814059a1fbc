"""Encodings and networks."""

import adapters.nerfstudio as nerfstudio_
import numpy as np
import scipy
import torch
from bases import beside, plain
from gsplat.cuda._torch_impl import _eval_sh_bases_fast
from nerfstudio.field_components.encodings import HashEncoding, NeRFEncoding


def moderate(case, x):
    """Arguments up to 2048 pi, whose rounding costs 2^12 ULP: the library rounds 2^k pi x before it takes the sine."""
    return np.max(np.abs(x["x"]), initial=0) * 2 ** (x["L"] - 1) <= 2048


@beside(
    "positional_encoding",
    "nerfstudio",
    "NeRFEncoding",
    "of x / 2, columns reordered; arguments to 2048 pi",
    moderate,
    within=4096,
)
def positional_encoding(x, L):
    """2 pi x / 2; sin of all (dimension, band), then cos: ours are by band."""
    size = x.shape[1]
    both = NeRFEncoding(size, L, 0.0, L - 1.0)(x / 2).unflatten(-1, (2, size, L))
    return {"encoding": torch.cat([x, both.permute(0, 3, 1, 2).flatten(1)], -1)}


def between_faces(case, x):
    """Points off all cells' faces, where every library has another one-sided derivative."""
    return case["kind"] == "forward" or not np.any(x["x"] * x["base"] % 1 == 0)


def whole(base, finest, levels):
    """Cells of every level."""
    return [round(base * (finest / base) ** (n / max(levels - 1, 1))) for n in range(levels)]


@beside(
    "hash_grid",
    "nerfstudio",
    "HashEncoding",
    "hashed levels, a module each; dense ones by torch's grid_sample(align_corners=True)",
    between_faces,
)
def hash_grid(x, base, finest, **tables):
    """Level by level."""
    found = []
    for level, n in enumerate(whole(base, finest, len(tables))):
        table = tables[f"table{level}"]
        size, features = table.shape
        if (n + 1) ** 3 <= size:
            volume = table[: (n + 1) ** 3].reshape(n + 1, n + 1, n + 1, features).permute(3, 0, 1, 2)[None]
            y = torch.nn.functional.grid_sample(volume, 2 * x[None, :, None, None] - 1, align_corners=True)
            found.append(y[0, :, :, 0, 0].T)
        else:
            grid = HashEncoding(1, n, n, size.bit_length() - 1, features, implementation="torch")
            del grid.hash_table
            grid.hash_table = table
            found.append(grid(x))
    return {"encoding": torch.cat(found, -1)}


@beside("spherical_harmonics", "gsplat", "_eval_sh_bases_fast", only=plain)
def spherical_harmonics(d, degree):
    """Sloan's recurrences."""
    return {"harmonics": _eval_sh_bases_fast((degree + 1) ** 2, d)}


def on_the_sphere(case, x):
    """Unit directions: scipy takes angles."""
    return plain(case, x) and np.all(np.abs(np.linalg.norm(x["d"], axis=-1) - 1) < 1e-15)


@beside(
    "spherical_harmonics", "scipy", "special.sph_harm_y", "real and imaginary parts, times the root of 2", on_the_sphere, "numpy"
)
def harmonics_scipy(d, degree):
    """By angles, with Legendre functions."""
    polar, azimuth = np.arctan2(np.hypot(d[:, 0], d[:, 1]), d[:, 2]), np.arctan2(d[:, 1], d[:, 0])
    columns = []
    for n in range(degree + 1):
        for m in range(-n, n + 1):
            y = scipy.special.sph_harm_y(n, abs(m), polar, azimuth)
            columns.append(y.real if m == 0 else np.sqrt(2) * (y.real if m > 0 else y.imag))
    return {"harmonics": np.stack(columns, -1)}


@beside("trunc_exp", "nerfstudio", "trunc_exp", only=plain)
def trunc_exp(x):
    """As it comes."""
    return {"sigmas": nerfstudio_.trunc_exp(x)}


@beside("mlp", "nerfstudio", "MLP", only=plain, within=4096)
def mlp(x, **parameters):
    """As it comes."""
    return {"y": nerfstudio_.mlp(x, **parameters)}
