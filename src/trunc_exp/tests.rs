//! The derivative where it is one, the stated surrogate elsewhere.

use approx::assert_relative_eq;

use super::{backward, forward};

#[test]
fn is_the_derivative_inside() {
    for x in [-14.9, -3.0, 0.0, 2.5, 14.9] {
        let slope = (forward(x + 1e-6) - forward(x - 1e-6)) / 2e-6;
        assert_relative_eq!(backward(x, 1.0), slope, max_relative = 1e-8);
    }
}

#[test]
fn is_finite_everywhere() {
    for x in [-1e300, -800.0, 800.0, 1e300] {
        assert!(backward(x, 1.0).is_finite() && backward(x, 1.0) > 0.0);
    }
    assert_eq!(forward(710.0), f64::INFINITY);
}
