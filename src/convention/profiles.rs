//! Profiles: conventions of well-known code, as data, each value with the file it was read from.

mod kornia;
mod ngp;
mod splats;

use std::collections::BTreeMap;

use super::*;
use crate::error::{Error, Result};

/// The conventions of one code base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Profile {
    /// Name, as `--profile` takes it.
    pub name: &'static str,
    /// What it is.
    pub title: &'static str,
    /// The assignment.
    pub conventions: Conventions,
    /// Convention -> the file that its value was read from, and what it says.
    pub sources: &'static [(&'static str, &'static str)],
    /// What in this code no convention expresses.
    pub beyond: &'static str,
}

/// All of them; the default first. Where a convention doesn't apply to a code base (a hash grid has no bands), the default's value is
/// kept, and `sources` has no entry.
pub const PROFILES: &[Profile] = &[
    Profile {
        name: "cs180",
        title: "Berkeley CS180, project on neural radiance fields: the paper's text taken literally",
        conventions: CS180,
        sources: &[
            ("axes", "course page: x right, y down, z forward, c2w as given in lego_200x200.npz"),
            ("pixel_center", "course page: add 0.5 to the pixel grid"),
            ("directions", "course page: r_d = (X_w - r_o) / |X_w - r_o|"),
            ("grid", "course page: t in [near, far], perturbed by U[0, 1) times the width"),
            ("frequency", "NeRF (2020), equation 4: sin(2^k pi x), cos(2^k pi x)"),
            ("identity", "course page: keep the original input in front"),
            ("skip_layer", "NeRF (2020), figure 7: the encoding again into the fifth layer"),
        ],
        beyond: "",
    },
    Profile {
        name: "nerf2020",
        title: "the original NeRF (bmild/nerf)",
        conventions: Conventions {
            axes: Axes::Opengl,
            pixel_center: PixelCenter::Integer,
            directions: Directions::Depth,
            grid: Grid::EndsBetweenMidpoints,
            delta: Delta::DifferencesTimesNorm,
            last_delta: LastDelta::TenToTen,
            product_eps: ProductEps::TenToMinusTen,
            pdf_padding: PdfPadding::TenToMinusFive,
            pdf_division: PdfDivision::Snapped,
            edges_from: EdgesFrom::Samples,
            old_edges: OldEdges::Kept,
            sigma_relu: SigmaRelu::Inside,
            frequency: Frequency::One,
            skip_layer: 5,
            skip_order: SkipOrder::EncodingFirst,
            depth: Depth::Plain,
            bytes: Bytes::Truncate,
            ..CS180
        },
        sources: &[
            ("axes", "run_nerf_helpers.py get_rays: [(i-W/2)/f, -(j-H/2)/f, -1]"),
            ("pixel_center", "run_nerf_helpers.py get_rays: range(W), range(H), center W*.5"),
            ("directions", "run_nerf_helpers.py get_rays: not normalized"),
            ("grid", "run_nerf.py render_rays: linspace with both ends, bins between mids"),
            ("delta", "run_nerf.py raw2outputs: z_vals[1:] - z_vals[:-1], times the norm of the direction"),
            ("last_delta", "run_nerf.py raw2outputs: 1e10"),
            ("sigma_relu", "run_nerf.py raw2outputs: 1 - exp(-act_fn(raw) * dists), act_fn = tf.nn.relu"),
            ("product_eps", "run_nerf.py raw2outputs: cumprod(1 - alpha + 1e-10)"),
            ("pdf_padding", "run_nerf_helpers.py sample_pdf: weights + 1e-5"),
            ("pdf_division", "run_nerf_helpers.py sample_pdf: where(denom < 1e-5, 1, denom)"),
            ("edges_from", "run_nerf.py render_rays: the samples themselves, which are points there"),
            ("old_edges", "run_nerf.py render_rays: sort(concat([z_vals, z_samples]))"),
            ("ndc_depth", "run_nerf_helpers.py ndc_rays: t = -(near + rays_o[..., 2]) / rays_d[..., 2]"),
            ("frequency", "run_nerf_helpers.py Embedder: 2^k without pi"),
            ("columns", "run_nerf_helpers.py Embedder: for each frequency sin, cos of all dimensions"),
            ("density", "run_nerf.py raw2alpha: relu"),
            (
                "skip_layer",
                "run_nerf_helpers.py init_nerf_model: concatenated after layer 4, read by layer 5 (from 0)",
            ),
            ("skip_order", "run_nerf_helpers.py init_nerf_model: [inputs_pts, outputs]"),
            ("feature", "run_nerf_helpers.py init_nerf_model: bottleneck with act=None"),
            ("depth", "run_nerf.py raw2outputs: sum of weights * z_vals"),
            ("bytes", "run_nerf_helpers.py to8b: astype(uint8)"),
        ],
        beyond: "directions are unit length for the network alone",
    },
    kornia::KORNIA,
    Profile {
        name: "nerfstudio",
        title: "nerfstudio's vanilla NeRF",
        conventions: Conventions {
            axes: Axes::Opengl,
            delta: Delta::Differences,
            last_delta: LastDelta::ToFar,
            contraction_norm: ContractionNorm::Linf,
            contraction_range: ContractionRange::Unit,
            identity_place: IdentityPlace::Last,
            frequency: Frequency::TwoPi,
            columns: Columns::AllSinAllCos,
            cosine: Cosine::ShiftedSine,
            density: Density::Softplus,
            hash_levels: HashLevels::Floor,
            hash_index: HashIndex::Hashed,
            harmonic_sign: HarmonicSign::Plain,
            skip_order: SkipOrder::EncodingFirst,
            empty_depth: EmptyDepth::First,
            integrated_identity: true,
            interlevel_eps: InterlevelEps::TenToMinusSeven,
            clip_eps: ClipEps::TenToMinusSix,
            rate_delay: RateDelay::Before,
            twist_translation: TwistTranslation::Plain,
            rotation_clamp: RotationClamp::Hundredth,
            anneal_padding: AnnealPadding::After,
            flat_bins: FlatBins::Kept,
            histogram_floor: HistogramFloor::TenToMinusFive,
            edges_from: EdgesFrom::Samples,
            ..CS180
        },
        sources: &[
            (
                "twist_order",
                "nerfstudio/cameras/lie_groups.py exp_map_SO3xR3: length-3 translations, followed by an so(3) tangent vector",
            ),
            (
                "twist_translation",
                "nerfstudio/cameras/lie_groups.py exp_map_SO3xR3: ret[:, :3, 3] = tangent_vector[:, :3]",
            ),
            ("rotation_clamp", "nerfstudio/cameras/lie_groups.py exp_map_SO3xR3: clamp(nrms, 1e-4).sqrt()"),
            ("motion_layout", "nerfstudio/cameras/lie_groups.py exp_map_SO3xR3: [R|t]"),
            (
                "outer_edges",
                "nerfstudio/model_components/losses.py outer: searchsorted, side right, for both ends",
            ),
            ("interlevel_eps", "nerfstudio/model_components/losses.py: EPS = 1.0e-7"),
            ("anneal_padding", "ray_samplers.py: weights**anneal, then weights + histogram_padding"),
            ("flat_bins", "model_components/ray_samplers.py PDFSampler: no look at widths"),
            ("histogram_floor", "ray_samplers.py PDFSampler: relu(eps - weights_sum), eps = 1e-5"),
            ("edges_from", "ray_samplers.py PDFSampler: num_samples + 1 bins at u"),
            (
                "old_edges",
                "ray_samplers.py ProposalNetworkSampler: PDFSampler(include_original=False), not its default",
            ),
            (
                "clip_eps",
                "nerfstudio/engine/optimizers.py optimizer_step_all: torch.nn.utils.clip_grad_norm_, which adds 1e-6",
            ),
            (
                "rate_delay",
                "nerfstudio/engine/schedulers.py ExponentialDecayScheduler: (step - warmup_steps) / (max_steps - warmup_steps)",
            ),
            (
                "rate_ramp",
                "nerfstudio/engine/schedulers.py ExponentialDecaySchedulerConfig: ramp = cosine, a sine of a quarter turn",
            ),
            (
                "rate_end",
                "nerfstudio/engine/schedulers.py CosineDecayScheduler: cos(pi * progress), not clipped",
            ),
            ("interlevel_reduction", "nerfstudio/model_components/losses.py interlevel_loss: torch.mean"),
            ("axes", "cameras/cameras.py: OpenGL"),
            ("pixel_center", "cameras/cameras.py get_image_coords: pixel_offset 0.5"),
            ("directions", "cameras/rays.py RayBundle: unit ray direction vector"),
            ("delta", "cameras/rays.py get_ray_samples: bin_ends - bin_starts"),
            ("product_eps", "cameras/rays.py get_weights: exp(-cumsum), nothing added"),
            ("contraction_norm", "models/nerfacto.py: SceneContraction(order=float(\"inf\"))"),
            ("contraction_range", "fields/nerfacto_field.py get_density: (positions + 2.0) / 4.0"),
            ("frequency", "field_components/encodings.py NeRFEncoding: 2 pi x"),
            (
                "columns",
                "field_components/encodings.py NeRFEncoding: sin of all (dimension, frequency) pairs, then cos",
            ),
            (
                "identity_place",
                "field_components/encodings.py NeRFEncoding: cat([encoded_inputs, in_tensor])",
            ),
            (
                "integrated_identity",
                "field_components/encodings.py NeRFEncoding with covs: cat([encoded_inputs, in_tensor])",
            ),
            ("ray_shape", "cameras/rays.py Frustums.get_gaussian_blob: conical_frustum_to_gaussian"),
            ("cosine", "field_components/encodings.py NeRFEncoding: sin(cat([scaled, scaled + pi / 2]))"),
            ("exponent_gradient", "field_components/activations.py: clamp(x, min=-15, max=15)"),
            (
                "hash_levels",
                "field_components/encodings.py HashEncoding: floor(min_res * growth_factor**levels)",
            ),
            ("hash_index", "field_components/encodings.py HashEncoding.pytorch_fwd: hash_fn for every level"),
            ("harmonic_sign", "utils/math.py components_from_spherical_harmonics: no (-1)^m"),
            ("harmonic_form", "utils/math.py components_from_spherical_harmonics: 0.946 zz - 0.315"),
            (
                "empty_depth",
                "model_components/renderers.py DepthRenderer expected: clip(depth, steps.min(), steps.max())",
            ),
            ("density", "field_components/field_heads.py DensityFieldHead: Softplus"),
            (
                "skip_layer",
                "field_components/mlp.py: in front of layer 4; fields/vanilla_nerf_field.py skip_connections (4,)",
            ),
            ("skip_order", "field_components/mlp.py: cat([in_tensor, x])"),
            ("last_trunk", "fields/vanilla_nerf_field.py mlp_base: out_activation ReLU"),
            (
                "depth",
                "model_components/renderers.py DepthRenderer expected: divided by sum of weights + 1e-10",
            ),
        ],
        beyond: "vanilla NeRF's exponents run from 0 to 8 in ten steps, not octaves, mip-NeRF's from 0 to 16 in sixteen; Gaussians \
                 are contracted by their length alone; no feature layer; in the torch code of older versions (1.1.5 has them \
                 right) two harmonics of band 4 are others",
    },
    Profile {
        name: "multinerf",
        title: "google-research/multinerf (mip-NeRF 360, Ref-NeRF, RawNeRF)",
        conventions: Conventions {
            axes: Axes::Opengl,
            directions: Directions::Depth,
            delta: Delta::DifferencesTimesNorm,
            last_delta: LastDelta::ToFar,
            frequency: Frequency::One,
            columns: Columns::AllSinAllCosByBand,
            cosine: Cosine::ShiftedSine,
            density: Density::Softplus,
            empty_depth: EmptyDepth::Last,
            skip_layer: 5,
            ssim_peak: PsnrPeak::One,
            interlevel_eps: InterlevelEps::Float32,
            clip_eps: ClipEps::Float32,
            ..CS180
        },
        sources: &[
            ("outer_edges", "internal/stepfun.py searchsorted: v >= a, for both ends"),
            ("anneal_padding", "internal/models.py Model: anneal * log(weights + resample_padding)"),
            ("flat_bins", "internal/models.py Model: where(sdist[1:] > sdist[:-1], ..., -inf)"),
            ("histogram_floor", "internal/stepfun.py invert_cdf: softmax, nothing added"),
            ("edges_from", "internal/stepfun.py sample_intervals: (centers[1:] + centers[:-1]) / 2"),
            ("old_edges", "internal/stepfun.py sample_intervals: the new ones alone"),
            ("interlevel_eps", "internal/stepfun.py lossfun_outer: jnp.finfo(jnp.float32).eps"),
            ("clip_eps", "internal/train_utils.py clip_gradients: jnp.finfo(jnp.float32).eps + tree_norm"),
            ("rate_delay", "internal/math.py learning_rate_decay: delay_rate * log_lerp"),
            (
                "rate_ramp",
                "internal/math.py learning_rate_decay: sin(0.5 * pi * clip(step / lr_delay_steps, 0, 1))",
            ),
            ("interlevel_reduction", "internal/train_utils.py interlevel_loss: mean(lossfun_outer)"),
            ("axes", "internal/camera_utils.py pixels_to_rays: diag(1, -1, -1), from OpenCV to OpenGL"),
            ("pixel_center", "internal/camera_utils.py pix_to_dir: x + .5, y + .5"),
            (
                "directions",
                "internal/camera_utils.py pixels_to_rays: directions as they are, viewdirs normalized",
            ),
            (
                "delta",
                "internal/render.py compute_alpha_weights: differences times the norm of the direction",
            ),
            ("product_eps", "internal/render.py compute_alpha_weights: exp(-cumsum), nothing added"),
            (
                "charbonnier_eps",
                "internal/train_utils.py compute_data_loss: sqrt(resid_sq + config.charb_padding**2)",
            ),
            (
                "ssim_window",
                "internal/image.py MetricHarness: dm_pix.ssim; dm_pix/_src/metrics.py ssim: filter_size = 11, filter_sigma = 1.5",
            ),
            ("ssim_padding", "dm_pix/_src/metrics.py ssim: jnp.convolve, mode = valid"),
            ("ssim_peak", "dm_pix/_src/metrics.py ssim: max_val = 1.0"),
            ("contraction_norm", "internal/coord.py contract: sum(x**2)"),
            ("contraction_range", "internal/coord.py contract: not scaled"),
            ("ray_shape", "internal/models.py Model: ray_shape = 'cone'"),
            ("integrated_identity", "internal/coord.py integrated_pos_enc: nothing appended"),
            (
                "ndc_depth",
                "internal/camera_utils.py convert_to_ndc: t = -(near + origins[..., 2]) / directions[..., 2]",
            ),
            ("frequency", "internal/coord.py pos_enc: 2^arange(min_deg, max_deg)"),
            ("identity", "internal/coord.py pos_enc: append_identity"),
            (
                "columns",
                "internal/coord.py pos_enc: sin of all (frequency, dimension) pairs, then sin(x + pi / 2)",
            ),
            ("cosine", "internal/coord.py pos_enc: sin(concatenate([scaled_x, scaled_x + 0.5 * pi]))"),
            (
                "empty_depth",
                "internal/render.py volumetric_rendering: nan_to_num to infinity, clipped to tdist",
            ),
            ("density", "internal/models.py MLP.density_activation: softplus"),
            ("skip_layer", "internal/models.py MLP: concatenated after layer 4, read by layer 5 (from 0)"),
            ("skip_order", "internal/models.py MLP: [x, inputs]"),
            ("depth", "internal/render.py volumetric_rendering: expectation divided by acc"),
        ],
        beyond: "positions are encoded as Gaussians; -1 is added to the raw density; colors are padded by 0.001; depth is the \
                 exponential of the expected logarithm",
    },
    Profile {
        name: "nerfacc",
        title: "nerfacc with the vanilla NeRF of its examples",
        conventions: Conventions {
            axes: Axes::Opengl,
            delta: Delta::Differences,
            last_delta: LastDelta::ToFar,
            contraction_range: ContractionRange::Unit,
            frequency: Frequency::One,
            columns: Columns::AllSinAllCosByBand,
            cosine: Cosine::ShiftedSine,
            exponent_gradient: ExponentGradient::Above,
            exponent_shift: ExponentShift::One,
            grid_threshold: GridThreshold::MeanOfSeen,
            skip_layer: 5,
            empty_depth: EmptyDepth::Zero,
            huber_slope: HuberSlope::One,
            interlevel_eps: InterlevelEps::TenToMinusSeven,
            ..CS180
        },
        sources: &[
            ("edges_from", "nerfacc/cuda/csrc/pdf.cu compute_intervels_kernel: (t + t_prev) * 0.5f"),
            ("old_edges", "nerfacc/cuda/csrc/pdf.cu compute_intervels_kernel: the new ones alone"),
            ("interlevel_eps", "nerfacc/estimators/prop_net.py _pdf_loss: eps = 1e-7"),
            ("axes", "examples/datasets/nerf_synthetic.py: OPENGL_CAMERA = True"),
            ("pixel_center", "examples/datasets/nerf_synthetic.py: x - cx + 0.5"),
            ("directions", "examples/datasets/nerf_synthetic.py: viewdirs normalized"),
            ("delta", "nerfacc/volrend.py render_transmittance_from_density: t_ends - t_starts"),
            ("product_eps", "nerfacc/volrend.py: exp(-exclusive_sum), nothing added"),
            (
                "contraction_norm",
                "examples/radiance_fields/ngp.py contract_to_unisphere: linalg.norm(x, ord=2)",
            ),
            ("contraction_range", "examples/radiance_fields/ngp.py contract_to_unisphere: x / 4 + 0.5"),
            (
                "grid_decay",
                "nerfacc/estimators/occ_grid.py _update: occs[cell_ids] = maximum(occs[cell_ids] * ema_decay, occ)",
            ),
            (
                "grid_threshold",
                "nerfacc/estimators/occ_grid.py _update: clamp(occs[occs >= 0].mean(), max=occ_thre)",
            ),
            ("frequency", "examples/radiance_fields/mlp.py SinusoidalEncoder: 2^i"),
            (
                "columns",
                "examples/radiance_fields/mlp.py SinusoidalEncoder: sin of all (frequency, dimension) pairs first",
            ),
            ("cosine", "examples/radiance_fields/mlp.py SinusoidalEncoder: sin(cat([xb, xb + 0.5 * pi]))"),
            ("exponent_gradient", "examples/radiance_fields/ngp.py _TruncExp: clamp(x, max=15)"),
            ("exponent_shift", "examples/radiance_fields/ngp.py density_activation: trunc_exp(x - 1)"),
            ("empty_depth", "nerfacc/volrend.py rendering: divided by opacities.clamp_min(eps)"),
            ("density", "examples/radiance_fields/mlp.py VanillaNeRFRadianceField: relu"),
            ("skip_layer", "examples/radiance_fields/mlp.py MLP: concatenated after layer 4"),
            ("skip_order", "examples/radiance_fields/mlp.py MLP: [x, inputs]"),
            ("huber_slope", "examples/train_ngp_nerf_occ.py: F.smooth_l1_loss(rgb, pixels)"),
            ("feature", "examples/radiance_fields/mlp.py bottleneck_layer: identity"),
            ("depth", "nerfacc/volrend.py rendering: divided by the opacity, not below eps"),
        ],
        beyond: "steps come from an occupancy grid",
    },
    ngp::NGP,
    ngp::TINY_CUDA_NN,
    splats::GSPLAT,
    splats::INRIA,
];

/// A profile by name.
///
/// # Errors
/// A name that isn't in [`PROFILES`].
pub fn find(name: &str) -> Result<&'static Profile> {
    let names = PROFILES.iter().map(|profile| profile.name).collect::<Vec<_>>().join(", ");
    let found = PROFILES.iter().find(|profile| profile.name == name);
    found.ok_or_else(|| Error::usage("profile", name, format!("one of {names}")))
}

/// An assignment in words: the nearest profile, and where it deviates.
pub fn describe(assignment: &BTreeMap<&'static str, String>) -> String {
    let deviations = |profile: &Profile| -> Vec<String> {
        let off = assignment.iter().filter(|(key, value)| profile.conventions.get(key) != **value);
        off.map(|(key, value)| format!("{key} = {value}")).collect()
    };
    let nearest =
        PROFILES.iter().min_by_key(|profile| deviations(profile).len()).expect("there are profiles");
    let off = deviations(nearest);
    if off.is_empty() { nearest.name.into() } else { format!("{} with {}", nearest.name, off.join(", ")) }
}
