//! Conventions by name: set and read as [`CHOICES`] spells them.

use std::borrow::Cow;

use serde::de::IntoDeserializer;
use serde::de::value::{Error as Unlisted, StrDeserializer};
use serde::{Deserialize, Serialize};

use super::Conventions;
use crate::error::{Error, Result};

/// Every convention with the closed list of its values, as they are written in JSON.
pub const CHOICES: &[(&str, &[&str])] = &[
    ("axes", &["opencv", "opengl"]),
    ("camera_axes", &["opencv", "opengl"]),
    ("quaternion", &["normalized", "as_given"]),
    ("pixel_center", &["half", "integer"]),
    ("directions", &["unit", "unit_in_camera", "depth"]),
    ("grid", &["intervals", "ends_plus_width", "ends_plus_spacing", "ends_between_midpoints"]),
    ("rest", &["left", "mid", "right"]),
    ("delta", &["width", "differences", "differences_times_norm", "midpoints", "central"]),
    ("last_delta", &["width", "repeated", "mean", "1e10", "1e9", "1e-3", "to_far"]),
    ("product_eps", &["none", "1e-10", "1e-9", "1e-8", "1e-7"]),
    ("contraction_norm", &["l2", "linf", "merf"]),
    ("contraction_range", &["two", "one", "unit"]),
    ("ray_shape", &["cone", "cylinder"]),
    ("ndc_depth", &["negative", "positive"]),
    ("identity", &["true", "false"]),
    ("identity_place", &["first", "last", "by_dimension"]),
    ("network_identity", &["first", "last", "by_dimension"]),
    ("frequency", &["pi", "one", "two_pi"]),
    ("bands", &["octaves", "linear", "stretched", "widened"]),
    (
        "columns",
        &[
            "band_sin_cos",
            "dim_sin_cos",
            "dim_interleaved",
            "all_sin_all_cos",
            "all_sin_all_cos_by_band",
            "band_interleaved",
        ],
    ),
    ("cosine", &["own", "shifted_sine"]),
    ("integrated_identity", &["false", "true"]),
    ("density", &["relu", "softplus", "exp"]),
    ("exponent", &["free", "clamped"]),
    ("exponent_gradient", &["both_ends", "above", "above11"]),
    ("exponent_shift", &["none", "one"]),
    ("grid_decay", &["touched", "every_cell"]),
    ("grid_threshold", &["mean_of_dense", "mean_of_seen", "mean_over_all", "limit_alone"]),
    ("grid_unseen", &["kept", "ordinary"]),
    ("hash_levels", &["nearest", "floor", "tiny_cuda_nn", "torch_ngp", "align_corners"]),
    ("hash_index", &["dense_where_it_fits", "hashed"]),
    ("hash_primes", &["coherent", "prime", "reversed"]),
    ("hash_weights", &["linear", "smoothstep"]),
    ("harmonic_sign", &["alternating", "plain"]),
    ("harmonic_form", &["sphere", "homogeneous", "normalized"]),
    ("pdf_padding", &["as_given", "none", "1e-5", "1e-6", "0.01"]),
    ("pdf_division", &["as_it_is", "snapped", "at_least"]),
    ("stop", &["behind", "in_front", "one_more"]),
    ("stopped", &["left", "made_opaque"]),
    ("alpha_cap", &["none", "0.99", "0.999"]),
    ("faint", &["kept", "skipped"]),
    ("alpha_stop", &["none", "in_front"]),
    ("sigma_relu", &["none", "inside"]),
    ("backdrop", &["none", "white"]),
    ("opacity_sum", &["all", "without_last"]),
    ("quaternion_order", &["wxyz", "xyzw"]),
    ("quaternion_length", &["divided", "as_given"]),
    ("splat_scale", &["plain", "log"]),
    ("splat_center", &["half", "integer"]),
    ("splat_dilation", &["0.3", "0.1"]),
    ("splat_clamp", &["picture", "centered", "none"]),
    ("splat_clamp_gradient", &["through", "held"]),
    ("radius_floor", &["0.1", "0.01", "none"]),
    ("compensation_floor", &["none", "0.005", "determinants_1e-6", "determinants_1e-12"]),
    ("splat_culling", &["kept", "zero"]),
    ("positive_power", &["kept", "skipped"]),
    ("cap_gradient", &["stopped", "through"]),
    ("conic_gradient", &["number", "entry"]),
    ("splat_color", &["clamped", "shifted", "sum"]),
    ("skip_layer", &["4", "5"]),
    ("skip_order", &["hidden_first", "encoding_first"]),
    ("color_order", &["feature_first", "direction_first"]),
    ("last_trunk", &["relu", "none"]),
    ("feature", &["none", "relu"]),
    ("depth", &["divided", "plain", "far_behind"]),
    ("empty_depth", &["far", "zero", "first", "last"]),
    ("psnr", &["images", "mean_error"]),
    ("psnr_floor", &["none", "small"]),
    ("psnr_peak", &["given", "one"]),
    ("loss_reduction", &["mean", "sum"]),
    ("huber_slope", &["delta", "one"]),
    ("charbonnier_eps", &["square", "as_given"]),
    ("outer_edges", &["touching", "inside"]),
    ("interlevel_reduction", &["mean", "sum"]),
    ("interlevel_eps", &["as_given", "float32", "1e-7", "1e-8"]),
    ("ssim_window", &["gaussian", "uniform", "uniform_11", "uniform_3"]),
    ("ssim_padding", &["valid", "zero", "reflect"]),
    ("ssim_variance", &["population", "sample"]),
    ("ssim_peak", &["given", "one"]),
    ("bytes", &["round", "truncate"]),
    ("adam_eps", &["corrected", "uncorrected"]),
    ("adam_zero", &["stepped", "left"]),
    ("clip_eps", &["none", "1e-7", "float32", "1e-6"]),
    ("rate_end", &["goes_on", "held"]),
    ("rate_delay", &["beside", "before"]),
    ("rate_ramp", &["sine", "linear"]),
    ("twist_order", &["translation_first", "rotation_first"]),
    ("twist_translation", &["coupled", "plain"]),
    ("rotation_clamp", &["none", "0.01"]),
    ("motion_layout", &["for_columns", "for_rows"]),
    ("loss_scale_floor", &["none", "one"]),
    ("loss_scale_ceiling", &["none", "2^24"]),
    ("anneal_padding", &["before", "after"]),
    ("flat_bins", &["dropped", "kept"]),
    ("histogram_floor", &["none", "1e-5"]),
    ("edges_from", &["midpoints", "samples"]),
    ("old_edges", &["dropped", "kept"]),
];

