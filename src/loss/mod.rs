//! Loss and image metrics: mean squared error, PSNR, SSIM; and colors as bytes.

use ndarray::ArrayView3;

use crate::convention::{Bytes, PsnrFloor, PsnrOf};
use crate::math::{Sum, exp, log10};

pub(crate) mod arrays;
pub mod backward;
pub(crate) mod bound;
pub(crate) mod cases;
pub(crate) mod component;
pub(crate) mod honest;
pub mod judge;
pub(crate) mod mistakes;

pub use judge::judge;

#[cfg(test)]
mod tests;

/// Mean of the squared differences over all entries.
///
/// # Panics
/// Where the lengths differ.
///
/// ```
/// assert_eq!(nerf_oracle::loss::mse(&[0.0, 3.0], &[0.0, 1.0]), 2.0);
/// ```
pub fn mse(prediction: &[f64], target: &[f64]) -> f64 {
    assert_eq!(prediction.len(), target.len(), "prediction and target: one entry for one entry");
    let mut sum = Sum::default();
    for (p, t) in prediction.iter().zip(target) {
        sum.add((p - t) * (p - t));
    }
    sum.value() / prediction.len() as f64
}

/// Peak signal-to-noise ratio of one mean squared error, in decibels: 10 log10(peak^2 / mse); infinite where mse is 0.
///
/// ```
/// assert_eq!(nerf_oracle::loss::psnr(0.01, 1.0), 20.0);
/// ```
pub fn psnr(mse: f64, peak: f64) -> f64 {
    -10.0 * log10(mse / (peak * peak))
}

/// PSNR of several images, each a slice: the mean of their PSNRs, or the PSNR of their mean error.
///
/// The first is never smaller: for errors .01 and .001 it is 25.00 dB, the second 22.60. One image without any error makes the first
/// infinite (ME1).
///
/// # Convention
/// `floor`: with [`PsnrFloor::Small`] an error of at least 1e-10 peak^2 is taken, so that equal pictures have 100 dB.
///
/// # Panics
/// Where there are more predictions than targets or fewer, or an image and its target differ in length.
pub fn psnr_of_images(
    predictions: &[&[f64]],
    targets: &[&[f64]],
    peak: f64,
    of: PsnrOf,
    floor: PsnrFloor,
) -> f64 {
    assert_eq!(predictions.len(), targets.len(), "predictions and targets: one image for one image");
    let least = if floor == PsnrFloor::Small { 1e-10 * peak * peak } else { 0.0 };
    let mut sum = Sum::default();
    for (prediction, target) in predictions.iter().zip(targets) {
        let error = mse(prediction, target);
        sum.add(match of {
            PsnrOf::Images => psnr(error.max(least), peak),
            PsnrOf::MeanError => error,
        });
    }
    let mean = sum.value() / predictions.len() as f64;
    match of {
        PsnrOf::Images => mean,
        PsnrOf::MeanError => psnr(mean.max(least), peak),
    }
}

/// Structural similarity of two images, Wang et al. 2004: the mean over all channels and all windows that lie inside the picture
/// of (2 ma mb + c1)(2 sab + c2) / ((ma^2 + mb^2 + c1)(sa^2 + sb^2 + c2)).
///
/// # Convention
/// Window 11 x 11, Gaussian with standard deviation 1.5, weights summing to 1; c1 = (0.01 peak)^2, c2 = (0.03 peak)^2; variances
/// with weight 1 (not n / (n - 1)); no padding. Other programs take a uniform window of 7: their values differ (ME2).
///
/// # Shapes
/// (H, W, 3) both, H and W at least 11.
///
/// # Panics
/// Where the shapes differ or a side is below 11.
pub fn ssim(a: ArrayView3<f64>, b: ArrayView3<f64>, peak: f64) -> f64 {
    const WINDOW: usize = 11;
    assert_eq!(a.dim(), b.dim(), "a and b: images of the same shape");
    let (height, width, channels) = a.dim();
    assert!(height >= WINDOW && width >= WINDOW, "images of at least {WINDOW} x {WINDOW} pixels");
    let kernel = gaussian_window::<WINDOW>(1.5);
    let mut sum = Sum::default();
    for j in 0..=height - WINDOW {
        for i in 0..=width - WINDOW {
            for c in 0..channels {
                sum.add(ssim_window(&a, &b, &kernel, [j, i, c], peak));
            }
        }
    }
    sum.value() / ((height - WINDOW + 1) * (width - WINDOW + 1) * channels) as f64
}

/// The weights of a Gaussian window along one axis; they sum to 1.
fn gaussian_window<const N: usize>(deviation: f64) -> [f64; N] {
    let center = (N - 1) as f64 / 2.0;
    let weights: [f64; N] = std::array::from_fn(|i| {
        let x = (i as f64 - center) / deviation;
        exp(-0.5 * x * x)
    });
    let mut sum = Sum::default();
    weights.iter().for_each(|&w| sum.add(w));
    weights.map(|w| w / sum.value())
}

/// SSIM of one window whose upper left corner is (j, i), in channel c.
fn ssim_window(
    a: &ArrayView3<f64>,
    b: &ArrayView3<f64>,
    kernel: &[f64],
    [j, i, c]: [usize; 3],
    peak: f64,
) -> f64 {
    let (mut mean_a, mut mean_b) = (0.0, 0.0);
    for (y, ky) in kernel.iter().enumerate() {
        for (x, kx) in kernel.iter().enumerate() {
            mean_a += ky * kx * a[[j + y, i + x, c]];
            mean_b += ky * kx * b[[j + y, i + x, c]];
        }
    }
    // Central moments: E[a^2] - E[a]^2 would cancel where the window is nearly flat.
    let (mut var_a, mut var_b, mut cov) = (0.0, 0.0, 0.0);
    for (y, ky) in kernel.iter().enumerate() {
        for (x, kx) in kernel.iter().enumerate() {
            let (da, db) = (a[[j + y, i + x, c]] - mean_a, b[[j + y, i + x, c]] - mean_b);
            var_a += ky * kx * da * da;
            var_b += ky * kx * db * db;
            cov += ky * kx * da * db;
        }
    }
    let (c1, c2) = ((0.01 * peak) * (0.01 * peak), (0.03 * peak) * (0.03 * peak));
    (2.0 * mean_a * mean_b + c1) * (2.0 * cov + c2)
        / ((mean_a * mean_a + mean_b * mean_b + c1) * (var_a + var_b + c2))
}

/// A color value as a byte: clipped to [0, 1], times 255, rounded (halves away from 0) or cut off.
///
/// ```
/// use nerf_oracle::{convention::Bytes, loss::to_uint8};
/// assert_eq!([-0.1, 0.5, 1.01].map(|x| to_uint8(x, Bytes::Round)), [0, 128, 255]);
/// ```
pub fn to_uint8(x: f64, bytes: Bytes) -> u8 {
    let x = 255.0 * x.clamp(0.0, 1.0);
    match bytes {
        Bytes::Round => libm::round(x) as u8,
        Bytes::Truncate => x as u8,
    }
}
