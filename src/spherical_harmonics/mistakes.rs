//! Spherical harmonics, wrong on purpose. Without a mistake every function equals the oracle.

use std::f64::consts::SQRT_2;

use super::arrays::{degree, forward, vjp};
use super::{backward, polynomial, power};
use crate::contract::arrays::Arrays;
use crate::contract::component::Mistake;
use crate::convention::{Conventions, HarmonicSign};

const FIRST_CONSTANT: Mistake = Mistake::new(
    "constant_of_band_0",
    "another constant in the place of 1/2 sqrt(1/pi)",
    "colors too strong or too faint from all sides",
    "0.28209479177387814",
    "never; cheap to keep",
    0,
)
.with("c", 0.886226925452758, [0.01, 10.0]);
const SECOND_CONSTANT: Mistake = Mistake::new(
    "constant_of_band_1",
    "another constant in the place of sqrt(3/(4 pi))",
    "band 1 too strong or too faint",
    "0.4886025119029199",
    "never; cheap to keep",
    0,
)
.with("c", 0.345494149471335, [0.01, 10.0]);
const THIRD_CONSTANT: Mistake = Mistake::new(
    "constant_of_the_zonal",
    "another constant in the place of 1/4 sqrt(5/pi), of 3 z^2 - 1",
    "band 2 isn't orthonormal",
    "0.31539156525252005",
    "never; cheap to keep",
    0,
)
.with("c", 0.15769578262626002, [0.01, 10.0]);

const ONE_OTHER: Mistake = Mistake::new(
    "one_harmonic_mistyped",
    "one of the functions is another one, and all the others are right",
    "one coefficient in so many leans the wrong way",
    "compare this one with its polynomial, sign and constant",
    "typed tables of polynomials: 7 z^2 - 3 for 7 z^2 - 1, + for -, a constant of another row",
    2,
)
.with("n", 4.0, [1.0, 24.0])
.or(&ALL)
.open_where_nan();
const ALL: [f64; super::MAX_WIDTH] = {
    let mut all = [0.0; super::MAX_WIDTH];
    let mut n = 0;
    while n < super::MAX_WIDTH {
        all[n] = n as f64;
        n += 1;
    }
    all
};

