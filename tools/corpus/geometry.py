"""Boxes, occupancy grids, and walks through them."""

import numpy as np
import torch
from entry import convention, fault, right


def slabs(rays_o, rays_d, low, high):
    """Smallest and largest t of each axis; a ray along a slab is inside of it for ever, or never."""
    with np.errstate(divide="ignore", invalid="ignore"):
        a, b = (low - rays_o) / rays_d, (high - rays_o) / rays_d
    along = rays_d == 0
    inside = (rays_o >= low) & (rays_o <= high)
    enter = np.where(along, np.where(inside, -np.inf, np.inf), np.minimum(a, b))
    leave = np.where(along, np.where(inside, np.inf, -np.inf), np.maximum(a, b))
    return enter.max(1), leave.min(1)


def answer(enter, leave, near, far, kind):
    """The three outputs, far on a miss."""
    enter, leave = np.maximum(enter, near), np.minimum(leave, far)
    hit = enter <= leave
    return np.where(hit, enter, far).astype(kind), np.where(hit, leave, far).astype(kind), hit.astype(kind)


@right("ray_aabb", seen="tests for parallel rays, axis by axis: three codes", times=3, arrays="numpy")
def parallel_rays_apart(rays_o, rays_d, low, high, near, far):
    """A case of its own for components of 0."""
    return answer(*slabs(rays_o, rays_d, low, high), near, far, rays_o.dtype)


@right("ray_aabb", seen="a slab test in torch, of a trial on unseen code: a miss has what was computed for it")
def misses_as_they_come(rays_o, rays_d, low, high, near, far):
    """The same in torch: t_near > t_far says that a ray misses, and both have gradients."""
    parallel, inside = rays_d == 0, (low <= rays_o) & (rays_o <= high)
    open_slab = torch.where(inside, torch.inf, -torch.inf).to(rays_o.dtype)
    safe = torch.where(parallel, 1.0, rays_d)
    a, b = (low - rays_o) / safe, (high - rays_o) / safe
    enter = torch.where(parallel, -open_slab, torch.minimum(a, b)).max(-1).values.clamp(min=near)
    leave = torch.where(parallel, open_slab, torch.maximum(a, b)).min(-1).values.clamp(max=far)
    return enter, leave, (enter <= leave).to(rays_o.dtype)


@right("ray_aabb", seen="pure Python engines: a loop over axes", times=3, arrays="numpy")
def axis_by_axis(rays_o, rays_d, low, high, near, far):
    """A loop over rays and axes with two numbers carried along."""
    out = []
    for o, d in zip(rays_o, rays_d):
        first, last = near, far
        for k in range(3):
            if d[k] == 0:
                if not low[k] <= o[k] <= high[k]:
                    first, last = np.inf, -np.inf
                continue
            a, b = (low[k] - o[k]) / d[k], (high[k] - o[k]) / d[k]
            first, last = max(first, min(a, b)), min(last, max(a, b))
        out.append((first, last, 1) if first <= last else (far, far, 0))
    return tuple(np.array(column, rays_o.dtype) for column in zip(*out))


@fault(
    "ray_aabb",
    "tiny_direction_replaced",
    "eps_in_direction",
    seen="an engine in numpy: sign(d) max(|d|, 1e-9)",
    arrays="numpy",
)
def components_of_at_least_1e_9(rays_o, rays_d, low, high, near, far):
    """Zeros become 1e-9: right but for rays that lie in the far face, which leave at 0."""
    sign = np.where(rays_d < 0, -1, 1).astype(rays_d.dtype)
    safe = sign * np.maximum(np.abs(rays_d), 1e-9).astype(rays_d.dtype)
    a, b = (low - rays_o) / safe, (high - rays_o) / safe
    return answer(np.minimum(a, b).max(1), np.maximum(a, b).min(1), near, far, rays_o.dtype)


@fault("ray_aabb", "nan_in_a_face", seen="nerfstudio utils/math.py _intersect_aabb", gradient="none")
def touching_is_a_miss(rays_o, rays_d, low, high, near, far):
    """A part of length 0 is a miss, 0 / 0 in a face is left to the arithmetic; 1e10 on a miss."""
    a, b = (low - rays_o) / rays_d, (high - rays_o) / rays_d
    enter = torch.clamp(torch.min(a, b).max(-1).values, min=near, max=far)
    leave = torch.clamp(torch.max(a, b).min(-1).values, min=near, max=far)
    miss = leave <= enter
    return torch.where(miss, 1e10, enter), torch.where(miss, 1e10, leave), 1 - miss.float()


