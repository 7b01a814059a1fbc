//! What is wrong with a march along a ray, and what it does: where it ends, which steps it takes, and what it adds up.

use crate::contract::component::Mistake;

pub(super) const LAST_STEP: Mistake = Mistake::new(
    "last_step_of_its_own",
    "the last step is 1e10, whatever was handed over",
    "what is given with a step of its own counts as a wall",
    "steps as they are given; whoever has no last one appends it in front of this",
    "never; cheap to keep",
    0,
)
.with("step", 1e10, [1e-4, 1e12]);
pub(super) const LAST_REPEATED: Mistake = Mistake::new(
    "last_step_repeated",
    "the last step is the one before",
    "a last sample that is too thin or too thick",
    "steps as they are given",
    "never; cheap to keep",
    0,
);
pub(super) const STEPS_MOVED: Mistake = Mistake::new(
    "steps_moved_on",
    "the step in front of each sample for that behind it, the first one twice",
    "densities over lengths that aren't theirs",
    "delta_i = t_{i+1} - t_i",
    "never; cheap to keep",
    0,
);
pub(super) const STEPS_AVERAGED: Mistake = Mistake::new(
    "steps_averaged",
    "(delta_{i-1} + delta_i) / 2, half of the first",
    "densities over lengths that aren't theirs",
    "delta_i = t_{i+1} - t_i",
    "never; cheap to keep",
    0,
);
pub(super) const BEFORE_THE_SAMPLE: Mistake = Mistake::new(
    "given_up_before_the_sample",
    "the ray ends without the sample behind which less light than a threshold is left",
    "what lies behind haze is missing, and the sample that ends the ray",
    "take the sample, then end; or take the threshold from the caller (early_stop)",
    "3D Gaussian splatting's rasterizer, where it is meant so",
    1,
)
.with("left", 1e-4, [1e-7, 0.5]);
pub(super) const TOGETHER: Mistake = Mistake::new(
    "given_up_together",
    "all rays end where less light than a threshold is left in each of them",
    "what lies behind haze is missing where all of a batch is opaque: a picture depends on how its rays are grouped",
    "each ray by itself, or go on to the end",
    "2 splat renderers: if accumulated.min() > 0.99: break",
    2,
)
.with("left", 1e-2, [1e-7, 0.5]);
pub(super) const MADE_OPAQUE: Mistake = Mistake::new(
    "made_opaque_early",
    "where less light than a threshold is left, the color is divided by the opacity, and that is 1",
    "haze in front of a background is brighter than it should be",
    "go on to the end, or take the threshold from the caller (early_stop)",
    "instant-ngp's renderer, where it is meant so",
    1,
)
.with("left", 1e-2, [1e-7, 0.5]);
pub(super) const FAINT_UNCOLORED: Mistake = Mistake::new(
    "faint_weights_have_no_color",
    "colors of samples whose weight is above a threshold alone; weights and opacity have all",
    "fog is darker than its opacity",
    "all samples, or the same ones for all that is added up",
    "TensoRF's rayMarch_weight_thres, where it saves the color network",
    1,
)
.with("k", 1e-4, [1e-8, 0.1]);
pub(crate) const THIN_SKIPPED: Mistake = Mistake::new(
    "thin_samples_skipped",
    "density 0 where sigma <= k",
    "fog vanishes",
    "densities as they are",
    "4 marches in shaders: if (density > 0.01)",
    4,
)
.with("k", 1e-2, [1e-6, 10.0]);

/// A density, and 0 where it is too thin.
pub(crate) fn unless_thin(sigma: f64, most: f64) -> f64 {
    if sigma <= most { 0.0 } else { sigma }
}

