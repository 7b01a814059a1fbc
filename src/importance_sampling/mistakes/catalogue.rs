//! What is wrong with importance sampling, what it does, and where it was seen.

use super::inputs::OF_INPUTS;
use crate::contract::component::{Mistake, joined};

/// The search takes the other side. This and the next three are mistakes of new edges, too.
pub(crate) const SEARCHED_FROM_THE_LEFT: Mistake = Mistake::new(
    "searched_from_the_left",
    "the bin by searchsorted with side left: F_k < u in the place of F_k <= u",
    "u = 0 gives the ray's first edge, through bins without weight",
    "side right",
    "torch.searchsorted's default, ports of sample_pdf",
    3,
);

/// The distribution begins too late.
pub(crate) const NO_LEADING_ZERO: Mistake = Mistake::new(
    "no_leading_zero",
    "F is the cumulative sum alone, without 0 in front",
    "every sample lies a bin too near",
    "concatenate 0 and the cumulative sum",
    "ports of sample_pdf",
    2,
)
.open_where_nan();

/// Weights of samples are taken for those of intervals.
pub(crate) const INTERIOR_ALONE: Mistake = Mistake::new(
    "interior_alone",
    "weights[1:-1] between the midpoints of the edges",
    "no sample in the first and last half bin",
    "edges and their weights as they are; midpoints belong to weights of samples",
    "bmild's call with z_vals_mid, copied to weights of intervals",
    4,
);

/// An empty ray isn't thought of. Of a proposal's distribution, too.
pub(crate) const NOTHING_OVER_NOTHING: Mistake = Mistake::new(
    "nothing_over_nothing",
    "w / sum w without anything added: 0 / 0 where no bin weighs",
    "not a number on rays through empty space, and from there in all parameters",
    "a padding, or even shares where the sum is 0",
    "never; proposals' softmaxes of logarithms do the same",
    0,
);

/// The distribution doesn't end at 1.
pub(crate) const NOT_NORMALIZED: Mistake = Mistake::new(
    "not_normalized",
    "F isn't divided by the sum of the weights",
    "nothing is sampled after F = 1, or all that is left falls on the last edge",
    "divide by the sum",
    "ports of sample_pdf",
    1,
);

pub(super) const DENOMINATOR_EPS: Mistake = Mistake::new(
    "eps_in_denominator",
    "(u - F_k) / (F_{k+1} - F_k + eps)",
    "bins with little weight are never left at their far end",
    "1 where the difference is 0",
    "never; cheap to keep",
    0,
)
.with("eps", 1e-5, [1e-8, 1e-1]);

pub(super) const EPS_IN_SUM: Mistake = Mistake::new(
    "eps_in_sum",
    "w / (eps + sum w): the eps once, with the sum, and none with each weight",
    "the last bin falls short of 1: u beyond lands on the last edge",
    "(w + padding) / sum (w + padding)",
    "2 public implementations, with 1e-5",
    2,
)
.with("eps", 1e-5, [1e-12, 1e-1]);

pub(super) const EPS_AFTER_DIVISION: Mistake = Mistake::new(
    "eps_after_division",
    "w / sum w + eps: F ends beyond 1, at 1 + N eps",
    "samples too near: the end of the last bin is never reached",
    "add it to the weights, before they are divided by their sum",
    "1 public implementation",
    1,
)
.with("eps", 1e-6, [1e-8, 1e-1]);

pub(super) const BLURRED: Mistake = Mistake::new(
    "weights_blurred",
    "(max(w_{k-1}, w_k) + max(w_k, w_{k+1})) / 2 + 0.01: mip-NeRF's weights, the larger of two neighbors",
    "samples beside what the weights show; mip-NeRF means it so, where a pixel is a cone",
    "the weights as they are; whoever blurs does so in front of this",
    "mip-NeRF's resampling and its ports",
    2,
)
.with("padding", 0.01, [1e-8, 1.0]);

