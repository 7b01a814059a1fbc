//! A scaler over many steps: what it keeps, and where it ends.

use proptest::prelude::*;

use super::*;
use crate::contract::testing::properties;
use crate::optimizer::{Adam, Moments, adam_step};

const USUAL: LossScale =
    LossScale { scale: 1024.0, tracker: 0, growth_factor: 2.0, backoff_factor: 0.5, growth_interval: 4 };

/// Scales and trackers over steps with and without overflows.
fn run(mut s: LossScale, overflows: &[bool]) -> Vec<(f64, u64)> {
    let step = |found: &bool| {
        (s.scale, s.tracker) = updated(&s, *found, LossScaleFloor::None, LossScaleCeiling::None);
        (s.scale, s.tracker)
    };
    overflows.iter().map(step).collect()
}

#[test]
fn it_grows_after_the_interval_and_shrinks_at_once() {
    let steps = run(USUAL, &[false, false, false, false, false, true, false, false, false, false]);
    let (scales, trackers): (Vec<f64>, Vec<u64>) = steps.into_iter().unzip();
    assert_eq!(scales, [1024.0, 1024.0, 1024.0, 2048.0, 2048.0, 1024.0, 1024.0, 1024.0, 1024.0, 2048.0]);
    assert_eq!(trackers, [1, 2, 3, 0, 1, 0, 1, 2, 3, 0]);
    // An interval that was made shorter on the way is over.
    assert_eq!(run(LossScale { tracker: 7, ..USUAL }, &[false]), [(2048.0, 0)]);
}

#[test]
fn limits_hold_what_changes() {
    let held = |scale, tracker, found| {
        updated(&LossScale { scale, tracker, ..USUAL }, found, LossScaleFloor::One, LossScaleCeiling::TwoTo24)
    };
    assert_eq!((held(1.5, 2, true), held(4.0, 2, true)), ((1.0, 0), (2.0, 0)));
    assert_eq!((held(1.5e7, 3, false), held(1.5e7, 2, false)), ((16_777_216.0, 0), (1.5e7, 3)));
    assert_eq!((held(0.25, 2, false), held(3e7, 2, false)), ((0.25, 3), (3e7, 3)));
    assert_eq!(held(8.0, 3, false), (16.0, 0));
    let low = |scale| {
        updated(
            &LossScale { scale, tracker: 3, ..USUAL },
            false,
            LossScaleFloor::None,
            LossScaleCeiling::TwoTo16,
        )
    };
    assert_eq!((low(40_000.0), low(20_000.0)), ((65_536.0, 0), (40_000.0, 0)));
}

/// Adam's parameters and moments after a step by scaled gradients, as the documentation of `unscaled` asks for it.
fn stepped(before: Moments, gradient: f64, scale: f64) -> Moments {
    let adam = Adam { lr: 0.1, beta1: 0.9, beta2: 0.99, eps: 1e-8, weight_decay: 0.1 };
    match unscaled(&[gradient], scale) {
        Some(g) => adam_step(&adam, before, g[0], 1),
        None => before,
    }
}

/// A skipped step leaves everything as it was; another one is that of the loss without the scale.
#[test]
fn a_step_with_an_overflow_is_skipped() {
    let before = Moments { param: 1.5, m: 0.25, v: 0.125 };
    for overflow in [f64::INFINITY, f64::NEG_INFINITY, f64::NAN] {
        assert_eq!(stepped(before, overflow, 1024.0), before);
    }
    assert_eq!(stepped(before, 512.0, 1024.0), stepped(before, 0.5, 1.0));
    assert!(stepped(before, 512.0, 1024.0) != before);
}

/// The largest finite numbers are no overflow, and one that isn't finite is one wherever it stands.
#[test]
fn every_place_is_looked_at() {
    assert_eq!(unscaled(&[f64::MAX, -f64::MAX, 5e-324], 1.0), Some(vec![f64::MAX, -f64::MAX, 5e-324]));
    assert_eq!(unscaled(&[], 2.0), Some(vec![]));
    for n in 0..4 {
        for x in [f64::INFINITY, f64::NEG_INFINITY, f64::NAN] {
            let mut g = [1.0, -2.0, 0.0, 65504.0];
            g[n] = x;
            assert_eq!(unscaled(&g, 8.0), None);
        }
    }
}

proptest! {
    #![proptest_config(properties())]

    /// What is scaled by a power of two and unscaled again is what it was, to the last bit.
    #[test]
    fn powers_of_two_leave_nothing(g in prop::collection::vec(-10.0..10.0f64, 1..9), exponent in -8..24) {
        let scale = libm::ldexp(1.0, exponent);
        let scaled: Vec<f64> = g.iter().map(|g| g * scale).collect();
        prop_assert_eq!(unscaled(&scaled, scale), Some(g));
    }

    /// By powers of two: the scale counts overflows and whole intervals, and the tracker what is left of the last one.
    #[test]
    fn it_counts(overflows in prop::collection::vec(prop::bool::weighted(0.2), 1..60)) {
        let steps = run(USUAL, &overflows);
        let (mut exponent, mut since) = (0, 0);
        for (found, (scale, tracker)) in overflows.iter().zip(steps) {
            since = if *found { 0 } else { since + 1 };
            exponent += if *found { -1 } else { i32::from(since > 0 && since % 4 == 0) };
            prop_assert_eq!((scale, tracker), (libm::ldexp(1024.0, exponent), since % 4));
        }
    }
}
