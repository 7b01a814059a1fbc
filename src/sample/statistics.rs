//! Statistics of samplers: tests of a program's random rays and jitter, over two calls in training and two at rest.
//!
//! Every test is one-sided and holds for finite samples: Bernstein's inequality for counts and means (draws without replacement are
//! under-dispersed and pass; Hoeffding 1963, section 6) and Dvoretzky, Kiefer, Wolfowitz (with Massart's constant, 1990) for the
//! law of the jitter. Each has a false alarm of at most [`FALSE_ALARM`]; a run makes fewer than 20 of them. `repeats.rs` looks for draws that
//! come again.

use std::collections::BTreeMap;

use ndarray::ArrayView4;

use super::{rest_u, sample_along_ray};
use crate::contract::special::Finding;
use crate::convention::{Conventions, PixelCenter};

mod repeats;
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
    /// Target colors, (R), or none.
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

/// How far positions may be off by rounding alone, in f32 at the end of the ray: a few units in the last place.
fn rounding([near, far]: [f64; 2]) -> f64 {
    4.0 * crate::contract::arithmetic::Dtype::F32.ulp(near.abs().max(far.abs()))
}

/// Whether two calls have the same positions but for rounding.
fn alike(a: &[Vec<f64>], b: &[Vec<f64>], off: f64) -> bool {
    a.len() == b.len() && a.iter().flatten().zip(b.iter().flatten()).all(|(a, b)| (a - b).abs() <= off)
}

/// A number for each pixel of all images.
fn pixel(call: &Call, r: usize) -> [u64; 3] {
    [call.image_ids[r], call.uv[r][0], call.uv[r][1]].map(f64::to_bits)
}

/// All tests: two calls with training on, two with it off. Each is made when its findings are asked for, those first that cost least:
/// a search for conventions ends with the first that isn't honest.
///
/// # Shapes
/// `images` (I, H, W, 3). At least 4,096 rays a call, so that each listed mistake is missed with a probability below 1e-6.
pub(crate) fn findings(
    images: ArrayView4<f64>,
    training: [Call; 2],
    rest: [Call; 2],
    bounds: [f64; 2],
    c: Conventions,
) -> impl Iterator<Item = Finding> {
    (0..3).flat_map(move |test| match test {
        0 => at_rest(&rest, bounds, &c),
        1 => rays(images, &training, &rest, &c),
        _ => jitter(&training, bounds, &c),
    })
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
    let both = || calls.iter().flat_map(|call| call.image_ids.iter().zip(&call.uv));
    let mut found = vec![];
    let inside = |x: f64, n: usize| x == libm::floor(x) && x >= 0.0 && x < n as f64;
    let known = both().all(|(&id, _)| inside(id, count));
    if known && [0.0, 0.5].iter().any(|shift| rounded(calls, *shift, [width, height])) {
        let says = format!("columns 0 to {width}, rows 0 to {height}, the first and the last half as often");
        return vec![finding("rounded_to_the_nearest", says)];
    }
    for (&id, uv) in both() {
        if !inside(id, count) || !inside(uv[0] - shift, width) || !inside(uv[1] - shift, height) {
            let says = format!(
                "image {id}, uv ({}, {}) is no pixel of {count} images of {width} x {height}",
                uv[0], uv[1]
            );
            return vec![finding("outside_the_images", says)];
        }
    }
    let ids: Vec<usize> = both().map(|(&id, _)| id as usize).collect();
    let uneven = |bins: usize, values: &[usize]| {
        let mut counts = vec![0; bins];
        values.iter().for_each(|&v| counts[v] += 1);
        let (n, p) = (values.len(), 1.0 / bins as f64);
        counts.iter().any(|&k| (f64::from(k) - n as f64 * p).abs() > count_slack(n, p, bins))
    };
    let last = ids.iter().copied().max().unwrap_or(0);
    let all = || calls.iter().chain(rest).flat_map(|call| &call.image_ids);
    let (first_alone, one_alone) = (all().all(|&id| id == 0.0), all().all(|&id| id == calls[0].image_ids[0]));
    let dealt = dealt(calls);
    if one_alone && !first_alone {
        let says = format!("image {} of {count} in all four calls", calls[0].image_ids[0]);
        found.push(finding("one_image_for_ever", says));
    }
    let again = come_again(calls, [height, width]);
    if let Some(per_call) = dealt.filter(|_| !one_alone) {
        // Two calls don't show how these images were drawn.
        found.push(choice("rays_per_image", format!("a call's rays are dealt to {per_call} drawn image(s)")));
    } else if again.is_none() && (!one_alone || first_alone) && (uneven(count, &ids) || lopsided(count, &ids))
    {
        let name = if last + 1 < count { "first_images_only" } else { "images_not_uniform" };
        found.push(finding(name, format!("the last of {count} images that is drawn is number {last}")));
    }
    let columns: Vec<usize> = both().map(|(_, uv)| uv[0] as usize).collect();
    let rows: Vec<usize> = both().map(|(_, uv)| uv[1] as usize).collect();
    if again.is_none() && (uneven(width, &columns) || uneven(height, &rows)) {
        found.push(finding("pixels_not_uniform", "some rows or columns are drawn too often".into()));
    }
    found.extend(again);
    let expected =
        |id: f64, uv: &[f64; 2], k: usize| images[[id as usize, uv[1] as usize, uv[0] as usize, k]];
    let colored = || calls.iter().flat_map(|call| call.image_ids.iter().zip(&call.uv).zip(&call.rgbs));
    let agrees = |scale: f64| {
        colored().all(|((&id, uv), rgb)| {
            (0..3).all(|k| (rgb[k] - scale * expected(id, uv, k)).abs() <= scale * 1e-2)
        })
    };
    if !agrees(1.0) {
        let name = if agrees(1.0 / 255.0) { "divided_twice_by_255" } else { "wrong_colors" };
        found.push(finding(name, "the colors are not those of the pixels".into()));
    }
    found
}

