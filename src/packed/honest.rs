//! Honest packed rays in emulated arithmetic: sums in any order, products forward or by halves, gradients by recursion or divided.

use super::arrays::{cotangents, gradient, gradients, offsets, scans, sums};
use crate::contract::arrays::{Arrays, threes, values};
use crate::contract::machine::Machine;
use crate::convention::Conventions;

/// Where rays begin: there is one answer.
pub(crate) fn pack_info(a: &Arrays, c: &Conventions, _: &Machine) -> Arrays {
    super::arrays::pack_info(a, c)
}

/// A product, left to right or by halves.
fn product(x: &[f64], m: &Machine) -> f64 {
    match x {
        [] => 1.0,
        [x] => *x,
        _ if m.form % 2 == 0 => x[1..].iter().fold(x[0], |product, x| m.mul(product, *x)),
        _ => {
            let (left, right) = x.split_at(x.len() / 2);
            m.mul(product(left, m), product(right, m))
        }
    }
}

/// Sums and products.
pub(crate) fn scan(a: &Arrays, _: &Conventions, m: &Machine) -> Arrays {
    let x = values(a, "x");
    let mut out: [Vec<f64>; 4] = Default::default();
    for ray in offsets(a, "x").windows(2) {
        let x = &x[ray[0]..ray[1]];
        for i in 0..x.len() {
            let all = [m.sum(&x[..i]), m.sum(&x[..=i]), product(&x[..i], m), product(&x[..=i], m)];
            out.iter_mut().zip(all).for_each(|(out, x)| out.push(x));
        }
    }
    scans(out)
}

/// The gradient of one ray: what the products pass to sample k, by the recursion or divided by x where that isn't 0.
fn of_ray(x: &[f64], g: &[Vec<f64>], m: &Machine) -> Vec<f64> {
    let (mut behind, mut through, mut terms) = (vec![], 0.0, vec![]);
    let mut g_x = vec![0.0; x.len()];
    for k in (0..x.len()).rev() {
        behind.push(g[1][k]);
        through = m.add(through, g[3][k]);
        terms.push(m.mul(g[3][k], product(&x[..=k], m)));
        let of_products = if m.form / 2 % 2 == 0 || x[k] == 0.0 {
            m.mul(product(&x[..k], m), through)
        } else {
            m.div(m.sum(&terms), x[k])
        };
        g_x[k] = m.add(m.sum(&behind), of_products);
        behind.push(g[0][k]);
        let passed = if m.fused { through * x[k] } else { m.mul(through, x[k]) };
        through = m.round(passed + g[2][k]);
        terms.push(m.mul(g[2][k], product(&x[..k], m)));
    }
    g_x
}

/// Their gradient.
pub(crate) fn scan_vjp(a: &Arrays, _: &Conventions, m: &Machine) -> Arrays {
    let (x, g) = (values(a, "x"), cotangents(a));
    let one = |ray: &[usize]| {
        let g: Vec<Vec<f64>> = g.iter().map(|g| g[ray[0]..ray[1]].to_vec()).collect();
        of_ray(&x[ray[0]..ray[1]], &g, m)
    };
    gradient(offsets(a, "x").windows(2).flat_map(one).collect())
}

/// Weighted sums.
pub(crate) fn accumulate(a: &Arrays, _: &Conventions, m: &Machine) -> Arrays {
    let (weights, colors) = (values(a, "weights"), threes(a, "values"));
    let of_ray = |ray: &[usize]| {
        let column = |axis: usize| colors[ray[0]..ray[1]].iter().map(|c| c[axis]).collect::<Vec<f64>>();
        [0, 1, 2].map(|axis| m.dot(&weights[ray[0]..ray[1]], &column(axis)))
    };
    sums(&offsets(a, "weights").windows(2).map(of_ray).collect::<Vec<_>>())
}

/// Their gradients.
pub(crate) fn accumulate_vjp(a: &Arrays, _: &Conventions, m: &Machine) -> Arrays {
    let (weights, colors, g) = (values(a, "weights"), threes(a, "values"), threes(a, "grad_sums"));
    let (mut g_weights, mut g_values) = (vec![], vec![]);
    for (r, ray) in offsets(a, "weights").windows(2).enumerate() {
        for i in ray[0]..ray[1] {
            g_weights.push(m.dot(&g[r], &colors[i]));
            g_values.push(g[r].map(|g| m.mul(weights[i], g)));
        }
    }
    gradients(g_weights, &g_values)
}
