//! Laws of the fisheye: which angle, of which radius, what is bent by which powers and coefficients, and what points are scaled by.

use glam::DVec2;

use super::super::arrays::coefficients;
use super::super::distort;
use crate::contract::arrays::Arrays;
use crate::contract::laws::{Guard, Laws};
use crate::convention::Conventions;
use crate::lens::arrays::forward;

/// How far a point is from the middle.
const RADIUS: [&str; 9] = [
    "sqrt(x^2 + y^2)",
    "x^2 + y^2",
    "sqrt(x^2 + y^2 + 1e-8)",
    "sqrt(x^2 + y^2 + 1e-12)",
    "sqrt(x^2 + y^2) + 1e-8",
    "sqrt(x^2 + y^2) + 1e-6",
    "max(1e-8, sqrt(x^2 + y^2))",
    "max(1e-6, sqrt(x^2 + y^2))",
    "|x| + |y|",
];

/// The angle.
const ANGLE: [&str; 12] = [
    "atan(r)",
    "r",
    "asin(r)",
    "sin(r)",
    "tan(r)",
    "2 atan(r / 2)",
    "2 atan(r)",
    "atan(r) in degrees",
    "atan(r^2)",
    "pi / 2 - atan(r)",
    "2 sin(atan(r) / 2)",
    "2 tan(atan(r) / 2)",
];

/// What y has that x hasn't.
const Y: [&str; 12] = [
    "as x",
    "k1 alone in y",
    "k1 and k2 alone in y",
    "k1, k2 and k3 alone in y",
    "no coefficients in y",
    "k1 alone in x",
    "k1 and k2 alone in x",
    "k1, k2 and k3 alone in x",
    "no coefficients in x",
    "y as it is",
    "x and y exchanged",
    "y turned over",
];

/// Which coefficients go with the first power, the second, ...
const READ: [([Option<usize>; 4], &str); 19] = [
    ([Some(0), Some(1), Some(2), Some(3)], "k1, k2, k3, k4"),
    ([Some(0), Some(1), Some(2), None], "k1, k2, k3, 0"),
    ([Some(0), Some(1), None, None], "k1, k2, 0, 0"),
    ([Some(0), None, None, None], "k1, 0, 0, 0"),
    ([Some(0), Some(1), None, Some(3)], "k1, k2, 0, k4"),
    ([Some(0), None, Some(2), Some(3)], "k1, 0, k3, k4"),
    ([None, Some(1), Some(2), Some(3)], "0, k2, k3, k4"),
    ([Some(0), Some(1), Some(2), Some(2)], "k1, k2, k3, k3"),
    ([Some(0), Some(1), Some(1), Some(3)], "k1, k2, k2, k4"),
    ([Some(0), Some(0), Some(2), Some(3)], "k1, k1, k3, k4"),
    ([Some(1), Some(1), Some(2), Some(3)], "k2, k2, k3, k4"),
    ([Some(0), Some(2), Some(2), Some(3)], "k1, k3, k3, k4"),
    ([Some(0), Some(1), Some(3), Some(3)], "k1, k2, k4, k4"),
    ([Some(0), Some(1), Some(3), Some(2)], "k1, k2, k4, k3"),
    ([Some(1), Some(0), Some(2), Some(3)], "k2, k1, k3, k4"),
    ([Some(0), Some(2), Some(1), Some(3)], "k1, k3, k2, k4"),
    ([Some(3), Some(2), Some(1), Some(0)], "k4, k3, k2, k1"),
    ([Some(1), Some(2), Some(3), None], "k2, k3, k4, 0"),
    ([None; 4], "0, 0, 0, 0"),
];

/// The powers that coefficients go with.
const POWERS: [([i32; 4], &str); 11] = [
    ([2, 4, 6, 8], "theta^2, theta^4, theta^6, theta^8"),
    ([1, 2, 3, 4], "theta, theta^2, theta^3, theta^4"),
    ([2, 4, 8, 16], "theta^2, theta^4, theta^8, theta^16"),
    ([1, 3, 5, 7], "theta, theta^3, theta^5, theta^7"),
    ([3, 5, 7, 9], "theta^3, theta^5, theta^7, theta^9"),
    ([2, 3, 4, 5], "theta^2, theta^3, theta^4, theta^5"),
    ([0, 2, 4, 6], "1, theta^2, theta^4, theta^6"),
    ([4, 6, 8, 10], "theta^4, theta^6, theta^8, theta^10"),
    ([2, 4, 6, 6], "theta^2, theta^4, theta^6, theta^6"),
    ([2, 4, 6, 8], "r^2, r^4, r^6, r^8"),
    ([1, 2, 3, 4], "r, r^2, r^3, r^4"),
];

/// The first of the powers that are r's.
const OF_RADIUS: usize = 9;

/// What points are multiplied with; P = 1 + k1 theta^2 + ...
const SCALE: [&str; 14] = [
    "theta P / r",
    "P",
    "P / r",
    "theta P",
    "P - 1 + theta / r",
    "(theta + P - 1) / r",
    "theta P / r^2",
    "theta / (r P)",
    "1 / P",
    "r / (theta P)",
    "r P",
    "theta P / sqrt(1 + r^2)",
    "tan(theta P) / r",
    "sin(theta P) / r",
];

/// What is done near the middle; behind these, what keeps a divisor off 0.
const MIDDLE: [&str; 8] = [
    "(x, y) where r = 0",
    "the formula where r = 0, too",
    "(x, y) where r < 1e-8",
    "(x, y) where r < 1e-6",
    "(x, y) where r < 1e-3",
    "(x, y) where r < 1e-2",
    "(0, 0) where r < 1e-6",
    "(0, 0) where r < 1e-3",
];

