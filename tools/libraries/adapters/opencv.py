"""OpenCV: points through a matrix, pixels to rays, PSNR, bytes."""

import cv2
import numpy as np
from entry import answers

PACKAGE = "opencv-python-headless"


@answers(PACKAGE, "transform", "transform", dtypes=("f64", "f32"), arrays="numpy")
def transform(c2w, x_c):
    """A matrix a point."""
    return np.concatenate([cv2.transform(x[None, None], m[:3])[0] for m, x in zip(c2w, x_c)])


@answers(PACKAGE, "pixel_to_camera", "undistortPoints without distortion, times the depth", dtypes=("f64", "f32"), arrays="numpy")
def pixel_to_camera(K, uv, s):
    """(x, y, 1) s."""
    x = cv2.undistortPoints(uv[:, None], K, None)[:, 0]
    return np.concatenate([x, np.ones_like(x[:, :1])], -1) * s[:, None]


@answers(PACKAGE, "psnr", "PSNR", dtypes=("f64", "f32"), arrays="numpy", why="equal pictures have 313.07 dB")
def psnr(prediction, target, peak):
    """All pictures as one, one above the other."""
    one = lambda x: x.reshape(-1, *x.shape[2:])  # noqa: E731
    return np.float64(cv2.PSNR(one(prediction), one(target), peak))


@answers(
    PACKAGE,
    "to_uint8",
    "convertScaleAbs of what is clipped",
    dtypes=("f64", "f32"),
    arrays="numpy",
    why="in f64: rows of 16 pixels and more are rounded to f32 first",
)
def to_uint8(image):
    """Clipped, because of the Abs."""
    return cv2.convertScaleAbs(np.clip(image, 0, 1), alpha=255).reshape(image.shape)
