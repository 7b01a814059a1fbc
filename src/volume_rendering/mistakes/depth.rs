//! Descriptions of the mistakes in the expected distance.

use crate::contract::component::Mistake;

/// Mistakes of the expected distance.
pub(crate) const DEPTH: &[Mistake] = &[
    Mistake::new(
        "zero_by_zero",
        "sum w t / sum w on a ray without weight",
        "NaN in depth pictures, and in losses on them",
        "say what an empty ray's depth is: far",
        "nerf-pytorch#28 and many others",
        10,
    ),
    Mistake::new(
        "median_depth",
        "the t at which half of the light is spent, not the mean",
        "depths that jump from sample to sample, and have no gradient in the weights",
        "the weighted mean, or say that the median is meant",
        "nerfstudio's renderers.py, method median: another quantity",
        2,
    ),
    Mistake::new(
        "disparity",
        "1 / max(depth, 1e-10)",
        "near is large: another quantity",
        "sum w t / A",
        "nerf-pytorch's and other ports' disp_map",
        3,
    ),
    Mistake::new(
        "far_by_opacity",
        "sum w t + A far: far is added where the ray meets something, not where it meets nothing",
        "surfaces lie behind far",
        "sum w t + (1 - A) far, or sum w t / A",
        "1 public implementation and its copies",
        2,
    ),
    Mistake::new(
        "depth_of_index",
        "sum w i / sum w: the sample's number in the place of t",
        "depth without units",
        "weigh t",
        "never; cheap to keep",
        0,
    ),
];
