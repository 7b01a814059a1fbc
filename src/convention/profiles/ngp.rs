//! Profiles of instant-ngp and of the library that it stands on.

use super::Profile;
use crate::convention::*;

/// instant-ngp.
pub(super) const NGP: Profile = Profile {
    name: "ngp",
    title: "NVlabs/instant-ngp",
    conventions: Conventions {
        delta: Delta::Differences,
        last_delta: LastDelta::Width,
        density: Density::Exp,
        grid_decay: GridDecay::EveryCell,
        grid_threshold: GridThreshold::MeanOverAll,
        hash_levels: HashLevels::TinyCudaNn,
        adam_eps: AdamEps::Uncorrected,
        huber_slope: HuberSlope::One,
        ..CS180
    },
    sources: &[
        (
            "grid_threshold",
            "src/testbed_nerf.cu update_density_grid_mean_and_bitfield: mean of fmaxf(val, 0) over all, and \
                 min(NERF_MIN_OPTICAL_THICKNESS(), mean)",
        ),
        (
            "huber_slope",
            "include/neural-graphics-primitives/nerf_device.cuh huber_loss: 0.5 / alpha * difference^2, |difference| - 0.5 alpha",
        ),
        ("hash_levels", "its encodings are tiny-cuda-nn's"),
        ("adam_eps", "its optimizer is tiny-cuda-nn's"),
        (
            "grid_decay",
            "src/testbed_nerf.cu ema_grid_samples_nerf: max(prev_val * decay, importance) in every cell that isn't below 0",
        ),
        ("density", "src/testbed_nerf.cu network_to_density: __expf (ENerfActivation::Exponential)"),
        (
            "exponent",
            "src/testbed_nerf.cu: network_to_density has __expf(val), network_to_density_derivative clamps val to [-15, 15]",
        ),
        ("delta", "src/testbed_nerf.cu calc_dt: the step of the march"),
        (
            "axes",
            "include/neural-graphics-primitives/nerf_loader.h nerf_matrix_to_ngp: poses are turned to z forward",
        ),
    ],
    beyond: "hash grid and spherical harmonics in place of the encoding; marching stops at T < 1e-4; its pictures, not its training, renormalize (`stopped`)",
};

/// tiny-cuda-nn.
pub(super) const TINY_CUDA_NN: Profile = Profile {
    name: "tiny-cuda-nn",
    title: "tiny-cuda-nn: hash grid, spherical harmonics, Adam",
    conventions: Conventions { hash_levels: HashLevels::TinyCudaNn, adam_eps: AdamEps::Uncorrected, ..CS180 },
    sources: &[
        (
            "hash_levels",
            "include/tiny-cuda-nn/encodings/grid.h kernel_grid: scale = exp2f(level * log2_per_level_scale) * \
                 base_resolution - 1, grid_resolution = ceil(scale) + 1; common_device.h pos_fract: scale * input + 0.5",
        ),
        (
            "hash_index",
            "include/tiny-cuda-nn/encodings/grid.h grid_index: by strides while they fit the table",
        ),
        ("hash_primes", "include/tiny-cuda-nn/encodings/grid.h: hash type CoherentPrime is the default"),
        ("hash_weights", "include/tiny-cuda-nn/encodings/grid.h: interpolation Linear is the default"),
        ("harmonic_sign", "include/tiny-cuda-nn/encodings/spherical_harmonics.h: -0.488 y"),
        ("harmonic_form", "include/tiny-cuda-nn/encodings/spherical_harmonics.h: 0.946 z2 - 0.315"),
        (
            "adam_eps",
            "include/tiny-cuda-nn/optimizers/adam.h adam_step: learning_rate * sqrt(1 - beta2^t) / (1 - beta1^t) / \
                 (sqrt(second_moment) + epsilon)",
        ),
    ],
    beyond: "harmonics are handed (d + 1) / 2 and turn it back; weight decay is beside the gradient, l2_reg in it; parameters \
                 of the encoding without a gradient take no step (adam_zero = left); hashes other than by exclusive or; half precision",
};
