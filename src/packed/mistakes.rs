//! Packed rays, wrong on purpose. Without a mistake every function equals the oracle.

use super::arrays::{cotangents, gradient, gradients, ids, infos, offsets, scans, sums};
use super::{Scan, accumulate as oracle_sums, backward, pack_info as oracle_info, scan as oracle_scan};
use crate::contract::arrays::{Arrays, threes, values};
use crate::contract::component::Mistake;
use crate::convention::Conventions;

/// Mistakes of where rays begin.
pub(crate) const PACK_INFO: &[Mistake] = &[
    Mistake::new(
        "empty_rays_begin_at_0",
        "the first sample of each ray that has some, 0 for all others",
        "nothing, where counts are looked at; offsets made of the starts give empty rays the samples of those in front",
        "the exclusive sum of the counts, which is right for empty rays too",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "ends_for_starts",
        "the inclusive sum of the counts",
        "every ray gets the next one's samples, the last one what lies behind the array",
        "the sum of the counts in front: cumsum - count",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "empty_rays_skipped",
        "rays numbered anew without the empty ones, zeros at the end",
        "behind the first ray that misses the scene, every pixel has its neighbor's color",
        "count all rays: bincount(ray_ids, minlength=rays), not unique_consecutive",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "last_sample_not_counted",
        "counts as differences between a ray's first and last sample",
        "each ray ends a sample early; rays of one sample have none",
        "last - first + 1",
        "never; cheap to keep",
        0,
    ),
];

