"""The second implementation's compact components: truncated exponential, early stop, hash grid. See second.py."""

import numpy as np
import second_rendering as rendering


def shifted(x, c):
    """x, or x - 1."""
    return x - x.dtype.type(1) if c["exponent_shift"] == "one" else x


def trunc_exp(a, c, wrong):
    """e^x, or e^clamp(x, -15, 15), of x or x - 1."""
    x = shifted(a["x"], c)
    if c["exponent"] == "clamped":
        x = np.clip(x, -15, 15)
    if "clamped_above" in wrong:
        x = np.minimum(x, x.dtype.type(10))
    with np.errstate(over="ignore"):
        if "softplus" in wrong:
            return {"sigmas": np.logaddexp(x, x.dtype.type(0))}
        return {"sigmas": np.exp2(x) if "base_two" in wrong else np.exp(x)}


def trunc_exp_vjp(a, c, wrong):
    """The surrogate."""
    x = shifted(a["x"], c)
    held = c["exponent_gradient"]
    low, high = np.exp(x.dtype.type(-15)), np.exp(x.dtype.type(11 if held == "above11" else 15))
    with np.errstate(over="ignore", invalid="ignore"):
        slope = np.exp(x)
        if "gradient_not_clamped" in wrong:
            return {"grad_x": a["grad_sigmas"] * slope}
        if "limits_of_its_own" in wrong:
            return {"grad_x": a["grad_sigmas"] * np.clip(slope, x.dtype.type(1e-6), x.dtype.type(1e6))}
        if "value_clamped" in wrong:
            return {"grad_x": a["grad_sigmas"] * np.minimum(slope, x.dtype.type(15))}
        slope = np.clip(slope, low, high) if held == "both_ends" else np.minimum(slope, high)
        if "zero_outside" in wrong:
            slope = np.where(np.abs(x) > 15, x.dtype.type(0), slope)
    return {"grad_x": a["grad_sigmas"] * slope}


def live_of(weights, behind, carried, eps, stop, wrong):
    """How many samples a ray uses; `behind` is T behind each."""
    if "weight_tested" in wrong:
        low = np.flatnonzero(carried * weights < eps)
        return int(low[0]) + 1 if len(low) else len(weights)
    low = np.flatnonzero(carried * behind < eps)
    if not len(low):
        return len(behind)
    n = int(low[0]) + 1
    return {"behind": n, "in_front": n - 1, "one_more": min(n + 1, len(behind))}[stop]


def one_ray(a, first, n):
    """Some packed samples as a batch of one ray."""
    return {name: a[name][None, first : first + n] for name in ("sigmas", "rgbs", "deltas")}


def early_stop(a, c, wrong):
    """Ray by ray, by products of 1 - alpha."""
    shown = ["optical_depth_for_alpha"] if "optical_depth_for_alpha" in wrong else ()
    c = c | {"product_eps": "none", "backdrop": "none", "sigma_relu": "none", "opacity_sum": "all", "last_sample": "as_it_is"}
    ends = np.rint(a["offsets"]).astype(int)
    kind, carried = a["sigmas"].dtype.type, a["sigmas"].dtype.type(1)
    out = {"weights": np.zeros_like(a["sigmas"]), "live": [], "colors": [], "opacity": [], "transmittance": []}
    for first, end in zip(ends, ends[1:]):
        n = end if "ends_taken_for_counts" in wrong else end - first
        ray = one_ray(a, first, n)
        behind = np.cumprod(np.exp(-(ray["sigmas"] * ray["deltas"])), 1)[0]
        n = live_of(rendering.volume_render(ray, c, ())["weights"][0], behind, carried, a["eps"], c["stop"], wrong)
        ray = {name: carried * value[0] for name, value in rendering.volume_render(one_ray(a, first, n), c, shown).items()}
        left = ray["transmittance"]
        if ("renormalized" in wrong or c["stopped"] == "made_opaque") and left < a["eps"] and ray["opacity"] > 0:
            weights = ray["weights"] / ray["opacity"] if c["stopped"] == "made_opaque" else ray["weights"]
            ray |= {"colors": ray["colors"] / ray["opacity"], "weights": weights, "opacity": kind(1), "transmittance": kind(0)}
        if "clamped" in wrong:
            ray["colors"] = np.clip(ray["colors"], 0, 1)
        if "not_reset_between_rays" in wrong:
            carried = left
        n = min(n, end - first)
        out["weights"][first : first + n] = ray["weights"][:n]
        out["live"].append(kind(len(ray["weights"])))
        for name in ("colors", "opacity", "transmittance"):
            out[name].append(ray[name])
    return {name: np.asarray(value, a["sigmas"].dtype) for name, value in out.items()}


