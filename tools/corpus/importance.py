"""Samples by the weights of a first pass."""

import numpy as np
import torch
from entry import convention, fault, right


def steps(weights, padding=0.0):
    """0, F_1, ..., 1; equal weights for an empty ray."""
    weights = weights + padding
    weights = torch.where(weights.sum(-1, keepdim=True) == 0, torch.ones_like(weights), weights)
    cdf = torch.cumsum(weights / weights.sum(-1, keepdim=True), -1)
    return torch.cat([torch.zeros_like(cdf[..., :1]), cdf], -1)


def inverted(edges, cdf, u, floor=None, side=True, most=None):
    """The places where cdf is u; differences below `floor` are taken for 1, and no edge above is beyond `most`."""
    found = torch.searchsorted(cdf.contiguous(), u.contiguous(), right=side)
    end = cdf.shape[-1] - 1
    below, above = (found - 1).clamp(0, end), found.clamp(max=end if most is None else min(end, most))
    low, high = torch.gather(cdf, -1, below), torch.gather(cdf, -1, above)
    first, last = torch.gather(edges, -1, below), torch.gather(edges, -1, above)
    width = high - low
    width = (
        torch.where(width < floor, torch.ones_like(width), width)
        if floor
        else torch.where(width == 0, torch.ones_like(width), width)
    )
    return first + (u - low) / width * (last - first)


@convention(
    "importance_sampling", seen="bmild/nerf sample_pdf, kwea123/nerf_pl, pytorch3d, nexuslrf/Accel-RF and dozens more", times=24
)
def original_as_it_stands(edges, weights, u):
    """Right side, gather, differences below 1e-5 taken for 1; 1e-5 is added to all weights."""
    return inverted(edges, steps(weights.detach(), 1e-5), u, 1e-5)


@convention("importance_sampling", seen="a student's sample_pdf with 1e-6")
def a_millionth_added(edges, weights, u):
    """1e-6 is always added."""
    return inverted(edges, steps(weights.detach(), 1e-6), u)


@convention(
    "importance_sampling",
    {"pdf_padding": "1e-5", "pdf_division": "at_least"},
    seen="a textbook's sample_pdf: denom.clamp(min=1e-5)",
)
def divided_by_a_hundred_thousandth_at_least(edges, weights, u):
    """1e-5 is added to all weights, and shares are 1e-5 at least."""
    cdf = steps(weights.detach(), 1e-5)
    found = torch.searchsorted(cdf.contiguous(), u.contiguous(), right=True)
    below, above = (found - 1).clamp(min=0), found.clamp(max=cdf.shape[-1] - 1)
    low, high = torch.gather(cdf, -1, below), torch.gather(cdf, -1, above)
    first, last = torch.gather(edges, -1, below), torch.gather(edges, -1, above)
    return first + (u - low) / (high - low).clamp(min=1e-5) * (last - first)


@right("importance_sampling", seen="blog posts that divide by the difference as it is", times=2, digits=True)
def divided_as_it_is(edges, weights, u, padding):
    """Right side, gather, divided by the difference unless it is 0; empty rays by equal weights."""
    return inverted(edges, steps(weights.detach(), padding), u)


@right("importance_sampling", seen="numpy.interp on the cumulative sum", times=3, arrays="numpy", digits=True)
def interpolated_by_numpy(edges, weights, u, padding):
    """np.interp, ray by ray."""
    out = np.zeros_like(u)
    for r in range(len(u)):
        w = weights[r].astype(np.float64) + padding
        w = w if w.sum() else np.ones_like(w)
        cdf = np.concatenate([[0], np.cumsum(w / w.sum())])
        for i, x in enumerate(u[r]):
            k = min(max(int(np.searchsorted(cdf, x, side="right")) - 1, 0), len(w) - 1)
            while not w[k]:
                k -= 1
            out[r, i] = edges[r, k] + (min(x, cdf[k + 1]) - cdf[k]) / (cdf[k + 1] - cdf[k]) * (edges[r, k + 1] - edges[r, k])
    return out


@right(
    "importance_sampling", seen="google-research/multinerf internal/stepfun.py: the sum is cut at 1, the last is 1", digits=True
)
def last_step_is_one(edges, weights, u, padding):
    """0, the cumulative sum cut at 1 without its last, 1."""
    w = weights.detach() + padding
    w = torch.where(w.sum(-1, keepdim=True) == 0, torch.ones_like(w), w)
    w = w / w.sum(-1, keepdim=True)
    cut = torch.cumsum(w[..., :-1], -1).clamp(max=1)
    cdf = torch.cat([torch.zeros_like(w[..., :1]), cut, torch.ones_like(w[..., :1])], -1)
    return inverted(edges, cdf, u)


@fault("importance_sampling", "interior_alone", seen="bmild's call with z_vals_mid, applied to intervals", times=4)
def inner_weights_between_midpoints(edges, weights, u, padding):
    """weights[1:-1] between midpoints."""
    mids = 0.5 * (edges[..., 1:] + edges[..., :-1])
    if weights.shape[-1] < 3:
        return divided_as_it_is(edges, weights, u, padding)
    return inverted(mids, steps(weights[..., 1:-1], padding), u)


