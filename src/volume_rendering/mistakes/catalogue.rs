//! Descriptions of the mistakes in volume rendering.

use crate::contract::component::Mistake;

pub(super) const INCLUSIVE: Mistake = Mistake::new(
    "inclusive_transmittance",
    "w_i = T_{i+1} alpha_i: the sample shades itself (an inclusive cumprod or cumsum)",
    "surfaces too dark by a factor of 1 - alpha; spikes read (.25, .125, .0625)",
    "shift the cumulative product by one: T_0 = 1",
    "1 of 38 CS180 projects, 8 others",
    9,
);
pub(super) const ROLLED: Mistake = Mistake::new(
    "rolled_transmittance",
    "T = roll(cumprod(1 - alpha), 1), whose first entry is the last product instead of 1",
    "the first sample is attenuated by the whole ray; spikes read (.0625, .25, .125)",
    "set T_0 = 1 after the roll",
    "2 public implementations",
    2,
);
pub(super) const DELTA_MISSING_IN_ALPHA: Mistake = Mistake::new(
    "delta_missing_in_alpha",
    "alpha = 1 - exp(-sigma), while T has the steps in it",
    "brightness depends on the number of samples, and weights don't add up to 1 - T",
    "1 - exp(-sigma delta)",
    "1 public implementation in CUDA, mended later",
    1,
);
pub(super) const DELTA_MISSING_IN_LIGHT: Mistake = Mistake::new(
    "delta_missing_in_transmittance",
    "T = exp(-sum sigma), while alpha has the steps in it",
    "light ends within a few samples of any density",
    "exp(-sum sigma delta)",
    "never; the other one of two",
    0,
);
pub(super) const ROLLED_BACKWARD: Mistake = Mistake::new(
    "rolled_backward",
    "the cumulative product is moved on by one in the place of back: T_i = T_{i+2}, 1 in the first place, 0 in the last",
    "samples are shaded by themselves and by the next, and the last one is invisible",
    "1 in front of the product, and its last entry left out",
    "1 public implementation, whose framework has no roll",
    1,
);
pub(super) const FIRST_ZERO: Mistake = Mistake::new(
    "first_transmittance_zero",
    "T_0 = 0 (a zero in front of the cumulative product instead of a one)",
    "the first sample is invisible; spikes read (0, .25, .125)",
    "put 1 in front of the product (0 in front of the sum)",
    "1 public implementation",
    1,
);
pub(super) const INCLUSIVE_BEHIND_FIRST: Mistake = Mistake::new(
    "inclusive_behind_the_first",
    "T_0 = 1, and T_i = prod_{j<=i} (1 - alpha_j) from the second sample on: 1 is written over the inclusive product's first factor",
    "every sample but the first shades itself, and the first one shades twice",
    "shift the product by one: 1 in front, the last factor dropped",
    "2 public implementations",
    2,
);
pub(super) const NOTHING_HIDES: Mistake = Mistake::new(
    "nothing_hides",
    "T_i = 1: w_i = alpha_i",
    "what lies behind shines through, and weights sum to more than 1",
    "T_i, the product of 1 - alpha over the samples in front",
    "X-rays, which sum sigma delta c",
    1,
);
pub(super) const OWN_LIGHT: Mistake = Mistake::new(
    "own_light_alone",
    "T_i = 1 - alpha_i: the sample's own factor for the product of those in front",
    "nothing is hidden by what lies in front of it",
    "the product over the samples in front",
    "1 public implementation",
    1,
);
pub(super) const NEIGHBORS_LIGHT: Mistake = Mistake::new(
    "neighbors_light_alone",
    "T_i = 1 - alpha_{i-1}, T_0 = 1: the factor of the one sample in front for the product of all of them",
    "nothing further in front hides anything",
    "the product over all samples in front",
    "1 public implementation",
    1,
);
pub(super) const WHOLE_RAYS_LIGHT: Mistake = Mistake::new(
    "whole_rays_light",
    "T is one number a ray, the product of all factors (prod or sum for cumprod or cumsum)",
    "the order of the samples doesn't matter; what is opaque hides itself",
    "the cumulative product, moved by one",
    "1 public implementation",
    1,
);
pub(super) const LIGHT_FOR_ALPHA: Mistake = Mistake::new(
    "light_for_alpha",
    "w_i = T_i (1 - alpha_i): what passes a sample in the place of what it stops",
    "empty space glows, surfaces are dark",
    "w_i = T_i alpha_i, with alpha_i = 1 - exp(-x_i)",
    "2 public implementations",
    2,
);
pub(super) const UNIT_WEIGHTS: Mistake = Mistake::new(
    "weights_of_unit_length",
    "the weights are divided by their Euclidean norm, as a vector's normalize does",
    "they sum to more than 1; empty rays are NaN, or 0 where an eps is added",
    "leave them: what is missing to 1 is the background's",
    "2 public implementations",
    2,
)
.open_where_nan();
pub(super) const COLORS_MOVED: Mistake = Mistake::new(
    "colors_of_next_sample",
    "C = sum w_i c_{i+1}: colors and weights are cut to the same length at opposite ends",
    "surfaces have the color of what lies behind them",
    "the same slice of both",
    "1 public implementation",
    1,
);
pub(super) const CLAMPED: Mistake = Mistake::new(
    "clamped",
    "the color is clamped to [0, 1]",
    "no gradient where a color is too bright or too dark; high dynamic range is lost",
    "clamp where the picture is written",
    "1 CIS 580 student",
    1,
);
pub(super) const EPS_IN_PRODUCT: Mistake = Mistake::new(
    "eps_in_product",
    "T_i = prod_{j<i} (1 - alpha_j + eps) with an eps larger than libraries have it",
    "light is made out of nothing, more of it the more samples there are",
    "add nothing, or 1e-10",
    "1 public implementation",
    1,
)
.with("eps", 1e-5, [1e-7, 1e-1]);
pub(super) const WEIGHTS_NORMALIZED: Mistake = Mistake::new(
    "weights_normalized",
    "the weights are divided by their sum, and used like that",
    "empty rays are NaN, thin ones opaque",
    "leave them: what is missing to 1 is the background's",
    "1 public implementation; an option of another adds 1e-5 to the sum",
    1,
)
.with("eps", 0.0, [1e-16, 1e-1]);
pub(super) const OPACITY_AS_T: Mistake = Mistake::new(
    "opacity_as_transmittance",
    "T = 1 - prod(1 - alpha): opacity in the place of transmittance",
    "what lies behind shines through what lies in front; spikes read (.25, .375, .4375)",
    "use the product itself",
    "3 public implementations",
    3,
);
pub(super) const OPACITY_IN_FRONT_AS_T: Mistake = Mistake::new(
    "opacity_in_front_as_transmittance",
    "T_i = 1 - prod_{j<i}(1 - alpha_j): what was spent in front of a sample in the place of what is left",
    "the first sample is invisible, and what lies behind shines through what lies in front; spikes read (0, .25, .375)",
    "use the product itself",
    "3 copies of a teaching code",
    3,
);
pub(super) const MOVED_TWICE: Mistake = Mistake::new(
    "transmittance_moved_twice",
    "an exclusive product (a cumsum less the step) is moved by one once more",
    "no sample is shaded by the one in front of it",
    "move it once",
    "1 public implementation",
    1,
);
pub(super) const ROLLED_BUT_FIRST: Mistake = Mistake::new(
    "rolled_but_in_first_ray",
    "T is rolled, and T[0, 0] alone is set to 1: the first sample of the first ray",
    "the first ray is right, all others are attenuated by what lies behind",
    "T[:, 0] = 1",
    "1 public implementation",
    1,
);
pub(super) const FIRST_RAY_UNSHADED: Mistake = Mistake::new(
    "first_ray_unshaded",
    "T is rolled, and T[0], all of the first ray, is set to 1",
    "nothing shades the first ray, and all others are attenuated by what lies behind",
    "T[:, 0] = 1",
    "2 public implementations, one of them in JAX: .at[0].set(1)",
    2,
);
pub(super) const LEFT_EARLY: Mistake = Mistake::new(
    "transmittance_before_last",
    "what is left behind the ray is T in front of its last sample",
    "the background shines through the last sample",
    "the product of all factors",
    "1 public implementation",
    1,
);
pub(super) const LEFT_LATE: Mistake = Mistake::new(
    "last_factor_once_more",
    "what is left behind the ray is the product of all factors, times the last one again",
    "the background is too dark behind a last sample that isn't empty",
    "the product of all factors",
    "1 public implementation",
    1,
);
pub(super) const OWN_FACTOR: Mistake = Mistake::new(
    "divided_by_own_factor",
    "T_i = prod_{j<=i}(1 - alpha_j) / (1 - alpha_i)",
    "0 / 0 in opaque samples: NaN",
    "shift the product, which divides by nothing",
    "1 public implementation",
    1,
);
pub(super) const DIVIDED: Mistake = Mistake::new(
    "divided_by_opacity",
    "C / A: the weights are normalized",
    "half-transparent rays as bright as opaque ones; NaN on an empty ray",
    "leave the weights as they are",
    "2 public implementations",
    2,
)
.with("eps", 0.0, [1e-16, 1e-1]);
pub(super) const ALPHA_FORGOTTEN: Mistake = Mistake::new(
    "alpha_forgotten",
    "w_i = T_i",
    "empty space glows; weights sum to more than 1",
    "multiply by alpha_i",
    "1 public implementation",
    1,
);
pub(super) const OVER_RAYS: Mistake = Mistake::new(
    "transmittance_over_rays",
    "the cumulative sum or product runs over rays instead of samples (axis 0 for axis 1)",
    "a ray's color depends on its neighbors in the batch",
    "accumulate along the sample axis",
    "1 public implementation",
    1,
);
pub(super) const OVER_RAYS_INCLUSIVE: Mistake = Mistake::new(
    "own_light_over_rays",
    "the product of 1 - alpha runs over rays instead of samples, the ray itself included",
    "a ray's color depends on its neighbors in the batch, and each sample shades itself",
    "accumulate along the sample axis, in front of each sample",
    "1 public implementation",
    1,
);
pub(super) const DELTA_SCALED: Mistake = Mistake::new(
    "delta_scaled",
    "alpha = 1 - exp(-k sigma delta): densities or steps in another unit",
    "densities are learned k times too small; those of another program render too thin or too thick",
    "k = 1, or say the unit where densities are handed over",
    "never; cheap to keep",
    0,
)
.with("k", 2.0, [1e-3, 1e3]);
pub(super) const EPS_ON_ALPHA: Mistake = Mistake::new(
    "eps_on_alpha",
    "eps is added to alpha (and 1e-10 to T)",
    "empty rays aren't empty; below what f32 can see",
    "add nothing",
    "1 public implementation",
    1,
)
.with("eps", 1e-10, [1e-16, 1e-2]);
pub(super) const SCALED_EXPONENTIAL: Mistake = Mistake::new(
    "scaled_exponential",
    "alpha = 1 - k exp(-x) with k other than 1",
    "empty space has an opacity of 1 - k",
    "alpha = 1 - exp(-x)",
    "2 public implementations",
    2,
)
.with("k", 0.99, [1e-3, 5.0]);
pub(crate) const OWN_STEP: Mistake = Mistake::new(
    "step_of_its_own",
    "alpha = 1 - exp(-sigma step), with one step for all samples, whatever they are apart",
    "densities in a unit of one's own; uneven samples are weighed as if they were even",
    "the gaps between the samples",
    "a voxel grid's renderer with 0.01; 10 over the number of samples in another",
    2,
)
// A step of 1 is a mistake of its own: none at all.
.with("step", 0.01, [1e-5, 0.9]);
pub(super) const WEIGHTS_CUT: Mistake = Mistake::new(
    "weights_cut",
    "weights below a threshold are 0",
    "thin fog is invisible and doesn't learn; opacities are too small",
    "leave them, or say it where speed is needed",
    "never; cheap to keep",
    0,
)
.with("most", 1e-2, [1e-8, 0.5]);
pub(super) const GIVEN_UP: Mistake = Mistake::new(
    "given_up_early",
    "a ray ends where less light than a threshold is left, whatever the caller allows",
    "what lies behind haze is missing; opacities are too small, and samples behind have no gradient",
    "go on to the end, or take the threshold from the caller (early_stop)",
    "marching loops in shaders that end at an opacity of 0.95 or 0.99",
    4,
)
.with("left", 1e-2, [1e-12, 0.5]);
pub(super) const BACK_TO_FRONT: Mistake = Mistake::new(
    "back_to_front",
    "the formula from front to back over samples that are sorted from back to front",
    "what is behind hides what is in front of it",
    "T_i = prod_{j<i} (1 - alpha_j) with the nearest sample first; from behind it is C = alpha c + (1 - alpha) C",
    "splat renderers written from scratch: argsort(z, descending=True), then T *= 1 - alpha",
    2,
);

