//! Statistics of samplers: tests of a program's random rays and jitter, over two calls in training and two at rest.
//!
//! Every test is one-sided and holds for finite samples: Bernstein's inequality for counts and means (draws without replacement are
//! under-dispersed and pass; Hoeffding 1963, section 6) and Dvoretzky, Kiefer, Wolfowitz (with Massart's constant, 1990) for the
//! law of the jitter. Each has a false alarm of at most [`FALSE_ALARM`]; a run makes fewer than 20 of them.

use ndarray::ArrayView4;

use super::{rest_u, sample_along_ray};
use crate::contract::special::Finding;
use crate::convention::{Conventions, PixelCenter};

#[cfg(test)]
mod tests;

/// The probability that one test rejects a right sampler.
pub(crate) const FALSE_ALARM: f64 = 1e-8;

/// How far u may be off because t was rounded (f32 at t = 6 and D = 1/16 rounds u to 1e-5).
const ROUNDING: f64 = 1e-3;

/// A call that spreads its rays over more drawn images than this counts as drawing an image for each ray.
const MOST_IMAGES: usize = 64;

/// The draws of one call.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Call {
    /// The image of each ray, (R).
    pub image_ids: Vec<f64>,
    /// Pixel positions, (R).
    pub uv: Vec<[f64; 2]>,
    /// Target colors, (R).
    pub rgbs: Vec<[f64; 3]>,
    /// Positions along each ray, (R, N).
    pub t: Vec<Vec<f64>>,
}

fn finding(name: &'static str, says: String) -> Finding {
    Finding { name, honest: false, says }
}

/// A choice that right programs make.
fn choice(name: &'static str, says: String) -> Finding {
    Finding { name, honest: true, says }
}

/// ln(2 n / false alarm), for n tests at once.
fn confidence(n: usize) -> f64 {
    crate::math::ln(2.0 * n as f64 / FALSE_ALARM)
}

/// Bernstein: how far a count of n draws with probability p may be from n p, for any of `bins` bins.
fn count_slack(n: usize, p: f64, bins: usize) -> f64 {
    let l = confidence(bins);
    (2.0 * n as f64 * p * (1.0 - p) * l).sqrt() + 2.0 * l / 3.0
}

/// All tests: two calls with training on, two with it off.
///
/// # Shapes
/// `images` (I, H, W, 3). At least 4,096 rays a call, so that each listed mistake is missed with a probability below 1e-6.
pub(crate) fn findings(
    images: ArrayView4<f64>,
    training: &[Call; 2],
    rest: &[Call; 2],
    [near, far]: [f64; 2],
    c: &Conventions,
) -> Vec<Finding> {
    let mut found = rays(images, training, rest, c);
    found.extend(jitter(training, [near, far], c));
    found.extend(at_rest(rest, [near, far], c));
    found
}

