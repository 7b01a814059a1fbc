//! Laws of structural similarity: which windows and constants, what is measured in a window, and what is made of all of them. Few choices
//! each: a picture costs much.

use ndarray::{Array3, ArrayView3, Axis};

use super::super::arrays::{form, forward, peak, picture, ssim};
use super::super::{Form, Moments, Windows, reach};
use super::LUMA;
use crate::contract::arrays::Arrays;
use crate::contract::laws::Laws;
use crate::convention::{Conventions, SsimPadding, SsimVariance, SsimWindow};
use crate::math::exp;

/// What is compared.
const COMPARED: [&str; 3] = ["colors", "the mean of the channels", "0.299 R + 0.587 G + 0.114 B"];

/// How wide a window is.
const WIDTH: [f64; 3] = [1.5, 2.0, 1.0];

/// What a window's similarity is, of luminance l, contrast c and structure s.
const SIMILARITY: [&str; 4] = ["l c s", "c s", "l", "s"];

/// What variances and covariance are.
const MEASURED: [&str; 6] = [
    "variances and covariance",
    "means of squares for variances, and of the product for the covariance",
    "means of squares for variances",
    "the root of the variances' product for the covariance",
    "the variances' product for the covariance",
    "the covariance without its sign",
];

/// How many pixels a window has along a side.
const SIZE: [usize; 5] = [11, 7, 5, 9, 13];

/// The constants.
const CONSTANTS: [&str; 5] = [
    "(0.01 peak)^2 and (0.03 peak)^2",
    "(0.03 peak)^2 and (0.01 peak)^2",
    "0.01 peak and 0.03 peak",
    "0.01^2 and 0.03^2",
    "0 and 0",
];

/// What a window's weights are divided by.
const OVER: [&str; 3] = ["their sum", "1", "2 pi sigma^2"];

/// What is made of all windows.
const MADE: [&str; 5] = ["mean", "1 - mean", "(1 - mean) / 2", "mean, held between 0 and 1", "|mean|"];

/// Those of structural similarity.
pub(crate) const OF_SIMILARITY: Laws = Laws {
    choices: &[
        COMPARED.len(),
        WIDTH.len(),
        SIMILARITY.len(),
        MEASURED.len(),
        SIZE.len(),
        CONSTANTS.len(),
        OVER.len(),
        MADE.len(),
    ],
    says: |part, choice| match part {
        0 => format!("of {}, compared", COMPARED[choice]),
        1 => format!("windows with sigma = {}", WIDTH[choice]),
        2 => format!("{}, of luminance l, contrast c and structure s", SIMILARITY[choice]),
        3 => MEASURED[choice].into(),
        4 => format!("windows of {0} x {0}", SIZE[choice]),
        5 => format!("constants {}", CONSTANTS[choice]),
        6 => format!("weights divided by {}", OVER[choice]),
        _ => format!("value = {}", MADE[choice]),
    },
    of,
    rounding: &[],
};

fn compared(picture: ArrayView3<f64>, choice: usize) -> Array3<f64> {
    let channels = picture.dim().2;
    match choice {
        1 => (picture.sum_axis(Axis(2)) / channels as f64).insert_axis(Axis(2)),
        2 if channels == 3 => {
            let luma = |k: usize| &picture.index_axis(Axis(2), k) * LUMA[k];
            (luma(0) + luma(1) + luma(2)).insert_axis(Axis(2))
        }
        _ => picture.to_owned(),
    }
}

