//! What a pose is: a rotation and where the camera stands, of which the projection is the inverse.

use glam::{DMat3, DMat4, DQuat, DVec3};
use proptest::prelude::*;

use super::{backward, from_colmap, rotation};
use crate::contract::testing::{properties, slope};
use crate::convention::Axes::{Opencv, Opengl};
use crate::convention::Quaternion::{AsGiven, Normalized};

fn turn() -> impl Strategy<Value = [f64; 4]> {
    prop::array::uniform4(-1.0..1.0).prop_filter("long enough", |q: &[f64; 4]| {
        q.iter().map(|x| x * x).fold(0.0, |sum: f64, x| sum + x) > 0.01
    })
}

fn place() -> impl Strategy<Value = [f64; 3]> {
    prop::array::uniform3(-4.0..4.0)
}

#[test]
fn quarter_turns_go_the_right_way() {
    let half = 0.5f64.sqrt();
    for (axis, from, to) in [(1, DVec3::Y, DVec3::Z), (2, DVec3::Z, DVec3::X), (3, DVec3::X, DVec3::Y)] {
        let mut q = [half, 0.0, 0.0, 0.0];
        q[axis] = half;
        for length in [Normalized, AsGiven] {
            assert!((rotation(q, length) * from - to).length() < 1e-15, "{axis}");
        }
    }
    assert_eq!(rotation([1.0, 0.0, 0.0, 0.0], AsGiven), DMat3::IDENTITY);
    // As it is, a quaternion that is twice as long turns nothing: 1 - 2 (4 z^2), ...
    assert_eq!(rotation([0.0, 0.0, 0.0, 2.0], AsGiven).x_axis, DVec3::new(-7.0, 0.0, 0.0));
    assert_eq!(rotation([0.0, 0.0, 0.0, 2.0], Normalized).x_axis, DVec3::NEG_X);
}

proptest! {
    #![proptest_config(properties())]

    /// A point of the world, moved to the camera as COLMAP says and back by the pose.
    #[test]
    fn the_pose_undoes_the_way_to_the_camera(q in turn(), t in place(), x in place()) {
        let turned = DQuat::from_xyzw(q[1], q[2], q[3], q[0]).normalize();
        let seen = turned * DVec3::from(x) + DVec3::from(t);
        let back = from_colmap(q, t, Opencv, Normalized).transform_point3(seen);
        prop_assert!((back - DVec3::from(x)).length() < 1e-13, "{back}");
        let gl = from_colmap(q, t, Opengl, Normalized);
        prop_assert!((gl.transform_point3(seen * DVec3::new(1.0, -1.0, -1.0)) - back).length() < 1e-13);
        prop_assert_eq!(gl.row(3), glam::DVec4::W);
    }

    #[test]
    fn a_rotation_keeps_lengths_and_hands(q in turn()) {
        let r = rotation(q, Normalized);
        let error = r * r.transpose() - DMat3::IDENTITY;
        prop_assert!(error.to_cols_array().iter().all(|x| x.abs() < 1e-14), "{error}");
        prop_assert!((r.determinant() - 1.0).abs() < 1e-14);
        prop_assert_eq!(rotation(q.map(|x| -x), Normalized), r);
        let unit = DQuat::from_xyzw(q[1], q[2], q[3], q[0]).normalize();
        let other = rotation([unit.w, unit.x, unit.y, unit.z], AsGiven);
        prop_assert!((other - r).to_cols_array().iter().all(|x| x.abs() < 1e-14));
    }

    #[test]
    fn the_gradient_is_that_of_differences(
        q in turn(), t in place(), g in prop::collection::vec(-1.0..1.0, 16), gl in any::<bool>(), given in any::<bool>()
    ) {
        let (axes, length) = (if gl { Opengl } else { Opencv }, if given { AsGiven } else { Normalized });
        let g = DMat4::from_cols_array(&std::array::from_fn(|n| g[n]));
        let (g_q, g_t) = backward::from_colmap(q, t, axes, length, &g);
        for n in 0..7 {
            let moved = |s: f64| {
                let (mut q, mut t) = (q, t);
                if n < 4 { q[n] += 0.01 * s } else { t[n - 4] += 0.01 * s }
                let c2w = from_colmap(q, t, axes, length).to_cols_array();
                c2w.iter().zip(g.to_cols_array()).map(|(x, g)| x * g).sum::<f64>()
            };
            let (found, by_hand) = (slope(moved) / 0.01, if n < 4 { g_q[n] } else { g_t[n - 4] });
            prop_assert!((found - by_hand).abs() <= 1e-7 * (1.0 + by_hand.abs()), "{n}: {found} {by_hand}");
        }
        if !given {
            let along: f64 = (0..4).map(|n| q[n] * g_q[n]).sum();
            prop_assert!(along.abs() < 1e-12, "lengths have no effect: {along}");
        }
    }
}
