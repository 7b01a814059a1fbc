//! What a file of somebody else's weights means: which array is which layer, and in which conventions its program rendered.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::convention::profiles;
use crate::convention::{CHOICES, Conventions, SkipOrder};
use crate::encoding::Encoding;
use crate::error::{Error, Input, Result};
use crate::limits::{LAYERS, LENGTH, LEVELS, SAMPLES, WIDTH};

/// The version of mapping files.
pub const SCHEMA: &str = "nerf-oracle/mapping/1";

const REMEDY: &str = "Correct the mapping; the README's section on other programs' weights has every field.";

/// Conventions that change a picture of such a network; others have no effect, and naming one is a mistake.
const USED: [&str; 14] = [
    "pixel_center",
    "directions",
    "grid",
    "delta",
    "last_delta",
    "product_eps",
    "pdf_padding",
    "pdf_division",
    "identity",
    "identity_place",
    "frequency",
    "bands",
    "columns",
    "density",
];

/// A mapping file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mapping {
    /// [`SCHEMA`].
    pub schema: String,
    /// What each network's names begin with.
    pub networks: Networks,
    /// Names of the layers.
    pub layers: Layers,
    /// How a layer's arrays are called and laid out.
    #[serde(default)]
    pub arrays: Names,
    /// Layers of the trunk.
    pub depth: usize,
    /// Units of each of them.
    pub width: usize,
    /// Units of the color layers; half of the width where it isn't said.
    #[serde(default)]
    pub color_width: Option<usize>,
    /// Where the encoding enters the trunk again.
    pub skip: Option<SkipAt>,
    /// What stands behind the layers.
    pub activations: Activations,
    /// L of positions and of directions.
    pub levels: Levels,
    /// The conventions to start from, one of `nerf-oracle list`.
    pub profile: String,
    /// Those that differ from the profile's.
    #[serde(default)]
    pub conventions: Map<String, Value>,
    /// Samples of a ray.
    pub samples: Samples,
    /// Where samples start.
    pub near: f64,
    /// Where they end.
    pub far: f64,
    /// The color behind everything; black where it isn't said.
    #[serde(default)]
    pub background: [f64; 3],
}

/// What each network's names begin with; nothing, where there is but one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Networks {
    /// The first network's.
    pub coarse: String,
    /// That of the second, where there is one.
    #[serde(default)]
    pub fine: Option<String>,
}

/// Names of layers, without what is before and behind.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Layers {
    /// The trunk: each layer's, or one with {} for its number from 0.
    pub trunk: Listed,
    /// The density head.
    pub density: String,
    /// The layer between trunk and color, where there is one.
    pub feature: Option<String>,
    /// The layers that see the direction, before the last; may be none.
    pub color: Vec<String>,
    /// The last: red, green, blue through a sigmoid.
    pub rgb: String,
}

/// Several values, or one for all.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Listed {
    /// One for all.
    One(String),
    /// One each.
    Each(Vec<String>),
}

/// How a layer's arrays are called ({} is the layer's name) and laid out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Names {
    /// Weights.
    pub weight: String,
    /// Biases; null where there are none.
    pub bias: Option<String>,
    /// Which axis of the weights comes first.
    pub layout: Layout,
}

impl Default for Names {
    /// PyTorch's.
    fn default() -> Self {
        Names { weight: "{}.weight".into(), bias: Some("{}.bias".into()), layout: Layout::OutIn }
    }
}

/// The axes of weights.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Layout {
    /// (out, in), as PyTorch has them.
    OutIn,
    /// (in, out), as TensorFlow and flax have them.
    InOut,
}

/// A layer of the trunk (from 0) whose input has the encoding beside the hidden units, and on which side.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SkipAt {
    /// The layer.
    pub layer: usize,
    /// The side.
    pub order: SkipOrder,
}

/// An activation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Activation {
    /// Nothing.
    None,
    /// max(z, 0).
    Relu,
}

/// What stands behind the layers; the density's is the convention `density`, the color's a sigmoid.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Activations {
    /// Behind those of the trunk: one for all, or one each.
    pub trunk: ListedActivations,
    /// Behind the feature layer.
    #[serde(default = "nothing")]
    pub feature: Activation,
    /// Behind the color layers before the last.
    #[serde(default = "relu")]
    pub color: Activation,
}

fn nothing() -> Activation {
    Activation::None
}

fn relu() -> Activation {
    Activation::Relu
}

/// Several activations, or one for all.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum ListedActivations {
    /// One for all.
    One(Activation),
    /// One each.
    Each(Vec<Activation>),
}

/// L of the encodings; null for a network that doesn't see directions.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Levels {
    /// Of positions.
    pub position: usize,
    /// Of directions.
    pub direction: Option<usize>,
}

/// Samples of a ray.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Samples {
    /// Of the first network.
    pub coarse: usize,
    /// What the second one gets beside those, drawn from the first one's weights.
    #[serde(default)]
    pub fine: usize,
}

