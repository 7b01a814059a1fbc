//! The frustum's Gaussian, wrong on purpose. Without a mistake every function equals the oracle.
//!
//! The closed forms in powers of the ends, 3 (t1^4 - t0^4) / (4 (t1^3 - t0^3)) and its like, are no mistake by name: what they answer is
//! noise, which the cases PE5 show.

use super::arrays::{cotangents, forward, frustums, vjp};
use super::{Frustum, Gaussian, across, backward, conical_frustum as oracle, moments, thickness};
use crate::contract::arrays::Arrays;
use crate::contract::component::Mistake;
use crate::convention::{Conventions, RayShape};

const ROUGH_MOMENTS: Mistake = Mistake::new("rough_moments","the middle mu for the mean, hw^2 / 3 along the ray, r^2 (mu^2 / 4 + k hw^2) across: mip-NeRF's first terms alone","samples lie too near, and long intervals are blurred too much along the ray","all terms: the mean and both variances of a cone","a student's mip-NeRF: 1/5",1)
.with("k", 0.2, [0.01, 2.0]);

/// Mistakes of the frustum's Gaussian.
pub(crate) const CONICAL_FRUSTUM: &[Mistake] = &[
    Mistake::new(
        "middle_for_mean",
        "the middle (t0 + t1) / 2 for the mean: a cone has more of its volume at its far end",
        "samples lie too near, the more the longer the interval is",
        "s (1/2 + q)",
        "code that has rays' middles at hand",
        0,
    ),
    Mistake::new(
        "fifths_forgotten",
        "the variance along the ray without its second term: d^2 / 12, a cylinder's",
        "long intervals are blurred too much along the ray",
        "- 4/15 of the half width's fourth power (...), or d^2 (5 - 16 q + 20 q^2) / 60",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "radius_at_mean",
        "r^2 t_mean^2 / 4: the disk at the mean for the whole frustum",
        "long intervals are a bit too thick or too thin",
        "r^2 (s^2 / 16 + d^2 (5/48 - q / 15))",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "variances_exchanged",
        "the variance along the ray across it, and the other way around, in space",
        "Gaussians lie across their rays",
        "t_variance d_i^2 + r_variance (1 - d_i^2 / |d|^2)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "middle_and_half_exchanged",
        "mu^2 + 3 hw^2 for 3 mu^2 + hw^2",
        "samples lie too far",
        "3 mu^2 + hw^2",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "deviations_for_variances",
        "the root of every variance",
        "narrow Gaussians are blurred, wide ones sharp",
        "variances, as they are",
        "never; cheap to keep",
        0,
    ),
    ROUGH_MOMENTS,
    Mistake::new(
        "width_for_half_width",
        "t1 - t0 for the half width",
        "variances along the ray are four times too large",
        "(t1 - t0) / 2",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "radius_at_middle",
        "the disk at the middle for the whole frustum: r^2 (t0 + t1)^2 / 16",
        "long intervals are too thin",
        "r^2 (s^2 / 16 + d^2 (5/48 - q / 15))",
        "short versions of mip-NeRF",
        0,
    ),
    Mistake::new(
        "radius_not_squared",
        "r times the squared distance",
        "small pixels' cones are thousands of times too wide: pictures are blurred",
        "r^2",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "quarter_forgotten",
        "the squared radius for the variance of a disk",
        "everything is blurred twice as wide",
        "r^2 / 4 on each line across a disk",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "across_everywhere",
        "the variance across the ray on all axes: without the projection 1 - d_i^2 / |d|^2",
        "samples are blurred along the ray by the pixel's width",
        "r_variance (1 - d_i^2 / |d|^2)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "projection_of_unit_direction",
        "1 - d_i^2 where the direction isn't of unit length",
        "negative variances: waves grow in place of fading",
        "divide by |d|^2",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "direction_normalized",
        "the variance along the ray times the unit direction's squares",
        "samples of long directions are too sharp along the ray",
        "t counts in units of the direction: times d_i^2 as it is",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "direction_not_squared",
        "t_variance |d_i| for t_variance d_i^2",
        "Gaussians turn away from their ray",
        "the diagonal of d d^T",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "origin_forgotten",
        "the mean t_mean d, as the paper's frame has it",
        "every camera looks from the origin",
        "add o",
        "mip.py's conical_frustum_to_gaussian taken without its cast_rays, which adds the origin",
        0,
    ),
    Mistake::new(
        "variances_detached",
        "the gradient of the means alone",
        "poses and sample distances aren't told that sharper is better",
        "variances depend on them, too",
        "covariances made under no_grad",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "directions_by_mean_alone",
        "t_mean g_mean for the gradient of the direction",
        "poses are slightly off",
        "both variances turn and stretch with the direction",
        "hand-written backward passes",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "projection_held",
        "1 - d_i^2 / |d|^2 taken for a constant",
        "poses are slightly off",
        "its slopes: 2 d_j / |d|^2 times sum_i (g_i - g_j) d_i^2 / |d|^2",
        "hand-written backward passes",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "ratio_held",
        "q taken for a constant",
        "distances that a proposal gives are off by half of what they move",
        "q depends on both ends",
        "hand-written backward passes",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "ends_by_halves",
        "half of the mean's gradient to each end, as if it were the middle",
        "the near end moves with the far one",
        "1/2 - q + 2 q^2 of the sum, 6 (d/s) / (3 + (d/s)^2)^2 of the difference",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "radius_slope_halved",
        "r in the place of 2 r",
        "radii follow half as fast",
        "2 r",
        "hand-written backward passes",
        0,
    )
    .of_gradient(),
];

