//! What is wrong with places on a ray, and what it does.

use crate::contract::component::Mistake;

/// Of strata, and of what is handed on.
pub(super) const OF_PLACES: &[Mistake] = &[
    Mistake::new(
        "lower_halves_alone",
        "strata from the middle in front of a place to the place itself: half of each",
        "nothing is ever sampled in half of the ray",
        "from middle to middle",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "strata_of_two_spacings",
        "strata from the place in front to the place behind: twice as wide as they should be",
        "neighbors change places: t is unsorted, and steps are negative",
        "from middle to middle",
        "1 port to libtorch",
        1,
    ),
    Mistake::new(
        "held_in_the_range",
        "jitter of a whole spacing of both ends, held between near and far",
        "samples in clumps at both ends",
        "strata that end at near and far by themselves",
        "a jitter about a linspace, cut",
        1,
    ),
    Mistake::new(
        "length_of_its_own",
        "steps of k / N, whatever far is",
        "samples end in front of far, or behind it",
        "steps of (far - near) / N",
        "marches with sqrt(3) / N, the diagonal of the unit cube",
        1,
    )
    .with("k", 1.7320508075688772, [0.1, 100.0]),
    Mistake::new(
        "near_added_twice",
        "points at near + t, for t that begins at near",
        "points behind where they are said to be",
        "o + t d",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "near_added_for_points_alone",
        "t without near, points with it",
        "depths that begin at the camera",
        "the same t for both",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "jitter_of_the_whole_range",
        "u (far - near) for the jitter, without / N",
        "samples far beyond their stratum, and beyond far",
        "a jitter within each stratum",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "jitter_of_a_share",
        "t = grid + k u (far - near): a share k of the range, however many samples there are",
        "too wide: samples leave their stratum; too narrow: the ray has gaps that no step ever sees",
        "a jitter within each stratum: (far - near) / N",
        "1 public implementation, with 0.002",
        1,
    )
    .with("k", 0.002, [1e-5, 0.99]),
    Mistake::new(
        "jittered_far_and_sorted",
        "u (far - near) for the jitter, without / N, and then sorted",
        "samples far beyond their stratum, and beyond far",
        "a jitter within each stratum: these are in order by themselves",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "middles_of_jittered_edges",
        "(e_i + e_{i+1}) / 2 of jittered edges, the last one far",
        "samples whose jitter is averaged away",
        "a sample in each stratum; middles where edges are what is jittered",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "even_then_in_disparity",
        "even up to a distance of 1, beyond it in disparity: the spacing of nerfacto",
        "samples elsewhere than between near and far evenly",
        "evenly, unless the scene has no end",
        "nerfstudio's UniformLinDispPiecewiseSampler, where it is meant so",
        1,
    ),
    Mistake::new(
        "t_without_jitter",
        "t of the middles is handed on, with points that are jittered",
        "depths and steps of other samples than those that are seen",
        "one t for both",
        "never; cheap to keep",
        0,
    ),
];
