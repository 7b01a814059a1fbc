//! Structural similarity, wrong on purpose. Without a mistake every function equals the oracle.

use ndarray::{Array3, ArrayView1, ArrayView3, Axis, s};

use super::arrays::{form, forward, peak, picture, vjp};
use super::{Form, Moments, Windows, backward, reach, ssim as oracle, value};
use crate::contract::arrays::{Arrays, number};
use crate::contract::component::Mistake;
use crate::convention::{Conventions, SsimWindow};

mod catalogue;
pub(crate) mod laws;

pub(crate) use catalogue::SSIM;
use catalogue::{EPS_BELOW, FIRST_CONSTANT, OTHER_WIDTH, SECOND_CONSTANT};

/// Similarity from moments, by what is wrong about it.
fn wrong_value(a: ArrayView3<f64>, b: ArrayView3<f64>, peak: f64, form: Form, wrong: &[&str]) -> f64 {
    let has = |name: &str| wrong.contains(&name);
    if has("one_window") || has("one_window_corrected") {
        return global(a, b, peak, has("one_window_corrected"));
    }
    let corrected = has("one_window_of_each_channel_corrected");
    if has("one_window_of_each_channel") || corrected {
        let of = |c: usize| global(a.slice(s![.., .., c..=c]), b.slice(s![.., .., c..=c]), peak, corrected);
        return (0..a.dim().2).map(of).sum::<f64>() / a.dim().2 as f64;
    }
    let (windows, places) = wrong_windows(a, b, form, wrong);
    let n = windows.weights.len().pow(2) as f64;
    let mut sum = 0.0;
    for &place in &places {
        let mut m = match () {
            () if has("window_over_channels") => over_channels(&windows, place),
            () => windows.moments(place),
        };
        if has("covariance_not_corrected") {
            let corrected = if windows.unbiased == 1.0 { n / (n - 1.0) } else { 1.0 };
            (m.var_a, m.var_b, m.cov) = (corrected * m.var_a, corrected * m.var_b, m.cov / windows.unbiased);
        }
        if has("squared_means_kept") {
            m.var_a += m.mean_a * m.mean_a;
            m.var_b += m.mean_b * m.mean_b;
            m.cov += m.mean_a * m.mean_b;
        }
        match () {
            () if has("deviations_for_covariance") => m.cov = (m.var_a * m.var_b).sqrt(),
            () if has("variances_squared") => (m.var_a, m.var_b) = (m.var_a * m.var_a, m.var_b * m.var_b),
            () if has("covariance_without_sign") => m.cov = m.cov.abs(),
            () if has("negative_covariance_zero") => m.cov = m.cov.max(0.0),
            () => {}
        }
        let [mut luminance, mut over, mut structure, mut under] = m.parts(peak);
        let [mut c1, mut c2] = [0.01, 0.03].map(|k: f64| (k * peak) * (k * peak));
        let [was_1, was_2] = [c1, c2];
        match () {
            () if has("constants_exchanged") => (c1, c2) = (c2, c1),
            () if has("constants_of_tenths") => {
                (c1, c2) = (0.1 * peak * (0.1 * peak), 0.3 * peak * (0.3 * peak))
            }
            () if has("constants_not_squared") => (c1, c2) = (0.01 * peak, 0.03 * peak),
            () if has("factors_not_squared") => (c1, c2) = (0.01 * peak * peak, 0.03 * peak * peak),
            () => {}
        }
        let own = |constant: &Mistake, c: f64| constant.among(wrong).map_or(c, |k| (k * peak) * (k * peak));
        let (more_1, more_2) = (own(&FIRST_CONSTANT, c1) - was_1, own(&SECOND_CONSTANT, c2) - was_2);
        (luminance, over, structure, under) =
            (luminance + more_1, over + more_1, structure + more_2, under + more_2);
        if has("sum_of_means_squared") {
            over += 2.0 * m.mean_a * m.mean_b;
        }
        if has("covariance_once") {
            structure -= m.cov;
        }
        let similarity = match EPS_BELOW.among(wrong) {
            Some(eps) => luminance * structure / (over * under + eps),
            None if has("luminance_dropped") => structure / under,
            None => luminance / over * structure / under,
        };
        sum += if has("clipped_at_zero") { similarity.clamp(0.0, 1.0) } else { similarity };
    }
    let value = sum / places.len() as f64;
    if has("dissimilarity") { 1.0 - value } else { value }
}

