//! Loss, metric and bytes, wrong on purpose. Without a mistake every function equals the oracle.

use ndarray::Axis;

use super::arrays;
use crate::contract::arrays::{Arrays, input, scalar};
use crate::contract::component::Mistake;
use crate::convention::Conventions;

mod bytes;
pub(crate) mod laws;
mod parts;
mod psnr;

pub(crate) use bytes::{TO_UINT8, to_uint8};
pub(crate) use psnr::{PSNR, psnr};

const MEAN_FORGOTTEN: Mistake = Mistake::new(
    "mean_forgotten",
    "the gradient 2 (p - t) of the sum in the place of the mean's 2 (p - t) / n",
    "steps n times as long; the best learning rate depends on the batch",
    "divide by the number of entries",
    "hand-written backward passes",
    0,
);

const RELATIVE: Mistake = Mistake::new(
    "relative_error",
    "the mean of ((p - t) / (|p| + eps))^2",
    "dark places count as much as bright ones: another loss",
    "p - t alone",
    "RawNeRF's loss for linear light, where linear light isn't asked",
    0,
)
.with("eps", 1e-3, [1e-6, 1.0]);

pub(crate) const PREDICTION_CLIPPED: Mistake = Mistake::new(
    "prediction_clipped",
    "the prediction is clamped to [0, 1] first",
    "colors beyond have no gradient, and never come back",
    "colors as they are; clamp for a picture alone",
    "never; cheap to keep",
    0,
);

/// Mistakes of the loss.
pub(crate) const MSE: &[Mistake] = &[
    Mistake::new(
        "sum_for_mean",
        "the squared differences are summed, not averaged",
        "the loss grows with the batch",
        "divide by the number of entries",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "mean_over_rays",
        "the sum over colors is divided by the number of rays, not of entries",
        "loss three times too large, PSNR 4.77 dB too low",
        "divide by all entries, channels too",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "absolute_error",
        "mean |p - t|",
        "another loss: its PSNR is no PSNR, and bright errors weigh less",
        "square the differences",
        "L1 losses of neighboring codes",
        2,
    ),
    Mistake::new(
        "root_of_mean",
        "the root of the mean square",
        "figures that can't be compared; gradients that don't shrink with the error",
        "leave the root out",
        "metrics modules (RMSE)",
        1,
    ),
    MEAN_FORGOTTEN.of_gradient(),
    RELATIVE,
    Mistake::new(
        "factor_two_missing",
        "the gradient (p - t) / n, as if the loss were half the square",
        "steps half as long",
        "multiply by 2",
        "hand-written backward passes",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "square_of_the_mean",
        "(mean (p - t))^2",
        "errors of both signs cancel: a gray picture of the right brightness is perfect",
        "square each, then the mean",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "mean_distance",
        "the mean of |p - t| over pixels, each a length",
        "another loss: lengths, not their squares",
        "the mean of squares",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "variance_of_difference",
        "the variance of p - t: its mean is taken off",
        "a picture that is too bright everywhere is perfect",
        "the mean of squares",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "gray_pictures",
        "the means over channels are compared",
        "the wrong colors of the right brightness are perfect",
        "every channel by itself",
        "never; cheap to keep",
        0,
    ),
    PREDICTION_CLIPPED,
    Mistake::new(
        "bytes_compared",
        "255 p and 255 t are compared",
        "a loss 65025 times too large; steps that are too long",
        "colors in [0, 1]",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "loss_halved",
        "half the mean square",
        "a PSNR that is 3 dB too high; steps half as long",
        "the mean square",
        "machine learning's 1/2 in front of squares; never seen here",
        0,
    ),
];

/// What losses compare.
pub(crate) fn compared(a: &Arrays, wrong: &[&str]) -> Arrays {
    let mut a = a.clone();
    if wrong.contains(&"prediction_clipped") {
        a.get_mut("prediction").expect("checked").mapv_inplace(|x| x.clamp(0.0, 1.0));
    }
    if wrong.contains(&"gray_pictures") {
        for name in ["prediction", "target"] {
            let colors = input(&a, name);
            let last = Axis(colors.ndim() - 1);
            let gray = colors.mean_axis(last).expect("channels").insert_axis(last);
            a.insert(name.into(), gray);
        }
    }
    a
}

/// Mean squared error.
pub(crate) fn mse(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let a = &compared(a, wrong);
    let mut out = arrays::mse(a, c);
    let entries = input(a, "prediction").len() as f64;
    let channels = input(a, "prediction").shape().last().copied().unwrap_or(1) as f64;
    if wrong.contains(&"absolute_error") {
        let sizes = (input(a, "prediction") - input(a, "target")).mapv(f64::abs);
        out.insert("value".into(), scalar(sizes.sum() / entries));
    }
    let apart = input(a, "prediction") - input(a, "target");
    if wrong.contains(&"mean_distance") {
        let squares = apart.mapv(|d| d * d).sum_axis(Axis(apart.ndim() - 1));
        out.insert("value".into(), scalar(squares.mapv(f64::sqrt).mean().unwrap_or(f64::NAN)));
    }
    if wrong.contains(&"variance_of_difference") {
        let mean = apart.sum() / entries;
        out.insert("value".into(), scalar(apart.mapv(|d| (d - mean) * (d - mean)).sum() / entries));
    }
    if wrong.contains(&"square_of_the_mean") {
        let mean = (input(a, "prediction") - input(a, "target")).sum() / entries;
        out.insert("value".into(), scalar(mean * mean));
    }
    if let Some(eps) = RELATIVE.among(wrong) {
        let (p, t) = (input(a, "prediction"), input(a, "target"));
        let one = |(p, t): (&f64, &f64)| ((p - t) / (p.abs() + eps)).powi(2);
        out.insert("value".into(), scalar(p.iter().zip(t).map(one).sum::<f64>() / entries));
    }
    if wrong.contains(&"root_of_mean") {
        out.insert("value".into(), input(&out, "value").mapv(f64::sqrt));
    }
    for name in wrong {
        let factor = match *name {
            "sum_for_mean" => entries,
            "mean_over_rays" => channels,
            "bytes_compared" => 255.0 * 255.0,
            "loss_halved" => 0.5,
            _ => 1.0,
        };
        out.insert("value".into(), input(&out, "value") * factor);
    }
    out
}

/// Its gradient.
pub(crate) fn mse_vjp(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let mut out = arrays::mse_vjp(a, c);
    let entries = input(a, "prediction").len() as f64;
    for name in wrong {
        let factor = match *name {
            "mean_forgotten" => entries,
            "factor_two_missing" => 0.5,
            _ => 1.0,
        };
        out.insert("grad_prediction".into(), input(&out, "grad_prediction") * factor);
    }
    out
}
