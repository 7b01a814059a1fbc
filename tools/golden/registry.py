"""Which components there are, which bases each has, and how a basis is built."""

import importlib

from . import bases, fixture

COMPONENTS = [
    "transform",
    "pixel_to_camera",
    "pixel_to_ray",
    "image_rays",
    "sample_along_rays",
    "step_sizes",
    "positional_encoding",
    "mlp",
    "nerf_mlp",
    "volume_render",
    "volume_render_alpha",
    "composite_background",
    "depth",
    "mse",
    "psnr",
    "to_uint8",
    "adam_step",
]
PACKAGES = {"mpmath": ["numpy", "mpmath"], "torch": ["numpy", "torch"], "kornia": ["numpy", "torch", "kornia"]}


def build(name):
    """The fixtures of one component, one for every basis that its module has."""
    module = importlib.import_module(f"golden.{name}")
    assert module.NAME == name
    built = {}
    if hasattr(module, "over_reals"):
        built["mpmath"] = bases.mpmath_basis(module)
    if hasattr(module, "in_torch"):
        built["torch"] = bases.torch_basis(module)
        bases.measure(built["torch"], built["mpmath"])
    if hasattr(module, "in_kornia"):
        built["kornia"] = bases.kornia_basis(module)
    return built.values()


def write(made, folder):
    """Writes one fixture with the versions of what made it."""
    fixture.write(made, folder, PACKAGES[made.basis])
