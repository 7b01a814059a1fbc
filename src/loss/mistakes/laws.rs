//! Laws of PSNR: which error, of what, and which logarithm of it.

use super::super::arrays::{peak, pictures, psnr};
use crate::contract::arrays::{Arrays, arrays, scalar};
use crate::contract::laws::Laws;
use crate::convention::{Conventions, PsnrFloor, PsnrOf};
use crate::math::{ln, log10};

/// What is compared.
const COMPARED: [&str; 10] = [
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
];

/// Y, Cb and Cr of colors, as JPEG has them.
const LUMA_AND_CHROMA: [[f64; 3]; 3] =
    [[0.299, 0.587, 0.114], [-0.168_735_9, -0.331_264_1, 0.5], [0.5, -0.418_687_6, -0.081_312_4]];

/// The error.
const ERROR: [&str; 9] = [
    "mean of d^2",
    "sum of d^2",
    "mean of |d|",
    "sum of d^2 over the number of pixels",
    "mean of d^2, a third of it",
    "sqrt(mean of d^2)",
    "max d^2",
    "the upper median of d^2",
    "(mean of |d|)^2",
];

/// The logarithm.
const LOGARITHM: [&str; 9] = [
    "10 log10(peak^2 / e)",
    "20 log10(peak^2 / e)",
    "10 ln(peak^2 / e)",
    "-10 log10(e)",
    "10 log10(peak / e)",
    "20 log10(peak) + 10 log10(e)",
    "10 log10(255^2 / e)",
    "log10(peak^2 / e)",
    "20 log10(peak / e)",
];

/// What an eps does.
const HELD: [&str; 6] =
    ["e", "e + 1e-10", "e + 1e-8", "max(e, 1e-5)", "e + 1e-6", "what gives 100 decibels where e is 0"];

/// Those of PSNR.
pub(crate) const OF_PSNR: Laws = Laws {
    choices: &[COMPARED.len(), ERROR.len(), LOGARITHM.len(), HELD.len(), 2],
    says: |part, choice| match part {
        0 => format!("of {}, compared", COMPARED[choice]),
        1 => format!("e = {}", ERROR[choice]),
        2 => LOGARITHM[choice].into(),
        3 => format!("{} in the place of e", HELD[choice]),
        _ => "of the mean error for the mean over pictures, or the other way around".into(),
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
        _ => picture.to_vec(),
    }
}

fn error(prediction: &[f64], target: &[f64], law: &[usize]) -> f64 {
    let pairs = compared(prediction, law[0]).into_iter().zip(compared(target, law[0]));
    let mut d: Vec<f64> = pairs.map(|(p, t)| p - t).collect();
    let n = d.len() as f64;
    let squares: f64 = d.iter().map(|d| d * d).sum();
    let sizes: f64 = d.iter().map(|d| d.abs()).sum();
    match law[1] {
        1 => squares,
        2 => sizes / n,
        3 => squares / (n / 3.0),
        4 => squares / (3.0 * n),
        5 => (squares / n).sqrt(),
        6 => d.iter().fold(0.0, |most: f64, d| most.max(d * d)),
        7 => {
            d.iter_mut().for_each(|d| *d *= *d);
            d.sort_by(f64::total_cmp);
            d[d.len() / 2]
        }
        8 => (sizes / n) * (sizes / n),
        _ => squares / n,
    }
}

fn of(a: &Arrays, c: &Conventions, law: &[usize]) -> Arrays {
    if law.iter().all(|choice| *choice == 0) {
        return psnr(a, c);
    }
    let peak = peak(a, c);
    let decibels = |e: f64| {
        let e = if c.psnr_floor == PsnrFloor::Small { e.max(1e-10 * peak * peak) } else { e };
        let held = match law[3] {
            1 => e + 1e-10,
            2 => e + 1e-8,
            3 => e.max(1e-5),
            4 => e + 1e-6,
            _ => e,
        };
        match law[2] {
            _ if law[3] == 5 && e == 0.0 => 100.0,
            1 => 20.0 * log10(peak * peak / held),
            2 => 10.0 * ln(peak * peak / held),
            3 => -10.0 * log10(held),
            4 => 10.0 * log10(peak / held),
            5 => 20.0 * log10(peak) + 10.0 * log10(held),
            6 => 10.0 * log10(65_025.0 / held),
            7 => log10(peak * peak / held),
            8 => 20.0 * log10(peak / held),
            _ => 10.0 * log10(peak * peak / held),
        }
    };
    let errors: Vec<f64> = pictures(a, "prediction")
        .iter()
        .zip(&pictures(a, "target"))
        .map(|(prediction, target)| error(prediction, target, law))
        .collect();
    let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
    let of_mean = (c.psnr == PsnrOf::MeanError) != (law[4] == 1);
    let value = if of_mean {
        decibels(mean(&errors))
    } else {
        mean(&errors.iter().map(|e| decibels(*e)).collect::<Vec<_>>())
    };
    arrays([("value", scalar(value))])
}
