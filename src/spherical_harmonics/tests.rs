//! Closed forms and properties of the harmonics.

use std::f64::consts::PI;

use approx::assert_abs_diff_eq;

use super::{MAX_WIDTH, backward, harmonics};

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

#[test]
fn gradient_is_finite_differences() {
    let d = [0.48, -0.6, 0.64];
    let g: Vec<f64> = (0..MAX_WIDTH).map(|n| 1.0 - 0.07 * n as f64).collect();
    let loss = |d| harmonics(d, 4).iter().zip(&g).map(|(y, g)| y * g).sum::<f64>();
    for (a, slope) in backward::harmonics(d, 4, &g).into_iter().enumerate() {
        let at = |h: f64| std::array::from_fn(|b| if a == b { d[b] + h } else { d[b] });
        // Polynomials of degree 4: the central difference is off by h^2 times a third derivative of at most 100.
        assert_abs_diff_eq!(slope, (loss(at(1e-5)) - loss(at(-1e-5))) / 2e-5, epsilon = 1e-8);
    }
}
