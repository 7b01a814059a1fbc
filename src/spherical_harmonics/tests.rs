//! Closed forms and properties of the harmonics.

use std::f64::consts::PI;

use approx::assert_abs_diff_eq;

use super::{MAX_WIDTH, backward, harmonics as by_convention, polynomial};
use crate::convention::{HarmonicForm, HarmonicSign};

/// In the default conventions.
fn harmonics(d: [f64; 3], degree: usize) -> Vec<f64> {
    by_convention(d, degree, HarmonicForm::Sphere, HarmonicSign::Alternating)
}

/// A uniform grid in phi and a fine midpoint rule in z: Gauss-Legendre nodes would be fewer, but need a table.
pub(super) fn sphere(rings: usize, sectors: usize) -> Vec<[f64; 3]> {
    let point = |i: usize| {
        let z = -1.0 + (2.0 * (i / sectors) as f64 + 1.0) / rings as f64;
        let phi = 2.0 * PI * (i % sectors) as f64 / sectors as f64;
        let r = (1.0 - z * z).sqrt();
        [r * phi.cos(), r * phi.sin(), z]
    };
    (0..rings * sectors).map(point).collect()
}

/// The integral of Y_i Y_j over the sphere is 1 where i = j and 0 elsewhere. The midpoint rule's error falls like rings^-2.
#[test]
fn orthonormal() {
    let points = sphere(2000, 12);
    let mut gram = [[0.0; MAX_WIDTH]; MAX_WIDTH];
    for p in &points {
        let y = harmonics(*p, 4);
        for i in 0..MAX_WIDTH {
            for j in 0..MAX_WIDTH {
                gram[i][j] += y[i] * y[j] * 4.0 * PI / points.len() as f64;
            }
        }
    }
    for i in 0..MAX_WIDTH {
        for j in 0..MAX_WIDTH {
            assert_abs_diff_eq!(gram[i][j], f64::from(u8::from(i == j)), epsilon = 2e-5);
        }
    }
}

/// Closed forms of the first two bands, with the signs of the convention: neither lengths nor integrals show these.
#[test]
fn signs_are_those_of_the_convention() {
    let [x, y, z] = [0.6, 0.48, 0.64];
    let of = |n: f64| (n / PI).sqrt();
    let one = [-y, z, -x].map(|p| of(0.75) * p);
    let two = [x * y, -y * z, -x * z].map(|p| of(3.75) * p);
    let got = harmonics([x, y, z], 4);
    for (expected, n) in one.into_iter().chain(two).zip([1, 2, 3, 4, 5, 7]) {
        assert_abs_diff_eq!(got[n], expected, epsilon = 1e-15);
    }
}

/// Unsoeld's theorem: the squares of a band sum to (2 l + 1) / 4 pi in every direction.
#[test]
fn bands_have_constant_length() {
    for d in sphere(7, 5) {
        let y = harmonics(d, 4);
        for l in 0..5 {
            let sum: f64 = y[l * l..(l + 1) * (l + 1)].iter().map(|y| y * y).sum();
            assert_abs_diff_eq!(sum, (2 * l + 1) as f64 / (4.0 * PI), epsilon = 1e-14);
        }
    }
}

/// Band l has parity (-1)^l.
#[test]
fn parity() {
    let (a, b) = (harmonics([0.48, -0.6, 0.64], 4), harmonics([-0.48, 0.6, -0.64], 4));
    for l in 0..5 {
        for n in l * l..(l + 1) * (l + 1) {
            assert_eq!(a[n], if l % 2 == 0 { b[n] } else { -b[n] });
        }
    }
}

const FORMS: [HarmonicForm; 3] = [HarmonicForm::Sphere, HarmonicForm::Homogeneous, HarmonicForm::Normalized];

/// On the sphere all forms are one function; beside it they differ, but for the normalized one, which is constant along a ray.
#[test]
fn forms_agree_on_the_sphere() {
    for sign in [HarmonicSign::Alternating, HarmonicSign::Plain] {
        for d in sphere(7, 5) {
            let [sphere, homogeneous, normalized] = FORMS.map(|form| by_convention(d, 4, form, sign));
            for n in 0..MAX_WIDTH {
                assert_abs_diff_eq!(homogeneous[n], sphere[n], epsilon = 1e-14);
                assert_abs_diff_eq!(normalized[n], sphere[n], epsilon = 1e-14);
            }
        }
        let far = FORMS.map(|form| by_convention([1.2, -0.96, 1.28], 4, form, sign));
        let near = by_convention([0.6, -0.48, 0.64], 4, HarmonicForm::Normalized, sign);
        for n in [6, 11, 12, 13] {
            assert_abs_diff_eq!(far[2][n], near[n], epsilon = 1e-14);
            assert!((far[0][n] - far[1][n]).abs() > 0.1 && (far[1][n] - near[n]).abs() > 0.1);
        }
    }
}

/// Homogeneous of degree 2 and 3: twice the direction is 4 and 8 times the value.
#[test]
fn homogeneous_bands_scale() {
    let of =
        |s: f64| by_convention([0.5 * s, -0.25 * s, s], 3, HarmonicForm::Homogeneous, HarmonicSign::Plain);
    let (one, two) = (of(1.0), of(2.0));
    for n in 4..16 {
        assert_abs_diff_eq!(two[n], if n < 9 { 4.0 } else { 8.0 } * one[n], epsilon = 1e-14);
    }
}

/// Without the sign exactly those of odd m are turned: the index has the parity of m.
#[test]
fn plain_signs_turn_odd_orders() {
    let d = [0.48, -0.6, 0.64];
    let (a, b) = (harmonics(d, 4), by_convention(d, 4, HarmonicForm::Sphere, HarmonicSign::Plain));
    for n in 0..MAX_WIDTH {
        let odd = [1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23].contains(&n);
        assert_eq!(b[n], if odd { -a[n] } else { a[n] });
        assert_eq!(polynomial(n, HarmonicForm::Sphere, HarmonicSign::Alternating).1, 1.0);
    }
}

#[test]
fn gradient_is_finite_differences() {
    let d = [0.6, -0.75, 0.8];
    let g: Vec<f64> = (0..MAX_WIDTH).map(|n| 1.0 - 0.07 * n as f64).collect();
    for (form, sign) in
        FORMS.into_iter().zip([HarmonicSign::Alternating, HarmonicSign::Plain, HarmonicSign::Plain])
    {
        let loss = |d| by_convention(d, 4, form, sign).iter().zip(&g).map(|(y, g)| y * g).sum::<f64>();
        let gradient = backward::harmonics(d, 4, form, sign, &g);
        for (a, slope) in gradient.into_iter().enumerate() {
            let at = |h: f64| std::array::from_fn(|b| if a == b { d[b] + h } else { d[b] });
            // Polynomials of degree 4: the central difference is off by h^2 times a third derivative of at most a few 100.
            assert_abs_diff_eq!(slope, (loss(at(1e-5)) - loss(at(-1e-5))) / 2e-5, epsilon = 2e-8);
        }
        // Along d nothing changes where d is normalized.
        let radial: f64 = gradient.iter().zip(d).map(|(g, d)| g * d).sum();
        assert_eq!(form == HarmonicForm::Normalized, radial.abs() < 1e-12);
    }
}