def with_eps(rays_o, rays_d, low, high, near, far, eps):
    """1 / (d + eps)."""
    a, b = (low - rays_o) / (rays_d + eps), (high - rays_o) / (rays_d + eps)
    enter = torch.clamp(torch.minimum(a, b).max(-1).values, min=near)
    leave = torch.clamp(torch.maximum(a, b).min(-1).values, max=far)
    hit = enter <= leave
    return torch.where(hit, enter, torch.full_like(enter, far)), torch.where(hit, leave, torch.full_like(leave, far)), hit.float()


@fault("ray_aabb", "eps_in_direction", seen="hand-written occupancy grids (1e-6)", times=2)
def direction_plus_1e_6(rays_o, rays_d, low, high, near, far):
    """d + 1e-6."""
    return with_eps(rays_o, rays_d, low, high, near, far, 1e-6)


# In f32 nothing but a tiny direction is changed by 1e-8: it is as if it were replaced.
@fault("ray_aabb", "eps_in_direction", "tiny_direction_replaced", seen="two NeRF libraries' intersections (1e-8)", times=2)
def direction_plus_1e_8(rays_o, rays_d, low, high, near, far):
    """d + 1e-8."""
    return with_eps(rays_o, rays_d, low, high, near, far, 1e-8)


@fault("ray_aabb", "near_ignored", seen="paradoxxxzero/raymarcher iBox.glsl: both t as they are", times=2, arrays="numpy")
def near_not_applied(rays_o, rays_d, low, high, near, far):
    """The first t isn't cut at near."""
    enter, leave = slabs(rays_o, rays_d, low, high)
    leave = np.minimum(leave, far)
    hit = enter <= leave
    return tuple(x.astype(rays_o.dtype) for x in (np.where(hit, enter, far), np.where(hit, leave, far), hit))


@fault("ray_aabb", "near_asked_not_cut", seen="a numpy renderer's intersect_aabb; shaders' vec2(tn, tf)", times=2, arrays="numpy")
def first_t_as_it_is(rays_o, rays_d, low, high, near, far):
    """Boxes behind near are missed; the first t of a ray that begins inside is negative."""
    enter, leave = slabs(rays_o, rays_d, low, high)
    leave = np.minimum(leave, far)
    hit = np.maximum(enter, near) <= leave
    return tuple(x.astype(rays_o.dtype) for x in (np.where(hit, enter, far), np.where(hit, leave, far), hit))


@fault("ray_aabb", "tiny_taken_for_parallel", seen="slab loops: if abs(d) < 1e-8", times=3, arrays="numpy", gradient="none")
def small_is_parallel(rays_o, rays_d, low, high, near, far):
    """Components below 1e-8 are no components."""
    flat = np.abs(rays_d) < 1e-8
    with np.errstate(divide="ignore", invalid="ignore"):
        x, y = (low - rays_o) / rays_d, (high - rays_o) / rays_d
    enter = np.maximum(np.where(flat, -np.inf, np.minimum(x, y)).max(1), near)
    leave = np.minimum(np.where(flat, np.inf, np.maximum(x, y)).min(1), far)
    hit = (enter <= leave) & ~(flat & ((rays_o < low) | (rays_o > high))).any(1)
    return tuple(x.astype(rays_o.dtype) for x in (np.where(hit, enter, far), np.where(hit, leave, far), hit))


@fault("ray_aabb", "far_ignored", seen="codes that cut at 0 alone", times=3, arrays="numpy")
def far_not_applied(rays_o, rays_d, low, high, near, far):
    """The last t isn't cut at far."""
    enter, leave = slabs(rays_o, rays_d, low, high)
    enter = np.maximum(enter, near)
    hit = enter <= leave
    return tuple(x.astype(rays_o.dtype) for x in (np.where(hit, enter, far), np.where(hit, leave, far), hit))