pub(super) const SHADE_FORGOTTEN: Mistake = Mistake::new(
    "shade_gradient_forgotten",
    "the gradient of alpha_i is T_i g.c_i alone: what the sample hides behind it is left out",
    "opacities only ever grow where colors are bright, and never make way for what is behind them",
    "T_i (g.c_i - what a unit of light is worth behind the sample)",
    "hand-written backward passes of splats",
    1,
)
.of_gradient();
pub(super) const DENSITY_CAPPED: Mistake = Mistake::new(
    "density_capped",
    "min(sigma, k)",
    "surfaces that should be opaque let light through where steps are short, and learn no more",
    "sigma as it is: exp(-sigma delta) is 0 where it is large, and needs no protection",
    "1 public implementation",
    1,
)
.with("k", 100.0, [1.0, 1e6]);
pub(super) const ALPHAS_CAPPED: Mistake = Mistake::new(
    "alphas_capped",
    "min(alpha, k)",
    "nothing is ever opaque",
    "alpha as it is: a cap belongs to gradients that divide by 1 - alpha",
    "never; cheap to keep",
    0,
)
.with("k", 0.99, [0.3, 0.9999]);
pub(super) const FAINT_SKIPPED: Mistake = Mistake::new(
    "faint_samples_skipped",
    "0 where alpha < k: a rasterizer's threshold for splats",
    "fog is invisible, however deep",
    "alpha as it is: many thin samples are a wall",
    "never; cheap to keep",
    0,
)
.with("k", 0.003_921_568_627_450_98, [1e-7, 0.2]);
pub(super) const HEAVIEST: Mistake = Mistake::new(
    "opacity_of_the_heaviest",
    "A = max w_i",
    "layers of fog don't add up: the background shines through",
    "A = sum w_i",
    "never; cheap to keep",
    0,
);
pub(super) const ALPHAS_SUMMED: Mistake = Mistake::new(
    "alphas_summed",
    "A = sum alpha_i",
    "an opacity above 1, and a background below 0",
    "A = sum w_i",
    "never; cheap to keep",
    0,
);
pub(super) const COLORS_GIVEN_UP: Mistake = Mistake::new(
    "colors_given_up_early",
    "samples count for the color where T_i is above a threshold alone; weights and opacity go on to the end",
    "what lies behind haze is missing in the color, but not in depth and opacity",
    "one end for all that is added up, the caller's (early_stop)",
    "a marching loop beside vectorized weights",
    1,
)
.with("left", 1e-2, [1e-12, 0.5]);
