"""volume_render(sigmas, rgbs, deltas): Max 1995, Mildenhall et al. 2020 eq. 3.

x_i = sigma_i delta_i,  alpha_i = 1 - exp(-x_i),  T_i = exp(-sum_{j<i} x_j),  w_i = T_i alpha_i,
colors = sum_i w_i c_i,  opacity = sum_i w_i = 1 - exp(-sum_j x_j),  transmittance = exp(-sum_j x_j).
"""

import math

import numpy as np
import torch
from kornia.nerf.volume_renderer import IrregularRenderer, RegularRenderer

from . import reals
from .fixture import Case, Draw

NAME, PURPOSE = "volume_render", 1011
DIFFERENTIABLE = ("sigmas", "rgbs", "deltas")
KORNIA_DIFFERENTIABLE = ("sigmas", "rgbs")


def cases():
    """Random rays in every regime, and the rows VR1 to VR10 of the hard cases that concern densities."""
    yield random("mixed", (3, 12), (0.0, 4.0), "sigma delta between 0 and 1: no regime dominates")
    yield random("ragged-VR10", (3, 8), (0.0, 2.0), "deltas that differ from ray to ray, by a factor of 50 and more")
    yield random("thin-VR1", (2, 16), (1e-9, 1e-6), "1 - exp(-x) cancels: 100% wrong in f32 at 1e-8")
    yield random("opaque", (2, 8), (400.0, 4000.0), "every sample opaque: w_0 is 1 to all digits")
    yield random("long", (1, 256), (0.0, 2.0), "256 samples", (0.015625, 0.015625))
    yield random("long-1024", (1, 1024), (0.0, 6.0), "1,024 samples of one width", (0.00390625, 0.00390625), vjp=False)
    ln2 = math.log(2.0)
    spikes = np.array([[ln2, ln2, 0.0, 0.0, ln2]])
    one_hot = np.array([[[1.0, 0, 0], [0, 1, 0], [0, 0, 0], [0, 0, 0], [0, 0, 1]]])
    yield case("spikes", spikes, one_hot, np.ones((1, 5)), "reads the weights .5, .25, .125 (ln 2 rounded to f64)")
    yield case("empty", np.zeros((1, 6)), random_colors("empty", 1, 6), np.full((1, 6), 0.0625), "no density anywhere")
    yield case("slab", np.full((1, 64), 0.75), random_colors("slab", 1, 64), np.full((1, 64), 0.0625), "1 - exp(-3)")
    opaque_second = np.array([[0.7, 1e4, 0.3, 0.2]])
    yield case("opaque-VR4", opaque_second, random_colors("opaque-VR4", 1, 4), np.ones((1, 4)), "nothing behind sample 1")
    far = np.array([[0.0, 1e-12, 1e-12], [0.5, 0.25, 0.0], [0.5, 0.25, 3.0]])
    last = np.array([[0.1, 0.1, 1e10]] * 3)
    yield case("last-delta-VR2", far, random_colors("last-delta-VR2", 3, 3), last, "a last step of 1e10: alpha 0.00995, 0 and 1")
    yield case("one-sample-VR9", np.array([[0.3]]), random_colors("one-sample", 1, 1), np.array([[0.5]]), "one sample")
    yield case("no-samples-VR9", np.zeros((2, 0)), np.zeros((2, 0, 3)), np.zeros((2, 0)), "no samples: black, T = 1")
    extremes = np.array([[1e-300, 1e-30, 1e30, 1e300], [1e300, 1e300, 1e-300, 0.0], [1e-300, 1e-300, 1e-300, 1e-300]])
    steps = np.array([[1.0, 1.0, 1e-30, 1.0], [1e-300, 1e10, 1.0, 1.0], [1e-10, 1.0, 1.0, 1.0]])
    note = "sigma from 1e-300 to 1e300; 1e310 overflows to an opaque sample; 1e-310 is subnormal"
    yield case("extremes-VR9", extremes, random_colors("extremes", 3, 4), steps, note)
    deep = np.array([[100.0, 300.0, 310.0, 20.0, 10.0, 5.0, 100.0]])
    yield case("underflow-VR9", deep, random_colors("underflow", 1, 7), np.ones((1, 7)), "T falls through the subnormals to 0")
    yield many()


def kornia_cases():
    """Both renderers, 1e-10 in the product; the regular one takes the first step of ray 0 for the whole batch."""
    eps = {"product_eps": "1e-10"}
    sixteenths = np.floor(Draw(PURPOSE, "steps").uniform((3, 8), 1.0, 16.0)) / 16.0
    irregular = random("irregular", (3, 8), (0.0, 3.0), "IrregularRenderer, last step 1e10")
    irregular.inputs["deltas"] = np.concatenate([sixteenths[:, :-1], np.full((3, 1), 1e10)], axis=1)
    spacing = np.array([[0.125], [0.25], [0.0625]])
    regular = random("regular", (3, 8), (0.0, 3.0), "RegularRenderer on rays of different spacing: .139 for .289 is possible")
    regular.inputs["deltas"] = np.broadcast_to(spacing, (3, 8))
    regular.quirks = {"ray0_spacing": True}
    same = random("regular-same", (2, 8), (0.0, 3.0), "RegularRenderer on rays of one spacing")
    same.inputs["deltas"] = np.full((2, 8), 0.125)
    empty = random("empty-VR3", (1, 64), (0.0, 0.0), "64 empty samples: a weight behind them exceeds 1 by 6.3e-9")
    empty.inputs |= {"deltas": np.full((1, 64), 0.125), "sigmas": np.array([[0.0] * 63 + [800.0]])}
    for case_ in (irregular, regular, same, empty):
        case_.conventions, case_.outputs = eps, ("colors",)
        yield case_


