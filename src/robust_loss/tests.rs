//! Pieces by hand, where they meet, what they lie between, and slopes.

use proptest::prelude::*;

use super::{backward, charbonnier, huber};
use crate::contract::testing::{properties, slope};
use crate::convention::{CharbonnierEps, HuberSlope, LossReduction};

const SLOPES: [HuberSlope; 2] = [HuberSlope::Delta, HuberSlope::One];
const EPS: [CharbonnierEps; 2] = [CharbonnierEps::Square, CharbonnierEps::AsGiven];
const REDUCTIONS: [LossReduction; 2] = [LossReduction::Mean, LossReduction::Sum];

fn pairs() -> impl Strategy<Value = (Vec<f64>, Vec<f64>)> {
    prop::collection::vec((-2.0..2.0, -2.0..2.0), 1..8).prop_map(|pairs| pairs.into_iter().unzip())
}

proptest! {
    #![proptest_config(properties())]

    /// Huber's is what the best split of d into an inlier's square and an outlier's length costs: min over s of s^2 / 2 + delta |d - s|.
    #[test]
    fn huber_is_the_cheapest_split(d in -3.0..3.0f64, delta in 0.1..2.0, s in -3.0..3.0f64) {
        let loss = huber(&[d], &[0.0], delta, HuberSlope::Delta, LossReduction::Mean);
        prop_assert!(loss <= 0.5 * s * s + delta * (d - s).abs() + 1e-12);
        let best = d.clamp(-delta, delta);
        prop_assert!((loss - (0.5 * best * best + delta * (d - best).abs())).abs() < 1e-14);
        let scaled = huber(&[d], &[0.0], delta, HuberSlope::One, LossReduction::Mean);
        prop_assert!((scaled * delta - loss).abs() < 1e-14);
    }

    /// |d| < sqrt(d^2 + eps^2) <= |d| + eps, with the equality at 0; and (loss - d) (loss + d) = eps^2.
    #[test]
    fn charbonnier_is_nearly_the_length(d in -3.0..3.0f64, eps in 0.01..1.0) {
        let loss = |d, eps, form| charbonnier(&[d], &[0.0], eps, form, LossReduction::Mean);
        let found = loss(d, eps, CharbonnierEps::Square);
        prop_assert!(d.abs() < found && found <= d.abs() + eps);
        prop_assert!(((found - d) * (found + d) - eps * eps).abs() < 1e-14);
        prop_assert_eq!(loss(0.0, eps, CharbonnierEps::Square), (eps * eps).sqrt());
        prop_assert!((loss(d, eps * eps, CharbonnierEps::AsGiven) - found).abs() < 1e-15);
    }

    #[test]
    fn the_mean_is_the_sum_over_the_entries((p, t) in pairs(), delta in 0.1..2.0) {
        let n = p.len() as f64;
        let [mean, sum] = REDUCTIONS.map(|r| huber(&p, &t, delta, HuberSlope::Delta, r));
        prop_assert_eq!(mean, sum / n);
        let [mean, sum] = REDUCTIONS.map(|r| charbonnier(&p, &t, delta, CharbonnierEps::Square, r));
        prop_assert_eq!(mean, sum / n);
    }

    #[test]
    fn gradients_are_those_of_differences((p, t) in pairs(), delta in 0.2..2.0, g in -2.0..2.0) {
        let check = |by_hand: &[f64], f: &dyn Fn(&[f64]) -> f64| {
            for (k, by_hand) in by_hand.iter().enumerate() {
                // A kink of the second derivative costs differences some digits.
                if f64::abs(f64::abs(p[k] - t[k]) - delta) < 0.01 {
                    continue;
                }
                let expected = slope(|step| {
                    let mut p = p.clone();
                    p[k] += step;
                    g * f(&p)
                });
                assert!((by_hand - expected).abs() < 1e-7, "{k}: {by_hand} {expected}");
            }
        };
        for r in REDUCTIONS {
            for s in SLOPES {
                check(&backward::huber(&p, &t, delta, s, r, g), &|p| huber(p, &t, delta, s, r));
            }
            for e in EPS {
                check(&backward::charbonnier(&p, &t, delta, e, r, g), &|p| charbonnier(p, &t, delta, e, r));
            }
        }
    }
}

/// At delta the two pieces meet, with their slopes; at 0 there is none.
#[test]
fn pieces_meet() {
    let loss = |d: f64| huber(&[d], &[0.0], 0.5, HuberSlope::Delta, LossReduction::Sum);
    let gradient = |d: f64| backward::huber(&[d], &[0.0], 0.5, HuberSlope::Delta, LossReduction::Sum, 1.0)[0];
    for sign in [-1.0, 1.0] {
        assert_eq!((loss(sign * 0.5), gradient(sign * 0.5)), (0.125, sign * 0.5));
        let beyond = 0.5 * (1.0 + 2.0 * f64::EPSILON);
        assert!((loss(sign * beyond) - 0.125).abs() < 1e-15);
        assert_eq!(gradient(sign * beyond), sign * 0.5);
        assert_eq!((loss(sign * 2.0), gradient(sign * 2.0)), (0.875, sign * 0.5));
    }
    assert_eq!((loss(0.0), gradient(0.0)), (0.0, 0.0));
    let flat =
        backward::charbonnier(&[0.25], &[0.25], 0.001, CharbonnierEps::Square, LossReduction::Mean, 1.0);
    assert_eq!(flat, [0.0]);
}
