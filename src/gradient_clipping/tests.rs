//! Lengths and directions of what is left, and where nothing happens.

use proptest::prelude::*;

use super::*;
use crate::contract::testing::properties;

const EPS: [ClipEps; 5] = [
    ClipEps::None,
    ClipEps::TenToMinusEight,
    ClipEps::TenToMinusSeven,
    ClipEps::Float32,
    ClipEps::TenToMinusSix,
];

fn length(numbers: &[f64]) -> f64 {
    numbers.iter().map(|g| g * g).sum::<f64>().sqrt()
}

proptest! {
    #![proptest_config(properties())]

    /// No longer than the limit, in the same direction, and the same numbers where they were short enough.
    #[test]
    fn what_is_left_is_short_enough(
        weights in prop::collection::vec(-4.0..4.0f64, 1..8),
        bias in prop::collection::vec(-4.0..4.0f64, 0..4),
        most in 0.1..20.0f64,
    ) {
        for eps in EPS {
            let (clipped, norm) = clip_by_global_norm(&[&weights, &bias], most, eps);
            prop_assert_eq!([clipped[0].len(), clipped[1].len()], [weights.len(), bias.len()]);
            let (before, after) = ([&weights[..], &bias].concat(), clipped.concat());
            prop_assert!((norm - length(&before)).abs() <= 1e-14 * norm);
            prop_assert!(length(&after) <= most * (1.0 + 1e-14));
            let scale = (most / (norm + eps.value())).min(1.0);
            for (g, left) in before.iter().zip(&after) {
                prop_assert!((left - scale * g).abs() <= 1e-15 * g.abs());
            }
            if norm + eps.value() <= most {
                prop_assert_eq!(before, after);
            }
        }
    }

    /// The tensors' borders don't matter.
    #[test]
    fn tensors_are_clipped_together(all in prop::collection::vec(-4.0..4.0f64, 2..9), at in 0usize..9, most in 0.1..5.0f64) {
        let (first, second) = all.split_at(at.min(all.len()));
        let (apart, norm) = clip_by_global_norm(&[first, second], most, ClipEps::None);
        let (whole, of_all) = clip_by_global_norm(&[&all], most, ClipEps::None);
        prop_assert_eq!((apart.concat(), norm), (whole.concat(), of_all));
    }

    #[test]
    fn a_limit_is_odd_and_keeps_what_is_inside(g in -3.0..3.0f64, limit in 0.1..2.0f64) {
        let clipped = clip_by_value(g, limit);
        prop_assert_eq!(clipped, -clip_by_value(-g, limit));
        prop_assert_eq!(clipped, if g.abs() <= limit { g } else { limit * g.signum() });
        prop_assert_eq!(clipped, clip_by_value(clipped, limit));
    }
}

#[test]
fn no_gradient_is_none_after_all() {
    for eps in EPS {
        assert_eq!(clip_by_global_norm(&[&[0.0; 3], &[]], 1.0, eps), (vec![vec![0.0; 3], vec![]], 0.0));
    }
}

/// What is added to the norm shortens what has the length of the limit, or nearly.
#[test]
fn a_norm_of_the_limit_is_shortened_by_what_is_added() {
    let left = |eps| clip_by_global_norm(&[&[3.0], &[4.0]], 5.0, eps).0;
    assert_eq!(left(ClipEps::None), [[3.0], [4.0]]);
    assert_eq!(left(ClipEps::TenToMinusSix), [[3.0 * (5.0 / 5.000001)], [4.0 * (5.0 / 5.000001)]]);
}

#[test]
fn what_is_no_number_stays_none() {
    assert!(clip_by_value(f64::NAN, 1.0).is_nan());
}