def random(name, shape, sigma_range, comment, step_range=(0.005, 0.25), vjp=True):
    """Uniform densities, colors and steps."""
    draw = Draw(PURPOSE, name)
    rays, samples = shape
    sigmas, rgbs = draw.uniform(shape, *sigma_range), draw.uniform((rays, samples, 3))
    return case(name, sigmas, rgbs, draw.uniform(shape, *step_range), comment, vjp=vjp)


def case(name, sigmas, rgbs, deltas, comment, **more):
    """A case from its three arrays."""
    return Case(name, {"sigmas": sigmas, "rgbs": rgbs, "deltas": deltas}, comment, **more)


def random_colors(name, rays, samples):
    """Random colors for a case whose densities are written out."""
    return Draw(PURPOSE, name).uniform((rays, samples, 3))


def many():
    """1e5 samples; a pattern of 16 repeated keeps the file small, and the weights are left out for the same reason."""
    period = Draw(PURPOSE, "many-VR9").uniform((16, 4))
    tiled = np.tile(period, (6250, 1))
    sigmas, deltas = tiled[None, :, 3], np.full((1, 100_000), 2.0**-16)
    comment = "1e5 samples on one ray"
    kept = ("colors", "opacity", "transmittance")
    return case("many-VR9", sigmas, tiled[None, :, :3], deltas, comment, vjp=False, outputs=kept)


def over_reals(x):
    """The definition, ray by ray; with eps in the product where the conventions say so."""
    rays, samples = x["sigmas"].shape
    out = {"colors": np.empty((rays, 3), object), "weights": np.empty((rays, samples), object)}
    out |= {"opacity": np.empty(rays, object), "transmittance": np.empty(rays, object)}
    for r in range(rays):
        row = 0 if "ray0_spacing" in x["quirks"] else r
        render = with_eps if x["conventions"].get("product_eps") == "1e-10" else without_eps
        out["weights"][r], out["opacity"][r], out["transmittance"][r] = render(x["sigmas"][r], x["deltas"][row])
        for c in range(3):
            out["colors"][r, c] = reals.dot(out["weights"][r], x["rgbs"][r, :, c])
    return out


def without_eps(sigmas, deltas):
    """Weights, opacity and transmittance of one ray."""
    weights, depth = [], reals.Real(0)
    for sigma, delta in zip(sigmas, deltas):
        weights.append(reals.exp(-depth) * -reals.expm1(-(sigma * delta)))
        depth = depth + sigma * delta
    return weights, -reals.expm1(-depth), reals.exp(-depth)


def with_eps(sigmas, deltas):
    """The same with 1e-10 added to every factor 1 - alpha = exp(-sigma delta)."""
    weights, transmittance = [], reals.Real(1)
    for sigma, delta in zip(sigmas, deltas):
        weights.append(transmittance * -reals.expm1(-(sigma * delta)))
        transmittance = transmittance * (reals.exp(-(sigma * delta)) + 1e-10)
    return weights, reals.total(weights), transmittance


def in_torch(x):
    """cumsum for the optical depth.

    torch differentiates expm1 as its result + 1, which is 0 where e^-x is below 2^-53: expm1 for thin samples alone.
    """
    steps = x["sigmas"] * x["deltas"]
    depth = torch.cumsum(torch.nn.functional.pad(steps, (1, 0)), -1)
    before, whole = depth[:, :-1], steps.sum(-1)
    weights = torch.exp(-before) * opacity(steps)
    colors = (weights[..., None] * x["rgbs"]).sum(-2)
    return {"colors": colors, "weights": weights, "opacity": opacity(whole), "transmittance": torch.exp(-whole)}


def opacity(depth):
    """1 - exp(-depth) with its digits, forward and backward."""
    return torch.where(depth < 0.5, -torch.expm1(-depth), 1.0 - torch.exp(-depth))


def in_kornia(x):
    """kornia.nerf.volume_renderer: the regular one where all steps of a ray are equal; points along an axis."""
    deltas = x["deltas"]
    regular = bool((deltas == deltas[:, :1]).all())
    t = torch.nn.functional.pad(torch.cumsum(deltas, -1), (1, 0))[:, :-1]
    points = torch.nn.functional.pad(t[..., None], (0, 2))
    renderer = RegularRenderer() if regular else IrregularRenderer()
    return {"colors": renderer(x["rgbs"], x["sigmas"][..., None], points)}
