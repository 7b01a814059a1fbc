//! Laws of PSNR: of what, which difference and which error, over which peak, which logarithm, and what is averaged.

use super::super::arrays::{peak, pictures, psnr};
use crate::contract::arrays::{Arrays, arrays, scalar, values};
use crate::contract::laws::{Guard, Laws};
use crate::convention::{Conventions, PsnrFloor, PsnrOf};
use crate::math::{ln, log10};

/// What is compared.
const COMPARED: [&str; 13] = [
    "colors",
    "colors held between 0 and 1",
    "colors as bytes, cut off",
    "colors as bytes, rounded",
    "the last channel alone",
    "the first channel alone",
    "the mean of the channels",
    "0.299 R + 0.587 G + 0.114 B",
    "0.2126 R + 0.7152 G + 0.0722 B",
    "Y, Cb and Cr",
    "the prediction held between 0 and 1, the target as it is",
    "colors / 255",
    "255 times colors",
];

/// Y, Cb and Cr of colors, as JPEG has them.
const LUMA_AND_CHROMA: [[f64; 3]; 3] =
    [[0.299, 0.587, 0.114], [-0.168_735_9, -0.331_264_1, 0.5], [0.5, -0.418_687_6, -0.081_312_4]];

/// The difference.
const DIFFERENCE: [&str; 8] = [
    "p - t",
    "t - (p - t)",
    "p - t less its mean",
    "(p - t) / t",
    "(p - t) / (t + 1e-8)",
    "p + t",
    "max(p - t, 0)",
    "p^2 - t^2",
];

/// The error.
const ERROR: [&str; 13] = [
    "mean of d^2",
    "sum of d^2",
    "mean of |d|",
    "sum of d^2 over the number of pixels",
    "mean of d^2, a third of it",
    "sqrt(mean of d^2)",
    "max d^2",
    "the upper median of d^2",
    "(mean of |d|)^2",
    "sqrt(sum of d^2)",
    "mean of d^2, half of it",
    "(mean of d)^2",
    "sum of d^2 over one less than their number",
];

/// What an eps does.
const HELD: [Guard; 10] = [
    Guard::Nothing,
    Guard::Plus(1e-8),
    Guard::Plus(1e-10),
    Guard::Plus(1e-7),
    Guard::Plus(1e-6),
    Guard::Plus(1e-12),
    Guard::AtLeast(1e-8),
    Guard::AtLeast(1e-5),
    Guard::AtLeast(1e-6),
    Guard::AtLeast(1.192_092_9e-7),
];

/// What else is done to it.
const HELD_OTHERWISE: [&str; 3] =
    ["(sqrt(e) + 1e-8)^2", "what gives 100 decibels where e is 0", "what gives 0 decibels where e is 0"];

/// The peak.
const PEAK: [&str; 8] = [
    "the largest value that a color may have",
    "255",
    "max t",
    "max p",
    "max t - min t",
    "sqrt(mean of t^2)",
    "sqrt(mean of p^2)",
    "sqrt(sum of t^2)",
];

/// The logarithm.
const LOGARITHM: [&str; 12] = [
    "10 log10(peak^2 / e)",
    "20 log10(peak^2 / e)",
    "10 ln(peak^2 / e)",
    "10 log10(peak / e)",
    "20 log10(peak / e)",
    "20 log10(peak) + 10 log10(e)",
    "-10 log10(peak^2 / e)",
    "20 ln(peak^2 / e)",
    "log10(peak^2 / e)",
    "10 log2(peak^2 / e)",
    "10 log10(1 + peak^2 / e)",
    "10 ln(peak / e)",
];

/// Whose figures are averaged.
const AVERAGED: [&str; 6] = [
    "of pictures, or of their mean error, as it is by convention",
    "of the mean error for the mean over pictures, or the other way around",
    "the mean over the channels of each picture",
    "the mean over pixels",
    "the mean over all numbers",
    "the mean over the channels of all pictures",
];

