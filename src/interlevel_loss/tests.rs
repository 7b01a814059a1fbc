//! What a bound costs, how it grows, edges by hand, and slopes.

use proptest::prelude::*;

use super::{Form, Histogram, backward, interlevel, outer};
use crate::contract::testing::{properties, slope};
use crate::convention::{LossReduction, OuterEdges};

const FORM: Form = Form { eps: 1e-7, edges: OuterEdges::Touching, reduction: LossReduction::Mean };
const EDGES: [OuterEdges; 2] = [OuterEdges::Touching, OuterEdges::Inside];

/// Weights and edges from 0 to 1.
fn histogram() -> impl Strategy<Value = (Vec<f64>, Vec<f64>)> {
    prop::collection::vec((0.05..1.0, 0.1..1.0), 1..7).prop_map(|intervals| {
        let total: f64 = intervals.iter().map(|(_, length)| length).sum();
        let mut t = vec![0.0];
        intervals.iter().for_each(|(_, length)| t.push(t[t.len() - 1] + length / total));
        *t.last_mut().unwrap() = 1.0;
        (intervals.iter().map(|(w, _)| *w).collect(), t)
    })
}

fn of<'a>((weights, t): &'a (Vec<f64>, Vec<f64>)) -> Histogram<'a> {
    Histogram { weights, t }
}

proptest! {
    #![proptest_config(properties())]

    /// A histogram that both are made of costs nothing: the proposal of merged intervals is a bound.
    #[test]
    fn what_a_merged_histogram_has_is_covered(fine in histogram(), cut in 0..6usize) {
        let cut = cut.min(fine.0.len() - 1);
        let merged = (vec![fine.0[..=cut].iter().sum(), fine.0[cut + 1..].iter().sum()], vec![0.0, fine.1[cut + 1], 1.0]);
        for edges in EDGES {
            prop_assert_eq!(interlevel(of(&fine), of(&merged), Form { edges, ..FORM }), 0.0);
            let g = backward::interlevel(of(&fine), of(&merged), Form { edges, ..FORM }, 1.0);
            prop_assert!(g.iter().all(|&g| g == 0.0));
        }
    }

    /// The bound is at least the share of the proposal in the interval, at most all of it, and grows with the proposal; without one all
    /// is missing.
    #[test]
    fn it_is_a_bound(fine in histogram(), proposal in histogram()) {
        for i in 0..fine.0.len() {
            let mut share = 0.0;
            for (j, v) in proposal.0.iter().enumerate() {
                let inside = fine.1[i + 1].min(proposal.1[j + 1]) - fine.1[i].max(proposal.1[j]);
                share += v * inside.max(0.0) / (proposal.1[j + 1] - proposal.1[j]);
            }
            for edges in EDGES {
                let bound = outer(&fine.1, i, of(&proposal), edges);
                prop_assert!(share <= bound + 1e-12 && bound <= proposal.0.iter().sum::<f64>() + 1e-12);
            }
        }
        let nothing = (vec![0.0; proposal.0.len()], proposal.1.clone());
        let all: f64 = fine.0.iter().map(|w| w * w / (w + FORM.eps)).sum();
        prop_assert!((interlevel(of(&fine), of(&nothing), FORM) - all / fine.0.len() as f64).abs() < 1e-14);
        let less = interlevel(of(&fine), of(&(proposal.0.iter().map(|v| 2.0 * v).collect(), proposal.1.clone())), FORM);
        prop_assert!(less <= interlevel(of(&fine), of(&proposal), FORM));
        let sum = interlevel(of(&fine), of(&proposal), Form { reduction: LossReduction::Sum, ..FORM });
        prop_assert_eq!(sum / fine.0.len() as f64, interlevel(of(&fine), of(&proposal), FORM));
    }

    #[test]
    fn the_gradient_is_that_of_differences(fine in histogram(), proposal in histogram(), g in -2.0..2.0) {
        let proposal = (proposal.0.iter().map(|v| 0.3 * v).collect::<Vec<_>>(), proposal.1);
        for reduction in [LossReduction::Mean, LossReduction::Sum] {
            let form = Form { eps: 0.01, reduction, ..FORM };
            let by_hand = backward::interlevel(of(&fine), of(&proposal), form, g);
            for (j, by_hand) in by_hand.iter().enumerate() {
                let expected = slope(|step| {
                    let mut v = proposal.0.clone();
                    // Small steps: what is missing may become 0, where the second derivative has a kink.
                    v[j] += step / 1024.0;
                    1024.0 * g * interlevel(of(&fine), Histogram { weights: &v, t: &proposal.1 }, form)
                });
                prop_assert!((by_hand - expected).abs() < 1e-4 * (1.0 + by_hand.abs()), "{j}: {by_hand} {expected}");
            }
        }
    }
}

