//! Honest implementations of loss, metric and bytes in emulated arithmetic.

use std::f64::consts::LN_10;

use super::arrays::{like, peak, pictures};
use crate::contract::arrays::{Arrays, arrays, input, number, scalar, values};
use crate::contract::machine::Machine;
use crate::convention::{Bytes, Conventions, PsnrFloor, PsnrOf};
use crate::math::{ln, log10};

/// The sum over n, or times 1 / n.
fn mean(terms: &[f64], m: &Machine) -> f64 {
    let (sum, n) = (m.sum(terms), terms.len() as f64);
    if m.form % 2 == 0 { m.div(sum, n) } else { m.mul(sum, m.div(1.0, n)) }
}

fn mean_square(p: &[f64], t: &[f64], m: &Machine) -> f64 {
    let d: Vec<f64> = p.iter().zip(t).map(|(&p, &t)| m.sub(p, t)).collect();
    mean(&d.iter().map(|&d| if m.fused { d * d } else { m.mul(d, d) }).collect::<Vec<_>>(), m)
}

/// Mean squared error.
pub(crate) fn mse(a: &Arrays, _: &Conventions, m: &Machine) -> Arrays {
    arrays([("value", scalar(mean_square(&values(a, "prediction"), &values(a, "target"), m)))])
}

/// Its gradient, scaled first or last.
pub(crate) fn mse_vjp(a: &Arrays, _: &Conventions, m: &Machine) -> Arrays {
    let (p, t, g) = (values(a, "prediction"), values(a, "target"), number(a, "grad_value"));
    let n = p.len() as f64;
    let gradient = |(&p, &t): (&f64, &f64)| {
        let d = m.sub(p, t);
        match m.form % 2 {
            0 => m.mul(m.mul(m.div(2.0, n), g), d),
            _ => m.div(m.mul(m.mul(2.0, d), g), n),
        }
    };
    arrays([("grad_prediction", like(a, "prediction", p.iter().zip(&t).map(gradient).collect()))])
}

/// By log10 or ln, of the quotient or as a difference.
fn decibels(error: f64, peak: f64, m: &Machine) -> f64 {
    let log_10 = |x: f64| match m.form % 3 {
        2 => m.div(m.elementary(ln(x)), m.round(LN_10)),
        _ => m.elementary(log10(x)),
    };
    match m.form % 2 {
        0 => m.mul(-10.0, log_10(m.div(error, m.mul(peak, peak)))),
        _ => m.sub(m.mul(20.0, log_10(peak)), m.mul(10.0, log_10(error))),
    }
}

/// The error kept away from 0: at least 1e-7, or 1e-8 more, of the squared peak.
fn floored(error: f64, peak: f64, floor: PsnrFloor, m: &Machine) -> f64 {
    let square = m.mul(peak, peak);
    match floor {
        PsnrFloor::None => error,
        PsnrFloor::Small if m.form % 2 == 0 => error.max(m.mul(m.round(1e-7), square)),
        PsnrFloor::Small => m.add(error, m.mul(m.round(1e-8), square)),
    }
}

/// Peak signal-to-noise ratio.
pub(crate) fn psnr(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    let (predictions, targets) = (pictures(a, "prediction"), pictures(a, "target"));
    let each: Vec<f64> = predictions.iter().zip(&targets).map(|(p, t)| mean_square(p, t, m)).collect();
    let peak = peak(a, c);
    let decibels = |error| decibels(floored(error, peak, c.psnr_floor, m), peak, m);
    let value = match c.psnr {
        PsnrOf::Images => mean(&each.iter().map(|&e| decibels(e)).collect::<Vec<_>>(), m),
        PsnrOf::MeanError if m.form % 2 == 0 => decibels(mean(&each, m)),
        PsnrOf::MeanError => decibels(mean_square(&predictions.concat(), &targets.concat(), m)),
    };
    arrays([("value", scalar(value))])
}

/// Bytes by rounding to even, or by a shift of one half.
pub(crate) fn to_uint8(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    let byte = |x: f64| {
        let y = m.mul(x.clamp(0.0, 1.0), 255.0);
        match c.bytes {
            Bytes::Truncate => y.floor(),
            Bytes::Round if m.form % 2 == 0 => libm::rint(y),
            Bytes::Round => m.add(y, 0.5).floor().min(255.0),
        }
    };
    arrays([("bytes", input(a, "image").mapv(byte))])
}