/// Whether positions less `shift` are whole numbers from 0 to the picture's size, both ends half as often as the others.
fn rounded(calls: &[Call; 2], shift: f64, size: [usize; 2]) -> bool {
    (0..2).all(|axis| {
        let mut counts = vec![0.0; size[axis] + 1];
        let all: Vec<f64> = calls.iter().flat_map(|call| &call.uv).map(|uv| uv[axis] - shift).collect();
        for x in &all {
            match counts.get_mut(*x as usize) {
                Some(count) if x.fract() == 0.0 && *x >= 0.0 => *count += 1.0,
                _ => return false,
            }
        }
        let share = |k: usize| (if k % size[axis] == 0 { 0.5 } else { 1.0 }) / size[axis] as f64;
        let slack = |k: usize| count_slack(all.len(), share(k), counts.len());
        let as_often = |k: usize| (counts[k] - all.len() as f64 * share(k)).abs() <= slack(k);
        (0..counts.len()).all(as_often)
    })
}

/// Rays that were there before: all of them, or more than meet by chance in a picture of so many pixels.
fn come_again(calls: &[Call; 2], [height, width]: [usize; 2]) -> Option<Finding> {
    if calls[0].uv == calls[1].uv && calls[0].image_ids == calls[1].image_ids {
        return Some(finding("rays_frozen", "both calls drew the same pixels".into()));
    }
    let rays = calls.iter().flat_map(|call| call.image_ids.iter().zip(&call.uv));
    let place = |(id, uv): (&f64, &[f64; 2])| (id * height as f64 + uv[1]) * width as f64 + uv[0];
    let places = repeats::Sorted::new(&rays.map(place).collect::<Vec<f64>>());
    // Who takes as many pixels of each picture, in their order, meets the same picture at some distance: any of its pixels.
    let (lag, times) = repeats::distance(&places, &places, 0.0, 1.0 / (height * width) as f64)?;
    Some(finding("rays_repeat", format!("{times} pixels are those of {lag} rays before")))
}

