//! Honest implementations of the positional encoding in emulated arithmetic.

use super::arrays::{dims, settings};
use super::{Encoding, factor};
use crate::contract::arrays::{Arrays, arrays, from_rows, rows};
use crate::contract::machine::Machine;
use crate::convention::{Conventions, Cosine, Frequency};
use crate::math::{cos, sin};

/// (sin, cos) after an exact reduction (stable), or of the rounded product, factor first or last.
pub(crate) fn waves(encoding: &Encoding, cosine: Cosine, k: usize, x: f64, m: &Machine) -> (f64, f64) {
    if cosine == Cosine::ShiftedSine {
        return shifted(encoding, k, x, m);
    }
    let band = m.round(encoding.band(k));
    let scale = factor(encoding.frequency);
    if encoding.frequency == Frequency::One {
        let angle = m.mul(band, x);
        return (m.elementary(sin(angle)), m.elementary(cos(angle)));
    }
    if m.stable {
        // scale / pi is 1 or 2, exactly.
        return reduced(m.mul(band, x) * (scale / std::f64::consts::PI), m);
    }
    let angle =
        if m.form % 2 == 0 { m.mul(m.mul(band, scale), x) } else { m.mul(m.round(scale), m.mul(band, x)) };
    (m.elementary(sin(angle)), m.elementary(cos(angle)))
}

/// (sin a, sin(a + pi / 2)); in every third form of angles modulo 100 pi, as mip-NeRF has it.
fn shifted(encoding: &Encoding, k: usize, x: f64, m: &Machine) -> (f64, f64) {
    let scale = m.round(factor(encoding.frequency));
    let band = m.round(encoding.band(k));
    let angle = if m.form % 2 == 0 { m.mul(band, m.mul(scale, x)) } else { m.mul(m.mul(band, scale), x) };
    let turns = m.round(100.0 * std::f64::consts::PI);
    let sine = |a: f64| {
        let a = if m.form % 3 == 2 && a.abs() >= turns { m.round(a % turns) } else { a };
        m.elementary(sin(a))
    };
    (sine(angle), sine(m.add(angle, m.round(std::f64::consts::FRAC_PI_2))))
}

/// (sin, cos) of pi half_turns, reduced to [-pi/4, pi/4] exactly; pi and the product are rounded.
fn reduced(half_turns: f64, m: &Machine) -> (f64, f64) {
    let x = half_turns % 2.0;
    let quarter = libm::rint(2.0 * x);
    let angle = m.mul(m.round(std::f64::consts::PI), x - quarter / 2.0);
    let (sin, cos) = (m.elementary(sin(angle)), m.elementary(cos(angle)));
    match (quarter as i64).rem_euclid(4) {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// The encoding of one point.
pub(crate) fn encode(x: &[f64], encoding: &Encoding, cosine: Cosine, m: &Machine) -> Vec<f64> {
    let dims = x.len();
    let mut out = vec![0.0; encoding.width(dims)];
    for d in 0..dims {
        if encoding.identity {
            out[encoding.identity_column(dims, d)] = x[d];
        }
        for k in 0..encoding.levels {
            let (sin, cos) = waves(encoding, cosine, k, x[d], m);
            out[encoding.column(dims, k, d, 0)] = sin;
            out[encoding.column(dims, k, d, 1)] = cos;
        }
    }
    out
}

/// g_x with the factor inside the sum, added band by band as a loop does, or outside of one sum.
pub(crate) fn gradient(x: &[f64], encoding: &Encoding, cosine: Cosine, g: &[f64], m: &Machine) -> Vec<f64> {
    let dims = x.len();
    let scale = m.round(factor(encoding.frequency));
    let of = |d: usize| {
        let identity = if encoding.identity { g[encoding.identity_column(dims, d)] } else { 0.0 };
        let mut terms = vec![];
        for k in 0..encoding.levels {
            let (sin, cos) = waves(encoding, cosine, k, x[d], m);
            let band = m.round(encoding.band(k));
            for (column, wave) in [(0, cos), (1, -sin)] {
                let g = g[encoding.column(dims, k, d, column)];
                terms.push(match m.form % 3 {
                    0 => m.mul(band, m.mul(g, wave)),
                    1 => m.mul(m.mul(scale, band), m.mul(g, wave)),
                    _ => m.mul(g, m.mul(m.mul(scale, band), wave)),
                });
            }
        }
        match m.form % 3 {
            0 => m.add(m.mul(scale, m.sum(&terms)), identity),
            1 => terms.iter().fold(identity, |sum, &term| m.add(sum, term)),
            _ => m.add(m.sum(&terms), identity),
        }
    };
    (0..dims).map(of).collect()
}

/// Positional encoding.
pub(crate) fn positional_encoding(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    let encoding = settings(a, c);
    let out: Vec<Vec<f64>> = rows(a, "x").iter().map(|x| encode(x, &encoding, c.cosine, m)).collect();
    arrays([("encoding", from_rows(&out, encoding.width(dims(a))))])
}

/// Its gradient.
pub(crate) fn positional_encoding_vjp(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    let encoding = settings(a, c);
    let g = rows(a, "grad_encoding");
    let out: Vec<Vec<f64>> =
        rows(a, "x").iter().zip(&g).map(|(x, g)| gradient(x, &encoding, c.cosine, g, m)).collect();
    arrays([("grad_x", from_rows(&out, dims(a)))])
}
