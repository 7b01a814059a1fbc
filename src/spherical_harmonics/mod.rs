//! Real spherical harmonics of a direction, bands 0 to 4: how a color varies with the direction it is seen from.
//!
//! Y_l^m(d) = K P_l^|m|(z) (cos or sin of m phi), as polynomials of x, y, z (Sloan, "Stupid Spherical Harmonics Tricks", 2008, A2).
//! Letters: `l` band, `m` order from -l to l; the value of (l, m) has the index l (l + 1) + m.

use crate::convention::{HarmonicForm, HarmonicSign};

pub(crate) mod arrays;
pub mod backward;
pub(crate) mod bound;
pub(crate) mod cases;
pub(crate) mod component;
#[cfg(feature = "fast")]
pub mod fast;
pub(crate) mod honest;
pub mod judge;
pub(crate) mod mistakes;

pub use judge::judge;

#[cfg(test)]
mod tests;

/// Largest number of values: bands 0 to 4.
pub const MAX_WIDTH: usize = 25;

/// One harmonic: the polynomial sum of `coefficient x^i y^j z^k` over its terms, on the unit sphere.
pub type Polynomial = &'static [(f64, [u32; 3])];

/// The harmonics as polynomials in x, y, z with the Condon-Shortley sign (-1)^m, in the order of their index.
///
/// Normalized so that the integral of Y^2 over the sphere is 1.
#[rustfmt::skip]
pub const POLYNOMIALS: [Polynomial; MAX_WIDTH] = [
    // l = 0: sqrt(1 / 4 pi).
    &[(0.282_094_791_773_878_14, [0, 0, 0])],
    // l = 1: sqrt(3 / 4 pi).
    &[(-0.488_602_511_902_919_9, [0, 1, 0])],
    &[(0.488_602_511_902_919_9, [0, 0, 1])],
    &[(-0.488_602_511_902_919_9, [1, 0, 0])],
    // l = 2: sqrt(15 / 4 pi), sqrt(5 / 16 pi), sqrt(15 / 16 pi).
    &[(1.092_548_430_592_079_2, [1, 1, 0])],
    &[(-1.092_548_430_592_079_2, [0, 1, 1])],
    &[(0.946_174_695_757_560_1, [0, 0, 2]), (-0.315_391_565_252_520_05, [0, 0, 0])],
    &[(-1.092_548_430_592_079_2, [1, 0, 1])],
    &[(0.546_274_215_296_039_6, [2, 0, 0]), (-0.546_274_215_296_039_6, [0, 2, 0])],
    // l = 3: sqrt(35 / 32 pi), sqrt(105 / 4 pi), sqrt(21 / 32 pi), sqrt(7 / 16 pi), sqrt(105 / 16 pi).
    &[(-1.770_130_769_779_930_5, [2, 1, 0]), (0.590_043_589_926_643_5, [0, 3, 0])],
    &[(2.890_611_442_640_554, [1, 1, 1])],
    &[(-2.285_228_997_322_329, [0, 1, 2]), (0.457_045_799_464_465_8, [0, 1, 0])],
    &[(1.865_881_662_950_577, [0, 0, 3]), (-1.119_528_997_770_346_2, [0, 0, 1])],
    &[(-2.285_228_997_322_329, [1, 0, 2]), (0.457_045_799_464_465_8, [1, 0, 0])],
    &[(1.445_305_721_320_277, [2, 0, 1]), (-1.445_305_721_320_277, [0, 2, 1])],
    &[(-0.590_043_589_926_643_5, [3, 0, 0]), (1.770_130_769_779_930_5, [1, 2, 0])],
    // l = 4: 3/4 sqrt(35 / pi), 3/4 sqrt(35 / 2 pi), 3/4 sqrt(5 / pi), 3/4 sqrt(5 / 2 pi), 3/16 sqrt(1 / pi), 3/8, 3/16 sqrt(35 / pi).
    &[(2.503_342_941_796_704_5, [3, 1, 0]), (-2.503_342_941_796_704_5, [1, 3, 0])],
    &[(-5.310_392_309_339_792, [2, 1, 1]), (1.770_130_769_779_930_5, [0, 3, 1])],
    &[(6.623222870302921, [1, 1, 2]), (-0.946_174_695_757_560_1, [1, 1, 0])],
    &[(-4.683_325_804_901_025, [0, 1, 3]), (2.007_139_630_671_868, [0, 1, 1])],
    &[(3.702_494_142_032_151, [0, 0, 4]), (-3.173_566_407_456_129_5, [0, 0, 2]), (0.317_356_640_745_612_9, [0, 0, 0])],
    &[(-4.683_325_804_901_025, [1, 0, 3]), (2.007_139_630_671_868, [1, 0, 1])],
    &[(3.3116114351514603, [2, 0, 2]), (-3.3116114351514603, [0, 2, 2]), (-0.473_087_347_878_780_06, [2, 0, 0]), (0.473_087_347_878_780_06, [0, 2, 0])],
    &[(-1.770_130_769_779_930_5, [3, 0, 1]), (5.310_392_309_339_792, [1, 2, 1])],
    &[(0.625_835_735_449_176_1, [4, 0, 0]), (-3.755_014_412_695_056_6, [2, 2, 0]), (0.625_835_735_449_176_1, [0, 4, 0])],
];

