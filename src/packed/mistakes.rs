//! Packed rays, wrong on purpose. Without a mistake every function equals the oracle.

use super::arrays::{cotangents, gradient, gradients, ids, infos, offsets, scans, sums};
use super::{Scan, accumulate as oracle_sums, backward, pack_info as oracle_info, scan as oracle_scan};
use crate::contract::arrays::{Arrays, threes, values};
use crate::convention::Conventions;

mod catalogue;

pub(crate) use catalogue::{ACCUMULATE_ALONG_RAYS, PACK_INFO, PACKED_SCAN};

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
            "even_share" => {
                let share = ids.len() / rays.max(1);
                info = (0..rays).map(|ray| (ray * share, share)).collect();
            }
            _ => {}
        }
    }
    let mut out = infos(&info);
    if wrong.contains(&"empty_rays_begin_nowhere") {
        let starts = out.get_mut("starts").expect("an output");
        starts.iter_mut().zip(&info).filter(|(_, ray)| ray.1 == 0).for_each(|(start, _)| *start = -1.0);
    }
    out
}

/// All samples as one ray.
fn joined(offsets: &[usize]) -> [usize; 2] {
    [0, offsets[offsets.len() - 1]]
}

/// Sums and products from each ray's last sample on.
fn backwards(x: &[f64], offsets: &[usize]) -> Scan {
    let turned = |x: &[f64]| {
        let mut x = x.to_vec();
        offsets.windows(2).for_each(|ray| x[ray[0]..ray[1]].reverse());
        x
    };
    let Scan { exclusive_sum, inclusive_sum, exclusive_product, inclusive_product } =
        oracle_scan(&turned(x), offsets);
    Scan {
        exclusive_sum: turned(&exclusive_sum),
        inclusive_sum: turned(&inclusive_sum),
        exclusive_product: turned(&exclusive_product),
        inclusive_product: turned(&inclusive_product),
    }
}

/// Sums and products.
pub(crate) fn scan(a: &Arrays, _: &Conventions, wrong: &[&str]) -> Arrays {
    let (x, right) = (values(a, "x"), offsets(a, "x"));
    let all = if wrong.contains(&"not_reset") { joined(&right).to_vec() } else { right.clone() };
    let mut found = oracle_scan(&x, &all);
    let other = |f: &dyn Fn(f64) -> f64| oracle_scan(&x.iter().map(|&x| f(x)).collect::<Vec<_>>(), &all);
    if wrong.contains(&"from_behind") {
        found = backwards(&x, &all);
    }
    if wrong.contains(&"factors_of_light") {
        let light = other(&|x| 1.0 - x);
        (found.exclusive_product, found.inclusive_product) =
            (light.exclusive_product, light.inclusive_product);
    }
    if wrong.contains(&"product_by_logarithms") {
        let sums = other(&crate::math::ln);
        found.exclusive_product = sums.exclusive_sum.into_iter().map(crate::math::exp).collect();
        found.inclusive_product = sums.inclusive_sum.into_iter().map(crate::math::exp).collect();
    }
    let Scan { mut exclusive_sum, inclusive_sum, mut exclusive_product, inclusive_product } = found;
    if wrong.contains(&"inclusive_for_exclusive") {
        (exclusive_sum, exclusive_product) = (inclusive_sum.clone(), inclusive_product.clone());
    }
    if wrong.contains(&"first_not_reset") && !x.is_empty() {
        (exclusive_sum, exclusive_product) = (inclusive_sum.clone(), inclusive_product.clone());
        exclusive_sum.rotate_right(1);
        exclusive_product.rotate_right(1);
    }
    for ray in right.windows(2).map(|ray| ray[0]..ray[1]).filter(|ray| !ray.is_empty()) {
        if wrong.contains(&"rolled") {
            exclusive_sum[ray.start] = inclusive_sum[ray.end - 1];
            exclusive_product[ray.start] = inclusive_product[ray.end - 1];
        }
        if wrong.contains(&"product_by_division") {
            ray.for_each(|i| exclusive_product[i] = inclusive_product[i] / x[i]);
        }
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
    for (ray, out) in offsets.windows(2).zip(&mut out) {
        let n = ray[1] - ray[0];
        let of = |i: usize| colors.get(i).map_or([0.0; 3], |color| color.map(|x| weights[i] * x));
        let heavier = |most: usize, i: usize| if weights[i] > weights[most] { i } else { most };
        for name in wrong {
            *out = match *name {
                "mean_over_samples" if n > 0 => out.map(|x| x / n as f64),
                "first_sample_alone" if n > 0 => of(ray[0]),
                "last_sample_left_out" if n > 0 => {
                    let kept = |k: usize| (ray[0]..ray[1] - 1).map(|i| of(i)[k]).sum();
                    std::array::from_fn(kept)
                }
                "heaviest_sample_alone" if n > 0 => colors[(ray[0]..ray[1]).fold(ray[0], heavier)],
                "one_sample_too_many" => std::array::from_fn(|k| out[k] + of(ray[1])[k]),
                _ => *out,
            };
        }
    }
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
