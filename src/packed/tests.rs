//! Packed rays against rays one by one, gradients by the definition and by differences.

use proptest::prelude::*;

use super::{Scan, accumulate, backward, pack_info, scan};
use crate::contract::testing::{properties, slope};

/// Rays of up to six samples, many without any.
fn rays() -> impl Strategy<Value = Vec<Vec<f64>>> {
    prop::collection::vec(prop_oneof![Just(vec![]), prop::collection::vec(-2.0..2.0, 1..6)], 1..7)
}

fn offsets(rays: &[Vec<f64>]) -> Vec<usize> {
    let mut all = vec![0];
    rays.iter().for_each(|ray| all.push(all[all.len() - 1] + ray.len()));
    all
}

/// A cotangent of n samples that no symmetry hides.
fn cotangent(n: usize) -> Scan {
    let numbers = |from: f64| (0..n).map(|i| (from + i as f64 * 0.61).sin()).collect::<Vec<f64>>();
    Scan {
        exclusive_sum: numbers(0.1),
        inclusive_sum: numbers(1.3),
        exclusive_product: numbers(2.9),
        inclusive_product: numbers(4.2),
    }
}

fn pulled(scan: &Scan, g: &Scan) -> f64 {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    dot(&scan.exclusive_sum, &g.exclusive_sum)
        + dot(&scan.inclusive_sum, &g.inclusive_sum)
        + dot(&scan.exclusive_product, &g.exclusive_product)
        + dot(&scan.inclusive_product, &g.inclusive_product)
}

proptest! {
    #![proptest_config(properties())]

    /// Packing changes nothing: each ray's results are those that it has alone, and ids lead back to the offsets.
    #[test]
    fn a_ray_does_not_see_the_others(rays in rays()) {
        let offsets = offsets(&rays);
        let packed = scan(&rays.concat(), &offsets);
        for (ray, range) in rays.iter().zip(offsets.windows(2)) {
            let alone = scan(ray, &[0, ray.len()]);
            let part = |x: &[f64]| x[range[0]..range[1]].to_vec();
            prop_assert_eq!(part(&packed.exclusive_sum), alone.exclusive_sum);
            prop_assert_eq!(part(&packed.inclusive_sum), alone.inclusive_sum);
            prop_assert_eq!(part(&packed.exclusive_product), alone.exclusive_product);
            prop_assert_eq!(part(&packed.inclusive_product), alone.inclusive_product);
        }
        let ids: Vec<usize> = rays.iter().enumerate().flat_map(|(r, ray)| vec![r; ray.len()]).collect();
        let expected: Vec<(usize, usize)> = offsets.windows(2).map(|ray| (ray[0], ray[1] - ray[0])).collect();
        prop_assert_eq!(pack_info(&ids, rays.len()), expected);
    }

    /// The definition: a sum and a product over all pairs.
    #[test]
    fn sums_and_products_are_those_of_the_definition(x in prop::collection::vec(-2.0..2.0, 0..9)) {
        let found = scan(&x, &[0, x.len()]);
        for i in 0..x.len() {
            let near = |a: f64, b: f64| (a - b).abs() <= 1e-13 * (1.0 + b.abs());
            prop_assert!(near(found.exclusive_sum[i], x[..i].iter().sum()));
            prop_assert!(near(found.inclusive_sum[i], x[..=i].iter().sum()));
            prop_assert!(near(found.exclusive_product[i], x[..i].iter().product()));
            prop_assert!(near(found.inclusive_product[i], x[..=i].iter().product()));
        }
    }

    /// With factors of exactly 0 as often as not.
    #[test]
    fn the_gradient_is_that_of_differences(rays in rays(), zeros in prop::collection::vec(any::<bool>(), 42)) {
        let offsets = offsets(&rays);
        let x: Vec<f64> = rays.concat().iter().zip(&zeros).map(|(x, zero)| if *zero { 0.0 } else { *x }).collect();
        let g = cotangent(x.len());
        let by_hand = backward::scan(&x, &offsets, &scan(&x, &offsets), &g);
        for k in 0..x.len() {
            let moved = |s: f64| {
                let mut x = x.clone();
                x[k] += s;
                pulled(&scan(&x, &offsets), &g)
            };
            // Of each entry it is a line: differences are exact but for rounding.
            prop_assert!((by_hand[k] - slope(moved)).abs() <= 1e-9 * (1.0 + by_hand[k].abs()), "{k}");
        }
    }

    #[test]
    fn weighted_sums_are_linear_in_both(rays in rays()) {
        let (offsets, weights) = (offsets(&rays), rays.concat());
        let values: Vec<[f64; 3]> = weights.iter().map(|w| [w * w, 1.0 - w, (3.0 * w).cos()]).collect();
        let found = accumulate(&weights, &values, &offsets);
        let g: Vec<[f64; 3]> = (0..rays.len()).map(|r| [1.0, -0.5, 0.25 * r as f64]).collect();
        let (g_weights, g_values) = backward::accumulate(&weights, &values, &offsets, &g);
        let total: f64 = found.iter().zip(&g).map(|(s, g)| s[0] * g[0] + s[1] * g[1] + s[2] * g[2]).sum();
        let by_weights: f64 = weights.iter().zip(&g_weights).map(|(w, g)| w * g).sum();
        let by_values: f64 = values.iter().zip(&g_values).map(|(v, g)| v[0] * g[0] + v[1] * g[1] + v[2] * g[2]).sum();
        prop_assert!((total - by_weights).abs() < 1e-12 * (1.0 + total.abs()) * 8.0);
        prop_assert!((total - by_values).abs() < 1e-12 * (1.0 + total.abs()) * 8.0);
    }
}

