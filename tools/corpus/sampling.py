"""Samples along rays, and their steps."""

import numpy as np
import torch
from entry import convention, fault, right


def on_rays(rays_o, rays_d, t):
    """t and o + t d."""
    return t, rays_o[:, None, :] + t[..., None] * rays_d[:, None, :]


def ends(near, far, n):
    """n places from near to far, both held."""
    return torch.linspace(near, far, n)


@right("sample_along_rays", seen="CS180 students (edges N + 1)", times=4)
def between_edges(rays_o, rays_d, near, far, u):
    """N + 1 edges, one sample in each interval."""
    edges = ends(near, far, u.shape[1] + 1)
    return on_rays(rays_o, rays_d, edges[:-1] + (edges[1:] - edges[:-1]) * u)


@right("sample_along_rays", seen="nerfstudio ray_samplers.py (spacing), blended as near (1 - x) + far x", times=3)
def blended_between_near_and_far(rays_o, rays_d, near, far, u):
    """x = (i + u) / N, near (1 - x) + far x."""
    x = (torch.arange(u.shape[1]) + u) / u.shape[1]
    return on_rays(rays_o, rays_d, near * (1.0 - x) + far * x)


@right("sample_along_rays", seen="CS180 students return the points alone", times=5)
def points_alone(rays_o, rays_d, near, far, u):
    """t isn't handed out."""
    return {"points": between_edges(rays_o, rays_d, near, far, u)[1]}


@right("sample_along_rays", seen="numpy ports", times=2, arrays="numpy")
def numpy_intervals(rays_o, rays_d, near, far, u):
    """numpy, flattened points (R N, 3)."""
    n = u.shape[1]
    t = (near + (np.arange(n, dtype=np.float32) + u) * np.float32((far - near) / n)).astype(np.float32)
    return t, (rays_o[:, None] + t[..., None] * rays_d[:, None]).reshape(-1, 3)


@convention("sample_along_rays", {"grid": "ends_plus_width"}, seen="keras-io, krrish94, tiny NeRF, most CS180 students", times=18)
def both_ends_plus_width(rays_o, rays_d, near, far, u):
    """linspace(near, far, N) + u (far - near) / N."""
    n = u.shape[1]
    return on_rays(rays_o, rays_d, ends(near, far, n) + u * (far - near) / n)


@convention(
    "sample_along_rays", {"grid": "ends_between_midpoints"}, seen="bmild/nerf, kwea123/nerf_pl, the 100-line NeRF", times=16
)
def between_midpoints(rays_o, rays_d, near, far, u):
    """Between the midpoints of linspace(near, far, N), half as wide at both ends."""
    t = ends(near, far, u.shape[1])
    mids = 0.5 * (t[1:] + t[:-1])
    upper, lower = torch.cat([mids, t[-1:]]), torch.cat([t[:1], mids])
    return on_rays(rays_o, rays_d, lower + (upper - lower) * u)


@convention("sample_along_rays", {"grid": "ends_plus_spacing"}, seen="CS180 students (spacing of linspace)", times=2)
def both_ends_plus_spacing(rays_o, rays_d, near, far, u):
    """linspace(near, far, N) + u times its spacing."""
    t = ends(near, far, u.shape[1])
    spacing = t[1] - t[0] if len(t) > 1 else 0.0
    return on_rays(rays_o, rays_d, t + u * spacing)


@fault("sample_along_rays", "one_jitter_for_all_rays", seen="CS180 students: rand_like of t (N), aviral2004", times=5)
def one_row_of_jitter(rays_o, rays_d, near, far, u):
    """linspace plus noise of shape N, the same for all rays."""
    n = u.shape[1]
    t = ends(near, far, n) + u[0] * (far - near) / n
    return on_rays(rays_o, rays_d, t.expand(len(rays_o), n))


@fault("sample_along_rays", "one_jitter_for_all_rays+jitter_width_1", seen="aviral2004/nerf_from_scratch (t_width=1)")
def one_row_of_wide_jitter(rays_o, rays_d, near, far, u):
    """The same, as wide as 1."""
    t = ends(near, far, u.shape[1]) + u[0] * 1.0
    return on_rays(rays_o, rays_d, t.expand(len(rays_o), len(t)))


def fixed_width(rays_o, rays_d, near, far, u, width):
    """linspace plus u times a fixed width."""
    return on_rays(rays_o, rays_d, ends(near, far, u.shape[1]) + u * width)


