"""gaussian_projection(means, covariances, w2c, K, width, height): a Gaussian in a picture (Zwicker et al. 2001; Kerbl et al. 2023)."""

import mpmath
import numpy as np
import torch

from . import reals
from .fixture import Case, Draw
from .portable import product

NAME, PURPOSE = "gaussian_projection", 1303
DIFFERENTIABLE = ("means", "covariances")
K = np.array([[40.0, 0.0, 28.0], [0.0, 44.0, 26.0], [0.0, 0.0, 1.0]])
PAIRS = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)]
DEFAULTS = {
    "splat_center": "half",
    "splat_dilation": "0.3",
    "splat_clamp": "picture",
    "splat_clamp_gradient": "through",
    "radius_floor": "0.1",
    "compensation_floor": "none",
    "splat_culling": "kept",
}


def cases():
    """In the picture and beside it, in each convention; small ones, clouds, and what has no area."""
    inria = {"splat_center": "integer", "splat_clamp": "centered", "compensation_floor": "0.005"}
    for conventions in [{}, inria, {"splat_dilation": "0.1", "radius_floor": "none"}, {"splat_clamp": "none", "radius_floor": "0.01"}]:
        tag = "-".join(conventions.values()) or "usual"
        yield case(f"in-{tag}", 6, 0.6, 0.5, "in the picture", conventions)
        yield case(f"beside-{tag}-GS3", 6, 4.0, 0.5, "beside it, the most of them", conventions)
    yield case("small", 6, 0.5, 0.02, "less than a pixel")
    yield case("clouds", 4, 0.5, 10.0, "as large as the scene")
    yield case("points-GS4", 3, 0.5, 0.0, "the dilation alone", vjp=False)
    yield case("beside-culled-GS3", 6, 4.0, 0.5, "some of them too far beside it", {"splat_culling": "zero"})
    for floor in ["determinants_1e-6", "determinants_1e-12"]:
        yield case(f"small-{floor}", 6, 0.5, 0.002, "some of their determinants at the floor", {"compensation_floor": floor}, vjp=False)
        yield case(f"points-{floor}-GS4", 3, 0.5, 0.0, "the floor alone", {"compensation_floor": floor}, vjp=False)


def case(name, count, slopes, size, comment, conventions=None, vjp=True):
    """A case of `count` Gaussians with slopes and deviations up to these."""
    q = Draw(PURPOSE, "pose").uniform((4,), -1.0, 1.0)
    w, x, y, z = q / np.sqrt(np.sum(q * q))
    rotation = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
    w2c = np.eye(4)
    w2c[:3, :3], w2c[:3, 3] = rotation, [0.5, -0.25, 1.5]
    depth = Draw(PURPOSE, name + "z").uniform((count, 1), 1.0, 6.0)
    t = np.concatenate([Draw(PURPOSE, name).uniform((count, 2), -slopes, slopes) * depth, depth], 1)
    half = Draw(PURPOSE, name + "s").uniform((count, 3, 3), -size, size)
    sigma = product(half, half.transpose(0, 2, 1))
    inputs = {"means": product(t - w2c[:3, 3], rotation), "covariances": np.stack([sigma[:, i, j] for i, j in PAIRS], 1)}
    inputs |= {"w2c": w2c, "K": K, "width": np.array(64.0), "height": np.array(48.0)}
    return Case(name, inputs, comment, conventions=conventions or {}, vjp=vjp)


def limits(f, center, size, clamp):
    """The least and the largest slope, exact numbers of f64 in the reference's own order aside."""
    half = size / 2 / f
    if clamp == "none":
        return None
    if clamp == "centered":
        return -half * 1.3, half * 1.3
    return -(center / f + half * 0.3), (size - center) / f + half * 0.3


def entries(s):
    """The matrix of six numbers."""
    return [[s[0], s[1], s[2]], [s[1], s[3], s[4]], [s[2], s[4], s[5]]]


def quadratic(p, sigma, q):
    """p^T Sigma q."""
    return reals.dot(p, [reals.dot(row, q) for row in sigma])


def floors(c):
    """The least determinant and the least compensation."""
    floor = c["compensation_floor"]
    return float(floor[13:]) if floor.startswith("determinants_") else -np.inf, 0.005 if floor == "0.005" else 0.0


