//! Loss scales, wrong on purpose. Without a mistake every function equals the oracle.

use super::arrays::{forward, found, gradients, loss_scale};
use super::{LossScale, unscaled, updated};
use crate::contract::arrays::{Arrays, number, values};
use crate::contract::component::Mistake;
use crate::convention::Conventions;

/// Mistakes of updates.
pub(crate) const LOSS_SCALE_UPDATE: &[Mistake] = &[
    Mistake::new(
        "tracker_kept_at_overflow",
        "an overflow shrinks the scale and leaves the tracker",
        "the scale grows again too soon, and overflows: steps are skipped for nothing",
        "0 after an overflow",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "tracker_kept_at_growth",
        "the tracker counts on after the scale has grown",
        "from then on it grows with every step, or never again: until it overflows",
        "0 after a growth",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "one_step_late",
        "compared before it is counted, or by >: growth_interval + 1 steps",
        "hardly any; the scale differs from that of other codes",
        "count first, then compare by >= or ==",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "overflow_counted",
        "a step that was skipped counts as well: the tracker is 1 after an overflow",
        "hardly any; the scale grows one step early",
        "0 after an overflow",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "meaning_of_bit_exchanged",
        "found_inf taken for all_finite",
        "the scale grows while gradients overflow, and shrinks to nothing while they don't",
        "1: an overflow; optax and jmp have it the other way around",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "divided_by_backoff",
        "scale / backoff_factor after an overflow",
        "the scale grows with every overflow: no step is taken any more",
        "times backoff_factor, which is below 1",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "updated_twice",
        "update called twice a step",
        "an overflow shrinks the scale by its square, and intervals are half as long",
        "once a step, after all optimizers",
        "neosr-project/neosr#9: double scaler.update()",
        1,
    ),
    Mistake::new(
        "overflow_ignored",
        "the bit isn't looked at",
        "the scale grows until every gradient overflows",
        "shrink where found_inf is 1",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "grown_with_every_step",
        "growth_interval isn't looked at",
        "the scale overflows every few steps, each of which is lost",
        "count the steps without an overflow",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "interval_of_its_own",
        "2000 is written in, whatever growth_interval is",
        "the scale grows sooner or later than was asked for",
        "the growth_interval that is handed over",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "scale_kept_at_overflow",
        "an overflow resets the tracker and leaves the scale",
        "every step overflows as the last one did, and is skipped: training stands still",
        "times backoff_factor",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "grown_at_overflow",
        "scale growth_factor with every overflow",
        "the scale grows where it should shrink",
        "times backoff_factor",
        "never; cheap to keep",
        0,
    ),
];

/// A scale and a tracker with a mistake in them.
fn wrong_update(s: &LossScale, found: bool, c: &Conventions, wrong: &[&str]) -> (f64, u64) {
    let has = |name: &str| wrong.contains(&name);
    let interval = if has("interval_of_its_own") { 2000 } else { s.growth_interval };
    let s = &LossScale { growth_interval: interval, ..*s };
    let right = |s: &LossScale, found| updated(s, found, c.loss_scale_floor, c.loss_scale_ceiling);
    let (scale, tracker) = right(s, found);
    let counted = s.tracker + 1;
    match () {
        () if has("tracker_kept_at_overflow") && found => (scale, s.tracker),
        () if has("tracker_kept_at_growth") && !found => (scale, counted),
        () if has("one_step_late") && !found && counted == s.growth_interval => (s.scale, counted),
        () if has("overflow_counted") && found => (scale, 1),
        () if has("meaning_of_bit_exchanged") => right(s, !found),
        () if has("divided_by_backoff") && found => (s.scale / s.backoff_factor, tracker),
        () if has("scale_kept_at_overflow") && found => (s.scale, tracker),
        () if has("grown_at_overflow") && found => (s.scale * s.growth_factor, tracker),
        () if has("updated_twice") => right(&LossScale { scale, tracker, ..*s }, found),
        () if has("overflow_ignored") => right(s, false),
        () if has("grown_with_every_step") && !found => right(&LossScale { growth_interval: 1, ..*s }, found),
        () => (scale, tracker),
    }
}

/// An update.
pub(crate) fn loss_scale_update(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let (scale, tracker) = wrong_update(&loss_scale(a), found(a), c, wrong);
    forward(scale, tracker as f64)
}

