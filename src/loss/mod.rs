//! Loss and image metrics: mean squared error and PSNR; and colors as bytes.

use crate::convention::{Bytes, PsnrFloor, PsnrOf};
use crate::math::{Sum, log10};

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