/// Whether images are drawn too often from one end, or one is never drawn.
fn lopsided(count: usize, ids: &[usize]) -> bool {
    let mut counts = vec![0.0; count];
    ids.iter().for_each(|&id| counts[id] += 1.0);
    let (n, mut below, mut gap) = (ids.len() as f64, 0.0, 0.0);
    for (k, times) in counts.iter().enumerate() {
        below += times / n;
        gap = f64::max(gap, (below - (k + 1) as f64 / count as f64).abs());
    }
    // Each is missed by all with a probability of (1 - 1 / count)^n.
    let missed = count as f64 * crate::math::exp(-n / count as f64) < FALSE_ALARM;
    gap > (confidence(1) / (2.0 * n)).sqrt() || missed && counts.contains(&0.0)
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
pub(crate) fn jitter(calls: &[Call; 2], bounds: [f64; 2], c: &Conventions) -> Vec<Finding> {
    let u = numbers(&calls[0], bounds, c);
    let (Some(first), n) = (u.first(), u.first().map_or(0, Vec::len)) else { return vec![] };
    if n == 0 {
        return vec![];
    }
    let (mut found, width, off) = (vec![], (bounds[1] - bounds[0]) / n as f64, rounding(bounds));
    let frozen = alike(&calls[0].t, &calls[1].t, off);
    if frozen && u.iter().flatten().all(|x| (x - first[0]).abs() < ROUNDING) {
        return vec![finding(
            "never_jittered",
            format!("u = {:.3} for every ray, sample and call", first[0]),
        )];
    }
    if frozen {
        found.push(finding("jitter_frozen", "both calls drew the same positions".into()));
    }
    if calls[0].t.iter().all(|t| alike(std::slice::from_ref(t), &calls[0].t[..1], off)) {
        found.push(finding("one_jitter_for_all_rays", "the variance across rays is 0".into()));
        // A single independent ray: too little to say anything about the distribution.
        found.extend(law(first.clone(), width));
        return found;
    }
    // What is frozen shows nothing more in the second call.
    let drawn = &calls[..if frozen { 1 } else { 2 }];
    let all: Vec<Vec<f64>> = drawn.iter().flat_map(|call| numbers(call, bounds, c)).collect();
    let (shift, dependent) = dependence(drawn, &all, 2.0 * off / narrowest(n, bounds, c));
    if shift {
        found.push(choice("one_jitter_per_ray", "a ray's samples are shifted together, as in NeuS".into()));
    }
    // The distribution can only be tested on independent draws.
    match dependent {
        Some(dependent) => found.push(dependent),
        None => {
            let independent = if shift { 1 } else { n };
            found.extend(law(u.iter().flat_map(|u| &u[..independent]).copied().collect(), width));
        }
    }
    found
}

/// The narrowest interval that a sample is drawn in.
fn narrowest(n: usize, [near, far]: [f64; 2], c: &Conventions) -> f64 {
    let low = sample_along_ray(near, far, &vec![0.0; n], c.grid);
    let high = sample_along_ray(near, far, &vec![1.0; n], c.grid);
    (0..n).map(|i| high[i] - low[i]).fold(f64::INFINITY, f64::min)
}

/// Whether a ray's samples share one number, which is a choice; and what else makes draws depend on each other. `off` is how far u may
/// be off by rounding.
fn dependence(calls: &[Call], u: &[Vec<f64>], off: f64) -> (bool, Option<Finding>) {
    let (n, total) = (u[0].len(), (u.len() * u[0].len()) as f64);
    let mean = u.iter().flatten().sum::<f64>() / total;
    let variance = u.iter().flatten().map(|x| (x - mean) * (x - mean)).sum::<f64>() / total;
    let rays = u.len();
    let column = |i: usize| u.iter().map(|u| u[i]).collect::<Vec<f64>>();
    // Lags along the samples and along the rays, and the two ends of a ray.
    let mut lags: Vec<usize> = (1..=64.min(rays / 2)).collect();
    lags.extend((7..).map(|k| 1 << k).take_while(|lag| 2 * lag <= rays));
    let tests = lags.len() + n + 1;
    let correlated = |values: &[f64], lag: usize| repeats::correlation(values, lag, [mean, variance], tests);
    let ends: Vec<f64> = u.iter().flat_map(|u| [u[0], u[n - 1]]).collect();
    let shift = n > 1 && correlated(&ends, 1).is_some_and(|r| r > 0.0);
    let firsts = column(0);
    let flat: Vec<f64> = if shift { firsts.clone() } else { u.iter().flatten().copied().collect() };
    let step = if shift { 1 } else { n };
    if correlated(&firsts, 1).is_some_and(|r| r > 0.0) {
        return (shift, Some(finding("rays_jittered_together", "neighboring rays move together".into())));
    }
    if let Some(says) = of_pixels(calls, &firsts, off) {
        return (shift, Some(finding("jitter_of_the_pixel", says)));
    }
    let place = |lag: usize| format!("{} rays and {} samples", lag / step, lag % step);
    let sorted = repeats::Sorted::new(&flat);
    if let Some((lag, times)) = repeats::distance(&sorted, &sorted, off, 2.0 * off) {
        let says = format!("{times} of {} numbers are those of {} before", flat.len(), place(lag));
        return (shift, Some(finding("jitter_repeats", says)));
    }
    if let Some((lag, times)) = repeats::distance(&sorted, &sorted.mirrored(), off, 2.0 * off) {
        let says = format!("{times} of {} numbers are 1 less those of {} before", flat.len(), place(lag));
        return (shift, Some(finding("jitter_antithetic", says)));
    }
    let along_rays = lags.iter().find_map(|&lag| Some((correlated(&firsts, lag)?, lag, "rays")));
    let inside = |lag: usize| -> Option<f64> {
        let pairs: Vec<f64> = u.iter().flat_map(|u| [u[0], u[lag]]).collect();
        correlated(&pairs, 1)
    };
    let along_samples = (1..n).filter(|_| !shift).find_map(|lag| Some((inside(lag)?, lag, "samples")));
    let says = |(r, lag, what): (f64, usize, &str)| {
        finding("jitter_correlated", format!("a correlation of {r:.2} with those of {lag} {what} before"))
    };
    (shift, along_rays.or(along_samples).map(says))
}

/// Whether a pixel that is drawn again gets the number that it had.
fn of_pixels(calls: &[Call], firsts: &[f64], off: f64) -> Option<String> {
    let mut last: BTreeMap<[u64; 3], f64> = BTreeMap::new();
    let (mut again, mut same) = (0, 0);
    let rays = calls.iter().flat_map(|call| (0..call.image_ids.len()).map(move |r| pixel(call, r)));
    for (pixel, &x) in rays.zip(firsts) {
        if let Some(before) = last.insert(pixel, x) {
            again += 1;
            same += usize::from((before - x).abs() <= off);
        }
    }
    let chance = again as f64 * 2.0 * off + count_slack(again, (2.0 * off).min(1.0), 1);
    // Other repetition meets a pixel in passing.
    (same as f64 > chance && 10 * same > 9 * again)
        .then(|| format!("{same} of {again} pixels that came again have the same jitter"))
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
    let off = rounding([near, far]);
    if calls
        .iter()
        .flat_map(|call| &call.t)
        .flat_map(|t| t.iter().zip(first))
        .any(|(t, x)| (t - x).abs() > off)
    {
        return vec![finding("jitter_at_evaluation", "two renders of the same view differ".into())];
    }
    let rest = sample_along_ray(near, far, &vec![rest_u(c.rest); first.len()], c.grid);
    let width = (far - near) / first.len() as f64;
    let off = first.iter().zip(&rest).any(|(t, rest)| (t - rest).abs() > ROUNDING * width);
    let says = || format!("t starts at {} instead of {}", first[0], rest[0]);
    if off { vec![finding("not_at_rest", says())] } else { vec![] }
}
