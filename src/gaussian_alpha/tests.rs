//! Closed forms, what cuts do, and slopes.

use approx::assert_relative_eq;
use proptest::prelude::*;

use super::{Form, Splat, alpha, backward};
use crate::contract::testing::{properties, slope};
use crate::convention::{AlphaCap, CapGradient, ConicGradient, Faint, PositivePower};

fn splat() -> impl Strategy<Value = Splat> {
    (prop::array::uniform2(-2.0..2.0), 0.1..2.0, -0.9..0.9, 0.1..2.0, 0.05..0.95).prop_map(
        |(mean, a, share, c, opacity): ([f64; 2], f64, f64, f64, f64)| Splat {
            mean,
            conic: [a, share * (a * c).sqrt(), c],
            opacity,
        },
    )
}

proptest! {
    #![proptest_config(properties())]

    /// Of a diagonal conic: a product of two Gaussians of one dimension.
    #[test]
    fn without_a_slant_it_is_a_product(pixel in prop::array::uniform2(-3.0..3.0), splat in splat()) {
        let upright = Splat { conic: [splat.conic[0], 0.0, splat.conic[2]], ..splat };
        let along = |k: usize, c: f64| crate::math::exp(-0.5 * c * (pixel[k] - splat.mean[k]) * (pixel[k] - splat.mean[k]));
        let expected = splat.opacity * along(0, splat.conic[0]) * along(1, splat.conic[2]);
        prop_assert!((alpha(pixel, &upright, Form::default()) - expected).abs() < 1e-15);
    }

    /// Of any conic: the same on either side of the mean, and after the slant is turned off by a shear.
    #[test]
    fn a_slant_is_a_shear(d in prop::array::uniform2(-3.0..3.0), splat in splat()) {
        let [a, b, c] = splat.conic;
        let at = |d: [f64; 2], s: &Splat| alpha([s.mean[0] + d[0], s.mean[1] + d[1]], s, Form::default());
        let upright = Splat { conic: [a, 0.0, c - b * b / a], ..splat };
        let sheared = [d[0] + b / a * d[1], d[1]];
        prop_assert!((at(d, &splat) - at(sheared, &upright)).abs() < 1e-14);
        prop_assert!((at(d, &splat) - at([-d[0], -d[1]], &splat)).abs() < 1e-14);
    }

    #[test]
    fn gradients_are_those_of_differences(pixel in prop::array::uniform2(-3.0..3.0), splat in splat(), g in -1.0..1.0f64) {
        let form = Form::default();
        let by_hand = backward::alpha(pixel, &splat, form, g);
        let close = |found: f64, moved: &dyn Fn(&mut Splat, f64)| {
            let expected = slope(|step| {
                let mut at = splat;
                moved(&mut at, 0.125 * step);
                g * alpha(pixel, &at, form)
            }) * 8.0;
            assert!((found - expected).abs() < 1e-7 * (1.0 + expected.abs()), "{found} {expected}");
        };
        for k in 0..2 {
            close(by_hand.mean[k], &|s, step| s.mean[k] += step);
        }
        for k in 0..3 {
            close(by_hand.conic[k], &|s, step| s.conic[k] += step);
        }
        close(by_hand.opacity, &|s, step| s.opacity += step);
        let entry = backward::alpha(pixel, &splat, Form { conic_gradient: ConicGradient::Entry, ..form }, g);
        prop_assert_eq!(entry.conic, [by_hand.conic[0], 0.5 * by_hand.conic[1], by_hand.conic[2]]);
    }
}

const NOTHING: Splat = Splat { mean: [0.0; 2], conic: [0.0; 3], opacity: 0.0 };

#[test]
fn what_is_cut_has_no_gradient() {
    let splat = Splat { mean: [0.0; 2], conic: [1.0, 0.0, 1.0], opacity: 1.0 };
    let capped = Form { cap: AlphaCap::Hundredth, ..Form::default() };
    assert_eq!(alpha([0.0; 2], &splat, capped), 0.99);
    assert_eq!(backward::alpha([0.0; 2], &splat, capped, 1.0), NOTHING);
    let through = Form { cap_gradient: CapGradient::Through, ..capped };
    assert_eq!(backward::alpha([0.0; 2], &splat, through, 1.0).opacity, 1.0);
    // Below the cap it is no matter.
    assert_eq!(
        backward::alpha([1.0, 0.0], &splat, capped, 1.0),
        backward::alpha([1.0, 0.0], &splat, Form::default(), 1.0)
    );
    let cut = Form { faint: Faint::Skipped, ..Form::default() };
    let edge = |factor: f64| {
        let at = [(2.0 * crate::math::ln(255.0 / factor)).sqrt(), 0.0];
        (alpha(at, &splat, cut), backward::alpha(at, &splat, cut, 1.0))
    };
    assert_eq!(edge(0.999), (0.0, NOTHING));
    assert_relative_eq!(edge(1.001).0, 1.001 / 255.0, max_relative = 1e-13);
    assert_relative_eq!(edge(1.001).1.opacity, 1.001 / 255.0, max_relative = 1e-13);
}

/// At the cap itself, and at 1 / 255 itself, nothing is cut.
#[test]
fn limits_belong_to_what_is_kept() {
    let splat = |opacity| Splat { mean: [0.0; 2], conic: [1.0, 0.0, 1.0], opacity };
    let form = Form { cap: AlphaCap::Hundredth, faint: Faint::Skipped, ..Form::default() };
    assert_eq!(backward::alpha([0.0; 2], &splat(0.99), form, 1.0).opacity, 1.0);
    assert_eq!(alpha([0.0; 2], &splat(1.0 / 255.0), form), 1.0 / 255.0);
    let skipping = Form { power: PositivePower::Skipped, ..form };
    assert_eq!(alpha([0.0; 2], &splat(0.5), skipping), 0.5, "an exponent of 0");
}

/// GS5: a conic that isn't positive has a splat without end.
#[test]
fn what_grows_with_the_distance_may_be_skipped() {
    let splat = Splat { mean: [0.0; 2], conic: [0.0, 1.0, 0.0], opacity: 0.5 };
    assert_eq!(alpha([1.0, -1.0], &splat, Form::default()), 0.5 * crate::math::exp(1.0));
    let form = Form { power: PositivePower::Skipped, ..Form::default() };
    assert_eq!(alpha([1.0, -1.0], &splat, form), 0.0);
    assert_eq!(backward::alpha([1.0, -1.0], &splat, form, 1.0), NOTHING);
    assert_eq!(alpha([1.0, 1.0], &splat, form), 0.5 * crate::math::exp(-1.0));
}