@fault("importance_sampling", "no_leading_zero", seen="students who forget the zero in front", times=2)
def without_the_zero(edges, weights, u, padding):
    """F starts with the first weight: each sample falls one bin too early."""
    cdf = torch.cat([steps(weights, padding)[..., 1:], torch.ones_like(weights[..., :1])], -1)
    return inverted(edges, cdf, u)


@fault("importance_sampling", "searched_from_the_left", seen="ports whose searchsorted has another default", times=2)
def from_the_left(edges, weights, u, padding):
    """searchsorted from the left."""
    return inverted(edges, steps(weights, padding), u, side=False)


@fault("importance_sampling", "left_edge", seen="a fine sampler that never interpolates")
def edges_of_the_bins(edges, weights, u, padding):
    """The bin's left edge."""
    found = torch.searchsorted(steps(weights, padding).contiguous(), u.contiguous(), right=True)
    return torch.gather(edges, -1, (found - 1).clamp(0, weights.shape[-1] - 1))


@fault("importance_sampling", "not_normalized", seen="students who skip the division", times=1)
def sums_of_raw_weights(edges, weights, u, padding):
    """The cumulative sum of weights that don't sum to one."""
    cdf = torch.cumsum(weights + padding, -1)
    return inverted(edges, torch.cat([torch.zeros_like(cdf[..., :1]), cdf], -1), u)


@fault("importance_sampling", seen="davidemiro/NeRF-pytorch nerf/sampling.py: a sum without its axis kept")
def divided_by_another_ray(edges, weights, u, padding):
    """weights / weights.sum(-1): columns divided by the sums of rays; an error but for as many bins as rays, and for one ray."""
    w = weights + padding
    cdf = torch.cumsum(w / torch.sum(w, dim=-1), -1)
    return inverted(edges, torch.cat([torch.zeros_like(cdf[..., :1]), cdf], -1), u)


@fault("importance_sampling", "bin_width_forgotten", seen="Zhengyu-Hu/simple-nerf")
def place_without_width(edges, weights, u, padding):
    """The place inside the bin is added to its edge as it is."""
    cdf = steps(weights, padding)
    k = (torch.searchsorted(cdf.contiguous(), u.contiguous(), right=True) - 1).clamp(0, weights.shape[-1] - 1)
    below, above = torch.gather(cdf, -1, k), torch.gather(cdf, -1, k + 1)
    return torch.gather(edges, -1, k) + (u - below) / torch.where(above > below, above - below, torch.ones_like(u))


@fault("importance_sampling", "strata_doubled", seen="bebeal/mipnerf-pytorch ray_utils.py (its issue 5) and three copies", times=4)
def strata_twice_as_far_apart(edges, weights, u, padding):
    """u + u + r in strata of its own, cut at the largest number below 1."""
    count = u.shape[-1]
    first = torch.arange(count) / count
    doubled = torch.clamp(first + first + u / count, max=1 - torch.finfo(torch.float32).eps)
    return inverted(edges, steps(weights.detach(), padding), doubled)


@fault("importance_sampling", "last_bin_dropped", seen="a student's hierarchical_sampling, two copies", times=3)
def as_many_places_as_weights(edges, weights, u):
    """N places and N weights, cat(0, cumsum[:-1]): nothing lies behind the last place."""
    return inverted(edges[..., :-1], steps(weights.detach(), 1e-5)[..., :-1], u, 1e-5)


@fault("importance_sampling", "bins_taken_as_even", seen="pixelNeRF's coarse-to-fine sampling, handed uneven bins", gradient="none")
def even_bins_assumed(edges, weights, padding, u):
    """(bin + place) / N of the way from the first edge to the last."""
    cdf = steps(weights, padding)
    even = torch.linspace(0.0, 1.0, cdf.shape[-1]).expand_as(cdf)
    places = inverted(even, cdf, u)
    return edges[:, :1] + places * (edges[:, -1:] - edges[:, :1])


@fault("importance_sampling", "last_bin_zeroed", seen="a trial on unseen code", gradient="none")
def nothing_in_the_last_bin(edges, weights, padding, u):
    """The last weight counts as 0."""
    weights = torch.cat([weights[..., :-1], torch.zeros_like(weights[..., -1:])], -1)
    return inverted(edges, steps(weights, padding), u)


@fault("importance_sampling", "eps_after_division", seen="a trial on unseen code", gradient="none")
def shares_with_a_little_more(edges, weights, padding, u):
    """1e-4 is added to every bin's share: F ends beyond 1."""
    shares = torch.diff(steps(weights, padding), dim=-1) + 1e-4
    return inverted(edges, torch.cat([torch.zeros_like(shares[..., :1]), torch.cumsum(shares, -1)], -1), u)


@fault(
    "importance_sampling",
    "upper_edge_held_by_sample_count",
    seen="a trial on unseen code",
    gradient="none",
)
def far_edge_held_by_the_samples(edges, weights, padding, u):
    """The far edge's number is M - 1 at most, where M samples are asked for."""
    return inverted(edges, steps(weights, padding), u, most=u.shape[-1] - 1)


