"""gaussian_color(means, camera_center, coefficients): max(sum_k f_k Y_k(d / |d|) + 1/2, 0), d = mean - center (Kerbl et al. 2023)."""

import numpy as np
import torch

from . import reals, spherical_harmonics
from .fixture import Case, Draw

NAME, PURPOSE = "gaussian_color", 1319
DIFFERENTIABLE = ("means", "coefficients")


def cases():
    """Each degree, both signs, each form of the color; near, far, and channels below 0."""
    for degree in range(4):
        yield case(f"degree-{degree}", degree, 4.0, 0.5, "from every side")
    yield case("plain", 3, 4.0, 0.5, "without (-1)^m", {"harmonic_sign": "plain"})
    yield case("shifted", 3, 4.0, 0.5, "not clamped", {"splat_color": "shifted"})
    yield case("sum", 2, 4.0, 0.5, "the sum alone", {"splat_color": "sum"})
    yield case("below-GS6", 3, 4.0, -1.75, "channels below 0")
    yield case("near", 3, 0.01, 0.5, "at a hundredth of a unit")
    yield case("far", 3, 1e6, 0.5, "at a million units")


def case(name, degree, distance, first, comment, conventions=None):
    """Six splats within a distance, and their coefficients."""
    coefficients = Draw(PURPOSE, name).uniform((6, (degree + 1) ** 2, 3), -0.25, 0.25)
    coefficients[:, 0] += first
    center = np.array([0.5, -0.25, 1.5])
    means = center + Draw(PURPOSE, name + "d").uniform((6, 3), -distance, distance)
    return Case(name, {"means": means, "camera_center": center, "coefficients": coefficients}, comment, conventions=conventions or {})


def signs(width, conventions):
    """-1 for the harmonics of odd m where the sign (-1)^m is left out."""
    plain = conventions.get("harmonic_sign") == "plain"
    return [-1 if plain and n % 2 else 1 for n in range(width)]


def over_reals(x):
    """The definition, splat by splat."""
    form, one = x["conventions"].get("splat_color", "clamped"), reals.Real(1)

    def root(a, b):
        return one * reals.mp.sqrt(reals.mpf(a) / (b * reals.mp.pi))

    rows = []
    for mean, f in zip(x["means"], x["coefficients"]):
        d = [m - c for m, c in zip(mean, x["camera_center"])]
        inverse = reals.sqrt(reals.dot(d, d)).reciprocal()
        values = spherical_harmonics.polynomials(*[k * inverse for k in d], root)[: len(f)]
        y = [value * sign for value, sign in zip(values, signs(len(f), x["conventions"]))]
        sums = [reals.dot(y, f[:, channel]) for channel in range(3)]
        sums = sums if form == "sum" else [s + 0.5 for s in sums]
        rows.append([reals.relu(s) for s in sums] if form == "clamped" else sums)
    return {"colors": np.array(rows, dtype=object)}


def in_torch(x):
    """The same in torch, all splats at once."""
    form = x["conventions"].get("splat_color", "clamped")
    d, f = x["means"] - x["camera_center"], x["coefficients"]
    u = d / torch.linalg.vector_norm(d, dim=-1, keepdim=True)

    def root(a, b):
        return torch.sqrt(torch.tensor(a / (b * torch.pi), dtype=torch.float64)).expand(len(d))

    y = torch.stack(spherical_harmonics.polynomials(u[:, 0], u[:, 1], u[:, 2], root)[: f.shape[1]], -1)
    total = torch.einsum("mk,mkc->mc", y * torch.tensor(signs(f.shape[1], x["conventions"])), f)
    total = total if form == "sum" else total + 0.5
    return {"colors": total.clamp_min(0) if form == "clamped" else total}
