//! Vector-Jacobian product of structural similarity, by hand. `g` is the gradient of the loss with respect to it.

use ndarray::{Array3, ArrayView3};

use super::{Form, Windows, value};
use crate::math::Sum;

/// Gradient with respect to `a`; that of `b` is this one with the pictures exchanged.
///
/// Of a window with similarity S = L C / (M V), L and M the luminance over its largest value, C and V the structure over its largest: a
/// pixel of weight k has k (2 (m_b C / (M V) - S m_a / M) + 2 r ((b - m_b) L / (M V) - (a - m_a) S / V)), r the factor of variances. A
/// variance doesn't move with its mean, as deviations from the mean add up to 0.
///
/// # Convention
/// Pixels that a reflecting border shows twice have both gradients.
///
/// # Panics
/// Where the shapes differ or a side is below 11.
///
/// ```
/// use ndarray::Array3;
/// use nerf_oracle::ssim::{Form, backward};
/// let flat = |x| Array3::from_elem((11, 11, 1), x);
/// // Equal pictures can't become more alike.
/// let g = backward::ssim(flat(0.5).view(), flat(0.5).view(), 1.0, Form::default(), 1.0);
/// assert!(g.iter().all(|g| g.abs() < 1e-16));
/// ```
pub fn ssim(a: ArrayView3<f64>, b: ArrayView3<f64>, peak: f64, form: Form, g: f64) -> Array3<f64> {
    let windows = Windows::new(a, b, form);
    let mut sums = Array3::from_elem(a.dim(), Sum::default());
    let each = g / windows.places().len() as f64;
    for place in windows.places() {
        let m = windows.moments(place);
        let [luminance, over, structure, under] = m.parts(peak);
        let similarity = luminance * structure / (over * under);
        let of_mean = 2.0 * (m.mean_b * structure / (over * under) - similarity * m.mean_a / over);
        let of_cov = 2.0 * windows.unbiased * luminance / (over * under);
        let of_var = -2.0 * windows.unbiased * similarity / under;
        for (weight, at) in windows.pixels(place) {
            let (off_a, off_b) = (value(&a, at) - m.mean_a, value(&b, at) - m.mean_b);
            if let Some(at) = at {
                sums[at].add(each * weight * (of_mean + of_cov * off_b + of_var * off_a));
            }
        }
    }
    sums.mapv(|sum| sum.value())
}
