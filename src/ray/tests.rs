use glam::{DMat4, DVec2, DVec3};
use ndarray::Array4;
use proptest::prelude::*;

use super::*;
use crate::camera::tests::{SKEWED, intrinsics, pixel, pose};
use crate::camera::{Distortion, Lens, camera_to_pixel, transform};
use crate::contract::testing::{properties, slope};

const K: Intrinsics = Intrinsics { fx: 100.0, fy: 200.0, cx: 50.0, cy: 40.0 };

fn unit(k: &Intrinsics, c2w: &DMat4, uv: DVec2) -> Ray {
    pixel_to_ray(k, c2w, uv, Axes::Opencv, Directions::Unit)
}

#[test]
fn a_camera_at_identity_sees_the_axis() {
    let ray = unit(&K, &DMat4::IDENTITY, DVec2::new(50.0, 40.0));
    assert_eq!((ray.o, ray.d, ray.at(3.0)), (DVec3::ZERO, DVec3::Z, DVec3::new(0.0, 0.0, 3.0)));
    // OpenGL looks along -z, with y up.
    let gl = |uv, directions| pixel_to_ray(&K, &DMat4::IDENTITY, uv, Axes::Opengl, directions).d;
    assert_eq!(gl(DVec2::new(50.0, 40.0), Directions::Unit), -DVec3::Z);
    assert_eq!(gl(DVec2::new(150.0, 240.0), Directions::Depth), DVec3::new(1.0, -1.0, -1.0));
}

/// Divided before it is turned: the same for a rotation, twice as long where the pose is.
#[test]
fn unit_in_the_cameras_frame() {
    let turn = |scale: f64| DMat4::from_scale(DVec3::splat(scale)) * DMat4::from_rotation_y(0.5);
    let of = |scale, directions| {
        pixel_to_ray(&K, &turn(scale), DVec2::new(150.0, 240.0), Axes::Opencv, directions).d
    };
    assert!((of(1.0, Directions::UnitInCamera) - of(1.0, Directions::Unit)).length() < 1e-15);
    assert!((of(2.0, Directions::UnitInCamera) - 2.0 * of(2.0, Directions::Unit)).length() < 1e-15);
}

#[test]
fn gradients_of_the_ray() {
    let (k, uv) = ([4.0, 8.0, 1.5, -2.5], DVec2::new(3.0, 5.0));
    let (g_o, g_d) = (DVec3::new(0.5, -1.0, 0.25), DVec3::new(0.75, -0.25, 1.25));
    let lens = |k: [f64; 4]| Intrinsics { fx: k[0], fy: k[1], cx: k[2], cy: k[3] };
    for axes in [Axes::Opencv, Axes::Opengl] {
        for directions in [Directions::Unit, Directions::UnitInCamera, Directions::Depth] {
            let pulled = |k: [f64; 4], c2w: [[f64; 4]; 4], uv: DVec2| {
                let ray = pixel_to_ray(&lens(k), &DMat4::from_cols_array_2d(&c2w), uv, axes, directions);
                g_o.dot(ray.o) + g_d.dot(ray.d)
            };
            let c2w = DMat4::from_cols_array_2d(&SKEWED);
            let (g_k, g_c2w, g_uv) = backward::pixel_to_ray(&lens(k), &c2w, uv, axes, directions, g_o, g_d);
            for (n, by_hand) in [g_k.fx, g_k.fy, g_k.cx, g_k.cy].into_iter().enumerate() {
                let moved = |h: f64| {
                    let mut k = k;
                    k[n] += h;
                    pulled(k, SKEWED, uv)
                };
                assert!((by_hand - slope(moved)).abs() < 1e-10, "{axes:?} {directions:?}: parameter {n}");
            }
            for entry in 0..16 {
                let moved = |h: f64| {
                    let mut c2w = SKEWED;
                    c2w[entry / 4][entry % 4] += h;
                    pulled(k, c2w, uv)
                };
                let by_hand = g_c2w.col(entry / 4)[entry % 4];
                assert!((by_hand - slope(moved)).abs() < 1e-10, "{axes:?} {directions:?}: entry {entry}");
            }
            for axis in 0..2 {
                let moved = |h: f64| pulled(k, SKEWED, uv + h * DVec2::AXES[axis]);
                assert!((g_uv[axis] - slope(moved)).abs() < 1e-10, "{axes:?} {directions:?}: uv");
            }
        }
    }
}

#[test]
fn pixel_centers() {
    assert_eq!(pixel_position(3, 5, PixelCenter::Half), DVec2::new(3.5, 5.5));
    assert_eq!(pixel_position(3, 5, PixelCenter::Integer), DVec2::new(3.0, 5.0));
}

#[test]
fn cg9_a_camera_far_away_keeps_its_directions() {
    let uv = DVec2::new(13.5, 71.5);
    let far = DMat4::from_translation(DVec3::new(1e6, -1e6, 1e6));
    let near = unit(&K, &DMat4::IDENTITY, uv);
    assert_eq!(unit(&K, &far, uv).d, near.d, "the translation never enters, to the last bit");
    // The textbook form (x_w - o) / |x_w - o| loses six digits.
    let x = transform(&far, pixel_to_camera(&K, uv, 1.0)) - far.w_axis.truncate();
    let lost = (x / x.length() - near.d).length();
    assert!((1e-12..1e-8).contains(&lost), "{lost}");
    // A scaled pose still has unit directions; a NaN stays one.
    assert!((unit(&K, &DMat4::from_scale(DVec3::splat(2.0)), uv).d - near.d).length() < 1e-15);
    assert!(unit(&K, &(far * f64::NAN), uv).d.is_nan());
}