/// What keeps it off.
const DIVISOR: [Guard; 6] = [
    Guard::Plus(1e-8),
    Guard::Plus(1e-6),
    Guard::Plus(1e-10),
    Guard::Plus(1e-12),
    Guard::AtLeast(1e-8),
    Guard::AtLeast(1e-6),
];

/// Those of a fisheye.
pub(crate) const OF_FISHEYES: Laws = Laws {
    choices: &[
        RADIUS.len(),
        ANGLE.len(),
        Y.len(),
        READ.len(),
        POWERS.len(),
        MIDDLE.len() + DIVISOR.len(),
        SCALE.len(),
    ],
    says: |part, choice| match part {
        0 => format!("r = {}", RADIUS[choice]),
        1 => format!("theta = {}", ANGLE[choice]),
        2 => Y[choice].into(),
        3 => format!("coefficients {}", READ[choice].1),
        4 => format!("powers {}", POWERS[choice].1),
        5 => match MIDDLE.get(choice) {
            Some(said) => (*said).into(),
            None => format!("{} in the place of a divisor x", DIVISOR[choice - MIDDLE.len()].said("x")),
        },
        _ => format!("(x', y') = {} (x, y) with P = 1 + k1 theta^2 + ...", SCALE[choice]),
    },
    of,
    rounding: &[],
};

fn radius(p: DVec2, choice: usize) -> f64 {
    let (square, r) = (p.length_squared(), p.length());
    match choice {
        1 => square,
        2 => (square + 1e-8).sqrt(),
        3 => (square + 1e-12).sqrt(),
        4 => r + 1e-8,
        5 => r + 1e-6,
        6 => r.max(1e-8),
        7 => r.max(1e-6),
        8 => p.x.abs() + p.y.abs(),
        _ => r,
    }
}

fn angle(r: f64, choice: usize) -> f64 {
    let theta = libm::atan(r);
    match choice {
        1 => r,
        2 => libm::asin(r),
        3 => libm::sin(r),
        4 => libm::tan(r),
        5 => 2.0 * libm::atan(0.5 * r),
        6 => 2.0 * theta,
        7 => theta.to_degrees(),
        8 => libm::atan(r * r),
        9 => std::f64::consts::FRAC_PI_2 - theta,
        10 => 2.0 * libm::sin(0.5 * theta),
        11 => 2.0 * libm::tan(0.5 * theta),
        _ => theta,
    }
}

/// What is divided by, kept off 0.
fn divisor(r: f64, choice: usize) -> f64 {
    choice.checked_sub(MIDDLE.len()).map_or(r, |n| DIVISOR[n].of(r))
}

/// What a coordinate is multiplied with, by these coefficients.
fn scale(k: [f64; 4], r: f64, law: &[usize]) -> f64 {
    let theta = angle(r, law[1]);
    let of = if law[4] < OF_RADIUS { theta } else { r };
    let bends: f64 = k.iter().zip(POWERS[law[4]].0).map(|(k, power)| k * of.powi(power)).sum();
    let (p, over) = (1.0 + bends, |x: f64| divisor(x, law[5]));
    match law[6] {
        1 => p,
        2 => p / over(r),
        3 => theta * p,
        4 => bends + theta / over(r),
        5 => (theta + bends) / over(r),
        6 => theta * p / over(r * r),
        7 => theta / over(r * p),
        8 => 1.0 / over(p),
        9 => r / over(theta * p),
        10 => r * p,
        11 => theta * p / (1.0 + r * r).sqrt(),
        12 => libm::tan(theta * p) / over(r),
        13 => libm::sin(theta * p) / over(r),
        _ => theta * p / over(r),
    }
}

/// What a point is near the middle, where that is something of its own.
fn middle(p: DVec2, r: f64, choice: usize) -> Option<DVec2> {
    let below = |limit: f64, own: DVec2| (r < limit).then_some(own);
    match choice {
        0 => (r == 0.0).then_some(p),
        2 => below(1e-8, p),
        3 => below(1e-6, p),
        4 => below(1e-3, p),
        5 => below(1e-2, p),
        6 => below(1e-6, DVec2::ZERO),
        7 => below(1e-3, DVec2::ZERO),
        _ => None,
    }
}

fn landed(k: [f64; 4], p: DVec2, law: &[usize]) -> DVec2 {
    if law.iter().all(|choice| *choice == 0) {
        return distort(k, p);
    }
    let r = radius(p, law[0]);
    if let Some(own) = middle(p, r, law[5]) {
        return own;
    }
    let read = READ[law[3]].0.map(|place| place.map_or(0.0, |n| k[n]));
    let first = |n: usize| [0, 1, 2, 3].map(|place| if place < n { read[place] } else { 0.0 });
    // How many coefficients x has, and y.
    let [in_x, in_y] = match law[2] {
        n @ 1..=3 => [4, n],
        4 => [4, 0],
        n @ 5..=7 => [n - 4, 4],
        8 => [0, 4],
        _ => [4, 4],
    };
    let [x, y] = [p.x * scale(first(in_x), r, law), p.y * scale(first(in_y), r, law)];
    match law[2] {
        9 => DVec2::new(x, p.y),
        10 => DVec2::new(y, x),
        11 => DVec2::new(x, -y),
        _ => DVec2::new(x, y),
    }
}

fn of(a: &Arrays, _: &Conventions, law: &[usize]) -> Arrays {
    let k = coefficients(a);
    forward(a, "points", "distorted", |p| landed(k, p.into(), law).to_array())
}
