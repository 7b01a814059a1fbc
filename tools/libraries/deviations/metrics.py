"""PSNR, SSIM and bytes of torchmetrics, kornia and OpenCV."""

from reproduction import deviation


@deviation("torchmetrics", "digits", "`peak_signal_noise_ratio` of f64 pictures has f32's digits")
def psnr_in_f32():
    """ln 10 is `torch.log(tensor(base))`, and data_range `tensor(float(data_range))`: both in f32, whatever the pictures are
    in. Off by 4.5e-8 of the value. `math.log(base)` mends the first, `dtype=preds.dtype` the second."""
    import mpmath
    import torch
    from torchmetrics.functional.image import peak_signal_noise_ratio

    ones = torch.ones(1, 3, 16, 16, dtype=torch.float64)
    value = peak_signal_noise_ratio(0.5 * ones, ones, data_range=1.0)
    found, expected = [value.item()], [float(20 * mpmath.log10(2))]
    return found, expected


@deviation("torchmetrics", "choice", "`structural_similarity_index_measure` counts windows that reach over the edge")
def ssim_over_the_edge():
    """The mean runs over all pixels, those near the edge with a mirrored neighborhood. Wang et al.'s own program, scikit-image
    and kornia's padding="valid" average the windows that lie inside; on small pictures it shows. Expected is its own map
    without the border of five pixels, which agrees with scikit-image."""
    import torch
    from torchmetrics.functional.image import structural_similarity_index_measure

    a = (torch.arange(3 * 13 * 17, dtype=torch.float64) * 0.61803398875 % 1).reshape(1, 3, 13, 17)
    value, every = structural_similarity_index_measure(a, 1 - a, data_range=1.0, return_full_image=True)
    found, expected = [value.item()], [every[..., 5:-5, 5:-5].mean().item()]
    return found, expected


@deviation("kornia", "choice", "`metrics.ssim`: 1e-12 in the denominator")
def ssim_beside_1e_12():
    """It is added to the product below, which is c2 (2 m^2 + c1) in a window without contrast: 9e-8 where it is black. Two equal
    black pictures are 0.99999 alike. eps=0.0 mends it: the product is never 0."""
    import torch
    from kornia.metrics import ssim

    black = torch.zeros(1, 1, 11, 11, dtype=torch.float64)
    found, expected = [ssim(black, black, 11, padding="valid").mean().item()], [1.0]
    return found, expected


@deviation("opencv-python-headless", "choice", "`PSNR` of equal pictures is 313.07 dB, not infinite")
def psnr_of_equal_pictures():
    """It is 20 log10(R / (rms + DBL_EPSILON)), so that nothing is better than 313.07 dB for R = 1, and an rms near 2.2e-16
    counts double."""
    import cv2
    import numpy as np

    picture = np.zeros((8, 8, 3))
    found, expected = [cv2.PSNR(picture, picture, 1.0)], [float("inf")]
    return found, expected


@deviation("opencv-python-headless", "bug", "`convertScaleAbs` gives a pixel another byte in a wider picture")
def bytes_by_width():
    """Rows of 16 pixels and more go through vector code that takes 255 x in f32, where the 80.5000024 of this pixel is 80.5,
    which half to even makes 80. Shorter rows are taken in f64 and rounded to the right 81. Found are rows of 15 and of 16
    pixels."""
    import cv2
    import mpmath
    import numpy as np

    x = 0.31568628391798803
    found = [float(cv2.convertScaleAbs(np.full((1, width), x), alpha=255)[0, 0]) for width in (15, 16)]
    expected = 2 * [float(mpmath.floor(255 * mpmath.mpf(x) + 0.5))]
    return found, expected
