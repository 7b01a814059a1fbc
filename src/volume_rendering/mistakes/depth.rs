//! The expected distance, wrong on purpose.

use ndarray::{ArrayD, Axis};

use crate::contract::arrays::{Arrays, array, input, number, row, size};
use crate::contract::component::Mistake;
use crate::convention::{Conventions, Depth};
use crate::volume_rendering::arrays;

const OFF_WEIGHT: Mistake = Mistake::new(
    "eps_beside_weight",
    "sum w t / (sum w + eps), with an eps that shows",
    "thin rays are too near, empty ones at 0",
    "say what an empty ray's depth is, and divide by the sum alone",
    "never; cheap to keep",
    0,
)
.with("eps", 1e-3, [1e-8, 1.0]);
const THIN_LEFT_OUT: Mistake = Mistake::new(
    "thin_rays_left_out",
    "0 where the weights' sum is below a threshold",
    "holes in depth pictures where it is hazy",
    "far, where there is no weight at all",
    "never; cheap to keep",
    0,
)
.with("least", 0.5, [1e-7, 0.99]);
const THIN_AT_FAR: Mistake = Mistake::new(
    "thin_rays_at_far",
    "far where the weights' sum is below a threshold",
    "haze is drawn as the background's distance",
    "far, where there is no weight at all",
    "never; cheap to keep",
    0,
)
.with("least", 0.5, [1e-7, 0.99]);
const FIRST_SURFACE: Mistake = Mistake::new(
    "first_weight_above",
    "the t of the first weight above a threshold",
    "depths that jump from sample to sample, and have no gradient",
    "sum w t / A",
    "never; cheap to keep",
    0,
)
.with("least", 0.01, [1e-4, 0.5]);
const EMPTY_OF_ITS_OWN: Mistake = Mistake::new(
    "empty_depth_of_its_own",
    "a number of its own where the weights' sum is 0",
    "empty rays lie at no distance that the scene has",
    "far, or what the program says an empty ray's depth is",
    "1 public implementation, with 1e10",
    1,
)
.with("depth", 1e10, [1e-6, 1e12]);

/// Mistakes of the expected distance.
pub(crate) const DEPTH: &[Mistake] = &[
    Mistake::new(
        "nan_behind_a_choice",
        "far is chosen behind sum w t / sum w: on a ray without weight the quotient is never seen, and its gradient is 0 / 0",
        "one empty ray, and all weights are NaN after the next step",
        "choose the divisor, not the quotient: sum w t / where(sum w > 0, sum w, 1)",
        "ports of mip-NeRF: nan_to_num(distance, inf), then clip",
        1,
    )
    .of_gradient(),
    Mistake::new(
        "zero_by_zero",
        "sum w t / sum w on a ray without weight",
        "NaN in depth pictures, and in losses on them",
        "say what an empty ray's depth is: far",
        "nerf-pytorch#28 and many others",
        10,
    ),
    Mistake::new(
        "median_depth",
        "the t at which half of the light is spent, not the mean",
        "depths that jump from sample to sample, and have no gradient in the weights",
        "the weighted mean, or say that the median is meant",
        "nerfstudio's renderers.py, method median: another quantity",
        2,
    ),
    Mistake::new(
        "median_depth_or_none",
        "the t at which half of the light is spent, 0 where that never is",
        "depths that jump from sample to sample, and holes where it is hazy",
        "the weighted mean, or say that the median is meant",
        "1 port of HyperNeRF",
        1,
    ),
    Mistake::new(
        "not_a_number_everywhere",
        "0 times infinity in a sum: a mask over distances that end with infinity",
        "no depth at all",
        "far for infinity, or where(mask, t, 0)",
        "1 port of TensoRF to JAX",
        1,
    ),
    Mistake::new(
        "disparity",
        "1 / max(depth, 1e-10)",
        "near is large: another quantity",
        "sum w t / A",
        "nerf-pytorch's and other ports' disp_map",
        3,
    ),
    Mistake::new(
        "far_by_opacity",
        "sum w t + A far: far is added where the ray meets something, not where it meets nothing",
        "surfaces lie behind far",
        "sum w t + (1 - A) far, or sum w t / A",
        "1 public implementation and its copies",
        2,
    ),
    Mistake::new(
        "depth_of_index",
        "sum w i / sum w: the sample's number in the place of t",
        "depth without units",
        "weigh t",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "one_where_light_is_left",
        "1 - A, the white background's share, is added to the depth",
        "empty rays lie 1 farther, thin ones less, wherever far is",
        "sum w t + (1 - A) far, or sum w t / A",
        "renderers whose white_bkgd goes over colors and depths alike",
        1,
    ),
    Mistake::new(
        "kept_between_the_samples",
        "sum w t, not divided, and then no nearer than the first sample and no farther than the last",
        "thin rays all lie at the first sample",
        "sum w t / A",
        "1 port of mip-NeRF",
        1,
    ),
    OFF_WEIGHT,
    THIN_LEFT_OUT,
    THIN_AT_FAR,
    FIRST_SURFACE,
    Mistake::new(
        "weights_of_all_rays",
        "divided by the sum of all rays' weights",
        "depths that shrink as the batch grows",
        "the sum over the ray's own samples",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "middles_between_samples",
        "middles between neighboring samples, the last one as it is",
        "depths half a step too far",
        "the t at which the weight was found",
        "never; cheap to keep",
        0,
    ),
    EMPTY_OF_ITS_OWN,
    Mistake::new(
        "depth_of_the_heaviest",
        "the t of the largest weight",
        "depths that jump from sample to sample, and have no gradient",
        "the weighted mean",
        "argmax of the weights where a mesh or a flow is wanted",
        0,
    ),
    Mistake::new(
        "middles_of_gaps",
        "sum w_i (t_i + t_{i+1}) / 2, without the last weight",
        "depths half a gap too far",
        "t where the weights belong to samples",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "steps_summed_for_t",
        "sum w_i (delta_0 + ... + delta_i): the steps' cumulative sum in the place of t, not divided",
        "depths that begin at the first sample, and a step too far",
        "t itself",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "middles_of_steps",
        "t + delta / 2 in the place of t, the last step up to far",
        "depths half a step too far",
        "t where the weights belong to samples",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "last_sample_for_the_rest",
        "sum w t + (1 - A) t_last",
        "empty rays end at the last sample, thin ones near it",
        "far, or the division by A",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "share_of_far",
        "sum w t / far",
        "depths in [0, 1]: another quantity",
        "sum w t / A",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "empty_depth_of_the_batch",
        "the largest t of all rays where the weights' sum is 0: NaN made infinite, and cut to the batch's range",
        "an empty ray's depth depends on what it is rendered with",
        "far, or what the program says an empty ray's depth is",
        "EG3D's ray marcher and its copies",
        2,
    ),
    Mistake::new(
        "counted_from_the_first",
        "sum w (t - t_0)",
        "depths that begin at the first sample",
        "t itself",
        "never; cheap to keep",
        0,
    ),
];

