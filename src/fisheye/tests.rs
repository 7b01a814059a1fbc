//! What a fisheye is: angles for distances, one branch of an inverse, and gradients that go with both.

use std::f64::consts::FRAC_PI_4;

use glam::{DMat2, DVec2};
use proptest::prelude::*;

use super::{backward, distort, undistort};
use crate::contract::testing::{properties, slope};

fn lens() -> impl Strategy<Value = [f64; 4]> {
    (-0.05..0.05, -0.02..0.02, -0.01..0.01, -0.003..0.003).prop_map(|(a, b, c, d)| [a, b, c, d])
}

fn point() -> impl Strategy<Value = DVec2> {
    (-1.5..1.5, -1.0..1.0).prop_map(|(x, y)| DVec2::new(x, y))
}

#[test]
fn the_polynomial_term_by_term() {
    let corner = DVec2::new(0.6, 0.8);
    assert!((distort([0.0; 4], corner) - FRAC_PI_4 * corner).length() < 1e-15);
    for n in 0..4 {
        let mut k = [0.0; 4];
        k[n] = 1.0;
        let expected = FRAC_PI_4 * (1.0 + FRAC_PI_4.powi(2 * n as i32 + 2)) * corner;
        assert!((distort(k, corner) - expected).length() < 1e-15, "{n}");
    }
}

#[test]
fn the_middle_stays() {
    let (k, g) = ([0.1, 0.2, 0.3, 0.4], DVec2::new(1.0, -2.0));
    assert_eq!((distort(k, DVec2::ZERO), undistort(k, DVec2::ZERO).unwrap()), (DVec2::ZERO, DVec2::ZERO));
    assert_eq!(backward::distort(k, DVec2::ZERO, g), (g, [0.0; 4]));
    assert_eq!(backward::undistort(k, DVec2::ZERO, g), (g, [0.0; 4]));
    // And so it is beside it, to the last digits.
    let beside = DVec2::new(1e-9, 0.0);
    assert_eq!(distort(k, beside), beside);
    assert!((backward::distort(k, beside, g).0 - g).length() < 1e-15);
}

#[test]
fn a_lens_without_inverse_says_so() {
    let refused = |k: [f64; 4], target: DVec2| undistort(k, target).unwrap_err().to_string();
    // theta (1 - 0.15 theta^2) never exceeds 0.994.
    let barrel = [-0.15, 0.0, 0.0, 0.0];
    let message = refused(barrel, DVec2::new(0.0, 1.2));
    assert!(message.contains("no inverse at (0, 1.2)") && message.contains("k1 -0.15"), "{message}");
    assert!(undistort(barrel, DVec2::new(0.0, 0.99)).is_ok());
    // 90 degrees and more have no point at depth 1.
    refused([0.0; 4], DVec2::new(std::f64::consts::FRAC_PI_2, 0.0));
    assert!(undistort([0.0; 4], DVec2::new(1.5625, 0.0)).unwrap().x > 100.0);
    refused([0.0; 4], DVec2::new(f64::NAN, 0.0));
    // theta (1 - theta^2 + 0.4 theta^4) has its top at 0.707 and its bottom at 1: beyond, Newton's method finds the other branch.
    let twice = [-1.0, 0.4, 0.0, 0.0];
    let beyond = distort(twice, DVec2::new(1.4f64.tan(), 0.0));
    refused(twice, beyond);
    // A flat start: a step without end.
    refused([-1.0 / 3.0, 0.0, 0.0, 0.0], DVec2::new(1.0, 0.0));
}

proptest! {
    #![proptest_config(properties())]

    #[test]
    fn undistortion_undoes_distortion(k in lens(), p in point()) {
        prop_assert!((undistort(k, distort(k, p)).unwrap() - p).length() < 1e-14 * (1.0 + p.length_squared()));
    }

    #[test]
    fn a_fisheye_has_no_direction(k in lens(), p in point(), turn in 0.0..6.3) {
        let rotation = DMat2::from_angle(turn);
        prop_assert!((distort(k, rotation * p) - rotation * distort(k, p)).length() < 1e-15);
    }

    #[test]
    fn gradients_are_those_of_differences(k in lens(), p in point(), g in (-1.0..1.0, -1.0..1.0)) {
        let g = DVec2::new(g.0, g.1);
        prop_assume!(p.length() > 0.1);
        let target = distort(k, p);
        let (g_p, g_k) = backward::distort(k, p, g);
        let (g_target, g_inverse) = backward::undistort(k, p, g);
        for (axis, e) in [DVec2::X, DVec2::Y].into_iter().enumerate() {
            let forward = slope(|s| g.dot(distort(k, p + 0.05 * s * e))) / 0.05;
            prop_assert!((forward - g_p[axis]).abs() < 1e-8, "{axis}: {forward} {g_p}");
            let inverse = slope(|s| g.dot(undistort(k, target + 0.05 * s * e).unwrap())) / 0.05;
            prop_assert!((inverse - g_target[axis]).abs() < 1e-7, "{axis}: {inverse} {g_target}");
        }
        for n in 0..4 {
            let bent = |s: f64| { let mut k = k; k[n] += 0.1 * s; k };
            let forward = slope(|s| g.dot(distort(bent(s), p))) / 0.1;
            prop_assert!((forward - g_k[n]).abs() < 1e-8, "{n}: {forward} {g_k:?}");
            let inverse = slope(|s| g.dot(undistort(bent(s), target).unwrap())) / 0.1;
            prop_assert!((inverse - g_inverse[n]).abs() < 1e-7 * (1.0 + g_inverse[n].abs()), "{n}: {inverse} {g_inverse:?}");
        }
    }
}