/// Image ids, pixels and colors: support, uniformity, and that the second call draws anew.
pub(crate) fn rays(
    images: ArrayView4<f64>,
    calls: &[Call; 2],
    rest: &[Call; 2],
    c: &Conventions,
) -> Vec<Finding> {
    let (count, height, width, _) = images.dim();
    let shift = if c.pixel_center == PixelCenter::Half { 0.5 } else { 0.0 };
    let both = || calls.iter().flat_map(|call| call.image_ids.iter().zip(&call.uv).zip(&call.rgbs));
    let mut found = vec![];
    let inside = |x: f64, n: usize| x == libm::floor(x) && x >= 0.0 && x < n as f64;
    for ((&id, uv), _) in both() {
        if !inside(id, count) || !inside(uv[0] - shift, width) || !inside(uv[1] - shift, height) {
            let says = format!(
                "image {id}, uv ({}, {}) is no pixel of {count} images of {width} x {height}",
                uv[0], uv[1]
            );
            return vec![finding("outside_the_images", says)];
        }
    }
    let ids: Vec<usize> = both().map(|((&id, _), _)| id as usize).collect();
    let uneven = |bins: usize, values: &[usize]| {
        let mut counts = vec![0; bins];
        values.iter().for_each(|&v| counts[v] += 1);
        let (n, p) = (values.len(), 1.0 / bins as f64);
        counts.iter().any(|&k| (f64::from(k) - n as f64 * p).abs() > count_slack(n, p, bins))
    };
    let last = ids.iter().copied().max().unwrap_or(0);
    let first_alone = calls.iter().chain(rest).all(|call| call.image_ids.iter().all(|&id| id == 0.0));
    if let Some(per_call) = dealt(calls).filter(|_| !first_alone) {
        // Two calls don't show how these images were drawn.
        found.push(choice("rays_per_image", format!("a call's rays are dealt to {per_call} drawn image(s)")));
    } else if uneven(count, &ids) {
        let name = if last + 1 < count { "first_images_only" } else { "images_not_uniform" };
        found.push(finding(name, format!("the last of {count} images that is drawn is number {last}")));
    }
    let columns: Vec<usize> = both().map(|((_, uv), _)| uv[0] as usize).collect();
    let rows: Vec<usize> = both().map(|((_, uv), _)| uv[1] as usize).collect();
    if uneven(width, &columns) || uneven(height, &rows) {
        found.push(finding("pixels_not_uniform", "some rows or columns are drawn too often".into()));
    }
    if calls[0].uv == calls[1].uv && calls[0].image_ids == calls[1].image_ids {
        found.push(finding("rays_frozen", "both calls drew the same pixels".into()));
    }
    let expected =
        |id: f64, uv: &[f64; 2], k: usize| images[[id as usize, uv[1] as usize, uv[0] as usize, k]];
    let agrees = |scale: f64| {
        both().all(|((&id, uv), rgb)| {
            (0..3).all(|k| (rgb[k] - scale * expected(id, uv, k)).abs() <= scale * 1e-2)
        })
    };
    if !agrees(1.0) {
        let name = if agrees(1.0 / 255.0) { "divided_twice_by_255" } else { "wrong_colors" };
        found.push(finding(name, "the colors are not those of the pixels".into()));
    }
    found
}

/// The number of drawn images among which a call divides its rays, in turn or in blocks (as `PixelDraws::PerImage` does, and bmild/nerf
/// with one image a step); `None` where each ray draws its own.
fn dealt(calls: &[Call; 2]) -> Option<usize> {
    let n = calls[0].image_ids.len();
    (1..=MOST_IMAGES.min(n / 2)).find(|&images| {
        let by_turns = |ids: &[f64]| (images..n).all(|r| ids[r] == ids[r - images]);
        let in_blocks = |ids: &[f64]| (1..n).all(|r| ids[r] == ids[r - 1] || r * images % n < images);
        calls.iter().all(|call| by_turns(&call.image_ids) || in_blocks(&call.image_ids))
    })
}

/// u of every sample, from where t lies between its lowest and highest position.
fn numbers(call: &Call, [near, far]: [f64; 2], c: &Conventions) -> Vec<Vec<f64>> {
    let n = call.t.first().map_or(0, Vec::len);
    let low = sample_along_ray(near, far, &vec![0.0; n], c.grid);
    let high = sample_along_ray(near, far, &vec![1.0; n], c.grid);
    call.t.iter().map(|t| (0..n).map(|i| (t[i] - low[i]) / (high[i] - low[i])).collect()).collect()
}