@fault("sample_along_rays", "jitter_width_0.02", seen="CS180 students: the course's own t_width", times=3)
def jitter_as_wide_as_a_fiftieth(rays_o, rays_d, near, far, u):
    """A width of 0.02 whatever the interval."""
    return fixed_width(rays_o, rays_d, near, far, u, 0.02)


@fault(
    "sample_along_rays",
    "jitter_width",
    "jitter_width_0.1",
    "jitter_width_0.02",
    seen="not met: a number beside those that were",
    times=0,
)
def jitter_as_wide_as_a_twentieth(rays_o, rays_d, near, far, u):
    """A width of 0.05: the same fault with another number."""
    return fixed_width(rays_o, rays_d, near, far, u, 0.05)


@fault("sample_along_rays", "jitter_width_1", seen="aviral2004, of shape (R, N)", times=2)
def jitter_as_wide_as_one(rays_o, rays_d, near, far, u):
    """A width of 1."""
    return fixed_width(rays_o, rays_d, near, far, u, 1.0)


@fault("sample_along_rays", "never_jittered", seen="JerryAIwei/nerf_pytorch render.py; a student's render_rays", times=4)
def linspace_alone(rays_o, rays_d, near, far, u):
    """linspace(near, far, N); u is ignored."""
    t = ends(near, far, u.shape[1])
    return on_rays(rays_o, rays_d, t.expand(len(rays_o), len(t)))


@fault("sample_along_rays", "never_jittered", seen="samplers that rest at the middles", times=2)
def middles_alone(rays_o, rays_d, near, far, u):
    """The middles of the intervals; u is ignored."""
    return between_edges(rays_o, rays_d, near, far, torch.full_like(u, 0.5))


@fault("sample_along_rays", "jitter_centered_on_edges", seen="an earlier reading of 114 implementations")
def jitter_about_the_edges(rays_o, rays_d, near, far, u):
    """u - 1/2: a sample may lie in front of near."""
    return between_edges(rays_o, rays_d, near, far, u - 0.5)


@fault("sample_along_rays", "flattened_in_wrong_order", seen="an earlier reading of 114 implementations")
def sample_after_sample(rays_o, rays_d, near, far, u):
    """All rays' first samples, then all rays' second ones."""
    t, points = between_edges(rays_o, rays_d, near, far, u)
    return t, points.transpose(0, 1).reshape(-1, 3)


@fault("sample_along_rays", "points_without_origin", seen="an earlier reading of 114 implementations")
def multiples_of_directions(rays_o, rays_d, near, far, u):
    """t d."""
    t = between_edges(rays_o, rays_d, near, far, u)[0]
    return t, t[..., None] * rays_d[:, None]


@fault("sample_along_rays", "unit_interval", seen="CS180 student (intervals of [0, 1] handed on as distances)")
def distances_in_the_unit_interval(rays_o, rays_d, near, far, u):
    """(i + u) / N: near and far are never applied."""
    return on_rays(rays_o, rays_d, (torch.arange(u.shape[1]) + u) / u.shape[1])


@right("step_sizes", seen="CS180 students: one step length for all", times=10)
def one_width(t, near, far):
    """(far - near) / N everywhere."""
    return torch.full_like(t, (far - near) / t.shape[1])


def differences(t, last):
    """t_{i+1} - t_i, and a last one."""
    gaps = t[..., 1:] - t[..., :-1]
    return torch.cat([gaps, last if isinstance(last, torch.Tensor) else torch.full_like(t[..., :1], last)], -1)


@convention(
    "step_sizes", {"delta": "differences", "last_delta": "1e10"}, seen="bmild/nerf, krrish94, keras-io, CMU, VolSDF", times=30
)
def infinite_last_step(t):
    """Differences, then 1e10."""
    return differences(t, 1e10)


@convention("step_sizes", {"delta": "differences"}, seen="cheind/pure-torch-ngp radiance.py (tfinal = 1e5)")
def last_step_up_to_1e5(t):
    """Differences of the samples and 1e5 behind them."""
    return torch.diff(torch.cat([t, torch.full_like(t[..., :1], 1e5)], -1), dim=-1)


@convention("step_sizes", {"delta": "differences"}, seen="a student's torch port (1e20)", times=1)
def last_step_1e20(t):
    """Differences, then 1e20."""
    return differences(t, 1e20)


