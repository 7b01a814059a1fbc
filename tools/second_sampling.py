"""The second implementation's importance sampling, boxes and grids: searchsorted, all slabs at once, every cell a box. See second.py."""

import numpy as np


def distribution(weights, padding, kind):
    """F at the edges, by normalized weights."""
    padded = weights + kind(padding)
    if not padded.any():
        padded = np.ones_like(padded)
    return np.concatenate([np.zeros(1, kind), np.cumsum(padded / padded.sum(), dtype=kind)])


def padding_of(a, c):
    """What is added to the weights."""
    named = {"as_given": a["padding"], "none": 0.0}
    return named[c["pdf_padding"]] if c["pdf_padding"] in named else float(c["pdf_padding"])


def places(edges, f, u, c, wrong):
    """Bins by searchsorted, clamped to those with some weight, and the places inside them."""
    heavy = np.flatnonzero(np.diff(f) > 0)
    if not heavy.size:
        heavy = np.zeros(1, int)
    if "searched_from_the_left" in wrong:
        k = np.searchsorted(f, u, "left") - 1
    else:
        k = np.clip(np.searchsorted(f, u, "right") - 1, heavy[0], heavy[-1])
    below = np.clip(k, 0, len(f) - 1)
    above = np.clip(k + 1, 0, len(f) - 1)
    difference = f[above] - f[below]
    s = (u - f[below]) / share_of(difference, c)
    return below, above, s


def share_of(difference, c):
    """What a place in a bin is divided by."""
    kind = difference.dtype.type
    if c["pdf_division"] == "at_least":
        return np.maximum(difference, kind(1e-5))
    snapped = difference < 1e-5 if c["pdf_division"] == "snapped" else difference == 0
    return np.where(snapped, kind(1), difference)


def importance_sampling(a, c, wrong):
    """Ray by ray."""
    t = np.empty_like(a["u"])
    kind = t.dtype.type
    for r in range(len(t)):
        edges, weights = a["edges"][r], a["weights"][r]
        u = a["u"][0 if "one_u_for_all_rays" in wrong else r]
        if "interior_alone" in wrong and len(weights) > 2:
            edges, weights = (edges[1:] + edges[:-1]) / 2, weights[1:-1]
        if "weights_as_densities" in wrong:
            weights = weights * np.diff(edges)
        padding = padding_of(a, c)
        f = distribution(weights, padding, kind)
        if "not_normalized" in wrong:
            f = f * (weights + kind(padding)).sum()
            t[r] = np.where(u >= f[-1], edges[-1], take(edges, *places(edges, f, np.minimum(u, f[-1]), c, wrong)))
        elif "no_leading_zero" in wrong:
            k = np.searchsorted(f[1:], u, "right") - 1
            f = np.append(f[1:], f[-1])
            inner = np.clip(k, 0, len(edges) - 2)
            difference = f[inner + 1] - f[inner]
            s = (u - f[inner]) / np.where(difference == 0, kind(1), difference)
            t[r] = np.where(k < 0, edges[0], np.where(k > len(edges) - 2, edges[-1], edges[inner] + s * np.diff(edges)[inner]))
        else:
            below, above, s = places(edges, f, u, c, wrong)
            s = kind(0) * s if "left_edge" in wrong else kind(0) * s + kind(0.5) if "middle_of_bin" in wrong else s
            t[r] = edges[below] + s if "bin_width_forgotten" in wrong else take(edges, below, above, s)
            if "last_bin_dropped" in wrong:
                t[r] = np.where(below >= len(edges) - 2, edges[-2], t[r])
    return {"t": t}


def take(edges, below, above, s):
    """Between two edges, by weights."""
    return edges[below] * (1 - s) + edges[above] * s


def importance_sampling_vjp(a, c, wrong):
    """The gradient of the two edges and of u."""
    g_edges, g_u = np.zeros_like(a["edges"]), np.zeros_like(a["u"])
    for r, (edges, g) in enumerate(zip(a["edges"], a["grad_t"])):
        f = distribution(a["weights"][r], padding_of(a, c), edges.dtype.type)
        below, above, s = places(edges, f, a["u"][r], c, ())
        s = np.full_like(s, 0.5) if "edges_half_each" in wrong else s
        np.add.at(g_edges[r], below, g * (1 - s))
        np.add.at(g_edges[r], above, g * s)
        share = f[above] - f[below]
        share = share if c["pdf_division"] == "as_it_is" else share_of(share, c)
        g_u[r] = 0 if "place_detached" in wrong else g * ((edges[above] - edges[below]) / share)
    return {"grad_edges": g_edges, "grad_u": g_u}


