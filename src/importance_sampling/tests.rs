//! Closed forms and properties of importance sampling.

use proptest::prelude::*;

use super::*;
use crate::contract::testing::properties;

/// The numbers of the hard cases: what textbook code returns, and what is right.
#[test]
fn sa2_an_opaque_ray_keeps_its_faint_bins() {
    let edges: Vec<f64> = (0..=62).map(|k| 2.0 + 4.0 * f64::from(k) / 62.0).collect();
    let mut weights = vec![0.0; 62];
    weights[30] = 1.0;
    // Half-way into the first bin.
    let u = 0.5e-5 / 1.00062;
    let t = sample(&edges, &weights, 1e-5, &[u])[0];
    assert!((t - 2.0323).abs() < 1e-4, "{t}");
    // The original code's repair: a difference below 1e-5 counts as 1.
    let f = cdf(&weights, 1e-5);
    assert!(f[1] - f[0] < 1e-5);
    let snapped = edges[0] + (u - f[0]) * (edges[1] - edges[0]);
    assert!((snapped - 2.000_000_2).abs() < 2e-7, "{snapped}");
}

#[test]
fn sa3_ends_and_ties() {
    // Ten times 0.1 in f32 end at 1.0000001; here at 1, and u = 1 is the last edge.
    let edges: Vec<f64> = (0..=10).map(f64::from).collect();
    assert_eq!(sample(&edges, &[0.1; 10], 0.0, &[0.0, 1.0]), [0.0, 10.0]);
    // Nothing after the last weight, nothing before the first, even at the ends and on ties.
    let weights = [0.0, 1.0, 0.0, 0.0, 1.0, 0.0];
    assert_eq!(sample(&edges[..7], &weights, 0.0, &[0.0, 0.25, 0.5, 0.75, 1.0]), [1.0, 1.5, 4.0, 4.5, 5.0]);
    // A bin of width 0 is a single point.
    assert_eq!(sample(&[0.0, 1.0, 1.0, 2.0], &[1.0, 2.0, 1.0], 0.0, &[0.25, 0.5, 0.75]), [1.0, 1.0, 1.0]);
}

/// SA1: the repairs don't agree; each is a value of `padding`, and 0 is their limit.
#[test]
fn sa1_an_empty_ray_is_the_limit_of_any_padding() {
    let edges = [2.0, 2.25, 3.0, 5.0];
    let u = [0.0, 0.1, 0.5, 0.9, 1.0];
    for padding in [1e-300, 1e-5, 1.0] {
        let (none, some) = (sample(&edges, &[0.0; 3], 0.0, &u), sample(&edges, &[0.0; 3], padding, &u));
        none.iter().zip(some).for_each(|(a, b)| assert!((a - b).abs() < 1e-14, "{a} {b}"));
    }
    assert!(backward::sample(&edges, &[0.0; 3], 0.0, &u, &[1.0; 5]).0.iter().all(|g| g.is_finite()));
}

/// At a kink the gradient is that of the bin to the right, at 1 that of the bin to the left: one-sided differences.
#[test]
fn gradients_at_kinks_are_one_sided() {
    let (edges, weights) = ([2.0, 3.0, 4.0, 6.0], [1.0, 0.0, 1.0]);
    for (u, step) in [(0.0, 1.0), (0.5, 1.0), (1.0, -1.0)] {
        let at = |u: f64| sample(&edges, &weights, 0.0, &[u])[0];
        let h = step / 1024.0;
        let slope = backward::sample(&edges, &weights, 0.0, &[u], &[1.0]).1[0];
        assert_eq!(slope, (at(u + h) - at(u)) / h, "u = {u}");
    }
}

/// Edges move their samples by 1 - s and s; several samples of a bin add up.
#[test]
fn gradients_of_edges_by_hand() {
    let (edges, weights) = ([2.0, 3.0, 5.0], [1.0, 3.0]);
    // F is 0, 1/4, 1: s = 1/2 in the first bin; 1/4 and 3/4 in the second.
    let u = [0.125, 0.4375, 0.8125];
    assert_eq!(sample(&edges, &weights, 0.0, &u), [2.5, 3.5, 4.5]);
    let (g_edges, g_u) = backward::sample(&edges, &weights, 0.0, &u, &[1.0, -2.0, 8.0]);
    assert_eq!(g_edges, [0.5, 0.5 - 1.5 + 2.0, -0.5 + 6.0]);
    // (e_{k+1} - e_k) / (F_{k+1} - F_k): 1 / (1/4) and 2 / (3/4).
    assert_eq!(g_u, [4.0, -4.0 / 0.75, 16.0 / 0.75]);
}