/// Those of PSNR.
pub(crate) const OF_PSNR: Laws = Laws {
    choices: &[
        COMPARED.len(),
        DIFFERENCE.len(),
        ERROR.len(),
        HELD.len() + HELD_OTHERWISE.len(),
        PEAK.len(),
        LOGARITHM.len(),
        AVERAGED.len(),
    ],
    says: |part, choice| match part {
        0 => format!("of {}, compared", COMPARED[choice]),
        1 => format!("d = {}", DIFFERENCE[choice]),
        2 => format!("e = {}", ERROR[choice]),
        3 => {
            let otherwise = || HELD_OTHERWISE[choice - HELD.len()].into();
            let held = HELD.get(choice).map_or_else(otherwise, |guard| guard.said("e"));
            format!("{held} in the place of e")
        }
        4 => format!("peak = {}", PEAK[choice]),
        5 => LOGARITHM[choice].into(),
        _ => AVERAGED[choice].into(),
    },
    of,
    rounding: &[(0, 2), (0, 3)],
};

/// A picture as it is compared.
fn compared(picture: &[f64], choice: usize) -> Vec<f64> {
    let gray = |by: [f64; 3]| picture.chunks_exact(3).map(|c| (0..3).map(|k| by[k] * c[k]).sum()).collect();
    let channel = |k: usize| picture.chunks_exact(3).map(|c| c[k]).collect();
    let each = |f: fn(f64) -> f64| picture.iter().map(|x| f(*x)).collect();
    match choice {
        1 => each(|x| x.clamp(0.0, 1.0)),
        2 => each(|x| (255.0 * x.clamp(0.0, 1.0)).floor() / 255.0),
        3 => each(|x| (255.0 * x.clamp(0.0, 1.0)).round() / 255.0),
        4 => channel(2),
        5 => channel(0),
        6 => gray([1.0 / 3.0; 3]),
        7 => gray([0.299, 0.587, 0.114]),
        8 => gray([0.2126, 0.7152, 0.0722]),
        9 => {
            let of = |c: &[f64]| LUMA_AND_CHROMA.map(|by| (0..3).map(|k| by[k] * c[k]).sum());
            picture.chunks_exact(3).flat_map(of).collect()
        }
        11 => each(|x| x / 255.0),
        12 => each(|x| 255.0 * x),
        _ => picture.to_vec(),
    }
}

/// The differences of a picture and its target.
fn differences(prediction: &[f64], target: &[f64], law: &[usize]) -> Vec<f64> {
    let prediction = compared(prediction, if law[0] == 10 { 1 } else { law[0] });
    let pairs: Vec<(f64, f64)> = prediction.into_iter().zip(compared(target, law[0])).collect();
    let mean = pairs.iter().map(|(p, t)| p - t).sum::<f64>() / pairs.len() as f64;
    let one = |(p, t): (f64, f64)| match law[1] {
        1 => t - (p - t),
        2 => p - t - mean,
        3 => (p - t) / t,
        4 => (p - t) / (t + 1e-8),
        5 => p + t,
        6 => (p - t).max(0.0),
        7 => p * p - t * t,
        _ => p - t,
    };
    pairs.into_iter().map(one).collect()
}

/// The differences that an error is of: those of each picture, or of its parts.
fn parts(pictures: Vec<Vec<f64>>, channels: usize, choice: usize) -> Vec<Vec<f64>> {
    let channel = |of: &[f64], k: usize| of.chunks(channels).map(|c| c[k]).collect::<Vec<f64>>();
    match choice {
        2 => pictures.iter().flat_map(|of| (0..channels).map(|k| channel(of, k))).collect(),
        3 => pictures.iter().flat_map(|of| of.chunks(channels).map(<[f64]>::to_vec)).collect(),
        4 => pictures.into_iter().flatten().map(|d| vec![d]).collect(),
        5 => (0..channels).map(|k| channel(&pictures.concat(), k)).collect(),
        _ => pictures,
    }
}

