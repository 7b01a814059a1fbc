"""render_trace: image_rays, sample_along_rays, step_sizes, volume_render and composite_background one after the other."""

import numpy as np

from . import composite_background, image_rays, pixel_to_ray, sample_along_rays, step_sizes, volume_render
from .fixture import Case, Draw

NAME, PURPOSE = "render_trace", 1019
DIFFERENTIABLE = ()
CAMERA = ("height", "width", "focal", "cx", "cy", "c2w")
DIFFERENCES = {"delta": "differences", "last_delta": "to_far"}


def cases():
    """A picture that is not square, its center off the middle, under a random pose, over a background of three colors."""
    yield case("jittered", (3, 4, 5), "an independent u for every pixel and sample")
    yield case("differences", (2, 3, 4), "steps by differences, the last one to far", DIFFERENCES)
    yield case("dense", (1, 2, 32), "32 samples at rest", u=0.5)


def case(name, shape, comment, conventions=None, u=None):
    """Densities in [0, 3), random colors."""
    draw, (height, width, _) = Draw(PURPOSE, name), shape
    inputs = {"height": height, "width": width, "focal": 4.375, "cx": 0.625 * width, "cy": 0.375 * height}
    inputs |= {"c2w": pixel_to_ray.poses(draw, 1)[0], "near": 2.0, "far": 6.0}
    inputs |= {"u": draw.uniform(shape) if u is None else np.full(shape, u)}
    inputs |= {"sigmas": draw.uniform(shape, 0.0, 3.0), "rgbs": draw.uniform((*shape, 3))}
    return Case(name, inputs | {"background": np.array([1.0, 0.25, 0.5])}, comment, conventions=conventions or {})


def trace(x, basis):
    """All arrays in one basis, whose components take one row a ray."""
    height, width, samples = x["u"].shape
    settings = {"conventions": x["conventions"], "quirks": x["quirks"]}
    seen = basis(image_rays)({name: x[name] for name in CAMERA} | settings)
    rays = {name: seen[name].reshape(-1, 3) for name in ("rays_o", "rays_d")}
    ends = {"near": x["near"], "far": x["far"]} | settings
    t = basis(sample_along_rays)(rays | ends | {"u": x["u"].reshape(-1, samples)})["t"]
    deltas = basis(step_sizes)({"t": t} | ends)["deltas"]
    ray = {"sigmas": x["sigmas"].reshape(-1, samples), "rgbs": x["rgbs"].reshape(-1, samples, 3), "deltas": deltas}
    rendered = basis(volume_render)(ray | settings)
    over = {"colors": rendered["colors"], "opacity": rendered["opacity"], "background": x["background"]}
    colors = basis(composite_background)(over)["colors_out"]
    per_sample = {"t": t, "deltas": deltas, "weights": rendered["weights"]}
    shaped = {name: value.reshape(height, width, samples) for name, value in per_sample.items()}
    return seen | shaped | {"colors": colors.reshape(height, width, 3)}


def over_reals(x):
    """The definition."""
    return trace(x, lambda component: component.over_reals)


def in_torch(x):
    """The torch counterparts of the same components."""
    return trace(x, lambda component: component.in_torch)