/// A convention's name, how its value is read, and how it is set.
type Field = (&'static str, fn(&Conventions) -> String, fn(&mut Conventions, &str));

/// One line per field: a search reads hundreds of thousands of them, so none is read by serializing the whole struct.
const FIELDS: &[Field] = &[
    ("axes", |c| name(&c.axes), |c, v| c.axes = listed(v)),
    ("camera_axes", |c| name(&c.camera_axes), |c, v| c.camera_axes = listed(v)),
    ("quaternion", |c| name(&c.quaternion), |c, v| c.quaternion = listed(v)),
    ("pixel_center", |c| name(&c.pixel_center), |c, v| c.pixel_center = listed(v)),
    ("directions", |c| name(&c.directions), |c, v| c.directions = listed(v)),
    ("grid", |c| name(&c.grid), |c, v| c.grid = listed(v)),
    ("rest", |c| name(&c.rest), |c, v| c.rest = listed(v)),
    ("delta", |c| name(&c.delta), |c, v| c.delta = listed(v)),
    ("last_delta", |c| name(&c.last_delta), |c, v| c.last_delta = listed(v)),
    ("product_eps", |c| name(&c.product_eps), |c, v| c.product_eps = listed(v)),
    ("contraction_norm", |c| name(&c.contraction_norm), |c, v| c.contraction_norm = listed(v)),
    ("contraction_range", |c| name(&c.contraction_range), |c, v| c.contraction_range = listed(v)),
    ("ray_shape", |c| name(&c.ray_shape), |c, v| c.ray_shape = listed(v)),
    ("ndc_depth", |c| name(&c.ndc_depth), |c, v| c.ndc_depth = listed(v)),
    ("identity", |c| c.identity.to_string(), |c, v| c.identity = v == "true"),
    ("identity_place", |c| name(&c.identity_place), |c, v| c.identity_place = listed(v)),
    ("network_identity", |c| name(&c.network_identity), |c, v| c.network_identity = listed(v)),
    ("frequency", |c| name(&c.frequency), |c, v| c.frequency = listed(v)),
    ("bands", |c| name(&c.bands), |c, v| c.bands = listed(v)),
    ("columns", |c| name(&c.columns), |c, v| c.columns = listed(v)),
    ("cosine", |c| name(&c.cosine), |c, v| c.cosine = listed(v)),
    (
        "integrated_identity",
        |c| c.integrated_identity.to_string(),
        |c, v| c.integrated_identity = v == "true",
    ),
    ("density", |c| name(&c.density), |c, v| c.density = listed(v)),
    ("exponent", |c| name(&c.exponent), |c, v| c.exponent = listed(v)),
    ("exponent_gradient", |c| name(&c.exponent_gradient), |c, v| c.exponent_gradient = listed(v)),
    ("exponent_shift", |c| name(&c.exponent_shift), |c, v| c.exponent_shift = listed(v)),
    ("grid_decay", |c| name(&c.grid_decay), |c, v| c.grid_decay = listed(v)),
    ("grid_threshold", |c| name(&c.grid_threshold), |c, v| c.grid_threshold = listed(v)),
    ("grid_unseen", |c| name(&c.grid_unseen), |c, v| c.grid_unseen = listed(v)),
    ("hash_levels", |c| name(&c.hash_levels), |c, v| c.hash_levels = listed(v)),
    ("hash_index", |c| name(&c.hash_index), |c, v| c.hash_index = listed(v)),
    ("hash_primes", |c| name(&c.hash_primes), |c, v| c.hash_primes = listed(v)),
    ("hash_weights", |c| name(&c.hash_weights), |c, v| c.hash_weights = listed(v)),
    ("harmonic_sign", |c| name(&c.harmonic_sign), |c, v| c.harmonic_sign = listed(v)),
    ("harmonic_form", |c| name(&c.harmonic_form), |c, v| c.harmonic_form = listed(v)),
    ("pdf_padding", |c| name(&c.pdf_padding), |c, v| c.pdf_padding = listed(v)),
    ("pdf_division", |c| name(&c.pdf_division), |c, v| c.pdf_division = listed(v)),
    ("stop", |c| name(&c.stop), |c, v| c.stop = listed(v)),
    ("stopped", |c| name(&c.stopped), |c, v| c.stopped = listed(v)),
    ("alpha_cap", |c| name(&c.alpha_cap), |c, v| c.alpha_cap = listed(v)),
    ("alpha_stop", |c| name(&c.alpha_stop), |c, v| c.alpha_stop = listed(v)),
    ("faint", |c| name(&c.faint), |c, v| c.faint = listed(v)),
    ("sigma_relu", |c| name(&c.sigma_relu), |c, v| c.sigma_relu = listed(v)),
    ("backdrop", |c| name(&c.backdrop), |c, v| c.backdrop = listed(v)),
    ("opacity_sum", |c| name(&c.opacity_sum), |c, v| c.opacity_sum = listed(v)),
    ("quaternion_order", |c| name(&c.quaternion_order), |c, v| c.quaternion_order = listed(v)),
    ("quaternion_length", |c| name(&c.quaternion_length), |c, v| c.quaternion_length = listed(v)),
    ("splat_scale", |c| name(&c.splat_scale), |c, v| c.splat_scale = listed(v)),
    ("splat_center", |c| name(&c.splat_center), |c, v| c.splat_center = listed(v)),
    ("splat_dilation", |c| name(&c.splat_dilation), |c, v| c.splat_dilation = listed(v)),
    ("splat_clamp", |c| name(&c.splat_clamp), |c, v| c.splat_clamp = listed(v)),
    ("splat_clamp_gradient", |c| name(&c.splat_clamp_gradient), |c, v| c.splat_clamp_gradient = listed(v)),
    ("radius_floor", |c| name(&c.radius_floor), |c, v| c.radius_floor = listed(v)),
    ("compensation_floor", |c| name(&c.compensation_floor), |c, v| c.compensation_floor = listed(v)),
    ("splat_culling", |c| name(&c.splat_culling), |c, v| c.splat_culling = listed(v)),
    ("positive_power", |c| name(&c.positive_power), |c, v| c.positive_power = listed(v)),
    ("cap_gradient", |c| name(&c.cap_gradient), |c, v| c.cap_gradient = listed(v)),
    ("conic_gradient", |c| name(&c.conic_gradient), |c, v| c.conic_gradient = listed(v)),
    ("splat_color", |c| name(&c.splat_color), |c, v| c.splat_color = listed(v)),
    ("skip_layer", |c| c.skip_layer.to_string(), |c, v| c.skip_layer = v.parse().expect("a listed number")),
    ("skip_order", |c| name(&c.skip_order), |c, v| c.skip_order = listed(v)),
    ("color_order", |c| name(&c.color_order), |c, v| c.color_order = listed(v)),
    ("last_trunk", |c| name(&c.last_trunk), |c, v| c.last_trunk = listed(v)),
    ("feature", |c| name(&c.feature), |c, v| c.feature = listed(v)),
    ("depth", |c| name(&c.depth), |c, v| c.depth = listed(v)),
    ("empty_depth", |c| name(&c.empty_depth), |c, v| c.empty_depth = listed(v)),
    ("psnr", |c| name(&c.psnr), |c, v| c.psnr = listed(v)),
    ("psnr_floor", |c| name(&c.psnr_floor), |c, v| c.psnr_floor = listed(v)),
    ("psnr_peak", |c| name(&c.psnr_peak), |c, v| c.psnr_peak = listed(v)),
    ("loss_reduction", |c| name(&c.loss_reduction), |c, v| c.loss_reduction = listed(v)),
    ("huber_slope", |c| name(&c.huber_slope), |c, v| c.huber_slope = listed(v)),
    ("charbonnier_eps", |c| name(&c.charbonnier_eps), |c, v| c.charbonnier_eps = listed(v)),
    ("outer_edges", |c| name(&c.outer_edges), |c, v| c.outer_edges = listed(v)),
    ("interlevel_reduction", |c| name(&c.interlevel_reduction), |c, v| c.interlevel_reduction = listed(v)),
    ("interlevel_eps", |c| name(&c.interlevel_eps), |c, v| c.interlevel_eps = listed(v)),
    ("ssim_window", |c| name(&c.ssim_window), |c, v| c.ssim_window = listed(v)),
    ("ssim_padding", |c| name(&c.ssim_padding), |c, v| c.ssim_padding = listed(v)),
    ("ssim_variance", |c| name(&c.ssim_variance), |c, v| c.ssim_variance = listed(v)),
    ("ssim_peak", |c| name(&c.ssim_peak), |c, v| c.ssim_peak = listed(v)),
    ("bytes", |c| name(&c.bytes), |c, v| c.bytes = listed(v)),
    ("adam_eps", |c| name(&c.adam_eps), |c, v| c.adam_eps = listed(v)),
    ("adam_zero", |c| name(&c.adam_zero), |c, v| c.adam_zero = listed(v)),
    ("clip_eps", |c| name(&c.clip_eps), |c, v| c.clip_eps = listed(v)),
    ("rate_end", |c| name(&c.rate_end), |c, v| c.rate_end = listed(v)),
    ("rate_delay", |c| name(&c.rate_delay), |c, v| c.rate_delay = listed(v)),
    ("rate_ramp", |c| name(&c.rate_ramp), |c, v| c.rate_ramp = listed(v)),
    ("twist_order", |c| name(&c.twist_order), |c, v| c.twist_order = listed(v)),
    ("twist_translation", |c| name(&c.twist_translation), |c, v| c.twist_translation = listed(v)),
    ("rotation_clamp", |c| name(&c.rotation_clamp), |c, v| c.rotation_clamp = listed(v)),
    ("motion_layout", |c| name(&c.motion_layout), |c, v| c.motion_layout = listed(v)),
    ("loss_scale_floor", |c| name(&c.loss_scale_floor), |c, v| c.loss_scale_floor = listed(v)),
    ("loss_scale_ceiling", |c| name(&c.loss_scale_ceiling), |c, v| c.loss_scale_ceiling = listed(v)),
    ("anneal_padding", |c| name(&c.anneal_padding), |c, v| c.anneal_padding = listed(v)),
    ("flat_bins", |c| name(&c.flat_bins), |c, v| c.flat_bins = listed(v)),
    ("histogram_floor", |c| name(&c.histogram_floor), |c, v| c.histogram_floor = listed(v)),
    ("edges_from", |c| name(&c.edges_from), |c, v| c.edges_from = listed(v)),
    ("old_edges", |c| name(&c.old_edges), |c, v| c.old_edges = listed(v)),
];

/// As serde spells it.
fn name(value: &impl Serialize) -> String {
    let value = serde_json::to_value(value).expect("conventions are plain data");
    value.as_str().expect("a name").to_string()
}

/// From serde's spelling.
fn listed<T: for<'a> Deserialize<'a>>(value: &str) -> T {
    let value: StrDeserializer<Unlisted> = value.into_deserializer();
    T::deserialize(value).expect("every listed value parses")
}

/// A name in American spelling, as all names here are written: `pixel_centre` is read as `pixel_center`, `wrong_colours` as
/// `wrong_colors`.
///
/// ```
/// assert_eq!(nerf_oracle::convention::american("origin_normalised"), "origin_normalized");
/// ```
pub fn american(name: &str) -> String {
    const SPELLINGS: [(&str, &str); 7] = [
        ("colour", "color"),
        ("centred", "centered"),
        ("centre", "center"),
        ("normalis", "normaliz"),
        ("regularis", "regulariz"),
        ("vectoris", "vectoriz"),
        ("optimis", "optimiz"),
    ];
    SPELLINGS.iter().fold(name.to_string(), |name, (old, new)| name.replace(old, new))
}

impl Conventions {
    /// The same with `key` set to `value`, both spelled as in [`CHOICES`].
    ///
    /// # Errors
    /// An unknown key or a value that isn't in its list.
    ///
    /// ```
    /// use nerf_oracle::convention::{CS180, ProductEps};
    /// let c = CS180.with("product_eps", "1e-10").unwrap();
    /// assert_eq!(c.product_eps, ProductEps::TenToMinusTen);
    /// assert!(CS180.with("product_eps", "0.1").is_err());
    /// ```
    pub fn with(&self, key: &str, value: &str) -> Result<Self> {
        // A search asks thousands of times, in the spelling of today.
        let known = CHOICES.iter().any(|(name, _)| *name == key);
        let key = if known { Cow::Borrowed(key) } else { Cow::Owned(american(key)) };
        let choices = CHOICES.iter().find(|(name, _)| *name == key).map(|(_, values)| *values);
        if !choices.is_some_and(|values| values.contains(&value)) {
            let expected = choices.map_or("a convention's name".into(), |values| values.join(" | "));
            return Err(Error::usage(format!("convention {key}"), value, expected));
        }
        let mut c = *self;
        let (_, _, set) = FIELDS.iter().find(|(name, ..)| *name == key).expect("every choice is a field");
        set(&mut c, value);
        Ok(c)
    }

    /// The value of `key`, spelled as in [`CHOICES`].
    ///
    /// # Panics
    /// Where `key` is no convention.
    pub fn get(&self, key: &str) -> String {
        let field = FIELDS.iter().find(|(name, ..)| *name == key);
        let (_, read, _) = field.unwrap_or_else(|| panic!("{key} is no convention"));
        read(self)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{CHOICES, CS180};

    #[test]
    fn the_old_spelling_is_read() {
        assert_eq!(
            CS180.with("pixel_centre", "integer").unwrap(),
            CS180.with("pixel_center", "integer").unwrap()
        );
        let mut json = serde_json::to_value(CS180).unwrap();
        let center = json.as_object_mut().unwrap().remove("pixel_center").unwrap();
        json["pixel_centre"] = center;
        assert_eq!(serde_json::from_value::<super::super::Conventions>(json).unwrap(), CS180);
    }

    #[test]
    fn every_choice_can_be_set_and_read_back() {
        for (key, values) in CHOICES {
            for value in *values {
                let c = CS180.with(key, value).unwrap();
                assert_eq!(c.get(key), *value);
                // And nothing but this field has changed.
                for (other, _) in CHOICES.iter().filter(|(other, _)| other != key) {
                    assert_eq!(c.get(other), CS180.get(other));
                }
                let json = serde_json::to_value(c).unwrap();
                assert_eq!(json[*key].to_string().trim_matches('"'), *value);
            }
        }
        let fields = serde_json::to_value(CS180).unwrap();
        assert_eq!(fields.as_object().unwrap().len(), CHOICES.len());
    }
}
