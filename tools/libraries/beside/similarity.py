"""SSIM beside its fixtures: libraries and mpmath on two pairs of pictures, which `src/ssim/tests.rs` has too."""

from importlib.metadata import version

import kornia
import mpmath
import numpy as np
import skimage.metrics
import torch
from torchmetrics.functional.image import structural_similarity_index_measure


def pictures():
    """Two pictures of 13 x 17 in three channels that are alike, and two that are opposites."""
    j, i, c = np.meshgrid(np.arange(13), np.arange(17), np.arange(3), indexing="ij")
    a = (37 * j + 101 * i + 53 * c) * 0.61803398875 % 1
    return (a, 0.9 * a), (a, 1 - a)


def exact_ssim(a, b):
    """Wang et al. 2004 over the reals: windows inside of the picture, Gaussian of 11 x 11 with deviation 1.5."""
    g = [mpmath.exp(-(mpmath.mpf(k) ** 2) / (2 * mpmath.mpf(1.5) ** 2)) for k in range(-5, 6)]
    weights = np.array([[x * y / sum(g) ** 2 for x in g] for y in g])
    lift = np.vectorize(lambda x: mpmath.mpf(float(x)), otypes=[object])
    a, b, c1, c2 = lift(a), lift(b), mpmath.mpf("1e-4"), mpmath.mpf("9e-4")
    values = []
    for j, i, c in np.ndindex(a.shape[0] - 10, a.shape[1] - 10, a.shape[2]):
        x, y = a[j : j + 11, i : i + 11, c], b[j : j + 11, i : i + 11, c]
        mx, my = (weights * x).sum(), (weights * y).sum()
        vx, vy, cov = (weights * (x - mx) ** 2).sum(), (weights * (y - my) ** 2).sum(), (weights * (x - mx) * (y - my)).sum()
        values.append((2 * mx * my + c1) * (2 * cov + c2) / ((mx**2 + my**2 + c1) * (vx + vy + c2)))
    return mpmath.fsum(values) / len(values)


def ssims():
    """(library, ULP, what was set) of each SSIM in f64."""
    tensor = lambda x: torch.from_numpy(x).permute(2, 0, 1)[None]  # noqa: E731
    inside = lambda every: every[1][..., 5:-5, 5:-5].mean().item()  # noqa: E731
    measure = {
        ("scikit-image", "population variances"): lambda a, b: skimage.metrics.structural_similarity(
            a, b, gaussian_weights=True, sigma=1.5, use_sample_covariance=False, data_range=1.0, channel_axis=2
        ),
        ("kornia", 'padding="valid", eps=0.0'): lambda a, b: (
            kornia.metrics.ssim(tensor(a), tensor(b), 11, eps=0.0, padding="valid").mean().item()
        ),
        ("torchmetrics", "its map without the border of five pixels"): lambda a, b: inside(
            structural_similarity_index_measure(tensor(a), tensor(b), data_range=1.0, return_full_image=True)
        ),
    }
    exact = [(a, b, exact_ssim(a, b)) for a, b in pictures()]
    for (package, setting), function in measure.items():
        ulp = max(float(abs(function(a, b) - y) / np.spacing(abs(float(y)))) for a, b, y in exact)
        yield f"{package} {version(package)}", ulp, setting