/// On edges in common: the interval behind touches, the one in front doesn't; or neither.
#[test]
fn edges_by_hand() {
    let t = [0.0, 0.25, 0.5, 1.0];
    let proposal = Histogram { weights: &[1.0, 10.0, 100.0], t: &t };
    let bounds = |edges| [0, 1, 2].map(|i| outer(&t, i, proposal, edges));
    assert_eq!(bounds(OuterEdges::Touching), [11.0, 110.0, 100.0]);
    assert_eq!(bounds(OuterEdges::Inside), [1.0, 10.0, 100.0]);
    // An interval without length sees what its place is in; on an edge, what begins there, or nothing.
    let point = |at: f64, edges| outer(&[at, at], 0, proposal, edges);
    assert_eq!(EDGES.map(|edges| point(0.375, edges)), [10.0, 10.0]);
    assert_eq!(EDGES.map(|edges| point(0.25, edges)), [10.0, 0.0]);
    // One of the proposal without length counts for the interval that it is in, and for the one that ends there.
    let thin = Histogram { weights: &[1.0, 10.0, 100.0], t: &[0.0, 0.5, 0.5, 1.0] };
    assert_eq!(EDGES.map(|edges| outer(&[0.25, 0.75], 0, thin, edges)), [111.0, 111.0]);
    assert_eq!(EDGES.map(|edges| outer(&[0.0, 0.5], 0, thin, edges)), [111.0, 1.0]);
    assert_eq!(EDGES.map(|edges| outer(&[0.5, 1.0], 0, thin, edges)), [100.0, 100.0]);
}

/// By hand: what is missing, squared, over the weight with eps; and an interval without weight costs nothing, whatever eps is.
#[test]
fn eps_keeps_empty_intervals_finite() {
    let (t, eps) = ([0.0, 0.5, 1.0], 0.25);
    let fine = Histogram { weights: &[0.75, 0.0], t: &t };
    let proposal = Histogram { weights: &[0.25], t: &[0.0, 1.0] };
    let form = Form { eps, reduction: LossReduction::Sum, ..FORM };
    assert_eq!(interlevel(fine, proposal, form), 0.25);
    assert_eq!(backward::interlevel(fine, proposal, form, 1.0), [-1.0]);
    assert_eq!(interlevel(fine, Histogram { weights: &[0.0], ..proposal }, Form { eps: 0.0, ..form }), 0.75);
    assert_eq!(
        backward::interlevel(fine, Histogram { weights: &[0.0], ..proposal }, Form { eps: 0.0, ..form }, 1.0),
        [-2.0]
    );
}

/// An edge too few or too many is no histogram.
#[test]
fn edges_are_one_more_than_weights() {
    let right = Histogram { weights: &[0.5], t: &[0.0, 1.0] };
    for t in [&[0.0][..], &[0.0, 0.5, 1.0]] {
        let wrong = Histogram { weights: &[0.5], t };
        for (fine, proposal) in [(wrong, right), (right, wrong)] {
            let refuses = |f: &dyn Fn()| std::panic::catch_unwind(std::panic::AssertUnwindSafe(f)).is_err();
            assert!(refuses(&|| {
                interlevel(fine, proposal, FORM);
            }));
            assert!(refuses(&|| {
                backward::interlevel(fine, proposal, FORM, 1.0);
            }));
        }
    }
}
