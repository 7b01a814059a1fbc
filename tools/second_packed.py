"""The second implementation's packed rays: by the ray of each sample; gradients by the whole triangle of factors. See second.py."""

import numpy as np


def ids_of(offsets):
    """The ray of each sample."""
    return np.repeat(np.arange(len(offsets) - 1), np.diff(np.asarray(offsets).astype(int)))


def without_empty(rows, counts):
    """Rays numbered anew without the empty ones, zeros at the end."""
    kept = rows[counts > 0]
    return np.concatenate([kept, np.zeros((len(rows) - len(kept), *rows.shape[1:]), rows.dtype)])


def pack_info(a, c, wrong):
    """By a search in the ids."""
    ids, rays = np.asarray(a["ray_ids"]).astype(int), np.arange(int(a["rays"]))
    starts, ends = np.searchsorted(ids, rays, "left"), np.searchsorted(ids, rays, "right")
    counts = ends - starts
    if "empty_rays_begin_at_0" in wrong:
        starts = np.where(counts == 0, 0, starts)
    if "ends_for_starts" in wrong:
        starts = ends
    if "empty_rays_skipped" in wrong:
        starts, counts = without_empty(starts, counts), without_empty(counts, counts)
    if "last_sample_not_counted" in wrong:
        counts = np.maximum(counts - 1, 0)
    return {"starts": starts, "counts": counts}


def packed_scan(a, c, wrong):
    """Sums and products over the samples that a mask of pairs leaves in."""
    x, ids = a["x"], ids_of(a["offsets"])
    same = np.ones((len(x), len(x)), bool) if "not_reset" in wrong else ids[:, None] == ids[None, :]
    order = np.arange(len(x))
    out = {}
    for name, mask in (("exclusive", order[None, :] < order[:, None]), ("inclusive", order[None, :] <= order[:, None])):
        mask = mask & same
        out[f"{name}_sum"] = np.where(mask, x[None, :], x.dtype.type(0)).sum(1, dtype=x.dtype)
        out[f"{name}_product"] = np.where(mask, x[None, :], x.dtype.type(1)).prod(1, dtype=x.dtype)
    for name in ("sum", "product"):
        if "inclusive_for_exclusive" in wrong:
            out[f"exclusive_{name}"] = out[f"inclusive_{name}"]
        if "first_not_reset" in wrong:
            out[f"exclusive_{name}"] = np.roll(out[f"inclusive_{name}"], 1)
    if "first_product_0" in wrong and len(x):
        out["exclusive_product"] = np.where(np.r_[True, ids[1:] != ids[:-1]], x.dtype.type(0), out["exclusive_product"])
    return out


def packed_scan_vjp(a, c, wrong):
    """The products' gradient by the product of all other factors, for each pair of samples."""
    x, ids = a["x"], ids_of(a["offsets"])
    joined = "gradient_not_reset" in wrong
    out = np.zeros_like(x)
    forward = packed_scan(a, c, ())
    for k in range(len(x)):
        end = len(x) if joined else int(np.searchsorted(ids, ids[k], "right"))
        start = int(np.searchsorted(ids, ids[k], "left"))
        behind = slice(k + 1, end)
        sums = a["grad_inclusive_sum"][k:end].sum() + a["grad_exclusive_sum"][behind].sum()
        if "gradient_forward" in wrong:
            sums = a["grad_inclusive_sum"][start : k + 1].sum() + a["grad_exclusive_sum"][start:k].sum()
        if "gradient_divided_by_clamped" in wrong or "gradient_divided" in wrong:
            total = (a["grad_inclusive_product"][k:end] * forward["inclusive_product"][k:end]).sum()
            total += (a["grad_exclusive_product"][behind] * forward["exclusive_product"][behind]).sum()
            with np.errstate(invalid="ignore"):
                products = total / (x[k] if "gradient_divided" in wrong else max(x[k], x.dtype.type(1e-10)))
        else:
            before = forward["exclusive_product"][k]
            inclusive = np.cumprod(np.r_[x.dtype.type(1), x[behind]])
            products = before * (a["grad_inclusive_product"][k:end] * inclusive).sum()
            products += before * (a["grad_exclusive_product"][behind] * inclusive[:-1]).sum()
        out[k] = sums + products
    return {"grad_x": out}


def accumulate_along_rays(a, c, wrong):
    """By index."""
    weights = np.ones_like(a["weights"]) if "weights_forgotten" in wrong else a["weights"]
    ids, terms = ids_of(a["offsets"]), weights[:, None] * a["values"]
    out = np.zeros((len(a["offsets"]) - 1, 3), terms.dtype)
    if "last_write_counts" in wrong:
        out[ids] = terms
    else:
        np.add.at(out, ids, terms)
    if "divided_by_weights" in wrong:
        totals = np.zeros(len(out), terms.dtype)
        np.add.at(totals, ids, weights)
        with np.errstate(invalid="ignore"):
            out = out / totals[:, None]
    if "empty_rays_skipped" in wrong:
        out = without_empty(out, np.diff(np.asarray(a["offsets"]).astype(int)))
    return {"sums": out}


def accumulate_along_rays_vjp(a, c, wrong):
    """Each sample has its ray's gradient."""
    g = a["grad_sums"][ids_of(a["offsets"])]
    products = g * a["values"]
    g_weights = products[:, 0] if "one_color_to_weights" in wrong else products.sum(1)
    if "weights_detached" in wrong:
        g_weights = np.zeros_like(g_weights)
    return {"grad_weights": g_weights, "grad_values": a["weights"][:, None] * g}
