//! What normalized device coordinates are for: points of a ray stay on it, the near plane and infinity are faces of a cube.

use approx::assert_relative_eq;
use proptest::prelude::*;

use super::{View, backward, ndc_point, ndc_ray};
use crate::contract::testing::{properties, slope};
use crate::convention::NdcDepth::{self, Negative, Positive};

fn view(near: f64, depth: NdcDepth) -> View {
    View { width: 40.0, height: 24.0, focal: 36.0, near, depth }
}

fn number() -> impl Strategy<Value = f64> {
    -2.0..2.0
}

fn ray(way: f64) -> impl Strategy<Value = ([f64; 3], [f64; 3])> {
    (prop::array::uniform3(number()), (number(), number(), 0.25..2.0))
        .prop_map(move |(o, (x, y, z))| (o, [x, y, way * z]))
}

proptest! {
    #![proptest_config(properties())]

    /// A point of the ray at depth D projects to o' + t' d' with t' = 1 - n/D.
    #[test]
    fn points_of_a_ray_stay_on_it(
        ((o, d), depth) in (ray(-1.0), Just(Negative)).prop_union((ray(1.0), Just(Positive))), near in 0.25..2.0, along in 0.0..9.0
    ) {
        let view = view(near, depth);
        let (o_ndc, d_ndc) = ndc_ray(o, d, &view);
        let at_near = (view.sign() * near - o[2]) / d[2];
        let p = [0, 1, 2].map(|j| o[j] + (at_near + along) * d[j]);
        let (expected, t) = (ndc_point(p, &view), 1.0 - near / (view.sign() * p[2]));
        for j in 0..3 {
            let found = o_ndc[j] + t * d_ndc[j];
            prop_assert!((found - expected[j]).abs() <= 1e-12 * (1.0 + expected[j].abs()), "{j}: {found} {expected:?}");
        }
    }

    /// Both conventions are one scene, mirrored.
    #[test]
    fn the_other_axes_mirror_the_scene((o, d) in ray(-1.0), near in 0.25..2.0) {
        let mirrored = |x: [f64; 3]| [x[0], x[1], -x[2]];
        prop_assert_eq!(
            ndc_ray(o, d, &view(near, Negative)),
            ndc_ray(mirrored(o), mirrored(d), &view(near, Positive))
        );
    }

    /// Neither the length of d nor where on its line a ray begins makes a difference.
    #[test]
    fn a_ray_is_its_line((o, d) in ray(-1.0), scale in 0.25..4.0, along in -2.0..2.0) {
        let view = view(1.0, Negative);
        let (a, b) = (ndc_ray(o, d, &view), ndc_ray([0, 1, 2].map(|j| o[j] + along * d[j]), d.map(|d| scale * d), &view));
        for j in 0..3 {
            prop_assert!((a.0[j] - b.0[j]).abs() < 1e-11 && (a.1[j] - b.1[j]).abs() < 1e-11, "{a:?} {b:?}");
        }
    }

    #[test]
    fn the_gradient_is_that_of_differences((o, d) in ray(1.0), g in prop::array::uniform6(number()), forward in any::<bool>()) {
        let view = view(0.75, if forward { Positive } else { Negative });
        let (g_o, g_d) = ([g[0], g[1], g[2]], [g[3], g[4], g[5]]);
        let by_hand = backward::ndc_ray(o, d, &view, g_o, g_d);
        for j in 0..6 {
            let moved = |s: f64| {
                let (mut o, mut d) = (o, d);
                if j < 3 { o[j] += 0.25 * s } else { d[j - 3] += 0.25 * s }
                let (a, b) = ndc_ray(o, d, &view);
                (0..3).map(|k| g_o[k] * a[k] + g_d[k] * b[k]).sum::<f64>()
            };
            let (by_differences, by_hand) = (slope(moved) / 0.25, if j < 3 { by_hand.0[j] } else { by_hand.1[j - 3] });
            prop_assert!((by_hand - by_differences).abs() <= 1e-7 * (1.0 + by_differences.abs()), "{j}: {by_hand} {by_differences}");
        }
    }
}

/// The camera's own view fills the cube: corners of the picture on the near plane and at infinity.
#[test]
fn the_view_is_the_cube() {
    let view = view(2.0, Positive);
    let corner = [20.0 / 36.0, -12.0 / 36.0, 1.0];
    let (o, d) = ndc_ray([0.0; 3], corner, &view);
    for j in 0..3 {
        assert_relative_eq!(o[j], [1.0, -1.0, -1.0][j], max_relative = 1e-15);
        assert!((d[j] - [0.0, 0.0, 2.0][j]).abs() < 1e-15, "{d:?}");
    }
}

/// CG10: a camera at z = 0 is as good as any other; rays across the axis have no place in the cube.
#[test]
fn a_ray_across_the_axis_is_not_finite() {
    let view = view(1.0, Negative);
    let (o, d) = ndc_ray([0.0, 0.0, 0.0], [0.5, 0.25, -1.0], &view);
    assert_eq!((o[2], d[2]), (-1.0, 2.0));
    assert!(o.iter().chain(&d).all(|x| x.is_finite()));
    let (o, d) = ndc_ray([0.0, 0.0, 0.0], [0.5, 0.25, 0.0], &view);
    assert!(!o[0].is_finite() && !d[0].is_finite());
}