def before_division(ray, c):
    """Cotangents of a ray from those of its color and weights divided by its opacity."""
    out = rendering.volume_render(ray, c, ())
    whole, weights = out["opacity"][:, None], ray["grad_weights"]
    worth = ((ray["grad_colors"] * out["colors"]).sum(1) + (weights * out["weights"]).sum(1))[:, None] / whole
    none = np.zeros_like(ray["grad_opacity"])
    return {
        "grad_colors": ray["grad_colors"] / whole,
        "grad_weights": (weights - worth) / whole,
        "grad_opacity": none,
        "grad_transmittance": none,
    }


def early_stop_vjp(a, c, wrong):
    """The gradient of so many samples."""
    c = c | {"product_eps": "none", "backdrop": "none", "sigma_relu": "none", "opacity_sum": "all", "last_sample": "as_it_is"}
    ends = np.rint(a["offsets"]).astype(int)
    out = {f"grad_{name}": np.zeros_like(a[name]) for name in ("sigmas", "rgbs", "deltas")}
    for r, (first, end) in enumerate(zip(ends, ends[1:])):
        n = end - first
        if "gradient_behind_the_stop" not in wrong:
            behind = np.exp(-np.cumsum(a["sigmas"][first:end] * a["deltas"][first:end]))
            n = live_of(None, behind, 1, a["eps"], c["stop"], ())
        ray = one_ray(a, first, n) | {"grad_weights": a["grad_weights"][None, first : first + n]}
        for name in ("colors", "opacity", "transmittance"):
            ray[f"grad_{name}"] = a[f"grad_{name}"][r : r + 1]
        if "light_left_forgotten" in wrong:
            ray["grad_transmittance"] = np.zeros_like(ray["grad_transmittance"])
        if c["stopped"] == "made_opaque" and n and np.exp(-(ray["sigmas"] * ray["deltas"]).sum()) < a["eps"]:
            ray |= before_division(ray, c)
        for name, g in rendering.volume_render_vjp(ray, c, ()).items():
            out[name][first : first + n] = g[0]
        # Who stops in front of the sample that ends a ray has none to forget.
        stopped = n and np.exp(-(a["sigmas"] * a["deltas"])[first : first + n].sum()) < a["eps"]
        if "last_sample_learns_nothing" in wrong and stopped:
            for name in out:
                out[name][first + n - 1] = 0
    return out


def sizes_of(a, wrong):
    """The tables, and n of each level: base times the growth to the level's power."""
    tables = [a[f"table{n}"] for n in range(sum(name.startswith("table") for name in a))]
    steps = len(tables) if "growth_over_levels" in wrong else max(len(tables) - 1, 1)
    exact = a["base"] * (a["finest"] / a["base"]) ** (np.arange(len(tables)) / steps)
    exact = np.where(np.abs(exact - np.rint(exact)) < 1e-9 * exact, np.rint(exact), exact)
    return tables, np.ceil(exact) if "resolution_rounded_up" in wrong else exact


# Scale, shift and vertices along an edge of a level of n cells.
LAID = {
    "nearest": lambda n: (np.rint(n), 0, int(np.rint(n)) + 1),
    "floor": lambda n: (np.floor(n), 0, int(n) + 1),
    "tiny_cuda_nn": lambda n: (n - 1, 0.5, int(np.ceil(n - 1)) + 1),
    "torch_ngp": lambda n: (n - 1, 0.5, int(np.ceil(n - 1)) + 2),
    "align_corners": lambda n: (n - 1, 0, int(np.ceil(n - 1)) + 1),
}
PRIMES = {
    "coherent": [1, 2654435761, 805459861],
    "prime": [1958374283, 2654435761, 805459861],
    "reversed": [2165219737, 1434869437, 2097192037],
}


