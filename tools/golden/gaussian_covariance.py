"""gaussian_covariance(quaternions, scales): R diag(s)^2 R^T, R the rotation of q / |q| (Kerbl et al. 2023, equation 6)."""

import numpy as np
import torch

from . import reals
from .fixture import Case, Draw
from .portable import power_of_ten

NAME, PURPOSE = "gaussian_covariance", 1301
DIFFERENTIABLE = ("quaternions", "scales")


def cases():
    """Usual ones, far from unit, needles, half turns; each form of quaternions and scales."""
    forms = [{}, {"quaternion_order": "xyzw"}, {"quaternion_length": "as_given"}, {"splat_scale": "log"}]
    for conventions in forms:
        tag = "-".join(conventions.values()) or "usual"
        q, s = Draw(PURPOSE, "q").uniform((8, 4), -1.0, 1.0), Draw(PURPOSE, "s").uniform((8, 3), 0.05, 1.5)
        yield case(tag, q, s, "lengths around 1", conventions)
    for length in (2.0**-20, 1e3):
        q, s = Draw(PURPOSE, "far").uniform((4, 4), -length, length), Draw(PURPOSE, "t").uniform((4, 3), 0.05, 1.5)
        yield case(f"GS1-{length:.0e}", q, s, "far from unit")
    sizes = power_of_ten(Draw(PURPOSE, "needles").uniform((6, 3), -5.0, 1.0))
    yield case("GS2-needles", Draw(PURPOSE, "n").uniform((6, 4), -1.0, 1.0), sizes, "variances far apart")
    yield case("half-turns", np.eye(4), np.tile([0.5, 0.25, 0.125], (4, 1)), "no turn, and half turns")


def case(name, quaternions, scales, comment, conventions=None):
    """A case from its Gaussians."""
    return Case(name, {"quaternions": quaternions, "scales": scales}, comment, conventions=conventions or {})


def settings(x):
    """Order, length and scale of a case."""
    defaults = {"quaternion_order": "wxyz", "quaternion_length": "divided", "splat_scale": "plain"}
    return (defaults | x["conventions"]).values()


def rotation(w, x, y, z, one, two):
    """The rotation's rows, `two` in front of all products."""
    return [
        [one - two * (y * y + z * z), two * (x * y - w * z), two * (x * z + w * y)],
        [two * (x * y + w * z), one - two * (x * x + z * z), two * (y * z - w * x)],
        [two * (x * z - w * y), two * (y * z + w * x), one - two * (x * x + y * y)],
    ]


def covariance(q, s, order, length, scale):
    """The definition of one Gaussian."""
    q = q if order == "wxyz" else [q[3], q[0], q[1], q[2]]
    if length == "divided":
        inverse = reals.sqrt(reals.dot(q, q)).reciprocal()
        q = [x * inverse for x in q]
    s = [reals.exp(x) for x in s] if scale == "log" else s
    m = [[x * s[k] for k, x in enumerate(row)] for row in rotation(*q, 1, 2)]
    return [[reals.dot(a, b) for b in m] for a in m]


def over_reals(x):
    """The definition, one by one."""
    form = list(settings(x))
    return {"covariances": np.array([covariance(list(q), list(s), *form) for q, s in zip(x["quaternions"], x["scales"])])}


def in_torch(x):
    """2/|q|^2 in front of the products, so that nothing is divided by a root; R diag(s^2) R^T."""
    order, length, scale = settings(x)
    q, s = x["quaternions"], x["scales"]
    w, a, b, c = q.unbind(-1) if order == "wxyz" else q.roll(1, -1).unbind(-1)
    two = 2 / (q * q).sum(-1) if length == "divided" else 2.0
    r = torch.stack([torch.stack(row, -1) for row in rotation(w, a, b, c, 1, two)], -2)
    variances = torch.exp(2 * s) if scale == "log" else s * s
    return {"covariances": torch.einsum("mik,mk,mjk->mij", r, variances, r)}
