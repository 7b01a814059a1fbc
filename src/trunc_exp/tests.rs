//! The derivative inside of the limits, the stated surrogate outside.

use approx::assert_relative_eq;

use super::{LIMIT, backward, density, trunc_exp};
use crate::contract::testing::slope;
use crate::convention::Exponent;
use crate::math::exp;

/// The function whose derivative is the surrogate: e^x, continued as a straight line outside of [-15, 15].
fn stated(x: f64) -> f64 {
    let inside = x.clamp(-LIMIT, LIMIT);
    exp(inside) * (1.0 + x - inside)
}

#[test]
fn is_the_derivative_inside() {
    for x in [-14.9, -3.0, 0.0, 2.5, 14.9] {
        let by_differences = slope(|s| trunc_exp(x + s));
        assert_relative_eq!(backward::trunc_exp(x, 1.0), by_differences, max_relative = 1e-10);
    }
}

/// VR6: outside, a plain check by differences fails by a factor of e or more, and the stated one passes.
#[test]
fn a_plain_check_fails_outside_and_the_stated_one_passes() {
    for x in [-60.0, -16.0, 16.0, 60.0] {
        let plain = slope(|s| trunc_exp(x + s));
        let ratio = backward::trunc_exp(x, 1.0) / plain;
        assert!(!(0.4..2.5).contains(&ratio), "{x}: {ratio}");
    }
    for x in [-60.0, -16.0, -14.0, 0.0, 14.0, 16.0, 60.0] {
        let by_differences = slope(|s| stated(x + s));
        assert_relative_eq!(backward::trunc_exp(x, 1.0), by_differences, max_relative = 1e-10);
    }
}

/// Clamped forward, the density is constant outside of the limits; free, it is the exponential itself.
#[test]
fn a_clamped_exponent_has_two_ends() {
    for (x, clamped) in [(-16.0, -15.0), (-3.0, -3.0), (2.5, 2.5), (16.0, 15.0)] {
        assert_eq!(density(x, Exponent::Free), exp(x));
        assert_eq!(density(x, Exponent::Clamped), exp(clamped));
    }
}

#[test]
fn is_finite_everywhere() {
    for x in [-1e300, -800.0, 800.0, 1e300] {
        assert!(backward::trunc_exp(x, 1.0).is_finite() && backward::trunc_exp(x, 1.0) > 0.0);
    }
    // VR6: e^x overflows past 709; nothing is NaN.
    assert_eq!((trunc_exp(709.0).is_finite(), trunc_exp(710.0)), (true, f64::INFINITY));
    assert_eq!(trunc_exp(-746.0), 0.0);
}
