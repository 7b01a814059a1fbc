//! What is wrong with gradients of renderings that are written by hand, and what it does. g is the cotangent of a weight, B what lies behind.

use super::catalogue::SHADE_FORGOTTEN;
use crate::contract::component::Mistake;

const HIDDEN_ADDED: Mistake = Mistake::new(
    "hidden_added",
    "+ sum w_j g_j for - sum w_j g_j over what lies behind: the sum from the end is taken off, not added to",
    "samples grow in front of what is bright",
    "minus what lies behind",
    "1 splat renderer in Crystal",
    1,
)
.of_gradient();

/// Between weights and densities.
pub(super) const OF_DENSITIES: &[Mistake] = &[
    SHADE_FORGOTTEN,
    HIDDEN_ADDED,
    Mistake::new(
        "front_for_behind",
        "T_i g_i - B_{i+1}: the light in front of a sample for that behind it",
        "gradients too large where it is dense",
        "T_{i+1} g_i - B_{i+1}: alpha has the slope 1 - alpha",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "own_weight_hidden_too",
        "T_{i+1} g_i - B_i: the sample itself among what it hides",
        "densities learn too slowly where a sample is bright itself",
        "the sum over what lies behind, the sample left out",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "hidden_in_front",
        "T_{i+1} g_i minus the sum over what lies in front",
        "the gradient of a ray that is looked through from behind",
        "the sum over what lies behind the sample",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "hidden_on_both_sides",
        "T_{i+1} g_i minus the sum over all other samples, in front too: C - w_i c_i for what lies behind",
        "densities learn from what they don't hide",
        "the sum over what lies behind the sample",
        "1 renderer in numba, with T_i for T_{i+1}",
        1,
    )
    .of_gradient(),
    Mistake::new(
        "alpha_for_density",
        "the gradient of alpha, with 1e-10 in what it divides by, as that of sigma delta: its slope 1 - alpha is left out",
        "gradients too large where it is dense",
        "times exp(-sigma delta)",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "opacity_without_step",
        "g_A T_N for g_A T_N delta_i: the opacity's gradient without the step",
        "densities that follow the mask too fast or too slowly",
        "dA / dsigma_i = T_N delta_i",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "ties_shared",
        "half of what a sample hides, where alpha is 0: max(1 - alpha, 1e-10) cut at 1, where both sides of the tie get half",
        "empty space learns half as fast what it would hide",
        "no cut at 1: 1 - alpha never lies above it",
        "jnp.clip around 1 - alpha, whose gradient at a tie is half",
        1,
    )
    .of_gradient(),
    Mistake::new(
        "nothing_learned_at_zero",
        "no gradient through the sample's own alpha where sigma delta = 0: a ReLU around it, which T hasn't",
        "empty space learns what it would hide alone, and only ever becomes emptier",
        "sigma as it is, or a ReLU for both, in front of the product",
        "2 ports to JAX and MLX: alpha = 1 - exp(-relu(sigma delta))",
        2,
    )
    .of_gradient(),
    Mistake::new(
        "first_channel_for_all",
        "the cotangent of red for all three channels",
        "densities learn from the red picture alone",
        "each channel's own cotangent",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "light_not_reset",
        "the backward march begins with what light the forward march has left",
        "gradients that vanish where it is opaque",
        "T = 1 in front of the first sample",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "colors_by_light_behind",
        "the gradient of a color is T_{i+1} alpha_i times that of the pixel's",
        "colors of surfaces never learn",
        "the weight: T_i alpha_i",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "first_rays_cotangent",
        "the first ray's cotangent of the color for all rays",
        "all rays learn what one of them should",
        "each ray's own row",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "opacity_shades_nothing",
        "g_A T_{i+1} delta_i: the opacity's gradient without what a sample hides",
        "densities behind a surface follow the mask, too",
        "g_A T_N delta_i, for each sample",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "opacity_without_light",
        "g_A delta_i: the opacity's gradient without T_N = 1 - A",
        "an opaque ray still grows denser",
        "dA / dsigma_i = T_N delta_i",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "step_gradient_by_step",
        "the gradient of delta_i is that of sigma_i: times delta for times sigma",
        "camera and sampling learn from nonsense",
        "d / ddelta_i = sigma_i times the slope",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "loss_scale_left_in",
        "all gradients times the scale of the loss, 128",
        "steps that are so many times too long, where it isn't Adam that takes them",
        "divide by the scale behind the backward pass",
        "never; cheap to keep",
        0,
    )
    .of_gradient()
    .with("scale", 128.0, [1.1, 1e6]),
    Mistake::new(
        "opacity_for_its_slope",
        "alpha for dalpha / dx = 1 - alpha",
        "thin samples never learn",
        "1 - alpha = exp(-sigma delta)",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "slope_taken_twice",
        "T_{i+1} (1 - alpha_i) g_i: T_{i+1} has that factor already",
        "gradients too small where it is dense",
        "T_{i+1} g_i, or T_i (1 - alpha_i) g_i",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "step_lost_in_slope",
        "T_i exp(-sigma_i) g_i: the slope of alpha without its step",
        "gradients too small where steps are short",
        "exp(-sigma_i delta_i)",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "steps_of_those_behind",
        "delta_j inside of the sum over what lies behind, for delta_i in front of it",
        "wrong wherever steps aren't even",
        "(T_{i+1} g_i - sum w_j g_j) delta_i",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "light_lost_behind",
        "sum alpha_j g_j over what lies behind, for sum w_j g_j",
        "far samples hold near ones back",
        "weights: T_j alpha_j",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "last_sample_without_gradient",
        "the loop ends in front of the last sample",
        "the last sample never learns",
        "all N samples",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "slope_for_both",
        "(T_i g_i - sum w_j g_j) (1 - alpha_i): the factor is the first term's alone",
        "what a sample hides counts too little",
        "T_{i+1} g_i - sum w_j g_j",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "backward_given_up",
        "no gradient behind where less light than a threshold is left, which the forward march goes through",
        "haze behind a surface never learns",
        "one end for both marches",
        "never; cheap to keep",
        0,
    )
    .of_gradient()
    .with("left", 1e-2, [1e-6, 0.5]),
    Mistake::new(
        "weights_detached",
        "colors of weights that are taken for constants",
        "densities learn nothing from the picture",
        "gradients through the weights, too",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
];

/// Between weights and opacities.
pub(super) const OF_OPACITIES: &[Mistake] = &[
    Mistake::new(
        "light_recovered_by_division",
        "T / (1 - alpha), from behind: 0 / 0 where a sample is opaque",
        "not a number in front of what is opaque, and from there in all parameters",
        "alphas that stay below 1, or T kept from the forward march",
        "1 check of a splat kernel",
        1,
    )
    .of_gradient(),
    Mistake::new(
        "thin_samples_learn_nothing",
        "no gradient where alpha is below a threshold",
        "what has faded never comes back",
        "g_alpha where alpha is 0, too",
        "2 splat kernels, where such samples are left out of the forward march as well",
        2,
    )
    .of_gradient()
    .with("alpha", 1e-6, [1e-12, 0.1]),
    Mistake::new(
        "accumulated_before_use",
        "T_i (g_i - B_i): what lies behind with the sample itself in it",
        "opaque samples never learn",
        "T_i (g_i - B_{i+1}): use it, then add the sample",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "light_behind_itself",
        "T_{i+1} (g_i - B_{i+1})",
        "opaque samples never learn",
        "T_i: the light that reaches the sample",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "last_alpha_forgotten",
        "B_{i+1} = alpha_i g_{i+1} + (1 - alpha_i) B_{i+2}: this sample's alpha for the next one's",
        "what lies behind counts by another sample's opacity",
        "keep the alpha with the color that it belongs to",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "hidden_undivided",
        "T_i g_i - sum w_j g_j, without / (1 - alpha_i)",
        "what a sample hides counts too little",
        "sum w_j g_j / (1 - alpha_i)",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "own_weight_hidden_too",
        "T_i g_i - sum_{j >= i} w_j g_j / (1 - alpha_i)",
        "opacities learn too slowly where a sample is bright itself",
        "the sum over what lies behind, the sample left out",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "opacity_shades_nothing",
        "g_A T_i: the opacity's gradient without what a sample hides",
        "opacities behind a surface follow the mask, too",
        "g_A T_N / (1 - alpha_i)",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "opacity_undivided",
        "g_A T_N, without / (1 - alpha_i)",
        "the mask teaches dense samples nothing",
        "g_A T_N / (1 - alpha_i)",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "eps_in_hidden",
        "sum w_j g_j / (1 - alpha_i + eps)",
        "wrong where a sample is nearly opaque",
        "a product over the others, or alpha that stays below 1",
        "never; cheap to keep",
        0,
    )
    .of_gradient()
    .with("eps", 1e-6, [1e-10, 1e-1]),
    Mistake::new(
        "hidden_held",
        "sum w_j g_j / max(1 - alpha_i, eps)",
        "wrong where a sample is nearly opaque",
        "a product over the others, or alpha that stays below 1",
        "never; cheap to keep",
        0,
    )
    .of_gradient()
    .with("eps", 1e-2, [1e-8, 0.5]),
    Mistake::new(
        "hidden_one_late",
        "T_i (g_i - B_{i+2}), of samples that aren't empty: what lies behind is kept for the next one; the light behind the ray is right",
        "what the next sample shows isn't held against this one",
        "B_{i+1} = alpha_{i+1} g_{i+1} + (1 - alpha_{i+1}) B_{i+2}, then use it",
        "1 port of 3D Gaussian splatting's backward pass to Warp",
        1,
    )
    .of_gradient(),
    HIDDEN_ADDED,
    Mistake::new(
        "stopped_behind_the_sample",
        "gradients as if the ray ended behind the sample that leaves less light than a threshold",
        "what lies behind never learns",
        "the samples of the forward pass, all of them or those of early_stop",
        "2 splat renderers",
        2,
    )
    .of_gradient()
    .with("left", 1e-4, [1e-6, 0.5]),
    Mistake::new(
        "stopped_before_the_sample",
        "gradients as if the ray ended in front of the sample that leaves less light than a threshold",
        "what lies behind never learns, nor does that sample",
        "the samples of the forward pass, all of them or those of early_stop",
        "1 splat renderer",
        1,
    )
    .of_gradient()
    .with("left", 1e-4, [1e-6, 0.5]),
];
