//! Moments by quadrature, what scales and turns with the ray, thin intervals, and slopes.

use proptest::prelude::*;

use super::{Frustum, Gaussian, backward, conical_frustum, moments};
use crate::contract::testing::{properties, slope};
use crate::convention::RayShape::{self, Cone, Cylinder};

fn frustum() -> impl Strategy<Value = Frustum> {
    let three = || prop::array::uniform3(-2.0..2.0f64);
    let parts = (three(), three(), 0.01..1.0f64, 0.0..4.0f64, 0.01..2.0f64);
    let far = parts.prop_filter("a direction", |(_, d, ..)| d.iter().map(|x| x * x).sum::<f64>() > 0.1);
    far.prop_map(|(origin, direction, radius, start, length)| Frustum {
        origin,
        direction,
        radius,
        start,
        end: start + length,
    })
}

/// By Gauss's three points, which are exact to the fifth degree, about the middle: a cone's disk at t weighs t^2, and has the variance
/// (r t)^2 / 4 on each line.
fn by_quadrature(start: f64, end: f64) -> (f64, f64, f64) {
    let (middle, half) = (0.5 * (start + end), 0.5 * (end - start));
    let nodes = [(-f64::sqrt(0.6), 5.0), (0.0, 8.0), (f64::sqrt(0.6), 5.0)];
    let mean_of = |f: &dyn Fn(f64) -> f64| {
        let weigh = |&(x, w): &(f64, f64)| w * (middle + half * x) * (middle + half * x);
        let sum: f64 = nodes.iter().map(|node| weigh(node) * f(half * node.0)).sum();
        sum / nodes.iter().map(weigh).sum::<f64>()
    };
    let shift = mean_of(&|x| x);
    let along = mean_of(&|x| (x - shift) * (x - shift));
    (middle + shift, along, mean_of(&|x| (middle + x) * (middle + x) / 4.0))
}

/// The closed forms that one integrates to, in powers of the ends.
fn by_powers(start: f64, end: f64) -> (f64, f64, f64) {
    // Products: `powi` rounds as the compiler likes.
    let product = |x: f64, n: usize| (1..n).fold(x, |y, _| y * x);
    let power = |n| product(end, n) - product(start, n);
    let mean = 3.0 * power(4) / (4.0 * power(3));
    (mean, 3.0 / 5.0 * power(5) / power(3) - mean * mean, 3.0 / 20.0 * power(5) / power(3))
}

fn near(a: f64, b: f64, relative: f64) -> bool {
    (a - b).abs() <= relative * b.abs()
}

proptest! {
    #![proptest_config(properties())]

    #[test]
    fn moments_are_those_of_the_volume(start in 0.0..10.0f64, length in -12.0..3.0f64) {
        let end = start + f64::powf(10.0, length);
        let (found, expected) = (moments(start, end, Cone), by_quadrature(start, end));
        prop_assert!(near(found.0, expected.0, 1e-15 * 8.0), "{found:?} {expected:?}");
        prop_assert!(near(found.1, expected.1, 1e-14), "{found:?} {expected:?}");
        prop_assert!(near(found.2, expected.2, 1e-14), "{found:?} {expected:?}");
    }

    /// The trace doesn't see where the ray looks.
    #[test]
    fn variances_add_up(f in frustum()) {
        let length: f64 = f.direction.iter().map(|x| x * x).sum();
        for shape in [Cone, Cylinder] {
            let g = conical_frustum(&f, shape);
            let sum: f64 = g.variance.iter().sum();
            prop_assert!(near(sum, g.t_variance * length + 2.0 * g.r_variance, 1e-14));
            prop_assert!(g.variance.iter().all(|v| *v > 0.0));
        }
    }

    /// The same cone with a direction twice as long, and half the t.
    #[test]
    fn the_length_of_the_direction_is_a_unit(f in frustum()) {
        let longer = Frustum {
            direction: f.direction.map(|x| 2.0 * x),
            radius: 2.0 * f.radius,
            start: 0.5 * f.start,
            end: 0.5 * f.end,
            ..f
        };
        let (g, again) = (conical_frustum(&f, Cone), conical_frustum(&longer, Cone));
        prop_assert_eq!((g.mean, g.variance, g.r_variance), (again.mean, again.variance, again.r_variance));
        prop_assert_eq!((g.t_mean, g.t_variance), (2.0 * again.t_mean, 4.0 * again.t_variance));
    }

    #[test]
    fn gradients_are_those_of_differences(f in frustum(), w in prop::array::uniform9(-1.0..1.0f64)) {
        let g = Gaussian {
            t_mean: w[0],
            t_variance: w[1],
            r_variance: w[2],
            mean: [w[3], w[4], w[5]],
            variance: [w[6], w[7], w[8]],
        };
        for shape in [Cone, Cylinder] {
            let found = backward::conical_frustum(&f, shape, &g);
            let check = |by_hand: f64, moved: &dyn Fn(f64) -> Frustum| {
                let expected = slope(|step| inner(&conical_frustum(&moved(step), shape), &g));
                let allowed = 1e-7 * (1.0 + by_hand.abs());
                prop_assert!((by_hand - expected).abs() < allowed, "{by_hand} {expected} of {f:?}");
                Ok(())
            };
            for j in 0..3 {
                check(found.origin[j], &|x| Frustum { origin: plus(f.origin, j, x), ..f })?;
                check(found.direction[j], &|x| Frustum { direction: plus(f.direction, j, x), ..f })?;
            }
            check(found.radius, &|x| Frustum { radius: f.radius + x, ..f })?;
            if f.end > 0.1 {
                check(found.start, &|x| Frustum { start: f.start + x, ..f })?;
                check(found.end, &|x| Frustum { end: f.end + x, ..f })?;
            }
        }
    }
}