/// Mistakes of the spherical harmonics.
pub(crate) const SPHERICAL_HARMONICS: &[Mistake] = &[
    Mistake::new(
        "directions_in_unit_cube",
        "(d + 1) / 2 is handed to polynomials that want d in [-1, 1]",
        "the harmonics of another direction, far from orthonormal",
        "hand over the unit direction itself, or undo the shift inside",
        "instant-ngp's and tiny-cuda-nn's input range, ported without the shift",
        2,
    ),
    Mistake::new(
        "band_1_signs",
        "the signs of x and y in band 1 are those of the other convention, all other bands' are not",
        "a picture's sheen leans to the other side in one band of five",
        "one convention for all bands: (-1)^m, or none",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "band_4_slips",
        "two slips in band 4: m = -1 lacks its z, and m = 4 has the constant 0.4425 for 0.6258",
        "degree 4 isn't orthonormal: two colors of 25 lean the wrong way",
        "0.669 y z (7 z^2 - 3), and 0.6258 (x^2 (x^2 - 3 y^2) - y^2 (3 x^2 - y^2))",
        "older versions of nerfstudio's utils/math.py and copies of it; 1.1.5 has it right",
        1,
    ),
    Mistake::new(
        "root_of_two_forgotten",
        "harmonics with m other than 0 without sqrt(2): the complex ones' constants",
        "a basis that isn't orthonormal",
        "sqrt(2) times real or imaginary part",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "cosines_for_sines",
        "|m| for m: cosines in the place of sines",
        "two of each pair are the same: colors can't depend on the sign of y",
        "sin(|m| phi) where m < 0",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "last_band_left_out",
        "0 for the last band",
        "colors change less with the direction than they could",
        "all (degree + 1)^2",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "m_descending",
        "within a band from m = l down to -l",
        "x and y exchange their places in band 1",
        "m ascending: y, z, x",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "polar_axis_y",
        "y and z exchanged: the pole along y, as in graphics texts",
        "harmonics of the turned direction",
        "the pole along z",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "turned_to_polar_axis_y",
        "x, y, z taken for y, z, x: the pole along y, angles about it from z",
        "harmonics of the turned direction",
        "the pole along z, angles from x",
        "1 public implementation, whose pictures have y up",
        1,
    ),
    Mistake::new(
        "power_rule_forgotten",
        "the gradient of x^n is x^(n-1), without n",
        "gradients of directions too small from band 2 on",
        "n x^(n-1)",
        "hand-written backward passes",
        0,
    )
    .of_gradient(),
    FIRST_CONSTANT,
    SECOND_CONSTANT,
    THIRD_CONSTANT,
    ONE_OTHER,
    Mistake::new(
        "bands_of_irradiance",
        "bands times pi, 2 pi / 3, pi / 4, 0, -pi / 24: the factors of diffuse light",
        "high bands too faint",
        "the harmonics as they are",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "third_and_fourth_band_left_out",
        "0 from band 3 on",
        "colors change less with the direction than they could",
        "all (degree + 1)^2",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "band_1_by_axes",
        "band 1 as x, y, z",
        "coefficients of other programs, and of one's own bands above, belong to other axes",
        "y, z, x: m ascending",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "zonal_twice_for_thrice",
        "2 z^2 - 1 for 3 z^2 - 1 in band 2",
        "band 2 isn't orthonormal",
        "3 z^2 - 1, or 2 z^2 - x^2 - y^2",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "constants_forgotten",
        "1, y, z, x, x y, 3 z^2 - 1, ...: polynomials without their constants",
        "a basis that isn't orthonormal: bands weigh otherwise than a trained model's coefficients ask for",
        "each with its constant: 0.28, 0.49, 1.09, 0.32, ...",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "last_of_band_2_added",
        "x^2 + y^2 for x^2 - y^2 in band 2",
        "two of its functions are nearly one",
        "x^2 - y^2",
        "never; cheap to keep",
        0,
    ),
];

/// What stands before the polynomials as they are usually written: x y, 3 z^2 - 1, x^2 - y^2, 5 z^3 - 3 z, ...
#[rustfmt::skip]
const CONSTANTS: [f64; super::MAX_WIDTH] = [
    0.282_094_791_773_878_14,
    0.488_602_511_902_919_9, 0.488_602_511_902_919_9, 0.488_602_511_902_919_9,
    1.092_548_430_592_079_2, 1.092_548_430_592_079_2, 0.315_391_565_252_520_05, 1.092_548_430_592_079_2, 0.546_274_215_296_039_6,
    0.590_043_589_926_643_5, 2.890_611_442_640_554, 0.457_045_799_464_465_8, 0.373_176_332_590_115_4, 0.457_045_799_464_465_8,
    1.445_305_721_320_277, 0.590_043_589_926_643_5,
    2.503_342_941_796_704_5, 1.770_130_769_779_930_5, 0.946_174_695_757_560_1, 0.669_046_543_557_289_2, 0.105_785_546_915_204_3,
    0.669_046_543_557_289_2, 0.473_087_347_878_780_06, 1.770_130_769_779_930_5, 0.625_835_735_449_176_1,
];