def slabs(a, wrong):
    """Entry and exit of every slab, d = 0 apart, and whether the ray runs beside one."""
    o, d, low, high = a["rays_o"], a["rays_d"], a["low"], a["high"]
    kind = o.dtype.type
    if "unit_directions" in wrong:
        length = np.sqrt((d * d).sum(1, keepdims=True))
        d = d / np.where(length == 0, kind(1), length)
    if "center_and_size" in wrong:
        low, high = low - high / 2, low + high / 2
    if "eps_in_direction" in wrong:
        d = d + kind(1e-6)
    if "tiny_taken_for_parallel" in wrong:
        d = np.where(np.abs(d) < kind(1e-6), 0, d)
    flat = d == 0
    with np.errstate(over="ignore"):
        inverse = 1 / np.where(flat, kind(1), d)
        x, y = (low - o) * inverse, (high - o) * inverse
    first, last = (x, y) if "sign_ignored" in wrong else (np.minimum(x, y), np.maximum(x, y))
    if "sign_ignored" not in wrong and "eps_in_direction" in wrong:
        first, last = np.where(d > 0, x, y), np.where(d > 0, y, x)
    face = flat & ((o == low) | (o == high))
    beside = flat & ((o < low) | (o > high))
    if "face_is_a_miss" in wrong:
        beside |= face
    if "parallel_is_a_miss" in wrong:
        beside |= flat
    return first, last, flat, beside.any(1)


def ray_aabb(a, c, wrong):
    """The largest entry, the smallest exit."""
    first, last, flat, beside = slabs(a, wrong)
    kind = first.dtype.type
    near, far = kind(a["near"]), kind(a["far"])
    enter = np.where(flat, kind(-np.inf), first).max(1)
    leave = np.where(flat, kind(np.inf), last).min(1)
    if "first_slab" in wrong:
        low, high = np.where(flat, kind(np.inf), first).min(1), np.where(flat, kind(-np.inf), last).max(1)
        enter, leave = np.where(low < high, low, enter), np.where(low < high, high, leave)
    t_near = enter if "near_ignored" in wrong else np.maximum(enter, near)
    t_far = leave if "far_ignored" in wrong else np.minimum(leave, far)
    hit = ~beside & (enter <= leave if "behind_is_a_hit" in wrong else t_near <= t_far)
    t_near = enter if "near_asked_not_cut" in wrong else t_near
    return {"t_near": np.where(hit, t_near, far), "t_far": np.where(hit, t_far, far), "hit": hit.astype(kind)}


def ray_aabb_vjp(a, c, wrong):
    """-g / d on the axis that decides, and -g t / d."""
    first, last, flat, _ = slabs(a, ())
    kind, hit = first.dtype.type, ray_aabb(a, c, ())["hit"] > 0
    g_o, g_d = np.zeros_like(a["rays_o"]), np.zeros_like(a["rays_d"])
    for t, sign, cut, name in ((first, 1, a["near"], "grad_t_near"), (last, -1, a["far"], "grad_t_far")):
        ends = np.where(flat, kind(-sign * np.inf), t) * sign
        axis = ends.argmax(1)
        rows = np.arange(len(axis))
        t = ends[rows, axis] * sign
        # An end that the range decides has no gradient.
        moves = hit & np.isfinite(t) & ((sign * t > sign * cut) | ("gradient_where_cut" in wrong))
        rows, axis, t = rows[moves], axis[moves], t[moves]
        share = a[name][moves] / a["rays_d"][rows, axis]
        g_o[rows, axis] -= share
        g_d[rows, axis] -= share * t
    return {"grad_rays_o": g_o, "grad_rays_d": 0 * g_d if "direction_forgotten" in wrong else g_d}


def cells(points, n, wrong):
    """Index triples [z, y, x]."""
    points = points + 0.5 / n if "nearest_cell" in wrong else points
    index = np.clip(np.floor(points * n), 0, n - 1).astype(int)
    return tuple((index if "axes_reversed" in wrong else index[:, ::-1]).T)


def mean_or(density, threshold, convention, wrong):
    """The smaller of the threshold and the mean of what is there; below all cells that are seen where none is above that."""
    if "mean_of_all" not in wrong and convention == "limit_alone":
        return threshold
    seen = {"mean_of_seen": density[density >= 0], "mean_over_all": np.maximum(density, 0)}
    known = density if "mean_of_all" in wrong else seen.get(convention, density[density > 0])
    level = min(threshold, known.mean(dtype=density.dtype)) if known.size else threshold
    if "mean_of_all" in wrong or convention != "mean_of_dense" or (known > level).any():
        return level
    return -1


