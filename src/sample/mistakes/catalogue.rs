//! What is wrong with samples, what it does, and where it was seen.

use super::places::OF_PLACES;
use crate::contract::component::{Mistake, joined};

const fn fixed(name: &'static str, cause: &'static str) -> Mistake {
    Mistake::new(
        name,
        cause,
        "too wide: samples leave their interval and t is unsorted; too narrow: the ray has gaps that no step ever sees",
        "spread u over the width of an interval, (far - near) / N",
        "3 public implementations",
        1,
    )
}

pub(super) const JITTER_WIDTH: Mistake =
    fixed("jitter_width", "t = near + i D + k u with a number k of one's own").with("k", 0.05, [1e-4, 10.0]);

pub(super) const JITTER_ABOUT_GRID: Mistake = Mistake::new(
    "jitter_about_grid",
    "t = grid + k (2 u - 1): a number k of one's own to either side of edges or of a linspace",
    "samples in front of near and behind far; too narrow, and bands appear between the depths that the network knows",
    "spread u over the width of an interval, (far - near) / N",
    "1 public implementation: uniform(-1e-4, 1e-4)",
    1,
)
.with("k", 1e-4, [1e-6, 10.0]);

/// Mistakes of positions and points.
pub(crate) const SAMPLE_ALONG_RAYS: &[Mistake] =
    &joined::<{ OF_JITTER.len() + OF_PLACES.len() }>(&[OF_JITTER, OF_PLACES]);

