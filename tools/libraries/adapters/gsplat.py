"""gsplat's reference in torch. Its alpha compositing, `accumulate`, needs nerfacc's `pack_info`, which has no CPU path."""

import torch
from entry import answers
from gsplat.cuda._torch_impl import _eval_sh_bases_fast, _spherical_harmonics, _world_to_cam


@answers("gsplat", "transform", "_torch_impl._world_to_cam")
def transform(c2w, x_c):
    """One camera a point; the matrix is whatever it is handed."""
    nothing = torch.zeros(len(x_c), 1, 3, 3, dtype=x_c.dtype)
    return _world_to_cam(x_c[:, None], nothing, c2w[:, None])[0][:, 0, 0]


@answers("gsplat", "spherical_harmonics", "_torch_impl._eval_sh_bases_fast")
def spherical_harmonics(d, degree):
    """The polynomials."""
    return _eval_sh_bases_fast((degree + 1) ** 2, d)


@answers("gsplat", "spherical_harmonics", "_torch_impl._spherical_harmonics, which normalizes")
def normalized_harmonics(d, degree):
    """One coefficient of 1 at a time, so that each color is a harmonic."""
    count = (degree + 1) ** 2
    one = torch.eye(count, dtype=d.dtype)[..., None].expand(len(d), count, count, 3)
    return _spherical_harmonics(degree, d[:, None].expand(-1, count, -1), one)[..., 0]
