"""to_uint8(image): 255 x with x clipped to [0, 1], rounded with halves away from 0; by convention cut off."""

import mpmath
import numpy as np
import torch

from .fixture import Case, Draw
from .reals import Real

NAME, PURPOSE = "to_uint8", 1017
DIFFERENTIABLE = ()


def cases():
    """Values in and beyond [0, 1], every byte's own value, and the one exact tie."""
    picture = Draw(PURPOSE, "picture").uniform((4, 5, 3), -0.5, 1.5)
    yield Case("picture", {"image": picture}, "a third of the entries lies outside [0, 1]")
    yield Case("truncated", {"image": picture}, "cut off in place of rounded", conventions={"bytes": "truncate"})
    bytes_ = (np.arange(256) / 255.0).reshape(16, 16, 1).repeat(3, axis=2)
    yield Case("every-byte", {"image": bytes_}, "k / 255 comes back as k")
    ends = np.array([[[-0.0, 0.0, 1.0], [0.5, 1.01, -1e300], [1e300, 5e-324, 1.0 - 2.0**-53]]])
    yield Case("ends", {"image": ends}, "0.5 is the exact tie 127.5 and gives 128; 1.01 gives 255, not 1")


def over_reals(x):
    """The definition, entry by entry; halves upwards."""
    out = np.empty(x["image"].shape, object)
    shift = mpmath.mpf(0) if x["conventions"].get("bytes") == "truncate" else mpmath.mpf(0.5)
    for index in np.ndindex(out.shape):
        clipped = min(max(x["image"][index].value, mpmath.mpf(0)), mpmath.mpf(1))
        out[index] = Real(mpmath.floor(255 * clipped + shift))
    return {"bytes": out}


def in_torch(x):
    """clamp and floor; torch.round would take the tie 127.5 to 128 as well, but 0.5 to 0."""
    shift = 0.0 if x["conventions"].get("bytes") == "truncate" else 0.5
    return {"bytes": torch.floor(255.0 * x["image"].clamp(0.0, 1.0) + shift)}
