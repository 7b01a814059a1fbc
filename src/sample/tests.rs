use proptest::prelude::*;

use super::*;
use crate::contract::testing::properties;

const GRIDS: [Grid; 4] =
    [Grid::Intervals, Grid::EndsPlusWidth, Grid::EndsPlusSpacing, Grid::EndsBetweenMidpoints];

#[test]
fn grids_by_hand() {
    // near 2, far 6, four samples: D = 1, S = 4/3.
    let t = |u, grid| sample_along_ray(2.0, 6.0, &[u; 4], grid);
    let close = |t: Vec<f64>, expected: [f64; 4]| {
        assert!(t.iter().zip(expected).all(|(t, e)| (t - e).abs() < 1e-15 * 8.0), "{t:?}, not {expected:?}");
    };
    let s = 4.0 / 3.0;
    assert_eq!(t(0.0, Grid::Intervals), [2.0, 3.0, 4.0, 5.0]);
    assert_eq!(t(1.0, Grid::Intervals), [3.0, 4.0, 5.0, 6.0]);
    close(t(0.0, Grid::EndsPlusWidth), [2.0, 2.0 + s, 2.0 + 2.0 * s, 6.0]);
    close(t(0.5, Grid::EndsPlusWidth), [2.5, 2.5 + s, 2.5 + 2.0 * s, 6.5]);
    close(t(0.5, Grid::EndsPlusSpacing), [2.0 + 0.5 * s, 2.0 + 1.5 * s, 2.0 + 2.5 * s, 6.0 + 0.5 * s]);
    // bmild/nerf: bins between midpoints, half as wide at both ends.
    close(t(0.0, Grid::EndsBetweenMidpoints), [2.0, 2.0 + 0.5 * s, 2.0 + 1.5 * s, 2.0 + 2.5 * s]);
    close(t(1.0, Grid::EndsBetweenMidpoints), [2.0 + 0.5 * s, 2.0 + 1.5 * s, 2.0 + 2.5 * s, 6.0]);
    assert_eq!([Rest::Left, Rest::Mid, Rest::Right].map(rest_u), [0.0, 0.5, 1.0]);
}

#[test]
fn vr9_no_sample_and_one_sample() {
    for grid in GRIDS {
        assert!(sample_along_ray(2.0, 6.0, &[], grid).is_empty());
        let expected = if matches!(grid, Grid::Intervals | Grid::EndsPlusWidth) { 4.0 } else { 2.0 };
        assert_eq!(sample_along_ray(2.0, 6.0, &[0.5], grid), [expected]);
    }
    for last in [LastDelta::Width, LastDelta::Repeated, LastDelta::Mean] {
        assert!(step_sizes(&[], 2.0, 6.0, Delta::Differences, last).is_empty());
        assert_eq!(step_sizes(&[3.0], 2.0, 6.0, Delta::Differences, last), [4.0]);
    }
    assert!(step_sizes(&[], 2.0, 6.0, Delta::Width, LastDelta::Width).is_empty());
}

#[test]
fn last_steps_by_convention() {
    let t = [2.0, 2.5, 4.0, 5.0];
    let last = |last| step_sizes(&t, 2.0, 7.0, Delta::Differences, last);
    for (convention, expected) in [
        (LastDelta::Width, 1.25),
        (LastDelta::Repeated, 1.0),
        (LastDelta::Mean, 1.0),
        (LastDelta::TenToTen, 1e10),
        (LastDelta::TenToNine, 1e9),
        (LastDelta::Thousandth, 1e-3),
        (LastDelta::ToFar, 2.0),
    ] {
        assert_eq!(last(convention), [0.5, 1.5, 1.0, expected], "{convention:?}");
    }
    assert_eq!(step_sizes(&[2.0, 2.5, 4.5], 2.0, 7.0, Delta::Differences, LastDelta::Mean)[2], 1.25);
    assert_eq!(step_sizes(&t, 2.0, 7.0, Delta::Width, LastDelta::ToFar), [1.25; 4]);
}

/// Cells meet in the middle between two samples, and fill [near, far].
#[test]
fn cells_between_middles() {
    let cells = |t: &[f64]| step_sizes(t, 1.5, 7.0, Delta::Midpoints, LastDelta::Width);
    assert_eq!(cells(&[2.0, 2.5, 4.0, 5.0]), [0.75, 1.0, 1.25, 2.5]);
    assert_eq!(cells(&[3.0]), [5.5]);
}

/// Whole gaps at both ends, half of both gaps between them, as `numpy.gradient([2, 2.5, 4, 5])` has them.
#[test]
fn central_steps() {
    let cells = |t: &[f64]| step_sizes(t, 1.5, 7.0, Delta::Central, LastDelta::Width);
    assert_eq!(cells(&[2.0, 2.5, 4.0, 5.0]), [0.5, 1.0, 1.25, 1.0]);
    assert_eq!(cells(&[2.0, 5.0]), [3.0, 3.0]);
    assert_eq!(cells(&[3.0]), [5.5]);
}

proptest! {
    #![proptest_config(properties())]

    #[test]
    fn samples_are_sorted_and_inside_their_interval(
        near in 0.0..5.0f64, length in 0.01..10.0f64, u in prop::collection::vec(0.0..1.0, 1..70),
    ) {
        let (n, far) = (u.len(), near + length);
        for grid in [Grid::Intervals, Grid::EndsPlusSpacing, Grid::EndsBetweenMidpoints] {
            let t = sample_along_ray(near, far, &u, grid);
            let (left, right) = (vec![0.0; n], vec![1.0; n]);
            let (left, right) = (sample_along_ray(near, far, &left, grid), sample_along_ray(near, far, &right, grid));
            for i in 0..n {
                prop_assert!(left[i] <= t[i] && t[i] <= right[i], "{grid:?}");
                prop_assert!(i == 0 || (t[i - 1] <= t[i] && (right[i - 1] - left[i]).abs() < 1e-14 * far));
            }
            prop_assert_eq!(left[0], near);
            if grid != Grid::EndsPlusSpacing && n > 1 {
                prop_assert!((right[n - 1] - far).abs() <= 4.0 * f64::EPSILON * far);
            }
        }
    }

    #[test]
    fn steps_add_up_to_the_way(near in 0.0..5.0f64, length in 0.01..10.0f64, u in prop::collection::vec(0.0..1.0, 1..70)) {
        let far = near + length;
        let t = sample_along_ray(near, far, &u, Grid::Intervals);
        let total: f64 = step_sizes(&t, near, far, Delta::Width, LastDelta::Width).iter().sum();
        prop_assert!((total - length).abs() < 1e-14 * far * u.len() as f64);
        let deltas = step_sizes(&t, near, far, Delta::Differences, LastDelta::ToFar);
        prop_assert!(deltas.iter().all(|&delta| delta >= -1e-14));
        prop_assert!((deltas.iter().sum::<f64>() - (far - t[0])).abs() < 1e-14 * far * u.len() as f64);
    }
}
