//! Vector-Jacobian product of the loss, by hand.

/// Gradient of [`super::mse`] with respect to the prediction: 2 (p - t) g / n. That of the target is its negative.
///
/// # Panics
/// Where the lengths differ.
pub fn mse(prediction: &[f64], target: &[f64], g: f64) -> Vec<f64> {
    assert_eq!(prediction.len(), target.len(), "prediction and target: one entry for one entry");
    let n = prediction.len() as f64;
    prediction.iter().zip(target).map(|(p, t)| 2.0 * (p - t) * g / n).collect()
}
