//! Values that the standard prints, the way back, and what happens at the threshold.

use approx::assert_relative_eq;

use super::{THRESHOLD, backward, linear_to_srgb};
use crate::contract::testing::slope;
use crate::math::pow;

/// The definition of the way back, IEC 61966-2-1.
fn to_linear(y: f64) -> f64 {
    if y <= 0.04045 { y / 12.92 } else { pow((y + 0.055) / 1.055, 2.4) }
}

#[test]
fn the_way_back_returns() {
    for x in [0.0, 1e-4, 0.003, 0.0032, 0.02, 0.18, 0.5, 1.0, 7.0] {
        assert_relative_eq!(to_linear(linear_to_srgb(x)), x, max_relative = 1e-14);
    }
}

/// A gray card reflects 18%; half of white in a file is 21.4% of its light.
#[test]
fn known_values() {
    assert_relative_eq!(linear_to_srgb(0.214_041_140_482_232_55), 0.5, max_relative = 1e-14);
    assert_eq!((255.0 * linear_to_srgb(0.18)).round(), 118.0);
    assert_eq!(linear_to_srgb(0.0), 0.0);
    // 1.055 and 0.055 are rounded, their difference is 1 less a half ULP of 1.
    assert_relative_eq!(linear_to_srgb(1.0), 1.0, max_relative = f64::EPSILON);
}

#[test]
fn is_the_derivative_of_each_piece() {
    for x in [-0.5, 0.05, 0.18, 1.0, 7.0] {
        // A step of 2^-9 would leave the domain of the power near 0.05.
        let scale = 0.1 * f64::abs(x);
        let by_differences = slope(|s| linear_to_srgb(x + scale * s)) / scale;
        assert_relative_eq!(backward::linear_to_srgb(x, 1.0), by_differences, max_relative = 1e-9);
    }
    assert_eq!(backward::linear_to_srgb(0.0, 1.0), 12.92);
    for x in [0.0, 0.18] {
        assert_relative_eq!(backward::linear_to_srgb(x, 3.0), 3.0 * backward::linear_to_srgb(x, 1.0));
    }
}

/// The pieces don't meet: a step of 2.9e-8 down, and a slope that falls by 0.22.
#[test]
fn the_threshold_belongs_to_the_straight_piece() {
    let above = THRESHOLD.next_up();
    assert_eq!(linear_to_srgb(THRESHOLD), 12.92 * THRESHOLD);
    assert_relative_eq!(linear_to_srgb(THRESHOLD) - linear_to_srgb(above), 2.85e-8, max_relative = 0.01);
    assert_eq!(backward::linear_to_srgb(THRESHOLD, 1.0), 12.92);
    assert_relative_eq!(backward::linear_to_srgb(above, 1.0), 12.703, max_relative = 1e-4);
}

/// Black, white and all beyond have a finite slope above 0: no pixel stops learning.
#[test]
fn every_slope_is_finite_and_positive() {
    for x in [-1e300, -1.0, -0.0, 0.0, 1e-320, THRESHOLD, 1.0, 2.0, 1e300] {
        let slope = backward::linear_to_srgb(x, 1.0);
        assert!(slope.is_finite() && slope > 0.0, "{x}: {slope}");
    }
}
