"""The encoding, band by band."""

import numpy as np


def positional_encoding(x, L):
    bands = [x]
    for k in range(L):
        # In f64, as pi times a coordinate has no digits left in f32 at high bands.
        angle = 2.0**k * np.pi * x.astype(np.float64)
        bands += [np.sin(angle), np.cos(angle)]
    return np.concatenate(bands, axis=-1).astype(x.dtype)
