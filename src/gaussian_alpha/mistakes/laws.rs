//! Laws of a splat's opacity at a pixel: how far away the pixel is, how the splat falls off, where it ends, and how much of it is left.

use super::super::arrays::{form, forward};
use super::super::{Form, Splat, alpha as oracle, cap, offset, skipped};
use crate::contract::laws::Laws;
use crate::field::sigmoid;
use crate::math::exp;

/// How far away a pixel is.
const FAR: [&str; 9] = [
    "A dx^2 + 2 B dx dy + C dy^2",
    "A dx^2 + B dx dy + C dy^2",
    "A dx^2 + C dy^2",
    "A dx^2 - 2 B dx dy + C dy^2",
    "C dx^2 + 2 B dx dy + A dy^2",
    "A dx^2 + 4 B dx dy + C dy^2",
    "dx^2 + dy^2",
    "A |dx| + 2 B dx dy + C |dy|",
    "dx^2 / xx + dy^2 / yy, of the covariance's diagonal",
];

/// From where.
const FROM: [&str; 4] = [
    "the mean",
    "the mean rounded down",
    "the mean rounded to whole pixels",
    "the mean cut off to whole pixels",
];

/// How the splat falls off.
const FALL: [&str; 12] = [
    "exp(-q / 2)",
    "exp(-q)",
    "exp(-2 q)",
    "exp(-sqrt(q))",
    "exp(-sqrt(q) / 2)",
    "1 / (1 + q)",
    "max(0, 1 - q)",
    "max(0, 1 - q / 9)",
    "exp(-q / 2) max(0, 1 - (q / 9)^2)",
    "exp(-q / 2) max(0, 1 - q / 9)",
    "exp(q / 2)",
    "exp(-q / 4)",
];

/// Where it ends.
const END: [&str; 20] = [
    "as it does by convention",
    "where q > 9",
    "where q > 8",
    "where q > 4",
    "where q > 1",
    "where q > 16",
    "where q > 20",
    "outside of the square of three deviations of its long axis",
    "outside of the disc of three deviations of its long axis",
    "outside of the box of three deviations along x and y",
    "where exp(-q / 2) < 1 / 255",
    "where its opacity is below 1 / 255",
    "where q > 0",
    "where q <= 0",
    "where |dx| > 3 or |dy| > 3",
    "where dx^2 + dy^2 > 9",
    "outside of the box of whole pixels about the square of three deviations of its long axis",
    "outside of the box of whole pixels about the square of three deviations along x and y",
    "where q < 8",
    "outside of r = int(3 sqrt(lambda)) + 1 whole pixels about the mean's own, lambda the larger variance",
];

/// What it is multiplied with.
const TIMES: [&str; 7] =
    ["o", "1", "o^2", "sigmoid(o)", "o / (2 pi sqrt(det))", "o / (2 pi)", "o sqrt(A C - B^2)"];

/// The most that is left.
const MOST: [&str; 6] = ["as it is by convention", "0.95", "0.9999", "1", "0.5", "0.98"];

/// What is added to the variances before all that.
const ADDED: [&str; 5] = ["nothing", "1e-6", "1e-4", "0.3", "0.1"];

/// Those of a pixel and a splat.
pub(crate) const OF_PIXELS: Laws = Laws {
    choices: &[FAR.len(), FALL.len(), END.len(), TIMES.len(), MOST.len(), FROM.len(), ADDED.len()],
    says: |part, choice| match part {
        0 => format!("q = {}", FAR[choice]),
        1 => format!("{} in the place of exp(-q / 2)", FALL[choice]),
        2 => format!("0 {}", END[choice]),
        3 => format!("times {} in the place of o", TIMES[choice]),
        4 => format!("at most {}", MOST[choice]),
        5 => format!("dx and dy from {}", FROM[choice]),
        _ => format!("{} added to the variances of its conic", ADDED[choice]),
    },
    of: |a, c, law| forward(a, |pixel, splat| of(pixel, splat, form(c), law)),
    rounding: &[(5, 1), (5, 2), (5, 3)],
};

/// The conic of variances with `h` more.
fn dilated([a, b, c]: [f64; 3], h: f64) -> [f64; 3] {
    if h == 0.0 {
        return [a, b, c];
    }
    // The inverse of the inverse and h: over 1 + h (a + c) + h^2 det.
    let det = a * c - b * b;
    let over = 1.0 + h * (a + c) + h * h * det;
    [(a + h * det) / over, b / over, (c + h * det) / over]
}

