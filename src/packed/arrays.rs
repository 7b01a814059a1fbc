//! The oracle of this folder on named arrays, and what turns these into its types and back.

use super::{Scan, backward};
use crate::contract::arrays::{Arrays, array, arrays, number, threes, values};
use crate::convention::Conventions;

/// The four results of a scan, in the order of their names.
pub(crate) const SCANS: [&str; 4] =
    ["exclusive_sum", "inclusive_sum", "exclusive_product", "inclusive_product"];

/// Where each ray begins, and the end. Made whole and in order, so that no inputs, however perturbed, read past the arrays.
pub(crate) fn offsets(a: &Arrays, samples: &str) -> Vec<usize> {
    let (count, mut least) = (a[samples].shape()[0], 0);
    let mut next = |x: f64| {
        least = (x.round() as usize).clamp(least, count);
        least
    };
    values(a, "offsets").into_iter().map(&mut next).collect()
}

/// Ids and the number of rays, made whole and in range as [`offsets`] are.
pub(crate) fn ids(a: &Arrays) -> (Vec<usize>, usize) {
    let rays = number(a, "rays") as usize;
    let id = |x: f64| (x.round() as usize).min(rays.saturating_sub(1));
    (values(a, "ray_ids").into_iter().map(id).collect(), rays)
}

/// Starts and counts of rays as the outputs.
pub(crate) fn infos(info: &[(usize, usize)]) -> Arrays {
    let column = |f: fn(&(usize, usize)) -> usize| {
        array(&[info.len()], info.iter().map(|ray| f(ray) as f64).collect())
    };
    arrays([("starts", column(|ray| ray.0)), ("counts", column(|ray| ray.1))])
}

/// Four arrays of numbers, one a sample, as the outputs of a scan.
pub(crate) fn scans(results: [Vec<f64>; 4]) -> Arrays {
    SCANS.iter().zip(results).map(|(name, x)| (name.to_string(), array(&[x.len()], x))).collect()
}

/// The cotangents of a scan's four results.
pub(crate) fn cotangents(a: &Arrays) -> [Vec<f64>; 4] {
    SCANS.map(|name| values(a, &format!("grad_{name}")))
}

/// A gradient of packed numbers as an array.
pub(crate) fn gradient(g_x: Vec<f64>) -> Arrays {
    arrays([("grad_x", array(&[g_x.len()], g_x))])
}

/// Colors of rays as the output.
pub(crate) fn sums(rays: &[[f64; 3]]) -> Arrays {
    arrays([("sums", array(&[rays.len(), 3], rays.concat()))])
}

/// The gradients of weights and values as arrays.
pub(crate) fn gradients(g_weights: Vec<f64>, g_values: &[[f64; 3]]) -> Arrays {
    arrays([
        ("grad_weights", array(&[g_weights.len()], g_weights)),
        ("grad_values", array(&[g_values.len(), 3], g_values.concat())),
    ])
}

pub(super) fn pack_info(a: &Arrays, _: &Conventions) -> Arrays {
    let (ids, rays) = ids(a);
    infos(&super::pack_info(&ids, rays))
}

pub(super) fn scan(a: &Arrays, _: &Conventions) -> Arrays {
    let scan = super::scan(&values(a, "x"), &offsets(a, "x"));
    scans([scan.exclusive_sum, scan.inclusive_sum, scan.exclusive_product, scan.inclusive_product])
}

pub(super) fn scan_vjp(a: &Arrays, _: &Conventions) -> Arrays {
    let (x, offsets) = (values(a, "x"), offsets(a, "x"));
    let [exclusive_sum, inclusive_sum, exclusive_product, inclusive_product] = cotangents(a);
    let g = Scan { exclusive_sum, inclusive_sum, exclusive_product, inclusive_product };
    gradient(backward::scan(&x, &offsets, &super::scan(&x, &offsets), &g))
}

pub(super) fn accumulate(a: &Arrays, _: &Conventions) -> Arrays {
    sums(&super::accumulate(&values(a, "weights"), &threes(a, "values"), &offsets(a, "weights")))
}

pub(super) fn accumulate_vjp(a: &Arrays, _: &Conventions) -> Arrays {
    let (weights, colors, offsets) = (values(a, "weights"), threes(a, "values"), offsets(a, "weights"));
    let (g_weights, g_values) = backward::accumulate(&weights, &colors, &offsets, &threes(a, "grad_sums"));
    gradients(g_weights, &g_values)
}
