//! The derivative inside of the limits, the stated surrogate outside.

use approx::assert_relative_eq;

use super::{LIMIT, backward, density, trunc_exp};
use crate::contract::testing::slope;
use crate::convention::{Exponent, ExponentGradient, ExponentShift};
use crate::math::exp;

/// The surrogate in the default conventions.
fn surrogate(x: f64) -> f64 {
    backward::trunc_exp(x, 1.0, ExponentGradient::BothEnds, ExponentShift::None)
}

/// The function whose derivative is the surrogate: e^x, continued as a straight line outside of [-15, 15].
fn stated(x: f64) -> f64 {
    let inside = x.clamp(-LIMIT, LIMIT);
    exp(inside) * (1.0 + x - inside)
}

#[test]
fn is_the_derivative_inside() {
    for x in [-14.9, -3.0, 0.0, 2.5, 14.9] {
        let by_differences = slope(|s| trunc_exp(x + s));
        assert_relative_eq!(surrogate(x), by_differences, max_relative = 1e-10);
    }
}

/// VR6: outside, a plain check by differences fails by a factor of e or more, and the stated one passes.
#[test]
fn a_plain_check_fails_outside_and_the_stated_one_passes() {
    for x in [-60.0, -16.0, 16.0, 60.0] {
        let plain = slope(|s| trunc_exp(x + s));
        let ratio = surrogate(x) / plain;
        assert!(!(0.4..2.5).contains(&ratio), "{x}: {ratio}");
    }
    for x in [-60.0, -16.0, -14.0, 0.0, 14.0, 16.0, 60.0] {
        let by_differences = slope(|s| stated(x + s));
        assert_relative_eq!(surrogate(x), by_differences, max_relative = 1e-10);
    }
}

/// Clamped forward, the density is constant outside of the limits; free, it is the exponential itself.
#[test]
fn a_clamped_exponent_has_two_ends() {
    for (x, clamped) in [(-16.0, -15.0), (-3.0, -3.0), (2.5, 2.5), (16.0, 15.0)] {
        assert_eq!(density(x, Exponent::Free, ExponentShift::None), exp(x));
        assert_eq!(density(x, Exponent::Clamped, ExponentShift::None), exp(clamped));
    }
}

/// Where each gradient stops to follow the exponential, and 1 taken off in both directions.
#[test]
fn gradients_stop_where_their_convention_says() {
    let stops = [ExponentGradient::BothEnds, ExponentGradient::Above, ExponentGradient::Above11];
    let at = |x: f64| stops.map(|stop| backward::trunc_exp(x, 2.0, stop, ExponentShift::None));
    assert_eq!(at(5.0), [2.0 * exp(5.0); 3]);
    assert_eq!(at(20.0), [15.0, 15.0, 11.0].map(|stop| 2.0 * exp(stop)));
    assert_eq!(at(-20.0), [-15.0, -20.0, -20.0].map(|stop| 2.0 * exp(stop)));
    for (stop, x) in stops.into_iter().zip([-3.0, 16.5, 12.5]) {
        let (shifted, plain) = (
            backward::trunc_exp(x, 1.0, stop, ExponentShift::One),
            backward::trunc_exp(x - 1.0, 1.0, stop, ExponentShift::None),
        );
        assert_eq!(shifted, plain);
    }
    assert_eq!(density(17.0, Exponent::Clamped, ExponentShift::One), exp(15.0));
    assert_eq!(density(3.0, Exponent::Free, ExponentShift::One), exp(2.0));
}

#[test]
fn is_finite_everywhere() {
    for x in [-1e300, -800.0, 800.0, 1e300] {
        assert!(surrogate(x).is_finite() && surrogate(x) > 0.0);
    }
    // VR6: e^x overflows past 709; nothing is NaN.
    assert_eq!((trunc_exp(709.0).is_finite(), trunc_exp(710.0)), (true, f64::INFINITY));
    assert_eq!(trunc_exp(-746.0), 0.0);
}