fn of(pixel: [f64; 2], splat: &Splat, form: Form, law: &[usize]) -> f64 {
    if law.iter().all(|choice| *choice == 0) {
        return oracle(pixel, splat, form);
    }
    let mean = match law[5] {
        0 => splat.mean,
        1 => splat.mean.map(f64::floor),
        2 => splat.mean.map(f64::round),
        _ => splat.mean.map(f64::trunc),
    };
    let [x, y] = offset(pixel, &Splat { mean, ..*splat });
    let [a, b, c] = dilated(splat.conic, [0.0, 1e-6, 1e-4, 0.3, 0.1][law[6]]);
    let det = a * c - b * b;
    // The variances are the conic's inverse.
    let [xx, yy] = [c / det, a / det];
    let q = match law[0] {
        1 => a * x * x + b * x * y + c * y * y,
        2 => a * x * x + c * y * y,
        3 => a * x * x - 2.0 * b * x * y + c * y * y,
        4 => c * x * x + 2.0 * b * x * y + a * y * y,
        5 => a * x * x + 4.0 * b * x * y + c * y * y,
        6 => x * x + y * y,
        7 => a * x.abs() + 2.0 * b * x * y + c * y.abs(),
        8 => x * x / xx + y * y / yy,
        _ => a * x * x + 2.0 * b * x * y + c * y * y,
    };
    let gaussian = exp(-0.5 * q);
    let fall = match law[1] {
        0 => gaussian,
        1 => exp(-q),
        2 => exp(-2.0 * q),
        3 => exp(-q.max(0.0).sqrt()),
        4 => exp(-0.5 * q.max(0.0).sqrt()),
        5 => 1.0 / (1.0 + q),
        6 => (1.0 - q).max(0.0),
        7 => (1.0 - q / 9.0).max(0.0),
        8 => gaussian * (1.0 - q * q / 81.0).max(0.0),
        9 => gaussian * (1.0 - q / 9.0).max(0.0),
        10 => exp(0.5 * q),
        _ => exp(-0.25 * q),
    };
    let long = 0.5 * (xx + yy) + (0.25 * (xx - yy) * (xx - yy) + b * b / (det * det)).sqrt();
    let reach = 3.0 * long.max(0.0).sqrt();
    let boxed = |reach: [f64; 2]| {
        let beyond =
            |n: usize| pixel[n] < (mean[n] - reach[n]).floor() || pixel[n] > (mean[n] + reach[n]).ceil();
        beyond(0) || beyond(1)
    };
    let ended = match law[2] {
        0 => false,
        1 => q > 9.0,
        2 => q > 8.0,
        3 => q > 4.0,
        4 => q > 1.0,
        5 => q > 16.0,
        6 => q > 20.0,
        7 => x.abs() > reach || y.abs() > reach,
        8 => x * x + y * y > reach * reach,
        9 => x.abs() > 3.0 * xx.max(0.0).sqrt() || y.abs() > 3.0 * yy.max(0.0).sqrt(),
        10 => gaussian < 1.0 / 255.0,
        11 => splat.opacity < 1.0 / 255.0,
        12 => q > 0.0,
        13 => q <= 0.0,
        14 => x.abs() > 3.0 || y.abs() > 3.0,
        16 => boxed([reach; 2]),
        17 => boxed([3.0 * xx.max(0.0).sqrt(), 3.0 * yy.max(0.0).sqrt()]),
        18 => q < 8.0,
        19 => [0, 1].iter().any(|&n| {
            let (own, r) = (mean[n].trunc(), reach.trunc() + 1.0);
            pixel[n] < own - r || pixel[n] >= own + r + 1.0
        }),
        _ => x * x + y * y > 9.0,
    };
    let (o, tau) = (splat.opacity, std::f64::consts::TAU);
    let times = match law[3] {
        0 => o,
        1 => 1.0,
        2 => o * o,
        3 => sigmoid(o),
        4 => o * det.max(0.0).sqrt() / tau,
        5 => o / tau,
        _ => o * det.max(0.0).sqrt(),
    };
    let most = [cap(form), 0.95, 0.9999, 1.0, 0.5, 0.98][law[4]];
    let alpha = (times * fall).min(most);
    if ended || skipped(-0.5 * q, alpha, form) { 0.0 } else { alpha }
}
