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
import second_compact as compact
import second_cones as cones
import second_distortion as distortion
import second_gaussians as gaussians
import second_fisheye as fisheye
import second_geometry as geometry
import second_harmonics as harmonics
import second_lens as lens
import second_motion as motion
import second_networks as networks
import second_packed as packed
import second_pose as pose
import second_proposals as proposals
import second_rates as rates
import second_rendering as rendering
import second_robust as robust
import second_sampler as sampler
import second_sampling as sampling
import second_scaling as scaling
import second_similarity as similarity
import second_space as space
import second_step as step
import second_training as training
from candidate import inputs_of, read_manifest, write

CS180 = {
    "axes": "opencv",
    "camera_axes": "opencv",
    "quaternion": "normalized",
    "pixel_center": "half",
    "directions": "unit",
    "grid": "intervals",
    "rest": "mid",
    "delta": "width",
    "last_delta": "width",
    "product_eps": "none",
    "contraction_norm": "l2",
    "contraction_range": "two",
    "ray_shape": "cone",
    "ndc_depth": "negative",
    "identity": "true",
    "identity_place": "first",
    "frequency": "pi",
    "bands": "octaves",
    "columns": "band_sin_cos",
    "cosine": "own",
    "integrated_identity": "false",
    "density": "relu",
    "grid_decay": "touched",
    "grid_threshold": "mean_of_dense",
    "grid_unseen": "kept",
    "hash_levels": "nearest",
    "hash_index": "dense_where_it_fits",
    "hash_primes": "coherent",
    "hash_weights": "linear",
    "harmonic_sign": "alternating",
    "harmonic_form": "sphere",
    "exponent": "free",
    "exponent_gradient": "both_ends",
    "exponent_shift": "none",
    "pdf_padding": "as_given",
    "pdf_division": "as_it_is",
    "stop": "behind",
    "stopped": "left",
    "alpha_cap": "none",
    "faint": "kept",
    "alpha_stop": "none",
    "sigma_relu": "none",
    "backdrop": "none",
    "opacity_sum": "all",
    "last_sample": "as_it_is",
    "quaternion_order": "wxyz",
    "quaternion_length": "divided",
    "splat_scale": "plain",
    "splat_center": "half",
    "splat_dilation": "0.3",
    "splat_clamp": "picture",
    "splat_clamp_gradient": "through",
    "radius_floor": "0.1",
    "compensation_floor": "none",
    "splat_culling": "kept",
    "positive_power": "kept",
    "cap_gradient": "stopped",
    "conic_gradient": "number",
    "splat_color": "clamped",
    "skip_order": "hidden_first",
    "color_order": "feature_first",
    "last_trunk": "relu",
    "feature": "none",
    "depth": "divided",
    "empty_depth": "far",
    "psnr": "images",
    "psnr_floor": "none",
    "psnr_peak": "given",
    "loss_reduction": "mean",
    "huber_slope": "delta",
    "charbonnier_eps": "square",
    "outer_edges": "touching",
    "interlevel_reduction": "mean",
    "interlevel_eps": "as_given",
    "ssim_window": "gaussian",
    "ssim_padding": "valid",
    "ssim_variance": "population",
    "ssim_peak": "given",
    "bytes": "round",
    "adam_eps": "corrected",
    "adam_zero": "stepped",
    "clip_eps": "none",
    "rate_end": "goes_on",
    "rate_delay": "beside",
    "rate_ramp": "sine",
    "twist_order": "translation_first",
    "twist_translation": "coupled",
    "rotation_clamp": "none",
    "motion_layout": "for_columns",
    "loss_scale_floor": "none",
    "loss_scale_ceiling": "none",
    "anneal_padding": "before",
    "flat_bins": "dropped",
    "histogram_floor": "none",
    "edges_from": "midpoints",
    "old_edges": "dropped",
}