def occupancy_grid(a, c, wrong):
    """Scattered by maximum.at."""
    kind, n = a["density"].dtype.type, len(a["density"])
    decay, threshold = kind(a["decay"]), kind(a["threshold"])
    at, sigmas = cells(a["points"], n, wrong), a["sigmas"]
    seen = np.full_like(a["density"], -np.inf)
    if "last_point_wins" in wrong:
        seen[at] = sigmas
    elif "points_added" in wrong:
        touched = np.zeros_like(seen)
        np.add.at(touched, at, sigmas)
        seen[at] = touched[at]
    else:
        np.maximum.at(seen, at, sigmas)
    before, some = a["density"], np.isfinite(seen)
    sigma, decayed = np.where(some, seen, kind(0)), decay * a["density"]
    density = np.maximum(decayed, sigma)
    if "density_replaced" in wrong:
        density = sigma
    if "moving_average" in wrong:
        density = decayed + (1 - decay) * sigma
    if "rise_decays" in wrong:
        density = np.maximum(decayed, decay * sigma)
    density = np.where(some, density, decayed if c["grid_decay"] == "every_cell" else before)
    if c["grid_unseen"] == "kept":
        density = np.where(before < 0, before, density)
    source = before if "occupied_before" in wrong else density
    level = mean_or(source, threshold, c["grid_threshold"], wrong)
    occupied = (source >= level if "threshold_included" in wrong else source > level).astype(kind)
    return {"density_out": density, "occupied": occupied, "found": occupied[cells(a["queries"], n, wrong)]}


def grid_traversal(a, c, wrong):
    """Every cell as a box of its own; the outermost ones reach to infinity."""
    o, d, n = a["rays_o"], a["rays_d"], int(a["resolution"])
    kind = o.dtype.type
    near, far = kind(0 if "near_ignored" in wrong else a["near"]), np.full(len(o), a["far"], kind)
    with np.errstate(divide="ignore", invalid="ignore"):
        if "far_ignored" in wrong:
            end = ((d > 0) - o) / d
            far = np.where(end > near, end, kind(np.inf)).min(1).astype(kind)
        outwards = ((o == 0) & (d < 0) | (o == 1) & (d > 0)).any(1) & ("left_at_a_face" in wrong)
        o = o + kind(0.5 / n) if "nearest_cell" in wrong else o
        if "equal_steps" in wrong:
            return stepped(o, d, near, far, n)
        faces = (np.arange(n + 1, dtype=kind) / kind(n))[:, None]
        t = (faces - o[:, None]) / d[:, None]
        t[:, 0], t[:, n] = -np.inf * np.sign(d), np.inf * np.sign(d)
        first, last = np.minimum(t[:, :-1], t[:, 1:]), np.maximum(t[:, :-1], t[:, 1:])
    low, high = np.repeat(faces[:-1], 3, 1), np.repeat(faces[1:], 3, 1)
    low[0], high[-1] = -np.inf, np.inf
    inside, flat = (low <= o[:, None]) & (o[:, None] < high), (d == 0)[:, None]
    first = np.where(flat, np.where(inside, -np.inf, np.inf), first)
    last = np.where(flat, np.where(inside, np.inf, -np.inf), last)
    enter = np.maximum(np.maximum(first[:, None, None, :, 0], first[:, None, :, None, 1]), first[:, :, None, None, 2])
    leave = np.minimum(np.minimum(last[:, None, None, :, 0], last[:, None, :, None, 1]), last[:, :, None, None, 2])
    enter, leave = np.maximum(enter, near), np.minimum(leave, far[:, None, None, None])
    lengths = np.maximum(leave - enter, 0).astype(kind)
    lengths[outwards] = 0
    visited = np.where(outwards, 1, (lengths > 0).sum((1, 2, 3)))
    if "first_cell_missing" in wrong:
        for ray, begin, count in zip(lengths, np.where(lengths > 0, enter, np.inf).reshape(len(o), -1).argmin(1), range(len(o))):
            ray.flat[begin] = 0
            visited[count] -= 1
    if "axes_reversed" in wrong:
        lengths = lengths.transpose(0, 3, 2, 1)
    if "unit_directions" in wrong:
        lengths = lengths * np.sqrt((d * d).sum(1))[:, None, None, None]
    return {"lengths": np.ascontiguousarray(lengths), "visited": visited.astype(kind)}


def stepped(o, d, near, far, n):
    """Steps of half a cell, each for the cell it begins in."""
    kind = o.dtype.type
    lengths = np.zeros((len(o), n, n, n), kind)
    for ray, x, v, end in zip(lengths, o, d, far):
        step, t = kind(0.5 / n) / np.sqrt((v * v).sum()), near
        while t < end:
            ray[cells((x + t * v)[None], n, ())] += min(step, end - t)
            t = t + step
    return {"lengths": lengths, "visited": (lengths > 0).sum((1, 2, 3)).astype(kind)}
