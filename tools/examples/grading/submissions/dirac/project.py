"""Cut off: it doesn't even parse."""

import numpy as np


def volrend(density, color, step_sizes):
    alpha = 1 - np.exp(-density * step_sizes
