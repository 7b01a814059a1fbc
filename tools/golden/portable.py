"""What inputs are made with beside + - x / and square roots, the same bits on every processor.

Inputs are compared by their bits. numpy's own powers differ by an ULP between instruction sets, and a matrix library's products
are summed in an order of its own, with or without fused steps.
"""

import mpmath
import numpy as np


def power_of_ten(exponents):
    """10^x of each element, rounded once."""
    with mpmath.workdps(50):
        return np.array([float(mpmath.mpf(10) ** float(x)) for x in exponents.flat]).reshape(exponents.shape)


def product(a, b):
    """The matrix product over the last two axes, its terms added one by one."""
    return sum(a[..., :, k, None] * b[..., k, None, :] for k in range(a.shape[-1]))