/// Expected distance.
pub(crate) fn depth(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let mut a = a.clone();
    if wrong.contains(&"depth_of_index") {
        a.get_mut("t").expect("checked").indexed_iter_mut().for_each(|(i, t)| *t = i[1] as f64);
    }
    if wrong.contains(&"middles_of_steps") {
        let far = number(&a, "far");
        for mut t in a.get_mut("t").expect("checked").rows_mut() {
            let ends = step_ends(&t.to_vec(), far);
            t.iter_mut().zip(ends).for_each(|(t, end)| *t = 0.5 * (*t + end));
        }
    }
    let mut depths = arrays::depths(&a, c);
    let opacity = |r| row(&a, "weights", r).iter().sum::<f64>();
    if wrong.contains(&"far_by_opacity") {
        let (far, (rays, _)) = (number(&a, "far"), size(&a, "weights"));
        let plain = arrays::depths(&a, &Conventions { depth: Depth::Plain, ..*c });
        let moved = input(&plain, "depth").iter().enumerate().map(|(r, z)| z + far * opacity(r)).collect();
        depths.insert("depth".into(), array(&[rays], moved));
    }
    if wrong.contains(&"median_depth") {
        depths.insert("depth".into(), medians(&a, |t| t[t.len() - 1]));
    }
    if wrong.contains(&"median_depth_or_none") {
        depths.insert("depth".into(), medians(&a, |_| 0.0));
    }
    if wrong.contains(&"not_a_number_everywhere") {
        depths.get_mut("depth").expect("an output").fill(f64::NAN);
    }
    let farthest = || input(&a, "t").iter().copied().fold(f64::MIN, f64::max);
    let of_batch = wrong.contains(&"empty_depth_of_the_batch").then(farthest);
    let divided = wrong.contains(&"zero_by_zero") && c.depth == Depth::Divided;
    if let Some(own) = EMPTY_OF_ITS_OWN.among(wrong).or(of_batch).or(divided.then_some(f64::NAN)) {
        let each = depths.get_mut("depth").expect("an output").iter_mut().enumerate();
        each.filter(|(r, _)| opacity(*r) == 0.0).for_each(|(_, z)| *z = own);
    }
    if let Some(z) = other_depths(&a, wrong) {
        depths.insert("depth".into(), z);
    }
    if wrong.contains(&"one_where_light_is_left") {
        let each = depths.get_mut("depth").expect("an output").iter_mut().enumerate();
        each.for_each(|(r, z)| *z += 1.0 - opacity(r));
    }
    if wrong.contains(&"disparity") {
        depths.insert("depth".into(), input(&depths, "depth").mapv(|z| 1.0 / z.max(1e-10)));
    }
    depths
}

