"""Rays and boxes whose range is never asked."""

import numpy as np
import torch
from entry import fault


def slabs_with_eps(rays_o, rays_d, low, high, eps):
    """Largest entry and smallest exit, by 1 / (d + eps)."""
    inverse = 1.0 / (rays_d + eps)
    a, b = (low - rays_o) * inverse, (high - rays_o) * inverse
    return torch.minimum(a, b).amax(-1), torch.maximum(a, b).amin(-1)


# In f32 nothing but a tiny direction is changed by 1e-8.
@fault(
    "ray_aabb",
    "eps_in_direction+range_never_asked",
    "tiny_direction_replaced+range_never_asked",
    "tiny_direction_positive+range_never_asked",
    seen="a trial on unseen code: 1 / (d + 1e-8), and no range",
    gradient="none",
)
def whole_line_with_eps(rays_o, rays_d, low, high, near, far):
    """1 / (d + 1e-8), and t as they are: neither near nor far is read."""
    enter, leave = slabs_with_eps(rays_o, rays_d, low, high, 1e-8)
    return enter, leave, (enter <= leave).float()


@fault(
    "ray_aabb",
    "eps_in_direction+range_ignored",
    "tiny_direction_replaced+range_ignored",
    "tiny_direction_positive+range_ignored",
    seen="not met in this reading",
    times=0,
    gradient="none",
)
def line_in_front_with_eps(rays_o, rays_d, low, high, near, far):
    """The same; boxes behind the origin are missed."""
    enter, leave = slabs_with_eps(rays_o, rays_d, low, high, 1e-8)
    return enter, leave, (enter.clamp(min=0) <= leave).float()


@fault("ray_aabb", "range_asked_not_cut", seen="a trial on unseen code: the line's t beside the right hit", gradient="none")
def line_beside_the_right_hit(rays_o, rays_d, low, high, near, far):
    """t as they are; the hit asks near and far."""
    along, inside = rays_d == 0, (low <= rays_o) & (rays_o <= high)
    inverse = 1.0 / torch.where(along, torch.ones_like(rays_d), rays_d)
    a, b = (low - rays_o) * inverse, (high - rays_o) * inverse
    none = torch.where(inside, -torch.inf, torch.inf)
    enter = torch.where(along, none, torch.minimum(a, b)).amax(-1)
    leave = torch.where(along, -none, torch.maximum(a, b)).amin(-1)
    return enter, leave, (enter.clamp(min=near) <= leave.clamp(max=far)).float()


def compared(rays_o, rays_d, low, high, near, far, first):
    """One slab after the other by comparisons alone, begun by `first`; what isn't a number fails each of them."""
    with np.errstate(all="ignore"):
        a, b = (low - rays_o) / rays_d, (high - rays_o) / rays_d
    out = []
    for ray in range(len(rays_o)):
        slabs = [(x, y) if not x > y else (y, x) for x, y in zip(*(first(s[ray]) for s in (a, b)))]
        (enter, leave), missed = slabs[0], False
        for x, y in slabs[1:]:
            missed = missed or enter > y or x > leave
            enter, leave = (x if x > enter else enter), (y if y < leave else leave)
        enter, leave = (near if enter < near else enter), (far if leave > far else leave)
        hit = not missed and enter <= leave
        out.append((enter, leave, 1) if hit or np.isnan(enter + leave) and not missed else (far, far, 0))
    return tuple(np.array(column, rays_o.dtype) for column in zip(*out))


@fault(
    "ray_aabb",
    "nan_in_a_face",
    seen="a trial on unseen code: two ports of instant-ngp's bounding box and of torch-ngp's",
    times=2,
    arrays="numpy",
)
def nan_of_x_kept(rays_o, rays_d, low, high, near, far):
    """x's NaN stays, y's and z's are passed over."""
    return compared(rays_o, rays_d, low, high, near, far, lambda t: t)


@fault("ray_aabb", "nan_in_a_face", seen="a trial on unseen code: a trainer in Julia", arrays="numpy")
def nan_taken_for_zero(rays_o, rays_d, low, high, near, far):
    """0 in the place of every NaN."""
    return compared(rays_o, rays_d, low, high, near, far, lambda t: np.where(np.isnan(t), 0, t))


@fault(
    "ray_aabb",
    "slip: another formula: t_near = near, always, and t_far = the nearest of all planes that are ahead",
    seen="a trial on unseen code: light inside of a voxel volume",
)
def out_of_the_volume(rays_o, rays_d, low, high):
    """From 0 to the first plane ahead, of all six."""

    def ahead(t):
        return torch.where(t > 0, t, torch.tensor(torch.inf)).amin(-1)

    first = torch.minimum(ahead((low - rays_o) / rays_d), ahead((high - rays_o) / rays_d))
    return torch.zeros_like(first), first


# Next to planes that a ray lies in no difference knows the gradient.
@fault(
    "ray_aabb",
    "near_ignored+eps_in_direction",
    "range_never_asked+eps_in_direction",
    "near_asked_not_cut+eps_in_direction",
    seen="a trial on unseen code: rays through grids of features",
)
def line_with_eps(rays_o, rays_d, low, high):
    """Entry and exit by 1 / (d + 1e-8), wherever the ray begins."""
    return slabs_with_eps(rays_o, rays_d, low, high, 1e-8)