/// The jitter of two training calls: independent from ray to ray, sample to sample and call to call, uniform over the interval.
pub(crate) fn jitter(calls: &[Call; 2], [near, far]: [f64; 2], c: &Conventions) -> Vec<Finding> {
    let u = numbers(&calls[0], [near, far], c);
    let (Some(first), n) = (u.first(), u.first().map_or(0, Vec::len)) else { return vec![] };
    if n == 0 {
        return vec![];
    }
    let (mut found, width) = (vec![], (far - near) / n as f64);
    if calls[0].t == calls[1].t && u.iter().flatten().all(|x| (x - first[0]).abs() < ROUNDING) {
        return vec![finding(
            "never_jittered",
            format!("u = {:.3} for every ray, sample and call", first[0]),
        )];
    }
    if calls[0].t == calls[1].t {
        found.push(finding("jitter_frozen", "both calls drew the same positions".into()));
    }
    if calls[0].t.iter().all(|t| *t == calls[0].t[0]) {
        found.push(finding("one_jitter_for_all_rays", "the variance across rays is 0".into()));
        // A single independent ray: too little to say anything about the distribution.
        found.extend(law(first.clone(), width));
        return found;
    }
    let means: Vec<f64> = u.iter().map(|u| u.iter().sum::<f64>() / n as f64).collect();
    let mean = means.iter().sum::<f64>() / means.len() as f64;
    let variance = u.iter().flatten().map(|x| (x - mean) * (x - mean)).sum::<f64>() / (u.len() * n) as f64;
    // Correlations of neighbors, scaled so that one common number gives 1; each product is at most 3 in size.
    let pairs = |products: Vec<f64>| {
        let slack = 3.0 * (2.0 * confidence(1) / products.len() as f64).sqrt();
        products.iter().sum::<f64>() / products.len() as f64 / variance > slack
    };
    let product = |a: f64, b: f64| (a - mean) * (b - mean);
    let across_samples = n > 1 && pairs(u.iter().map(|u| product(u[0], u[1])).collect());
    let across_rays = pairs(u.chunks_exact(2).map(|u| product(u[0][0], u[1][0])).collect());
    if across_samples {
        found.push(choice("one_jitter_per_ray", "a ray's samples are shifted together, as in NeuS".into()));
    }
    if across_rays {
        found.push(finding("rays_jittered_together", "neighboring rays move together".into()));
    }
    // The distribution can only be tested on independent draws.
    if !across_rays {
        let independent = if across_samples { 1 } else { n };
        found.extend(law(u.iter().flat_map(|u| &u[..independent]).copied().collect(), width));
    }
    found
}

/// Whether independent draws u are uniform on [0, 1); if they aren't, what they look like.
fn law(mut sorted: Vec<f64>, width: f64) -> Option<Finding> {
    sorted.sort_by(f64::total_cmp);
    let total = sorted.len() as f64;
    let distance = |shift: f64, scale: f64| {
        let cdf = |x: f64| ((x - shift) / scale).clamp(0.0, 1.0);
        let gap = |(k, &x): (usize, &f64)| {
            (cdf(x) - k as f64 / total).abs().max((cdf(x) - (k + 1) as f64 / total).abs())
        };
        sorted.iter().enumerate().map(gap).fold(0.0, f64::max)
    };
    let slack = (confidence(1) / (2.0 * total)).sqrt() + ROUNDING;
    let (low, high) = (sorted[0], sorted[sorted.len() - 1]);
    let inside = low >= -ROUNDING && high <= 1.0 + ROUNDING;
    if inside && distance(0.0, 1.0) <= slack {
        return None;
    }
    for (name, fixed) in [("jitter_width_0.02", 0.02), ("jitter_width_0.1", 0.1), ("jitter_width_1", 1.0)] {
        if distance(0.0, fixed / width) <= slack + ROUNDING / (fixed / width) {
            return Some(finding(name, format!("jitter over {fixed} instead of {width:.4}")));
        }
    }
    if distance(-0.5, 1.0) <= slack {
        return Some(finding("jitter_centered_on_edges", "u is uniform on [-0.5, 0.5)".into()));
    }
    let mean = sorted.iter().sum::<f64>() / total;
    let moment = |k: i32| sorted.iter().map(|x| (x - mean).powi(k)).sum::<f64>() / total;
    let kurtosis = moment(4) / (moment(2) * moment(2));
    // 1.8 for anything uniform, 3 for a Gaussian.
    let name = if kurtosis > 2.4 { "jitter_gaussian" } else { "jitter_not_uniform" };
    Some(finding(name, format!("u from {low:.3} to {high:.3}, mean {mean:.3}, kurtosis {kurtosis:.2}")))
}

/// Two calls with training off: the same positions for every ray in both, where the convention has them.
pub(crate) fn at_rest(calls: &[Call; 2], [near, far]: [f64; 2], c: &Conventions) -> Vec<Finding> {
    let Some(first) = calls[0].t.first() else { return vec![] };
    if calls.iter().flat_map(|call| &call.t).any(|t| t != first) {
        return vec![finding("jitter_at_evaluation", "two renders of the same view differ".into())];
    }
    let rest = sample_along_ray(near, far, &vec![rest_u(c.rest); first.len()], c.grid);
    let width = (far - near) / first.len() as f64;
    let off = first.iter().zip(&rest).any(|(t, rest)| (t - rest).abs() > ROUNDING * width);
    let says = || format!("t starts at {} instead of {}", first[0], rest[0]);
    if off { vec![finding("not_at_rest", says())] } else { vec![] }
}
