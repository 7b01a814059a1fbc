//! Bytes, wrong on purpose.

use crate::contract::arrays::{Arrays, arrays, input};
use crate::contract::component::Mistake;
use crate::convention::{Bytes, Conventions};
use crate::loss::arrays::{self, like};

const SIGN_GUESSED: Mistake = Mistake::new(
    "sign_guessed",
    "(x + 1) / 2 where a number of the picture is below -k",
    "one number that is too dark, and the whole picture is pale",
    "the range is known: clip to [0, 1] and multiply by 255",
    "1 public implementation and its copies, with 0.2",
    2,
)
.with("k", 0.2, [1e-6, 0.999]);

const STRETCHED_TO_QUANTILES: Mistake = Mistake::new(
    "stretched_to_quantiles",
    "what lies between the quantiles q and 1 - q is stretched to [0, 255]",
    "every picture has another brightness; PSNR of such files means nothing",
    "clip to [0, 1] and multiply by 255",
    "a viewer of depth maps, with 0.02",
    1,
)
.with("q", 0.02, [1e-4, 0.4]);

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
        "times_256_wrapped",
        "256 x, clipped before: 1 becomes 256, which is 0 in a byte",
        "black specks in the whitest places",
        "round(255 x)",
        "a denoiser of digits",
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
    STRETCHED_TO_QUANTILES,
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
    Mistake::new(
        "scale_guessed",
        "times 255 only where no number of the picture is above 1",
        "one highlight, and the whole picture is black",
        "the scale is known: clip to [0, 1] and multiply by 255",
        "1 public implementation",
        1,
    ),
    SIGN_GUESSED,
    Mistake::new(
        "divided_by_the_largest",
        "x / max x, then bytes",
        "every picture has another brightness",
        "clip to [0, 1]",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "divided_where_above_one",
        "x / max x where that is above 1",
        "one highlight darkens the whole picture",
        "clip to [0, 1]",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "clipped_above_alone",
        "min(x, 1): what is below 0 wraps around",
        "white specks in the darkest places",
        "clip to [0, 1]",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "clipped_below_alone",
        "max(x, 0): what is above 1 wraps around",
        "black specks in the brightest places",
        "clip to [0, 1]",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "gamma_applied",
        "x^(1/2.2) in front of the bytes",
        "pale pictures, of colors that are sRGB already",
        "bytes of what was trained on",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "sign_forgotten",
        "min(|x|, 1)",
        "bright specks in the darkest places",
        "clip to [0, 1]",
        "never; cheap to keep",
        0,
    ),
];

/// The number that a share q of all, in ascending order, lies below: between the two nearest where it falls between two (as numpy has it).
fn quantile(all: &[f64], q: f64) -> f64 {
    let Some(last) = all.len().checked_sub(1) else { return f64::NAN };
    let place = q * last as f64;
    let n = (place as usize).min(last);
    all[n] + (place - n as f64) * (all[(n + 1).min(last)] - all[n])
}

/// Bytes.
pub(crate) fn to_uint8(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let mut bytes = input(&arrays::to_uint8(a, c), "bytes").clone();
    let image = input(a, "image");
    let most = image.iter().copied().fold(f64::MIN, f64::max);
    let again = |f: &dyn Fn(f64) -> f64| {
        input(&arrays::to_uint8(&arrays([("image", image.mapv(f))]), c), "bytes").clone()
    };
    let whole = |x: f64| match c.bytes {
        Bytes::Round => libm::round(255.0 * x),
        Bytes::Truncate => (255.0 * x).trunc(),
    };
    let least = image.iter().copied().fold(f64::MAX, f64::min);
    let signed = SIGN_GUESSED.among(wrong).is_some_and(|k| least < -k);
    if signed {
        bytes = again(&|x| 0.5 * (x + 1.0));
    }
    if let Some(q) = STRETCHED_TO_QUANTILES.among(wrong) {
        let mut all: Vec<f64> = image.iter().copied().collect();
        all.sort_by(f64::total_cmp);
        let [low, high] = [q, 1.0 - q].map(|q| quantile(&all, q));
        bytes = again(&|x| (x - low) / (high - low));
    }
    for name in wrong {
        bytes = match *name {
            "scale_guessed" if signed => bytes,
            "scale_guessed" if most > 1.0 => again(&|x| x / 255.0),
            "divided_by_the_largest" => again(&|x| x / most),
            "divided_where_above_one" => again(&|x| x / most.max(1.0)),
            "clipped_above_alone" => image.mapv(|x| whole(x.min(1.0)).rem_euclid(256.0)),
            "clipped_below_alone" => image.mapv(|x| whole(x.max(0.0)).rem_euclid(256.0)),
            "gamma_applied" => again(&|x| crate::math::pow(x.clamp(0.0, 1.0), 1.0 / 2.2)),
            "sign_forgotten" => again(&f64::abs),
            _ => bytes,
        };
    }
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
    if wrong.contains(&"times_256_wrapped") {
        bytes = input(a, "image").mapv(|x| (256.0 * x.clamp(0.0, 1.0)).trunc().rem_euclid(256.0));
    }
    if wrong.contains(&"stretched_to_the_range") {
        let image = input(a, "image");
        let (low, high) =
            image.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(*x), h.max(*x)));
        bytes = input(
            &arrays::to_uint8(&arrays([("image", image.mapv(|x| (x - low) / (high - low)))]), c),
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