@convention("step_sizes", {"delta": "differences"}, seen="a lidar renderer (1e25)", times=1)
def last_step_1e25(t):
    """Differences, then 1e25."""
    return differences(t, 1e25)


@convention("step_sizes", {"delta": "differences"}, seen="a Chinese NeRF-W port (233)", times=1)
def last_step_233(t):
    """Differences, then 233."""
    return differences(t, 233.0)


@convention("step_sizes", {"delta": "differences"}, seen="google/nerfies without a sample at infinity (1e-19)", times=2)
def last_step_1e_minus_19(t):
    """Differences, then 1e-19."""
    return differences(t, 1e-19)


@convention(
    "step_sizes", {"delta": "differences", "last_delta": "to_far"}, seen="an earlier reading of 114 implementations", times=2
)
def last_step_to_far(t, far):
    """Differences, then what is left to far."""
    return differences(t, far - t[..., -1:])


@convention(
    "step_sizes", {"delta": "differences", "last_delta": "repeated"}, seen="an earlier reading of 114 implementations", times=3
)
def last_step_repeated(t, near, far):
    """Differences, the last one twice."""
    gaps = t[..., 1:] - t[..., :-1]
    return torch.cat([gaps, gaps[..., -1:] if t.shape[-1] > 1 else torch.full_like(t, far - near)], -1)


@convention("step_sizes", {"delta": "differences", "last_delta": "1e10"}, seen="numpy and MLX ports", times=3, arrays="numpy")
def infinite_last_step_in_numpy(t):
    """numpy, then 1e10."""
    return np.concatenate([np.diff(t, axis=-1), np.full_like(t[..., :1], 1e10)], -1)


@convention("step_sizes", {"delta": "central"}, seen="a compositor of depths: cells about the samples, whole gaps at both ends")
def whole_gaps_at_both_ends(t, near, far):
    """(t_2 - t_0) / 2 inside, the first and the last gap as they are."""
    if t.shape[-1] == 1:
        return torch.full_like(t, far - near)
    return torch.cat([t[:, 1:2] - t[:, :1], (t[:, 2:] - t[:, :-2]) / 2, t[:, -1:] - t[:, -2:-1]], -1)


@fault("step_sizes", "last_gap_too_early", seen="a surface renderer: dists[..., -2:-1]")
def last_step_from_one_too_early(t, near, far):
    """The last step is the gap before the last one: a slice that ends too early."""
    gaps = t[..., 1:] - t[..., :-1]
    return torch.cat([gaps, gaps[..., -2:-1] if t.shape[-1] > 2 else torch.full_like(t[..., :1], far - near)], -1)


@fault("step_sizes", "delta_unit_interval", seen="CS180 student (differences of [0, 1]); an earlier reading", times=4)
def steps_of_the_unit_interval(t):
    """1 / N."""
    return torch.full_like(t, 1 / t.shape[1])


@fault("step_sizes", "delta_missing", seen="an earlier reading of 114 implementations", times=5)
def steps_of_one(t):
    """1."""
    return torch.ones_like(t)


@fault("step_sizes", "delta_over_n_minus_1", seen="an earlier reading of 114 implementations", times=3)
def one_interval_too_few(t, near, far):
    """(far - near) / (N - 1)."""
    return torch.full_like(t, (far - near) / max(t.shape[1] - 1, 1))


@fault("step_sizes", "backward_delta", seen="a volume viewer: diff with the first prepended", times=2)
def gap_in_front(t):
    """t_i - t_{i-1}, the first 0."""
    return torch.diff(t, dim=1, prepend=t[:, :1])


@fault(
    "step_sizes",
    "first_gap_for_all",
    "first_gap_for_all+first_ray_deltas",
    seen="a teaching code and its copies: ds[0, 1] - ds[0, 0]",
    times=2,
)
def first_gap_of_the_first_ray(t, near, far):
    """The first gap of the first ray for all rays and samples."""
    return torch.full_like(t, (t[0, 1] - t[0, 0]).item() if t.shape[1] > 1 else far - near)


@fault("step_sizes", seen="a copy of the teaching code: ds[0, 2] - ds[0, 1]")
def second_gap_of_the_first_ray(t, near, far):
    """The second gap of the first ray for all rays and samples."""
    return torch.full_like(t, (t[0, 2] - t[0, 1]).item() if t.shape[1] > 2 else far - near)