#[test]
fn cg5_a_ray_without_inverse_lens_is_an_error() {
    let lens = Lens::Opencv(Distortion { k1: -0.3, ..Distortion::default() });
    let camera = Camera { width: 100, height: 80, k: K, c2w: DMat4::IDENTITY, distortion: Some(lens) };
    assert!(camera_ray(&camera, DVec2::new(150.0, 40.0)).is_err());
    // Near the middle the distorted ideal ray comes back.
    let ideal = DVec2::new(0.2, -0.1);
    let uv = camera_to_pixel(&K, lens.distort(ideal).extend(1.0));
    let d = camera_ray(&camera, uv).unwrap().d;
    assert!((d - ideal.extend(1.0).normalize()).length() < 1e-12);
    let plain = Camera { distortion: None, ..camera };
    assert_eq!(camera_ray(&plain, uv).unwrap(), unit(&K, &DMat4::IDENTITY, uv));
}

/// A stack in which every pixel's color tells where it is.
fn labeled() -> Array4<f64> {
    Array4::from_shape_fn((3, 4, 6, 3), |(n, j, i, k)| [n, j, i][k] as f64)
}

#[test]
fn random_rays_carry_the_color_under_their_pixel() {
    let images = labeled();
    let u: Vec<[f64; 3]> =
        (0..60).map(|n| [0.37, 0.61, 0.83].map(|step| (f64::from(n) * step).fract())).collect();
    for draw in [PixelDraws::Pool, PixelDraws::PerImage { images: 4 }] {
        let rays = sample_random_rays(images.view(), draw, &u, PixelCenter::Half);
        assert_eq!(rays.len(), u.len());
        for (n, ray) in rays.iter().enumerate() {
            assert_eq!(ray.rgb, [ray.image as f64, ray.uv.y - 0.5, ray.uv.x - 0.5]);
            let row = if draw == PixelDraws::Pool { n } else { n % 4 };
            assert_eq!(ray.image, (3.0 * u[row][0]) as usize);
            assert_eq!((ray.uv.y, ray.uv.x), ((4.0 * u[n][1]).floor() + 0.5, (6.0 * u[n][2]).floor() + 0.5));
        }
        let seen = |wanted| rays.iter().any(|ray| ray.image == wanted);
        assert!(seen(0) && seen(1) && seen(2), "every image is drawn");
    }
}

#[test]
fn the_largest_u_stays_inside() {
    let u = 1.0 - f64::EPSILON / 2.0;
    for n in [1, 2, 3, 7, 1000] {
        let draw = draw_pixel(Array4::zeros((n, 1, n, 3)).view(), [u; 3], PixelCenter::Integer);
        assert_eq!((draw.image, draw.uv), (n - 1, DVec2::new((n - 1) as f64, 0.0)));
    }
    // Even 1 itself, which no generator of [0, 1) returns, is the last pixel.
    let last = draw_pixel(labeled().view(), [1.0; 3], PixelCenter::Integer);
    assert_eq!((last.image, last.uv), (2, DVec2::new(5.0, 3.0)));
    let first = draw_pixel(labeled().view(), [0.0; 3], PixelCenter::Integer);
    assert_eq!((first.image, first.uv), (0, DVec2::ZERO));
}

proptest! {
    #![proptest_config(properties())]

    #[test]
    fn projecting_a_ray_returns_its_pixel(k in intrinsics(), c2w in pose(), uv in pixel(), t in 0.5..50.0) {
        let ray = unit(&k, &c2w, uv);
        prop_assert!((ray.d.length() - 1.0).abs() <= 4.0 * f64::EPSILON);
        prop_assert_eq!(ray.o, c2w.w_axis.truncate());
        let back = camera_to_pixel(&k, transform(&c2w.inverse(), ray.at(t)));
        // Positions of size 60 are rounded, then magnified by the focal length over the distance.
        prop_assert!((back - uv).length() < 1e-15 * 60.0 * k.fy / t.min(1.0) * 40.0, "{}", (back - uv).length());
    }

    #[test]
    fn turning_the_world_turns_the_ray(k in intrinsics(), c2w in pose(), g in pose(), uv in pixel()) {
        let (before, after) = (unit(&k, &c2w, uv), unit(&k, &(g * c2w), uv));
        prop_assert!((after.o - transform(&g, before.o)).length() < 1e-13 * 40.0);
        prop_assert!((after.d - rotate(&g, before.d)).length() < 1e-14);
        // Moving the camera moves the origin alone.
        let moved = unit(&k, &(DMat4::from_translation(DVec3::new(3.0, -1.0, 2.0)) * c2w), uv);
        prop_assert_eq!(moved.d, before.d);
    }

    #[test]
    fn depth_directions_advance_one_unit_of_depth(k in intrinsics(), c2w in pose(), uv in pixel()) {
        let depth = pixel_to_ray(&k, &c2w, uv, Axes::Opencv, Directions::Depth).d;
        let axis = c2w.z_axis.truncate();
        prop_assert!((depth.dot(axis) - 1.0).abs() < 1e-12);
        prop_assert!((depth.normalize() - unit(&k, &c2w, uv).d).length() < 1e-15);
    }
}
