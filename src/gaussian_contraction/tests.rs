//! Closed forms, the tangent by differences, what the contraction leaves of a Gaussian, and slopes.

use approx::assert_relative_eq;
use proptest::prelude::*;

use super::*;
use crate::contract::testing::{properties, slope};
use crate::convention::ContractionNorm::{L2, Linf, Merf};
use crate::convention::ContractionRange::{One, Two, Unit};

const NORMS: [ContractionNorm; 3] = [L2, Linf, Merf];
const RANGES: [ContractionRange; 3] = [Two, One, Unit];

fn matrix() -> impl Strategy<Value = [[f64; 3]; 3]> {
    prop::array::uniform3(prop::array::uniform3(-1.0..1.0))
}

/// A point away from both surfaces and from ties of the largest coordinate, at sizes of 0.1 to 1000, and how far it may be moved.
fn point() -> impl Strategy<Value = ([f64; 3], f64)> {
    let points = (prop::array::uniform3(-1.0..1.0), -1.0..3.0)
        .prop_map(|(x, scale)| x.map(|x: f64| x * f64::powf(10.0, scale)));
    points.prop_filter_map("smooth there", |x| {
        let mut sizes = x.map(f64::abs);
        sizes.sort_by(f64::total_cmp);
        let apart = 0.02 * sizes[2].max(0.1);
        let smooth = NORMS.iter().all(|&norm| (length(x, norm) - 1.0).abs() > 0.02);
        (smooth && sizes[2] - sizes[1] > apart).then_some((x, apart))
    })
}

fn determinant(m: [[f64; 3]; 3]) -> f64 {
    let minor = |a: usize, b: usize| m[1][a] * m[2][b] - m[1][b] * m[2][a];
    m[0][0] * minor(1, 2) - m[0][1] * minor(0, 2) + m[0][2] * minor(0, 1)
}

