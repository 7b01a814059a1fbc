"""Structural similarity of two pictures."""

import numpy as np
import torch
import torch.nn.functional as F
from entry import convention, fault, right


def line(size=11, sigma=1.5):
    """Weights along an axis."""
    x = torch.arange(size) - size // 2
    w = torch.exp(-(x**2) / (2 * sigma**2))
    return w / w.sum()


def blur(x, window, pad=0):
    """Means over windows of (H, W, C)."""
    x = x.permute(2, 0, 1)[None]
    kernel = window.expand(x.shape[1], 1, *window.shape)
    return F.conv2d(x, kernel, padding=pad, groups=x.shape[1])[0].permute(1, 2, 0)


def similarity_map(a, b, c1, c2, mean, more=1.0, eps=0.0):
    """The map, from means of squares less squares of means."""
    ma, mb = mean(a), mean(b)
    va, vb, cov = more * (mean(a * a) - ma * ma), more * (mean(b * b) - mb * mb), more * (mean(a * b) - ma * mb)
    return (2 * ma * mb + c1) * (2 * cov + c2) / ((ma * ma + mb * mb + c1) * (va + vb + c2) + eps)


def constants(peak):
    """c1, c2."""
    return (0.01 * peak) ** 2, (0.03 * peak) ** 2


@right("ssim", seen="pytorch-msssim, torchmetrics (padded, then cut): windows in the picture", times=6)
def windows_in_the_picture(prediction, target, peak):
    """A window of 11 x 11 moved over the picture, groups for channels."""
    window = torch.outer(line(), line())
    return similarity_map(prediction, target, *constants(peak), lambda x: blur(x, window)).mean()


@right("ssim", seen="google-deepmind/dm_pix metrics.py ssim without its limits: along x, then along y", times=3)
def one_axis_at_a_time(prediction, target, peak):
    """Two passes of a filter of 11."""
    w = line()
    return similarity_map(prediction, target, *constants(peak), lambda x: blur(blur(x, w[None]), w[:, None])).mean()


@convention("ssim", {"ssim_peak": "one"}, seen="gsplat examples/simple_trainer.py: fused_ssim, padding valid", times=3)
def borders_cut(prediction, target):
    """Zeros about the picture, five pixels on each side cut off the map; C1 = 0.01^2."""
    window = torch.outer(line(), line())
    full = similarity_map(prediction, target, 0.01**2, 0.03**2, lambda x: blur(x, window, 5))
    return full[5:-5, 5:-5].mean()


@convention(
    "ssim",
    {"ssim_padding": "zero", "ssim_peak": "one"},
    seen="graphdeco-inria/gaussian-splatting utils/loss_utils.py and what stands on it",
    times=9,
)
def zeros_about_the_picture(prediction, target):
    """conv2d with padding 5, C1 = 0.01^2, C2 = 0.03^2."""
    window = torch.outer(line(), line())
    return similarity_map(prediction, target, 0.01**2, 0.03**2, lambda x: blur(x, window, 5)).mean()


@convention("ssim", {"ssim_padding": "reflect"}, seen="kornia.metrics.ssim, padding same", times=3)
def picture_reflected(prediction, target, peak):
    """Five pixels reflected on each side, one window about each pixel."""
    window = torch.outer(line(), line())

    def mean(x):
        return blur(F.pad(x.permute(2, 0, 1)[None], (5,) * 4, mode="reflect")[0].permute(1, 2, 0), window)

    return similarity_map(prediction, target, *constants(peak), mean).mean()


@convention(
    "ssim",
    {"ssim_window": "uniform", "ssim_variance": "sample"},
    seen="skimage.metrics.structural_similarity with data_range and channel_axis alone",
    times=8,
)
def seven_by_seven(prediction, target, peak):
    """Even windows of 7 x 7, variances over 48."""
    window = torch.full((7, 7), 1 / 49)
    return similarity_map(prediction, target, *constants(peak), lambda x: blur(x, window), 49 / 48).mean()