pub(super) const WEIGHTS_ARE_ALPHAS: Mistake = Mistake::new(
    "weights_are_alphas",
    "alpha is handed on for the weights; colors and opacity are right",
    "depths and resampling see what is hidden",
    "w_i = T_i alpha_i",
    "never; cheap to keep",
    0,
);
pub(super) const MIDDLE_LIGHT: Mistake = Mistake::new(
    "light_at_the_middle",
    "T_i = exp(-(sum_{j<i} x_j + x_i / 2))",
    "surfaces are darker than they should be",
    "the light that reaches the sample: all in front of it",
    "never; cheap to keep",
    0,
);
pub(super) const CLOUD: Mistake = Mistake::new(
    "cloud_of_a_shader",
    "w_i = T_{i+1} sigma_i delta_i, with 1 - T_N for the opacity",
    "dense samples shine less than thin ones",
    "alpha_i T_i",
    "never; cheap to keep",
    0,
);
pub(super) const GAMMA: Mistake = Mistake::new(
    "colors_with_gamma",
    "C^(1 / 2.2)",
    "pictures that are too bright: photographs have it already",
    "C as it is",
    "never; cheap to keep",
    0,
);
pub(super) const BY_OPACITY: Mistake = Mistake::new(
    "color_by_opacity",
    "C times its opacity",
    "fog is darker than it should be",
    "C has its weights already",
    "never; cheap to keep",
    0,
);
pub(super) const ALPHAS_OFF_ONE: Mistake = Mistake::new(
    "alphas_subtracted",
    "T_i = 1 - sum alpha_j over those in front, ending at 0",
    "everything is opaque after a few dense samples",
    "a product of 1 - alpha_j",
    "never; cheap to keep",
    0,
);
pub(super) const COLORS_AVERAGED: Mistake = Mistake::new(
    "colors_averaged",
    "(c_i + c_{i+1}) / 2, the last one by itself",
    "edges are blurred",
    "each sample's own color",
    "never; cheap to keep",
    0,
);
pub(super) const SOURCE: Mistake = Mistake::new(
    "source_without_density",
    "w_i = T_i alpha_i / sigma_i, 0 where sigma is 0: light that is emitted by length, not by matter",
    "thin fog shines as brightly as a wall",
    "w_i = T_i alpha_i",
    "never; cheap to keep",
    0,
);
pub(super) const BLENDED_TWICE: Mistake = Mistake::new(
    "opacity_blended_twice",
    "A = alpha^2 + (1 - alpha) A from back to front: the color's blend for opacity, too",
    "pictures that are seen through",
    "A = alpha + (1 - alpha) A: glBlendFuncSeparate(SRC_ALPHA, ONE_MINUS_SRC_ALPHA, ONE, ONE_MINUS_SRC_ALPHA)",
    "viewers that blend with SRC_ALPHA",
    1,
);
pub(super) const THIN_ALPHAS: Mistake = Mistake::new(
    "thin_alphas_skipped",
    "0 for alpha below k",
    "haze vanishes",
    "alphas as they are",
    "never; cheap to keep",
    0,
)
.with("k", 0.5, [1e-7, 0.9]);
pub(super) const ALPHAS_HELD: Mistake = Mistake::new(
    "alphas_held_inside",
    "alpha held between k and 1 - k",
    "empty space is never empty, and nothing is opaque",
    "alphas as they are",
    "never; cheap to keep",
    0,
)
.with("k", 1e-4, [1e-8, 0.1]);
pub(super) const ANY_ORDER: Mistake = Mistake::new(
    "blended_in_any_order",
    "C = (sum alpha c / sum alpha) (1 - prod (1 - alpha))",
    "what lies behind shines through what lies in front",
    "from front to back, or from back to front",
    "weighted blended order-independent transparency, where it is meant so",
    1,
);
pub(super) const WHITE_BEFORE_LAST: Mistake = Mistake::new(
    "white_before_last",
    "C + T_{N-1}: white, seen by the light in front of the last sample, not behind it",
    "what fills a ray up to its end shines",
    "C + T_N = C + 1 - A",
    "1 public implementation",
    1,
);
pub(super) const COLORS_OF_ALPHAS: Mistake = Mistake::new(
    "colors_of_alphas",
    "C = sum alpha_i c_i; weights are right",
    "what lies behind shines through what lies in front",
    "C = sum w_i c_i",
    "never; cheap to keep",
    0,
);
pub(super) const WEIGHTS_HELD: Mistake = Mistake::new(
    "weights_held_up",
    "max(w, k): no weight is below a number of one's own",
    "empty space shines a little, and opacities lie above 1 - T",
    "w = T alpha; an eps belongs where something is divided by it",
    "1 course assignment: clamp_min(1e-10)",
    1,
)
.with("k", 1e-10, [1e-12, 1e-2]);
pub(super) const DEPTH_HELD: Mistake = Mistake::new(
    "optical_depth_held",
    "min(sigma delta, k)",
    "nothing is ever quite opaque: what lies behind a wall shines through",
    "exp(-sigma delta) as it is: it underflows to 0 where it should",
    "1 public implementation, with 10",
    1,
)
.with("k", 10.0, [0.5, 100.0]);
pub(super) const GROWING_LIGHT: Mistake = Mistake::new(
    "light_grows",
    "T_i = exp(+sum_{j<i} sigma_j delta_j)",
    "what lies behind shines the brighter, up to infinity",
    "exp(-sum)",
    "1 public implementation",
    1,
);
pub(super) const WEIGHTS_MULTIPLIED: Mistake = Mistake::new(
    "weights_multiplied",
    "w_i = prod_{j<=i} alpha_j (1 - alpha_j): the product over alpha too",
    "nothing but the first sample is seen, and that at a quarter",
    "w_i = alpha_i prod_{j<i} (1 - alpha_j)",
    "1 public implementation: cumprod(T (1 - T))",
    1,
);
pub(super) const GIVEN_UP_IN_THE_DARK: Mistake = Mistake::new(
    "given_up_without_background",
    "0 for T where it is below a threshold: what lies behind isn't seen, nor is a background",
    "a dark seam where rays begin to end early",
    "T times the background, for each ray",
    "1 CUDA renderer",
    1,
)
.with("left", 1e-2, [1e-7, 0.5]);
pub(super) const LAST_ALPHAS_LIGHT: Mistake = Mistake::new(
    "light_behind_the_last_alone",
    "T_N = 1 - alpha of the last sample that counts",
    "the background shines through whatever lies in front of that",
    "T_N = prod (1 - alpha)",
    "1 splat renderer, whose T begins with 1 for each splat",
    1,
);
pub(super) const CAPPED_ELSEWHERE: Mistake = Mistake::new(
    "capped_elsewhere",
    "min(alpha, k)",
    "nothing is ever opaque",
    "alpha as it is, or capped as the splats are",
    "1 splat renderer, with 0.995",
    1,
)
.with("k", 0.995, [0.3, 0.9998]);
pub(super) const ALPHAS_SCALED: Mistake = Mistake::new(
    "alphas_scaled",
    "k (1 - exp(-sigma delta))",
    "nothing is ever opaque where k < 1; opacities above 1 where k > 1",
    "alpha = 1 - exp(-sigma delta): the step belongs in the exponent alone",
    "never; cheap to keep",
    0,
)
.with("k", 0.5, [1e-3, 8.0]);
pub(super) const DIVISION_GUARDED: Mistake = Mistake::new(
    "division_by_density_guarded",
    "s = max(sigma, k) for sigma in T = exp(-sum s delta) and in w = T sigma (1 - exp(-s delta)) / s",
    "empty space hides what is behind it, if it is deep enough",
    "T_i (1 - exp(-sigma_i delta_i)): nothing is divided by sigma",
    "a fog by slices of a frustum: s = max(sigma, 1e-6), (S - S exp(-s d)) / s, S = sigma c",
    1,
)
.with("k", 1e-6, [1e-9, 0.1]);