pub(super) const PADDED: Mistake = Mistake::new(
    "padded_by",
    "w + k, whatever the padding is",
    "samples that are spread over empty space, or not spread where it was asked for",
    "w + padding",
    "never; cheap to keep",
    0,
)
.with("k", 1e-3, [1e-8, 0.1]);

/// Mistakes of importance sampling.
pub(crate) const IMPORTANCE_SAMPLING: &[Mistake] =
    &joined::<{ OF_SAMPLES.len() + OF_INPUTS.len() }>(&[OF_SAMPLES, OF_INPUTS]);

const OF_SAMPLES: &[Mistake] = &[
    SEARCHED_FROM_THE_LEFT,
    NO_LEADING_ZERO,
    INTERIOR_ALONE,
    NOT_NORMALIZED,
    PADDED,
    Mistake::new(
        "left_edge",
        "the chosen bin's edge, without a place inside it",
        "samples in clumps",
        "interpolate between the two edges",
        "ports of sample_pdf",
        1,
    ),
    Mistake::new(
        "bin_width_forgotten",
        "t = edge_k + (u - F_k) / (F_{k+1} - F_k), without the bin's width",
        "samples beyond their bin where it is narrower than 1, in clumps where it is wider",
        "edge_k + s (edge_{k+1} - edge_k)",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "middle_of_bin",
        "the chosen bin's middle",
        "samples in clumps",
        "interpolate between the two edges",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "last_bin_dropped",
        "N places for N weights: F without its last entry and, of the edges, all but the last",
        "what belongs to the last bin lies on its first edge, in one point",
        "N + 1 edges for N weights; of N places, the N - 1 midpoints and the weights between them",
        "3 copies of a student's code: cat(0, cumsum[:-1]) over the coarse samples",
        3,
    ),
    Mistake::new(
        "first_bin_dropped",
        "N places for N weights, each of a bin that ends there: of the edges, all but the first",
        "what belongs to the first bin lies on its far edge, in one point",
        "N + 1 edges for N weights; of N places, the N - 1 midpoints and the weights between them",
        "a trainer in C#",
        1,
    ),
    Mistake::new(
        "place_mirrored",
        "1 - s for the place s within the bin",
        "samples of a bin in the reverse order, each where another belongs",
        "a + s (b - a)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "stratified_again",
        "(j + u_j) / M for u_j, which were handed over as they are to be used",
        "samples in the wrong bins",
        "u as it is",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "own_bin_alone",
        "sample j is looked for in bin j alone, and is 0 where it doesn't lie there",
        "nearly all samples lie at the camera",
        "look for each u in the whole of F",
        "a trainer in C++: for (i) if (F[i] <= u[i] && u[i] < F[i + 1])",
        1,
    ),
    Mistake::new(
        "edges_about_the_middles",
        "edges half of the first step before and behind each middle: bins are taken for even",
        "samples in bins that aren't where they are, wherever bins aren't even",
        "the edges as they are",
        "a trainer in Rust, which has the coarse samples' middles alone",
        1,
    ),
    Mistake::new(
        "weights_as_densities",
        "weights times the widths of their bins",
        "wide bins are sampled too often",
        "a weight is a bin's whole share already",
        "between histograms and densities; never seen",
        0,
    ),
    Mistake::new(
        "padded_densities",
        "(weights + padding) times the widths of their bins",
        "wide bins are sampled too often, also where nothing weighs",
        "a weight is a bin's whole share already",
        "1 public implementation: densities of a histogram, whose integral is taken",
        1,
    ),
    NOTHING_OVER_NOTHING,
    Mistake::new(
        "one_u_for_all_rays",
        "the first ray's u for all",
        "rays share their noise",
        "u of its own for each ray",
        "as the jitter of coarse samples, seen 8 times there",
        1,
    ),
    Mistake::new(
        "place_detached",
        "the place s inside the bin is taken for a constant",
        "no gradient with respect to u",
        "s depends on u",
        "torch.no_grad around the search, spread too far",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "edges_half_each",
        "both edges of a bin get half of the gradient",
        "edges move together, whatever side the sample is on",
        "1 - s and s",
        "never; cheap to keep",
        0,
    )
    .of_gradient(),
    Mistake::new(
        "strata_doubled",
        "u = u + u + r where u = i / M and r is in [0, 1 / M), cut below 1: a `u +=` became `u = u +`",
        "half of the samples on the ray's last edge, and every second stratum empty",
        "u = i / M + r",
        "mipnerf-pytorch#5 and three copies",
        4,
    ),
    DENOMINATOR_EPS,
    EPS_AFTER_DIVISION,
    EPS_IN_SUM,
    BLURRED,
    Mistake::new(
        "last_bin_zeroed",
        "the last weight is set to 0 before the division by the sum",
        "next to nothing is sampled in the last bin: what is added to all weights",
        "every bin's own weight",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "upper_edge_held_by_sample_count",
        "the far edge is min(k + 1, M - 1), with the number of samples M for that of edges",
        "beyond bin M - 2 samples are drawn out from edges far in front of them",
        "min(k + 1, N)",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "right_edge",
        "the chosen bin's far edge, without a place inside it",
        "samples in clumps, behind what they should show",
        "interpolate between the two edges",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "place_of_u",
        "edge_k + u (edge_{k+1} - edge_k): u itself for the place inside the bin",
        "samples in a part of each bin that depends on how far away it is",
        "(u - F_k) / (F_{k+1} - F_k)",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "sum_of_all_rays",
        "divided by the sum over the batch, without its axis",
        "rays get the share of the batch that they happen to have; what is left falls on the last edge",
        "a sum for each ray",
        "never; cheap to keep",
        0,
    ),
    Mistake::new("weights_squared", "w^2", "faint surfaces get no samples", "w", "never; cheap to keep", 0),
    Mistake::new(
        "weights_over_widths",
        "weights over the widths of their bins",
        "narrow bins are sampled too often",
        "a weight is a bin's whole share already",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "weights_of_next_bin",
        "the weights of the next bin, those of the first at the end",
        "samples a bin in front of what they should show",
        "bin k has weight k",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "sorted_within",
        "the samples are sorted",
        "samples don't belong to their u any more: what is handed on with these is mixed up",
        "sort where samples are merged, and all that belongs to them",
        "never; cheap to keep",
        0,
    ),
    Mistake::new(
        "bins_taken_as_even",
        "(bin + place) / N between the first edge and the last, as if all bins were as wide",
        "samples where nothing is, once the bins are uneven",
        "between the bin's own edges",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "index_not_moved_back",
        "edges k + 1 and k + 2 for a u between F_k and F_{k+1}: what searchsorted finds, without - 1",
        "every sample lies a bin too far",
        "the bin begins one before what a search from the right finds",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "divided_by_the_integral",
        "F sums w / sum (w width): divided as a density is, summed without its widths",
        "F ends far from 1, unless bins are 1 wide",
        "w / sum w for weights, w width / sum (w width) for densities",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "edges_from_zero",
        "edges measured from the first one: sums of widths",
        "samples begin at the camera, not at near",
        "edges as they are, or near added to sums of widths",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "bins_counted_by_samples",
        "(bin + place) / M between the first edge and the last, with the number of samples for that of even bins",
        "samples in a part of the ray alone, or beyond it",
        "between the bin's own edges",
        "1 public implementation",
        1,
    ),
    Mistake::new(
        "left_edge_at_the_end",
        "u = 1 gives the last bin's first edge: the search runs past F, and both ends of the bin are its last entry",
        "the last of evenly spaced samples is a bin too near",
        "hold the bin, not each of its ends: its end is the last edge",
        "2 public implementations",
        2,
    ),
];
