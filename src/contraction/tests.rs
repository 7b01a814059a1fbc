//! Closed forms, what the contraction leaves as it is, and slopes.

use approx::assert_relative_eq;
use proptest::prelude::*;

use super::{backward, contract};
use crate::contract::testing::{properties, slope};
use crate::convention::ContractionNorm::{self, L2, Linf, Merf};
use crate::convention::ContractionRange::{One, Two, Unit};

const NORMS: [ContractionNorm; 3] = [L2, Linf, Merf];

fn l2(x: [f64; 3]) -> f64 {
    (x[0] * x[0] + x[1] * x[1] + x[2] * x[2]).sqrt()
}

fn linf(x: [f64; 3]) -> f64 {
    x[0].abs().max(x[1].abs()).max(x[2].abs())
}

fn point() -> impl Strategy<Value = [f64; 3]> {
    (prop::array::uniform3(-1.0..1.0), -2.0..3.0)
        .prop_map(|(x, scale)| x.map(|x: f64| x * f64::powf(10.0, scale)))
}

proptest! {
    #![proptest_config(properties())]

    /// r becomes 2 - 1/r: the disparity of what is far is what is left up to 2.
    #[test]
    fn disparity_is_what_is_left_up_to_two(x in point()) {
        for (norm, length) in [(L2, l2 as fn([f64; 3]) -> f64), (Linf, linf), (Merf, linf)] {
            let (before, after) = (length(x), length(contract(x, norm, Two)));
            let expected = if before <= 1.0 { before } else { 2.0 - 1.0 / before };
            prop_assert!((after - expected).abs() <= 1e-15 * 4.0, "{norm:?} {x:?}: {after}, not {expected}");
        }
    }

    /// A point stays on its line through the origin, where one factor scales all coordinates.
    #[test]
    fn directions_are_kept(x in point()) {
        for norm in [L2, Linf] {
            let y = contract(x, norm, Two);
            for (i, j) in [(0, 1), (1, 2), (0, 2)] {
                prop_assert!((x[i] * y[j] - x[j] * y[i]).abs() <= 1e-14 * l2(x) * l2(y));
            }
        }
    }

    #[test]
    fn the_other_ranges_are_its_multiples(x in point()) {
        for norm in NORMS {
            let y = contract(x, norm, Two);
            prop_assert_eq!(contract(x, norm, One), y.map(|y| y / 2.0));
            prop_assert_eq!(contract(x, norm, Unit), y.map(|y| y / 4.0 + 0.5));
        }
    }

    #[test]
    fn the_gradient_is_that_of_differences(x in point(), g in prop::array::uniform3(-1.0..1.0)) {
        for norm in NORMS {
            // A difference across a kink has no slope: ties of the largest coordinate, and MERF's surface.
            let mut sizes = x.map(f64::abs);
            sizes.sort_by(f64::total_cmp);
            let apart = 0.02 * sizes[2].max(1e-2);
            prop_assume!(sizes[2] - sizes[1] > apart && (l2(x) - 1.0).abs() > 0.02 && (linf(x) - 1.0).abs() > 0.02);
            for range in [Two, One, Unit] {
                let by_hand = backward::contract(x, g, norm, range);
                for j in 0..3 {
                    let moved = |s: f64| {
                        let mut at = x;
                        at[j] += apart * s;
                        let y = contract(at, norm, range);
                        g[0] * y[0] + g[1] * y[1] + g[2] * y[2]
                    };
                    let by_differences = slope(moved) / apart;
                    let allowed = 1e-7 * (1.0 + by_differences.abs()) / (1.0 + l2(x)) + 1e-11;
                    let off = (by_hand[j] - by_differences).abs();
                    prop_assert!(off <= allowed, "{norm:?} {j}: {} {by_differences}", by_hand[j]);
                }
            }
        }
    }
}

/// MERF: lines outside of the cube that lie in one face's pyramid are straight after, as a perspective picture has them.
#[test]
fn merf_keeps_straight_lines_straight() {
    let at = |t: f64| contract([2.0 + t, 1.0 + 0.25 * t, -0.5 + 0.125 * t], Merf, Two);
    let [a, b, c] = [at(0.0), at(1.0), at(5.0)];
    let part = (b[0] - a[0]) / (c[0] - a[0]);
    for j in [1, 2] {
        assert_relative_eq!(b[j] - a[j], part * (c[j] - a[j]), max_relative = 1e-14);
    }
}

/// CG6: at the origin nothing is divided by 0.
#[test]
fn the_origin_stays_with_its_gradient() {
    for norm in NORMS {
        assert_eq!(contract([0.0; 3], norm, Two), [0.0; 3]);
        assert_eq!(contract([0.0; 3], norm, Unit), [0.5; 3]);
        assert_eq!(backward::contract([0.0; 3], [1.0, -2.0, 3.0], norm, Two), [1.0, -2.0, 3.0]);
        assert_eq!(backward::contract([0.0; 3], [1.0, -2.0, 3.0], norm, One), [0.5, -1.0, 1.5]);
        assert_eq!(backward::contract([0.0; 3], [4.0, -8.0, 2.0], norm, Unit), [1.0, -2.0, 0.5]);
    }
}

/// CG7: at r = 1 L2 and L-infinity have one value and one derivative, those of the inside.
#[test]
fn the_pieces_meet_at_the_surface() {
    let g = [1.0, -2.0, 0.5];
    for x in [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0]] {
        let beyond = x.map(|x: f64| x * (1.0 + 1e-9));
        for norm in NORMS {
            assert_eq!(contract(x, norm, Two), x);
            let y = contract(beyond, norm, Two);
            (0..3).for_each(|j| assert!((y[j] - beyond[j]).abs() < 1e-15));
        }
        for norm in [L2, Linf] {
            assert_eq!(backward::contract(x, g, norm, Two), g);
            let g_x = backward::contract(beyond, g, norm, Two);
            (0..3).for_each(|j| assert!((g_x[j] - g[j]).abs() < 1e-8));
        }
    }
}

/// CG8: of coordinates that tie, the first is the largest.
#[test]
fn ties_go_to_the_first() {
    assert_eq!(contract([2.0, -2.0, 1.0], Merf, Two), [1.5, -1.0, 0.5]);
    assert_eq!(contract([1.0, 2.0, 2.0], Merf, Two), [0.5, 1.5, 1.0]);
    assert_eq!(contract([1.0, -1.0, 2.0], Merf, Two), [0.5, -0.5, 1.5]);
    assert_eq!(backward::contract([2.0, -2.0, 1.0], [1.0; 3], Linf, Two), [0.5, 0.75, 0.75]);
    assert_eq!(backward::contract([2.0, -2.0, 1.0], [1.0; 3], Merf, Two), [0.5, 0.5, 0.5]);
}

/// What no number can be further than.
#[test]
fn the_farthest_points_stay_in_range() {
    for norm in NORMS {
        for x in [[1e150, -1e150, 3.0], [1e100, 0.0, 0.0], [1e16, 1e16, 1e16]] {
            let y = contract(x, norm, Two);
            assert!(y.iter().all(|y| y.is_finite() && y.abs() <= 2.0), "{norm:?} {y:?}");
            let g_x = backward::contract(x, [1.0; 3], norm, Two);
            assert!(g_x.iter().all(|g| g.is_finite() && g.abs() < 1e-15), "{norm:?} {g_x:?}");
        }
    }
}
