//! The distortion loss, wrong on purpose. Without a mistake every function equals the oracle.

pub(crate) mod laws;

use super::arrays::{forward, vjp};
use super::{backward, distortion as oracle};
use crate::contract::arrays::Arrays;
use crate::contract::component::Mistake;
use crate::convention::Conventions;

/// Mistakes of the distortion loss.
pub(crate) const DISTORTION_LOSS: &[Mistake] = &[
    Mistake::new(
        "pairs_once",
        "sum_{i<j}: each pair in one order alone",
        "surfaces that should merge pull at one another half as much as intervals shrink",
        "twice sum_{i<j}, or all i and j",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "own_forgotten",
        "the pairs alone, without 1/3 sum w^2 delta",
        "nothing makes an interval that has all the weight shorter",
        "plus sum w_i^2 delta_i / 3",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "third_forgotten",
        "sum w^2 delta, without 1/3",
        "intervals shrink three times too much",
        "a third: the mean distance of two points of an interval",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "own_weight_once",
        "1/3 sum w delta, the weight not squared",
        "a length that every ray pays for its weight, wherever it lies",
        "w^2: both points are drawn by weight",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "edges_for_middles",
        "t_i for m_i: the interval's beginning",
        "distances between intervals of different lengths are off by half of the difference",
        "(t_i + t_{i+1}) / 2",
        "codes whose samples are edges and middles at once",
        0,
    ),
    Mistake::new(
        "signs_kept",
        "m_i - m_j for |m_i - m_j|",
        "the pairs cancel: a loss of almost 0 whatever the weights",
        "the absolute value",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "mean_of_intervals",
        "the mean over intervals in the place of their sum",
        "a loss N times too small, and smaller the finer a ray is sampled",
        "sums over intervals, a mean over rays alone",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "other_weight_held",
        "the gradient of w_i as if w_j were constant: sum_j w_j |m_i - m_j|, without the 2",
        "weights move half as fast as their intervals",
        "each weight counts as i and as j",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "own_gradient_dropped",
        "gradients of the pairs alone",
        "nothing makes an interval that has all the weight shorter",
        "and 2/3 w delta for the weight, w^2 / 3 for the length",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "middle_to_one_edge",
        "a middle's gradient to its first edge alone",
        "edges move unevenly",
        "half of it to each edge",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "far_edges_for_middles",
        "|t_{i+1} - t_{j+1}| for the distance of intervals",
        "uneven intervals are pulled the wrong way",
        "the middles (t_i + t_{i+1}) / 2",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "edges_normalized",
        "edges mapped to [0, 1] inside, as if they weren't yet",
        "a loss that is too small by the rays' length; rays of other lengths count otherwise",
        "edges as they are handed over",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "weights_made_shares",
        "weights divided by their sum",
        "thin fog is pulled together as strongly as a surface",
        "weights as they are",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "mean_of_pairs",
        "the mean over pairs, and the sum of the own terms",
        "pairs hardly count beside the own terms",
        "both sums",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "neighbors_alone",
        "pairs of neighbors alone",
        "two surfaces far from each other aren't pulled together",
        "all pairs",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "own_width_one_over_n",
        "1 / N for the width of each interval, in the own terms alone",
        "uneven intervals are pulled together by other amounts than their widths",
        "t_{i+1} - t_i of each",
        "eff_distloss(w, m, 1 / N) in copies of DVGO's training loop",
        4,
    ),
    Mistake::new(
        "variance_for_pairs",
        "sum w_i (m_i - sum w m)^2, the variance of the distance",
        "outliers rule; another loss",
        "|m_i - m_j| over all pairs",
        "never; cheap to keep",
        0,
    ),
];