/// Spherical harmonics.
pub(crate) fn harmonics(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    forward(a, |mut d| {
        if wrong.contains(&"directions_in_unit_cube") {
            d = d.map(|x| 0.5 * (x + 1.0));
        }
        if wrong.contains(&"polar_axis_y") {
            d.swap(1, 2);
        }
        if wrong.contains(&"turned_to_polar_axis_y") {
            d.rotate_right(1);
        }
        let mut out = super::harmonics(d, degree(a), c.harmonic_form, c.harmonic_sign);
        if wrong.contains(&"band_4_slips") && degree(a) == 4 {
            let sign = if c.harmonic_sign == HarmonicSign::Plain { 1.0 } else { -1.0 };
            out[19] = sign * 0.669_046_543_557_289_2 * d[1] * (7.0 * d[2] * d[2] - 3.0);
            out[24] *= 0.442_532_692_444_982_6 / 0.625_835_735_449_176_1;
        }
        if wrong.contains(&"band_1_signs") && degree(a) > 0 {
            (out[1], out[3]) = (-out[1], -out[3]);
        }
        let scaled = [
            (&FIRST_CONSTANT, 0, 1, 0.282_094_791_773_878_14),
            (&SECOND_CONSTANT, 1, 4, 0.488_602_511_902_919_9),
            (&THIRD_CONSTANT, 6, 7, 0.315_391_565_252_520_05),
        ];
        for (mistake, first, end, right) in scaled {
            if let Some(constant) = mistake.among(wrong) {
                out.iter_mut().take(end).skip(first).for_each(|y| *y *= constant / right);
            }
        }
        if wrong.contains(&"band_1_by_axes") && degree(a) > 0 {
            let (y, z, x) = (out[1], out[2], out[3]);
            out[1..4].copy_from_slice(&[x, y, z]);
        }
        if wrong.contains(&"zonal_twice_for_thrice") && degree(a) > 1 {
            out[6] = 0.315_391_565_252_520_05 * (2.0 * d[2] * d[2] - 1.0);
        }
        if wrong.contains(&"last_of_band_2_added") && degree(a) > 1 {
            out[8] = 0.546_274_215_296_039_6 * (d[0] * d[0] + d[1] * d[1]);
        }
        if wrong.contains(&"constants_forgotten") {
            out.iter_mut().zip(CONSTANTS).for_each(|(y, constant)| *y /= constant);
        }
        for l in 0..=degree(a) {
            let middle = l * l + l;
            for m in 1..=l {
                if wrong.contains(&"root_of_two_forgotten") {
                    (out[middle - m], out[middle + m]) = (out[middle - m] / SQRT_2, out[middle + m] / SQRT_2);
                }
                if wrong.contains(&"cosines_for_sines") {
                    out[middle - m] = out[middle + m];
                }
            }
        }
        if wrong.contains(&"last_band_left_out") && degree(a) > 0 {
            out[degree(a) * degree(a)..].fill(0.0);
        }
        if wrong.contains(&"third_and_fourth_band_left_out") {
            out.iter_mut().skip(9).for_each(|y| *y = 0.0);
        }
        if wrong.contains(&"bands_of_irradiance") {
            let pi = std::f64::consts::PI;
            let factor = |n: usize| match n {
                0 => pi,
                1..4 => 2.0 * pi / 3.0,
                4..9 => 0.25 * pi,
                9..16 => 0.0,
                _ => -pi / 24.0,
            };
            out.iter_mut().enumerate().for_each(|(n, y)| *y *= factor(n));
        }
        if let Some(y) = ONE_OTHER.among(wrong).and_then(|n| out.get_mut(n as usize)) {
            *y = f64::NAN;
        }
        if wrong.contains(&"m_descending") {
            (0..=degree(a)).for_each(|l| out[l * l..(l + 1) * (l + 1)].reverse());
        }
        out
    })
}

/// Their gradient.
pub(crate) fn harmonics_vjp(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let (form, sign) = (c.harmonic_form, c.harmonic_sign);
    if !wrong.contains(&"power_rule_forgotten") {
        return vjp(a, |d, g| backward::harmonics(d, degree(a), form, sign, g));
    }
    vjp(a, |d, g| {
        let mut g_d = [0.0; 3];
        for (n, g) in g.iter().enumerate() {
            let (polynomial, factor) = polynomial(n, form, sign);
            for &(coefficient, exponents) in polynomial {
                for axis in (0..3).filter(|&axis| exponents[axis] > 0) {
                    let mut lowered = exponents;
                    lowered[axis] -= 1;
                    let product: f64 = (0..3).map(|b| power(d[b], lowered[b])).product();
                    g_d[axis] += g * factor * coefficient * product;
                }
            }
        }
        g_d
    })
}
