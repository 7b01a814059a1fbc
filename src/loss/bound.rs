//! Error bounds of loss, metric and bytes.

use std::f64::consts::LN_10;

use super::arrays::{like, peak, pictures};
use crate::contract::arithmetic::Arithmetic;
use crate::contract::arrays::{Arrays, arrays, input, number, scalar, values};
use crate::contract::bounded::{Bounded, exact};
use crate::convention::{Bytes, Conventions, PsnrFloor, PsnrOf};
use crate::math::{ln_1p, log10};

/// The mean of squared differences: differences, squares, a sum in any order, one division (or a product with 1 / n).
fn mean_square(p: &[f64], t: &[f64], m: &Arithmetic) -> Bounded {
    mean_square_of(&p.iter().copied().map(exact).collect::<Vec<_>>(), t, m)
}

/// The same of predictions with errors of their own.
pub(crate) fn mean_square_of(p: &[Bounded], t: &[f64], m: &Arithmetic) -> Bounded {
    let square = |(&p, &t): (&Bounded, &f64)| {
        let d = m.sub(p, exact(t));
        m.mul(d, d)
    };
    let sum = m.sum(&p.iter().zip(t).map(square).collect::<Vec<_>>());
    m.mul(sum, m.div(exact(1.0), exact(p.len() as f64)))
}

/// Bound of [`super::mse`].
pub(crate) fn mse(a: &Arrays, _: &Conventions, m: &Arithmetic) -> Arrays {
    arrays([("value", scalar(mean_square(&values(a, "prediction"), &values(a, "target"), m).e))])
}

/// Bound of [`super::backward::mse`]: ((2 / n) g) (p - t), or (2 (p - t)) g / n.
pub(crate) fn mse_vjp(a: &Arrays, _: &Conventions, m: &Arithmetic) -> Arrays {
    let (p, t) = (values(a, "prediction"), values(a, "target"));
    let (g, n) = (number(a, "grad_value"), p.len());
    let error = |(&p, &t): (&f64, &f64)| slope_of(exact(p), t, g, n, m).e;
    arrays([("grad_prediction", like(a, "prediction", p.iter().zip(&t).map(error).collect()))])
}

/// One of n predictions' part of the gradient, where the prediction has an error of its own.
pub(crate) fn slope_of(p: Bounded, t: f64, g: f64, n: usize, m: &Arithmetic) -> Bounded {
    let (d, g, n) = (m.sub(p, exact(t)), exact(g), exact(n as f64));
    let scale_first = m.mul(m.mul(m.div(exact(2.0), n), g), d);
    scale_first.or(m.div(m.mul(m.mul(exact(2.0), d), g), n))
}

/// 10 log10(peak^2 / error): the ratio's relative error becomes an absolute one; or the difference of two logarithms.
fn decibels(error: Bounded, peak: f64, m: &Arithmetic) -> Bounded {
    let y = super::psnr(error.y, peak);
    if error == exact(0.0) {
        return exact(y);
    }
    let ratio = m.div(error, m.mul(exact(peak), exact(peak)));
    let quotient = m.mul(exact(-10.0), log_10(ratio, m));
    // For a peak of 1 the second logarithm is 0, so nothing is rounded.
    let of_peak = if peak == 1.0 { exact(0.0) } else { m.mul(exact(20.0), log_10(exact(peak), m)) };
    let difference = m.sub(of_peak, m.mul(exact(10.0), log_10(error, m)));
    let worst = quotient.e.max(difference.e);
    Bounded { y, e: worst }
}

/// The decimal logarithm of a positive number. With b = 0.4343 ln x its error is 0.4343 ln(1 - e / x), and that of `ln(x) / ln(10)`.
fn log_10(x: Bounded, m: &Arithmetic) -> Bounded {
    let carried = if x.e < x.y { -ln_1p(-x.e / x.y) / LN_10 } else { f64::INFINITY };
    let direct = m.elementary(log10(x.y), carried);
    let by_ln = m.div(direct, m.rounded(1.0, 0.0));
    Bounded { y: direct.y, e: direct.e.max(by_ln.e) }
}

/// The same where a number up to 1e-6 peak^2 may have been added to the error, or may be its least; for equal pictures anything from 40 to
/// 160 dB.
fn floored(error: Bounded, peak: f64, floor: PsnrFloor, m: &Arithmetic) -> Bounded {
    if floor == PsnrFloor::None {
        return decibels(error, peak, m);
    }
    let (least, most) = (1e-10 * peak * peak, 1e-6 * peak * peak);
    let y = super::psnr(error.y.max(least), peak);
    if error.y == 0.0 {
        // From 100 dB on half of the way to either end: the oracle's own error, which is added, is as large. Half precision doesn't hold
        // such numbers.
        return Bounded { y, e: if most > 1e3 * m.tiny { 30.0 } else { f64::INFINITY } };
    }
    let raised = Bounded { y: error.y + most, ..error };
    let reach = |b: Bounded| (b.y - y).abs() + b.e;
    Bounded { y, e: reach(decibels(error, peak, m)).max(reach(decibels(raised, peak, m))) }
}

/// Bound of [`super::psnr_of_images`].
pub(crate) fn psnr(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    let (predictions, targets) = (pictures(a, "prediction"), pictures(a, "target"));
    let errors: Vec<Bounded> = predictions.iter().zip(&targets).map(|(p, t)| mean_square(p, t, m)).collect();
    let peak = peak(a, c);
    let mean = |terms: &[Bounded]| m.mul(m.sum(terms), m.div(exact(1.0), exact(terms.len() as f64)));
    let e = match c.psnr {
        PsnrOf::Images => {
            let each: Vec<Bounded> =
                errors.iter().map(|&error| floored(error, peak, c.psnr_floor, m)).collect();
            // One infinite PSNR makes the mean infinite, in every arithmetic (ME1).
            if each.iter().any(|b| b.y.is_infinite()) { 0.0 } else { mean(&each).e }
        }
        // The mean over all pixels, or the mean of the pictures' means.
        PsnrOf::MeanError => {
            let all = mean_square(&predictions.concat(), &targets.concat(), m);
            floored(all, peak, c.psnr_floor, m).e.max(floored(mean(&errors), peak, c.psnr_floor, m).e)
        }
    };
    arrays([("value", scalar(e))])
}

/// Bound of [`super::to_uint8`]: 0 where every honest 255 x gives the same byte, otherwise the distance to the other byte.
pub(crate) fn to_uint8(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    let byte = |y: f64| match c.bytes {
        Bytes::Round => libm::round(y),
        Bytes::Truncate => y.floor(),
    };
    let error = |x: f64| {
        let scaled = m.mul(exact(x.clamp(0.0, 1.0)), exact(255.0));
        // floor(255 x + 0.5) rounds once more.
        let shifted = if c.bytes == Bytes::Round { m.add(scaled, exact(0.5)).e } else { scaled.e };
        if scaled.y == 0.0 || scaled.y == 255.0 {
            return 0.0;
        }
        let reach = |y: f64| (byte(y.clamp(0.0, 255.0)) - byte(scaled.y)).abs();
        reach(scaled.y - shifted).max(reach(scaled.y + shifted))
    };
    arrays([("bytes", input(a, "image").mapv(error))])
}
