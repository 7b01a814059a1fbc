"""A second implementation of every row of the contract, in numpy, right or wrong on purpose: what the judge is tested with.

    python tools/second.py CASES ANSWERS [--profile NAME] [--mistake COMPONENT:NAME ...]

It shares no code with the crate and takes other ways: products of (1 - alpha) for sums of depths, matrix products for loops, the
textbook's formulas where the crate has stable ones. It computes in the type of the cases' arrays. A mistake of the forward pass leaves
the hand-written gradient right, as it is in programs whose backward pass was written from the paper.
"""

import argparse
import sys
from pathlib import Path

import numpy as np
import second_geometry as geometry
import second_networks as networks
import second_rendering as rendering
import second_sampler as sampler
import second_sampling as sampling
import second_training as training
from candidate import inputs_of, read_manifest, write

CS180 = {
    "axes": "opencv",
    "pixel_centre": "half",
    "directions": "unit",
    "grid": "intervals",
    "rest": "mid",
    "delta": "width",
    "last_delta": "width",
    "product_eps": "none",
    "identity": "true",
    "frequency": "pi",
    "bands": "octaves",
    "columns": "band_sin_cos",
    "density": "relu",
    "skip_order": "hidden_first",
    "last_trunk": "relu",
    "feature": "none",
    "depth": "divided",
    "psnr": "images",
    "bytes": "round",
}

# Where well-known code deviates from it. The skip layer follows from the shapes.
DEVIATIONS = {
    "cs180": {},
    "nerf2020": {
        "axes": "opengl",
        "pixel_centre": "integer",
        "directions": "depth",
        "grid": "ends_between_midpoints",
        "delta": "differences",
        "last_delta": "1e10",
        "product_eps": "1e-10",
        "frequency": "one",
        "skip_order": "encoding_first",
        "depth": "plain",
        "bytes": "truncate",
    },
    "kornia-0.8.2": {
        "pixel_centre": "integer",
        "directions": "depth",
        "delta": "differences",
        "last_delta": "1e10",
        "product_eps": "1e-10",
        "frequency": "one",
        "bands": "linear",
        "depth": "plain",
    },
    "nerfstudio": {
        "axes": "opengl",
        "delta": "differences",
        "last_delta": "to_far",
        "frequency": "two_pi",
        "columns": "all_sin_all_cos",
        "density": "softplus",
        "skip_order": "encoding_first",
    },
    "multinerf": {
        "axes": "opengl",
        "directions": "depth",
        "delta": "differences",
        "last_delta": "to_far",
        "frequency": "one",
        "columns": "all_sin_all_cos",
        "density": "softplus",
    },
    "nerfacc": {
        "axes": "opengl",
        "delta": "differences",
        "last_delta": "to_far",
        "frequency": "one",
        "columns": "all_sin_all_cos",
    },
    "ngp": {"delta": "differences", "density": "exp"},
}


def render_trace(a, c, wrong):
    """The rows one after the other."""
    a = dict(a)
    shape = a["u"].shape
    if "jitter_ignored" in wrong:
        a["u"] = np.full_like(a["u"], 0.5)
    flat = {name: a[name].reshape(-1, *a[name].shape[2:]) for name in ("u", "sigmas", "rgbs")}
    out = geometry.image_rays(a, c, wrong)
    along = {**a, **flat, "rays_o": out["rays_o"].reshape(-1, 3), "rays_d": out["rays_d"].reshape(-1, 3)}
    t = geometry.sample_along_rays(along, c, wrong)["t"]
    if "steps_of_rest" in wrong:
        rest = geometry.positions(a["near"], a["far"], np.full_like(t, 0.5), c["grid"])
        deltas = geometry.step_sizes({**a, "t": rest}, c | {"delta": "differences", "last_delta": "repeated"}, wrong)["deltas"]
    else:
        deltas = geometry.step_sizes({**a, "t": t}, c, wrong)["deltas"]
    rendered = rendering.volume_render({**flat, "deltas": deltas}, c, wrong)
    colors = rendering.composite_background({**rendered, "background": a["background"]}, c, wrong)["colors_out"]
    last = {"t": t, "deltas": deltas, "weights": rendered["weights"]}
    return out | {name: x.reshape(shape) for name, x in last.items()} | {"colors": colors.reshape(*shape[:2], 3)}


FUNCTIONS = {"render_trace": render_trace} | {
    name: getattr(module, name)
    for module, names in {
        geometry: "transform transform_vjp pixel_to_camera pixel_to_camera_vjp pixel_to_ray pixel_to_ray_vjp image_rays "
        "sample_along_rays step_sizes",
        networks: "positional_encoding positional_encoding_vjp mlp mlp_vjp nerf_mlp nerf_mlp_vjp",
        rendering: "volume_render volume_render_vjp volume_render_alpha volume_render_alpha_vjp composite_background "
        "composite_background_vjp depth depth_vjp",
        training: "mse mse_vjp psnr to_uint8 adam_step",
        sampler: "sample_random_rays",
        sampling: "importance_sampling importance_sampling_vjp ray_aabb ray_aabb_vjp occupancy_grid grid_traversal",
    }.items()
    for name in names.split()
}


def answer(cases, answers, mistakes=(), conventions=None, only=None):
    """Answers all cases, or those of the components in `only`. Mistakes are (component, name)."""
    cases, answers = Path(cases), Path(answers)
    manifest = read_manifest(cases)
    conventions = conventions or CS180 | DEVIATIONS[manifest["profile"] or "cs180"]
    for case in manifest["cases"]:
        component = case["component"]
        function = FUNCTIONS.get(component + ("_vjp" if case["kind"] == "vjp" else ""))
        # A row that this implementation hasn't got stays unanswered, which the judge reports.
        if function and (only is None or component in only):
            wrong = [name for owner, name in mistakes if owner == component]
            inputs = inputs_of(cases, case, manifest["dtype"], "numpy", "cpu")
            with np.errstate(under="ignore"):
                write(answers / case["file"], function(inputs, conventions, wrong))


def main():
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", type=Path)
    parser.add_argument("answers", type=Path)
    parser.add_argument("--profile", choices=DEVIATIONS)
    parser.add_argument("--mistake", metavar="COMPONENT:NAME", action="append", default=[])
    arguments = parser.parse_args()
    mistakes = [tuple(mistake.split(":", 1)) for mistake in arguments.mistake]
    if any(len(mistake) != 2 or mistake[0] not in FUNCTIONS for mistake in mistakes):
        sys.exit(f"--mistake {arguments.mistake}: expected COMPONENT:NAME, as `nerf-oracle list` prints them")
    conventions = CS180 | DEVIATIONS[arguments.profile] if arguments.profile else None
    answer(arguments.cases, arguments.answers, mistakes, conventions)


if __name__ == "__main__":
    main()
