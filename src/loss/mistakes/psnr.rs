//! Signal-to-noise ratio, wrong on purpose.

use super::parts::OF_PARTS;
use crate::contract::arrays::{Arrays, arrays, input, scalar};
use crate::contract::component::{Mistake, joined};
use crate::convention::{Conventions, PsnrOf, PsnrPeak};
use crate::loss::arrays;

const PEAK_SCALED: Mistake = Mistake::new(
    "peak_scaled",
    "a peak that is k times the largest value that a color may have",
    "20 log10(k) dB too many, or too few, whatever the picture",
    "the peak of the colors' own scale: 1, or 255 of bytes",
    "1 public implementation, with 8",
    1,
)
.with("k", 8.0, [1e-3, 1e3]);

const INFINITE: Mistake = Mistake::new(
    "infinite_below",
    "infinite where the mean square is below k",
    "two pictures that differ are told to be the same",
    "infinite where it is 0",
    "a student in PyTorch",
    1,
)
.with("k", 1e-10, [1e-14, 1e-2]);

const REGULARIZED: Mistake = Mistake::new(
    "regularized_psnr",
    "PSNR of a mean square with something added: a training loss' regularizer, an eps",
    "figures too low, and capped",
    "take the mean squared error alone",
    "1 public implementation",
    1,
)
.with("k", 1e-3, [1e-6, 1e-1]);

/// Mistakes of the metric.
pub(crate) const PSNR: &[Mistake] = &joined::<{ OF_FIGURES.len() + OF_PARTS.len() }>(&[OF_FIGURES, OF_PARTS]);

const OF_FIGURES: &[Mistake] = &[
    INFINITE,
    Mistake::new(
        "doubled_psnr",
        "20 log10(1 / mse): the formula of the root mean square on the mean square",
        "every figure twice as large",
        "10 log10(peak^2 / mse)",
        "1 public implementation",
        1,
    ),
    REGULARIZED,
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
    Mistake::new(
        "peak_of_each_target",
        "the largest value of each target for its peak",
        "figures that differ from picture to picture for the same error",
        "peak is the largest value that a color may have",
        "metrics that are handed one picture after the other",
        1,
    ),
    PEAK_SCALED,
    Mistake::new(
        "both_clipped_to_one",
        "both pictures are clipped to [0, 1] first, whatever the peak",
        "what is too bright or too dark costs nothing; bytes are white",
        "colors of the peak's own scale, as they are",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "prediction_clipped_to_one",
        "the prediction is clipped to [0, 1] first, whatever the peak",
        "what is too bright or too dark costs less; bytes are compared with white",
        "colors of the peak's own scale, as they are",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "peak_255",
        "peak 255 whatever the colors",
        "48.13 dB too many for colors in [0, 1]",
        "peak is the largest value that a color may have",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "peak_of_prediction",
        "the prediction's largest value for the peak",
        "brighter pictures score better",
        "peak is the largest value that a color may have",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "range_of_target",
        "the target's largest value less its smallest for the peak",
        "figures that differ from picture to picture for the same error",
        "peak is the largest value that a color may have",
        "scripts with data_range = target.max() - target.min(); never seen here",
        0,
    ),
    Mistake::new(
        "peak_not_squared",
        "10 log10(peak / mse)",
        "of bytes 24 dB too few; right where the peak is 1",
        "peak^2 / mse",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "absolute_error_psnr",
        "20 log10(peak / mean |p - t|)",
        "figures too high wherever errors are uneven",
        "the mean square",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "mean_over_channels",
        "the mean of the channels' figures",
        "one good channel outweighs two bad ones",
        "the mean square over all channels",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "mean_over_pixels",
        "the mean of the pixels' figures, errors of 1e-10 at least",
        "figures too high wherever errors are uneven",
        "the mean square over the picture",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "bias_left_out",
        "the standard deviation of p - t for the root of its mean square",
        "a picture that is too bright all over is perfect",
        "the mean square",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "bytes_cut_off",
        "both pictures cut off to bytes first, peak 255",
        "figures of files, off by a part of a decibel, and infinite for errors below a byte",
        "colors as they are",
        "scripts that compare what was written; never seen here",
        0,
    ),
    Mistake::new(
        "divided_by_pixels",
        "the sum of the squares is divided by height and width alone",
        "every figure 4.77 dB too low",
        "the mean over all entries",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "channels_not_counted",
        "the sum of a picture's squares is divided by its height and width, not by its channels",
        "every figure 10 log10(channels) dB too low: 4.77 of three",
        "the mean over all entries",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "root_for_mean_square",
        "10 log10(peak / rmse): the factor of the mean square on its root",
        "every figure half as large",
        "20 log10(peak / rmse)",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "first_picture_alone",
        "the figure of the first picture",
        "nothing is known of the others",
        "the mean over all pictures",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "through_bytes",
        "both pictures are rounded to bytes first",
        "pictures that are nearly equal are infinitely good",
        "colors as they are, or say that they are bytes",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "prediction_clipped_to_peak",
        "the prediction is clamped to [0, peak] first",
        "figures that hide colors beyond the peak",
        "colors as they are, or say that they are clamped",
        "never; cheap to keep",
        0,
    ),
];

