use glam::{DMat3, DMat4, DQuat, DVec2, DVec3};
use proptest::prelude::*;

use super::*;
use crate::contract::testing::{properties, slope};

/// A rigid pose: any rotation, any place within 10 units.
pub(crate) fn pose() -> impl Strategy<Value = DMat4> {
    (prop::array::uniform4(-1.0..1.0), prop::array::uniform3(-10.0..10.0))
        .prop_filter("a quaternion of some length", |(q, _): &([f64; 4], [f64; 3])| {
            q.iter().map(|x| x * x).sum::<f64>() > 0.01
        })
        .prop_map(|(q, o)| DMat4::from_rotation_translation(DQuat::from_array(q).normalize(), o.into()))
}

/// Intrinsics with fx != fy and the principal point off the center of a 640 x 360 picture.
pub(crate) fn intrinsics() -> impl Strategy<Value = Intrinsics> {
    (100.0..2000.0, 1.05..2.0, 100.0..500.0, 50.0..300.0).prop_map(|(fx, ratio, cx, cy)| Intrinsics {
        fx,
        fy: fx * ratio,
        cx,
        cy,
    })
}

/// A pixel of that picture.
pub(crate) fn pixel() -> impl Strategy<Value = DVec2> {
    (0.0..640.0, 0.0..360.0).prop_map(|(u, v)| DVec2::new(u, v))
}

#[test]
fn a_quarter_turn_and_a_shift() {
    // The camera at (1, 2, 3), turned so that its x axis is the world's y and its y axis the world's -x.
    let c2w = DMat4::from_cols_array_2d(&[
        [0.0, 1.0, 0.0, 0.0],
        [-1.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0],
        [1.0, 2.0, 3.0, 1.0],
    ]);
    assert_eq!(transform(&c2w, DVec3::new(10.0, 20.0, 30.0)), DVec3::new(-19.0, 12.0, 33.0));
    assert_eq!(rotate(&c2w, DVec3::new(10.0, 20.0, 30.0)), DVec3::new(-20.0, 10.0, 30.0));
    assert_eq!(
        backward::rotate_transposed(&c2w, DVec3::new(-20.0, 10.0, 30.0)),
        DVec3::new(10.0, 20.0, 30.0)
    );
}

/// A pose that is not rigid: gradients know nothing of orthogonality.
pub(crate) const SKEWED: [[f64; 4]; 4] =
    [[0.5, 1.0, -0.25, 0.0], [-1.0, 0.75, 0.5, 0.0], [0.25, -0.5, 1.5, 0.0], [1.0, 2.0, 3.0, 1.0]];

#[test]
fn gradients_of_the_transform() {
    let (x_c, g) = (DVec3::new(0.5, -1.5, 2.0), DVec3::new(0.75, -0.25, 1.25));
    let pulled = |c2w: [[f64; 4]; 4], x: DVec3| g.dot(transform(&DMat4::from_cols_array_2d(&c2w), x));
    let (g_c2w, g_x) = backward::transform(&DMat4::from_cols_array_2d(&SKEWED), x_c, g);
    for column in 0..4 {
        for row in 0..4 {
            let moved = |h: f64| {
                let mut c2w = SKEWED;
                c2w[column][row] += h;
                pulled(c2w, x_c)
            };
            assert!((g_c2w.col(column)[row] - slope(moved)).abs() < 1e-11, "column {column}, row {row}");
        }
    }
    for axis in 0..3 {
        let moved = |h: f64| pulled(SKEWED, x_c + h * DVec3::AXES[axis]);
        assert!((g_x[axis] - slope(moved)).abs() < 1e-11);
    }
}

#[test]
fn gradients_of_the_lens() {
    let k = [4.0, 8.0, 1.5, -2.5];
    let lens = |k: [f64; 4]| Intrinsics { fx: k[0], fy: k[1], cx: k[2], cy: k[3] };
    let (uv, s, g) = (DVec2::new(3.0, 5.0), 2.5, DVec3::new(0.75, -0.25, 1.25));
    let (g_k, g_uv, g_s) = backward::pixel_to_camera(&lens(k), uv, s, g);
    for (n, by_hand) in [g_k.fx, g_k.fy, g_k.cx, g_k.cy].into_iter().enumerate() {
        let moved = |h: f64| {
            let mut k = k;
            k[n] += h;
            g.dot(pixel_to_camera(&lens(k), uv, s))
        };
        assert!((by_hand - slope(moved)).abs() < 1e-11, "{n}: {by_hand} {}", slope(moved));
    }
    for axis in 0..2 {
        let moved = |h: f64| g.dot(pixel_to_camera(&lens(k), uv + h * DVec2::AXES[axis], s));
        assert!((g_uv[axis] - slope(moved)).abs() < 1e-11);
    }
    assert!((g_s - slope(|h| g.dot(pixel_to_camera(&lens(k), uv, s + h)))).abs() < 1e-11);
}