# Where well-known code deviates from it. The skip layer follows from the shapes.
DEVIATIONS = {
    "cs180": {},
    "nerf2020": {
        "axes": "opengl",
        "pixel_center": "integer",
        "directions": "depth",
        "grid": "ends_between_midpoints",
        "delta": "differences_times_norm",
        "last_delta": "1e10",
        "product_eps": "1e-10",
        "pdf_padding": "1e-5",
        "pdf_division": "snapped",
        "edges_from": "samples",
        "old_edges": "kept",
        "sigma_relu": "inside",
        "frequency": "one",
        "skip_order": "encoding_first",
        "depth": "plain",
        "bytes": "truncate",
    },
    "kornia-0.8.2": {
        "pixel_center": "integer",
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
        "contraction_norm": "linf",
        "contraction_range": "unit",
        "identity_place": "last",
        "frequency": "two_pi",
        "columns": "all_sin_all_cos",
        "cosine": "shifted_sine",
        "density": "softplus",
        "hash_levels": "floor",
        "hash_index": "hashed",
        "harmonic_sign": "plain",
        "skip_order": "encoding_first",
        "empty_depth": "first",
        "integrated_identity": "true",
        "interlevel_eps": "1e-7",
        "clip_eps": "1e-6",
        "rate_delay": "before",
        "twist_translation": "plain",
        "rotation_clamp": "0.01",
        "anneal_padding": "after",
        "flat_bins": "kept",
        "histogram_floor": "1e-5",
        "edges_from": "samples",
    },
    "multinerf": {
        "axes": "opengl",
        "directions": "depth",
        "delta": "differences_times_norm",
        "last_delta": "to_far",
        "frequency": "one",
        "columns": "all_sin_all_cos_by_band",
        "cosine": "shifted_sine",
        "density": "softplus",
        "empty_depth": "last",
        "interlevel_eps": "float32",
        "ssim_peak": "one",
        "clip_eps": "float32",
    },
    "nerfacc": {
        "axes": "opengl",
        "delta": "differences",
        "last_delta": "to_far",
        "contraction_range": "unit",
        "frequency": "one",
        "columns": "all_sin_all_cos_by_band",
        "cosine": "shifted_sine",
        "exponent_gradient": "above",
        "exponent_shift": "one",
        "grid_threshold": "mean_of_seen",
        "empty_depth": "zero",
        "huber_slope": "one",
        "interlevel_eps": "1e-7",
    },
    "ngp": {
        "delta": "differences",
        "density": "exp",
        "grid_decay": "every_cell",
        "grid_threshold": "mean_over_all",
        "hash_levels": "tiny_cuda_nn",
        "adam_eps": "uncorrected",
        "huber_slope": "one",
    },
    "tiny-cuda-nn": {"hash_levels": "tiny_cuda_nn", "adam_eps": "uncorrected"},
    "gsplat": {
        "radius_floor": "0.01",
        "alpha_cap": "0.999",
        "faint": "skipped",
        "alpha_stop": "in_front",
        "positive_power": "skipped",
        "stop": "in_front",
        "harmonic_form": "normalized",
        "ssim_peak": "one",
    },
    "3dgs": {
        "quaternion": "as_given",
        "quaternion_length": "as_given",
        "splat_center": "integer",
        "splat_clamp": "centered",
        "splat_clamp_gradient": "held",
        "compensation_floor": "0.005",
        "alpha_cap": "0.99",
        "faint": "skipped",
        "alpha_stop": "in_front",
        "positive_power": "skipped",
        "cap_gradient": "through",
        "conic_gradient": "entry",
        "stop": "in_front",
        "harmonic_form": "homogeneous",
        "ssim_padding": "zero",
        "ssim_peak": "one",
    },
}


STEPS = (
    "delta_missing delta_unit_interval delta_over_n_minus_1 backward_delta delta_differenced_twice first_gap_for_all first_ray_deltas"
).split()


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
    deltas = geometry.step_sizes({**a, "t": t}, c, wrong)["deltas"]
    if c["delta"] == "differences_times_norm":
        deltas = deltas * np.linalg.norm(along["rays_d"], axis=1, keepdims=True)
    # Steps are made once: what is wrong with them isn't made wrong again.
    wrong = [name for name in wrong if name not in STEPS]
    rendered = rendering.volume_render({**flat, "deltas": deltas}, c, wrong)
    # T in front of the last sample, and what the last sample leaves of it.
    left = 1 - rendered["opacity"]
    front = left + rendered["weights"][:, -1]
    if "background_before_last_sample" in wrong:
        rendered["opacity"] = 1 - front
    if "background_shaded_twice" in wrong:
        rendered["opacity"] = 1 - left * np.divide(left, front, out=np.zeros_like(left), where=front != 0)
    colors = rendering.composite_background({**rendered, "background": a["background"]}, c, wrong)["colors_out"]
    last = {"t": t, "deltas": deltas, "weights": rendered["weights"]}
    return out | {name: x.reshape(shape) for name, x in last.items()} | {"colors": colors.reshape(*shape[:2], 3)}