def splat(mean, sigma, x, c):
    """The definition of one Gaussian."""
    w2c, k = x["w2c"], x["K"]
    t = [reals.total([reals.dot(w2c[i][:3], mean), w2c[i][3]]) for i in range(3)]
    deep = t[2].reciprocal()
    rows, place = [], []
    for axis, size in ((0, "width"), (1, "height")):
        f, center = k[axis, axis].value, k[axis, 2].value
        slope = t[axis] * deep
        shift = 0.5 if c["splat_center"] == "integer" else 0
        place.append(reals.total([slope * f, reals.real(center), reals.real(-shift)]))
        found = limits(f, center, x[size].item().value, c["splat_clamp"])
        if found and not found[0] < slope.value < found[1]:
            slope = reals.constant(found[0] if slope.value < found[0] else found[1])
        rows.append([(reals.real(w2c[axis][j]) - slope * w2c[2][j]) * deep * f for j in range(3)])
    sigma = entries(sigma)
    p, q = rows
    h = float(c["splat_dilation"])
    before = quadratic(p, sigma, p), quadratic(p, sigma, q), quadratic(q, sigma, q)
    a, b, c_ = before[0] + h, before[1], before[2] + h
    det = a * c_ - b * b
    inverse = det.reciprocal()
    least, floor = floors(c)
    held = [one if one.value > least else reals.constant(least) for one in (before[0] * before[2] - b * b, det)]
    ratio = held[0] * held[1].reciprocal()
    root = reals.sqrt(ratio) if ratio.value > 0 else reals.real(0)
    compensation = root if root.value > floor else reals.constant(floor)
    half = (a.value - c_.value) / 2
    flat = 0.0 if c["radius_floor"] == "none" else float(c["radius_floor"])
    larger = (a.value + c_.value) / 2 + mpmath.sqrt(max(half**2 + b.value**2, flat))
    radius = reals.real(mpmath.ceil(3 * mpmath.sqrt(larger)))
    ends = [(place[n].value - radius.value, place[n].value + radius.value, x[size].item().value) for n, size in enumerate(["width", "height"])]
    if c["splat_culling"] == "zero" and not all(low < size and high > 0 for low, high, size in ends):
        zero = reals.constant(0)
        return [zero] * 2, [zero] * 3, [zero] * 3, zero, zero, zero
    return place, [a, b, c_], [c_ * inverse, -(b * inverse), a * inverse], t[2], radius, compensation


def over_reals(x):
    """The definition, one by one."""
    c = DEFAULTS | x["conventions"]
    found = [splat(list(mean), list(sigma), x, c) for mean, sigma in zip(x["means"], x["covariances"])]
    names = ["means2d", "covariances2d", "conics", "depths", "radii", "compensations"]
    return {name: np.array([one[n] for one in found], dtype=object) for n, name in enumerate(names)}


def in_torch(x):
    """Sigma turned to the camera's axes first, J as a matrix, the inverse as one."""
    c = DEFAULTS | x["conventions"]
    rotation, k = x["w2c"][:3, :3], x["K"]
    t = x["means"] @ rotation.T + x["w2c"][:3, 3]
    slopes = t[:, :2] / t[:, 2:]
    focal, center = torch.stack([k[0, 0], k[1, 1]]), k[:2, 2]
    shift = 0.5 if c["splat_center"] == "integer" else 0.0
    held = slopes
    if c["splat_clamp"] != "none":
        sizes = torch.stack([torch.as_tensor(float(x["width"])), torch.as_tensor(float(x["height"]))])
        low, high = limits(focal, center, sizes, c["splat_clamp"])
        held = torch.minimum(torch.maximum(slopes, low), high)
    zero = torch.zeros_like(t[:, 0])
    scale = focal / t[:, 2:]
    j = torch.stack([scale[:, 0], zero, -scale[:, 0] * held[:, 0], zero, scale[:, 1], -scale[:, 1] * held[:, 1]], -1).view(-1, 2, 3)
    full = x["covariances"][:, [0, 1, 2, 1, 3, 4, 2, 4, 5]].view(-1, 3, 3)
    before = j @ (rotation @ full @ rotation.T) @ j.mT
    after = before + float(c["splat_dilation"]) * torch.eye(2)
    conic = torch.linalg.inv(after)
    least, floor = floors(c)
    ratio = torch.clamp(torch.linalg.det(before), min=least) / torch.clamp(torch.linalg.det(after), min=least)
    root = torch.where(ratio > 0, torch.sqrt(torch.where(ratio > 0, ratio, torch.ones_like(ratio))), 0 * ratio)
    flat = 0.0 if c["radius_floor"] == "none" else float(c["radius_floor"])
    a, b, d = after[:, 0, 0], after[:, 0, 1], after[:, 1, 1]
    larger = (a + d) / 2 + torch.sqrt(torch.clamp((a - d) ** 2 / 4 + b * b, min=flat))
    both = lambda m: torch.stack([m[:, 0, 0], (m[:, 0, 1] + m[:, 1, 0]) / 2, m[:, 1, 1]], -1)
    means, radii = slopes * focal + center - shift, torch.ceil(3 * torch.sqrt(larger))
    size = torch.tensor([float(x["width"]), float(x["height"])])
    reach = radii[:, None].detach()
    seen = ((means - reach < size) & (means + reach > 0)).all(1) if c["splat_culling"] == "zero" else radii > 0
    out = {
        "means2d": means,
        "covariances2d": both(after),
        "conics": both(conic),
        "depths": t[:, 2],
        "radii": radii,
        "compensations": torch.where(root > floor, root, torch.full_like(root, floor)),
    }
    return {name: torch.where(seen[:, None] if each.dim() == 2 else seen, each, 0 * each) for name, each in out.items()}
