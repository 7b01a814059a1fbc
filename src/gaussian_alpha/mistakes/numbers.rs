//! Mistakes of splats' opacities that have a number.

use crate::contract::component::Mistake;

pub(super) const CUT: Mistake = Mistake::new(
    "cut_at_other_sigmas",
    "0 where d^T conic d > k^2",
    "splats end in a rim that is seen",
    "cut where alpha falls below 1/255, or nowhere",
    "never; cheap to keep",
    0,
)
.with("k", 2.0, [0.5, 6.0]);
pub(super) const FLOORED: Mistake = Mistake::new(
    "exponent_floored",
    "exp(max(-1/2 d^T conic d, -k))",
    "every splat is a veil over the whole picture, of e^-k times its opacity at least",
    "the exponent as it is: exp has no trouble with large negative ones",
    "1 public implementation",
    1,
)
.with("k", 10.0, [1.0, 80.0]);

pub(super) const SCALED: Mistake = Mistake::new(
    "exponent_scaled",
    "exp(-k d^T conic d) with k other than 1/2",
    "splats are larger or smaller than they were fitted",
    "1/2",
    "a WebGPU viewer, 1/16: its quads are cut at a distance of its own",
    1,
)
.with("k", 0.0625, [0.01, 10.0]);
pub(super) const BELOW: Mistake = Mistake::new(
    "cut_below_an_opacity",
    "0 where alpha < k, with k other than 1/255",
    "faint splats are lost, and what lies behind many of them comes through",
    "1/255, or everything counts",
    "a WGSL shader, 0.02; a viewer, 0.01",
    2,
)
.with("k", 0.02, [1e-6, 0.5]);
pub(super) const CAPPED: Mistake = Mistake::new(
    "capped_elsewhere",
    "min(alpha, k) with k other than 0.99 and 0.999",
    "more of what lies behind comes through than was trained",
    "0.99 as 3D Gaussian splatting has it, 0.999 as gsplat",
    "a renderer on CPUs: 0.995",
    1,
)
.with("k", 0.995, [0.3, 0.9999]);
pub(super) const CAPPED_BEFORE: Mistake = Mistake::new(
    "gaussian_capped",
    "opacity times min(exp(...), k)",
    "what is opaque lets light through where it shouldn't, and the rest as it is",
    "cap the product",
    "never; cheap to keep",
    0,
)
.with("k", 0.99, [0.3, 0.9999]);
pub(super) const CIRCLE: Mistake = Mistake::new(
    "cut_at_a_radius",
    "0 where |d| is above k deviations along the long axis, rounded up",
    "splats end in a rim",
    "a radius is for finding tiles: within a tile every pixel counts",
    "a Vulkan rasterizer, of 2 deviations",
    1,
)
.with("k", 3.0, [0.5, 6.0]);
pub(super) const SQUARE: Mistake = Mistake::new(
    "cut_at_a_square",
    "0 where |dx| or |dy| is above k deviations along the long axis, rounded up",
    "splats end in a rim",
    "a radius is for finding tiles: within a tile every pixel counts",
    "a wgpu rasterizer, 3",
    1,
)
.with("k", 3.0, [0.5, 6.0]);

pub(super) const DILATED: Mistake = Mistake::new(
    "covariance_dilated_again",
    "k is added to both variances of a covariance that the projection has dilated",
    "small splats are larger and slanted ones rounder than they were fitted",
    "the conic as it is",
    "1 renderer in Python: 1e-4 against what has no inverse",
    1,
)
.with("k", 0.3, [1e-6, 10.0]);
