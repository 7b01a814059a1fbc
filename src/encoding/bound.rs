//! Error bounds of the positional encoding.
//!
//! Grade A reduces 2^k x exactly before anything is multiplied by pi; grade B forms the product 2^k pi x, whose rounding, times the
//! slope, is the error: 2^9 pi x in f32 is off by up to 2e-4. cos as sin(x + pi/2) loses the sum's rounding (PE2): a convention, with a bound
//! of its own.

use super::arrays::{dims, settings};
use super::{Encoding, factor, wave};
use crate::contract::arithmetic::{Arithmetic, Grade};
use crate::contract::arrays::{Arrays, arrays, from_rows, rows};
use crate::contract::bounded::{Bounded, exact};
use crate::convention::{Bands, Conventions, Cosine, Frequency};
use crate::math::ln;

/// (sin, cos) of factor f_k x with their errors.
pub(crate) fn waves(
    encoding: &Encoding,
    cosine: Cosine,
    k: usize,
    x: f64,
    m: &Arithmetic,
) -> (Bounded, Bounded) {
    let (sin, cos) = wave(encoding.frequency, encoding.band(k), x);
    let scale = factor(encoding.frequency) * encoding.band(k);
    let off = argument_error(encoding, cosine, k, scale * x, m) + shifted(cosine, scale * x, m);
    // |sin(a + e) - sin(a)| <= |cos a| e + e^2 / 2, and no more than 2.
    let bounded = |y: f64, slope: f64| {
        let carried = if off.is_finite() { (slope.abs() * off + 0.5 * off * off).min(2.0) } else { off };
        // After an exact reduction, pi and the product are rounded: |r cos r| <= |sin r|, so the error is relative to the result.
        let reduced = if encoding.frequency == Frequency::One { 0.0 } else { 2.0 * m.u * y.abs() };
        m.elementary(y, carried + reduced)
    };
    (bounded(sin, cos), bounded(cos, sin))
}

/// What sin(a + pi / 2) for the cosine may add to the argument's error: pi / 2 and the sum are rounded; and where a, or the sum, is taken
/// modulo some whole turns, these are rounded, once for each time that they fit into it.
fn shifted(cosine: Cosine, angle: f64, m: &Arithmetic) -> f64 {
    match cosine {
        Cosine::Own => 0.0,
        Cosine::ShiftedSine => m.u * (2.0 * angle.abs() + 2.0 * std::f64::consts::PI) * (1.0 + 4.0 * m.u),
    }
}

/// Error of 2^e for a rounded exponent e, relative to which the power's is e ln 2 u; and of the power itself.
fn power_error(encoding: &Encoding, k: usize, m: &Arithmetic) -> f64 {
    let band = encoding.band(k);
    band * m.u * (m.elementary_ulp + 2.0 * ln(band))
}

/// f_k as honest code has it.
pub(crate) fn band(encoding: &Encoding, k: usize, m: &Arithmetic) -> Bounded {
    match encoding.bands {
        Bands::Octaves => exact(encoding.band(k)),
        Bands::Linear => m.rounded(encoding.band(k), m.u * encoding.band(k)),
        Bands::Stretched | Bands::Widened => m.rounded(encoding.band(k), power_error(encoding, k, m)),
    }
}

/// How far the argument of sin and cos may be off.
fn argument_error(encoding: &Encoding, cosine: Cosine, k: usize, angle: f64, m: &Arithmetic) -> f64 {
    let scale = factor(encoding.frequency) * encoding.band(k);
    // Octaves scale exactly; other bands are themselves rounded (two operations), and their product with x.
    let bands = match encoding.bands {
        Bands::Octaves => 0.0,
        Bands::Linear => 4.0,
        Bands::Stretched | Bands::Widened => 2.0 + m.elementary_ulp + 2.0 * ln(encoding.band(k)),
    };
    // Whoever shifts the sine forms the product.
    let product = m.grade == Grade::B || cosine == Cosine::ShiftedSine;
    let textbook = if product && encoding.frequency != Frequency::One { 2.0 } else { 0.0 };
    let roundings: f64 = bands + textbook;
    // Where the argument or 2^k pi overflows here, it may overflow in an honest implementation.
    if angle.abs().max(scale) * (1.0 + 8.0 * m.u) > m.largest {
        return f64::INFINITY;
    }
    if angle == 0.0 {
        return 0.0;
    }
    let subnormal = if roundings > 0.0 { m.tiny } else { 0.0 };
    angle.abs() * roundings * m.u * (1.0 + roundings * m.u) + subnormal
}