@convention(
    "ssim",
    {"ssim_window": "uniform_11", "ssim_padding": "zero", "ssim_peak": "one"},
    seen="a splatting trainer: avg_pool2d of 11, padding 5, counted",
)
def even_windows_of_the_published_size(prediction, target):
    """Boxes of 11 x 11 with zeros about the picture."""
    window = torch.full((11, 11), 1 / 121)
    return similarity_map(prediction, target, 0.01**2, 0.03**2, lambda x: blur(x, window, 5)).mean()


@convention(
    "ssim",
    {"ssim_window": "uniform_3", "ssim_padding": "reflect", "ssim_peak": "one"},
    seen="nianticlabs/monodepth2 layers.py SSIM, before it is turned into a loss, and depth networks after it",
    times=3,
)
def three_by_three(prediction, target):
    """Boxes of 3 x 3, one pixel reflected on each side."""
    window = torch.full((3, 3), 1 / 9)

    def mean(x):
        return blur(F.pad(x.permute(2, 0, 1)[None], (1,) * 4, mode="reflect")[0].permute(1, 2, 0), window)

    return similarity_map(prediction, target, 0.01**2, 0.03**2, mean).mean()


@convention(
    "ssim",
    {"ssim_variance": "sample"},
    seen="skimage with gaussian_weights and sigma 1.5, use_sample_covariance left on",
    times=2,
)
def gaussian_with_sample_covariance(prediction, target, peak):
    """Windows of 11 x 11, variances times 121 / 120."""
    window = torch.outer(line(), line())
    return similarity_map(prediction, target, *constants(peak), lambda x: blur(x, window), 121 / 120).mean()


@fault("ssim", "gray_pictures", seen="scripts that average channels before skimage's", times=2)
def gray_first(prediction, target, peak):
    """The mean over channels first."""
    window = torch.outer(line(), line())
    gray = [x.mean(-1, keepdim=True) for x in (prediction, target)]
    return similarity_map(*gray, *constants(peak), lambda x: blur(x, window)).mean()


@fault("ssim", "luma_pictures", seen="a city's renderer: 0.299 R + 0.587 G + 0.114 B, three channels expected", times=2)
def luma_of_three_channels(prediction, target, peak):
    """Y first; pictures of other channels are no pictures."""
    shares = torch.tensor([0.299, 0.587, 0.114])
    if prediction.shape[-1] != 3:
        raise ValueError("three channels expected")
    window = torch.outer(line(), line())
    gray = [(x * shares).sum(-1, keepdim=True) for x in (prediction, target)]
    return similarity_map(*gray, *constants(peak), lambda x: blur(x, window)).mean()


@fault("ssim", "one_window", seen="metrics modules with the formula over the whole picture", times=2)
def formula_over_all_pixels(prediction, target, peak):
    """Means, variances and covariance over everything."""
    c1, c2 = constants(peak)
    ma, mb = prediction.mean(), target.mean()
    va, vb = prediction.var(unbiased=False), target.var(unbiased=False)
    cov = ((prediction - ma) * (target - mb)).mean()
    return (2 * ma * mb + c1) * (2 * cov + c2) / ((ma**2 + mb**2 + c1) * (va + vb + c2))


@fault("ssim", "peak_255", seen="pytorch-msssim with its data_range of 255 left, for colors in [0, 1]", times=2)
def range_left_at_255(prediction, target):
    """Constants of bytes whatever the pictures hold."""
    window = torch.outer(line(), line())
    return similarity_map(prediction, target, *constants(255.0), lambda x: blur(x, window)).mean()


@fault("ssim", "peak_of_target", seen="skimage with data_range = target.max() - target.min()", times=3, arrays="numpy")
def range_of_the_target(prediction, target):
    """Constants of the target's range."""
    peak, window = float(target.max() - target.min()), torch.outer(line(), line())
    a, b = (torch.as_tensor(x.astype(np.float32)) for x in (prediction, target))
    return similarity_map(a, b, *constants(peak), lambda x: blur(x, window)).mean().numpy()