const OF_JITTER: &[Mistake] = &[
    Mistake::new(
        "one_jitter_for_all_rays",
        "noise of shape (N,), broadcast over the rays",
        "all rays of a step see the same slices of space; noisier training",
        "noise of shape (rays, N)",
        "8 of 38 CS180 projects, 3 others",
        11,
    ),
    Mistake::new(
        "never_jittered",
        "u isn't used: always the middle of the interval, or linspace(near, far, N)",
        "the network knows the scene at N depths and bands appear between them",
        "add the noise in training",
        "3 public implementations",
        3,
    ),
    Mistake::new(
        "left_edges_alone",
        "u isn't used: always the left edge of the interval",
        "the network knows the scene at N depths, half a step too near",
        "add the noise in training",
        "2 public implementations",
        2,
    ),
    Mistake::new(
        "unit_directions",
        "points = o + t d / |d|: the sampler makes directions unit",
        "t means another distance than near and far do, where directions aren't unit",
        "make directions unit where rays are made, or nowhere",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "jitter_centered_on_edges",
        "t = near + (i + u - 0.5) D: noise in [-0.5, 0.5) around left edges",
        "samples in front of near",
        "noise in [0, 1) from left edges, or in [-0.5, 0.5) around the middles",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "middles_not_halved",
        "t_i = e_i + e_{i+1} / 2 for the middle of an interval: the brackets of (e_i + e_{i+1}) / 2 are missing",
        "samples reach half as far again, behind the scene, and u isn't used",
        "0.5 * (e[:-1] + e[1:])",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "even_in_disparity",
        "t = 1 / ((1 - s) / near + s / far): even in 1/t",
        "most samples lie just behind near, and what is far is seen by a few",
        "near + s (far - near); lindisp is another law, for scenes without bounds",
        "a sampler with 'linearly in disparity' written in, as bmild/nerf has it where lindisp is set",
        1,
    ),
    Mistake::new(
        "even_in_square",
        "t = near + s^2 (far - near): even in the root of the distance",
        "most samples lie in the near half",
        "near + s (far - near)",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "even_in_logarithm",
        "t = near^(1 - s) far^s: even in log t",
        "most samples lie in the near half",
        "near + s (far - near)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "origin_times_t",
        "(o + d) t",
        "points that move away from the camera's line with its place",
        "o + t d",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "jitter_in_unit_widths",
        "u / N for u D: the jitter of a ray from 0 to 1",
        "samples that hardly move, or leave their bins",
        "u (far - near) / N",
        "a JAX trainer",
        1,
    ),
    Mistake::new(
        "grid_of_unit_interval",
        "i / N + u D: bins of [0, 1], and a jitter of [near, far]",
        "samples in front of near",
        "near + (i + u) D",
        "a student in PyTorch, with both ends",
        1,
    ),
    Mistake::new(
        "grid_times_jitter",
        "t = near + (far - near) (i / N) u: the jitter shrinks the way to a sample",
        "most samples lie near the camera, in no order",
        "near + (i + u) D",
        "a program in Rust",
        1,
    ),
    Mistake::new(
        "drawn_without_bins",
        "t = near + u (far - near)",
        "samples aren't in order, and gaps are left that no step sees",
        "one interval for each sample",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "drawn_and_sorted",
        "t = sort(near + u (far - near))",
        "gaps are left that no step sees",
        "one interval for each sample",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "from_far_to_near",
        "t = far - (i + u) D",
        "samples run backward: what is behind hides what is in front",
        "near + (i + u) D",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "points_from_near",
        "points = o + (t - near) d",
        "everything is too near by near",
        "o + t d",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "one_bin_early",
        "t = near + (i - 1 + u) D: bins are counted from 1 where they were numbered from 0",
        "the first sample lies in front of near, and nothing in the last bin is seen",
        "near + (i + u) D, i from 0",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "unit_interval",
        "t = (i + u) / N: near and far are never applied",
        "samples in front of the scene, or in a small part of it",
        "near + t (far - near)",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "near_taken_for_zero",
        "t = (i + u) far / N: near is never read",
        "samples between the camera and near, and steps that are too wide",
        "near + (i + u) (far - near) / N",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "ends_held",
        "t = near + (i + u) (far - near) / (N - 1) between the ends, which aren't moved: t[1:-1] += u * gap",
        "near and far are seen at one depth alone, and samples crowd behind near's gap",
        "spread every sample over an interval of its own",
        "1 public implementation",
        1,
    ),
    fixed("jitter_width_0.02", "t = near + i D + 0.02 u"),
    fixed("jitter_width_0.1", "t = near + i D + 0.1 u"),
    fixed("jitter_width_1", "t = near + i D + u: noise that isn't scaled"),
    JITTER_WIDTH,
    Mistake::new(
        "flattened_in_wrong_order",
        "points were made as (N, R, 3) and reshaped to (R, N, 3)",
        "every sample is handed another ray's point; a permutation matches",
        "transpose before reshaping",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "points_without_origin",
        "points = t d",
        "all cameras stand at the origin",
        "o + t d",
        "never; cheap to keep",
        0,
    ),
    JITTER_ABOUT_GRID,
    Mistake::new(
        "one_jitter_for_all_samples",
        "u of a ray's first sample moves all of its samples",
        "samples keep their distances: thin surfaces are seen by all rays or none",
        "draw u anew for every sample",
        "2 public implementations",
        2,
    ),
];

