//! Traces, wrong on purpose: the components' mistakes, and those made by the caller, between two components.

use super::chain::{chain, plainly, without_backdrop};
use crate::contract::arrays::Arrays;
use crate::contract::component::{Component, Mistake};
use crate::convention::Conventions;
use crate::ray::mistakes::IMAGE_RAYS;
use crate::sample::mistakes::{SAMPLE_ALONG_RAYS, STEP_SIZES};
use crate::volume_rendering::mistakes::{COMPOSITE_BACKGROUND, VOLUME_RENDER};

/// Mistakes of the caller.
const AT_THE_CALL: &[Mistake] = &[
    Mistake::new(
        "jitter_ignored",
        "u is ignored: the samples of training rest in the middle of their intervals",
        "stripes, and detail that the grid can't see",
        "draw u anew for every ray and every sample in training",
        "3 public implementations",
        3,
    ),
    Mistake::new(
        BEFORE,
        "C + T_N b, with T_N the transmittance in front of the last sample instead of behind it",
        "the background shines through whatever the last sample holds",
        "C + (1 - A) b, or the transmittance behind the last sample",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        AFTER,
        "C + T_{N+1} (1 - alpha_N) b: the last sample shades the background twice",
        "the background too dark behind a last sample of any density",
        "C + (1 - A) b, or the transmittance behind the last sample",
        "1 public implementation",
        1,
    ),
];

/// The background's transmittance one sample off.
const BEFORE: &str = "background_before_last_sample";
const AFTER: &str = "background_shaded_twice";

/// The rows of a trace, in order.
const ROWS: [&[Mistake]; 6] =
    [AT_THE_CALL, IMAGE_RAYS, SAMPLE_ALONG_RAYS, STEP_SIZES, VOLUME_RENDER, COMPOSITE_BACKGROUND];

/// Mistakes that no array of a trace shows (it has no points and no transmittance, its samples have the picture's shape, and its lens is in
/// the middle), and one that `jitter_ignored` covers already.
const ELSEWHERE: &[&str] = &[
    "flattened_in_wrong_order",
    "points_without_origin",
    "points_from_near",
    "center_of_picture",
    "never_jittered",
    "unit_directions",
    "picture_transposed",
    "transmittance_before_last",
    "last_factor_once_more",
    "density_capped",
    "origin_times_t",
    "alphas_capped",
    "faint_samples_skipped",
    "taken_off_the_sum",
    "near_added_twice",
    "colors_given_up_early",
    "given_up_together",
    "given_up_without_background",
    "optical_depth_held",
    "division_by_density_guarded",
    "last_step_repeated",
    "steps_moved_on",
    "faint_weights_have_no_color",
    "thin_samples_skipped",
    "made_opaque_early",
    "near_added_for_points_alone",
    "t_without_jitter",
    "lower_halves_alone",
    "jittered_far_and_sorted",
    "even_then_in_disparity",
    "norm_down_the_columns",
    "rows_as_far_as_columns",
    "angle_in_whole_degrees",
    "focal_rounded",
    "colors_with_gamma",
    "source_without_density",
    "cloud_of_a_shader",
    "light_at_the_middle",
    "steps_averaged",
    "color_by_opacity",
    "weights_are_alphas",
    "colors_averaged",
];

/// Mistakes of the caller, and those of every component: the first component that has a name owns it.
pub(crate) const RENDER_TRACE: &[Mistake] = &gathered::<{ count() }>();

/// Whether mistake n of row r belongs to the trace.
const fn belongs(r: usize, n: usize) -> bool {
    let name = ROWS[r][n].name;
    !ROWS[r][n].gradient && !known(ROWS, r, name) && !listed(ELSEWHERE, name)
}

const fn known(rows: [&[Mistake]; 6], before: usize, name: &str) -> bool {
    let mut r = 0;
    while r < before {
        let mut n = 0;
        while n < rows[r].len() {
            if same(rows[r][n].name, name) {
                return true;
            }
            n += 1;
        }
        r += 1;
    }
    false
}

const fn listed(names: &[&str], name: &str) -> bool {
    let mut n = 0;
    while n < names.len() {
        if same(names[n], name) {
            return true;
        }
        n += 1;
    }
    false
}

/// a == b, as a `const fn`.
const fn same(a: &str, b: &str) -> bool {
    let (a, b, mut i) = (a.as_bytes(), b.as_bytes(), 0);
    while i < a.len() && i < b.len() && a[i] == b[i] {
        i += 1;
    }
    i == a.len() && i == b.len()
}

const fn count() -> usize {
    let (mut r, mut total) = (0, 0);
    while r < ROWS.len() {
        let mut n = 0;
        while n < ROWS[r].len() {
            total += belongs(r, n) as usize;
            n += 1;
        }
        r += 1;
    }
    total
}

const fn gathered<const N: usize>() -> [Mistake; N] {
    let (mut out, mut r, mut total) = ([AT_THE_CALL[0]; N], 0, 0);
    while r < ROWS.len() {
        let mut n = 0;
        while n < ROWS[r].len() {
            if belongs(r, n) {
                out[total] = ROWS[r][n];
                total += 1;
            }
            n += 1;
        }
        r += 1;
    }
    out
}

/// The trace with mistakes of the caller or of any of its components.
pub(crate) fn render_trace(a: &Arrays, c: &Conventions, wrong: &[&str]) -> Arrays {
    let (mut a, c) = (a.clone(), &without_backdrop(c));
    if wrong.contains(&"jitter_ignored") {
        a.get_mut("u").expect("checked").fill(0.5);
    }
    // Step lengths are computed once: the mistakes that `step_sizes` shares with `volume_render` aren't applied again there.
    let of_steps = |name: &&&str| STEP_SIZES.iter().any(|m| m.name == **name);
    let later: Vec<&str> = wrong.iter().filter(|name| !of_steps(name)).copied().collect();
    let run = |component: &Component, arrays: &Arrays| match component.name {
        "volume_render" => behind((component.forward.wrong)(arrays, c, &later), wrong),
        "composite_background" => (component.forward.wrong)(arrays, c, &later),
        _ => (component.forward.wrong)(arrays, c, wrong),
    };
    chain(&a, c, run, plainly)
}

/// The opacity passed to the background, where its transmittance is one sample off.
fn behind(mut rendered: Arrays, wrong: &[&str]) -> Arrays {
    if !wrong.contains(&BEFORE) && !wrong.contains(&AFTER) {
        return rendered;
    }
    let weights = rendered["weights"].clone();
    let last = weights.shape()[1] - 1;
    let opacity = rendered.get_mut("opacity").expect("an output");
    for (r, opacity) in opacity.iter_mut().enumerate() {
        let rest = 1.0 - *opacity;
        // T_N = T_{N+1} + w_N, and 1 - alpha_N is their quotient.
        let front = rest + weights[[r, last]];
        let off = if wrong.contains(&BEFORE) {
            front
        } else if front == 0.0 {
            0.0
        } else {
            rest * rest / front
        };
        *opacity = 1.0 - off;
    }
    rendered
}
