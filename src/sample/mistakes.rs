//! Samples, wrong on purpose. Every function takes the names of its mistakes; without any it equals the oracle.
//!
//! Grids with both ends, jitter over their spacing, differences for widths and the choices of the last step are conventions. What
//! a single call can't show (jitter at evaluation, frozen, Gaussian) is found by statistics over repeated calls.

mod catalogue;
pub(crate) mod laws;
mod places;

pub(crate) use catalogue::*;

use super::{arrays, sample_along_ray, step_sizes as oracle_steps};
use crate::contract::arrays::{Arrays, array, arrays, input, number, row, size};
use crate::contract::component::number_of;
use crate::convention::{Conventions, Grid};
use crate::math::pow;

/// One ray's positions as the mistakes have them.
fn wrong_positions(a: &Arrays, r: usize, c: &Conventions, wrong: &[&str]) -> Vec<f64> {
    let (near, far) = match () {
        () if wrong.contains(&"unit_interval") || wrong.contains(&"grid_of_unit_interval") => (0.0, 1.0),
        () if wrong.contains(&"near_taken_for_zero") => (0.0, number(a, "far")),
        () => (number(a, "near"), number(a, "far")),
    };
    let mut u = row(a, "u", if wrong.contains(&"one_jitter_for_all_rays") { 0 } else { r });
    let n = u.len();
    let far = number_of("length_of_its_own", SAMPLE_ALONG_RAYS, wrong).map_or(far, |length| near + length);
    let width = (far - near) / n as f64;
    for name in wrong {
        match *name {
            // Where the grid has both ends, they are what is left without a jitter.
            "never_jittered" if c.grid != Grid::Intervals => {
                return sample_along_ray(near, far, &vec![0.0; n], Grid::EndsPlusWidth);
            }
            "never_jittered" => u.fill(0.5),
            "jitter_in_unit_widths" => u.iter_mut().for_each(|u| *u /= far - near),
            "grid_of_unit_interval" => {
                u.iter_mut().for_each(|u| *u *= number(a, "far") - number(a, "near"));
            }
            "jitter_of_the_whole_range" | "jittered_far_and_sorted" => {
                u.iter_mut().for_each(|u| *u *= n as f64)
            }
            "left_edges_alone" => u.fill(0.0),
            "one_jitter_for_all_samples" if n > 0 => u = vec![u[0]; n],
            "one_bin_early" => u.iter_mut().for_each(|u| *u -= 1.0),
            "jitter_centered_on_edges" => u.iter_mut().for_each(|u| *u -= 0.5),
            _ => {
                if let Some(fixed) = name.strip_prefix("jitter_width_").and_then(|w| w.parse::<f64>().ok()) {
                    u.iter_mut().for_each(|u| *u *= fixed / width);
                }
            }
        }
    }
    if let Some(fixed) = JITTER_WIDTH.among(wrong) {
        u.iter_mut().for_each(|u| *u *= fixed / width);
    }
    if let Some(k) = number_of("jitter_of_a_share", SAMPLE_ALONG_RAYS, wrong) {
        u.iter_mut().for_each(|u| *u *= k * n as f64);
    }
    if let Some(k) = JITTER_ABOUT_GRID.among(wrong) {
        u.iter_mut().for_each(|u| *u = (2.0 * *u - 1.0) * k / width);
    }
    if wrong.contains(&"middles_not_halved") {
        let edge = |i: usize| near + i as f64 * width;
        return (0..n).map(|i| edge(i) + 0.5 * edge(i + 1)).collect();
    }
    if wrong.contains(&"ends_held") && n > 0 {
        (u[0], u[n - 1]) = (0.0, 0.0);
        return sample_along_ray(near, far, &u, Grid::EndsPlusSpacing);
    }
    let t = bent(sample_along_ray(near, far, &u, c.grid), [near, far], &u, c, wrong);
    rearranged(t, [near, far], &u, wrong)
}

