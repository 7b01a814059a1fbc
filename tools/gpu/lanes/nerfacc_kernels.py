"""nerfacc on CUDA, unchanged: its packed forms, and those of tools/libraries on the device."""

import nerfacc
import nerfacc.cameras
import torch
from asked import adapters
from nerfacc.grid import ray_aabb_intersect, traverse_grids
from torch.nn.functional import pad


def packed(deltas, rgbs, **fields):
    """rendering of all rays' samples one after the other, an empty one behind each ray."""
    rays, samples = deltas.shape[0], deltas.shape[1] + 1
    ends, rgbs = pad(deltas, (0, 1)).reshape(-1), pad(rgbs, (0, 0, 0, 1)).reshape(-1, 3)
    ids = torch.arange(rays).repeat_interleave(samples)
    (name, values), = fields.items()  # fmt: skip
    field = {name: lambda *_: (rgbs, pad(values, (0, 1)).reshape(-1))}
    colors, opacity, _, extras = nerfacc.rendering(torch.zeros_like(ends), ends, ids, n_rays=rays, **field)
    weights, left = (extras[what].reshape(rays, samples) for what in ("weights", "trans"))
    return colors, weights[:, :-1], opacity[:, 0], left[:, -1]


def volume_render(sigmas, rgbs, deltas):
    """Steps begin at 0, so that t_ends - t_starts are the deltas."""
    return packed(deltas, rgbs, rgb_sigma_fn=sigmas)


def volume_render_alpha(alphas, rgbs):
    """t is needed for its depth alone."""
    return packed(torch.zeros_like(alphas), rgbs, rgb_alpha_fn=alphas)


def packed_scan(offsets, x):
    """In kernels of its own."""
    offsets = offsets.long()
    info = torch.stack([offsets[:-1], offsets.diff()], -1)
    scans = nerfacc.exclusive_sum, nerfacc.inclusive_sum, nerfacc.exclusive_prod, nerfacc.inclusive_prod
    return tuple(scan(x, info) for scan in scans)


def pack_info(ray_ids, rays):
    """First samples and their numbers."""
    found = nerfacc.pack_info(ray_ids, int(rays))
    return found[:, 0], found[:, 1]


def early_stop(sigmas, rgbs, deltas, offsets, eps):
    """What is visible, rendered, an empty sample behind each ray for what is left."""
    rays = len(offsets) - 1
    ids = torch.repeat_interleave(torch.arange(rays), offsets.diff().long())
    visible = nerfacc.render_visibility_from_density
    seen = visible(torch.zeros_like(deltas), deltas, sigmas, ray_indices=ids, n_rays=rays, early_stop_eps=eps)
    kept = torch.cat([torch.nonzero(seen)[:, 0], len(sigmas) + torch.arange(rays)])
    of_ray = torch.cat([ids, torch.arange(rays)])[kept]
    order = torch.sort(of_ray, stable=True).indices
    kept, of_ray = kept[order], of_ray[order]
    s, d, c = (torch.cat([x, x.new_zeros(rays, *x.shape[1:])])[kept] for x in (sigmas, deltas, rgbs))
    field = {"rgb_sigma_fn": lambda *_: (c, s)}
    colors, opacity, _, extras = nerfacc.rendering(torch.zeros_like(d), d, of_ray, n_rays=rays, **field)
    last = kept >= len(sigmas)
    weights = torch.zeros_like(sigmas).masked_scatter(seen, extras["weights"][~last])
    live = sigmas.new_zeros(rays).index_add(0, ids, seen.to(sigmas))
    return live, colors, weights, opacity[:, 0], extras["trans"][last]


@torch.no_grad()
def ray_aabb(rays_o, rays_d, low, high, near, far):
    """One box."""
    t_near, t_far, hit = ray_aabb_intersect(rays_o, rays_d, torch.cat([low, high])[None], near, far)
    return t_near[:, 0], t_far[:, 0], hit[:, 0]


def lens_undistort(distorted, coefficients):
    """Its default steps. It takes four or eight coefficients: zeros behind five."""
    count = len(coefficients)
    return nerfacc.cameras.opencv_lens_undistortion(distorted, pad(coefficients, (0, 0 if count in (4, 8) else 8 - count)))


def fisheye_undistort(distorted, coefficients):
    """Its default steps."""
    return nerfacc.cameras.opencv_lens_undistortion_fisheye(distorted, coefficients)


def grid_traversal(rays_o, rays_d, near, far, resolution):
    """A grid that is occupied everywhere; an interval counts for the cell that its middle is in."""
    n = int(resolution)
    box = torch.tensor([[0.0, 0, 0, 1, 1, 1]])
    planes = {"near_planes": torch.full_like(rays_o[:, 0], near), "far_planes": torch.full_like(rays_o[:, 0], far)}
    full = torch.ones(1, n, n, n, dtype=torch.bool)
    intervals, samples, _ = traverse_grids(rays_o, rays_d, full, box, step_size=0.0, **planes)
    width = intervals.vals[intervals.is_right] - intervals.vals[intervals.is_left]
    ids = samples.ray_indices
    x, y, z = ((rays_o[ids] + samples.vals[:, None] * rays_d[ids]) * n).floor().long().clamp(0, n - 1).unbind(-1)
    lengths = rays_o.new_zeros(len(rays_o), n, n, n).index_put((ids, z, y, x), width, accumulate=True)
    return lengths, (lengths > 0).sum((1, 2, 3)).to(rays_o)


def answer(asked):
    """Its kernels are f32's."""
    asked.cuda()
    if asked.dtype != "f32":
        return
    own = adapters("nerfacc")
    batched = {"volume_render": own.volume_render, "volume_render_alpha": own.volume_render_alpha}
    rows = packed_scan, pack_info, early_stop, ray_aabb, lens_undistort, fisheye_undistort, grid_traversal
    asked.hand("nerfacc_batched", **batched)
    asked.hand("nerfacc_packed", volume_render=volume_render, volume_render_alpha=volume_render_alpha)
    asked.hand("nerfacc", **{row.__name__: row for row in rows})
    asked.hand("nerfacc", accumulate_along_rays=own.accumulate_along_rays, occupancy_grid=own.occupancy_of_the_largest)