/// Windows as the mistakes have them, and which of these are looked at.
fn wrong_windows<'a>(
    a: ArrayView3<'a, f64>,
    b: ArrayView3<'a, f64>,
    form: Form,
    wrong: &[&str],
) -> (Windows<'a>, Vec<[usize; 3]>) {
    let has = |name: &str| wrong.contains(&name);
    let mut windows = Windows::new(a, b, form);
    let (height, width, _) = a.dim();
    let even = |n: usize| Some(vec![1.0 / n as f64; n]);
    let centered = |n: i32, width: f64| Some(bell((0..n).map(|k| f64::from(k - n / 2)), width));
    // Another window than the convention's would undo it.
    let own = match () {
        () if form.window != SsimWindow::Gaussian => None,
        () if has("box_of_eight") => even(8),
        () if has("seven_wide") => centered(7, 1.5),
        () if has("three_wide") => centered(3, 1.5),
        () if has("window_by_its_integral") => {
            let whole = 1.5 * (2.0 * std::f64::consts::PI).sqrt();
            Some((-5..6).map(|i| crate::math::exp(-0.5 * (f64::from(i) / 1.5).powi(2)) / whole).collect())
        }
        () if has("center_half_off") => Some(bell((0..11).map(|i| f64::from(i) - 5.5), 1.5)),
        () if has("window_of_one_side") => {
            Some(bell((0..11).map(|i: i32| f64::from((i - 11).div_euclid(2))), 1.5))
        }
        () => OTHER_WIDTH.among(wrong).and_then(|width| centered(11, width)),
    };
    if let Some(weights) = own {
        [windows.rows, windows.columns] =
            [height, width].map(|length| reach(length, weights.len(), form.padding));
        windows.weights = weights;
    }
    let beyond: Option<fn(i64, i64) -> i64> = match () {
        () if has("border_repeated") => Some(|n, length| n.clamp(0, length - 1)),
        () if has("border_around") => Some(|n, length| n.rem_euclid(length)),
        () if has("window_over_channels") => Some(mirrored),
        () => None,
    };
    if let Some(pixel) = beyond {
        let size = windows.weights.len() as i64;
        let about =
            |n: i64, length: i64| (n..n + size).map(|n| Some(pixel(n - size / 2, length) as usize)).collect();
        [windows.rows, windows.columns] =
            [height as i64, width as i64].map(|length| (0..length).map(|n| about(n, length)).collect());
    }
    if has("window_across_alone") {
        windows.rows = (0..height).map(|j| vec![Some(j); windows.weights.len()]).collect();
    }
    let step = if has("windows_side_by_side") { windows.weights.len() } else { 1 };
    let looked_at =
        |[j, i, c]: &[usize; 3]| j % step == 0 && i % step == 0 && (*c == 0 || !has("first_channel_alone"));
    let places = windows.places().into_iter().filter(looked_at).collect();
    (windows, places)
}

/// A Gaussian at these places, as weights that add up to 1.
fn bell(places: impl Iterator<Item = f64>, width: f64) -> Vec<f64> {
    let all: Vec<f64> = places.map(|x| crate::math::exp(-0.5 * (x / width).powi(2))).collect();
    let sum: f64 = all.iter().sum();
    all.iter().map(|w| w / sum).collect()
}

/// The place that n stands for beyond a border which mirrors, as scipy's filters have it: the last one comes twice.
fn mirrored(n: i64, length: i64) -> i64 {
    let n = n.rem_euclid(2 * length);
    n.min(2 * length - 1 - n)
}

