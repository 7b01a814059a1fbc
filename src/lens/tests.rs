//! What a lens is: its terms one by one, one branch of an inverse, and gradients that go with both.

use glam::{DMat2, DVec2};
use proptest::prelude::*;

use super::{Distortion, backward};
use crate::contract::testing::{properties, slope};

const NONE: Distortion =
    Distortion { k1: 0.0, k2: 0.0, p1: 0.0, p2: 0.0, k3: 0.0, k4: 0.0, k5: 0.0, k6: 0.0 };

/// Mild lenses of all eight coefficients: none of them folds within 1 of the middle.
fn lens() -> impl Strategy<Value = Distortion> {
    let small = || -5e-3..5e-3;
    let far = (-0.01..0.01, -0.02..0.02, -0.01..0.01, -0.005..0.005);
    (-0.08..0.1, -0.02..0.05, small(), small(), far)
        .prop_map(|(k1, k2, p1, p2, (k3, k4, k5, k6))| Distortion { k1, k2, p1, p2, k3, k4, k5, k6 })
}

fn point() -> impl Strategy<Value = DVec2> {
    (-0.8..0.8, -0.5..0.5).prop_map(|(x, y)| DVec2::new(x, y))
}

/// The lens whose coefficient n, in OpenCV's order, is larger by s.
fn bent(lens: &Distortion, n: usize, s: f64) -> Distortion {
    let mut k = [lens.k1, lens.k2, lens.p1, lens.p2, lens.k3, lens.k4, lens.k5, lens.k6];
    k[n] += s;
    Distortion::from_opencv(&k)
}

#[test]
fn distortion_terms_one_by_one() {
    let p = DVec2::new(0.5, -0.25); // r^2 = 5/16
    assert_eq!(NONE.distort(p), p);
    assert_eq!(Distortion { k1: 1.0, ..NONE }.distort(p), p * (1.0 + 0.3125));
    assert_eq!(Distortion { k2: 1.0, ..NONE }.distort(p), p * (1.0 + 0.09765625));
    assert_eq!(Distortion { k3: 1.0, ..NONE }.distort(p), p * (1.0 + 0.030517578125));
    assert_eq!(Distortion { k4: 1.0, ..NONE }.distort(p), p * (1.0 / 1.3125));
    assert_eq!(Distortion { k5: 1.0, ..NONE }.distort(p), p * (1.0 / 1.09765625));
    assert_eq!(Distortion { k6: 1.0, ..NONE }.distort(p), p * (1.0 / 1.030517578125));
    // p1: x += 2 x y, y += r^2 + 2 y^2; p2: x += r^2 + 2 x^2, y += 2 x y.
    assert_eq!(Distortion { p1: 1.0, ..NONE }.distort(p), p + DVec2::new(-0.25, 0.4375));
    assert_eq!(Distortion { p2: 1.0, ..NONE }.distort(p), p + DVec2::new(0.8125, -0.25));
}

#[test]
fn coefficients_come_in_opencvs_order() {
    let all = Distortion { k1: 1.0, k2: 2.0, p1: 3.0, p2: 4.0, k3: 5.0, k4: 6.0, k5: 7.0, k6: 8.0 };
    assert_eq!(Distortion::from_opencv(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]), all);
    let five = Distortion { k4: 0.0, k5: 0.0, k6: 0.0, ..all };
    assert_eq!(Distortion::from_opencv(&[1.0, 2.0, 3.0, 4.0, 5.0]), five);
    assert_eq!(Distortion::from_opencv(&[1.0, 2.0, 3.0, 4.0]), Distortion { k3: 0.0, ..five });
    assert!(std::panic::catch_unwind(|| Distortion::from_opencv(&[1.0; 6])).is_err());
    assert_eq!(five.to_string(), "k1 1, k2 2, p1 3, p2 4, k3 5");
    assert_eq!(NONE.to_string(), "k1 0, k2 0, p1 0, p2 0");
}

