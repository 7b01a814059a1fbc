//! What is wrong with the numbers that come into importance sampling: what is drawn, which weights have which edges, and what they add up to.

use crate::contract::component::Mistake;

pub(super) const EVEN_U: Mistake = Mistake::new(
    "u_ignored",
    "u = linspace(0, 1, M), whatever is handed over",
    "the same samples in each step",
    "u as it is given: evenly spaced ones for a picture, drawn ones for training",
    "never; cheap to keep",
    0,
);
pub(super) const MIDDLES_U: Mistake = Mistake::new(
    "middles_for_u",
    "u = (j + 1/2) / M, whatever is handed over",
    "the same samples in each step",
    "u as it is given",
    "never; cheap to keep",
    0,
);
pub(super) const U_REVERSED: Mistake = Mistake::new(
    "u_from_the_far_end",
    "1 - u",
    "samples don't belong to their u: those near lie far",
    "F^-1(u)",
    "never; cheap to keep",
    0,
);
pub(super) const U_CUT: Mistake = Mistake::new(
    "u_cut_below_one",
    "min(u, 1 - k)",
    "the end of the last bin is never reached",
    "the last bin for u = 1",
    "never; cheap to keep",
    0,
)
.with("k", 1e-5, [1e-7, 0.1]);
pub(super) const U_HELD: Mistake = Mistake::new(
    "u_held_inside",
    "u held between k and 1 - k",
    "the ends of a ray are never reached",
    "u as it is",
    "never; cheap to keep",
    0,
)
.with("k", 1e-3, [1e-7, 0.1]);
pub(super) const OUTER_ZEROED: Mistake = Mistake::new(
    "outer_bins_zeroed",
    "the first weight and the last are set to 0",
    "nothing is sampled in the first bin and the last",
    "every bin's own weight",
    "never; cheap to keep",
    0,
);
pub(super) const AVERAGED: Mistake = Mistake::new(
    "weights_averaged",
    "(w_k + w_{k+1}) / 2, the last by itself",
    "samples in front of what they should show",
    "a weight belongs to a bin, not to an edge",
    "never; cheap to keep",
    0,
);
pub(super) const POOLED: Mistake = Mistake::new(
    "weights_pooled",
    "the largest of three neighboring weights",
    "samples beside what the weights show",
    "the weights as they are",
    "never; cheap to keep",
    0,
);
pub(super) const MIXED: Mistake = Mistake::new(
    "mixed_with_even_bins",
    "(1 - k) (w + padding) / sum (w + padding) + k / N",
    "samples in empty space",
    "the weights as they are, and the padding that is given",
    "never; cheap to keep",
    0,
)
.with("k", 0.01, [1e-4, 0.9]);
pub(super) const INNER_ON_FIRST: Mistake = Mistake::new(
    "inner_weights_on_first_edges",
    "weights[1:-1] on the first edges of all",
    "samples a bin in front of what they should show",
    "weights[1:-1] belong to the midpoints between samples; weights of intervals to all of their edges",
    "never; cheap to keep",
    0,
);
pub(super) const BEHIND_MIDDLES: Mistake = Mistake::new(
    "middles_with_weights_behind",
    "the midpoints of the edges with weights[1:]",
    "samples half a bin in front of what they should show",
    "edges and their weights as they are",
    "never; cheap to keep",
    0,
);
pub(super) const BEFORE_MIDDLES: Mistake = Mistake::new(
    "middles_with_weights_before",
    "the midpoints of the edges with weights[:-1]",
    "samples half a bin behind what they should show",
    "edges and their weights as they are",
    "never; cheap to keep",
    0,
);
pub(super) const IN_DISPARITY: Mistake = Mistake::new(
    "interpolated_in_disparity",
    "1 / t is interpolated between 1 / e_k and 1 / e_{k+1}",
    "samples nearer to the camera than they should be, inside of each bin",
    "a + s (b - a)",
    "never; cheap to keep",
    0,
);
pub(super) const MAX_FOR_SUM: Mistake = Mistake::new(
    "at_least_for_padding",
    "max(w, k), whatever the padding is",
    "samples in empty space, or too few",
    "w + padding",
    "never; cheap to keep",
    0,
)
.with("k", 1e-5, [1e-8, 0.1]);
pub(super) const CUT_AT_ONE: Mistake = Mistake::new(
    "sums_cut_at_one",
    "min(1, sum (w + padding)), not divided by the whole",
    "what is missing up to 1 falls on the last edge",
    "divide by the sum",
    "never; cheap to keep",
    0,
);
pub(super) const REST_IN_LAST: Mistake = Mistake::new(
    "rest_in_the_last_bin",
    "0, the sums of w + padding cut at 1, without the last, and 1: not divided by the whole",
    "what is missing up to 1 falls into the last bin",
    "divide by the sum",
    "never; cheap to keep",
    0,
);
pub(super) const PADDING_UNCOUNTED: Mistake = Mistake::new(
    "padding_not_in_the_sum",
    "(w + padding) / sum w",
    "F ends beyond 1: samples too near",
    "the same weights above and below",
    "never; cheap to keep",
    0,
);
pub(super) const NEXT_SHARE: Mistake = Mistake::new(
    "next_bins_share",
    "(u - F_k) over the share of bin k + 1",
    "samples beyond their bin, or in a part of it",
    "F_{k+1} - F_k",
    "never; cheap to keep",
    0,
);
pub(super) const FROM_ABOVE: Mistake = Mistake::new(
    "measured_from_above",
    "(u - F_{k+1}) / (F_{k+1} - F_k): the place is measured from the upper end",
    "samples a bin in front of their own",
    "(u - F_k)",
    "never; cheap to keep",
    0,
);
pub(super) const EVEN_WIDTH: Mistake = Mistake::new(
    "even_widths",
    "e_k + s (e_N - e_0) / N: bins' widths are taken for even, their edges not",
    "samples beyond their bin, or in a part of it",
    "e_k + s (e_{k+1} - e_k)",
    "never; cheap to keep",
    0,
);
pub(super) const LAST_OUT_OF_REACH: Mistake = Mistake::new(
    "last_edge_out_of_reach",
    "the upper edge is min(k + 1, N - 1), the lower one k",
    "what belongs to the last bin lies on its first edge; u = 1 on its end",
    "min(k + 1, N)",
    "never; cheap to keep",
    0,
);
pub(super) const NAN_AT_ONE: Mistake = Mistake::new(
    "u_of_one_past_the_end",
    "u = 1 reads past the end: not a number",
    "one NaN in a ray takes a whole step with it",
    "the last bin for u = 1",
    "never; cheap to keep",
    0,
);
pub(super) const SNAPPED_BELOW: Mistake = Mistake::new(
    "snapped_below",
    "1 for a share F_{k+1} - F_k below k",
    "samples of bins with little weight fall on their first edge",
    "the share as it is, unless it is 0",
    "never; cheap to keep",
    0,
)
.with("k", 1e-3, [2e-5, 0.5]);
pub(super) const INVERTED: Mistake = Mistake::new(
    "distribution_at_u",
    "F(u) for F^-1(u): what is interpolated, and between what, exchanged",
    "no sample anywhere near",
    "interpolate the edges between the entries of F",
    "never; cheap to keep",
    0,
);
pub(super) const FIRST_EDGES: Mistake = Mistake::new(
    "first_rays_edges",
    "the first ray's edges for all",
    "samples where another ray's bins are",
    "each ray's own edges",
    "never; cheap to keep",
    0,
);
pub(super) const FIRST_WEIGHTS: Mistake = Mistake::new(
    "first_rays_weights",
    "the first ray's weights for all",
    "samples where another ray has its surface",
    "each ray's own weights",
    "never; cheap to keep",
    0,
);

