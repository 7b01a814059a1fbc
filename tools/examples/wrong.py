"""A wrong one: the sample shades itself. `python wrong.py CASES ANSWERS`; what the judge says is in ../README.md."""

import sys
from pathlib import Path

import torch

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from candidate import run  # noqa: E402


def volume_render(sigmas, rgbs, deltas):
    """The cumulative product of 1 - alpha as it comes, without the shift by one sample."""
    alpha = 1 - torch.exp(-sigmas * deltas)
    transmittance = torch.cumprod(1 - alpha, -1)
    weights = transmittance * alpha
    return (weights[..., None] * rgbs).sum(-2), weights, weights.sum(-1)


if __name__ == "__main__":
    run(*sys.argv[1:], volume_render=volume_render)