#[test]
fn cg5_a_lens_without_inverse_says_so() {
    // r (1 - 0.3 r^2) never exceeds 0.703: nothing is seen beyond.
    let barrel = Distortion { k1: -0.3, ..NONE };
    let message = barrel.undistort(DVec2::new(0.8, 0.0)).unwrap_err().to_string();
    assert!(message.contains("no inverse at (0.8, 0)") && message.contains("-0.3"), "{message}");
    assert!(barrel.undistort(DVec2::new(0.69, 0.0)).is_ok(), "close to the fold, but before it");
    assert!(barrel.undistort(DVec2::new(f64::NAN, 0.0)).is_err());
    // The point with a singular Jacobian itself: r = sqrt(1 / 0.9).
    let fold = DVec2::new((1.0f64 / 0.9).sqrt(), 0.0);
    assert!(barrel.jacobian(fold).determinant().abs() < 1e-15);
    // A fold exactly at the point: its image is known, but the inverse can't be trusted.
    let touching = Distortion { k1: 0.5, k2: -0.5, ..NONE };
    assert_eq!(touching.distort(DVec2::Y), DVec2::Y);
    assert_eq!(touching.jacobian(DVec2::Y), DMat2::from_cols(DVec2::X, DVec2::ZERO));
    assert!(touching.undistort(DVec2::Y).is_err());
    // A third branch behind two folds, with a positive determinant, where the picture would be mirrored through the center.
    let behind = barrel.distort(DVec2::new(-2.5, 0.0));
    assert!(barrel.jacobian(DVec2::new(-2.5, 0.0)).determinant() > 0.0);
    assert!(barrel.undistort(behind).is_err());
    // r (1 - r^2 + 0.4 r^4) has its top at 0.707 and its bottom at 1: beyond, it grows again and Newton's method gets there.
    let twice = Distortion { k1: -1.0, k2: 0.4, ..NONE };
    let beyond = twice.distort(DVec2::new(0.0, 1.5));
    assert!(twice.jacobian(DVec2::new(0.0, 1.5)).determinant() > 0.0);
    assert!(twice.undistort(beyond).is_err(), "{:?}", twice.undistort(beyond));
    // A denominator that passes through 0 is as bad as a fold.
    let pole = Distortion { k4: -1.0, ..NONE };
    assert!(pole.undistort(pole.distort(DVec2::new(1.5, 0.0))).is_err());
}

/// LE2: steps of x' / radial(x) swing between two points about the right one; OpenCV's five end at 1.38656.
#[test]
fn a_strong_lens_without_a_fold_is_undone() {
    let strong = Distortion { k1: -0.45, k2: 0.25, ..NONE };
    let bent = strong.distort(DVec2::new(1.25, 0.0)).x;
    let step = |x: f64, _| bent / (1.0 - 0.45 * x * x + 0.25 * x.powi(4));
    let after = |steps: usize| (0..steps).fold(bent, step);
    assert!((after(5) - 1.38656).abs() < 5e-6, "{}", after(5));
    assert!((after(1000) - 1.0416).abs() < 5e-5 && (after(1001) - 1.4069).abs() < 5e-5, "{}", after(1000));
    assert!((strong.undistort(DVec2::new(bent, 0.0)).unwrap().x - 1.25).abs() < 1e-15);
}

#[test]
fn the_middle_stays() {
    let lens = Distortion { k1: -0.3, k2: 0.1, p1: 0.01, p2: -0.02, k3: 0.1, k4: 0.2, k5: 0.3, k6: 0.4 };
    assert_eq!((lens.distort(DVec2::ZERO), lens.undistort(DVec2::ZERO).unwrap()), (DVec2::ZERO, DVec2::ZERO));
    assert_eq!(lens.jacobian(DVec2::ZERO), DMat2::IDENTITY);
    let g = DVec2::new(1.0, -2.0);
    assert_eq!(backward::distort(&lens, DVec2::ZERO, g), (g, [0.0; 8]));
    assert_eq!(backward::undistort(&lens, DVec2::ZERO, g), (g, [-0.0; 8]));
}

proptest! {
    #![proptest_config(properties())]

    #[test]
    fn undistortion_undoes_distortion(lens in lens(), p in point()) {
        prop_assert!((lens.undistort(lens.distort(p)).unwrap() - p).length() < 1e-14);
        let target = p;
        prop_assert!((lens.distort(lens.undistort(target).unwrap()) - target).length() < 1e-15);
    }

    /// A lens that is turned with its points bends them alike: the radial factor has no direction.
    #[test]
    fn a_round_lens_has_no_direction(lens in lens(), p in point(), turn in 0.0..6.3) {
        let round = Distortion { p1: 0.0, p2: 0.0, ..lens };
        let rotation = DMat2::from_angle(turn);
        prop_assert!((round.distort(rotation * p) - rotation * round.distort(p)).length() < 1e-15);
    }

    #[test]
    fn gradients_are_those_of_differences(lens in lens(), p in point(), g in (-1.0..1.0, -1.0..1.0)) {
        let g = DVec2::new(g.0, g.1);
        let target = lens.distort(p);
        let (g_p, g_k) = backward::distort(&lens, p, g);
        let (g_target, g_inverse) = backward::undistort(&lens, p, g);
        for (axis, e) in [DVec2::X, DVec2::Y].into_iter().enumerate() {
            let forward = slope(|s| g.dot(lens.distort(p + 0.1 * s * e))) / 0.1;
            prop_assert!((forward - g_p[axis]).abs() < 1e-9, "{axis}: {forward} {g_p}");
            let inverse = slope(|s| g.dot(lens.undistort(target + 0.1 * s * e).unwrap())) / 0.1;
            prop_assert!((inverse - g_target[axis]).abs() < 1e-9, "{axis}: {inverse} {g_target}");
        }
        for n in 0..8 {
            let forward = slope(|s| g.dot(bent(&lens, n, s).distort(p)));
            prop_assert!((forward - g_k[n]).abs() < 1e-8, "{n}: {forward} {g_k:?}");
            let inverse = slope(|s| g.dot(bent(&lens, n, s).undistort(target).unwrap()));
            prop_assert!((inverse - g_inverse[n]).abs() < 1e-8, "{n}: {inverse} {g_inverse:?}");
        }
    }
}