def entries_of(vertices, n, size, c, wrong):
    """The entries of integer vertices (..., 3)."""
    x, y, z = np.moveaxis(vertices.astype(np.uint64), -1, 0)
    side = LAID[c["hash_levels"]](n)[2]
    if side**3 <= size and c["hash_index"] != "hashed":
        side = np.uint64(side - 1 if "side_without_one" in wrong else side)
        x, z = (z, x) if "z_fastest" in wrong else (x, z)
        return (x + side * (y + side * z)).astype(int) % size
    primes = list(PRIMES[c["hash_primes"]])
    if "prime_mistyped" in wrong:
        primes[1] = 265443567
    if "primes_rolled" in wrong:
        primes = primes[1:] + primes[:1]
    x, y, z = (axis * np.uint64(prime) % np.uint64(2**32) for axis, prime in zip((x, y, z), primes))
    mixed = (x + y + z) % np.uint64(2**32) if "sum_for_xor" in wrong else x ^ y ^ z
    return mixed.astype(int) % (size - 1 if "modulo_one_less" in wrong else size)


CORNERS = np.array([[z, y, x] for x in (0, 1) for y in (0, 1) for z in (0, 1)])[:, ::-1]


def located(x, n, c, wrong):
    """Cells, weights of the upper side, and their slopes, (M, 3) each."""
    scale, shift, _ = LAID[c["hash_levels"]](n)
    last = int(np.floor(scale + shift)) - (c["hash_levels"] in ("nearest", "floor"))
    shift = shift + 0.5 * ("offset_half" in wrong)
    scaled = x * x.dtype.type(scale) + x.dtype.type(shift)
    cells = np.clip(np.floor(scaled), x.dtype.type(0), x.dtype.type(last))
    f = scaled - cells
    if "nearest_vertex" in wrong:
        f = (f >= 0.5).astype(x.dtype)
    if "weights_swapped" in wrong:
        f = 1 - f
    slope = np.full_like(f, scale)
    if c["hash_weights"] == "smoothstep":
        f, slope = f * f * (3 - 2 * f), slope * 6 * f * (1 - f)
    return cells.astype(int), f, slope


def sides_of(f):
    """The three factors of each corner's weight, (M, 8, 3)."""
    return np.where(CORNERS[None] == 1, f[:, None], 1 - f[:, None])


def hash_grid(a, c, wrong):
    """All points of a level at once."""
    out = []
    for table, n in zip(*sizes_of(a, wrong)):
        cells, f, _ = located(a["x"], n, c, wrong)
        at = entries_of(cells[:, None] + CORNERS, n, len(table), c, wrong)
        out.append(np.einsum("mk,mkf->mf", sides_of(f).prod(-1), table[at]))
    return {"encoding": np.concatenate(out, 1)}


def hash_grid_vjp(a, c, wrong):
    """np.add.at for the tables; for x the weights without one of their factors."""
    tables, sizes = sizes_of(a, ())
    parts = np.split(a["grad_encoding"], np.cumsum([table.shape[1] for table in tables])[:-1], 1)
    out, g_x = {}, 0
    for level, (table, n, g) in enumerate(zip(tables, sizes, parts)):
        cells, f, steep = located(a["x"], n, c, ())
        at, sides = entries_of(cells[:, None] + CORNERS, n, len(table), c, ()), sides_of(f)
        g_table, given = np.zeros_like(table), sides.prod(-1)[..., None] * g[:, None]
        if "collisions_overwrite" in wrong:
            for point, (where, what) in enumerate(zip(at, given)):
                # Two corners of one point may share an entry too: the contract's order, x fastest.
                for k in sorted(range(8), key=lambda k: tuple(CORNERS[k][::-1])):
                    g_table[where[k]] = what[k]
        else:
            np.add.at(g_table, at, given)
        out[f"grad_table{level}"] = g_table
        worth = np.einsum("mkf,mf->mk", table[at], g)
        others = [np.delete(sides, axis, 2).prod(-1) * np.where(CORNERS[:, axis] == 1, 1, -1) for axis in range(3)]
        slope = np.stack([(worth * other.astype(worth.dtype)).sum(1) for other in others], 1)
        scale = slope.dtype.type(LAID[c["hash_levels"]](n)[0])
        g_x = g_x + slope * (steep / scale if "resolution_forgotten" in wrong else steep)
    return out | {"grad_x": g_x}
