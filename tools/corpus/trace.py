"""Whole renderers, as they stand in one file."""

import torch
from entry import convention, fault, right


def rendered(a, opengl=False, half=0.5, unit=True, grid="edges", delta="width", last=1e10, eps=0.0, swap=None):
    """All stages by their choices; `swap` changes what lies between them."""
    H, W, n = a["height"], a["width"], a["u"].shape[-1]
    swap = swap or {}
    i, j = torch.meshgrid(torch.arange(W).float() + half, torch.arange(H).float() + half, indexing="xy")
    uv = torch.stack([i, j], -1)
    i, j = swap.get("uv", lambda x: x)(uv).unbind(-1)
    x, y = (i - a["cx"]) / a["focal"], (j - a["cy"]) / a["focal"]
    dirs = torch.stack([x, -y, -torch.ones_like(x)] if opengl else [x, y, torch.ones_like(x)], -1)
    d = (dirs[..., None, :] * a["c2w"][:3, :3]).sum(-1)
    d = d / d.norm(dim=-1, keepdim=True) if unit else d
    near, far, u = a["near"], a["far"], swap.get("u", lambda x: x)(a["u"])
    width = (far - near) / n
    ends = torch.linspace(near, far, n)
    if grid == "edges":
        t = near + (torch.arange(n) + u) * width
    elif grid == "ends":
        t = ends + u * width
    else:
        mids = 0.5 * (ends[1:] + ends[:-1])
        upper, lower = torch.cat([mids, ends[-1:]]), torch.cat([ends[:1], mids])
        t = lower + (upper - lower) * u
    deltas = torch.full_like(t, width) if delta == "width" else torch.cat([t.diff(dim=-1), torch.full_like(t[..., :1], last)], -1)
    deltas = deltas * d.norm(dim=-1, keepdim=True) if delta == "norm" else deltas
    deltas = swap.get("deltas", lambda x: x)(deltas)
    alpha = 1 - torch.exp(-a["sigmas"] * deltas)
    product = torch.cumprod(1 - alpha + eps, -1)
    shade = swap.get("shade", lambda p: torch.cat([torch.ones_like(p[..., :1]), p[..., :-1]], -1))(product)
    weights = shade * alpha
    colors = (weights[..., None] * a["rgbs"]).sum(-2)
    total = weights.sum(-1, keepdim=True)
    colors = swap.get("behind", lambda c, total, b: c + (1 - total) * b)(colors, total, a["background"])
    o = a["c2w"][:3, 3].expand(d.shape)
    return {"uv": uv, "rays_o": o, "rays_d": d, "t": t, "deltas": deltas, "weights": weights, "colors": colors}


ORIGINAL = {
    "axes": "opengl",
    "pixel_center": "integer",
    "directions": "depth",
    "grid": "ends_between_midpoints",
    "delta": "differences_times_norm",
    "last_delta": "1e10",
    "product_eps": "1e-10",
}


@right("render_trace", seen="CS180 students, all of it right", times=3)
def course_renderer(**a):
    """The course's choices."""
    return rendered(a)


@convention("render_trace", {"grid": "ends_plus_width"}, seen="CS180 students: linspace with both ends, a constant step", times=8)
def course_renderer_with_linspace(**a):
    """Samples at both ends plus a jitter of the width, which is the step."""
    return rendered(a, grid="ends")


@convention("render_trace", ORIGINAL, seen="bmild/nerf, yenchenlin, kwea123/nerf_pl", times=6)
def original_renderer(**a):
    """The original's choices."""
    return rendered(a, True, 0.0, False, "mids", "norm", 1e10, 1e-10)


@convention(
    "render_trace",
    ORIGINAL | {"grid": "ends_plus_width", "delta": "differences"},
    seen="tiny NeRF, keras-io, krrish94's tiny",
    times=8,
)
def tiny_renderer(**a):
    """Tiny NeRF's choices."""
    return rendered(a, True, 0.0, False, "ends", "differences", 1e10, 1e-10)


@fault("render_trace", "inclusive_transmittance", seen="JerryAIwei/nerf_pytorch render.py with its ray.py")
def tiny_renderer_shading_itself(**a):
    """Tiny NeRF whose product isn't moved."""
    return rendered(a, True, 0.0, False, "ends", "differences", 1e10, 1e-10, {"shade": lambda p: p})


@fault("render_trace", "one_jitter_for_all_rays", seen="CS180 students", times=5)
def course_renderer_with_one_jitter(**a):
    """One row of noise for all rays."""
    return rendered(a, grid="ends", swap={"u": lambda u: u[:1, :1].expand_as(u)})


@fault("render_trace", "delta_unit_interval", seen="CS180 student: differences of [0, 1]", times=3)
def course_renderer_in_the_unit_interval(**a):
    """Steps of 1 / N."""
    return rendered(a, swap={"deltas": lambda x: torch.full_like(x, 1 / x.shape[-1])})


@fault("render_trace", "no_half_pixel", seen="CS180 students whose uv has the half and whose rays don't", times=2)
def course_renderer_without_half(**a):
    """uv is reported with the half; the rays have none."""
    return rendered(a, swap={"uv": lambda uv: uv - 0.5})


@fault("render_trace", "row_column_swapped", seen="students with a grid of rows and columns", times=3)
def course_renderer_with_rows_for_columns(**a):
    """Rows are taken for u."""
    return rendered(a, swap={"uv": lambda uv: uv.flip(-1)})


@fault("render_trace", "background_shaded_twice", "attenuated_twice", seen="nerfstudio#2165", times=2)
def course_renderer_mixing_twice(**a):
    """A C + (1 - A) b."""
    return rendered(a, swap={"behind": lambda c, total, b: total * c + (1 - total) * b})


@fault("render_trace", "one_jitter_for_all_rays+inclusive_transmittance", seen="two of the commonest in one file", times=1)
def two_faults(**a):
    """One jitter for all, and each sample shades itself."""
    return rendered(a, grid="ends", swap={"u": lambda u: u[:1, :1].expand_as(u), "shade": lambda p: p})


@fault(
    "render_trace",
    "row_column_swapped+delta_missing+divided_by_opacity",
    seen="files with two to four faults: three at once",
    times=1,
)
def three_faults(**a):
    """Rows for columns, steps of 1, colors divided by the opacity."""
    return rendered(
        a,
        swap={
            "uv": lambda uv: uv.flip(-1),
            "deltas": torch.ones_like,
            "behind": lambda c, total, b: c / total + (1 - total) * b,
        },
    )
