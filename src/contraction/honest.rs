//! Honest contractions in emulated arithmetic: divided, or multiplied by 1/r or by one factor; gradients as automatic differentiation
//! has them, expanded, or split; either piece at r = 1.

use super::arrays::{forward, vjp};
use super::largest;
use crate::contract::arrays::Arrays;
use crate::contract::machine::Machine;
use crate::convention::{ContractionNorm, ContractionRange, Conventions};

/// The length of x.
fn length(x: [f64; 3], norm: ContractionNorm, m: &Machine) -> f64 {
    if norm == ContractionNorm::L2 { m.sqrt(m.dot(&x, &x)) } else { x[largest(x)].abs() }
}

/// Whether this machine leaves a point of length r where it is.
fn inside(r: f64, m: &Machine) -> bool {
    if m.form % 2 == 0 { r <= 1.0 } else { r < 1.0 }
}

/// The largest coordinate, the first or the last of those that tie.
fn the_largest(x: [f64; 3], m: &Machine) -> usize {
    if m.form % 3 == 0 {
        return largest(x);
    }
    let last = largest([x[2], x[1], x[0]]);
    2 - last
}

/// 1 / r, by division or as an elementary function.
fn inverse(r: f64, m: &Machine) -> f64 {
    if m.stable { m.div(1.0, r) } else { m.elementary(1.0 / r) }
}

/// (2 - 1/r) / r.
fn factor(r: f64, m: &Machine) -> f64 {
    let numerator = m.sub(m.mul(2.0, r), 1.0);
    match m.form % 3 {
        0 => m.mul(m.sub(2.0, inverse(r, m)), inverse(r, m)),
        1 => m.div(m.sub(2.0, inverse(r, m)), r),
        _ => m.div(numerator, m.mul(r, r)),
    }
}

/// The contracted point.
fn folded(x: [f64; 3], norm: ContractionNorm, m: &Machine) -> [f64; 3] {
    let r = length(x, norm, m);
    if inside(r, m) {
        return x;
    }
    let radius = m.sub(2.0, inverse(r, m));
    let apart = |x: f64| match m.form % 4 {
        0 => m.mul(radius, m.div(x, r)),
        1 => m.mul(radius, m.mul(x, inverse(r, m))),
        _ => m.mul(factor(r, m), x),
    };
    if norm != ContractionNorm::Merf {
        return x.map(apart);
    }
    let mut y = x.map(|x| m.mul(x, inverse(r, m)));
    let k = the_largest(x, m);
    y[k] = apart(x[k]);
    y
}

/// The contraction.
pub(crate) fn contraction(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    forward(a, |x| {
        let y = folded(x, c.contraction_norm, m);
        y.map(|y| match c.contraction_range {
            ContractionRange::Two => y,
            ContractionRange::One => m.div(y, 2.0),
            ContractionRange::Unit if m.form % 2 == 0 => m.add(m.div(y, 4.0), 0.5),
            ContractionRange::Unit => m.div(m.add(y, 2.0), 4.0),
        })
    })
}

/// d r / d x.
fn slope(x: [f64; 3], r: f64, norm: ContractionNorm, m: &Machine) -> [f64; 3] {
    if norm == ContractionNorm::L2 {
        return x.map(|x| m.div(x, r));
    }
    let mut slope = [0.0; 3];
    let tied: Vec<usize> = (0..3).filter(|&j| x[j].abs() == r).collect();
    if m.form % 2 == 0 {
        slope[the_largest(x, m)] = x[the_largest(x, m)].signum();
    } else {
        tied.iter().for_each(|&j| slope[j] = m.div(x[j].signum(), tied.len() as f64));
    }
    slope
}

/// As automatic differentiation has it, of (2 - 1/r) (x/r).
fn differentiated(x: [f64; 3], g: [f64; 3], r: f64, slope: [f64; 3], m: &Machine) -> [f64; 3] {
    let (inverse, radius) = (inverse(r, m), m.sub(2.0, inverse(r, m)));
    let through_radius = m.dot(&g, &x.map(|x| m.mul(x, inverse)));
    let scaled = g.map(|g| m.mul(g, radius));
    let g_r = -m.mul(m.sub(m.dot(&scaled, &x), through_radius), m.mul(inverse, inverse));
    [0, 1, 2].map(|j| m.add(m.mul(scaled[j], inverse), m.mul(g_r, slope[j])))
}

/// Of s x, the slope of s in two terms, or in three.
fn expanded(x: [f64; 3], g: [f64; 3], r: f64, slope: [f64; 3], m: &Machine) -> [f64; 3] {
    let (along, square) = (m.dot(&g, &x), m.mul(r, r));
    let cube = m.mul(square, r);
    let of_s = if m.form % 8 < 4 {
        m.sub(m.div(2.0, cube), m.div(2.0, square))
    } else {
        m.sub(m.div(2.0, square), m.div(m.mul(2.0, m.sub(m.mul(2.0, r), 1.0)), cube))
    };
    [0, 1, 2].map(|j| m.add(m.mul(factor(r, m), g[j]), m.mul(m.mul(of_s, along), slope[j])))
}

/// The parts across and along x, for L2.
fn split(g: [f64; 3], r: f64, u: [f64; 3], m: &Machine) -> [f64; 3] {
    let radial = m.dot(&g, &u);
    let along = u.map(|u| m.mul(radial, u));
    [0, 1, 2].map(|j| m.add(m.mul(factor(r, m), m.sub(g[j], along[j])), m.div(along[j], m.mul(r, r))))
}

/// Of MERF's contraction: the formula, or as automatic differentiation has it of x times a scale for each coordinate.
fn by_coordinates(x: [f64; 3], g: [f64; 3], r: f64, m: &Machine) -> [f64; 3] {
    let (k, square) = (the_largest(x, m), m.mul(r, r));
    let products: Vec<f64> = (0..3).filter(|&j| j != k).map(|j| m.mul(g[j], x[j])).collect();
    let others = m.div(m.sum(&products), square);
    let mut g_x = g.map(|g| m.div(g, r));
    g_x[k] = if m.form % 2 == 0 {
        m.sub(m.div(g[k], square), m.mul(x[k].signum(), others))
    } else {
        let slope = m.sub(m.div(1.0, m.mul(square, r)), m.div(m.sub(2.0, inverse(r, m)), square));
        let g_r = m.sub(m.mul(m.mul(g[k], x[k]), slope), others);
        m.add(m.mul(g[k], factor(r, m)), m.mul(x[k].signum(), g_r))
    };
    g_x
}

/// Its gradient.
pub(crate) fn contraction_vjp(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    vjp(a, |x, g| {
        let g = match c.contraction_range {
            ContractionRange::Two => g,
            ContractionRange::One => g.map(|g| m.div(g, 2.0)),
            ContractionRange::Unit => g.map(|g| m.div(g, 4.0)),
        };
        let norm = c.contraction_norm;
        let r = length(x, norm, m);
        if inside(r, m) {
            return g;
        }
        let slope = slope(x, r, norm, m);
        match (norm, m.form % 3) {
            (ContractionNorm::Merf, _) => by_coordinates(x, g, r, m),
            (ContractionNorm::L2, 2) => split(g, r, slope, m),
            (_, 0) => differentiated(x, g, r, slope, m),
            _ => expanded(x, g, r, slope, m),
        }
    })
}
