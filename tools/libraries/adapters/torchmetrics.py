"""torchmetrics: PSNR in its two ways. Its SSIM is compared in ../bases.py: SSIM has no row in the contract."""

import torch
from entry import answers
from torchmetrics.functional.image import peak_signal_noise_ratio

assert torch  # whose tensors it takes
F32 = "in f64: ln 10 and the range are in f32"


@answers("torchmetrics", "psnr", "functional.image.peak_signal_noise_ratio(data_range)", why=F32)
def psnr(prediction, target, peak):
    """Of the mean error over all pictures."""
    return peak_signal_noise_ratio(prediction, target, data_range=peak)


@answers("torchmetrics", "psnr", "functional.image.peak_signal_noise_ratio(data_range, dim=(1, 2, 3))", why=F32)
def psnr_of_each(prediction, target, peak):
    """The mean of the pictures' own."""
    return peak_signal_noise_ratio(prediction, target, data_range=peak, dim=(1, 2, 3))
