"""The second implementation's distortion and interlevel losses: matrices of distances, and of overlaps. See second.py."""

import numpy as np


def distortion_loss(a, c, wrong):
    """All pairs at once."""
    w, t = a["weights"], a["t"] - a["t"][:, :1]
    kind = w.dtype.type
    middles = t[:, :-1] if "edges_for_middles" in wrong else (t[:, 1:] + t[:, :-1]) / 2
    apart = middles[:, :, None] - middles[:, None, :]
    apart = apart if "signs_kept" in wrong else np.abs(apart)
    pairs = np.einsum("ri,rij,rj->r", w, apart, w).astype(w.dtype)
    pairs = pairs / 2 if "pairs_once" in wrong else pairs
    own = ((w if "own_weight_once" in wrong else w * w) * np.diff(t)).sum(1)
    own = own * kind(0 if "own_forgotten" in wrong else 1 if "third_forgotten" in wrong else 1 / 3)
    loss = pairs + own
    return {"loss": loss / w.shape[1] if "mean_of_intervals" in wrong else loss}


def distortion_loss_vjp(a, c, wrong):
    """Matrices of distances and of signs."""
    w, t, g = a["weights"], a["t"] - a["t"][:, :1], a["grad_loss"][:, None]
    kind = w.dtype.type
    middles = (t[:, 1:] + t[:, :-1]) / 2
    apart = middles[:, :, None] - middles[:, None, :]
    pairs = np.einsum("rij,rj->ri", np.abs(apart), w) * kind(1 if "other_weight_held" in wrong else 2)
    share = kind(0 if "own_gradient_dropped" in wrong else 1)
    g_w = g * (pairs + share * kind(2 / 3) * w * np.diff(t))
    of_middle = g * w * np.einsum("rij,rj->ri", np.sign(apart), w)
    of_length = share * g * w * w / 3
    g_t = np.zeros_like(t)
    first, last = (2, 0) if "middle_to_one_edge" in wrong else (1, 1)
    g_t[:, :-1] += kind(first) * of_middle - of_length
    g_t[:, 1:] += kind(last) * of_middle + of_length
    return {"grad_weights": g_w, "grad_t": g_t}


def covers(a, c, wrong=()):
    """Which intervals of the proposal overlap which of the field: (R, N, M)."""
    (t, s) = (a[name][:, :, None] if name == "t" else a[name][:, None, :] for name in ("t", "proposal_t"))
    begins = s[:, :, :-1] <= t[:, 1:] if c["outer_edges"] == "touching" else s[:, :, :-1] < t[:, 1:]
    over = begins & (t[:, :-1] < s[:, :, 1:])
    if "inner_for_outer" in wrong:
        over = over & (t[:, :-1] <= s[:, :, :-1]) & (s[:, :, 1:] <= t[:, 1:])
    if "end_left_out" in wrong:
        # Of each interval, all but the last that overlaps.
        over = over & (np.cumsum(over[:, :, ::-1], 2)[:, :, ::-1] > 1)
    return over


def eps_of(a, c):
    """What is added to the weight."""
    eps = {"as_given": float(a["eps"]), "float32": 2.0**-23, "1e-7": 1e-7, "1e-8": 1e-8}[c["interlevel_eps"]]
    return a["weights"].dtype.type(eps)


def interlevel_loss(a, c, wrong):
    """A matrix of overlaps times the proposal."""
    w, v, over = a["weights"], a["proposal_weights"], covers(a, c, wrong)
    share = over.astype(w.dtype)
    if "share_for_bound" in wrong:
        t, s = a["t"][:, :, None], a["proposal_t"][:, None, :]
        length = s[:, :, 1:] - s[:, :, :-1]
        inside = np.maximum(np.minimum(t[:, 1:], s[:, :, 1:]) - np.maximum(t[:, :-1], s[:, :, :-1]), 0)
        share = np.where(over, np.where(length > 0, inside / np.where(length > 0, length, 1), 1), 0).astype(w.dtype)
    bound = np.einsum("rij,rj->ri", share, v).astype(w.dtype)
    missing = w - bound if "both_signs" in wrong else np.maximum(w - bound, 0)
    square = missing if "square_forgotten" in wrong else missing * missing
    below = (bound if "divided_by_the_bound" in wrong else w) + eps_of(a, c)
    terms = square if "division_forgotten" in wrong else np.where(missing == 0, 0, square / below)
    return {"loss": (terms.sum(1) if c["interlevel_reduction"] == "sum" else terms.mean(1)).astype(w.dtype)}


def interlevel_loss_vjp(a, c, wrong):
    """The transposed matrix times what is missing."""
    w, v, over = a["weights"], a["proposal_weights"], covers(a, c)
    missing = np.maximum(w - np.einsum("rij,rj->ri", over, v).astype(w.dtype), 0)
    size = 1 if c["interlevel_reduction"] == "sum" else w.shape[1]
    factor = (1 if "factor_two_missing" in wrong else 2) * (1 if "gradient_negated" in wrong else -1)
    share = w.dtype.type(factor) * a["grad_loss"][:, None] * missing / (w + eps_of(a, c)) / w.dtype.type(size)
    if "shared_among_overlaps" in wrong:
        share = share / np.maximum(over.sum(2), 1).astype(w.dtype)
    if "first_alone" in wrong:
        over = over & (np.cumsum(over, 2) == 1)
    return {"grad_proposal_weights": np.einsum("rij,ri->rj", over, share).astype(w.dtype)}