/// Moments as [`moments`] has them, with a mistake in them.
fn wrong_moments(f: &Frustum, shape: RayShape, wrong: &[&str]) -> (f64, f64, f64) {
    let has = |name: &str| wrong.contains(&name);
    let (s, d) = (f.start + f.end, f.end - f.start);
    let (mean, along, squares) = if has("width_for_half_width") {
        moments(0.5 * s - d, 0.5 * s + d, shape)
    } else {
        moments(f.start, f.end, shape)
    };
    if let Some(k) = ROUGH_MOMENTS.among(wrong).filter(|_| shape == RayShape::Cone) {
        return (0.5 * s, d * d / 12.0, s * s / 16.0 + k * d * d / 4.0);
    }
    if has("middle_and_half_exchanged") && shape == RayShape::Cone {
        let (mu, hw) = (0.5 * s, 0.5 * d);
        let (mu, hw, sum) = (mu * mu, hw * hw, mu * mu + 3.0 * hw * hw);
        return (
            0.5 * s * (1.0 + 2.0 * hw / sum),
            hw / 3.0 - 4.0 / 15.0 * hw * hw * (12.0 * mu - hw) / (sum * sum),
            mu / 4.0 + 5.0 / 12.0 * hw - 4.0 / 15.0 * hw * hw / sum,
        );
    }
    if has("radius_at_mean") && shape == RayShape::Cone {
        return (mean, along, 0.25 * mean * mean);
    }
    (
        if has("middle_for_mean") { 0.5 * s } else { mean },
        if has("fifths_forgotten") { d * d / 12.0 } else { along },
        if has("radius_at_middle") && shape == RayShape::Cone { s * s / 16.0 } else { squares },
    )
}

