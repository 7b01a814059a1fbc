//! Ends and means by hand, what schedules keep from step to step, and what each is among the others.

use proptest::prelude::*;

use super::*;
use crate::contract::testing::properties;

const ENDS: [RateEnd; 2] = [RateEnd::GoesOn, RateEnd::Held];

fn delays(steps: u64, mult: f64) -> Vec<Delay> {
    let places = [RateDelay::Beside, RateDelay::Before];
    let ramps = [RateRamp::Sine, RateRamp::Linear];
    places.into_iter().flat_map(|place| ramps.map(|ramp| Delay { steps, mult, place, ramp })).collect()
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-14 * b.abs()
}

#[test]
fn an_exponential_goes_from_lr_to_its_fraction() {
    for end in ENDS {
        assert_eq!((exponential(0.5, 0.01, 0, 10, end), exponential(0.5, 0.25, 10, 10, end)), (0.5, 0.125));
        assert!(near(exponential(1.0, 0.25, 5, 10, end), 0.5));
    }
    assert_eq!(exponential(1.0, 0.5, 30, 10, RateEnd::GoesOn), 0.125);
    assert_eq!(exponential(1.0, 0.5, 30, 10, RateEnd::Held), 0.5);
    // NeRF's: a tenth after 250,000 steps.
    assert!(near(exponential(5e-4, 0.1, 250_000, 250_000, RateEnd::GoesOn), 5e-5));
}

#[test]
fn a_cosine_has_its_quarters_and_turns_around() {
    let rate = |step, end| cosine([1.0, 0.0], step, 8, 0, end);
    let root = 0.5f64.sqrt();
    for end in ENDS {
        assert_eq!((rate(0, end), rate(4, end), rate(8, end)), (1.0, 0.5, 0.0));
        assert!(near(rate(2, end), 0.5 * (1.0 + root)) && near(rate(6, end), 0.5 * (1.0 - root)));
    }
    assert_eq!((rate(12, RateEnd::GoesOn), rate(16, RateEnd::GoesOn)), (0.5, 1.0));
    assert_eq!((rate(12, RateEnd::Held), rate(16, RateEnd::Held)), (0.0, 0.0));
}

#[test]
fn a_warm_up_is_a_straight_line_to_the_first_rate() {
    let rate = |step| cosine([0.5, 0.125], step, 24, 8, RateEnd::Held);
    assert_eq!([0, 1, 4, 7, 8].map(rate), [0.0, 0.0625, 0.25, 0.4375, 0.5]);
    assert_eq!((rate(16), rate(24), rate(99)), (0.3125, 0.125, 0.125));
}

#[test]
fn a_delay_begins_at_its_factor_and_ends_with_none() {
    for delay in delays(6, 0.25) {
        let rate = |step| log_linear([0.5, 0.125], step, 22, &delay);
        assert_eq!(rate(0), 0.125);
        assert_eq!((rate(22), rate(40)), (0.125, 0.125));
        let without = log_linear([0.5, 0.125], 8, 22, &Delay { steps: 0, ..delay });
        match delay.place {
            RateDelay::Beside => assert_eq!(rate(8), without),
            // Half of the sixteen steps that are left.
            RateDelay::Before => assert!(rate(6) == 0.5 && near(rate(14), 0.25)),
        }
        // A third of the delay, by the ramp alone.
        let risen = rate(2) / if delay.place == RateDelay::Beside { pow(0.25, 2.0 / 22.0) } else { 1.0 };
        let ramp = if delay.ramp == RateRamp::Sine { 0.5 } else { 1.0 / 3.0 };
        assert!(near(risen, 0.5 * (0.25 + 0.75 * ramp)), "{delay:?}: {risen}");
    }
}

proptest! {
    #![proptest_config(properties())]

    /// Two steps of s are one of twice as many: every exponential is its own scheduler.
    #[test]
    fn an_exponential_keeps_its_ratio(lr in 1e-4..1.0f64, decay in 0.01..1.0f64, s in 0u64..100, steps in 1u64..100) {
        let rate = |step| exponential(lr, decay, step, steps, RateEnd::GoesOn);
        prop_assert!((rate(2 * s) * lr - rate(s) * rate(s)).abs() <= 1e-13 * rate(s) * rate(s));
        let held = exponential(lr, decay, s, steps, RateEnd::Held);
        prop_assert_eq!(held, rate(s.min(steps)));
    }

    /// Between its ends a cosine falls, and what it has lost at p it has left at 1 - p.
    #[test]
    fn a_cosine_is_symmetric(first in 0.5..1.0f64, last in 0.0..0.5f64, warmup in 0u64..50, s in 0u64..100) {
        let rate = |step| cosine([first, last], warmup + step, warmup + 100, warmup, RateEnd::Held);
        prop_assert!((rate(s) + rate(100 - s) - first - last).abs() < 1e-14);
        prop_assert!(rate(s + 1) <= rate(s));
    }

    /// Without a delay a log-linear decay is an exponential that is held, and linear in logarithms.
    #[test]
    fn a_log_linear_decay_is_an_exponential(first in 0.1..1.0f64, last in 1e-3..0.1f64, s in 0u64..200) {
        let rate = |step| log_linear([first, last], step, 100, &Delay::default());
        prop_assert_eq!(rate(s), exponential(first, last / first, s, 100, RateEnd::Held));
        let t = (s as f64 / 100.0).min(1.0);
        prop_assert!((rate(s).ln() - (1.0 - t) * first.ln() - t * last.ln()).abs() < 1e-13);
        for delay in delays(40, 0.01) {
            let delayed = log_linear([first, last], s, 100, &delay);
            let whole = if delay.place == RateDelay::Before && s < 40 { first } else { rate(s) };
            prop_assert!(delayed > 0.0 && (delay.place == RateDelay::Before || delayed <= whole));
        }
    }
}
