//! Mistakes in projections of splats that have a number.

use crate::contract::component::Mistake;

pub(super) const OTHER_SIGMAS: Mistake = Mistake::new(
    "another_count_of_sigmas",
    "k sqrt(lambda) with k other than 3",
    "splats are cut off while they are seen, or reach too far",
    "3",
    "never; cheap to keep",
    0,
)
.with("k", 2.0, [0.5, 10.0]);
pub(super) const OTHER_LIMIT: Mistake = Mistake::new(
    "another_limit_of_slopes",
    "slopes are held to k half pictures, with k other than 1.3",
    "splats beside the picture lean otherwise",
    "1.3",
    "never; cheap to keep",
    0,
)
.with("k", 1.0, [0.5, 10.0]);

pub(super) const OTHER_DILATION: Mistake = Mistake::new(
    "dilated_by_another_number",
    "a + k and c + k with k other than 0.3",
    "splats are thicker or thinner on the screen than they were trained to be",
    "0.3 as 3D Gaussian splatting has it, or the number of the training",
    "renderers of their own: 1e-6 in C#, 0.09 in wgpu",
    2,
)
.with("k", 0.1, [1e-9, 10.0]);
pub(super) const COMPENSATION_HELD: Mistake = Mistake::new(
    "compensation_held",
    "sqrt(det / det') is k at least",
    "splats that are far below a pixel stay visible",
    "the ratio as it is, or one of the known floors",
    "a renderer in Metal: 0.25",
    1,
)
.with("k", 0.25, [1e-2, 0.99]);
pub(super) const RADIUS_HELD: Mistake = Mistake::new(
    "radius_held",
    "the radius is k at most",
    "large splats end in a square",
    "the radius as it is: what is behind the camera is left out by its depth",
    "a renderer in Metal: 512; one in WebGPU: 1024",
    2,
)
.with("k", 64.0, [4.0, 8192.0]);
pub(super) const COVARIANCE_SCALED: Mistake = Mistake::new(
    "covariance_scaled",
    "k times the covariance: scales in another unit, or a viewer's slider",
    "splats that are larger or smaller than they were trained",
    "1",
    "never; cheap to keep",
    0,
)
.with("k", 4.0, [0.01, 100.0]);

pub(super) const DETERMINANT_HELD: Mistake = Mistake::new(
    "determinant_held",
    "max(det, k) in what the conic is divided by",
    "thin splats are fainter than they should be",
    "the determinant: 0.3 on the diagonal keeps it above 0.09",
    "1 public implementation, with 1e-3",
    1,
)
.with("k", 1.0, [1e-8, 10.0])
.or(&[1e-3, 1e-6]);