fn plus(mut x: [f64; 3], j: usize, step: f64) -> [f64; 3] {
    x[j] += step;
    x
}

fn inner(a: &Gaussian, g: &Gaussian) -> f64 {
    let vectors: f64 = (0..3).map(|i| a.mean[i] * g.mean[i] + a.variance[i] * g.variance[i]).sum();
    a.t_mean * g.t_mean + a.t_variance * g.t_variance + a.r_variance * g.r_variance + vectors
}

/// At [2, 2 + 1e-5] powers of the ends are several times off in f64, and ours aren't.
#[test]
fn pe5_powers_of_the_ends_have_no_digit_left() {
    let (start, end) = (2.0, 2.0 + 1e-5);
    let (found, expected) = (moments(start, end, Cone), by_quadrature(start, end));
    assert!(near(found.1, expected.1, 1e-14) && near(found.0, expected.0, 1e-15));
    let off = by_powers(start, end).1 / expected.1;
    assert!(!(0.5..2.0).contains(&off), "{off}");
    // On long intervals they are the same moments.
    let (long, powers) = (moments(1.0, 3.0, Cone), by_powers(1.0, 3.0));
    assert!(near(powers.0, long.0, 1e-14) && near(powers.1, long.1, 1e-13) && near(powers.2, long.2, 1e-14));
}

/// A disk: what is left of an interval without length, with its gradient.
#[test]
fn pe5_an_interval_without_length_is_a_disk() {
    for t in [0.5, 3.0, 1e6] {
        assert_eq!(moments(t, t, Cone), (t, 0.0, t * t / 4.0));
        assert_eq!(moments(t, t, Cylinder), (t, 0.0, 0.25));
    }
    assert_eq!(moments(0.0, 0.0, Cone), (0.0, 0.0, 0.0));
    let f = Frustum { origin: [0.0; 3], direction: [0.0, 0.0, 1.0], radius: 0.5, start: 2.0, end: 2.0 };
    let g = Gaussian { t_mean: 1.0, t_variance: 1.0, r_variance: 1.0, mean: [0.0; 3], variance: [0.0; 3] };
    let found = backward::conical_frustum(&f, Cone, &g);
    assert_eq!((found.start, found.end), (0.625, 0.625));
}

/// 3/4 of the way down; 3/80 of the height's square; 3/20 of the base's.
#[test]
fn a_whole_cone() {
    let (mean, along, across) = moments(0.0, 4.0, Cone);
    assert_eq!(mean, 3.0);
    assert!(near(along, 0.6, 1e-15) && near(across, 0.15 * 16.0, 1e-15));
    let huge = moments(0.0, 1e200, Cone);
    assert_eq!(huge.0, 0.75e200);
    assert_eq!(moments(1e-200, 2e-200, RayShape::Cone).0, moments(1.0, 2.0, Cone).0 * 1e-200);
}