/// The Gaussian with mistakes in it.
fn gaussian(f: &Frustum, shape: RayShape, wrong: &[&str]) -> Gaussian {
    if wrong.is_empty() {
        return oracle(f, shape);
    }
    let has = |name: &str| wrong.contains(&name);
    let v = f.direction;
    let (t_mean, t_variance, squares) = wrong_moments(f, shape, wrong);
    let squares = if has("quarter_forgotten") { 4.0 * squares } else { squares };
    let r_variance = f.radius * squares * if has("radius_not_squared") { 1.0 } else { f.radius };
    let length = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    let mean = [0, 1, 2].map(|i| t_mean * v[i] + if has("origin_forgotten") { 0.0 } else { f.origin[i] });
    let variance = [0, 1, 2].map(|i| {
        let square = match () {
            () if has("direction_normalized") => v[i] * v[i] / length,
            () if has("direction_not_squared") => v[i].abs(),
            () => v[i] * v[i],
        };
        let part = match () {
            () if has("across_everywhere") => 1.0,
            () if has("projection_of_unit_direction") => 1.0 - v[i] * v[i],
            () => across(v, i),
        };
        if has("variances_exchanged") {
            return r_variance * square + t_variance * part;
        }
        t_variance * square + r_variance * part
    });
    if has("deviations_for_variances") {
        let (t_variance, r_variance) = (t_variance.sqrt(), r_variance.sqrt());
        return Gaussian { t_mean, t_variance, r_variance, mean, variance: variance.map(f64::sqrt) };
    }
    Gaussian { t_mean, t_variance, r_variance, mean, variance }
}

/// The frustums' Gaussians.
pub(crate) fn conical_frustum(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    forward(&frustums(a).iter().map(|f| gaussian(f, c.ray_shape, wrong)).collect::<Vec<_>>())
}

/// What reaches the moments: those of the mean, along and across.
fn to_moments(f: &Frustum, g: &Gaussian) -> [f64; 3] {
    let v = f.direction;
    [0, 1, 2].iter().fold([g.t_mean, g.t_variance, g.r_variance], |[mean, along, round], &i| {
        let variance = g.variance[i];
        [mean + g.mean[i] * v[i], along + variance * v[i] * v[i], round + variance * across(v, i)]
    })
}

/// The gradients of start and end where q is held.
fn ends_with_ratio_held(f: &Frustum, g: &Gaussian) -> (f64, f64) {
    let (s, d) = (f.start + f.end, f.end - f.start);
    let (q, [mean, along, round]) = (thickness(s, d), to_moments(f, g));
    let round = f.radius * f.radius * round;
    let g_s = (0.5 + q) * mean - 24.0 / 15.0 * s * q * q * along + s / 8.0 * round;
    let g_d = (1.0 / 6.0 + 2.0 / 15.0 * q * q) * d * along + 2.0 * d * (5.0 / 48.0 - q / 15.0) * round;
    (g_s - g_d, g_s + g_d)
}

/// The gradient with a mistake in it.
fn gradient(f: &Frustum, shape: RayShape, g: &Gaussian, wrong: &[&str]) -> Frustum {
    let right = backward::conical_frustum(f, shape, g);
    let (t_mean, t_variance, _) = moments(f.start, f.end, shape);
    let of_mean = g.mean.map(|g| t_mean * g);
    let by_mean = Gaussian { t_variance: 0.0, r_variance: 0.0, variance: [0.0; 3], ..*g };
    match wrong.first() {
        Some(&"variances_detached") => backward::conical_frustum(f, shape, &by_mean),
        Some(&"directions_by_mean_alone") => Frustum { direction: of_mean, ..right },
        Some(&"projection_held") => {
            let stretched = |j: usize| of_mean[j] + 2.0 * t_variance * f.direction[j] * g.variance[j];
            Frustum { direction: [0, 1, 2].map(stretched), ..right }
        }
        Some(&"ratio_held") if shape == RayShape::Cone => {
            let (start, end) = ends_with_ratio_held(f, g);
            Frustum { start, end, ..right }
        }
        Some(&"ends_by_halves") => {
            let others = Gaussian { t_mean: 0.0, mean: [0.0; 3], ..*g };
            let (others, half) = (backward::conical_frustum(f, shape, &others), 0.5 * to_moments(f, g)[0]);
            Frustum { start: others.start + half, end: others.end + half, ..right }
        }
        Some(&"radius_slope_halved") => Frustum { radius: 0.5 * right.radius, ..right },
        _ => right,
    }
}

/// Their gradient.
pub(crate) fn conical_frustum_vjp(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let pairs = frustums(a).into_iter().zip(cotangents(a));
    vjp(&pairs.map(|(f, g)| gradient(&f, c.ray_shape, &g, wrong)).collect::<Vec<_>>())
}
