//! The loss as an integral, what it is for, and its gradient by differences.

use approx::assert_relative_eq;
use proptest::prelude::*;

use super::{backward, distortion};
use crate::contract::testing::{properties, slope};

/// Weights and edges of up to eight intervals.
fn ray() -> impl Strategy<Value = (Vec<f64>, Vec<f64>)> {
    (prop::collection::vec((0.0..1.0, 0.1..2.0), 1..8), -3.0..3.0).prop_map(|(intervals, near)| {
        let mut t = vec![near];
        intervals.iter().for_each(|(_, length)| t.push(t[t.len() - 1] + length));
        (intervals.iter().map(|(w, _)| *w).collect(), t)
    })
}

proptest! {
    #![proptest_config(properties())]

    /// Equation 14: iint w(s) w(s') |s - s'| ds ds', with w_i / delta_i inside of an interval, by the midpoint rule on a fine grid.
    #[test]
    fn is_the_mean_distance_of_two_points((w, t) in ray()) {
        const CUTS: usize = 32;
        let mut points = vec![];
        for i in 0..w.len() {
            let length = (t[i + 1] - t[i]) / CUTS as f64;
            points.extend((0..CUTS).map(|k| (t[i] + (k as f64 + 0.5) * length, w[i] / CUTS as f64)));
        }
        let mut integral = 0.0;
        for (s, a) in &points {
            points.iter().for_each(|(r, b)| integral += a * b * (s - r).abs());
        }
        // The rule loses 1 / CUTS^2 of each interval's own term, exactly.
        let own: f64 = (0..w.len()).map(|i| w[i] * w[i] * (t[i + 1] - t[i]) / 3.0).sum();
        let expected = distortion(&w, &t) - own / (CUTS * CUTS) as f64;
        prop_assert!((integral - expected).abs() <= 1e-11 * (1.0 + expected), "{integral} {expected}");
    }

    /// N terms: twice the pairs in ascending order, by running sums; with what is at i in both sums or in neither.
    #[test]
    fn running_sums_have_the_same_value((w, t) in ray()) {
        let middle = |i: usize| 0.5 * (t[i] + t[i + 1]);
        let expected = distortion(&w, &t);
        for with_own in [0, 1] {
            let pairs: f64 = (0..w.len()).map(|i| {
                let weight: f64 = w[..i + with_own].iter().sum();
                let moment: f64 = (0..i + with_own).map(|j| w[j] * middle(j)).sum();
                w[i] * (middle(i) * weight - moment)
            }).sum();
            let own: f64 = (0..w.len()).map(|i| w[i] * w[i] * (t[i + 1] - t[i])).sum();
            prop_assert!((2.0 * pairs + own / 3.0 - expected).abs() <= 1e-12 * (1.0 + expected));
        }
    }

    /// Moved, nothing changes; stretched, it grows as much; an interval cut in two has the same loss.
    #[test]
    fn is_a_length((w, t) in ray(), far in -9.0..9.0, scale in 0.25..4.0, cut in 0.1..0.9) {
        let loss = distortion(&w, &t);
        let near = |a: f64, b: f64| (a - b).abs() <= 1e-12 * (1.0 + b.abs()) * 8.0;
        let moved = t.iter().map(|t| t + far).collect::<Vec<_>>();
        prop_assert!(near(distortion(&w, &moved), loss));
        let stretched = t.iter().map(|t| scale * t).collect::<Vec<_>>();
        prop_assert!(near(distortion(&w, &stretched), scale * loss));
        let (mut finer, mut edges) = (w.clone(), t.clone());
        finer.splice(..1, [w[0] * cut, w[0] * (1.0 - cut)]);
        edges.insert(1, t[0] + cut * (t[1] - t[0]));
        prop_assert!(near(distortion(&finer, &edges), loss));
    }

    #[test]
    fn the_gradient_is_that_of_differences((w, t) in ray(), g in -2.0..2.0) {
        let (g_w, g_t) = backward::distortion(&w, &t, g);
        for k in 0..w.len() + t.len() {
            let moved = |s: f64| {
                let (mut w, mut t) = (w.clone(), t.clone());
                if k < w.len() { w[k] += s } else { t[k - w.len()] += s }
                g * distortion(&w, &t)
            };
            let by_hand = if k < w.len() { g_w[k] } else { g_t[k - w.len()] };
            prop_assert!((by_hand - slope(moved)).abs() <= 1e-8 * (1.0 + by_hand.abs()), "{k}: {by_hand}");
        }
    }
}

/// VR8: at t = 1e4 and 1e8 the definition keeps the digits of the lengths.
#[test]
fn far_from_0_nothing_is_lost() {
    let (w, t) = ([0.25, 0.5, 0.125], [0.0, 0.5, 0.75, 2.0]);
    for far in [1e4, 1e8] {
        let moved = t.map(|t| t + far);
        assert_relative_eq!(distortion(&w, &moved), distortion(&w, &t), max_relative = 1e-15);
    }
}

/// No weight, no intervals: no loss, and no gradient.
#[test]
fn nothing_is_not_distorted() {
    assert_eq!(distortion(&[], &[1.0]), 0.0);
    assert_eq!(backward::distortion(&[], &[1.0], 1.0), (vec![], vec![0.0]));
    assert_eq!(distortion(&[0.0; 2], &[0.0, 1.0, 4.0]), 0.0);
    // A weight that is 0 still has a gradient: it would be far from the other.
    assert_eq!(backward::distortion(&[0.0, 1.0], &[0.0, 1.0, 3.0], 1.0).0, [3.0, 4.0 / 3.0]);
}

/// VR11: middles that tie have no derivative, and pass nothing.
#[test]
fn ties_pass_nothing() {
    let (_, g_t) = backward::distortion(&[0.5, 0.5], &[1.0, 1.0, 1.0], 3.0);
    assert_eq!(g_t, [-0.25, 0.0, 0.25]);
}

/// Middles half a rounding apart don't tie, though the sums of their edges round to one number: the one behind is pushed back by
/// g w_0 w_1, shared by its edges, the one in front forward.
#[test]
fn middles_that_round_to_one_do_not_tie() {
    let (_, g_t) = backward::distortion(&[0.5, 0.5], &[1.0, 1.0, 1.0 + f64::EPSILON], 3.0);
    assert_eq!(g_t, [-1.0, 0.0, 1.0]);
}
