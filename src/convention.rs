//! Conventions: choices that differ between right implementations, as data.
//!
//! A convention is never a mistake. Every oracle function takes the choices it depends on as arguments; this file bundles
//! them so that a profile (`cs180`, `nerf2020`, ...) can be named, and lists the closed set of values that the judge
//! searches when no profile is pinned.

mod camera;
mod compact;
mod cs180;
mod encoding;
mod gaussians;
mod network;
mod poses;
pub mod profiles;
mod proposals;
mod rendering;
mod results;
mod sampling;
mod space;
mod spelling;
mod training;

pub use camera::*;
pub use compact::*;
pub use cs180::CS180;
pub use encoding::*;
pub use gaussians::*;
pub use network::*;
pub use poses::*;
pub use proposals::*;
pub use rendering::*;
pub use results::*;
pub use sampling::*;
pub use space::*;
pub use spelling::{CHOICES, american};
pub use training::*;

use serde::{Deserialize, Serialize};

/// One assignment of all conventions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Conventions {
    /// Camera axes.
    pub axes: Axes,
    /// Camera axes of points at a depth, which code may have otherwise than its rays.
    #[serde(default)]
    pub camera_axes: Axes,
    /// What a quaternion's length means.
    #[serde(default)]
    pub quaternion: Quaternion,
    /// Pixel centers.
    #[serde(alias = "pixel_centre")]
    pub pixel_center: PixelCenter,
    /// Direction lengths.
    pub directions: Directions,
    /// Sample grid and what `u` scales.
    pub grid: Grid,
    /// Where samples rest at evaluation.
    pub rest: Rest,
    /// Step lengths.
    pub delta: Delta,
    /// Last step length.
    pub last_delta: LastDelta,
    /// Number added inside the product of transmittances.
    pub product_eps: ProductEps,
    /// Norm of the scene contraction.
    #[serde(default)]
    pub contraction_norm: ContractionNorm,
    /// Range of its result.
    #[serde(default)]
    pub contraction_range: ContractionRange,
    /// What a ray is taken for that has a width.
    #[serde(default)]
    pub ray_shape: RayShape,
    /// Where a scene lies in front of rays in normalized device coordinates.
    #[serde(default)]
    pub ndc_depth: NdcDepth,
    /// Whether the encoding begins with x itself.
    pub identity: bool,
    /// Where that stands.
    #[serde(default)]
    pub identity_place: IdentityPlace,
    /// Where it stands inside of a network that encodes by itself.
    #[serde(default)]
    pub network_identity: IdentityPlace,
    /// Factor of the encoding's bands.
    pub frequency: Frequency,
    /// Spacing of the encoding's bands.
    pub bands: Bands,
    /// Column order of the encoding.
    pub columns: Columns,
    /// How the encoding's cosine is computed.
    #[serde(default)]
    pub cosine: Cosine,
    /// Whether the integrated encoding keeps the mean itself.
    #[serde(default)]
    pub integrated_identity: bool,
    /// Density activation.
    pub density: Density,
    /// Where an exponential density's exponent is clamped.
    #[serde(default)]
    pub exponent: Exponent,
    /// Where its gradient is clamped.
    #[serde(default)]
    pub exponent_gradient: ExponentGradient,
    /// What is taken off it.
    #[serde(default)]
    pub exponent_shift: ExponentShift,
    /// Which cells of an occupancy grid fade.
    #[serde(default)]
    pub grid_decay: GridDecay,
    /// What an occupied cell is denser than.
    #[serde(default)]
    pub grid_threshold: GridThreshold,
    /// Cells below 0.
    #[serde(default)]
    pub grid_unseen: GridUnseen,
    /// How the levels of a hash grid lie on the box.
    #[serde(default)]
    pub hash_levels: HashLevels,
    /// Which of them have an entry for each vertex.
    #[serde(default)]
    pub hash_index: HashIndex,
    /// The factors of the hash.
    #[serde(default)]
    pub hash_primes: HashPrimes,
    /// How a hash grid interpolates.
    #[serde(default)]
    pub hash_weights: HashWeights,
    /// Sign of the harmonics of odd m.
    #[serde(default)]
    pub harmonic_sign: HarmonicSign,
    /// Polynomials of the harmonics.
    #[serde(default)]
    pub harmonic_form: HarmonicForm,
    /// What is added to the weights of a coarse pass.
    #[serde(default)]
    pub pdf_padding: PdfPadding,
    /// What the place inside a bin is divided by.
    #[serde(default)]
    pub pdf_division: PdfDivision,
    /// Which sample of a ray that stops is the last.
    #[serde(default)]
    pub stop: Stop,
    /// What becomes of such a ray.
    #[serde(default)]
    pub stopped: Stopped,
    /// The largest opacity.
    #[serde(default)]
    pub alpha_cap: AlphaCap,
    /// What becomes of faint samples.
    #[serde(default)]
    pub faint: Faint,
    /// Whether a ray ends where next to no light is left.
    #[serde(default)]
    pub alpha_stop: AlphaStop,
    /// Whether rendering passes densities through a ReLU.
    #[serde(default)]
    pub sigma_relu: SigmaRelu,
    /// What is behind a ray.
    #[serde(default)]
    pub backdrop: Backdrop,
    /// Which weights a ray's opacity adds up.
    #[serde(default)]
    pub opacity_sum: OpacitySum,
    /// What a ray's last sample is.
    #[serde(default)]
    pub last_sample: LastSample,
    /// Where a quaternion has its real part.
    #[serde(default)]
    pub quaternion_order: QuaternionOrder,
    /// Whether a rotation's quaternion is divided by its length.
    #[serde(default)]
    pub quaternion_length: QuaternionLength,
    /// What a Gaussian's scales are.
    #[serde(default)]
    pub splat_scale: SplatScale,
    /// Where pixels of splats have their centers.
    #[serde(default)]
    pub splat_center: SplatCenter,
    /// What is added to the variances of splats.
    #[serde(default)]
    pub splat_dilation: SplatDilation,
    /// How far beside the picture a projection's Jacobian is taken.
    #[serde(default)]
    pub splat_clamp: SplatClamp,
    /// What is constant where it is clamped.
    #[serde(default)]
    pub splat_clamp_gradient: SplatClampGradient,
    /// The least value under the root of a splat's eigenvalue.
    #[serde(default)]
    pub radius_floor: RadiusFloor,
    /// The least compensation of a dilated splat.
    #[serde(default)]
    pub compensation_floor: CompensationFloor,
    /// What a projection says of a splat beside the picture.
    #[serde(default)]
    pub splat_culling: SplatCulling,
    /// What becomes of splats that grow with the distance.
    #[serde(default)]
    pub positive_power: PositivePower,
    /// Whether a capped splat learns.
    #[serde(default)]
    pub cap_gradient: CapGradient,
    /// What the gradient of a conic's second number is.
    #[serde(default)]
    pub conic_gradient: ConicGradient,
    /// What is made of a splat's harmonics.
    #[serde(default)]
    pub splat_color: SplatColor,
    /// Index (from 0) of the trunk layer whose input contains the encoding again.
    pub skip_layer: usize,
    /// Order of that concatenation.
    pub skip_order: SkipOrder,
    /// Order of the color layer's input.
    #[serde(default)]
    pub color_order: ColorOrder,
    /// Activation after the last trunk layer.
    pub last_trunk: Activation,
    /// Activation of the feature layer.
    pub feature: Activation,
    /// Expected depth.
    pub depth: Depth,
    /// Depth of an empty ray.
    #[serde(default)]
    pub empty_depth: EmptyDepth,
    /// PSNR aggregation.
    pub psnr: PsnrOf,
    /// PSNR of equal pictures.
    #[serde(default)]
    pub psnr_floor: PsnrFloor,
    /// Peak of the PSNR.
    #[serde(default)]
    pub psnr_peak: PsnrPeak,
    /// What a robust loss makes of its entries.
    #[serde(default)]
    pub loss_reduction: LossReduction,
    /// The slope of Huber's loss.
    #[serde(default)]
    pub huber_slope: HuberSlope,
    /// What is added under the root of Charbonnier's.
    #[serde(default)]
    pub charbonnier_eps: CharbonnierEps,
    /// What the bound of an interlevel loss adds up.
    #[serde(default)]
    pub outer_edges: OuterEdges,
    /// What it makes of a ray's intervals.
    #[serde(default)]
    pub interlevel_reduction: LossReduction,
    /// What it adds to the weight that it divides by.
    #[serde(default)]
    pub interlevel_eps: InterlevelEps,
    /// Windows of structural similarity.
    #[serde(default)]
    pub ssim_window: SsimWindow,
    /// What they see beyond the picture.
    #[serde(default)]
    pub ssim_padding: SsimPadding,
    /// What its variances are divided by.
    #[serde(default)]
    pub ssim_variance: SsimVariance,
    /// Peak of its constants.
    #[serde(default)]
    pub ssim_peak: PsnrPeak,
    /// Quantization.
    pub bytes: Bytes,
    /// What Adam's eps is added to.
    #[serde(default)]
    pub adam_eps: AdamEps,
    /// What Adam does where a gradient is 0.
    #[serde(default)]
    pub adam_zero: AdamZero,
    /// What is added to a gradient's norm.
    #[serde(default)]
    pub clip_eps: ClipEps,
    /// Learning rates after a schedule's last step.
    #[serde(default)]
    pub rate_end: RateEnd,
    /// The delay of a log-linear schedule.
    #[serde(default)]
    pub rate_delay: RateDelay,
    /// How the rate rises in it.
    #[serde(default)]
    pub rate_ramp: RateRamp,
    /// Which half of a twist comes first.
    #[serde(default)]
    pub twist_order: TwistOrder,
    /// Whether a twist's rotation turns its translation on the way.
    #[serde(default)]
    pub twist_translation: TwistTranslation,
    /// The least angle that a rotation vector's factors are taken at.
    #[serde(default)]
    pub rotation_clamp: RotationClamp,
    /// Whether motions are for columns or for rows.
    #[serde(default)]
    pub motion_layout: MotionLayout,
    /// What a loss scale doesn't shrink below.
    #[serde(default)]
    pub loss_scale_floor: LossScaleFloor,
    /// What it doesn't grow beyond.
    #[serde(default)]
    pub loss_scale_ceiling: LossScaleCeiling,
    /// When a histogram is padded that is annealed.
    #[serde(default)]
    pub anneal_padding: AnnealPadding,
    /// What its bins without width weigh.
    #[serde(default)]
    pub flat_bins: FlatBins,
    /// What its sum is raised to.
    #[serde(default)]
    pub histogram_floor: HistogramFloor,
    /// What new edges are made of.
    #[serde(default)]
    pub edges_from: EdgesFrom,
    /// What becomes of the old ones.
    #[serde(default)]
    pub old_edges: OldEdges,
}
