"""torchmetrics: PSNR in its two ways, and SSIM."""

import torch
from entry import answers
from torchmetrics.functional.image import peak_signal_noise_ratio, structural_similarity_index_measure

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


@answers(
    "torchmetrics",
    "ssim",
    "functional.image.structural_similarity_index_measure(data_range)",
    why="in bf16: it squares and subtracts in it",
)
def ssim(prediction, target, peak):
    """Of pictures with their channels in front."""
    a, b = (x.permute(2, 0, 1)[None] for x in (prediction, target))
    return structural_similarity_index_measure(a, b, data_range=float(peak))
