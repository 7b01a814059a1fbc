"""From a proposal's weights to the next level's intervals."""

import torch
from entry import convention, fault, right
from importance import inverted, steps

EPS = 1e-5


def widths(edges):
    """Whether bins have a width."""
    return edges[..., 1:] > edges[..., :-1]


def logits(edges, weights, anneal, padding):
    """What multinerf hands to its softmax."""
    return torch.where(widths(edges), anneal * torch.log(weights + padding), torch.full_like(weights, -torch.inf))


def raised(weights):
    """Shares of a histogram whose sum is raised to 1e-5."""
    total = weights.sum(-1, keepdim=True)
    missing = torch.relu(EPS - total)
    return (weights + missing / weights.shape[-1]) / (total + missing)


@fault(
    "proposal_pdf",
    "logarithm_of_nothing",
    seen="google-research/multinerf internal/models.py and ports: padding 0, then empty rays are NaN",
    times=9,
)
def softmax_of_minus_infinities(edges, weights, anneal, padding):
    """A softmax of anneal log(w + padding): 0 times a logarithm of 0, and rays without any weight, are NaN."""
    return torch.softmax(logits(edges, weights, anneal, padding), -1)


@right("proposal_pdf", seen="a port of multinerf whose rays of minus infinities are set to 1", digits=True)
def softmax_with_empty_rays(edges, weights, anneal, padding):
    """The same; in the beginning all bins are alike, and so are those of an empty ray."""
    begin = torch.zeros_like(weights).masked_fill(~widths(edges), -torch.inf)
    found = logits(edges, weights, anneal, padding) if anneal else begin
    found[(found <= -torch.inf).all(-1)] = 1
    return torch.softmax(found, -1)


@convention(
    "proposal_pdf",
    {"anneal_padding": "after"},
    seen="nerfstudio model_components/ray_samplers.py: weights ** anneal, then PDFSampler",
    digits=True,
)
def padded_after_the_power(weights, anneal, padding):
    """w^anneal + padding; what is missing to 1e-5 is shared."""
    return raised(torch.pow(weights, anneal) + padding)


@convention(
    "proposal_pdf",
    {"histogram_floor": "1e-5"},
    seen="google/mipnerf internal/math.py sorted_piecewise_constant_pdf; annealed in a port of multinerf",
    times=2,
    digits=True,
)
def padded_before_the_power(weights, anneal, padding):
    """(w + padding)^anneal; what is missing to 1e-5 is shared."""
    return raised(torch.pow(weights + padding, anneal))


@fault("proposal_pdf", "anneal_forgotten", seen="ports of multinerf without an exponent", times=2)
def without_annealing(edges, weights, anneal, padding):
    """log(w + padding), whatever the step is."""
    found = logits(edges, weights, 1.0, padding)
    found[(found <= -torch.inf).all(-1)] = 1
    return torch.softmax(found, -1)


@fault("proposal_pdf", "softmax_of_weights", seen="not met in this reading: weights in the place of logits", times=0)
def weights_for_logits(edges, weights, anneal, padding):
    """A softmax of weights."""
    return torch.softmax(torch.where(widths(edges), anneal * (weights + padding), torch.full_like(weights, -torch.inf)), -1)


def samples(edges, weights, u):
    """Points by their inverse."""
    return inverted(edges, steps(weights), u)


def around(c, low, high):
    """Midpoints, and the outermost mirrored."""
    middle = (c[..., 1:] + c[..., :-1]) / 2
    first, last = 2 * c[..., :1] - middle[..., :1], 2 * c[..., -1:] - middle[..., -1:]
    return torch.cat([torch.maximum(first, low), middle, torch.minimum(last, high)], -1)


@right("resample_edges", seen="google-research/multinerf internal/stepfun.py sample_intervals and ports", times=5, digits=True)
def midpoints_mirrored(edges, weights, u):
    """Midpoints, mirrored at both ends, clamped to the domain."""
    return around(samples(edges, weights, u), edges[..., :1], edges[..., -1:])


@right("resample_edges", seen="nerfstudio-project/nerfacc nerfacc/cuda/csrc/pdf.cu: half of a step to both sides", digits=True)
def half_steps(edges, weights, u):
    """t - half the step to the next, t + half the step from the one before."""
    c = samples(edges, weights, u)
    half = (c[..., 1:] - c[..., :-1]) * 0.5
    first = torch.maximum(c[..., :1] - half[..., :1], edges[..., :1])
    last = torch.minimum(c[..., -1:] + half[..., -1:], edges[..., -1:])
    return torch.cat([first, (c[..., 1:] + c[..., :-1]) * 0.5, last], -1)


@convention(
    "resample_edges",
    {"edges_from": "samples"},
    seen="nerfstudio PDFSampler(include_original=False); google/mipnerf",
    times=2,
    digits=True,
)
def samples_for_edges(edges, weights, u):
    """Places that are clipped to their bin; NaN is 0."""
    cdf = steps(weights)
    found = torch.searchsorted(cdf.contiguous(), u.contiguous(), side="right")
    below, above = (found - 1).clamp(0, edges.shape[-1] - 1), found.clamp(0, edges.shape[-1] - 1)
    low, high = cdf.gather(-1, below), cdf.gather(-1, above)
    first, last = edges.gather(-1, below), edges.gather(-1, above)
    return first + ((u - low) / (high - low)).nan_to_num(0).clip(0, 1) * (last - first)


@convention(
    "resample_edges",
    {"edges_from": "samples", "old_edges": "kept"},
    seen="nerfstudio PDFSampler, as it comes",
    digits=True,
)
def with_the_old_edges(edges, weights, u):
    """sort(cat([old, new]))."""
    return torch.sort(torch.cat([edges, samples(edges, weights, u)], -1), -1).values


@fault("resample_edges", "ends_not_clamped", seen="sample_intervals without a domain: its default is all numbers", times=0)
def any_domain(edges, weights, u):
    """Mirrored edges as they come."""
    ends = torch.full_like(edges[..., :1], torch.inf)
    return around(samples(edges, weights, u), -ends, ends)


@fault("resample_edges", "no_leading_zero", seen="students who forget the zero in front, of points", times=2)
def a_bin_too_far(edges, weights, u):
    """F starts with the first weight."""
    cdf = torch.cat([steps(weights)[..., 1:], torch.ones_like(weights[..., :1])], -1)
    return around(inverted(edges, cdf, u), edges[..., :1], edges[..., -1:])


@fault("resample_edges", "interior_alone", seen="bmild's call with z_vals_mid, applied to intervals, of points", times=4)
def inner_weights_alone(edges, weights, u):
    """weights[1:-1] between midpoints."""
    if weights.shape[-1] < 3:
        return midpoints_mirrored(edges, weights, u)
    middle = 0.5 * (edges[..., 1:] + edges[..., :-1])
    return around(inverted(middle, steps(weights[..., 1:-1]), u), edges[..., :1], edges[..., -1:])