/// Where no bin weighs, the place is looked up in sums that are all 0.
pub(crate) const EMPTY_AT_FAR: Mistake = Mistake::new(
    "empty_rays_at_far",
    "w / max(sum w, eps): sums of 0 where no bin weighs, and so all samples on the last edge",
    "rays through empty space are looked at in one place, their far end",
    "a padding, or even shares where the sum is 0",
    "2 public implementations",
    2,
);
pub(crate) const EMPTY_AT_NEAR: Mistake = Mistake::new(
    "empty_rays_at_near",
    "NaN taken for 0, or for what lies in front of everything, where no bin weighs: all samples on the first edge",
    "rays through empty space are looked at in one place, their near end",
    "a padding, or even shares where the sum is 0",
    "2 public implementations",
    2,
);
pub(super) const U_SQUEEZED: Mistake = Mistake::new(
    "u_squeezed",
    "u (1 - 2 k) + k",
    "samples are a little nearer to the middle; the ends of a ray are never reached",
    "u as it is",
    "1 public implementation, with 1e-5",
    1,
)
.with("k", 1e-5, [1e-7, 0.1]);
const SUMMED_OVER_BINS: Mistake = Mistake::new(
    "summed_over_bins",
    "t = sum over bins of (a u + b) [F_k <= u < F_{k+1}], empty ones with 1e-16: 0 beyond the last sum, and the first edge for u = 0",
    "samples at the camera, or in front of what they should show",
    "the last bin that weighs for u = 1, the first for u = 0",
    "2 implementations of piecewise constant densities",
    2,
);
const HELD_AT_COUNT: Mistake = Mistake::new(
    "upper_edge_held_at_sample_count",
    "the far edge is min(k + 1, M), with the number of samples M for that of bins",
    "beyond bin M - 1 samples are drawn out from edges far in front of them",
    "min(k + 1, N)",
    "1 public implementation",
    1,
);
const INDEX: Mistake = Mistake::new(
    "index_for_place",
    "the number of the bin for a place in it",
    "samples at whole numbers, wherever the ray's bins are",
    "t_k + s (t_{k+1} - t_k)",
    "1 public implementation",
    1,
);

/// These, in order.
pub(super) const OF_INPUTS: &[Mistake] = &[
    EVEN_U,
    MIDDLES_U,
    U_REVERSED,
    U_CUT,
    U_HELD,
    OUTER_ZEROED,
    AVERAGED,
    POOLED,
    MIXED,
    INNER_ON_FIRST,
    BEHIND_MIDDLES,
    BEFORE_MIDDLES,
    IN_DISPARITY,
    MAX_FOR_SUM,
    CUT_AT_ONE,
    REST_IN_LAST,
    PADDING_UNCOUNTED,
    NEXT_SHARE,
    FROM_ABOVE,
    EVEN_WIDTH,
    LAST_OUT_OF_REACH,
    NAN_AT_ONE,
    SNAPPED_BELOW,
    INVERTED,
    FIRST_EDGES,
    FIRST_WEIGHTS,
    INDEX,
    EMPTY_AT_FAR,
    EMPTY_AT_NEAR,
    U_SQUEEZED,
    SUMMED_OVER_BINS,
    HELD_AT_COUNT,
];
