//! The plan of the trunk: what the input of each layer is made of. Whoever walks along the trunk reads it here.

use crate::convention::{Conventions, SkipOrder};

/// A part of a layer's input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// The encoded position.
    Encoding,
    /// The output of the layer before.
    Hidden,
}

/// Where the encoding enters the trunk again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Plan {
    /// The layer (from 0) whose input contains it; `None` if it is 0 or not below the depth.
    pub skip: usize,
    /// On which side of the hidden units.
    pub order: SkipOrder,
}

impl Plan {
    /// Layer after layer, the encoding into the first alone.
    pub fn straight() -> Plan {
        Plan { skip: 0, order: SkipOrder::HiddenFirst }
    }

    /// The plan of some conventions.
    pub fn of(c: &Conventions) -> Plan {
        Plan { skip: c.skip_layer, order: c.skip_order }
    }

    /// The parts of layer n's input, from its first column on. Layer 0 reads the encoding alone.
    pub fn parts(&self, n: usize) -> &'static [Part] {
        if n == 0 {
            return &[Part::Encoding];
        }
        if n != self.skip {
            return &[Part::Hidden];
        }
        match self.order {
            SkipOrder::HiddenFirst => &[Part::Hidden, Part::Encoding],
            SkipOrder::EncodingFirst => &[Part::Encoding, Part::Hidden],
        }
    }

    /// Columns of layer n's input, where hidden layers have `width` units and the encoding `encoding` columns.
    pub fn columns(&self, n: usize, width: usize, encoding: usize) -> usize {
        let mut columns = 0;
        for part in self.parts(n) {
            columns += match part {
                Part::Encoding => encoding,
                Part::Hidden => width,
            };
        }
        columns
    }

    /// The column of layer n's input at which the encoding begins, where the input has `inputs` columns and the encoding `encoding`;
    /// `None` if it isn't part of it.
    pub fn encoding_begins(&self, n: usize, inputs: usize, encoding: usize) -> Option<usize> {
        match self.parts(n) {
            [Part::Hidden] => None,
            [Part::Encoding, ..] => Some(0),
            _ => Some(inputs.saturating_sub(encoding)),
        }
    }

    /// Layer n's input.
    pub fn join(&self, n: usize, hidden: &[f64], encoding: &[f64]) -> Vec<f64> {
        let mut input = vec![];
        for part in self.parts(n) {
            match part {
                Part::Encoding => input.extend(encoding),
                Part::Hidden => input.extend(hidden),
            }
        }
        input
    }

    /// The other way: of layer n's input, or its gradient, what belongs to the hidden units and what to the encoding of `encoding`
    /// columns; nothing for a part that it doesn't have.
    ///
    /// # Panics
    /// Where the encoding has more columns than the input that it is part of.
    ///
    /// ```
    /// use nerf_oracle::convention::CS180;
    /// use nerf_oracle::field::trunk::Plan;
    /// let plan = Plan::of(&CS180);
    /// assert_eq!(plan.join(4, &[1.0, 2.0], &[7.0]), [1.0, 2.0, 7.0]);
    /// assert_eq!(plan.split(4, &[1.0, 2.0, 7.0], 1), (vec![1.0, 2.0], vec![7.0]));
    /// assert_eq!(plan.split(5, &[1.0, 2.0], 1), (vec![1.0, 2.0], vec![]));
    /// ```
    pub fn split(&self, n: usize, input: &[f64], encoding: usize) -> (Vec<f64>, Vec<f64>) {
        let Some(begins) = self.encoding_begins(n, input.len(), encoding) else {
            return (input.to_vec(), vec![]);
        };
        assert!(input.len() >= encoding, "input: at least the encoding's columns");
        let ends = begins + encoding;
        ([&input[..begins], &input[ends..]].concat(), input[begins..ends].to_vec())
    }
}
