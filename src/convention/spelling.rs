//! Conventions by name: set and read as [`CHOICES`] spells them.

use serde::de::IntoDeserializer;
use serde::de::value::{Error as Unlisted, StrDeserializer};
use serde::{Deserialize, Serialize};

use super::{CHOICES, Conventions};
use crate::error::{Error, Result};

/// A convention's name, how its value is read, and how it is set.
type Field = (&'static str, fn(&Conventions) -> String, fn(&mut Conventions, &str));

/// One line per field: a search reads hundreds of thousands of them, so none is read by serializing the whole struct.
const FIELDS: &[Field] = &[
    ("axes", |c| name(&c.axes), |c, v| c.axes = listed(v)),
    ("camera_axes", |c| name(&c.camera_axes), |c, v| c.camera_axes = listed(v)),
    ("pixel_center", |c| name(&c.pixel_center), |c, v| c.pixel_center = listed(v)),
    ("directions", |c| name(&c.directions), |c, v| c.directions = listed(v)),
    ("grid", |c| name(&c.grid), |c, v| c.grid = listed(v)),
    ("rest", |c| name(&c.rest), |c, v| c.rest = listed(v)),
    ("delta", |c| name(&c.delta), |c, v| c.delta = listed(v)),
    ("last_delta", |c| name(&c.last_delta), |c, v| c.last_delta = listed(v)),
    ("product_eps", |c| name(&c.product_eps), |c, v| c.product_eps = listed(v)),
    ("identity", |c| c.identity.to_string(), |c, v| c.identity = v == "true"),
    ("frequency", |c| name(&c.frequency), |c, v| c.frequency = listed(v)),
    ("bands", |c| name(&c.bands), |c, v| c.bands = listed(v)),
    ("columns", |c| name(&c.columns), |c, v| c.columns = listed(v)),
    ("density", |c| name(&c.density), |c, v| c.density = listed(v)),
    ("exponent", |c| name(&c.exponent), |c, v| c.exponent = listed(v)),
    ("grid_decay", |c| name(&c.grid_decay), |c, v| c.grid_decay = listed(v)),
    ("grid_threshold", |c| name(&c.grid_threshold), |c, v| c.grid_threshold = listed(v)),
    ("pdf_padding", |c| name(&c.pdf_padding), |c, v| c.pdf_padding = listed(v)),
    ("pdf_division", |c| name(&c.pdf_division), |c, v| c.pdf_division = listed(v)),
    ("stop", |c| name(&c.stop), |c, v| c.stop = listed(v)),
    ("alpha_cap", |c| name(&c.alpha_cap), |c, v| c.alpha_cap = listed(v)),
    ("faint", |c| name(&c.faint), |c, v| c.faint = listed(v)),
    ("skip_layer", |c| c.skip_layer.to_string(), |c, v| c.skip_layer = v.parse().expect("a listed number")),
    ("skip_order", |c| name(&c.skip_order), |c, v| c.skip_order = listed(v)),
    ("last_trunk", |c| name(&c.last_trunk), |c, v| c.last_trunk = listed(v)),
    ("feature", |c| name(&c.feature), |c, v| c.feature = listed(v)),
    ("depth", |c| name(&c.depth), |c, v| c.depth = listed(v)),
    ("psnr", |c| name(&c.psnr), |c, v| c.psnr = listed(v)),
    ("bytes", |c| name(&c.bytes), |c, v| c.bytes = listed(v)),
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
        let key = american(key);
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