/// The errors whose figures are averaged, where these aren't the mean squares of pictures.
fn parts(a: &Arrays, wrong: &[&str]) -> Option<Vec<f64>> {
    let apart = input(a, "prediction") - input(a, "target");
    let mean = |axes: [usize; 2], x: &ndarray::ArrayD<f64>| {
        let of = |x: ndarray::ArrayD<f64>, axis: usize| x.mean_axis(ndarray::Axis(axis)).expect("pixels");
        of(of(x.clone(), axes[0]), axes[1])
    };
    let squares = apart.mapv(|d| d * d);
    let of_pictures =
        |x: &ndarray::ArrayD<f64>| mean([2, 1], x).mean_axis(ndarray::Axis(1)).expect("channels");
    let all = |x: ndarray::ArrayD<f64>| x.iter().copied().collect::<Vec<f64>>();
    match () {
        () if wrong.contains(&"absolute_error_psnr") => {
            Some(all(of_pictures(&apart.mapv(f64::abs)).mapv(|x| x * x)))
        }
        () if wrong.contains(&"mean_over_channels") => Some(all(mean([2, 1], &squares))),
        () if wrong.contains(&"mean_over_pixels") => {
            Some(all(squares.mean_axis(ndarray::Axis(3)).expect("channels").mapv(|x| x.max(1e-10))))
        }
        () if wrong.contains(&"bias_left_out") => {
            Some(all(of_pictures(&squares) - of_pictures(&apart).mapv(|x| x * x)))
        }
        () => None,
    }
}

/// The mean of the pictures' figures, each with its target's largest value for the peak.
fn by_own_peaks(a: &Arrays, c: &Conventions) -> f64 {
    let pictures = input(a, "prediction").outer_iter().zip(input(a, "target").outer_iter());
    let figures = pictures.map(|(prediction, target)| {
        let [p, t] = [prediction, target].map(|x| x.iter().copied().collect::<Vec<f64>>());
        let peak = t.iter().copied().fold(f64::MIN, f64::max);
        crate::loss::psnr_of_images(&[&p], &[&t], peak, PsnrOf::Images, c.psnr_floor)
    });
    figures.sum::<f64>() / input(a, "target").shape()[0] as f64
}

