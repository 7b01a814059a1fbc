//! Conventions by name: set and read as [`CHOICES`] spells them.

use std::collections::HashMap;
use std::sync::LazyLock;

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
    ("last_sample", &["as_it_is", "opaque"]),
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
    ("clip_eps", &["none", "1e-8", "1e-7", "float32", "1e-6"]),
    ("rate_end", &["goes_on", "held"]),
    ("rate_delay", &["beside", "before"]),
    ("rate_ramp", &["sine", "linear"]),
    ("twist_order", &["translation_first", "rotation_first"]),
    ("twist_translation", &["coupled", "plain"]),
    ("rotation_clamp", &["none", "0.01"]),
    ("motion_layout", &["for_columns", "for_rows"]),
    ("loss_scale_floor", &["none", "one"]),
    ("loss_scale_ceiling", &["none", "2^16", "2^24"]),
    ("anneal_padding", &["before", "after"]),
    ("flat_bins", &["dropped", "kept"]),
    ("histogram_floor", &["none", "1e-5"]),
    ("edges_from", &["midpoints", "samples"]),
    ("old_edges", &["dropped", "kept"]),
];

/// A convention's name, how its value is read, how it is set, and how it is taken over from others.
struct Field {
    name: &'static str,
    get: fn(&Conventions) -> String,
    set: fn(&mut Conventions, &str),
    take: fn(&mut Conventions, &Conventions),
}

/// One entry per field: a search reads hundreds of thousands of them, so none is read by serializing the whole struct.
macro_rules! fields {
    ($($field:ident),*) => {
        &[$(Field {
            name: stringify!($field),
            get: |c| name(&c.$field),
            set: |c, value| c.$field = listed(value),
            take: |c, other| c.$field = other.$field,
        }),*]
    };
}

#[rustfmt::skip]
const FIELDS: &[Field] = fields![
    axes, camera_axes, quaternion, pixel_center, directions, grid, rest, delta, last_delta, product_eps,
    contraction_norm, contraction_range, ray_shape, ndc_depth, identity, identity_place, network_identity,
    frequency, bands, columns, cosine, integrated_identity, density, exponent, exponent_gradient,
    exponent_shift, grid_decay, grid_threshold, grid_unseen, hash_levels, hash_index, hash_primes,
    hash_weights, harmonic_sign, harmonic_form, pdf_padding, pdf_division, stop, stopped, alpha_cap,
    alpha_stop, faint, sigma_relu, backdrop, opacity_sum, last_sample, quaternion_order, quaternion_length,
    splat_scale, splat_center, splat_dilation, splat_clamp, splat_clamp_gradient, radius_floor,
    compensation_floor, splat_culling, positive_power, cap_gradient, conic_gradient, splat_color, skip_layer, skip_order,
    color_order, last_trunk, feature, depth, empty_depth, psnr, psnr_floor, psnr_peak, loss_reduction,
    huber_slope, charbonnier_eps, outer_edges, interlevel_reduction, interlevel_eps, ssim_window, ssim_padding,
    ssim_variance, ssim_peak, bytes, adam_eps, adam_zero, clip_eps, rate_end, rate_delay, rate_ramp,
    twist_order, twist_translation, rotation_clamp, motion_layout, loss_scale_floor, loss_scale_ceiling,
    anneal_padding, flat_bins, histogram_floor, edges_from, old_edges
];

/// Each of them by its name, with the values that it may have.
static BY_NAME: LazyLock<HashMap<&str, (&Field, &[&str])>> = LazyLock::new(|| {
    let values =
        |field: &Field| CHOICES.iter().find(|(name, _)| *name == field.name).expect("all are listed").1;
    FIELDS.iter().map(|field| (field.name, (field, values(field)))).collect()
});

/// As serde spells it: a name, or a number or truth value as in JSON.
fn name(value: &impl Serialize) -> String {
    let value = serde_json::to_value(value).expect("conventions are plain data");
    value.as_str().map_or_else(|| value.to_string(), str::to_string)
}

/// From serde's spelling.
fn listed<T: for<'a> Deserialize<'a>>(value: &str) -> T {
    let by_name: StrDeserializer<Unlisted> = value.into_deserializer();
    T::deserialize(by_name).or_else(|_| serde_json::from_str(value)).expect("every listed value parses")
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
        let found = BY_NAME.get(key).or_else(|| BY_NAME.get(&*american(key)));
        let Some((field, _)) = found.filter(|(_, values)| values.contains(&value)) else {
            let expected = found.map_or("a convention's name".into(), |(_, values)| values.join(" | "));
            return Err(Error::usage(format!("convention {}", american(key)), value, expected));
        };
        let mut c = *self;
        (field.set)(&mut c, value);
        Ok(c)
    }

    /// These conventions alone, and those of `base` beside them.
    ///
    /// # Panics
    /// Where one of `keys` is no convention.
    pub(crate) fn of(&self, keys: &[&str], base: Conventions) -> Conventions {
        let mut c = base;
        keys.iter().for_each(|key| (field(key).take)(&mut c, self));
        c
    }

    /// The value of `key`, spelled as in [`CHOICES`].
    ///
    /// # Panics
    /// Where `key` is no convention.
    pub fn get(&self, key: &str) -> String {
        (field(key).get)(self)
    }
}

fn field(key: &str) -> &'static Field {
    BY_NAME.get(key).unwrap_or_else(|| panic!("{key} is no convention")).0
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