// Wrong step lengths show where they are made and where they are used: volume rendering lists the same eight.
pub(crate) const DELTA_MISSING: Mistake = Mistake::new(
    "delta_missing",
    "delta = 1, so that alpha = 1 - exp(-sigma)",
    "density is learned in the wrong unit and changes with the number of samples",
    "the length of the step, in the units of t",
    "5 public implementations",
    5,
);
pub(crate) const DELTA_UNIT_INTERVAL: Mistake = Mistake::new(
    "delta_unit_interval",
    "delta = 1 / N, as if near and far were 0 and 1",
    "density off by far - near; one passes the course's own test",
    "(far - near) / N",
    "3 public implementations",
    3,
);
pub(crate) const DELTA_OVER_N_MINUS_1: Mistake = Mistake::new(
    "delta_over_n_minus_1",
    "delta = (far - near) / (N - 1) on a grid of N intervals",
    "density off by N / (N - 1)",
    "divide by N, or use the grid that includes both ends",
    "3 public implementations",
    3,
);
pub(crate) const BACKWARD_DELTA: Mistake = Mistake::new(
    "backward_delta",
    "delta_i = t_i - t_{i-1}, delta_0 = 0",
    "the first sample is invisible and every density belongs to the wrong step",
    "delta_i = t_{i+1} - t_i",
    "3 public implementations",
    3,
);
pub(crate) const DELTA_DIFFERENCED_TWICE: Mistake = Mistake::new(
    "delta_differenced_twice",
    "differences of the differences are taken as step lengths, last 1e10",
    "only the last sample is visible",
    "take the differences of t once",
    "1 public implementation",
    1,
);
pub(crate) const FIRST_GAP_FOR_ALL: Mistake = Mistake::new(
    "first_gap_for_all",
    "the first step of a ray, t_1 - t_0, for all of its samples",
    "varies from call to call when samples are jittered",
    "one step for each sample",
    "1 public implementation",
    1,
);
pub(crate) const FIRST_RAY_DELTAS: Mistake = Mistake::new(
    "first_ray_deltas",
    "the first ray's steps are used for every ray of the batch",
    "jittered rays get another ray's steps",
    "one row of steps for each ray",
    "kornia 0.8.2 RegularRenderer (0.139 for 0.289)",
    1,
);

pub(crate) const DELTA_OF_THE_WHOLE_RAY: Mistake = Mistake::new(
    "delta_of_the_whole_ray",
    "delta = far - near for every sample: the ray's length isn't divided by N",
    "densities are learned N times too small, and change with the number of samples",
    "(far - near) / N",
    "1 public implementation",
    1,
);

/// Mistakes of step lengths.
pub(crate) const STEP_SIZES: &[Mistake] = &[
    DELTA_MISSING,
    DELTA_UNIT_INTERVAL,
    DELTA_OVER_N_MINUS_1,
    BACKWARD_DELTA,
    DELTA_DIFFERENCED_TWICE,
    FIRST_GAP_FOR_ALL,
    FIRST_RAY_DELTAS,
    Mistake::new(
        "last_gap_too_early",
        "the last step is the gap before the last one: deltas[-2:-1], where deltas has N - 1 entries",
        "the last sample has another sample's step",
        "deltas[-1:]",
        "a surface renderer",
        1,
    ),
    Mistake::new(
        "last_delta_wraps",
        "t_0 - t_{N-1} for the last step: roll(t, -1) - t",
        "a last step below 0: its opacity too",
        "far - t_{N-1}, or a large number",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "central_differences",
        "(t_{i+1} - t_{i-1}) / 2, and 0 at both ends",
        "the first and the last sample are invisible",
        "t_{i+1} - t_i",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "mean_gap_for_all",
        "(t_{N-1} - t_0) / (N - 1) for every step",
        "nothing where samples are even; wrong weights elsewhere",
        "t_{i+1} - t_i",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "last_delta_zero",
        "delta_i = t_{i+1} - t_i, and 0 for the last: differences written into zeros",
        "the last sample is invisible: what lies in front of far is never learned",
        "any length for the last step, such as far - t or 1e10",
        "1 public implementation",
        1,
    ),
    DELTA_OF_THE_WHOLE_RAY,
    Mistake::new(
        "backward_delta_from_near",
        "delta_i = t_i - t_{i-1}, delta_0 = t_0 - near",
        "every density belongs to the wrong step",
        "delta_i = t_{i+1} - t_i",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "backward_delta_from_zero",
        "delta_i = t_i - t_{i-1}, delta_0 = t_0: as if samples began at the camera",
        "the first sample stands for everything in front of it, and every density belongs to the wrong step",
        "delta_i = t_{i+1} - t_i",
        "1 public implementation",
        1,
    ),
];