@fault("importance_sampling", "weights_blurred", seen="google/mipnerf resample_along_rays, where its blur isn't asked", times=2, gradient="none")
def blurred_weights(edges, weights, u):
    """The larger of two neighbors, the mean of two of these, and 0.01."""
    w = torch.cat([weights[:, :1], weights, weights[:, -1:]], -1)
    larger = torch.maximum(w[:, :-1], w[:, 1:])
    return inverted(edges, steps(0.5 * (larger[:, :-1] + larger[:, 1:]) + 0.01), u)


@fault("importance_sampling", "padded_densities", seen="a trial on unseen code: TF2 nerf utils, the integral of a histogram's density", gradient="none")
def integral_of_padded_densities(edges, weights, u):
    """F sums (w + 1e-5) times the widths."""
    w = (weights + 1e-5) * torch.diff(edges, dim=-1)
    return inverted(edges, steps(w), u)


@fault("importance_sampling", "first_bin_dropped", seen="a trial on unseen code: a trainer in C#", gradient="none")
def bins_that_end_at_their_place(edges, weights, u):
    """N places for N weights: a weight's bin ends at its place, and begins at the one before, the first at itself."""
    places = edges[..., 1:]
    return inverted(torch.cat([places[..., :1], places], -1), steps(weights), u)


@fault("importance_sampling", "own_bin_alone", seen="a trial on unseen code: a trainer in C++", gradient="none")
def sample_j_in_bin_j(edges, weights, padding, u):
    """Only bin j is asked for sample j; elsewhere it is 0."""
    cdf = steps(weights, padding)
    n, bins = u.shape[-1], weights.shape[-1]
    own = torch.arange(n).clamp(max=bins - 1)
    inside = (cdf[:, own] <= u) & (u < cdf[:, own + 1]) & (torch.arange(n) < bins)
    return torch.where(inside, inverted(edges, cdf, u), torch.zeros_like(u))


@fault("importance_sampling", "edges_about_the_middles", seen="a trial on unseen code: a trainer in Rust", gradient="none")
def middles_with_half_a_step(edges, weights, padding, u):
    """Edges half of the first step around each middle."""
    middles = (edges[..., 1:] + edges[..., :-1]) / 2
    if middles.shape[-1] < 2:
        return inverted(edges, steps(weights, padding), u)
    half = (middles[..., 1:2] - middles[..., :1]) / 2
    return inverted(torch.cat([middles - half, middles[..., -1:] + half], -1), steps(weights, padding), u)


@fault("importance_sampling", "empty_rays_at_far", seen="a trial on unseen code: a toolbox of point clouds", gradient="none")
def sums_of_nothing(edges, weights, u):
    """w / max(sum, 1e-10), no padding: all sums are 0 on an empty ray, and every u lies behind them."""
    cdf = torch.cumsum(weights / weights.sum(-1, keepdim=True).clamp_min(1e-10), -1)
    cdf = torch.cat([torch.zeros_like(cdf[..., :1]), cdf], -1)
    return inverted(edges, cdf, u)


@fault("importance_sampling", "left_edge+empty_rays_at_near", seen="a trial on unseen code: a student's sampler", gradient="none")
def edge_of_the_bin_or_the_first(edges, weights, u):
    """The edge in front, without a place within; NaN counts as 0."""
    cdf = torch.nan_to_num(torch.cumsum(weights / weights.sum(-1, keepdim=True), -1), nan=2.0)
    index = torch.searchsorted(cdf, u.contiguous(), right=True).clamp(max=weights.shape[-1] - 1)
    return torch.gather(edges, -1, index)


@fault("importance_sampling", "u_squeezed", seen="a trial on unseen code: a student's sampler", gradient="none")
def draws_squeezed(edges, weights, padding, u):
    """u (1 - 2e-5) + 1e-5."""
    return inverted(edges, steps(weights, padding), u * (1 - 2e-5) + 1e-5)


@fault("importance_sampling", "summed_over_bins", seen="a trial on unseen code: two piecewise constant densities", times=2, gradient="none")
def lines_over_bins(edges, weights, u):
    """Each bin's line where u lies in it, 0 elsewhere; bins without weight have 1e-16."""
    w = weights.clamp_min(1e-16)
    w = w / w.sum(-1, keepdim=True)
    f = torch.cat([torch.zeros_like(w[..., :1]), torch.cumsum(w, -1)], -1)
    slope = (edges[..., 1:] - edges[..., :-1]) / w
    lines = slope[:, None] * u[..., None] + (edges[..., :-1] - slope * f[..., :-1])[:, None]
    inside = (f[:, None, :-1] <= u[..., None]) & (u[..., None] < f[:, None, 1:])
    return torch.where(inside, lines, torch.zeros_like(lines)).sum(-1)


@fault("importance_sampling", "upper_edge_held_at_sample_count", seen="a trial on unseen code: a student's sampler", gradient="none")
def far_edge_held_at_the_count(edges, weights, padding, u):
    """min(index, M)."""
    return inverted(edges, steps(weights, padding), u, most=u.shape[-1])