/// The windows, and how far their weights are from a sum of 1.
fn windows<'a>(a: &'a Array3<f64>, b: &'a Array3<f64>, form: Form, law: &[usize]) -> (Windows<'a>, f64) {
    let mut windows = Windows::new(a.view(), b.view(), form);
    let (width, size) = (WIDTH[law[1]], SIZE[law[4]]);
    // Some pictures have no room for a larger window that lies inside.
    let size = if form.padding == SsimPadding::Valid { size.min(SIZE[0]) } else { size };
    // Another window than the convention's would undo it.
    if form.window != SsimWindow::Gaussian || [law[1], law[4], law[6]] == [0; 3] {
        return (windows, 0.0);
    }
    let middle = (size / 2) as f64;
    let bell = |n: usize| exp(-0.5 * ((n as f64 - middle) / width).powi(2));
    let weights: Vec<f64> = (0..size).map(bell).collect();
    let over = match law[6] {
        1 => 1.0,
        2 => width * (2.0 * std::f64::consts::PI).sqrt(),
        _ => weights.iter().sum(),
    };
    windows.weights = weights.iter().map(|w| w / over).collect();
    let (height, across, _) = a.dim();
    [windows.rows, windows.columns] = [height, across].map(|length| reach(length, size, form.padding));
    let n = (size * size) as f64;
    windows.unbiased = if form.variance == SsimVariance::Sample { n / (n - 1.0) } else { 1.0 };
    let sum: f64 = windows.weights.iter().sum();
    (windows, 1.0 - sum * sum)
}

/// What is measured in a window whose weights lack so much of 1: variances are means of squares less squared means.
fn measured(mut m: Moments, lack: f64, choice: usize) -> Moments {
    let [a, b, ab] = [m.mean_a * m.mean_a, m.mean_b * m.mean_b, m.mean_a * m.mean_b];
    (m.var_a, m.var_b, m.cov) = (m.var_a + lack * a, m.var_b + lack * b, m.cov + lack * ab);
    match choice {
        1 => (m.var_a, m.var_b, m.cov) = (m.var_a + a, m.var_b + b, m.cov + ab),
        2 => (m.var_a, m.var_b) = (m.var_a + a, m.var_b + b),
        3 => m.cov = (m.var_a * m.var_b).sqrt(),
        4 => m.cov = m.var_a * m.var_b,
        5 => m.cov = m.cov.abs(),
        _ => {}
    }
    m
}

fn constants(peak: f64, choice: usize) -> [f64; 2] {
    let usual = [0.01, 0.03].map(|k: f64| (k * peak) * (k * peak));
    match choice {
        1 => [usual[1], usual[0]],
        2 => [0.01 * peak, 0.03 * peak],
        3 => [1e-4, 9e-4],
        4 => [0.0; 2],
        _ => usual,
    }
}

fn similarity(m: &Moments, [c1, c2]: [f64; 2], choice: usize) -> f64 {
    let luminance = (2.0 * m.mean_a * m.mean_b + c1) / (m.mean_a * m.mean_a + m.mean_b * m.mean_b + c1);
    let contrast_and_structure = (2.0 * m.cov + c2) / (m.var_a + m.var_b + c2);
    match choice {
        0 => luminance * contrast_and_structure,
        1 => contrast_and_structure,
        2 => luminance,
        _ => (m.cov + 0.5 * c2) / ((m.var_a * m.var_b).sqrt() + 0.5 * c2),
    }
}

fn of(a: &Arrays, c: &Conventions, law: &[usize]) -> Arrays {
    if law.iter().all(|choice| *choice == 0) {
        return ssim(a, c);
    }
    let [p, t] = ["prediction", "target"].map(|name| compared(picture(a, name), law[0]));
    let (windows, lack) = windows(&p, &t, form(c), law);
    let (constants, places) = (constants(peak(a, c), law[5]), windows.places());
    let one =
        |place: &[usize; 3]| similarity(&measured(windows.moments(*place), lack, law[3]), constants, law[2]);
    let mean = places.iter().map(one).sum::<f64>() / places.len() as f64;
    forward(match law[7] {
        1 => 1.0 - mean,
        2 => 0.5 * (1.0 - mean),
        3 => mean.clamp(0.0, 1.0),
        4 => mean.abs(),
        _ => mean,
    })
}
