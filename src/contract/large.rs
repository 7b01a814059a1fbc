//! Large cases: real sizes, as recipes.

use super::arithmetic::Dtype;
use super::recipe::Recipe;

/// An array of a large case.
#[derive(Clone, Debug, PartialEq)]
pub struct Made {
    /// Its name.
    pub name: String,
    /// Its shape.
    pub shape: Vec<usize>,
    /// Its entries.
    pub recipe: Recipe,
}

/// Samples of rays one after the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Packed {
    /// The letter that counts samples in the shapes of ports.
    pub letter: &'static str,
    /// The input that says where each ray begins.
    pub offsets: &'static str,
}

/// A large case of a row.
#[derive(Clone, Debug, PartialEq)]
pub struct Large {
    /// Unique within the row.
    pub id: &'static str,
    /// What it probes, in a sentence.
    pub comment: &'static str,
    /// Rays, points or parameters in all.
    pub items: usize,
    /// Of which so many are judged at once: all, where an output adds them up. A gradient that does is judged at once anyway.
    pub block: usize,
    /// The inputs.
    pub inputs: Vec<Made>,
    /// Where rays have samples of their own number.
    pub packed: Option<Packed>,
    /// Not asked of the gradient.
    pub forward_only: bool,
    /// The types that have these numbers.
    pub types: &'static [Dtype],
}

impl Large {
    /// A case without inputs.
    pub fn new(id: &'static str, comment: &'static str, items: usize, block: usize) -> Large {
        let (inputs, packed, forward_only, types) = (vec![], None, false, &Dtype::ALL[..]);
        Large { id, comment, items, block, inputs, packed, forward_only, types }
    }

    /// The same with one input more.
    pub fn with(mut self, name: impl ToString, shape: &[usize], recipe: Recipe) -> Large {
        self.inputs.push(Made { name: name.to_string(), shape: shape.to_vec(), recipe });
        self
    }

    /// The same of packed rays.
    pub fn packed(self, letter: &'static str, offsets: &'static str) -> Large {
        Large { packed: Some(Packed { letter, offsets }), ..self }
    }

    /// The same, not asked of the gradient.
    pub fn forward_only(self) -> Large {
        Large { forward_only: true, ..self }
    }

    /// The same in these types alone.
    pub fn in_types(self, types: &'static [Dtype]) -> Large {
        Large { types, ..self }
    }
}
