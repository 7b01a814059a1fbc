"""The second implementation's distortion loss: matrices of distances, about each ray's first edge. See second.py."""

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