/// Positions in other strata, or in another order.
fn rearranged(mut t: Vec<f64>, [near, far]: [f64; 2], u: &[f64], wrong: &[&str]) -> Vec<f64> {
    let has = |name: &str| wrong.contains(&name);
    let n = t.len();
    let place = |i: usize| near + (far - near) * i as f64 / (n.max(2) - 1) as f64;
    if has("lower_halves_alone") {
        let lower = |i: usize| if i == 0 { near } else { 0.5 * (place(i - 1) + place(i)) };
        t = (0..n).map(|i| lower(i) + u[i] * (place(i) - lower(i))).collect();
    }
    if has("strata_of_two_spacings") {
        let ends = |i: usize| [place(i.saturating_sub(1)), place((i + 1).min(n - 1))];
        t = (0..n).map(|i| ends(i)[0] + u[i] * (ends(i)[1] - ends(i)[0])).collect();
    }
    if has("middles_of_jittered_edges") {
        t = (0..n).map(|i| 0.5 * (t[i] + t.get(i + 1).copied().unwrap_or(far))).collect();
    }
    if has("held_in_the_range") {
        let spaced = sample_along_ray(near, far, u, Grid::EndsPlusSpacing);
        t = spaced.into_iter().map(|t| t.clamp(near.min(far), far.max(near))).collect();
    }
    if has("jittered_far_and_sorted") {
        t.sort_by(f64::total_cmp);
    }
    t
}

/// Positions by another law.
fn bent(t: Vec<f64>, [near, far]: [f64; 2], u: &[f64], c: &Conventions, wrong: &[&str]) -> Vec<f64> {
    let has = |name: &str| wrong.contains(&name);
    let law: fn(f64, f64, f64) -> f64 = match () {
        () if has("even_in_disparity") => |s, near, far| 1.0 / ((1.0 - s) / near + s / far),
        () if has("even_in_square") => |s, near, far| near + s * s * (far - near),
        () if has("even_then_in_disparity") => |s, near, far| {
            let (spaced, back) = (
                |x: f64| if x < 1.0 { 0.5 * x } else { 1.0 - 0.5 / x },
                |y: f64| if y < 0.5 { 2.0 * y } else { 0.5 / (1.0 - y) },
            );
            back((1.0 - s) * spaced(near) + s * spaced(far))
        },
        () if has("even_in_logarithm") => |s, near, far| pow(near, 1.0 - s) * pow(far, s),
        () => {
            let drawn = |u: &f64| near + u * (far - near);
            let mut drawn: Vec<f64> = u.iter().map(drawn).collect();
            if has("drawn_and_sorted") {
                drawn.sort_by(f64::total_cmp);
            }
            return match () {
                () if has("drawn_without_bins") || has("drawn_and_sorted") => drawn,
                () if has("grid_times_jitter") => {
                    let n = u.len() as f64;
                    u.iter().enumerate().map(|(i, u)| near + (far - near) * (i as f64 / n) * u).collect()
                }
                () if has("from_far_to_near") => t.iter().map(|t| far - (t - near)).collect(),
                () => t,
            };
        }
    };
    if c.grid != Grid::EndsBetweenMidpoints {
        return t.iter().map(|t| law((t - near) / (far - near), near, far)).collect();
    }
    // The law gives the grid, and the jitter spreads between its middles.
    let last = u.len().max(2) - 1;
    let grid = |i: usize| law(i as f64 / last as f64, near, far);
    let middle = |i: usize| 0.5 * (grid(i) + grid(i + 1));
    let ends = |i: usize| {
        [if i == 0 { grid(0) } else { middle(i - 1) }, if i >= last { grid(i) } else { middle(i) }]
    };
    (0..u.len()).map(|i| ends(i)[0] + u[i] * (ends(i)[1] - ends(i)[0])).collect()
}

