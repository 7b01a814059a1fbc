"""pose_from_colmap(q, t): camera to world of COLMAP's quaternion (w, x, y, z) and translation, which go from world to camera."""

import numpy as np
import torch

from . import reals
from .fixture import Case, Draw

NAME, PURPOSE = "pose_from_colmap", 1242
DIFFERENTIABLE = ("q", "t")


def cases():
    """Each length of quaternion with each kind of axes; half turns, no turn, far away."""
    for axes in ("opencv", "opengl"):
        for length in ("normalized", "as_given"):
            conventions = {"axes": axes, "quaternion": length}
            tag = f"{axes}-{length}"
            draw = Draw(PURPOSE, tag)
            q = draw.uniform((6, 4), -1.0, 1.0)
            unit = q / np.sqrt((q * q).sum(1, keepdims=True))
            t = draw.uniform((6, 3), -4.0, 4.0)
            yield Case(f"unit-{tag}", {"q": unit, "t": t}, "of length 1", conventions=conventions)
            yield Case(f"any-{tag}", {"q": q, "t": t}, "of any length", conventions=conventions)
    yield Case("half-turns", {"q": np.eye(4), "t": Draw(PURPOSE, "half").uniform((4, 3), -4.0, 4.0)}, "about each axis, and none")
    far = Draw(PURPOSE, "far").uniform((3, 3), -1e6, 1e6)
    yield Case("far-CG9", {"q": Draw(PURPOSE, "turn").uniform((3, 4), -1.0, 1.0), "t": far}, "a million away")


def settings(x):
    """Axes and length of a case."""
    return x["conventions"].get("axes", "opencv"), x["conventions"].get("quaternion", "normalized")


def over_reals(x):
    """The definition: R by its entries, transposed, and the place."""
    axes, length = settings(x)
    zero, one = reals.Real(0), reals.Real(1)
    found = []
    for q, t in zip(x["q"], x["t"], strict=True):
        w, i, j, k = q
        s = reals.dot(q, q).reciprocal() * 2.0 if length == "normalized" else reals.Real(2)
        r = [
            [1 - s * (j * j + k * k), s * (i * j - w * k), s * (i * k + w * j)],
            [s * (i * j + w * k), 1 - s * (i * i + k * k), s * (j * k - w * i)],
            [s * (i * k - w * j), s * (j * k + w * i), 1 - s * (i * i + j * j)],
        ]
        signs = [1, 1, 1] if axes == "opencv" else [1, -1, -1]
        rows = []
        for a in range(3):
            column = [r[b][a] for b in range(3)]
            rows.append([*(column[b] if signs[b] > 0 else -column[b] for b in range(3)), -reals.dot(column, t)])
        found.append([*rows, [zero, zero, zero, one]])
    return {"c2w": np.array(found, dtype=object)}


def in_torch(x):
    """The matrix of quaternion products q p q*, and an inverse as codes have it: of the 4x4 matrix where that is the transpose."""
    axes, length = settings(x)
    q, t = x["q"], x["t"]
    if length == "normalized":
        q = torch.nn.functional.normalize(q, dim=-1)
    vector, w = q[:, 1:], q[:, :1]
    a, b, c = vector.unbind(-1)
    zero = torch.zeros_like(a)
    cross = torch.stack([zero, -c, b, c, zero, -a, -b, a, zero], -1).reshape(-1, 3, 3)
    r = torch.eye(3) + 2 * w[:, :, None] * cross + 2 * cross @ cross
    back = r.transpose(1, 2)
    place = -(back @ t[:, :, None])
    signs = torch.tensor([1.0, 1.0, 1.0] if axes == "opencv" else [1.0, -1.0, -1.0])
    last = torch.tensor([0.0, 0.0, 0.0, 1.0]).expand(len(q), 1, 4)
    return {"c2w": torch.cat([torch.cat([back * signs, place], -1), last], 1)}
