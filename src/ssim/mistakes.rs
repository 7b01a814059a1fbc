//! Structural similarity, wrong on purpose. Without a mistake every function equals the oracle.

use ndarray::{Array3, ArrayView1, ArrayView3, Axis};

use super::arrays::{form, forward, peak, picture, vjp};
use super::{Form, Windows, backward, ssim as oracle, value};
use crate::contract::arrays::{Arrays, number};
use crate::contract::component::Mistake;
use crate::convention::Conventions;

/// Mistakes of structural similarity.
pub(crate) const SSIM: &[Mistake] = &[
    Mistake::new(
        "one_window",
        "means and variances of the whole picture: one window, without weights",
        "a blurred picture scores like a sharp one; figures that can't be compared",
        "a window about each pixel, and the mean of their similarities",
        "2 public implementations of metrics",
        2,
    ),
    Mistake::new(
        "gray_pictures",
        "the similarity of the mean over channels",
        "wrong hues cost nothing",
        "channel by channel, then the mean",
        "scripts that convert to gray first",
        0,
    ),
    Mistake::new(
        "luma_pictures",
        "the similarity of 0.299 R + 0.587 G + 0.114 B",
        "wrong blues cost next to nothing",
        "channel by channel, then the mean",
        "a city's renderer, and losses that take Y alone",
        2,
    ),
    Mistake::new(
        "dissimilarity",
        "1 - SSIM, the loss, reported as SSIM",
        "the better the smaller",
        "leave 1 - to the loss",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "constants_not_squared",
        "c1 = 0.01 peak, c2 = 0.03 peak",
        "values close to 1 whatever the pictures",
        "(0.01 peak)^2 and (0.03 peak)^2",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "squared_means_kept",
        "E[a^2] for the variance, E[a b] for the covariance",
        "bright pictures are alike whatever is on them",
        "subtract the squared mean, and the product of the means",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "luminance_dropped",
        "the contrast and structure of MS-SSIM's coarser scales alone",
        "a picture that is too dark all over scores 1",
        "times (2 ma mb + c1) / (ma^2 + mb^2 + c1)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "peak_255",
        "constants of bytes for colors in [0, 1]",
        "0.999 for anything",
        "peak is the largest value that a color may have",
        "scripts that were written for bytes",
        0,
    ),
    Mistake::new(
        "peak_of_target",
        "the target's range, its largest value less its smallest, for the peak",
        "figures that differ from picture to picture",
        "peak is the largest value that a color may have",
        "scripts with data_range = target.max() - target.min(); torchmetrics without data_range takes the wider range of both",
        3,
    ),
    Mistake::new(
        "mean_forgotten",
        "the gradient of the sum over windows",
        "a loss that outweighs the other one by the number of pixels",
        "divide by the number of windows and channels",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "gradient_of_the_loss",
        "the gradient of 1 - SSIM",
        "the caller's 1 - is differentiated twice: pictures become unlike",
        "leave 1 - to the caller",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "means_held",
        "the gradient through variances and covariance alone",
        "brightness is never corrected",
        "and through the means",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "variances_held",
        "the gradient through the means alone",
        "a loss of blurred pictures: no detail comes back",
        "and through variances and covariance",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "center_alone",
        "each window passes its gradient to the pixel in its middle",
        "noise: most of the gradient is with the neighbors",
        "every pixel of a window by its weight: the transposed filter",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
];

/// Similarity from moments, by what is wrong about it.
fn wrong_value(a: ArrayView3<f64>, b: ArrayView3<f64>, peak: f64, form: Form, wrong: &[&str]) -> f64 {
    let has = |name: &str| wrong.contains(&name);
    if has("one_window") {
        return global(a, b, peak);
    }
    let windows = Windows::new(a, b, form);
    let mut sum = 0.0;
    for place in windows.places() {
        let mut m = windows.moments(place);
        if has("squared_means_kept") {
            m.var_a += m.mean_a * m.mean_a;
            m.var_b += m.mean_b * m.mean_b;
            m.cov += m.mean_a * m.mean_b;
        }
        let [mut luminance, mut over, mut structure, mut under] = m.parts(peak);
        if has("constants_not_squared") {
            let more = [0.01 * peak * (1.0 - 0.01 * peak), 0.03 * peak * (1.0 - 0.03 * peak)];
            (luminance, over, structure, under) =
                (luminance + more[0], over + more[0], structure + more[1], under + more[1]);
        }
        let luminance = if has("luminance_dropped") { 1.0 } else { luminance / over };
        sum += luminance * structure / under;
    }
    let value = sum / windows.places().len() as f64;
    if has("dissimilarity") { 1.0 - value } else { value }
}

/// That of one window over everything.
fn global(a: ArrayView3<f64>, b: ArrayView3<f64>, peak: f64) -> f64 {
    let n = a.len() as f64;
    let mean = [&a, &b].map(|x| x.sum() / n);
    let spread = |x: &ArrayView3<f64>, y: &ArrayView3<f64>, [p, q]: [f64; 2]| {
        x.iter().zip(y).map(|(x, y)| (x - p) * (y - q)).sum::<f64>() / n
    };
    let (var_a, var_b) = (spread(&a, &a, [mean[0]; 2]), spread(&b, &b, [mean[1]; 2]));
    let m = super::Moments { mean_a: mean[0], mean_b: mean[1], var_a, var_b, cov: spread(&a, &b, mean) };
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
    // Of fewer channels than three, the first ones' shares.
    let luma = |x: ArrayView3<f64>| {
        let shares = &LUMA[..x.dim().2.min(3)];
        let of = |color: ArrayView1<f64>| color.iter().zip(shares).map(|(x, share)| x * share).sum::<f64>();
        (x.map_axis(Axis(2), of) / shares.iter().sum::<f64>()).insert_axis(Axis(2))
    };
    forward(match wrong {
        [] => oracle(p, t, peak, form(c)),
        _ if wrong.contains(&"gray_pictures") => {
            wrong_value(gray(p).view(), gray(t).view(), peak, form(c), wrong)
        }
        _ if wrong.contains(&"luma_pictures") => {
            wrong_value(luma(p).view(), luma(t).view(), peak, form(c), wrong)
        }
        _ => wrong_value(p, t, peak, form(c), wrong),
    })
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
        let [luminance, over, structure, under] = m.parts(peak);
        let similarity = luminance * structure / (over * under);
        let of_mean = 2.0 * (m.mean_b * structure / (over * under) - similarity * m.mean_a / over);
        let of_cov = 2.0 * windows.unbiased * luminance / (over * under);
        let of_var = -2.0 * windows.unbiased * similarity / under;
        let pixels = windows.pixels(place);
        for (n, (weight, at)) in pixels.iter().enumerate() {
            let Some(at) = *at else { continue };
            let spread =
                of_cov * (value(&t, Some(at)) - m.mean_b) + of_var * (value(&p, Some(at)) - m.mean_a);
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

/// Its gradient.
pub(crate) fn ssim_vjp(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let (p, t, peak, g) =
        (picture(a, "prediction"), picture(a, "target"), peak(a, c), number(a, "grad_value"));
    let right = || backward::ssim(p, t, peak, form(c), g);
    vjp(match wrong.first() {
        Some(&"mean_forgotten") => right() * Windows::new(p, t, form(c)).places().len() as f64,
        Some(&"gradient_of_the_loss") => -right(),
        Some(name @ (&"means_held" | &"variances_held" | &"center_alone")) => {
            wrong_gradient(p, t, peak, form(c), g, name)
        }
        _ => right(),
    })
}
