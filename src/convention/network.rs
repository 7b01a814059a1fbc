//! Choices of the network: its density, its activations, its skip connection.

use serde::{Deserialize, Serialize};

/// What turns the density head's output into a density.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Density {
    /// max(z, 0).
    Relu,
    /// ln(1 + e^z).
    Softplus,
    /// e^z.
    Exp,
}

/// The order in which a skip connection is concatenated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SkipOrder {
    /// [h, encoding].
    HiddenFirst,
    /// [encoding, h].
    EncodingFirst,
}

/// The order of the color layer's input.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ColorOrder {
    /// [feature, direction].
    #[default]
    FeatureFirst,
    /// [direction, feature].
    DirectionFirst,
}

impl ColorOrder {
    /// The two in this order.
    pub fn join<T: Clone>(self, feature: &[T], direction: &[T]) -> Vec<T> {
        match self {
            ColorOrder::FeatureFirst => [feature, direction].concat(),
            ColorOrder::DirectionFirst => [direction, feature].concat(),
        }
    }

    /// The column at which the feature begins, and that of the direction, where they have so many.
    pub fn begins(self, features: usize, directions: usize) -> [usize; 2] {
        match self {
            ColorOrder::FeatureFirst => [0, features],
            ColorOrder::DirectionFirst => [directions, 0],
        }
    }

    /// The other way: of the input, or its gradient, what belongs to so many features, and what to the direction.
    ///
    /// # Panics
    /// Where there are fewer columns.
    pub fn split<T: Clone>(self, input: &[T], features: usize) -> (Vec<T>, Vec<T>) {
        match self {
            ColorOrder::FeatureFirst => (input[..features].to_vec(), input[features..].to_vec()),
            ColorOrder::DirectionFirst => {
                let (direction, feature) = input.split_at(input.len() - features);
                (feature.to_vec(), direction.to_vec())
            }
        }
    }
}

/// Whether a layer has a ReLU.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Activation {
    /// max(z, 0).
    Relu,
    /// z.
    None,
}
