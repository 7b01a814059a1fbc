"""Rays and boxes whose range is never asked."""

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