@fault("ray_aabb", "behind_is_a_hit", seen="HLSL and GLSL: return tFar >= tNear", times=2, arrays="numpy")
def boxes_behind_are_hit(rays_o, rays_d, low, high, near, far):
    """hit is asked of the whole line."""
    enter, leave = slabs(rays_o, rays_d, low, high)
    hit = enter <= leave
    enter, leave = np.maximum(enter, near), np.minimum(leave, far)
    return tuple(x.astype(rays_o.dtype) for x in (np.where(hit, enter, far), np.where(hit, leave, far), hit))


@fault("ray_aabb", "sign_ignored", seen="not met in this reading", times=0, arrays="numpy")
def low_face_first(rays_o, rays_d, low, high, near, far):
    """Entered by the low face whatever the sign of d."""
    with np.errstate(divide="ignore", invalid="ignore"):
        a, b = (low - rays_o) / rays_d, (high - rays_o) / rays_d
    along, inside = rays_d == 0, (rays_o >= low) & (rays_o <= high)
    enter = np.where(along, np.where(inside, -np.inf, np.inf), a).max(1)
    leave = np.where(along, np.where(inside, np.inf, -np.inf), b).min(1)
    return answer(enter, leave, near, far, rays_o.dtype)


@fault("ray_aabb", "parallel_is_a_miss", seen="codes that return on |d| < eps", times=1, arrays="numpy")
def parallel_rays_never_hit(rays_o, rays_d, low, high, near, far):
    """A component of 0 is a miss."""
    enter, leave = slabs(rays_o, rays_d, low, high)
    enter = np.where((rays_d == 0).any(1), np.inf, enter)
    return answer(enter, leave, near, far, rays_o.dtype)


def line(rays_o, rays_d, low, high):
    """Largest entry and smallest exit of three slabs, whatever the arithmetic makes of a component of 0."""
    a, b = (low - rays_o) / rays_d, (high - rays_o) / rays_d
    return torch.minimum(a, b).max(-1).values, torch.maximum(a, b).min(-1).values


@fault("ray_aabb", "eps_in_direction", seen="a text-to-3D code and a copy of it (1e-8), whose caller masks misses", times=2, gradient="none")
def direction_plus_1e_8_and_misses_as_they_are(rays_o, rays_d, low, high, near, far):
    """d + 1e-8; on a miss t is what comes out."""
    enter, leave = line(rays_o, rays_d + 1e-8, low, high)
    enter, leave = enter.clamp(min=near), leave.clamp(max=far)
    return enter, leave, (enter <= leave).float()


@fault(
    "ray_aabb",
    "face_is_a_miss",
    seen="a port of a WebGL path tracer to torch, cut to a range by its caller",
    gradient="none",
)
def faces_left_to_the_arithmetic(rays_o, rays_d, low, high, near, far):
    """0 / 0 in a face, and infinities beside it: NaN is compared with near and far, and differentiated."""
    enter, leave = line(rays_o, rays_d, low, high)
    enter, leave = enter.clamp(min=near), leave.clamp(max=far)
    return enter, leave, (enter <= leave).float()


@fault(
    "ray_aabb",
    "tiny_direction_replaced+behind_is_a_hit",
    "eps_in_direction+behind_is_a_hit",
    seen="a scene editor's culling in torch: from 0 on, whatever is hit by the line",
    gradient="none",
)
def line_against_box(rays_o, rays_d, low, high):
    """No range is taken: entries are cut at 0, boxes behind count, and every part is at least 1e-4 long."""
    sign = torch.where(rays_d < 0, -1.0, 1.0)
    enter, leave = line(rays_o, torch.where(rays_d.abs() > 1e-6, rays_d, 1e-6 * sign), low, high)
    hit = leave > enter
    enter = enter.clamp_min(0.0)
    return enter, torch.maximum(leave, enter + 1e-4), hit


@right("ray_aabb", seen="engines whose rays have no range", times=4, arrays="numpy")
def without_a_range(rays_o, rays_d, low, high):
    """From 0 to infinity."""
    return answer(*slabs(rays_o, rays_d, low, high), 0.0, np.inf, rays_o.dtype)


