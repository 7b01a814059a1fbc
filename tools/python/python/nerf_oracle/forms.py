"""Inputs in the forms that functions take in their place: one step for all, positions for steps, a matrix for focal and
center."""

from __future__ import annotations

from typing import Any

import numpy as np

from .frameworks import Framework


def in_other_forms(framework: Framework, arrays: dict[str, Any], wanted: set[str]) -> dict[str, Any]:
    """The arrays that stand in for others, in those of the case's forms that a function takes."""
    out: dict[str, Any] = {}
    if "K" in wanted:
        focal, cx, cy = (arrays[name] for name in ("focal", "cx", "cy"))
        K = np.array([[focal, 0, cx], [0, focal, cy], [0, 0, 1]], float)
        out["K"] = framework.array(K, "f64" if framework.dtype == "f64" else "f32")
    if "step" in wanted:
        deltas = arrays["deltas"]
        out["step"] = float(deltas.reshape(-1)[0]) if deltas.shape[-1] else 1.0
    if "t" in wanted:
        out.update(positions(framework, arrays))
    return out


def positions(framework: Framework, arrays: dict[str, Any]) -> dict[str, Any]:
    """Steps as positions, and behind the last of them an empty sample, for a last step of the function's own."""
    join, deltas = framework.module.concatenate, arrays["deltas"]
    t = [framework.zeros((*deltas.shape[:-1], 1), deltas)]
    for i in range(deltas.shape[-1]):
        t.append(t[-1] + deltas[..., i : i + 1])

    # Samples are counted from behind: steps that all rays share have no axis of rays.
    def padded(x: Any, behind: int) -> Any:
        axis = x.ndim - 1 - behind
        return join([x, framework.zeros((*x.shape[:axis], 1, *x.shape[axis + 1 :]), x)], axis)

    return {"t": join(t, deltas.ndim - 1), "sigmas": padded(arrays["sigmas"], 0), "rgbs": padded(arrays["rgbs"], 1)}