/// The row VR4: alpha = [.5, 1, .3, .2], cotangent [1, 2, 3, 4] on what is let through: a division by a clamped 0 has [2, 0, 0, 0].
#[test]
fn a_factor_of_0_has_its_gradient() {
    let x = [0.5, 0.0, 0.7, 0.8];
    let zeros = vec![0.0; 4];
    let g = Scan {
        exclusive_sum: zeros.clone(),
        inclusive_sum: zeros.clone(),
        exclusive_product: zeros,
        inclusive_product: vec![1.0, 2.0, 3.0, 4.0],
    };
    let g_x = backward::scan(&x, &[0, 4], &scan(&x, &[0, 4]), &g);
    let expected = [1.0, 0.5 * (2.0 + 0.7 * (3.0 + 0.8 * 4.0)), 0.0, 0.0];
    (0..4).for_each(|k| assert!((g_x[k] - expected[k]).abs() < 1e-15, "{g_x:?}"));
}

/// First, middle and last rays without samples; no samples at all; no rays at all.
#[test]
fn empty_rays_are_rays() {
    assert_eq!(pack_info(&[1, 1, 3], 5), [(0, 0), (0, 2), (2, 0), (2, 1), (3, 0)]);
    assert_eq!(pack_info(&[], 2), [(0, 0), (0, 0)]);
    assert_eq!(pack_info(&[], 0), []);
    assert_eq!(scan(&[], &[0, 0, 0]), Scan::default());
    assert_eq!(scan(&[], &[0]), Scan::default());
    assert_eq!(accumulate(&[], &[], &[0, 0]), [[0.0; 3]]);
    let found = scan(&[3.0, 5.0], &[0, 0, 1, 1, 2, 2]);
    assert_eq!(found.inclusive_sum, [3.0, 5.0]);
    assert_eq!(found.exclusive_product, [1.0, 1.0]);
    assert_eq!(
        accumulate(&[2.0, 4.0], &[[1.0, 0.0, 0.5], [0.0, 1.0, 0.5]], &[0, 0, 1, 1, 2, 2]),
        [[0.0; 3], [2.0, 0.0, 1.0], [0.0; 3], [0.0, 4.0, 2.0], [0.0; 3]]
    );
}

/// Compensated: a thousand samples cost as much as two.
#[test]
fn long_rays_keep_their_digits() {
    let x = vec![0.1; 1000];
    let found = scan(&x, &[0, 1000]);
    assert_eq!(found.inclusive_sum[999], 100.0);
    let thin = vec![1.0 - 2f64.powi(-40); 1024];
    let expected = 1.0 - 2f64.powi(-30) + 1023.0 * 2f64.powi(-71);
    assert_eq!(scan(&thin, &[0, 1024]).inclusive_product[1023], expected);
}

#[test]
#[should_panic(expected = "never falling")]
fn offsets_that_fall_are_refused() {
    scan(&[1.0; 3], &[0, 2, 1, 3]);
}

#[test]
#[should_panic(expected = "to their number")]
fn samples_behind_the_last_ray_are_refused() {
    scan(&[1.0; 3], &[0, 2]);
}