/// Mistakes of gradients.
pub(crate) const UNSCALE_GRADIENTS: &[Mistake] = &[
    Mistake::new(
        "multiplied_by_scale",
        "g scale: the loss' own line once more",
        "gradients are scale^2 times too large; Adam hardly shows it, weight decay and clips are lost",
        "g / scale",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "unscaled_twice",
        "g / scale^2: unscale_ by hand, and again in the step",
        "gradients vanish below Adam's eps",
        "once a step: GradScaler.step unscales what unscale_ hasn't",
        "hand-written loops; GradScaler refuses a second unscale_",
        0,
    ),
    Mistake::new(
        "scale_left_in",
        "g: gradients clipped or logged before they are unscaled",
        "clips cut every step to nothing; rates and decays are off by the scale",
        "unscale first, then clip",
        "milesial/Pytorch-UNet#468; Lightning-AI/pytorch-lightning#9694; pytorch/examples#1196; harubaru/waifu-diffusion#64; \
         victorchall/EveryDream2trainer#175",
        5,
    ),
    Mistake::new(
        "divided_by_root_of_scale",
        "g / sqrt(scale), as of a squared loss whose residuals were scaled",
        "gradients are too large by the root of the scale",
        "the loss was scaled: g / scale",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "finite_in_the_place_of_found",
        "1 where all are finite",
        "steps are skipped where nothing is wrong, and taken where something is",
        "1: a gradient isn't finite; optax and jmp have it the other way around",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "unscaled_clipped",
        "clamped to [-1, 1] after the division",
        "large gradients lose their direction; clips are the caller's",
        "g / scale",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "nan_not_looked_for",
        "1 where any is infinite: isinf alone",
        "a step with NaN is taken, and every parameter is lost",
        "not isfinite",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "largest_alone",
        "1 where the largest is infinite, by a max that passes over NaN: neither -inf nor NaN",
        "steps with -inf or NaN are taken, and every parameter is lost",
        "not isfinite, of all of them",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "sum_looked_at",
        "1 where the sum of all, in f32, is infinite or NaN",
        "steps whose gradients are finite are skipped where their sum isn't",
        "not isfinite, of each of them",
        "mmcv's LossScaler and its copies; nvidia/apex's first one",
        2,
    ),
    Mistake::new(
        "never_found",
        "0, whatever the gradients are: they are divided, and nobody looks",
        "steps with infinities and NaN are taken, and every parameter is lost",
        "not isfinite, of all of them",
        "hand-written loops in half precision",
        1,
    ),
    Mistake::new(
        "half_precisions_limit",
        "found where a number is above 65504, whatever type the gradients have",
        "steps that are right are skipped, and the scale shrinks for nothing",
        "not isfinite",
        "never; cheap to keep",
        0,
    ),
];

/// Unscaled gradients.
pub(crate) fn unscale_gradients(a: &Arrays, _: &Conventions, wrong: &[&str]) -> Arrays {
    let (scaled, scale) = (values(a, "gradients"), number(a, "scale"));
    let has = |name: &str| wrong.contains(&name);
    let found = match () {
        () if has("finite_in_the_place_of_found") => scaled.iter().all(|g| g.is_finite()),
        () if has("sum_looked_at") => !scaled.iter().map(|&g| g as f32).sum::<f32>().is_finite(),
        () if has("never_found") => false,
        () if has("nan_not_looked_for") => scaled.iter().any(|g| g.is_infinite()),
        () if has("largest_alone") => scaled.contains(&f64::INFINITY),
        () if has("half_precisions_limit") => scaled.iter().any(|g| g.is_nan() || g.abs() > 65504.0),
        () => scaled.iter().any(|g| !g.is_finite()),
    };
    let by = |f: fn(f64, f64) -> f64| gradients(found, scaled.iter().map(|&g| f(g, scale)).collect());
    // What else is made of an infinity is open; where it isn't seen, nothing.
    let Some(right) = unscaled(&scaled, scale) else {
        return if found { gradients(found, vec![0.0; scaled.len()]) } else { by(|g, scale| g / scale) };
    };
    match wrong.first() {
        Some(&"multiplied_by_scale") => by(|g, scale| g * scale),
        Some(&"unscaled_clipped") => by(|g, scale| (g / scale).clamp(-1.0, 1.0)),
        Some(&"unscaled_twice") => by(|g, scale| g / scale / scale),
        Some(&"scale_left_in") => by(|g, _| g),
        Some(&"divided_by_root_of_scale") => by(|g, scale| g / scale.sqrt()),
        _ => gradients(found, right),
    }
}
