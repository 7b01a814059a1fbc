"""Kernels that the tests judge."""

import numpy as np
import pytest

pytest_plugins = "pytester"


def render(sigmas, rgbs, deltas):
    """Right: colors, weights."""
    depth = sigmas * deltas
    front = np.cumsum(np.concatenate([np.zeros_like(depth[:, :1]), depth[:, :-1]], 1), 1)
    weights = -np.expm1(-depth) * np.exp(-front)
    return (weights[..., None] * rgbs).sum(1), weights


def shaded_by_itself(sigmas, rgbs, deltas):
    """Wrong: the product isn't moved by one sample."""
    alpha = 1 - np.exp(-sigmas * deltas)
    weights = np.cumprod(1 - alpha, -1) * alpha
    return (weights[..., None] * rgbs).sum(1), weights


@pytest.fixture
def ray():
    """Inputs of volume_render: five rays of seven samples."""
    draw = np.random.default_rng(1)
    return {"sigmas": draw.random((5, 7)) * 3, "rgbs": draw.random((5, 7, 3)), "deltas": np.full((5, 7), 0.25)}