impl Mapping {
    /// A mapping from JSON, checked; `file` is named in messages.
    ///
    /// # Errors
    /// Where a field is missing, unknown or impossible.
    pub fn parse(json: &Value, file: &str) -> Result<Mapping> {
        let mapping: Mapping = serde_path_to_error::deserialize(json).map_err(|error| {
            let path = error.path().to_string();
            let field = if path == "." { "mapping".into() } else { path };
            let (found, expected) = (error.into_inner(), "what mappings have");
            Error::input(Input { file, field, found, expected, remedy: REMEDY })
        })?;
        mapping.check(file)?;
        Ok(mapping)
    }

    fn check(&self, file: &str) -> Result<()> {
        let wrong = |field: &str, found: String, expected: String| {
            Err(Error::input(Input { file, field, found, expected, remedy: REMEDY }))
        };
        if self.schema != SCHEMA {
            return wrong("schema", self.schema.clone(), SCHEMA.into());
        }
        let counts = [
            ("depth", self.depth, 1, LAYERS),
            ("width", self.width, 1, WIDTH),
            ("color_width", self.color_width.unwrap_or(1), 1, WIDTH),
            ("levels.position", self.levels.position, 0, LEVELS),
            ("levels.direction", self.levels.direction.unwrap_or(0), 0, LEVELS),
            ("samples.coarse", self.samples.coarse, 3, SAMPLES),
            ("samples.fine", self.samples.fine, 0, SAMPLES),
        ];
        for (field, count, least, most) in counts {
            if !(least..=most).contains(&count) {
                return wrong(field, count.to_string(), format!("a whole number from {least} to {most}"));
            }
        }
        let Mapping { near, far, depth, .. } = *self;
        if !(near >= 0.0 && near < far && far <= LENGTH) {
            return wrong("near and far", format!("{near}, {far}"), "0 <= near < far, at most 1e9".into());
        }
        if let Some(c) = self.background.iter().find(|c| !(0.0..=1.0).contains(*c)) {
            return wrong("background", c.to_string(), "three numbers from 0 to 1".into());
        }
        if (self.samples.fine > 0) != self.networks.fine.is_some() {
            let found = format!("samples.fine {}, networks.fine {:?}", self.samples.fine, self.networks.fine);
            return wrong("fine", found, "both, or neither".into());
        }
        if let Some(skip) = self.skip.filter(|skip| !(1..depth).contains(&skip.layer)) {
            return wrong("skip.layer", skip.layer.to_string(), format!("1 to {}", depth - 1));
        }
        if let (Listed::Each(names), n) = (&self.layers.trunk, depth)
            && names.len() != n
        {
            return wrong("layers.trunk", format!("{} names", names.len()), format!("{n}, as depth says"));
        }
        if let (ListedActivations::Each(list), n) = (&self.activations.trunk, depth)
            && list.len() != n
        {
            return wrong(
                "activations.trunk",
                format!("{} of them", list.len()),
                format!("{n}, as depth says"),
            );
        }
        self.conventions(file).map(|_| ())
    }

    /// The conventions that its program rendered in.
    ///
    /// # Errors
    /// Where a name or a value isn't known, or has no effect.
    pub(super) fn conventions(&self, file: &str) -> Result<Conventions> {
        let named = |field: String, error: Error| match error {
            Error::Usage { found, expected, .. } => {
                Error::input(Input { file, field, found, expected, remedy: REMEDY })
            }
            other => other,
        };
        let mut c =
            profiles::find(&self.profile).map_err(|error| named("profile".into(), error))?.conventions;
        for (name, value) in &self.conventions {
            let field = format!("conventions.{name}");
            if !USED.contains(&name.as_str()) {
                let (found, expected) = ("a name without effect here", USED.join(", "));
                return Err(Error::input(Input { file, field, found, expected, remedy: REMEDY }));
            }
            debug_assert!(CHOICES.iter().any(|(choice, _)| choice == name), "{name} is a convention");
            let text = value.as_str().map_or_else(|| value.to_string(), String::from);
            c = c.with(name, &text).map_err(|error| named(field, error))?;
        }
        Ok(c)
    }

    /// The trunk's names.
    pub(super) fn trunk(&self) -> Vec<String> {
        match &self.layers.trunk {
            Listed::Each(names) => names.clone(),
            Listed::One(pattern) => (0..self.depth).map(|n| pattern.replace("{}", &n.to_string())).collect(),
        }
    }

    /// What stands behind layer `n` of the trunk.
    pub(super) fn behind(&self, n: usize) -> Activation {
        match &self.activations.trunk {
            ListedActivations::One(one) => *one,
            ListedActivations::Each(list) => list[n],
        }
    }

    /// The encodings of positions and of directions.
    pub(super) fn encodings(&self, c: &Conventions) -> (Encoding, Option<Encoding>) {
        let Levels { position, direction } = self.levels;
        (Encoding::new(position, c), direction.map(|levels| Encoding::new(levels, c)))
    }
}