/// Where each step ends: at the next sample, the last one at far.
fn step_ends(t: &[f64], far: f64) -> Vec<f64> {
    t.iter().copied().skip(1).chain([far]).take(t.len()).collect()
}

/// Depths by another law than the mean over the weights' sum.
fn other_depths(a: &Arrays, wrong: &[&str]) -> Option<ArrayD<f64>> {
    let has = |name: &str| wrong.contains(&name);
    let (eps, least) = (OFF_WEIGHT.among(wrong), THIN_LEFT_OUT.among(wrong));
    let (at_far, first) = (THIN_AT_FAR.among(wrong), FIRST_SURFACE.among(wrong));
    let of_all = input(a, "weights").sum();
    let one = |r: usize| -> Option<f64> {
        let (weights, t) = (row(a, "weights", r), row(a, "t", r));
        let sum = |t: &[f64]| weights.iter().zip(t).map(|(w, t)| w * t).sum::<f64>();
        let opacity = weights.iter().sum::<f64>();
        let heaviest = |most: usize, i: usize| if weights[i] > weights[most] { i } else { most };
        let middles: Vec<f64> = t.windows(2).map(|t| 0.5 * (t[0] + t[1])).collect();
        Some(match () {
            () if eps.is_some() => sum(&t) / (opacity + eps?),
            () if least.is_some() && opacity < least? => 0.0,
            () if least.is_some() => sum(&t) / opacity,
            () if at_far.is_some_and(|least| opacity <= least) => number(a, "far"),
            () if at_far.is_some() => sum(&t) / opacity,
            () if first.is_some() => {
                t[weights.iter().position(|w| first.is_some_and(|least| *w > least)).unwrap_or(0)]
            }
            () if has("weights_of_all_rays") => sum(&t) / of_all,
            () if has("middles_between_samples") => {
                let last = t[t.len() - 1];
                sum(&middles.iter().copied().chain([last]).collect::<Vec<_>>()) / opacity
            }
            () if has("depth_of_the_heaviest") => t[(0..t.len()).fold(0, heaviest)],
            () if has("middles_of_gaps") => sum(&middles),
            () if has("steps_summed_for_t") => sum(&step_ends(&t, number(a, "far"))) - opacity * t[0],
            () if has("last_sample_for_the_rest") => sum(&t) + (1.0 - opacity) * t[t.len() - 1],
            // Not `clamp`, which panics where a t is NaN.
            () if has("kept_between_the_samples") => sum(&t).max(t[0]).min(t[t.len() - 1]),
            () if has("share_of_far") => sum(&t) / number(a, "far"),
            () if has("counted_from_the_first") => sum(&t) - opacity * t[0],
            () => return None,
        })
    };
    let (rays, _) = size(a, "weights");
    let all: Option<Vec<f64>> = (0..rays).map(one).collect();
    all.map(|all| array(&[rays], all))
}

/// The first t at which the weights' sum reaches 1/2, but for its rounding; something else where it never does.
fn medians(a: &Arrays, otherwise: fn(&[f64]) -> f64) -> ArrayD<f64> {
    let median = |r| {
        let (weights, t) = (row(a, "weights", r), row(a, "t", r));
        let mut spent = 0.0;
        let reached = weights.iter().position(|w| {
            spent += w;
            spent >= 0.499_99
        });
        reached.map_or_else(|| otherwise(&t), |n| t[n])
    };
    let (rays, _) = size(a, "weights");
    array(&[rays], (0..rays).map(median).collect())
}

/// Gradient of the expected distance: none of its own.
pub(crate) fn depth_vjp(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let mut gradients = arrays::depths_vjp(a, c);
    if wrong.contains(&"nan_behind_a_choice") {
        let empty = |r: usize| row(a, "weights", r).iter().all(|w| *w == 0.0);
        for r in (0..size(a, "weights").0).filter(|&r| empty(r)) {
            gradients.values_mut().for_each(|g| g.index_axis_mut(Axis(0), r).fill(f64::NAN));
        }
    }
    gradients
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contract::arrays::scalar;
    use crate::convention::CS180;

    /// The judge asks wrong code about inputs that are changed in its turn.
    #[test]
    fn positions_that_are_no_numbers_stop_nobody() {
        let t = array(&[2, 2], vec![1.0, f64::NAN, f64::NAN, 2.0]);
        let a = crate::contract::arrays::arrays([
            ("weights", array(&[2, 2], vec![0.25, 0.5, 0.0, 0.0])),
            ("t", t),
            ("far", scalar(4.0)),
        ]);
        for mistake in DEPTH {
            assert_eq!(depth(&a, &CS180, &[mistake.name])["depth"].len(), 2, "{}", mistake.name);
        }
    }
}