/// The loss of one ray.
fn wrong_loss(weights: &[f64], t: &[f64], wrong: &[&str]) -> f64 {
    let has = |name: &str| wrong.contains(&name);
    let (mut pairs, mut own, n) = (0.0, 0.0, weights.len());
    let (mut weights, mut t) = (weights.to_vec(), t.to_vec());
    if has("edges_normalized") {
        let (first, length) = (t[0], t[n] - t[0]);
        t.iter_mut().for_each(|t| *t = (*t - first) / length);
    }
    if has("weights_made_shares") {
        let total: f64 = weights.iter().sum();
        weights.iter_mut().for_each(|w| *w /= total + 1e-8);
    }
    let place = |i: usize| match () {
        () if has("edges_for_middles") => t[i],
        () if has("far_edges_for_middles") => t[i + 1],
        () => 0.5 * (t[i] + t[i + 1]),
    };
    if has("variance_for_pairs") {
        let mean: f64 = (0..n).map(|i| weights[i] * place(i)).sum();
        return (0..n).map(|i| weights[i] * (place(i) - mean) * (place(i) - mean)).sum();
    }
    for i in 0..n {
        for j in (0..n).filter(|j| !has("neighbors_alone") || i.abs_diff(*j) == 1) {
            let apart = place(i) - place(j);
            pairs += weights[i] * weights[j] * if has("signs_kept") { apart } else { apart.abs() };
        }
        let weight = if has("own_weight_once") { weights[i] } else { weights[i] * weights[i] };
        own += weight * if has("own_width_one_over_n") { 1.0 / n as f64 } else { t[i + 1] - t[i] };
    }
    let pairs = match () {
        () if has("pairs_once") => pairs / 2.0,
        () if has("mean_of_pairs") => pairs / (n * n) as f64,
        () => pairs,
    };
    let own = match () {
        () if has("own_forgotten") => 0.0,
        () if has("third_forgotten") => own,
        () => own / 3.0,
    };
    (pairs + own) / if has("mean_of_intervals") { n as f64 } else { 1.0 }
}

/// The loss.
pub(crate) fn distortion(a: &Arrays, _: &Conventions, wrong: &[&str]) -> Arrays {
    forward(a, |weights, t| if wrong.is_empty() { oracle(weights, t) } else { wrong_loss(weights, t, wrong) })
}

/// What the terms of single intervals pass to weights and edges.
fn own_gradient(weights: &[f64], t: &[f64], g: f64) -> (Vec<f64>, Vec<f64>) {
    let (mut g_weights, mut g_t) = (vec![], vec![0.0; t.len()]);
    for (i, w) in weights.iter().enumerate() {
        g_weights.push(g * 2.0 / 3.0 * w * (t[i + 1] - t[i]));
        g_t[i] -= g * w * w / 3.0;
        g_t[i + 1] += g * w * w / 3.0;
    }
    (g_weights, g_t)
}

/// Its gradients.
pub(crate) fn distortion_vjp(a: &Arrays, _: &Conventions, wrong: &[&str]) -> Arrays {
    vjp(a, |weights, t, g| {
        let (mut g_weights, mut g_t) = backward::distortion(weights, t, g);
        let own = own_gradient(weights, t, g);
        match wrong.first() {
            Some(&"other_weight_held") => {
                g_weights.iter_mut().zip(&own.0).for_each(|(g, own)| *g = (*g - own) / 2.0 + own);
            }
            Some(&"own_gradient_dropped") => {
                g_weights.iter_mut().zip(&own.0).for_each(|(g, own)| *g -= own);
                g_t.iter_mut().zip(&own.1).for_each(|(g, own)| *g -= own);
            }
            Some(&"middle_to_one_edge") => {
                g_t = own.1;
                for (i, wi) in weights.iter().enumerate() {
                    for (j, wj) in weights.iter().enumerate() {
                        let apart = (t[i] + t[i + 1]) - (t[j] + t[j + 1]);
                        g_t[i] += if apart == 0.0 { 0.0 } else { 2.0 * g * wi * wj * apart.signum() };
                    }
                }
            }
            _ => {}
        }
        (g_weights, g_t)
    })
}
