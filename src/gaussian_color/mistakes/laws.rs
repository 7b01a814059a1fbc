//! Laws of a splat's color: from where it is seen, which harmonics, how many of them, and what is made of their sum.

use super::super::arrays::{form, forward};
use super::super::{Form, color as oracle, degree, direction, sum};
use crate::contract::laws::Laws;
use crate::convention::{HarmonicForm, HarmonicSign, SplatColor};
use crate::field::sigmoid;
use crate::spherical_harmonics::harmonics;

/// The direction.
const SEEN: [&str; 10] = [
    "from the camera to the splat",
    "from the splat to the camera",
    "from the camera to the splat, not normalized",
    "from the splat to the camera, not normalized",
    "to the splat from the world's origin",
    "to the camera from the world's origin",
    "with x and y exchanged",
    "with y and z exchanged",
    "with x, y, z taken for z, x, y",
    "with x, y, z taken for y, z, x",
];

/// The harmonics.
const HARMONICS: [&str; 7] = [
    "as they are",
    "with the other sign where m is odd",
    "without their constants",
    "with y and z exchanged in the polynomials",
    "of the first band all one",
    "with the first band's constant for all",
    "with their polynomials divided by their constants",
];

/// What makes the polynomials of the first four bands of unit length, as one writes them: y, z, x; xy, yz, 3 z^2 - 1, xz, x^2 - y^2; ...
const CONSTANTS: [f64; 16] = [
    0.282_094_791_773_878_14,
    0.488_602_511_902_919_9,
    0.488_602_511_902_919_9,
    0.488_602_511_902_919_9,
    1.092_548_430_592_079_2,
    1.092_548_430_592_079_2,
    0.315_391_565_252_520_05,
    1.092_548_430_592_079_2,
    0.546_274_215_296_039_6,
    0.590_043_589_926_643_5,
    2.890_611_442_640_554,
    0.457_045_799_464_465_8,
    0.373_176_332_590_115_4,
    0.457_045_799_464_465_8,
    1.445_305_721_320_277,
    0.590_043_589_926_643_5,
];

/// How many bands.
const BANDS: [&str; 5] = ["all", "the first alone", "two", "three", "the first two alone but for red"];

/// What is made of the sum.
const MADE: [&str; 12] = [
    "as it is by convention",
    "s",
    "s + 1/2",
    "max(0, s + 1/2)",
    "s + 1/2 held between 0 and 1",
    "s held between 0 and 1",
    "max(0, s)",
    "sigmoid(s)",
    "sigmoid(s + 1/2)",
    "|s + 1/2|",
    "min(1, s + 1/2)",
    "max(0, s + 1/2)^2.2",
];

/// Where a channel's coefficients are.
const LAID: [&str; 4] = [
    "k, channel",
    "channel after channel",
    "channels from the last to the first",
    "the k-th number of all for every channel, from the third band on",
];

/// The part that is the sign of harmonic 1, y in the polynomials; those of the others follow.
const SIGNS: usize = 5;

/// The choices of each part; a sign has two.
const CHOICES: [usize; SIGNS + 15] = {
    let mut choices = [2; SIGNS + 15];
    choices[0] = SEEN.len();
    choices[1] = HARMONICS.len();
    choices[2] = BANDS.len();
    choices[3] = MADE.len();
    choices[4] = LAID.len();
    choices
};

/// Those of a splat.
pub(crate) const OF_SPLATS: Laws = Laws {
    choices: &CHOICES,
    says: |part, choice| match part {
        0 => format!("direction {}", SEEN[choice]),
        1 => format!("harmonics {}", HARMONICS[choice]),
        2 => format!("bands: {}", BANDS[choice]),
        3 => format!("color = {}", MADE[choice]),
        4 => format!("coefficients laid by {}", LAID[choice]),
        _ => format!("the other sign of harmonic {}", part - SIGNS + 1),
    },
    of: |a, c, law| forward(a, |mean, center, f| of(mean, center, f, form(c), law)),
    rounding: &[],
};

