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