FUNCTIONS = {"render_trace": render_trace} | {
    name: getattr(module, name)
    for module, names in {
        geometry: "transform transform_vjp pixel_to_camera pixel_to_camera_vjp pixel_to_ray pixel_to_ray_vjp image_rays "
        "sample_along_rays step_sizes",
        networks: "positional_encoding positional_encoding_vjp mlp mlp_vjp nerf_mlp nerf_mlp_vjp",
        cones: "conical_frustum conical_frustum_vjp integrated_encoding integrated_encoding_vjp",
        lens: "lens_distort lens_distort_vjp lens_undistort lens_undistort_vjp",
        fisheye: "fisheye_distort fisheye_distort_vjp fisheye_undistort fisheye_undistort_vjp",
        pose: "pose_from_colmap pose_from_colmap_vjp",
        motion: "so3_exp so3_exp_vjp se3_exp se3_exp_vjp",
        space: "contraction contraction_vjp contract_gaussians contract_gaussians_vjp ndc_rays ndc_rays_vjp",
        gaussians: "gaussian_covariance gaussian_covariance_vjp gaussian_projection gaussian_projection_vjp gaussian_alpha gaussian_alpha_vjp "
        "gaussian_color gaussian_color_vjp",
        harmonics: "spherical_harmonics spherical_harmonics_vjp",
        rendering: "volume_render volume_render_vjp volume_render_alpha volume_render_alpha_vjp composite_background "
        "composite_background_vjp depth depth_vjp",
        packed: "pack_info packed_scan packed_scan_vjp accumulate_along_rays accumulate_along_rays_vjp",
        distortion: "distortion_loss distortion_loss_vjp interlevel_loss interlevel_loss_vjp",
        compact: "trunc_exp trunc_exp_vjp early_stop early_stop_vjp hash_grid hash_grid_vjp",
        training: "mse mse_vjp psnr to_uint8 linear_to_srgb linear_to_srgb_vjp adam_step adamw_step",
        rates: "lr_exponential lr_cosine lr_log_linear clip_by_global_norm clip_by_value",
        scaling: "loss_scale_update unscale_gradients",
        step: "training_step",
        proposals: "proposal_pdf resample_edges",
        robust: "huber huber_vjp charbonnier charbonnier_vjp",
        similarity: "ssim ssim_vjp",
        sampler: "sample_random_rays",
        sampling: "importance_sampling importance_sampling_vjp ray_aabb ray_aabb_vjp occupancy_grid grid_traversal",
    }.items()
    for name in names.split()
}


def differentiated(function, a, c, wrong, wanted):
    """What automatic differentiation makes of a wrong forward function: differences over five points, in the longest type there is, as
    a camera may be a million units away. All lie to the right: at a face or a step, it takes the side that the function is on."""
    long = np.longdouble
    a = {n: x.astype(long) if isinstance(x, np.ndarray) else x for n, x in a.items()}
    cotangents = {n.removeprefix("grad_"): x for n, x in a.items() if n.startswith("grad_")}

    def inner():
        outputs = function(a, c, wrong)
        return sum((outputs[n] * g).sum() for n, g in cotangents.items())

    out = {}
    for name in wanted:
        x, gradient = a[name], np.zeros_like(a[name])
        for i in np.ndindex(x.shape):
            at = x[i]
            h = long(2.0**-20) * max(long(0.1), min(abs(at), long(1)), abs(at) * long(2.0**-10))
            slope = long(0)
            for step, factor in enumerate((-25, 48, -36, 16, -3)):
                x[i] = at + step * h
                slope += factor * inner()
            x[i] = at
            gradient[i] = slope / (12 * h)
        out[f"grad_{name}"] = gradient
    if "grad_c2w" in out:
        # The contract's pose is the upper three rows.
        out["grad_c2w"] = out["grad_c2w"] * np.array([[1], [1], [1], [0]])
    if "grad_K" in out:
        # The contract's K is (fx, fy, cx, cy) alone.
        out["grad_K"] = out["grad_K"] * np.array([[1, 0, 1], [0, 1, 1], [0, 0, 0]])
    return out


def answer(cases, answers, mistakes=(), conventions=None, only=None, autograd=False):
    """Answers all cases, or those of the components in `only`. Mistakes are (component, name); with `autograd` gradients are those of
    the wrong forward function."""
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
                if autograd and wrong and case["kind"] == "vjp":
                    wanted = [port["name"].removeprefix("grad_") for port in case["outputs"]]
                    outputs = differentiated(FUNCTIONS[component], inputs, conventions, wrong, wanted)
                    outputs = {n: x.astype(np.float64 if manifest["dtype"] == "f64" else np.float32) for n, x in outputs.items()}
                else:
                    outputs = function(inputs, conventions, wrong)
                if outputs is not None:
                    write(answers / case["file"], outputs)


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
