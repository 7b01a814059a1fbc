//! How learning rates fall while a model is trained.

/// Steps over which rates fall by the square root of 2.
pub const HALF_LIFE: f64 = 1500.0;

/// The factor of a learning rate at a training step: 1 / sqrt(1 + step / 1500).
///
/// Steps that are too long for the noise of a batch end far from the least loss; the inverse of the square root is the fall that
/// needs no end of the run to be known, so that a run can be resumed and go on (Robbins and Monro 1951; Vaswani et al. 2017, 5.3).
///
/// ```
/// use nerf_oracle::training::rate::falling;
/// assert_eq!((falling(0), falling(4500)), (1.0, 0.5));
/// ```
pub fn falling(step: u64) -> f64 {
    1.0 / (1.0 + step as f64 / HALF_LIFE).sqrt()
}