/// The error of these differences, so many of each pixel.
fn error(d: &[f64], of_pixel: usize, choice: usize) -> f64 {
    let n = d.len() as f64;
    let squares: f64 = d.iter().map(|d| d * d).sum();
    let sizes: f64 = d.iter().map(|d| d.abs()).sum();
    let all: f64 = d.iter().sum();
    match choice {
        1 => squares,
        2 => sizes / n,
        3 => squares / (n / of_pixel as f64),
        4 => squares / (3.0 * n),
        5 => (squares / n).sqrt(),
        6 => d.iter().fold(0.0, |most: f64, d| most.max(d * d)),
        7 => {
            let mut squares: Vec<f64> = d.iter().map(|d| d * d).collect();
            squares.sort_by(f64::total_cmp);
            squares.get(squares.len() / 2).copied().unwrap_or(f64::NAN)
        }
        8 => (sizes / n) * (sizes / n),
        9 => squares.sqrt(),
        10 => squares / (2.0 * n),
        11 => (all / n) * (all / n),
        12 => squares / (n - 1.0),
        _ => squares / n,
    }
}

fn held(e: f64, choice: usize) -> f64 {
    match HELD.get(choice) {
        Some(guard) => guard.of(e),
        None if choice == HELD.len() => (e.sqrt() + 1e-8) * (e.sqrt() + 1e-8),
        None => e,
    }
}

/// The peak, or what is taken for it, of all pictures.
fn other_peak(a: &Arrays, c: &Conventions, choice: usize) -> f64 {
    let colors = values(a, if [3, 6].contains(&choice) { "prediction" } else { "target" });
    let most = colors.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let least = colors.iter().copied().fold(f64::INFINITY, f64::min);
    let squares: f64 = colors.iter().map(|x| x * x).sum();
    match choice {
        1 => 255.0,
        2 | 3 => most,
        4 => most - least,
        5 | 6 => (squares / colors.len() as f64).sqrt(),
        7 => squares.sqrt(),
        _ => peak(a, c),
    }
}

fn logarithm(peak: f64, e: f64, choice: usize) -> f64 {
    match choice {
        1 => 20.0 * log10(peak * peak / e),
        2 => 10.0 * ln(peak * peak / e),
        3 => 10.0 * log10(peak / e),
        4 => 20.0 * log10(peak / e),
        5 => 20.0 * log10(peak) + 10.0 * log10(e),
        6 => -10.0 * log10(peak * peak / e),
        7 => 20.0 * ln(peak * peak / e),
        8 => log10(peak * peak / e),
        9 => 10.0 * ln(peak * peak / e) / ln(2.0),
        10 => 10.0 * log10(1.0 + peak * peak / e),
        11 => 10.0 * ln(peak / e),
        _ => 10.0 * log10(peak * peak / e),
    }
}

fn of(a: &Arrays, c: &Conventions, law: &[usize]) -> Arrays {
    if law.iter().all(|choice| *choice == 0) {
        return psnr(a, c);
    }
    let peak = other_peak(a, c, law[4]);
    let decibels = |e: f64| match law[3] {
        11 if e == 0.0 => 100.0,
        12 if e == 0.0 => 0.0,
        _ => {
            let least = if c.psnr_floor == PsnrFloor::Small { 1e-10 * peak * peak } else { 0.0 };
            logarithm(peak, held(e.max(least), law[3]), law[5])
        }
    };
    let pairs = pictures(a, "prediction").into_iter().zip(pictures(a, "target"));
    let apart = pairs.map(|(prediction, target)| differences(&prediction, &target, law)).collect();
    // What is of one channel, or of all together, has one.
    let channels = if (4..=8).contains(&law[0]) { 1 } else { 3 };
    let parts = parts(apart, channels, law[6]);
    let of_pixel = if [2, 5].contains(&law[6]) { 1 } else { channels };
    let errors: Vec<f64> = parts.iter().map(|d| error(d, of_pixel, law[2])).collect();
    let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
    let of_mean = law[6] < 2 && (c.psnr == PsnrOf::MeanError) != (law[6] == 1);
    let value = if of_mean {
        decibels(mean(&errors))
    } else {
        mean(&errors.iter().map(|e| decibels(*e)).collect::<Vec<_>>())
    };
    arrays([("value", scalar(value))])
}