/// What the harmonics of these indices are with x^2 + y^2 + z^2 for 1, as PlenOctrees writes them.
#[rustfmt::skip]
const HOMOGENEOUS: [(usize, Polynomial); 4] = [
    (6, &[(0.630_783_130_505_040_1, [0, 0, 2]), (-0.315_391_565_252_520_05, [2, 0, 0]), (-0.315_391_565_252_520_05, [0, 2, 0])]),
    (11, &[(-1.828_183_197_857_863, [0, 1, 2]), (0.457_045_799_464_465_8, [2, 1, 0]), (0.457_045_799_464_465_8, [0, 3, 0])]),
    (12, &[(0.746_352_665_180_230_8, [0, 0, 3]), (-1.119_528_997_770_346_2, [2, 0, 1]), (-1.119_528_997_770_346_2, [0, 2, 1])]),
    (13, &[(-1.828_183_197_857_863, [1, 0, 2]), (0.457_045_799_464_465_8, [3, 0, 0]), (0.457_045_799_464_465_8, [1, 2, 0])]),
];

/// The harmonic of index n and the factor of its convention: its polynomial, and -1 where the sign of odd m is left out.
pub(crate) fn polynomial(n: usize, form: HarmonicForm, sign: HarmonicSign) -> (Polynomial, f64) {
    let mut polynomial = POLYNOMIALS[n];
    for (index, homogeneous) in HOMOGENEOUS {
        if index == n && form == HarmonicForm::Homogeneous {
            polynomial = homogeneous;
        }
    }
    // n = l (l + 1) + m, and l (l + 1) is even.
    let turned = n % 2 == 1 && sign == HarmonicSign::Plain;
    (polynomial, if turned { -1.0 } else { 1.0 })
}

/// The direction that is handed to the polynomials, and its length: 1 but where the convention normalizes.
pub(crate) fn normalized(d: [f64; 3], form: HarmonicForm) -> ([f64; 3], f64) {
    if form != HarmonicForm::Normalized {
        return (d, 1.0);
    }
    let length = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
    (d.map(|x| x / length), length)
}

/// x^n by repeated multiplication.
pub(crate) fn power(x: f64, n: u32) -> f64 {
    let mut product = 1.0;
    for _ in 0..n {
        product *= x;
    }
    product
}

/// The harmonics of bands 0 to `degree` (at most 4) of a unit direction.
///
/// # Shapes
/// `d` (3), result ((degree + 1)^2).
///
/// # Convention
/// `d` lies in [-1, 1]^3 and has length 1 (instant-ngp's code takes (d + 1) / 2 instead, PE7). Other lengths aren't normalized but in
/// [`HarmonicForm::Normalized`]: the polynomials are evaluated as they are. Instant-NGP's "degree 4" means four bands, 0 to 3: here that
/// is `degree` 3.
///
/// # Panics
/// Where `degree` is above 4.
///
/// ```
/// use nerf_oracle::convention::{HarmonicForm::Sphere, HarmonicSign::{Alternating, Plain}};
/// use nerf_oracle::spherical_harmonics::harmonics;
/// let y = harmonics([0.0, 0.0, 1.0], 1, Sphere, Alternating);
/// assert!((y[2] / y[0] - 3f64.sqrt()).abs() < 1e-15 && y[1] == 0.0 && y[3] == 0.0);
/// assert_eq!(harmonics([0.6, 0.0, 0.8], 1, Sphere, Plain)[3], -harmonics([0.6, 0.0, 0.8], 1, Sphere, Alternating)[3]);
/// ```
pub fn harmonics(d: [f64; 3], degree: usize, form: HarmonicForm, sign: HarmonicSign) -> Vec<f64> {
    let (d, _) = normalized(d, form);
    let mut out = vec![];
    for n in 0..(degree + 1) * (degree + 1) {
        let (polynomial, factor) = polynomial(n, form, sign);
        let mut value = 0.0;
        for &(coefficient, [i, j, k]) in polynomial {
            value += coefficient * power(d[0], i) * power(d[1], j) * power(d[2], k);
        }
        out.push(factor * value);
    }
    out
}
