//! Loss, metric and bytes, wrong on purpose. Without a mistake every function equals the oracle.

use super::arrays::{self, like};
use crate::contract::arrays::{Arrays, arrays, input, scalar};
use crate::contract::component::Mistake;
use crate::convention::{Bytes, Conventions, PsnrPeak};

const MEAN_FORGOTTEN: Mistake = Mistake::new(
    "mean_forgotten",
    "the gradient 2 (p - t) of the sum in the place of the mean's 2 (p - t) / n",
    "steps n times as long; the best learning rate depends on the batch",
    "divide by the number of entries",
    "hand-written backward passes",
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
    Mistake::new(
        "factor_two_missing",
        "the gradient (p - t) / n, as if the loss were half the square",
        "steps half as long",
        "multiply by 2",
        "hand-written backward passes",
        0,
    )
    .of_gradient(),
];

const PEAK_SCALED: Mistake = Mistake::new(
    "peak_scaled",
    "a peak that is k times the largest value that a color may have",
    "20 log10(k) dB too many, or too few, whatever the picture",
    "the peak of the colors' own scale: 1, or 255 of bytes",
    "1 public implementation, with 8",
    1,
)
.with("k", 8.0, [1e-3, 1e3]);

/// Mistakes of the metric.
pub(crate) const PSNR: &[Mistake] = &[
    Mistake::new(
        "doubled_psnr",
        "20 log10(1 / mse): the formula of the root mean square on the mean square",
        "every figure twice as large",
        "10 log10(peak^2 / mse)",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "regularized_psnr",
        "PSNR of a training loss that holds a regularizer (here 1e-3)",
        "figures too low, capped by the regularizer",
        "take the mean squared error alone",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "few_pixels",
        "a few pixels (here the first row) are reported as the picture",
        "figures that can't be compared with anybody's",
        "render the whole picture",
        "3 public implementations",
        3,
    ),
    Mistake::new(
        "natural_log_psnr",
        "10 ln(1 / mse)",
        "every figure 2.3 times as large",
        "use the decimal logarithm",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "peak_of_target",
        "the target's largest value for the peak",
        "figures that differ from picture to picture for the same error",
        "peak is the largest value that a color may have",
        "an imaging code",
        1,
    ),
    PEAK_SCALED,
    Mistake::new(
        "peak_255",
        "peak 255 whatever the colors",
        "48.13 dB too many for colors in [0, 1]",
        "peak is the largest value that a color may have",
        "never; cheap to keep",
        0,
    ),
];

/// Mistakes of the bytes.
pub(crate) const TO_UINT8: &[Mistake] = &[
    Mistake::new(
        "times_256",
        "256 x, clipped and cut off",
        "up to one level too bright",
        "round(255 x)",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "stretched_to_the_range",
        "255 (x - min) / (max - min), as plotting libraries do",
        "every picture has another brightness; PSNR of such files means nothing",
        "clip to [0, 1] and multiply by 255",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "uint8_without_clipping",
        "255 x is cast without clipping: 1.01 becomes 1",
        "black specks in the brightest places",
        "clip to [0, 1] first",
        "6 public implementations",
        6,
    ),
    Mistake::new(
        "red_and_blue_exchanged",
        "BGR for RGB",
        "blue for red",
        "reverse the last axis where OpenCV writes the file",
        "2 public implementations",
        2,
    ),
    Mistake::new(
        "picture_transposed",
        "rows and columns of the picture are exchanged",
        "the picture lies on its side, or is sheared where it isn't square",
        "reshape to (height, width, 3)",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "picture_flipped",
        "the first row is written last",
        "the picture stands on its head",
        "rows run downwards",
        "1 public implementation",
        1,
    ),
];

/// Mean squared error.
pub(crate) fn mse(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let mut out = arrays::mse(a, c);
    let entries = input(a, "prediction").len() as f64;
    let channels = input(a, "prediction").shape().last().copied().unwrap_or(1) as f64;
    if wrong.contains(&"absolute_error") {
        let sizes = (input(a, "prediction") - input(a, "target")).mapv(f64::abs);
        out.insert("value".into(), scalar(sizes.sum() / entries));
    }
    if wrong.contains(&"root_of_mean") {
        out.insert("value".into(), input(&out, "value").mapv(f64::sqrt));
    }
    for name in wrong {
        let factor = match *name {
            "sum_for_mean" => entries,
            "mean_over_rays" => channels,
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

/// Peak signal-to-noise ratio.
pub(crate) fn psnr(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let mut a = a.clone();
    if wrong.contains(&"peak_255") {
        a.insert("peak".into(), scalar(255.0));
    }
    if wrong.contains(&"peak_of_target") {
        a.insert("peak".into(), scalar(input(&a, "target").iter().copied().fold(f64::MIN, f64::max)));
    }
    if wrong.contains(&"few_pixels") {
        for name in ["prediction", "target"] {
            let row = input(&a, name).slice_axis(ndarray::Axis(1), (0..1).into()).to_owned();
            a.insert(name.into(), row);
        }
    }
    let by_peak = wrong.contains(&"peak_255") || wrong.contains(&"peak_of_target");
    // Where the peak is 1 by convention, another one is still a mistake.
    let c = &Conventions { psnr_peak: if by_peak { PsnrPeak::Given } else { c.psnr_peak }, ..*c };
    let mut value = input(&arrays::psnr(&a, c), "value").sum();
    if wrong.contains(&"regularized_psnr") {
        let peak = arrays::peak(&a, c);
        let error = peak * peak * crate::math::pow(10.0, -value / 10.0);
        value = super::psnr(error + 1e-3, peak);
    }
    if let Some(k) = PEAK_SCALED.among(wrong) {
        value += 20.0 * libm::log10(k);
    }
    if wrong.contains(&"doubled_psnr") {
        value *= 2.0;
    }
    if wrong.contains(&"natural_log_psnr") {
        value *= std::f64::consts::LN_10;
    }
    arrays([("value", scalar(value))])
}

/// Bytes.
pub(crate) fn to_uint8(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let mut bytes = input(&arrays::to_uint8(a, c), "bytes").clone();
    if wrong.contains(&"uint8_without_clipping") {
        let wrapped = |x: f64| match c.bytes {
            Bytes::Round => libm::round(255.0 * x).rem_euclid(256.0),
            Bytes::Truncate => (255.0 * x).trunc().rem_euclid(256.0),
        };
        bytes = input(a, "image").mapv(wrapped);
    }
    if wrong.contains(&"times_256") {
        bytes = input(a, "image").mapv(|x| (256.0 * x.clamp(0.0, 1.0)).trunc().min(255.0));
    }
    if wrong.contains(&"stretched_to_the_range") {
        let image = input(a, "image");
        let (low, high) =
            image.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(*x), h.max(*x)));
        bytes = input(
            &arrays::to_uint8(&self::arrays([("image", image.mapv(|x| (x - low) / (high - low)))]), c),
            "bytes",
        )
        .clone();
    }
    if wrong.contains(&"red_and_blue_exchanged") {
        bytes.invert_axis(ndarray::Axis(2));
    }
    if wrong.contains(&"picture_flipped") {
        bytes.invert_axis(ndarray::Axis(0));
    }
    if wrong.contains(&"picture_transposed") {
        // Reshaped to the right shape.
        let columns = bytes.permuted_axes(ndarray::IxDyn(&[1, 0, 2]));
        bytes = like(a, "image", columns.iter().copied().collect());
    }
    arrays([("bytes", like(a, "image", bytes.iter().copied().collect()))])
}