/// The encoding of one point with its errors.
pub(crate) fn encode(x: &[f64], encoding: &Encoding, cosine: Cosine, m: &Arithmetic) -> Vec<Bounded> {
    let dims = x.len();
    let mut out = vec![exact(0.0); encoding.width(dims)];
    for d in 0..dims {
        if encoding.identity {
            out[encoding.identity_column(dims, d)] = exact(x[d]);
        }
        for k in 0..encoding.levels {
            let (sin, cos) = waves(encoding, cosine, k, x[d], m);
            out[encoding.column(dims, k, d, 0)] = sin;
            out[encoding.column(dims, k, d, 1)] = cos;
        }
    }
    out
}

/// g_x from cotangents with errors of their own: terms f (g cos) or (f cos) g, added one by one as a loop over bands does.
pub(crate) fn gradient(
    x: &[f64],
    encoding: &Encoding,
    cosine: Cosine,
    g: &[Bounded],
    m: &Arithmetic,
) -> Vec<Bounded> {
    let dims = x.len();
    let running = Arithmetic { u_sum: m.u, ..*m };
    let of = |d: usize| {
        let (mut inside, mut outside) = (vec![], vec![]);
        for k in 0..encoding.levels {
            let (sin, cos) = waves(encoding, cosine, k, x[d], m);
            let band = band(encoding, k, m);
            let scaled = if encoding.frequency == Frequency::One {
                band
            } else {
                m.mul(m.rounded(factor(encoding.frequency), 0.0), band)
            };
            for (column, wave) in [(0, cos), (1, sin.neg())] {
                let g = g[encoding.column(dims, k, d, column)];
                inside.push(m.mul(scaled, m.mul(g, wave)).or(m.mul(g, m.mul(scaled, wave))));
                outside.push(m.mul(band, m.mul(g, wave)));
            }
        }
        let identity = if encoding.identity { g[encoding.identity_column(dims, d)] } else { exact(0.0) };
        let sum = running.sum(&outside);
        let pi = m.rounded(factor(encoding.frequency), 0.0);
        let outside = m.add(m.mul(pi, m.rounded(sum.y, sum.e)), identity);
        inside.push(identity);
        let sum = running.sum(&inside);
        let inside = m.rounded(sum.y, sum.e);
        Bounded { y: outside.y, e: outside.e.max(inside.e) }
    };
    (0..dims).map(of).collect()
}

fn errors(bounded: Vec<Bounded>) -> Vec<f64> {
    bounded.into_iter().map(|b| b.e).collect()
}

/// Bound of [`super::positional_encoding`].
pub(crate) fn positional_encoding(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    let encoding = settings(a, c);
    let out: Vec<Vec<f64>> = rows(a, "x").iter().map(|x| errors(encode(x, &encoding, c.cosine, m))).collect();
    arrays([("encoding", from_rows(&out, encoding.width(dims(a))))])
}

/// Bound of [`super::backward::positional_encoding`].
pub(crate) fn positional_encoding_vjp(a: &Arrays, c: &Conventions, m: &Arithmetic) -> Arrays {
    let encoding = settings(a, c);
    let one = |(x, g): (&Vec<f64>, &Vec<f64>)| {
        let g: Vec<Bounded> = g.iter().copied().map(exact).collect();
        errors(gradient(x, &encoding, c.cosine, &g, m))
    };
    let out: Vec<Vec<f64>> = rows(a, "x").iter().zip(&rows(a, "grad_encoding")).map(one).collect();
    arrays([("grad_x", from_rows(&out, dims(a)))])
}