@right("ray_aabb", seen="torch codes whose caller masks misses", times=3, gradient="none")
def misses_as_they_are(rays_o, rays_d, low, high, near, far):
    """Zeros are taken for 1 and left out; on a miss t is what comes out."""
    along, inside = rays_d == 0, (rays_o >= low) & (rays_o <= high)
    safe, never = torch.where(along, 1.0, rays_d), torch.where(inside, -torch.inf, torch.inf)
    a, b = (low - rays_o) / safe, (high - rays_o) / safe
    enter = torch.where(along, never, torch.minimum(a, b)).max(-1).values.clamp(min=near)
    leave = torch.where(along, -never, torch.maximum(a, b)).min(-1).values.clamp(max=far)
    return enter, leave, (enter <= leave).float()


def cells(points, n):
    """Cell of each point, (z, y, x); the box's end belongs to the last."""
    return tuple(np.clip(np.floor(points * points.dtype.type(n)).astype(int), 0, n - 1).T[::-1])


def looked_up(density, queries, threshold, before=None):
    """The outputs of the grid."""
    occupied = (density if before is None else before) > threshold
    return density, occupied.astype(density.dtype), occupied[cells(queries, len(density))].astype(density.dtype)


@right("occupancy_grid", seen="instant-ngp: decay, then an atomic maximum", times=3, arrays="numpy")
def decayed_then_raised(density, points, sigmas, decay, threshold, queries):
    """np.maximum.at of the decayed grid."""
    out = (density * density.dtype.type(decay)).copy()
    np.maximum.at(out, cells(points, len(density)), sigmas)
    return looked_up(out, queries, threshold)


@right("occupancy_grid", seen="torch-ngp: maximum of decayed density and new", times=3)
def scattered_maximum(density, points, sigmas, decay, threshold, queries):
    """torch's scatter_reduce with amax."""
    n = len(density)

    def flat(x):
        """Number of each point's cell."""
        i = torch.clamp((x * n).floor().long(), 0, n - 1)
        return i[:, 0] + n * (i[:, 1] + n * i[:, 2])

    out = (density * decay).flatten().scatter_reduce(0, flat(points), sigmas, "amax").reshape(density.shape)
    occupied = (out > threshold).to(density.dtype)
    return out, occupied, occupied.flatten()[flat(queries)]


@convention(
    "occupancy_grid", seen="nerfstudio-project/nerfacc grid.py: only cells that were asked decay", times=2, arrays="numpy"
)
def others_keep_their_density(density, points, sigmas, decay, threshold, queries):
    """Cells without a point don't decay."""
    out, at = density.copy(), cells(points, len(density))
    out[at] = density[at] * density.dtype.type(decay)
    np.maximum.at(out, at, sigmas)
    return looked_up(out, queries, threshold)


@fault(
    "occupancy_grid", "last_point_wins", seen="nerfstudio-project/nerfacc grid.py, by its own comment", times=2, arrays="numpy"
)
def last_of_a_cell(density, points, sigmas, decay, threshold, queries):
    """Of several points in a cell the last counts."""
    out, at = density * density.dtype.type(decay), cells(points, len(density))
    out[at] = np.maximum(out[at], sigmas)
    return looked_up(out, queries, threshold)


@fault("occupancy_grid", "density_replaced", seen="a student's grid that is evaluated anew", times=2, arrays="numpy")
def evaluated_anew(density, points, sigmas, decay, threshold, queries):
    """The new density replaces the old one."""
    out, at = density * density.dtype.type(decay), cells(points, len(density))
    fresh = np.full_like(out, -np.inf)
    np.maximum.at(fresh, at, sigmas)
    return looked_up(np.where(np.isinf(fresh), out, fresh), queries, threshold)


@fault("occupancy_grid", "threshold_included", seen="occupied = density >= threshold", times=1, arrays="numpy")
def at_the_threshold_too(density, points, sigmas, decay, threshold, queries):
    """>= for >."""
    out = decayed_then_raised(density, points, sigmas, decay, threshold, queries)[0]
    occupied = (out >= threshold).astype(out.dtype)
    return out, occupied, occupied[cells(queries, len(out))]


@fault("occupancy_grid", "nearest_cell", seen="a voxel radiance field: .5 added before the cut", times=1, arrays="numpy")
def rounded_to_cells(density, points, sigmas, decay, threshold, queries):
    """round(p R) for floor(p R)."""
    half = points.dtype.type(0.5 / len(density))
    return decayed_then_raised(density, points + half, sigmas, decay, threshold, queries + half)


