//! Descriptions of the mistakes in volume rendering.

use crate::contract::component::Mistake;
use crate::sample::mistakes::{
    BACKWARD_DELTA, DELTA_DIFFERENCED_TWICE, DELTA_MISSING, DELTA_OF_THE_WHOLE_RAY, DELTA_OVER_N_MINUS_1,
    DELTA_UNIT_INTERVAL, FIRST_GAP_FOR_ALL, FIRST_RAY_DELTAS,
};

const INCLUSIVE: Mistake = Mistake::new(
    "inclusive_transmittance",
    "w_i = T_{i+1} alpha_i: the sample shades itself (an inclusive cumprod or cumsum)",
    "surfaces too dark by a factor of 1 - alpha; spikes read (.25, .125, .0625)",
    "shift the cumulative product by one: T_0 = 1",
    "1 of 38 CS180 projects, 8 others",
    9,
);
const ROLLED: Mistake = Mistake::new(
    "rolled_transmittance",
    "T = roll(cumprod(1 - alpha), 1), whose first entry is the last product instead of 1",
    "the first sample is attenuated by the whole ray; spikes read (.0625, .25, .125)",
    "set T_0 = 1 after the roll",
    "2 public implementations",
    2,
);
const FIRST_ZERO: Mistake = Mistake::new(
    "first_transmittance_zero",
    "T_0 = 0 (a zero in front of the cumulative product instead of a one)",
    "the first sample is invisible; spikes read (0, .25, .125)",
    "put 1 in front of the product (0 in front of the sum)",
    "1 public implementation",
    1,
);
const INCLUSIVE_BEHIND_FIRST: Mistake = Mistake::new(
    "inclusive_behind_the_first",
    "T_0 = 1, and T_i = prod_{j<=i} (1 - alpha_j) from the second sample on: 1 is written over the inclusive product's first factor",
    "every sample but the first shades itself, and the first one shades twice",
    "shift the product by one: 1 in front, the last factor dropped",
    "2 public implementations",
    2,
);
const OWN_LIGHT: Mistake = Mistake::new(
    "own_light_alone",
    "T_i = 1 - alpha_i: the sample's own factor for the product of those in front",
    "nothing is hidden by what lies in front of it",
    "the product over the samples in front",
    "1 public implementation",
    1,
);
const NEIGHBORS_LIGHT: Mistake = Mistake::new(
    "neighbors_light_alone",
    "T_i = 1 - alpha_{i-1}, T_0 = 1: the factor of the one sample in front for the product of all of them",
    "nothing further in front hides anything",
    "the product over all samples in front",
    "1 public implementation",
    1,
);
const WHOLE_RAYS_LIGHT: Mistake = Mistake::new(
    "whole_rays_light",
    "T is one number a ray, the product of all factors (prod or sum for cumprod or cumsum)",
    "the order of the samples doesn't matter; what is opaque hides itself",
    "the cumulative product, moved by one",
    "1 public implementation",
    1,
);
const LIGHT_FOR_ALPHA: Mistake = Mistake::new(
    "light_for_alpha",
    "w_i = T_i (1 - alpha_i): what passes a sample in the place of what it stops",
    "empty space glows, surfaces are dark",
    "w_i = T_i alpha_i, with alpha_i = 1 - exp(-x_i)",
    "2 public implementations",
    2,
);
const UNIT_WEIGHTS: Mistake = Mistake::new(
    "weights_of_unit_length",
    "the weights are divided by their Euclidean norm, as a vector's normalize does",
    "they sum to more than 1; empty rays are NaN",
    "leave them: what is missing to 1 is the background's",
    "1 public implementation",
    1,
);
const COLORS_MOVED: Mistake = Mistake::new(
    "colors_of_next_sample",
    "C = sum w_i c_{i+1}: colors and weights are cut to the same length at opposite ends",
    "surfaces have the color of what lies behind them",
    "the same slice of both",
    "1 public implementation",
    1,
);
const CLAMPED: Mistake = Mistake::new(
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
const OPACITY_AS_T: Mistake = Mistake::new(
    "opacity_as_transmittance",
    "T = 1 - prod(1 - alpha): opacity in the place of transmittance",
    "what lies behind shines through what lies in front; spikes read (.25, .375, .4375)",
    "use the product itself",
    "3 public implementations",
    3,
);
const OPACITY_IN_FRONT_AS_T: Mistake = Mistake::new(
    "opacity_in_front_as_transmittance",
    "T_i = 1 - prod_{j<i}(1 - alpha_j): what was spent in front of a sample in the place of what is left",
    "the first sample is invisible, and what lies behind shines through what lies in front; spikes read (0, .25, .375)",
    "use the product itself",
    "3 copies of a teaching code",
    3,
);
const MOVED_TWICE: Mistake = Mistake::new(
    "transmittance_moved_twice",
    "an exclusive product (a cumsum less the step) is moved by one once more",
    "no sample is shaded by the one in front of it",
    "move it once",
    "1 public implementation",
    1,
);
const ROLLED_BUT_FIRST: Mistake = Mistake::new(
    "rolled_but_in_first_ray",
    "T is rolled, and T[0, 0] alone is set to 1: the first sample of the first ray",
    "the first ray is right, all others are attenuated by what lies behind",
    "T[:, 0] = 1",
    "1 public implementation",
    1,
);
const LEFT_EARLY: Mistake = Mistake::new(
    "transmittance_before_last",
    "what is left behind the ray is T in front of its last sample",
    "the background shines through the last sample",
    "the product of all factors",
    "1 public implementation",
    1,
);
const OWN_FACTOR: Mistake = Mistake::new(
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
const ALPHA_FORGOTTEN: Mistake = Mistake::new(
    "alpha_forgotten",
    "w_i = T_i",
    "empty space glows; weights sum to more than 1",
    "multiply by alpha_i",
    "1 public implementation",
    1,
);
const OVER_RAYS: Mistake = Mistake::new(
    "transmittance_over_rays",
    "the cumulative sum or product runs over rays instead of samples (axis 0 for axis 1)",
    "a ray's color depends on its neighbors in the batch",
    "accumulate along the sample axis",
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
    "1 public implementation",
    1,
)
.with("k", 0.99, [0.5, 1.5]);
const BACK_TO_FRONT: Mistake = Mistake::new(
    "back_to_front",
    "the formula from front to back over samples that are sorted from back to front",
    "what is behind hides what is in front of it",
    "T_i = prod_{j<i} (1 - alpha_j) with the nearest sample first; from behind it is C = alpha c + (1 - alpha) C",
    "splat renderers written from scratch: argsort(z, descending=True), then T *= 1 - alpha",
    2,
);

const SHADE_FORGOTTEN: Mistake = Mistake::new(
    "shade_gradient_forgotten",
    "the gradient of alpha_i is T_i g.c_i alone: what the sample hides behind it is left out",
    "opacities only ever grow where colors are bright, and never make way for what is behind them",
    "T_i (g.c_i - what a unit of light is worth behind the sample)",
    "hand-written backward passes of splats",
    1,
)
.of_gradient();

/// Mistakes of rendering from densities.
pub(crate) const VOLUME_RENDER: &[Mistake] = &[
    INCLUSIVE,
    ROLLED,
    FIRST_ZERO,
    OPACITY_AS_T,
    INCLUSIVE_BEHIND_FIRST,
    OWN_LIGHT,
    WEIGHTS_NORMALIZED,
    DIVIDED,
    ALPHA_FORGOTTEN,
    OVER_RAYS,
    OPACITY_IN_FRONT_AS_T,
    MOVED_TWICE,
    ROLLED_BUT_FIRST,
    LEFT_EARLY,
    NEIGHBORS_LIGHT,
    WHOLE_RAYS_LIGHT,
    LIGHT_FOR_ALPHA,
    UNIT_WEIGHTS,
    COLORS_MOVED,
    CLAMPED,
    EPS_IN_PRODUCT,
    Mistake::new(
        "exponent_without_minus",
        "alpha = 1 - exp(sigma delta)",
        "opacities below 0, and weights that grow without bound",
        "alpha = 1 - exp(-sigma delta)",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "depth_for_transmittance",
        "T_i = sum_{j<i} sigma_j delta_j, without the exponential",
        "the first sample is invisible, what lies behind is brighter the more is in front of it",
        "T_i = exp(-sum_{j<i} sigma_j delta_j)",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "density_for_opacity",
        "w_i = T_i sigma_i: the density in the place of alpha",
        "weights in units of 1 / length, above 1 where it is dense",
        "alpha_i = 1 - exp(-sigma_i delta_i)",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "optical_depth_for_alpha",
        "w_i = T_i sigma_i delta_i: the integral by rectangles, exact for T alone",
        "as it should be in thin fog; a thick step shines brighter than its color, and weights sum to more than 1",
        "alpha_i = 1 - exp(-sigma_i delta_i)",
        "a renderer of fluids in C++, twice; volumes in GLSL",
        3,
    ),
    Mistake::new(
        "density_with_step_before",
        "T_i = T_{i-1} exp(-sigma_i delta_{i-1}): density and step of different samples, and the sample shades itself",
        "shadows one sample too early",
        "T_i = T_{i-1} exp(-sigma_{i-1} delta_{i-1})",
        "1 CMU 16-825 student",
        1,
    ),
    DELTA_MISSING,
    DELTA_UNIT_INTERVAL,
    DELTA_OVER_N_MINUS_1,
    BACKWARD_DELTA,
    DELTA_DIFFERENCED_TWICE,
    FIRST_GAP_FOR_ALL,
    FIRST_RAY_DELTAS,
    EPS_ON_ALPHA,
    DELTA_SCALED,
    SCALED_EXPONENTIAL,
    DELTA_OF_THE_WHOLE_RAY,
    BACK_TO_FRONT,
    SHADE_FORGOTTEN,
];
/// Mistakes of rendering from opacities.
pub(crate) const VOLUME_RENDER_ALPHA: &[Mistake] = &[
    INCLUSIVE,
    ROLLED,
    FIRST_ZERO,
    OPACITY_AS_T,
    INCLUSIVE_BEHIND_FIRST,
    OWN_LIGHT,
    WEIGHTS_NORMALIZED,
    DIVIDED,
    ALPHA_FORGOTTEN,
    OVER_RAYS,
    OPACITY_IN_FRONT_AS_T,
    MOVED_TWICE,
    ROLLED_BUT_FIRST,
    LEFT_EARLY,
    NEIGHBORS_LIGHT,
    WHOLE_RAYS_LIGHT,
    LIGHT_FOR_ALPHA,
    UNIT_WEIGHTS,
    COLORS_MOVED,
    CLAMPED,
    EPS_IN_PRODUCT,
    OWN_FACTOR,
    BACK_TO_FRONT,
    SHADE_FORGOTTEN,
    Mistake::new(
        "product_gradient_zero_at_opaque",
        "the product's gradient divides by 1 - alpha and is set to 0 where that is 0",
        "an opaque sample can never become transparent again",
        "use the recursion from the last sample, which divides by nothing",
        "nerfacc FIXME; alpha = [.5, 1, .3, .2], cotangent [1, 2, 3, 4]: [2, 0, 0, 0] for [2, 2.9, 0, 0]",
        1,
    )
    .of_gradient(),
];
/// Mistakes of the background.
pub(crate) const COMPOSITE_BACKGROUND: &[Mistake] = &[
    CLAMPED,
    Mistake::new(
        "background_by_opacity",
        "C + A b: the opacity stands where the light that is left belongs",
        "the background shines through what is opaque, and is missing behind nothing",
        "C + (1 - A) b",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "attenuated_twice",
        "A C + (1 - A) b: the rendered color is premultiplied already",
        "half-transparent edges too dark; right only at A = 0 or 1",
        "C + (1 - A) b",
        "instant-nsr-pl#54, nerfstudio#2165",
        2,
    ),
    Mistake::new(
        "one_channel",
        "the background is written to the first channel alone",
        "empty rays have the wrong hue",
        "add (1 - A) b to every channel",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "background_255",
        "b is in 0..255 where C is in 0..1",
        "everything that isn't opaque is white",
        "divide the background by 255",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "background_always",
        "C + b: the background isn't attenuated (an appended sample that isn't opaque, or a forgotten 1 - A)",
        "opaque objects glow",
        "C + (1 - A) b",
        "1 public implementation",
        1,
    ),
];