/// Peak signal-to-noise ratio.
pub(crate) fn psnr(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let mut a = a.clone();
    let clipped: &[&str] = match () {
        () if wrong.contains(&"both_clipped_to_one") => &["prediction", "target"],
        () if wrong.contains(&"prediction_clipped_to_one") => &["prediction"],
        () => &[],
    };
    for name in clipped {
        a.get_mut(*name).expect("checked").mapv_inplace(|x| x.clamp(0.0, 1.0));
    }
    let peak = arrays::peak(&a, c);
    if wrong.contains(&"prediction_clipped_to_peak") {
        a.get_mut("prediction").expect("checked").mapv_inplace(|x| x.clamp(0.0, peak));
    }
    for name in ["prediction", "target"] {
        let array = a.get_mut(name).expect("checked");
        if wrong.contains(&"through_bytes") {
            array.mapv_inplace(|x| libm::rint(255.0 * x / peak) / 255.0 * peak);
        }
        if wrong.contains(&"first_channel_alone") {
            *array = array.slice_axis(ndarray::Axis(3), (0..1).into()).to_owned();
        }
        if wrong.contains(&"luma_alone") && array.shape()[3] == 3 {
            let luma = |x: ndarray::ArrayView1<f64>| 0.299 * x[0] + 0.587 * x[1] + 0.114 * x[2];
            *array = array.map_axis(ndarray::Axis(3), luma).insert_axis(ndarray::Axis(3));
        }
        let crop = wrong.contains(&"border_cropped") && array.shape()[1..3].iter().all(|n| *n > 2);
        for axis in [1, 2].into_iter().filter(|_| crop) {
            let end = array.shape()[axis] as isize - 1;
            *array = array.slice_axis(ndarray::Axis(axis), (1..end).into()).to_owned();
        }
        if wrong.contains(&"first_picture_alone") {
            *array = array.slice_axis(ndarray::Axis(0), (0..1).into()).to_owned();
        }
    }
    if wrong.contains(&"peak_255") {
        a.insert("peak".into(), scalar(255.0));
    }
    if wrong.contains(&"bytes_wrap_around") {
        let bytes = |x: &f64| libm::rint(255.0 * (x / peak).clamp(0.0, 1.0));
        let [p, t] = ["prediction", "target"].map(|name| input(&a, name).map(bytes));
        a.insert("prediction".into(), (p - &t).mapv(|d| if d < 0.0 { d + 256.0 } else { d }) + &t);
        a.insert("target".into(), t);
        a.insert("peak".into(), scalar(255.0));
    }
    if wrong.contains(&"peak_of_target") {
        a.insert("peak".into(), scalar(input(&a, "target").iter().copied().fold(f64::MIN, f64::max)));
    }
    if wrong.contains(&"peak_of_prediction") {
        a.insert("peak".into(), scalar(input(&a, "prediction").iter().copied().fold(f64::MIN, f64::max)));
    }
    if wrong.contains(&"range_of_target") {
        let ends = |[low, high]: [f64; 2], x: &f64| [low.min(*x), high.max(*x)];
        let [low, high] = input(&a, "target").iter().fold([f64::MAX, f64::MIN], ends);
        a.insert("peak".into(), scalar(high - low));
    }
    if wrong.contains(&"bytes_cut_off") {
        let peak = arrays::peak(&a, c);
        for name in ["prediction", "target"] {
            a.get_mut(name).expect("checked").mapv_inplace(|x| (255.0 * (x / peak).clamp(0.0, 1.0)).floor());
        }
        a.insert("peak".into(), scalar(255.0));
    }
    if wrong.contains(&"few_pixels") {
        for name in ["prediction", "target"] {
            let row = input(&a, name).slice_axis(ndarray::Axis(1), (0..1).into()).to_owned();
            a.insert(name.into(), row);
        }
    }
    let peaks = [
        "bytes_wrap_around",
        "peak_255",
        "peak_of_target",
        "peak_of_prediction",
        "range_of_target",
        "bytes_cut_off",
    ];
    let by_peak = peaks.iter().any(|name| wrong.contains(name));
    // Where the peak is 1 by convention, another one is still a mistake.
    let c = &Conventions { psnr_peak: if by_peak { PsnrPeak::Given } else { c.psnr_peak }, ..*c };
    let mut value = input(&arrays::psnr(&a, c), "value").sum();
    if wrong.contains(&"peak_not_squared") {
        value -= 10.0 * libm::log10(arrays::peak(&a, c));
    }
    if let Some(parts) = parts(&a, wrong) {
        let figure = |error: f64| crate::loss::psnr(error, arrays::peak(&a, c));
        value = parts.iter().map(|error| figure(*error)).sum::<f64>() / parts.len() as f64;
    }
    if wrong.contains(&"peak_of_each_target") {
        value = by_own_peaks(&a, c);
    }
    if let Some(k) = REGULARIZED.among(wrong) {
        let peak = arrays::peak(&a, c);
        let error = peak * peak * crate::math::pow(10.0, -value / 10.0);
        value = crate::loss::psnr(error + k, peak);
    }
    let square = |value: f64| crate::math::pow(10.0, -value / 10.0) * arrays::peak(&a, c).powi(2);
    if INFINITE.among(wrong).is_some_and(|k| square(value) < k) {
        value = f64::INFINITY;
    }
    if let Some(k) = PEAK_SCALED.among(wrong) {
        value += 20.0 * libm::log10(k);
    }
    if wrong.contains(&"divided_by_pixels") {
        let shape = input(&a, "target").shape();
        value -= 10.0 * libm::log10((shape[0] * shape[3]) as f64);
    }
    if wrong.contains(&"channels_not_counted") {
        value -= 10.0 * libm::log10(input(&a, "target").shape()[3] as f64);
    }
    if wrong.contains(&"root_for_mean_square") {
        value *= 0.5;
    }
    if wrong.contains(&"doubled_psnr") {
        value *= 2.0;
    }
    if wrong.contains(&"natural_log_psnr") {
        value *= std::f64::consts::LN_10;
    }
    arrays([("value", scalar(value))])
}