proptest! {
    #![proptest_config(properties())]

    #[test]
    fn the_jacobian_is_that_of_differences((x, apart) in point()) {
        for norm in NORMS {
            for range in RANGES {
                let j = jacobian(x, norm, range);
                for a in 0..3 {
                    for i in 0..3 {
                        let by_differences = slope(|step| {
                            let mut at = x;
                            at[a] += apart * step;
                            contract(at, norm, range)[i]
                        }) / apart;
                        let off = (j[i][a] - by_differences).abs();
                        let allowed = 1e-9 / (1.0 + length(x, L2));
                        prop_assert!(off <= allowed, "{norm:?} {i} {a}: {} {by_differences}", j[i][a]);
                    }
                }
            }
        }
    }

    /// Volumes shrink by s^2 / r^2, in MERF's norm by 1 / r^4.
    #[test]
    fn volumes_shrink_by_the_squared_determinant((x, _) in point(), half in matrix()) {
        let sigma = between(half, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        let whole = [0, 1, 2].map(|i| { let mut row = sigma[i]; row[i] += 0.5; row });
        for norm in NORMS {
            let r = length(x, norm).max(1.0);
            let s = if norm == Merf { 1.0 / r } else { (2.0 - 1.0 / r) / r };
            let by = determinant(contract_gaussian(&Gaussian { mean: x, covariance: whole }, norm, Two).covariance)
                / determinant(whole);
            let root = s * s / (r * r);
            // What is left along the ray is a difference of entries r times as large.
            prop_assert!((by - root * root).abs() <= 1e-11 * r * r * root * root, "{norm:?} {x:?}: {by} {}", root * root);
        }
    }

    /// A symmetric matrix stays one, and what no direction is narrower than 0 in.
    #[test]
    fn covariances_stay_covariances((x, _) in point(), half in matrix(), along in prop::array::uniform3(-1.0..1.0)) {
        let sigma = between(half, [[1.0, 0.0, 0.0], [0.0, 0.25, 0.0], [0.0, 0.0, 0.0]]);
        for norm in NORMS {
            let c = contract_gaussian(&Gaussian { mean: x, covariance: sigma }, norm, Two).covariance;
            let size = c[0][0] + c[1][1] + c[2][2];
            let mut variance = 0.0;
            for i in 0..3 {
                for k in 0..3 {
                    prop_assert!((c[i][k] - c[k][i]).abs() <= 1e-14 * size);
                    variance += along[i] * c[i][k] * along[k];
                }
            }
            prop_assert!(variance >= -1e-14 * size);
        }
    }

    #[test]
    fn gradients_are_those_of_differences(
        (x, apart) in point(),
        covariance in matrix(),
        g_mean in prop::array::uniform3(-1.0..1.0),
        g_covariance in matrix(),
    ) {
        let at = Gaussian { mean: x, covariance };
        let g = Gaussian { mean: g_mean, covariance: g_covariance };
        for (norm, range) in NORMS.into_iter().flat_map(|norm| RANGES.map(|range| (norm, range))) {
            let by_hand = backward::contract_gaussian(&at, &g, norm, range);
            let inner = |at: &Gaussian| -> f64 {
                let y = contract_gaussian(at, norm, range);
                let mean: f64 = (0..3).map(|i| g.mean[i] * y.mean[i]).sum();
                mean + (0..9).map(|n| g.covariance[n / 3][n % 3] * y.covariance[n / 3][n % 3]).sum::<f64>()
            };
            let r = length(x, L2);
            for a in 0..3 {
                let by_differences = slope(|step| {
                    let mut moved = at;
                    moved.mean[a] += apart * step;
                    inner(&moved)
                }) / apart;
                let off = (by_hand.mean[a] - by_differences).abs();
                prop_assert!(off <= 3e-8 / (1.0 + r), "{norm:?} {range:?} {a}: {} {by_differences}", by_hand.mean[a]);
            }
            for n in 0..9 {
                let by_differences = slope(|step| {
                    let mut moved = at;
                    moved.covariance[n / 3][n % 3] += step;
                    inner(&moved)
                });
                let off = (by_hand.covariance[n / 3][n % 3] - by_differences).abs();
                prop_assert!(off <= 1e-11 + 1e-9 / (1.0 + r), "{norm:?} {range:?} {n}: {by_differences}");
            }
        }
    }
}

/// Rows times columns; two in a row hide a sign.
#[test]
fn products_of_matrices() {
    let a = [[1.0, 2.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let b = [[1.0, 0.0, 0.0], [3.0, 1.0, 0.0], [0.0, 0.0, 2.0]];
    assert_eq!(product(a, b), [[7.0, 2.0, 0.0], [3.0, 1.0, 0.0], [0.0, 0.0, 2.0]]);
}

/// On an axis: s^2 across, 1 / r^4 along, nothing between.
#[test]
fn on_an_axis_it_is_diagonal() {
    let covariance = [[1.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 9.0]];
    for (norm, across) in [(L2, 0.4375), (Linf, 0.4375), (Merf, 0.25)] {
        let y = contract_gaussian(&Gaussian { mean: [0.0, -4.0, 0.0], covariance }, norm, Two);
        assert_eq!(y.mean, [0.0, -1.75, 0.0]);
        let square = across * across;
        assert_eq!(y.covariance, [[square, 0.0, 0.0], [0.0, 4.0 / 256.0, 0.0], [0.0, 0.0, 9.0 * square]]);
    }
}

/// CG6, CG7: on the surface and within nothing moves, and nothing is bent.
#[test]
fn inside_it_stays_as_it_is() {
    let covariance = [[0.5, 0.25, -0.125], [0.25, 1.0, 0.0], [-0.125, 0.0, 2.0]];
    let g = Gaussian {
        mean: [1.0, -2.0, 0.5],
        covariance: [[1.0, 2.0, 3.0], [-1.0, 0.5, 4.0], [0.0, 1.0, -2.0]],
    };
    for mean in [[0.0; 3], [0.25, -0.5, 0.125], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]] {
        let x = Gaussian { mean, covariance };
        for norm in NORMS {
            assert_eq!(contract_gaussian(&x, norm, Two), x);
            assert_eq!(backward::contract_gaussian(&x, &g, norm, Two), g);
            let quarter = backward::contract_gaussian(&x, &g, norm, Unit);
            assert_eq!((quarter.mean[1], quarter.covariance[1][2]), (-0.5, 0.25));
            assert_eq!(contract_gaussian(&x, norm, One).covariance[0], [0.125, 0.0625, -0.03125]);
        }
    }
}

/// CG8: of coordinates that tie, the first is the largest.
#[test]
fn ties_go_to_the_first() {
    let x = [2.0, -2.0, 1.0];
    assert_eq!(jacobian(x, Linf, Two), [[0.25, 0.0, 0.0], [0.5, 0.75, 0.0], [-0.25, 0.0, 0.75]]);
    assert_eq!(jacobian(x, Merf, Two), [[0.25, 0.0, 0.0], [0.5, 0.5, 0.0], [-0.25, 0.0, 0.5]]);
}

/// CG9: far away, beside an axis, what is along the ray isn't lost in what is across: no entry is a difference.
#[test]
fn nothing_cancels_far_away() {
    let j = jacobian([1e12, 1e2, 0.0], L2, Two);
    // 1 / r^2 and s x_2^2 / r^2 = 2e-12 1e-20.
    assert_relative_eq!(j[0][0], 1e-24 + 2e-32, max_relative = 1e-9);
    assert_relative_eq!(j[0][1], -2e-22, max_relative = 1e-9);
    assert_relative_eq!(j[1][1], 2e-12, max_relative = 1e-9);
    let j = jacobian([1e12, 1e2, 0.0], Linf, Two);
    assert_eq!((j[0][0], j[0][1]), (1.0 / (1e12 * 1e12), 0.0));
    assert_relative_eq!(j[1][0], -2e-22, max_relative = 1e-9);
}
