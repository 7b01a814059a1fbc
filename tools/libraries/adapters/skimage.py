"""scikit-image: mean squared error, PSNR. Its SSIM is compared in ../bases.py."""

import numpy as np
from entry import answers
from skimage.metrics import mean_squared_error, peak_signal_noise_ratio
from skimage.util import img_as_ubyte


@answers("scikit-image", "mse", "metrics.mean_squared_error", dtypes=("f64", "f32"), arrays="numpy")
def mse(prediction, target):
    """As it comes."""
    return mean_squared_error(target, prediction)


@answers("scikit-image", "psnr", "metrics.peak_signal_noise_ratio", dtypes=("f64", "f32"), arrays="numpy")
def psnr(prediction, target, peak):
    """All pictures at once."""
    with np.errstate(divide="ignore"):
        return peak_signal_noise_ratio(target, prediction, data_range=peak)


@answers("scikit-image", "to_uint8", "util.img_as_ubyte of what is clipped", dtypes=("f64", "f32"), arrays="numpy")
def to_uint8(image):
    """It refuses what lies outside of [-1, 1]."""
    return img_as_ubyte(np.clip(image, 0, 1))