@fault("sample_along_rays", "left_edges_alone", seen="two students' samplers", times=2, gradient="none")
def always_left_edges(rays_o, rays_d, near, far, u):
    """near + i D, whatever u is."""
    n = u.shape[1]
    t = (near + (far - near) * torch.arange(n, dtype=u.dtype) / n).expand(u.shape)
    return t, rays_o[:, None] + t[..., None] * rays_d[:, None]


@fault("sample_along_rays", "unit_directions", seen="a student's sampler", gradient="none")
def directions_made_unit_by_the_sampler(rays_o, rays_d, near, far, u):
    """The middles as always, along d / |d|."""
    n = u.shape[1]
    t = near + (far - near) * (torch.arange(n, dtype=u.dtype) + u) / n
    return t, rays_o[:, None] + t[..., None] * (rays_d / rays_d.norm(dim=-1, keepdim=True))[:, None]


@fault("sample_along_rays", "one_bin_early", seen="pipyat/Neural-Radiance-Field-Ray-Sampling", gradient="none")
def bins_counted_from_one(rays_o, rays_d, near, far, u):
    """near + (i - 1 + u) D."""
    n = u.shape[1]
    t = near + (far - near) * (torch.arange(n, dtype=u.dtype) - 1 + u) / n
    return t, rays_o[:, None] + t[..., None] * rays_d[:, None]


@convention("step_sizes", {"delta": "midpoints"}, seen="openai point-e and shap-e; rejuvyesh/SimpleNeRF.jl", times=3)
def cells_between_middles(t, near, far):
    """From middle to middle, near and far at the ends."""
    middles = (t[:, 1:] + t[:, :-1]) / 2
    ends = [torch.full_like(t[:, :1], x) for x in (near, far)]
    return torch.diff(torch.cat([ends[0], middles, ends[1]], -1))


@fault("sample_along_rays", "middles_not_halved", seen="a student's b[:-1] + b[1:] / 2", gradient="none")
def middles_without_brackets(rays_o, rays_d, near, far, u):
    """e_i + e_{i+1} / 2."""
    n = u.shape[1]
    edges = near + (far - near) * torch.arange(n + 1, dtype=u.dtype) / n
    t = (edges[:-1] + edges[1:] / 2).expand(u.shape)
    return t, rays_o[:, None] + t[..., None] * rays_d[:, None]


@fault("sample_along_rays", "left_edges_alone+one_bin_early", seen="two students: (i - 1) / N with i from 0", gradient="none")
def left_edges_one_bin_early(rays_o, rays_d, near, far, u):
    """near + (i - 1) D."""
    n = u.shape[1]
    t = (near + (far - near) * (torch.arange(n, dtype=u.dtype) - 1) / n).expand(u.shape)
    return t, rays_o[:, None] + t[..., None] * rays_d[:, None]


@fault("sample_along_rays", "one_jitter_for_all_rays+jitter_about_grid", seen="a fork of the tiny NeRF: uniform(-1e-4, 1e-4)")
def linspace_that_trembles(rays_o, rays_d, near, far, u):
    """linspace, the same 1e-4 to either side for every ray."""
    t = ends(near, far, u.shape[1]) + 1e-4 * (2 * u[0] - 1)
    return on_rays(rays_o, rays_d, t.expand(len(rays_o), len(t)))


@fault("sample_along_rays", "jitter_about_grid", seen="not met in this reading", times=0)
def linspace_with_noise(rays_o, rays_d, near, far, u):
    """linspace, and 0.03 to either side."""
    return on_rays(rays_o, rays_d, ends(near, far, u.shape[1]) + 0.03 * (2 * u - 1))


@fault("step_sizes", "backward_delta_from_zero", seen="a sampler in numpy: 0 in front of t, then differences")
def gap_to_the_camera(t):
    """t_i - t_{i-1}, the first t_0 itself."""
    return torch.diff(t, dim=1, prepend=torch.zeros_like(t[:, :1]))


@fault("step_sizes", "delta_of_the_whole_ray", seen="a student's renderer")
def whole_ray_as_a_step(t, near, far):
    """far - near for every sample."""
    return torch.full_like(t, far - near)


@fault("sample_along_rays", "one_jitter_for_all_samples", seen="NeuS, and a port", times=2)
def one_number_a_ray(rays_o, rays_d, near, far, u):
    """Each ray is moved as a whole."""
    edges = ends(near, far, u.shape[1] + 1)
    return on_rays(rays_o, rays_d, edges[:-1] + (edges[1:] - edges[:-1]) * u[:, :1])