#[test]
fn the_principal_point_looks_along_the_axis() {
    let k = Intrinsics { fx: 300.0, fy: 500.0, cx: 31.0, cy: 17.0 };
    assert_eq!(pixel_to_camera(&k, DVec2::new(31.0, 17.0), 7.0), DVec3::new(0.0, 0.0, 7.0));
    // One focal length off the center: 45 degrees.
    assert_eq!(pixel_to_camera(&k, DVec2::new(331.0, -483.0), 2.0), DVec3::new(2.0, -2.0, 2.0));
}

#[test]
fn cg9_a_pose_is_applied_as_it_is() {
    // A mirror (det -1) or a scale of 2 is not repaired here: the file readers refuse it, the formula doesn't hide it.
    for (s, x) in [
        (DVec3::new(-1.0, 1.0, 1.0), DVec3::new(-1.0, 2.0, 3.0)),
        (DVec3::splat(2.0), DVec3::new(2.0, 4.0, 6.0)),
    ] {
        assert_eq!(transform(&DMat4::from_scale(s), DVec3::new(1.0, 2.0, 3.0)), x);
    }
    let mut nan = DMat4::IDENTITY;
    nan.x_axis.x = f64::NAN;
    assert!(transform(&nan, DVec3::X).x.is_nan(), "a NaN stays visible");
    // A singular K has no ray: infinite, not a plausible number.
    let flat = Intrinsics { fx: 0.0, fy: 1.0, cx: 0.0, cy: 0.0 };
    assert!(!pixel_to_camera(&flat, DVec2::new(3.0, 1.0), 1.0).is_finite());
}

/// Each lens is its own formula, there and back: 45 degrees off the axis a fisheye has pi/4.
#[test]
fn a_lens_bends_as_its_model_says() {
    let radial = Lens::Opencv(Distortion { k1: 0.5, ..Distortion::default() });
    let (p, bent) = (DVec2::new(0.0, 1.0), DVec2::new(0.0, 1.5));
    assert_eq!(radial.distort(p), bent);
    assert!((radial.undistort(bent).unwrap() - p).length() < 1e-15);
    let fisheye = Lens::Fisheye([0.0; 4]);
    let bent = DVec2::new(0.0, std::f64::consts::FRAC_PI_4);
    assert_eq!(fisheye.distort(p), bent);
    assert!((fisheye.undistort(bent).unwrap() - p).length() < 1e-15);
    assert!(fisheye.undistort(2.0 * bent).is_err(), "90 degrees off the axis there is no point at depth 1");
}

proptest! {
    #![proptest_config(properties())]

    #[test]
    fn projecting_undoes_lifting(k in intrinsics(), uv in pixel(), s in 0.1..100.0) {
        let x_c = pixel_to_camera(&k, uv, s);
        prop_assert_eq!(x_c.z, s);
        prop_assert!((camera_to_pixel(&k, x_c) - uv).length() < 1e-12 * 640.0);
        // K^-1 as a matrix, the other way to write it.
        let matrix = DMat3::from_cols(DVec3::new(k.fx, 0.0, 0.0), DVec3::new(0.0, k.fy, 0.0), DVec3::new(k.cx, k.cy, 1.0));
        prop_assert!((matrix.inverse() * uv.extend(1.0) * s - x_c).length() < 1e-13 * s * 10.0);
    }

    #[test]
    fn a_pose_keeps_lengths_and_composes(a in pose(), b in pose(), x in prop::array::uniform3(-5.0..5.0)) {
        let x = DVec3::from(x);
        prop_assert!((rotate(&a, x).length() - x.length()).abs() < 1e-13);
        prop_assert!((transform(&a, transform(&b, x)) - transform(&(a * b), x)).length() < 1e-12);
        prop_assert!((transform(&a.inverse(), transform(&a, x)) - x).length() < 1e-12);
        prop_assert_eq!(transform(&a, x), rotate(&a, x) + a.w_axis.truncate());
        prop_assert!((backward::rotate_transposed(&a, rotate(&a, x)) - x).length() < 1e-13);
    }
}