@fault("ssim", "dissimilarity", seen="losses that are reported as the metric", gradient=("dissimilarity", "gradient_of_the_loss"))
def one_less_similarity(prediction, target, peak):
    """1 - SSIM."""
    return 1 - windows_in_the_picture(prediction, target, peak)


@fault("ssim", "luminance_dropped", seen="contrast and structure alone, as of MS-SSIM's scales", gradient="none")
def contrast_and_structure(prediction, target, peak):
    """(2 cov + c2) / (va + vb + c2)."""
    window = torch.outer(line(), line())
    return similarity_map(prediction, target, 1e30, constants(peak)[1], lambda x: blur(x, window)).mean()


@fault("ssim", "deviations_for_covariance", seen="keras-contrib#98, a port of pytorch-msssim", times=2)
def deviations_multiplied(prediction, target, peak):
    """sigma_x sigma_y where sigma_xy belongs."""
    window, (c1, c2) = torch.outer(line(), line()), constants(peak)
    ma, mb = blur(prediction, window), blur(target, window)
    va, vb = (blur((x * x), window) - m * m for x, m in ((prediction, ma), (target, mb)))
    both = torch.sqrt((va * vb).clamp(min=0))
    return ((2 * ma * mb + c1) * (2 * both + c2) / ((ma**2 + mb**2 + c1) * (va + vb + c2))).mean()


@fault("ssim", "variances_squared", seen="MONAI#8634, scikit-image#2520", times=2)
def squares_of_variances(prediction, target, peak):
    """Variances, named sigma, squared as the formula has sigma."""
    window, (c1, c2) = torch.outer(line(), line()), constants(peak)
    ma, mb = blur(prediction, window), blur(target, window)
    va, vb = (blur(x * x, window) - m * m for x, m in ((prediction, ma), (target, mb)))
    cov = blur(prediction * target, window) - ma * mb
    return ((2 * ma * mb + c1) * (2 * cov + c2) / ((ma**2 + mb**2 + c1) * (va**2 + vb**2 + c2))).mean()


@fault("ssim", "factors_not_squared", seen="a student's metrics: C1 = k1 * L ** 2", times=1)
def power_without_parentheses(prediction, target, peak):
    """0.01 peak^2 and 0.03 peak^2."""
    window = torch.outer(line(), line())
    return similarity_map(prediction, target, 0.01 * peak**2, 0.03 * peak**2, lambda x: blur(x, window)).mean()