def crossings(o, d, near, far, n):
    """Sorted t of all planes between near and far, in f64."""
    t = [near, far]
    for k in range(3):
        if d[k]:
            t += [x for x in ((np.arange(n + 1) / n - o[k]) / d[k]) if near < x < far]
    return np.unique(t)


def walked(rays_o, rays_d, near, far, resolution, pieces):
    """Lengths and numbers of cells from pieces of each ray."""
    lengths = np.zeros((len(rays_o), resolution, resolution, resolution))
    for r, (o, d) in enumerate(zip(rays_o.astype(np.float64), rays_d.astype(np.float64))):
        t = pieces(o, d)
        for a, b in zip(t, t[1:]):
            x = o + d * (a + b) / 2
            lengths[r][tuple(np.clip(np.floor(x * resolution).astype(int), 0, resolution - 1)[::-1])] += b - a
    return lengths.astype(rays_o.dtype), (lengths > 0).sum((1, 2, 3)).astype(rays_o.dtype)


@right("grid_traversal", seen="ray tracers that sort all crossings; DDA codes", times=3, arrays="numpy")
def sorted_crossings(rays_o, rays_d, near, far, resolution):
    """All planes' t, sorted; the middle of a piece names its cell."""
    return walked(rays_o, rays_d, near, far, resolution, lambda o, d: crossings(o, d, near, far, resolution))


@fault("grid_traversal", "equal_steps", seen="ray marchers with a fixed step through a grid", times=4, arrays="numpy")
def fixed_steps(rays_o, rays_d, near, far, resolution):
    """Equal steps, each counted to the cell of its middle."""
    return walked(rays_o, rays_d, near, far, resolution, lambda o, d: np.linspace(near, far, 8 * resolution + 1))


@fault("grid_traversal", "first_cell_missing", seen="walks that count a cell when its face is crossed", times=1, arrays="numpy")
def from_the_first_face_on(rays_o, rays_d, near, far, resolution):
    """The cell where a ray begins isn't counted."""
    return walked(rays_o, rays_d, near, far, resolution, lambda o, d: crossings(o, d, near, far, resolution)[1:])


@fault("ray_aabb", seen="an engine's physics: hits alone, and the box's y where z is meant", arrays="numpy")
def bounds_of_y_for_z(rays_o, rays_d, low, high):
    """Hits alone; the slab of z has y's bounds, 0 / 0 is left to comparisons."""
    with np.errstate(divide="ignore", invalid="ignore"):
        a, b = ((bound[[0, 1, 1]] - rays_o) * (1 / rays_d) for bound in (low, high))
    first = [max(min(*pair) for pair in zip(*ray)) for ray in zip(a, b)]
    last = [min(max(*pair) for pair in zip(*ray)) for ray in zip(a, b)]
    return {"hit": np.array([not (t < 0 or s > t) for s, t in zip(first, last)], bool)}


def in_the_cube(rays_o, rays_d, focal, width, height, near, t):
    """NeRF's lines from the moved origin on."""
    rays_o = rays_o + t[..., None] * rays_d
    sx, sy = -1.0 / (width / (2.0 * focal)), -1.0 / (height / (2.0 * focal))
    (ox, oy, oz), (dx, dy, dz) = rays_o.unbind(-1), rays_d.unbind(-1)
    o = torch.stack([sx * ox / oz, sy * oy / oz, 1.0 + 2.0 * near / oz], -1)
    d = torch.stack([sx * (dx / dz - ox / oz), sy * (dy / dz - oy / oz), -2.0 * near / oz], -1)
    return o, d


@right("ndc_rays", seen="bmild/nerf run_nerf_helpers.py ndc_rays, and its ports", times=12, digits=True)
def to_the_near_plane(rays_o, rays_d, focal, width, height, near):
    """t = -(near + o_z) / d_z."""
    return in_the_cube(rays_o, rays_d, focal, width, height, near, -(near + rays_o[..., 2]) / rays_d[..., 2])


@fault(
    "ndc_rays",
    "slip: plane - o[2], of which plane is taken outside of the parenthesis",
    seen="a port whose parenthesis closes too late",
)
def near_outside_the_quotient(rays_o, rays_d, focal, width, height, near):
    """t = -(near + o_z / d_z)."""
    return in_the_cube(rays_o, rays_d, focal, width, height, near, -(near + rays_o[..., 2] / rays_d[..., 2]))