/// Mistakes of running sums and products.
pub(crate) const PACKED_SCAN: &[Mistake] = &[
    Mistake::new(
        "not_reset",
        "one sum or product over all samples of all rays",
        "every ray begins with what those in front have added up: black behind the first opaque one",
        "begin anew at each ray's first sample",
        "one scan for a whole batch, as cumsum over the wrong axis (1 in volume rendering)",
        1,
    ),
    Mistake::new(
        "inclusive_for_exclusive",
        "the exclusive results with the sample itself",
        "each sample shades itself: w_i (1 - alpha_i)",
        "shift by one: 0 or 1 for a ray's first sample",
        "9 as the transmittance of dense rays",
        9,
    ),
    Mistake::new(
        "first_not_reset",
        "rolled by one: the first of a ray has the last inclusive result of the one in front",
        "a ray's first sample is as dark as the end of its neighbor",
        "0 or 1 for a ray's first sample",
        "2 as rolled products of dense rays",
        2,
    ),
    Mistake::new(
        "first_product_0",
        "0 as the exclusive product of a ray's first sample",
        "what a ray meets first is invisible",
        "the empty product is 1",
        "1 as T_0 = 0 of dense rays",
        1,
    ),
    Mistake::new(
        "gradient_divided_by_clamped",
        "the gradient of products: sum_{i>=k} g_i P_i, divided by max(x_k, 1e-10)",
        "a fully opaque sample has no gradient from what it hides: it stays opaque for ever",
        "the recursion q_k = x_{k+1} p_{k+1} + g_{k+1}, which divides by nothing",
        "nerfacc FIXME in the backward pass of its products",
        1,
    )
    .of_gradient(),
    Mistake::new(
        "gradient_divided",
        "the same, divided by x_k as it is",
        "NaN where a sample is fully opaque",
        "the recursion, which divides by nothing",
        "hand-written backward passes of cumulative products",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "gradient_not_reset",
        "the sums behind a sample run on into the rays behind",
        "rays pull at their neighbors' samples",
        "end where the ray ends",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "gradient_forward",
        "the gradient of sums as a sum over what lies in front",
        "samples learn from those that they have no part in",
        "the transposed scan runs backward",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
];

/// Mistakes of weighted sums.
pub(crate) const ACCUMULATE_ALONG_RAYS: &[Mistake] = &[
    Mistake::new(
        "divided_by_weights",
        "divided by the sum of the weights",
        "thin rays are as bright as opaque ones; NaN without samples",
        "sum w v alone; a background takes what is left",
        "2 in volume rendering",
        2,
    ),
    Mistake::new(
        "empty_rays_skipped",
        "rays numbered anew without the empty ones, zeros at the end",
        "behind the first ray that misses the scene, every pixel has its neighbor's color",
        "index_add by the ray's number",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "last_write_counts",
        "out[ray_ids] = w v: of a ray's samples the last one counts, not their sum",
        "colors of the last sample alone, and too dark",
        "index_add, or atomic additions",
        "assignments by index in numpy and PyTorch, which don't add",
        0,
    ),
    Mistake::new(
        "weights_forgotten",
        "the sum of the values",
        "far too bright",
        "times the weights",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "one_color_to_weights",
        "the weights' gradient from the first color alone",
        "densities learn from red alone",
        "the sum over colors",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "weights_detached",
        "no gradient to the weights",
        "colors learn, densities don't",
        "g . v",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
];

/// Rays numbered anew without those of no samples, zeros at the end.
fn skipped<T: Copy>(info: &[T], empty: impl Fn(&T) -> bool, zero: T) -> Vec<T> {
    let mut left: Vec<T> = info.iter().filter(|ray| !empty(ray)).copied().collect();
    left.resize(info.len(), zero);
    left
}

/// Where rays begin.
pub(crate) fn pack_info(a: &Arrays, _: &Conventions, wrong: &[&str]) -> Arrays {
    let (ids, rays) = ids(a);
    let mut info = oracle_info(&ids, rays);
    for name in wrong {
        match *name {
            "empty_rays_begin_at_0" => info.iter_mut().filter(|ray| ray.1 == 0).for_each(|ray| ray.0 = 0),
            "ends_for_starts" => info.iter_mut().for_each(|ray| ray.0 += ray.1),
            "empty_rays_skipped" => info = skipped(&info, |ray| ray.1 == 0, (0, 0)),
            "last_sample_not_counted" => info.iter_mut().for_each(|ray| ray.1 = ray.1.saturating_sub(1)),
            _ => {}
        }
    }
    infos(&info)
}

/// All samples as one ray.
fn joined(offsets: &[usize]) -> [usize; 2] {
    [0, offsets[offsets.len() - 1]]
}

/// Sums and products.
pub(crate) fn scan(a: &Arrays, _: &Conventions, wrong: &[&str]) -> Arrays {
    let (x, right) = (values(a, "x"), offsets(a, "x"));
    let all = if wrong.contains(&"not_reset") { joined(&right).to_vec() } else { right.clone() };
    let Scan { mut exclusive_sum, inclusive_sum, mut exclusive_product, inclusive_product } =
        oracle_scan(&x, &all);
    if wrong.contains(&"inclusive_for_exclusive") {
        (exclusive_sum, exclusive_product) = (inclusive_sum.clone(), inclusive_product.clone());
    }
    if wrong.contains(&"first_not_reset") && !x.is_empty() {
        (exclusive_sum, exclusive_product) = (inclusive_sum.clone(), inclusive_product.clone());
        exclusive_sum.rotate_right(1);
        exclusive_product.rotate_right(1);
    }
    if wrong.contains(&"first_product_0") {
        right.windows(2).filter(|ray| ray[0] < ray[1]).for_each(|ray| exclusive_product[ray[0]] = 0.0);
    }
    scans([exclusive_sum, inclusive_sum, exclusive_product, inclusive_product])
}

/// sum_{i>=k} g_i P_i over a ray, divided by what `divisor` makes of x_k, in the place of the product's gradient.
fn divided(a: &Arrays, divisor: impl Fn(f64) -> f64) -> Vec<f64> {
    let (x, offsets) = (values(a, "x"), offsets(a, "x"));
    let (forward, g) = (oracle_scan(&x, &offsets), cotangents(a));
    let mut g_x = vec![0.0; x.len()];
    for ray in offsets.windows(2) {
        let (mut of_sums, mut of_products) = (0.0, 0.0);
        for k in (ray[0]..ray[1]).rev() {
            of_sums += g[1][k];
            of_products += g[3][k] * forward.inclusive_product[k];
            g_x[k] = of_sums + of_products / divisor(x[k]);
            of_sums += g[0][k];
            of_products += g[2][k] * forward.exclusive_product[k];
        }
    }
    g_x
}

/// Their gradient.
pub(crate) fn scan_vjp(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let (x, right) = (values(a, "x"), offsets(a, "x"));
    let [exclusive_sum, inclusive_sum, exclusive_product, inclusive_product] = cotangents(a);
    let mut g = Scan { exclusive_sum, inclusive_sum, exclusive_product, inclusive_product };
    let forward = oracle_scan(&x, &right);
    match wrong.first() {
        Some(&"gradient_divided_by_clamped") => gradient(divided(a, |x| x.max(1e-10))),
        Some(&"gradient_divided") => gradient(divided(a, |x| x)),
        Some(&"gradient_not_reset") => gradient(backward::scan(&x, &joined(&right), &forward, &g)),
        Some(&"gradient_forward") => {
            let front = oracle_scan(&g.inclusive_sum, &right).inclusive_sum;
            let behind = oracle_scan(&g.exclusive_sum, &right).exclusive_sum;
            g.inclusive_sum.fill(0.0);
            g.exclusive_sum.fill(0.0);
            let of_products = backward::scan(&x, &right, &forward, &g);
            gradient((0..x.len()).map(|k| front[k] + behind[k] + of_products[k]).collect())
        }
        _ => super::arrays::scan_vjp(a, c),
    }
}

/// Weighted sums.
pub(crate) fn accumulate(a: &Arrays, _: &Conventions, wrong: &[&str]) -> Arrays {
    let (mut weights, colors, offsets) = (values(a, "weights"), threes(a, "values"), offsets(a, "weights"));
    if wrong.contains(&"last_write_counts") {
        for ray in offsets.windows(2).filter(|ray| ray[0] < ray[1]) {
            weights[ray[0]..ray[1] - 1].fill(0.0);
        }
    }
    if wrong.contains(&"weights_forgotten") {
        weights.fill(1.0);
    }
    let mut out = oracle_sums(&weights, &colors, &offsets);
    if wrong.contains(&"divided_by_weights") {
        let totals = oracle_sums(&weights, &vec![[1.0; 3]; weights.len()], &offsets);
        out = out.iter().zip(totals).map(|(sum, total)| sum.map(|x| x / total[0])).collect();
    }
    if wrong.contains(&"empty_rays_skipped") {
        let rays: Vec<([f64; 3], usize)> =
            out.iter().zip(offsets.windows(2)).map(|(sum, ray)| (*sum, ray[1] - ray[0])).collect();
        out = skipped(&rays, |ray| ray.1 == 0, ([0.0; 3], 0)).into_iter().map(|ray| ray.0).collect();
    }
    sums(&out)
}

/// Their gradients.
pub(crate) fn accumulate_vjp(a: &Arrays, _: &Conventions, wrong: &[&str]) -> Arrays {
    let (weights, colors, offsets) = (values(a, "weights"), threes(a, "values"), offsets(a, "weights"));
    let g = threes(a, "grad_sums");
    let (mut g_weights, g_values) = backward::accumulate(&weights, &colors, &offsets, &g);
    if wrong.contains(&"one_color_to_weights") {
        let red: Vec<[f64; 3]> = g.iter().map(|g| [g[0], 0.0, 0.0]).collect();
        g_weights = backward::accumulate(&weights, &colors, &offsets, &red).0;
    }
    if wrong.contains(&"weights_detached") {
        g_weights.fill(0.0);
    }
    gradients(g_weights, &g_values)
}