def even_along(x, axis, size=7):
    """A moving mean along an axis that is mirrored beyond its ends, the last element twice: one axis of uniform_filter."""
    length = x.shape[axis]
    at = (torch.arange(length)[:, None] + torch.arange(size) - size // 2) % (2 * length)
    at = torch.where(at < length, at, 2 * length - 1 - at)
    return x.index_select(axis, at.flatten()).unflatten(axis, (length, size)).mean(axis + 1)


@fault("ssim", "window_over_channels", seen="a trial on unseen code: scipy.ndimage.uniform_filter of (H, W, C)", gradient="none")
def boxes_of_three_axes(prediction, target, peak):
    """Even windows of 7 x 7 x 7 about every pixel: along both sides, and over the channels."""

    def mean(x):
        return even_along(even_along(even_along(x, 0), 1), 2)

    return similarity_map(prediction, target, *constants(peak), mean).mean()


@fault(
    "ssim",
    "one_window_of_each_channel",
    "one_window",
    seen="a trial on unseen code: a NeRF in tfjs",
    gradient="none",
)
def formula_over_each_channel(prediction, target):
    """Means and variances of whole channels; the mean of the channels' values."""

    def mean(x):
        return x.mean((0, 1), keepdim=True)

    return similarity_map(prediction, target, 0.01**2, 0.03**2, mean).mean()


@fault("ssim", "window_of_one_side", seen="pierotofy/OpenSplat ssim.cpp", gradient="none")
def middle_lost_in_whole_numbers(prediction, target):
    """exp(-floor((i - 11) / 2)^2 / (2 1.5^2)), zeros about the picture."""
    x = torch.div(torch.arange(11) - 11, 2, rounding_mode="floor")
    w = torch.exp(-(x**2) / 4.5)
    window = torch.outer(w / w.sum(), w / w.sum())
    return similarity_map(prediction, target, 0.01**2, 0.03**2, lambda x: blur(x, window, 5)).mean()


@fault(
    "ssim",
    "three_wide+clipped_at_zero",
    seen="a trial on unseen code: kornia's ssim loss with a window of 3 in a mip-NeRF",
    gradient="none",
)
def three_pixels_and_clamped(prediction, target):
    """A Gaussian of three pixels, zeros about the picture, 1 - 2 mean(clamp(1 - ssim, 0, 1) / 2)."""
    window = torch.outer(line(3), line(3))
    full = similarity_map(prediction, target, 0.01**2, 0.03**2, lambda x: blur(x, window, 1))
    return 1 - 2 * (torch.clamp(1 - full, 0, 1) / 2).mean()


@fault("ssim", "eps_in_denominator", seen="a trial on unseen code: 1e-10 below the fraction", gradient="none")
def a_little_below(prediction, target):
    """Zeros about the picture, C1 = 0.01^2; 1e-10 is added to what is divided by."""
    window = torch.outer(line(), line())
    return similarity_map(prediction, target, 0.01**2, 0.03**2, lambda x: blur(x, window, 5), eps=1e-10).mean()


@fault("ssim_vjp", "border_repeated_both_ways", seen="a trial on unseen code: renderers of splats in Metal and CUDA", times=3, arrays="numpy")
def border_repeated_on_the_way_back(prediction, target, peak, grad_value):
    """Windows over pixels that are repeated beyond the border, forward and back."""
    weights, (c1, c2) = line().numpy().astype(prediction.dtype), constants(float(peak))

    def mean(x):
        for axis in (0, 1):
            padded = np.pad(x, [(5, 5) if axis == k else (0, 0) for k in range(3)], mode="edge")
            x = sum(w * np.take(padded, np.arange(k, k + x.shape[axis]), axis) for k, w in enumerate(weights))
        return x

    a, b = prediction, target
    ma, mb = mean(a), mean(b)
    va, vb, cov = mean(a * a) - ma * ma, mean(b * b) - mb * mb, mean(a * b) - ma * mb
    low, high, over, under = 2 * ma * mb + c1, 2 * cov + c2, ma * ma + mb * mb + c1, va + vb + c2
    s = low * high / (over * under)
    m, q, r = 2 * (mb * high / (over * under) - s * ma / over), -s / under, 2 * low / (over * under)
    g = mean(m) + 2 * a * mean(q) - 2 * mean(q * ma) + b * mean(r) - mean(r * mb)
    return {"grad_prediction": (grad_value * g / g.size).astype(prediction.dtype)}


@fault("ssim", "one_window_of_each_channel_corrected", seen="a trial on unseen code: forecasts of fields")
def deviations_of_each_channel(prediction, target):
    """std() of whole channels, which divides by n - 1, and a covariance by mean()."""
    ma, mb = prediction.mean((0, 1)), target.mean((0, 1))
    sa, sb = prediction.std((0, 1)), target.std((0, 1))
    cov = ((prediction - ma) * (target - mb)).mean((0, 1))
    c1, c2 = 0.01**2, 0.03**2
    return ((2 * ma * mb + c1) * (2 * cov + c2) / ((ma**2 + mb**2 + c1) * (sa**2 + sb**2 + c2))).mean()