/// Moments of a window that reaches over the channels too: each channel's within, and how far its means are off those of all.
fn over_channels(windows: &Windows, [j, i, c]: [usize; 3]) -> Moments {
    let channels = windows.a.dim().2;
    let of_channel: Vec<Moments> = (0..channels).map(|c| windows.moments([j, i, c])).collect();
    let mut shares = vec![0.0; channels];
    let before = (windows.weights.len() / 2) as i64;
    for (n, weight) in windows.weights.iter().enumerate() {
        shares[mirrored((c + n) as i64 - before, channels as i64) as usize] += weight;
    }
    let mean = |of: fn(&Moments) -> f64| of_channel.iter().zip(&shares).map(|(m, w)| w * of(m)).sum::<f64>();
    let (mean_a, mean_b) = (mean(|m| m.mean_a), mean(|m| m.mean_b));
    let mut all = Moments { mean_a, mean_b, var_a: 0.0, var_b: 0.0, cov: 0.0 };
    for (m, share) in of_channel.iter().zip(&shares) {
        let (a, b, unbiased) = (m.mean_a - mean_a, m.mean_b - mean_b, windows.unbiased);
        all.var_a += share * (m.var_a + unbiased * a * a);
        all.var_b += share * (m.var_b + unbiased * b * b);
        all.cov += share * (m.cov + unbiased * a * b);
    }
    all
}

/// That of one window over everything; its variances divided by n, or n - 1 alone.
fn global(a: ArrayView3<f64>, b: ArrayView3<f64>, peak: f64, corrected: bool) -> f64 {
    let n = a.len() as f64;
    let mean = [&a, &b].map(|x| x.sum() / n);
    let spread = |x: &ArrayView3<f64>, y: &ArrayView3<f64>, [p, q]: [f64; 2]| {
        x.iter().zip(y).map(|(x, y)| (x - p) * (y - q)).sum::<f64>() / n
    };
    let more = if corrected { n / (n - 1.0) } else { 1.0 };
    let (var_a, var_b) = (more * spread(&a, &a, [mean[0]; 2]), more * spread(&b, &b, [mean[1]; 2]));
    let m = Moments { mean_a: mean[0], mean_b: mean[1], var_a, var_b, cov: spread(&a, &b, mean) };
    let [luminance, over, structure, under] = m.parts(peak);
    luminance * structure / (over * under)
}

/// The shares of red, green and blue in a television's luma (ITU-R BT.601).
const LUMA: [f64; 3] = [0.299, 0.587, 0.114];

/// The peak with what is wrong about it.
fn wrong_peak(a: &Arrays, c: &Conventions, wrong: &[&str]) -> f64 {
    let target = picture(a, "target");
    let ends = target.iter().fold([f64::MAX, f64::MIN], |[low, high], x| [low.min(*x), high.max(*x)]);
    match () {
        () if wrong.contains(&"peak_255") => 255.0,
        () if wrong.contains(&"peak_of_target") => ends[1] - ends[0],
        () => peak(a, c),
    }
}

/// Similarity.
pub(crate) fn ssim(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let (p, t, peak) = (picture(a, "prediction"), picture(a, "target"), wrong_peak(a, c, wrong));
    let gray = |x: ArrayView3<f64>| (x.sum_axis(Axis(2)) / x.dim().2 as f64).insert_axis(Axis(2));
    let luma = |x: ArrayView3<f64>| {
        let of = |color: ArrayView1<f64>| color.iter().zip(LUMA).map(|(x, share)| x * share).sum::<f64>();
        x.map_axis(Axis(2), of).insert_axis(Axis(2))
    };
    forward(match wrong {
        [] => oracle(p, t, peak, form(c)),
        _ if wrong.contains(&"gray_pictures") => {
            wrong_value(gray(p).view(), gray(t).view(), peak, form(c), wrong)
        }
        _ if wrong.contains(&"through_gamma") => {
            let [p, t] = [p, t].map(|x| x.mapv(|x| crate::math::pow(x.max(0.0), 1.0 / 2.2)));
            wrong_value(p.view(), t.view(), peak, form(c), wrong)
        }
        // Whatever has another number of channels is taken as it is.
        _ if wrong.contains(&"luma_pictures") && p.dim().2 == 3 => {
            wrong_value(luma(p).view(), luma(t).view(), peak, form(c), wrong)
        }
        _ => wrong_value(p, t, peak, form(c), wrong),
    })
}

