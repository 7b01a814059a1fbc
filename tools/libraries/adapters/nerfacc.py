"""nerfacc on a CPU: the functions that it has in torch. Its packed scans, `pack_info`, sampling and traversal are CUDA's alone,
so that scans of rays with different numbers of samples run ray by ray here."""

import nerfacc
import torch
from entry import answers, replaced
from nerfacc.grid import _query, _ray_aabb_intersect
from nerfacc.pdf import _sample_from_weighted
from torch.nn.functional import pad


def rendered(deltas, rgbs, **fields):
    """rendering, with an empty sample behind the last one, whose transmittance is what is left behind the ray."""
    ends, rgbs = pad(deltas, (0, 1)), pad(rgbs, (0, 0, 0, 1))
    (name, values), = fields.items()  # fmt: skip
    colors, opacity, _, extras = nerfacc.rendering(torch.zeros_like(ends), ends, **{name: lambda *_: (rgbs, pad(values, (0, 1)))})
    return colors, extras["weights"][:, :-1], opacity[:, 0], extras["trans"][:, -1]


@answers("nerfacc", "volume_render", "rendering(rgb_sigma_fn)")
def volume_render(sigmas, rgbs, deltas):
    """Steps begin at 0, so that t_ends - t_starts are the deltas."""
    return rendered(deltas, rgbs, rgb_sigma_fn=sigmas)


@answers("nerfacc", "volume_render_alpha", "rendering(rgb_alpha_fn)")
def volume_render_alpha(alphas, rgbs):
    """t is needed for its depth alone."""
    return rendered(torch.zeros_like(alphas), rgbs, rgb_alpha_fn=alphas)


def bounds(offsets):
    """Where rays begin and end."""
    return [int(n) for n in offsets]


def by_ray(offsets, x, function):
    """A function of one ray's samples, ray by ray."""
    return torch.cat([x[:0], *(function(x[a:b]) for a, b in zip(bounds(offsets), bounds(offsets)[1:]))])


@answers("nerfacc", "packed_scan", "exclusive_sum, inclusive_sum, exclusive_prod, inclusive_prod, ray by ray")
def packed_scan(offsets, x):
    """Without packed_info, which needs CUDA."""
    scans = nerfacc.exclusive_sum, nerfacc.inclusive_sum, nerfacc.exclusive_prod, nerfacc.inclusive_prod
    return tuple(by_ray(offsets, x, scan) for scan in scans)


def ray_ids(offsets):
    """The ray of each sample."""
    return torch.repeat_interleave(torch.arange(len(offsets) - 1), offsets.diff().long())


@answers("nerfacc", "accumulate_along_rays", "accumulate_along_rays(ray_indices)")
def accumulate_along_rays(offsets, weights, values):
    """Packed, which this one does on a CPU too."""
    return nerfacc.accumulate_along_rays(weights, values, ray_ids(offsets), len(offsets) - 1)


@answers("nerfacc", "early_stop", "render_visibility_from_density, rendering of what is visible")
def early_stop(sigmas, rgbs, deltas, offsets, eps):
    """As OccGridEstimator.sampling drops what lies behind, before anything is rendered."""
    live, colors, weights, opacity, left = [], [], [], [], []
    for a, b in zip(bounds(offsets), bounds(offsets)[1:]):
        ray = slice(a, b)
        seen = nerfacc.render_visibility_from_density(torch.zeros_like(deltas[ray]), deltas[ray], sigmas[ray], early_stop_eps=eps)
        c, w, o, t = volume_render(sigmas[ray][seen][None], rgbs[ray][seen][None], deltas[ray][seen][None])
        whole = torch.zeros_like(sigmas[ray])
        weights.append(whole.masked_scatter(seen, w[0]))
        live.append(seen.sum().to(sigmas))
        colors.append(c[0])
        opacity.append(o[0])
        left.append(t[0])
    return torch.stack(live), torch.stack(colors), torch.cat(weights), torch.stack(opacity), torch.stack(left)


@answers(
    "nerfacc",
    "importance_sampling",
    "pdf._sample_from_weighted",
    why="an empty ray's samples lie in its last bin (a choice); u = 1 is an index error: it draws u below 1",
)
def importance_sampling(edges, weights, u, padding):
    """Its own u come from linspace: it is handed the case's. It pads nothing: the weights come padded."""
    with replaced(torch, linspace=lambda *_, **__: u):
        return _sample_from_weighted(edges, weights + padding, u.shape[1])[1]


@answers(
    "nerfacc",
    "ray_aabb",
    "grid._ray_aabb_intersect",
    why="hits know neither near nor far; rays in a face are NaN and miss; a box without thickness is missed",
)
@torch.no_grad()
def ray_aabb(rays_o, rays_d, low, high, near, far):
    """One box; without gradient, as its CUDA twin."""
    t_near, t_far, hit = _ray_aabb_intersect(rays_o, rays_d, torch.cat([low, high])[None], near, far)
    return t_near[:, 0], t_far[:, 0], hit[:, 0]


LOWER_FACE = "queries on the box's lower faces, and outside of it, find nothing"


@answers("nerfacc", "occupancy_grid", "OccGridEstimator._update, one sample a cell, the largest; grid._query", why=LOWER_FACE)
def occupancy_of_the_largest(density, points, sigmas, queries, decay, threshold):
    """The largest sigma of each cell, put last: the last one counts."""
    order = torch.argsort(sigmas)
    return occupancy_grid(density, points[order], sigmas[order], queries, decay, threshold)


@answers(
    "nerfacc",
    "occupancy_grid",
    "OccGridEstimator._update, grid._query",
    why=f"of a cell's samples the last one counts; {LOWER_FACE}",
)
def occupancy_grid(density, points, sigmas, queries, decay, threshold):
    """It draws the cells that it looks into and a point in each: it is handed the case's, where a camera sees them. Its index
    is [x, y, z]."""
    box = torch.tensor([0, 0, 0, 1, 1, 1], dtype=density.dtype)
    grid = nerfacc.OccGridEstimator(box, resolution=list(density.shape)).to(density.device)
    grid.occs = density.permute(2, 1, 0).flatten().clone()
    size = len(density)
    x, y, z = (points * size).long().clamp(0, size - 1).unbind(-1)
    cells = (x * size + y) * size + z
    seen = grid.occs[cells] >= 0
    grid._get_all_cells = lambda: [cells[seen]]
    grid._update(0, lambda _: sigmas[seen, None], occ_thre=threshold, ema_decay=decay)
    found, _ = _query(queries, grid.binaries, box)
    return grid.occs.view(density.shape).permute(2, 1, 0), grid.binaries[0].permute(2, 1, 0), found
