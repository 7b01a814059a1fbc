//! Error bounds of packed rays. Counting is exact; sums and products in any order, and gradients of products with or without a division.

use super::arrays::{cotangents, gradient, gradients, offsets, scans, sums};
use crate::contract::arithmetic::Arithmetic;
use crate::contract::arrays::{Arrays, threes, values};
use crate::contract::bounded::{Bounded, Running, any_order, exact, in_any_order};
use crate::convention::Conventions;

/// Bound of [`super::pack_info`]: none.
pub(crate) fn pack_info(a: &Arrays, c: &Conventions, _: &Arithmetic) -> Arrays {
    let zero = |(name, x): (String, ndarray::ArrayD<f64>)| (name, x.mapv(|_| 0.0));
    super::arrays::pack_info(a, c).into_iter().map(zero).collect()
}

/// Products of the first 0, 1, ..., N factors.
fn products(x: &[Bounded], m: &Arithmetic) -> Vec<Bounded> {
    let mut all = vec![exact(1.0)];
    for (n, &x) in x.iter().enumerate() {
        // 1 times the first is exact.
        all.push(if n == 0 { x } else { m.mul(all[n], x) });
    }
    all
}

/// Bound of [`super::scan`].
pub(crate) fn scan(a: &Arrays, _: &Conventions, m: &Arithmetic) -> Arrays {
    let x: Vec<Bounded> = values(a, "x").into_iter().map(exact).collect();
    let mut errors: [Vec<f64>; 4] = Default::default();
    for ray in offsets(a, "x").windows(2) {
        let x = &x[ray[0]..ray[1]];
        let (products, mut before) = (products(x, m), Running::default());
        for i in 0..x.len() {
            let exclusive = in_any_order(&before, m).e;
            before.add(x[i]);
            let inclusive = in_any_order(&before, m).e;
            let all = [exclusive, inclusive, products[i].e, products[i + 1].e];
            errors.iter_mut().zip(all).for_each(|(errors, e)| errors.push(e));
        }
    }
    scans(errors)
}

/// Bound of [`super::backward::scan`]: the terms behind a sample by a recursion, or, of products, their sum divided by x.
pub(crate) fn scan_vjp(a: &Arrays, _: &Conventions, m: &Arithmetic) -> Arrays {
    let x: Vec<Bounded> = values(a, "x").into_iter().map(exact).collect();
    let g = cotangents(a);
    let g = |n: usize, k: usize| exact(g[n][k]);
    let mut errors = vec![0.0; x.len()];
    for ray in offsets(a, "x").windows(2) {
        let products = products(&x[ray[0]..ray[1]], m);
        let (mut behind, mut through, mut terms) = (Running::default(), exact(0.0), Running::default());
        for k in (ray[0]..ray[1]).rev() {
            let (before, with) = (products[k - ray[0]], products[k - ray[0] + 1]);
            behind.add(g(1, k));
            through = m.add(through, g(3, k));
            terms.add(m.mul(g(3, k), with));
            let recursive = m.mul(before, through);
            let divided = m.div(in_any_order(&terms, m), x[k]);
            let product = if x[k].y == 0.0 { recursive } else { recursive.or(divided) };
            errors[k] = m.add(in_any_order(&behind, m), product).e;
            behind.add(g(0, k));
            through = m.add(m.mul(through, x[k]), g(2, k));
            terms.add(m.mul(g(2, k), before));
        }
    }
    gradient(errors)
}

/// Bound of [`super::accumulate`].
pub(crate) fn accumulate(a: &Arrays, _: &Conventions, m: &Arithmetic) -> Arrays {
    let (weights, colors) = (values(a, "weights"), threes(a, "values"));
    let of_ray = |ray: &[usize]| {
        [0, 1, 2].map(|axis| {
            let product = |i: usize| m.mul(exact(weights[i]), exact(colors[i][axis]));
            let sum = any_order(&(ray[0]..ray[1]).map(product).collect::<Vec<_>>(), m);
            if sum.e == 0.0 { 0.0 } else { m.rounded(sum.y, sum.e).e }
        })
    };
    sums(&offsets(a, "weights").windows(2).map(of_ray).collect::<Vec<_>>())
}

/// Bound of [`super::backward::accumulate`].
pub(crate) fn accumulate_vjp(a: &Arrays, _: &Conventions, m: &Arithmetic) -> Arrays {
    let (weights, colors, g) = (values(a, "weights"), threes(a, "values"), threes(a, "grad_sums"));
    let (mut g_weights, mut g_values) = (vec![], vec![]);
    for (r, ray) in offsets(a, "weights").windows(2).enumerate() {
        for i in ray[0]..ray[1] {
            let products = [0, 1, 2].map(|axis| m.mul(exact(g[r][axis]), exact(colors[i][axis])));
            let sum = any_order(&products, m);
            g_weights.push(m.rounded(sum.y, sum.e).e);
            g_values.push(g[r].map(|g| m.mul(exact(weights[i]), exact(g)).e));
        }
    }
    gradients(g_weights, &g_values)
}
