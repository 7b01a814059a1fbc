"""What a proposal fails to cover: the interlevel loss."""

import torch
from entry import convention, fault, right


def outer(t, s, v, behind=0):
    """Weight of the intervals that overlap, from running sums and places of edges."""
    sums = torch.cat([torch.zeros_like(v[:, :1]), v.cumsum(-1)], -1)
    place = torch.searchsorted(s.contiguous(), t.contiguous(), right=True)
    first, last = (place[:, :-1] - 1).clamp(min=0), place[:, 1:].clamp(max=v.shape[1]) + behind
    return sums.gather(1, last) - sums.gather(1, first)


def excess(weights, bound):
    """max(0, w - bound)^2."""
    return (weights - bound).clamp(min=0) ** 2


@right("interlevel_loss", seen="google-research/multinerf internal/stepfun.py lossfun_outer, eps as handed", times=3, digits=True)
def running_sums(weights, t, proposal_weights, proposal_t, eps):
    """Differences of running sums."""
    return (excess(weights, outer(t, proposal_t, proposal_weights)) / (weights + eps)).mean(-1)


@right("interlevel_loss", seen="ports that compare all pairs of intervals")
def all_pairs(weights, t, proposal_weights, proposal_t, eps):
    """A mask of overlaps times the proposal."""
    begins = proposal_t[:, None, :-1] <= t[:, 1:, None]
    ends = t[:, :-1, None] < proposal_t[:, None, 1:]
    bound = ((begins & ends) * proposal_weights[:, None]).sum(-1)
    return (excess(weights, bound) / (weights + eps)).mean(-1)


@convention(
    "interlevel_loss",
    {"interlevel_eps": "float32"},
    seen="google-research/multinerf internal/stepfun.py lossfun_outer: eps of float32",
    times=3,
    digits=True,
)
def eps_of_float32(weights, t, proposal_weights, proposal_t):
    """w + 1.19e-7."""
    bound = outer(t, proposal_t, proposal_weights)
    return (excess(weights, bound) / (weights + torch.finfo(torch.float32).eps)).mean(-1)


@convention(
    "interlevel_loss",
    {"interlevel_eps": "1e-7"},
    seen="nerfstudio model_components/losses.py; nerfacc estimators/prop_net.py _pdf_loss",
    times=5,
    digits=True,
)
def eps_of_nerfstudio(weights, t, proposal_weights, proposal_t):
    """w + 1e-7."""
    return (excess(weights, outer(t, proposal_t, proposal_weights)) / (weights + 1e-7)).mean(-1)


@convention(
    "interlevel_loss",
    {"interlevel_reduction": "sum"},
    seen="ports that add up along rays",
    times=2,
    digits=True,
)
def summed_along_rays(weights, t, proposal_weights, proposal_t, eps):
    """The sum over intervals."""
    return (excess(weights, outer(t, proposal_t, proposal_weights)) / (weights + eps)).sum(-1)


@convention("interlevel_loss", {"outer_edges": "inside"}, seen="ports that compare both ends strictly")
def strictly_inside(weights, t, proposal_weights, proposal_t, eps):
    """Intervals that touch don't overlap."""
    overlaps = (proposal_t[:, None, :-1] < t[:, 1:, None]) & (t[:, :-1, None] < proposal_t[:, None, 1:])
    return (excess(weights, (overlaps * proposal_weights[:, None]).sum(-1)) / (weights + eps)).mean(-1)


@fault("interlevel_loss", "end_left_out", seen="searches that are one off", gradient="none")
def search_one_off(weights, t, proposal_weights, proposal_t, eps):
    """The last edge is the one in front of the interval's end."""
    bound = outer(t, proposal_t, proposal_weights, -1).clamp(min=0)
    return (excess(weights, bound) / (weights + eps)).mean(-1)


@fault("interlevel_loss", "both_signs", seen="the squared difference without its limit", gradient="none")
def without_the_limit(weights, t, proposal_weights, proposal_t, eps):
    """(w - bound)^2."""
    bound = outer(t, proposal_t, proposal_weights)
    return ((weights - bound) ** 2 / (weights + eps)).mean(-1)


@fault("interlevel_loss", "division_forgotten", seen="the squared excess alone", gradient="none")
def without_the_division(weights, t, proposal_weights, proposal_t):
    """max(0, w - bound)^2."""
    return excess(weights, outer(t, proposal_t, proposal_weights)).mean(-1)


@convention("interlevel_loss", {"interlevel_eps": "1e-8"}, seen="a trial on unseen code: ports in PyTorch", times=2, digits=True)
def eps_of_ports(weights, t, proposal_weights, proposal_t):
    """w + 1e-8."""
    return (excess(weights, outer(t, proposal_t, proposal_weights)) / (weights + 1e-8)).mean(-1)


@fault("interlevel_loss", "both_exchanged+paired_by_number", seen="a trial on unseen code: a port for a studio's template")
def excess_of_the_proposal(weights, proposal_weights):
    """max(0, w' - w)^2 / (w' + 1e-7) of interval i and interval i, as many as both have."""
    n = min(weights.shape[1], proposal_weights.shape[1])
    w, p = weights[:, :n], proposal_weights[:, :n]
    return (excess(p, w) / (p + 1e-7)).mean(-1)


@fault("interlevel_loss", "eps_of_its_own", seen="a trial on unseen code: losses of photographs in the wild")
def millionth_in_the_denominator(weights, t, proposal_weights, proposal_t):
    """1e-6, whatever eps is."""
    return (excess(weights, outer(t, proposal_t, proposal_weights)) / (weights + 1e-6)).mean(-1)