@fault("sample_along_rays", "ends_held", seen="a trial on unseen code: depth[:, 1:-1] += rand * gap", gradient="none")
def noise_between_the_ends(rays_o, rays_d, near, far, u):
    """linspace with both ends; all samples but these are moved by u times the gap."""
    n = u.shape[1]
    t = ends(near, far, n).expand(u.shape).clone()
    t[:, 1:-1] += u[:, 1:-1] * (far - near) / max(n - 1, 1)
    return on_rays(rays_o, rays_d, t)


@fault("sample_along_rays", "near_taken_for_zero", seen="not met with a jitter", times=0, gradient="none")
def intervals_from_zero(rays_o, rays_d, near, far, u):
    """(i + u) far / N."""
    n = u.shape[1]
    return on_rays(rays_o, rays_d, (torch.arange(n) + u) / n * far)


@fault(
    "sample_along_rays",
    "near_taken_for_zero+left_edges_alone",
    seen="a trial on unseen code: pos + vec * d / N * max_depth",
    gradient="none",
)
def left_edges_from_zero(rays_o, rays_d, near, far, u):
    """i far / N: neither near nor u is read."""
    n = u.shape[1]
    return on_rays(rays_o, rays_d, (torch.arange(n, dtype=u.dtype) / n * far).expand(u.shape))


@fault("step_sizes", "last_delta_zero", seen="a trial on unseen code: differences written into zeros_like(t)")
def differences_into_zeros(t):
    """t_{i+1} - t_i, and 0 for the last."""
    steps = torch.zeros_like(t)
    steps[..., :-1] = t[..., 1:] - t[..., :-1]
    return steps


@fault("sample_along_rays", "even_in_square", seen="a trial on unseen code: near (1 - s^2) + far s^2")
def even_in_the_square(rays_o, rays_d, near, far, u):
    """Strata in s, whose square is taken."""
    n = u.shape[1]
    s = (torch.arange(n, dtype=u.dtype) + u) / n
    return on_rays(rays_o, rays_d, near * (1 - s**2) + far * s**2)


@fault("sample_along_rays", "grid_times_jitter", seen="a trial on unseen code, one of its two faults: a program in Rust", gradient="none")
def way_shrunk_by_the_jitter(rays_o, rays_d, near, far, u):
    """near + (far - near) (i / N) u."""
    n = u.shape[1]
    return on_rays(rays_o, rays_d, near + (far - near) * (torch.arange(n) / n) * u)


@fault("sample_along_rays", "jitter_in_unit_widths", seen="a trial on unseen code: a trainer in JAX", gradient="none")
def jitter_of_one_over_n(rays_o, rays_d, near, far, u):
    """linspace(near, far, N) + u / N."""
    n = u.shape[1]
    return on_rays(rays_o, rays_d, ends(near, far, n) + u / n)


@fault(
    "sample_along_rays",
    "grid_of_unit_interval+one_jitter_for_all_rays",
    seen="a trial on unseen code: a student in torch",
    gradient="none",
)
def bins_of_the_unit_interval(rays_o, rays_d, near, far, u):
    """linspace(0, 1, N) + u of the first ray (far - near) / N."""
    n = u.shape[1]
    return on_rays(rays_o, rays_d, (ends(0.0, 1.0, n) + u[:1] * (far - near) / n).expand(u.shape))


@fault("sample_along_rays", "jitter_of_a_share", seen="a trial on unseen code: 0.002 of the range", gradient="none")
def jitter_of_two_thousandths(rays_o, rays_d, near, far, u):
    """linspace, and 0.002 (far - near) of noise."""
    t = ends(near, far, u.shape[1]) + 0.002 * u * (far - near)
    return on_rays(rays_o, rays_d, t)


@fault("sample_along_rays", "strata_of_two_spacings", seen="a trial on unseen code: a port to libtorch", gradient="none")
def between_the_neighbors(rays_o, rays_d, near, far, u):
    """From the place in front to the place behind."""
    t = ends(near, far, u.shape[1])
    lower, upper = torch.cat([t[:1], t[:-1]]), torch.cat([t[1:], t[-1:]])
    return on_rays(rays_o, rays_d, lower + (upper - lower) * u)