/// Positions and points.
pub(crate) fn sample_along_rays(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let (rays, samples) = size(a, "u");
    let t: Vec<_> = (0..rays).map(|r| wrong_positions(a, r, c, wrong)).collect();
    let mut a = a.clone();
    if wrong.contains(&"unit_directions") {
        let d = a.get_mut("rays_d").expect("checked");
        for mut d in d.rows_mut() {
            let length = d.iter().map(|x| x * x).sum::<f64>().sqrt();
            d.mapv_inplace(|x| x / length);
        }
    }
    if wrong.contains(&"points_without_origin") {
        a.get_mut("rays_o").expect("checked").fill(0.0);
    }
    let mut out = arrays::samples(&a, &t);
    if wrong.contains(&"origin_times_t") {
        let d = input(&a, "rays_o") + input(&a, "rays_d");
        let moved = a.clone().into_iter().chain([("rays_d".to_string(), d)]);
        let mut moved: Arrays = moved.collect();
        moved.get_mut("rays_o").expect("checked").fill(0.0);
        out.insert("points".into(), arrays::samples(&moved, &t).remove("points").expect("an output"));
    }
    if wrong.contains(&"points_from_near") {
        let near = number(&a, "near");
        let nearer: Vec<Vec<f64>> = t.iter().map(|t| t.iter().map(|t| t - near).collect()).collect();
        let points = arrays::samples(&a, &nearer).remove("points").expect("an output");
        out.insert("points".into(), points);
    }
    if wrong.contains(&"near_added_twice") {
        let near = number(&a, "near");
        let farther: Vec<Vec<f64>> = t.iter().map(|t| t.iter().map(|t| t + near).collect()).collect();
        out.insert("points".into(), arrays::samples(&a, &farther).remove("points").expect("an output"));
    }
    if wrong.contains(&"near_added_for_points_alone") {
        let near = number(&a, "near");
        out.get_mut("t").expect("an output").mapv_inplace(|t| t - near);
    }
    if wrong.contains(&"t_without_jitter") {
        let still: Vec<Vec<f64>> =
            (0..rays).map(|r| wrong_positions(&a, r, c, &[wrong, &["never_jittered"]].concat())).collect();
        out.insert("t".into(), arrays::samples(&a, &still).remove("t").expect("an output"));
    }
    if wrong.contains(&"flattened_in_wrong_order") {
        let points = input(&out, "points");
        let turned = points.view().permuted_axes(vec![1, 0, 2]).iter().copied().collect();
        let turned = array(&[rays, samples, 3], turned);
        out.insert("points".into(), turned);
    }
    out
}

/// One ray's steps as the mistakes have them.
fn wrong_steps(a: &Arrays, r: usize, c: &Conventions, wrong: &[&str]) -> Vec<f64> {
    let (near, far) = (number(a, "near"), number(a, "far"));
    let first = wrong.contains(&"first_ray_deltas");
    let t = row(a, "t", if first { 0 } else { r });
    let n = t.len();
    let gap = |i: usize| if i + 1 < n { t[i + 1] - t[i] } else { far - t[i] };
    let mut deltas = oracle_steps(&t, near, far, c.delta, c.last_delta);
    for name in wrong {
        match *name {
            "delta_missing" => deltas.fill(1.0),
            "delta_unit_interval" => deltas.fill(1.0 / n as f64),
            "delta_over_n_minus_1" if n > 1 => deltas.fill((far - near) / (n - 1) as f64),
            "backward_delta" => deltas = (0..n).map(|i| if i == 0 { 0.0 } else { gap(i - 1) }).collect(),
            "backward_delta_from_near" => {
                deltas = (0..n).map(|i| t[i] - if i == 0 { near } else { t[i - 1] }).collect();
            }
            "delta_of_the_whole_ray" => deltas.fill(far - near),
            "backward_delta_from_zero" => {
                deltas = (0..n).map(|i| t[i] - if i == 0 { 0.0 } else { t[i - 1] }).collect();
            }
            "delta_differenced_twice" => {
                deltas = (1..n).map(|i| gap(i) - gap(i - 1)).chain([1e10]).collect();
            }
            "first_gap_for_all" if n > 1 => deltas.fill(gap(0)),
            "last_gap_too_early" if n > 2 => deltas[n - 1] = gap(n - 3),
            "last_delta_wraps" => deltas = (0..n).map(|i| t[(i + 1) % n] - t[i]).collect(),
            "central_differences" => {
                let central = |i: usize| if i == 0 || i + 1 == n { 0.0 } else { 0.5 * (t[i + 1] - t[i - 1]) };
                deltas = (0..n).map(central).collect();
            }
            "mean_gap_for_all" if n > 1 => deltas.fill((t[n - 1] - t[0]) / (n - 1) as f64),
            "last_delta_zero" => deltas = (0..n).map(|i| if i + 1 < n { gap(i) } else { 0.0 }).collect(),
            "first_ray_deltas" if n > 1 => deltas = (0..n).map(gap).collect(),
            _ => {}
        }
    }
    deltas
}

/// Step lengths.
pub(crate) fn step_sizes(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let (rays, samples) = size(a, "t");
    let deltas = (0..rays).flat_map(|r| wrong_steps(a, r, c, wrong)).collect();
    arrays([("deltas", array(&[rays, samples], deltas))])
}