fn seen(mean: [f64; 3], center: [f64; 3], choice: usize) -> [f64; 3] {
    let [x, y, z] = direction(mean, center);
    match choice {
        1 | 3 => [-x, -y, -z],
        4 => mean,
        5 => center,
        6 => [y, x, z],
        7 => [x, z, y],
        8 => [z, x, y],
        9 => [y, z, x],
        _ => [x, y, z],
    }
}

fn basis(d: [f64; 3], degree: usize, normalized: HarmonicForm, form: Form, choice: usize) -> Vec<f64> {
    let other = match form.sign {
        HarmonicSign::Alternating => HarmonicSign::Plain,
        _ => HarmonicSign::Alternating,
    };
    let sign = if choice == 1 { other } else { form.sign };
    let d = if choice == 3 { [d[0], d[2], d[1]] } else { d };
    let mut y = harmonics(d, degree, normalized, sign);
    match choice {
        // The polynomials as one writes them, without what makes them of unit length.
        2 => y.iter_mut().zip(CONSTANTS).for_each(|(y, constant)| *y /= constant),
        4 => y[0] = 1.0,
        5 => y.iter_mut().zip(CONSTANTS).for_each(|(y, constant)| *y *= CONSTANTS[0] / constant),
        6 => y.iter_mut().zip(CONSTANTS).for_each(|(y, constant)| *y /= constant * constant),
        _ => {}
    }
    y
}

fn made(s: f64, choice: usize) -> f64 {
    match choice {
        1 => s,
        2 => s + 0.5,
        3 => (s + 0.5).max(0.0),
        4 => (s + 0.5).clamp(0.0, 1.0),
        5 => s.clamp(0.0, 1.0),
        6 => s.max(0.0),
        7 => sigmoid(s),
        8 => sigmoid(s + 0.5),
        9 => (s + 0.5).abs(),
        10 => (s + 0.5).min(1.0),
        _ => crate::math::pow((s + 0.5).max(0.0), 2.2),
    }
}

fn of(mean: [f64; 3], center: [f64; 3], f: &[[f64; 3]], form: Form, law: &[usize]) -> [f64; 3] {
    if law.iter().all(|choice| *choice == 0) {
        return oracle(mean, center, f, form);
    }
    let normalized =
        if matches!(law[0], 2 | 3) { HarmonicForm::Homogeneous } else { HarmonicForm::Normalized };
    let mut y = basis(seen(mean, center, law[0]), degree(f), normalized, form, law[1]);
    y.iter_mut().skip(1).zip(&law[SIGNS..]).filter(|(_, other)| **other == 1).for_each(|(y, _)| *y = -*y);
    let flat: Vec<f64> = f.iter().flatten().copied().collect();
    let k = f.len();
    let f: Vec<[f64; 3]> = match law[4] {
        1 => (0..k).map(|n| [flat[n], flat[k + n], flat[2 * k + n]]).collect(),
        2 => f.iter().map(|[r, g, b]| [*b, *g, *r]).collect(),
        3 => f.iter().enumerate().map(|(n, f)| if n < 4 { *f } else { [flat[n]; 3] }).collect(),
        _ => f.to_vec(),
    };
    let kept = [k, 1, 4, 9, k][law[2]];
    let whole = sum(&y, &f);
    y.iter_mut().skip(if law[2] == 4 { 4 } else { kept }).for_each(|y| *y = 0.0);
    let mut s = sum(&y, &f);
    if law[2] == 4 {
        s[0] = whole[0];
    }
    let own = |s: f64| match form.color {
        SplatColor::Clamped => made(s, 3),
        SplatColor::Shifted => made(s, 2),
        SplatColor::Sum => s,
    };
    s.map(|s| if law[3] == 0 { own(s) } else { made(s, law[3]) })
}