/// How a window's similarity changes with the prediction's mean and variance, and with the covariance.
fn slopes(m: &Moments, peak: f64, unbiased: f64) -> [f64; 3] {
    let [luminance, over, structure, under] = m.parts(peak);
    let similarity = luminance * structure / (over * under);
    let of_mean = 2.0 * (m.mean_b * structure / (over * under) - similarity * m.mean_a / over);
    [of_mean, -unbiased * similarity / under, 2.0 * unbiased * luminance / (over * under)]
}

/// The gradient by windows: of means, of the rest, or to the pixel in the middle alone.
fn wrong_gradient(
    p: ArrayView3<f64>,
    t: ArrayView3<f64>,
    peak: f64,
    form: Form,
    g: f64,
    wrong: &str,
) -> Array3<f64> {
    let windows = Windows::new(p, t, form);
    let mut gradient = Array3::zeros(p.dim());
    let each = g / windows.places().len() as f64;
    for place in windows.places() {
        let m = windows.moments(place);
        let [of_mean, of_var, of_cov] = slopes(&m, peak, windows.unbiased);
        let pixels = windows.pixels(place);
        for (n, (weight, at)) in pixels.iter().enumerate() {
            let Some(at) = *at else { continue };
            let spread =
                of_cov * (value(&t, Some(at)) - m.mean_b) + 2.0 * of_var * (value(&p, Some(at)) - m.mean_a);
            gradient[at] += each
                * match wrong {
                    "means_held" => weight * spread,
                    "variances_held" => weight * of_mean,
                    _ if n == pixels.len() / 2 => of_mean + spread,
                    _ => 0.0,
                };
        }
    }
    gradient
}

/// The gradient of windows beyond whose border pixels are repeated, by the same windows again: a pixel of the border has its part of those
/// that stand for it in its neighbors' windows once.
fn repeated(p: ArrayView3<f64>, t: ArrayView3<f64>, peak: f64, form: Form, g: f64) -> Array3<f64> {
    let (windows, places) = wrong_windows(p, t, form, &["border_repeated"]);
    // dS over the mean, the variance and the covariance, and these times the means.
    let mut maps: [Array3<f64>; 5] = std::array::from_fn(|_| Array3::zeros(p.dim()));
    for &place in &places {
        let m = windows.moments(place);
        let [of_mean, of_var, of_cov] = slopes(&m, peak, windows.unbiased);
        let all = [of_mean, of_var, of_var * m.mean_a, of_cov, of_cov * m.mean_b];
        maps.iter_mut().zip(all).for_each(|(map, x)| map[place] = x);
    }
    let mut gradient = Array3::zeros(p.dim());
    for &place in &places {
        let pixels = windows.pixels(place);
        let mean =
            |map: &Array3<f64>| pixels.iter().map(|(w, at)| at.map_or(0.0, |at| w * map[at])).sum::<f64>();
        let [m, q, qm, r, rm] = maps.each_ref().map(mean);
        gradient[place] = m + 2.0 * (p[place] * q - qm) + t[place] * r - rm;
    }
    gradient * (g / places.len() as f64)
}

/// Its gradient.
pub(crate) fn ssim_vjp(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let (p, t, peak, g) =
        (picture(a, "prediction"), picture(a, "target"), peak(a, c), number(a, "grad_value"));
    let held = ["means_held", "variances_held", "center_alone"].into_iter().find(|name| wrong.contains(name));
    let mut gradient = match held {
        _ if wrong.contains(&"border_repeated_both_ways") => repeated(p, t, peak, form(c), g),
        Some(name) => wrong_gradient(p, t, peak, form(c), g, name),
        None => backward::ssim(p, t, peak, form(c), g),
    };
    if wrong.contains(&"mean_forgotten") {
        gradient *= Windows::new(p, t, form(c)).places().len() as f64;
    }
    vjp(if wrong.contains(&"gradient_of_the_loss") { -gradient } else { gradient })
}
