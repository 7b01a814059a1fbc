"""Which components there are, which bases each has, and how a basis is built."""

import importlib

import torch

from . import bases, fixture, kornia

COMPONENTS = [
    "transform",
    "pixel_to_camera",
    "lens_distort",
    "lens_undistort",
    "fisheye_distort",
    "fisheye_undistort",
    "pose_from_colmap",
    "so3_exp",
    "se3_exp",
    "pixel_to_ray",
    "image_rays",
    "ndc_rays",
    "sample_along_rays",
    "step_sizes",
    "conical_frustum",
    "contraction",
    "contract_gaussians",
    "positional_encoding",
    "integrated_encoding",
    "hash_grid",
    "spherical_harmonics",
    "trunc_exp",
    "mlp",
    "nerf_mlp",
    "volume_render",
    "volume_render_alpha",
    "composite_background",
    "depth",
    "pack_info",
    "packed_scan",
    "accumulate_along_rays",
    "early_stop",
    "gaussian_covariance",
    "gaussian_projection",
    "gaussian_alpha",
    "gaussian_color",
    "render_trace",
    "distortion_loss",
    "interlevel_loss",
    "mse",
    "huber",
    "charbonnier",
    "psnr",
    "to_uint8",
    "ssim",
    "linear_to_srgb",
    "loss_scale_update",
    "unscale_gradients",
    "clip_by_global_norm",
    "clip_by_value",
    "lr_exponential",
    "lr_cosine",
    "lr_log_linear",
    "adam_step",
    "adamw_step",
    "training_step",
    "importance_sampling",
    "proposal_pdf",
    "resample_edges",
    "ray_aabb",
    "occupancy_grid",
    "grid_traversal",
    # Several components in a row: no rows of the registry, but run through it.
    "loss_gradient",
    "adam",
    "loss_curve",
]
PACKAGES = {"mpmath": ["numpy", "mpmath"], "torch": ["numpy", "torch"], "kornia": ["numpy", "torch", "kornia"]}


def build(name):
    """The fixtures of one component, one for every basis that its module has."""
    module = importlib.import_module(f"golden.{name}")
    assert module.NAME == name
    torch.set_default_dtype(torch.float64)
    torch.set_num_threads(1)
    cases, patterns = list(module.cases()), module.DIFFERENTIABLE
    exact = bases.in_reals(module, cases, patterns)
    in_torch = bases.in_tensors(module, "torch", module.in_torch, cases, patterns)
    bases.measure(in_torch, exact)
    built = [exact, in_torch]
    if hasattr(module, "in_kornia"):
        cases, patterns = list(module.kornia_cases()), module.KORNIA_DIFFERENTIABLE
        in_kornia = bases.in_tensors(module, "kornia", module.in_kornia, cases, patterns)
        bases.measure(in_kornia, bases.in_reals(module, cases, patterns))
        in_kornia.known_differences = known_differences(in_kornia)
        built.append(in_kornia)
    return built


def known_differences(fixture):
    """The conventions and quirks of a fixture, each with its reason and the cases that have it."""
    found = []
    for name, reason in kornia.REASONS.items():
        cases = [c["name"] for c in fixture.cases if name in c.get("quirks", {}) or name in tags(c)]
        found += [{"name": name, "reason": reason, "cases": cases}] if cases else []
    named = {name for c in fixture.cases for name in [*c.get("quirks", {}), *tags(c)]}
    assert named <= set(kornia.REASONS), f"differences without a reason: {named - set(kornia.REASONS)}"
    return found


def tags(case):
    """The conventions of a case as `key=value`."""
    return [f"{key}={value}" for key, value in case.get("conventions", {}).items()]


def write(made, folder):
    """Writes one fixture with the versions of what made it."""
    fixture.write(made, folder, PACKAGES[made.basis])