/// Bins of shares 1/2, 2^-20 and the rest, by hand: in the middle one s = u - F, its share counting as 1; in the others it is as always.
#[test]
fn faint_bins_are_snapped_by_hand() {
    let faint = 2f64.powi(-20);
    let edges = [2.0, 3.0, 5.0, 9.0];
    let weights = [0.5 / faint, 1.0, 0.5 / faint - 1.0];
    let u = [0.25, 0.5 + faint / 2.0, 0.75];
    let s = (0.25 - faint) / (0.5 - faint);
    assert_eq!(sample_snapped(&edges, &weights, 0.0, &u, 1.0), [2.5, 3.0 + faint, 5.0 + 4.0 * s]);
    let (g_edges, g_u) = backward::sample_snapped(&edges, &weights, 0.0, &u, &[1.0, 4.0, 8.0], 1.0);
    assert_eq!(g_edges, [0.5, 0.5 + 4.0 * (1.0 - faint / 2.0), 2.0 * faint + 8.0 * (1.0 - s), 8.0 * s]);
    assert_eq!(g_u, [2.0, 8.0, 32.0 / (0.5 - faint)]);
    // A share of exactly 1e-5 isn't faint.
    let weights = [SNAPPED, 1.0 - SNAPPED];
    assert_eq!(sample_snapped(&edges[..3], &weights, 0.0, &[0.5 * SNAPPED], 1.0), [2.5]);
    let g_u = backward::sample_snapped(&edges[..3], &weights, 0.0, &[0.5 * SNAPPED], &[1.0], 1.0).1;
    assert_eq!(g_u, [1.0 / SNAPPED]);
}

/// A share of 2^-20 that counts as 1e-5: s = (u - F) / 1e-5 in its bin.
#[test]
fn faint_shares_are_at_least_that_by_hand() {
    let share = 2f64.powi(-20);
    let (edges, weights) = ([2.0, 3.0, 5.0], [1.0 - share, share]);
    let u = [0.5, 1.0 - share / 2.0];
    let s = share / 2.0 / SNAPPED;
    assert_eq!(
        sample_snapped(&edges, &weights, 0.0, &u, SNAPPED),
        [2.0 + 0.5 / (1.0 - share), 3.0 + s * 2.0]
    );
    let (g_edges, g_u) = backward::sample_snapped(&edges, &weights, 0.0, &u, &[0.0, 1.0], SNAPPED);
    assert_eq!(g_edges, [0.0, 1.0 - s, s]);
    assert_eq!(g_u, [0.0, 2.0 / SNAPPED]);
}

fn rays() -> impl Strategy<Value = (Vec<f64>, Vec<f64>)> {
    let weight = prop_oneof![Just(0.0), 0.01..1.0f64];
    prop::collection::vec((0.01..1.0f64, weight), 1..40).prop_map(|bins| {
        let mut edges = vec![2.0];
        bins.iter().for_each(|(width, _)| edges.push(edges[edges.len() - 1] + width));
        (edges, bins.iter().map(|(_, w)| *w).collect())
    })
}

proptest! {
    #![proptest_config(properties())]

    /// F(F^-1(u)) = u, samples ascend with u, and none lies inside a bin without weight.
    #[test]
    fn the_inverse_is_one((edges, weights) in rays(), u in prop::collection::vec(0.0..=1.0f64, 1..20)) {
        let mut u = u;
        u.sort_by(f64::total_cmp);
        let f = cdf(&weights, 0.0);
        let t = sample(&edges, &weights, 0.0, &u);
        for (i, &t_i) in t.iter().enumerate() {
            prop_assert!(i == 0 || t[i - 1] <= t_i);
            prop_assert!(edges[0] <= t_i && t_i <= edges[edges.len() - 1] * (1.0 + 1e-15));
            let k = (0..weights.len()).rfind(|&k| edges[k] <= t_i).unwrap();
            let back = f[k] + (t_i - edges[k]) / (edges[k + 1] - edges[k]) * (f[k + 1] - f[k]);
            // t is rounded to 2^-50, and F is at most 100 (a weight of 1 in a bin of 0.01) times as steep.
            prop_assert!((back - u[i]).abs() < 1e-12, "{back} {}", u[i]);
            let empty = weights[k] == 0.0 && weights.iter().any(|&w| w > 0.0);
            prop_assert!(!empty || t_i - edges[k] < 1e-12, "{t_i} inside an empty bin");
        }
    }

    /// Only the weights' ratios count.
    #[test]
    fn scale_of_the_weights_is_nothing((edges, weights) in rays(), u in 0.0..=1.0f64) {
        let scaled: Vec<f64> = weights.iter().map(|w| 1024.0 * w).collect();
        prop_assert_eq!(sample(&edges, &weights, 0.0, &[u]), sample(&edges, &scaled, 0.0, &[u]));
    }

    #[test]
    fn a_union_is_sorted_and_keeps_all(a in prop::collection::vec(0.0..1.0f64, 0..9), b in prop::collection::vec(0.0..1.0f64, 0..9)) {
        let both = union(&a, &b);
        prop_assert!(both.len() == a.len() + b.len() && both.is_sorted());
        prop_assert!(a.iter().chain(&b).all(|t| both.contains(t)));
    }
}
