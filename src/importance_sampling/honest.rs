//! Honest importance sampling in emulated arithmetic: F from normalized weights, from divided sums, or u multiplied by the sum.

use super::SNAPPED;
use super::arrays::{Ray, forward, vjp};
use crate::contract::arrays::Arrays;
use crate::contract::machine::Machine;
use crate::convention::Conventions;

/// How F is made. Shares that are compared with a number are those of a whole that is 1.
fn form(c: &Conventions, m: &Machine) -> u64 {
    m.form % if c.pdf_division.faint().is_some() { 2 } else { 3 }
}

/// What the place in a bin is divided by.
fn divisor(below: f64, above: f64, c: &Conventions, m: &Machine) -> f64 {
    let share = m.sub(above, below);
    c.pdf_division.faint().filter(|_| share < m.round(SNAPPED)).map_or(share, |faint| m.round(faint))
}

/// F at the edges, and the u that is searched in it.
fn distribution(ray: &Ray, c: &Conventions, m: &Machine) -> (Vec<f64>, Vec<f64>) {
    let mut w: Vec<f64> = ray.weights.iter().map(|&w| m.add(w, m.round(ray.padding))).collect();
    if w.iter().all(|&w| w == 0.0) {
        w.fill(1.0);
    }
    let total = m.sum(&w);
    match form(c, m) {
        0 => {
            let shares: Vec<f64> = w.iter().map(|&w| m.div(w, total)).collect();
            (m.cumulative_sum(&shares), ray.u.clone())
        }
        1 => (m.cumulative_sum(&w).iter().map(|&sum| m.div(sum, total)).collect(), ray.u.clone()),
        _ => (m.cumulative_sum(&w), ray.u.iter().map(|&u| m.mul(u, total)).collect()),
    }
}

/// The last edge at or below u: N where F ends below it.
fn edge_of(f: &[f64], u: f64) -> usize {
    f.iter().rposition(|&f| f <= u).unwrap_or(0)
}

/// Samples: by s, by the slope, or by weights.
pub(crate) fn sample(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    forward(a, c, |ray| {
        let (f, u) = distribution(ray, c, m);
        let one = |&u: &f64| {
            let k = edge_of(&f, u);
            if k == ray.weights.len() {
                return ray.edges[k];
            }
            let (a, b) = (ray.edges[k], ray.edges[k + 1]);
            let (above, weight, width) = (m.sub(u, f[k]), divisor(f[k], f[k + 1], c, m), m.sub(b, a));
            match m.form / 3 % 3 {
                0 => m.add(a, m.mul(m.div(above, weight), width)),
                1 => m.add(a, m.mul(above, m.div(width, weight))),
                _ => {
                    let s = m.div(above, weight);
                    m.add(m.mul(a, m.sub(1.0, s)), m.mul(b, s))
                }
            }
        };
        u.iter().map(one).collect()
    })
}

/// Their gradient.
pub(crate) fn sample_vjp(a: &Arrays, c: &Conventions, m: &Machine) -> Arrays {
    vjp(a, c, |ray, g| {
        let (f, u) = distribution(ray, c, m);
        let n = ray.weights.len();
        // Where u S is searched in the sums, dt / du has a factor S.
        let scale = if form(c, m) == 2 { f[n] } else { 1.0 };
        let (mut terms, mut g_u) = (vec![vec![]; n + 1], vec![]);
        for (&u, &g) in u.iter().zip(g) {
            let k = edge_of(&f, u);
            if k == n {
                terms[n].push(g);
                g_u.push(0.0);
                continue;
            }
            let (weight, width) = (divisor(f[k], f[k + 1], c, m), m.sub(ray.edges[k + 1], ray.edges[k]));
            let s = m.div(m.sub(u, f[k]), weight);
            terms[k].push(m.mul(g, m.sub(1.0, s)));
            terms[k + 1].push(m.mul(g, s));
            let slope = match m.form / 3 % 2 {
                0 => m.div(m.mul(g, width), weight),
                _ => m.mul(g, m.div(width, weight)),
            };
            g_u.push(if scale == 1.0 { slope } else { m.mul(slope, scale) });
        }
        (terms.iter().map(|terms| m.sum(terms)).collect(), g_u)
    })
}
