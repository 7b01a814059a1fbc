//! What a component is to the harness: a plain struct of functions over named arrays.

use std::collections::BTreeMap;

use ndarray::{ArrayD, IxDyn};

use crate::convention::Conventions;

/// Name -> array: the only thing that crosses the harness boundary. Row-major.
pub type Arrays = BTreeMap<String, ArrayD<f64>>;

/// One input or output array.
#[derive(Clone, Copy, Debug)]
pub struct Port {
    /// Name, as in the judging contract.
    pub name: &'static str,
    /// Shape in letters, e.g. `R,N,3`; empty for a scalar.
    pub shape: &'static str,
    /// What it is, with units.
    pub meaning: &'static str,
    /// Inputs: a VJP asks for `grad_<name>`. Outputs: a VJP hands over `grad_<name>`.
    pub gradient: bool,
}

/// Something wrong that people really write, runnable through [`Component::wrong`].
#[derive(Clone, Copy, Debug)]
pub struct Mistake {
    /// Name, unique within the component, e.g. `inclusive_transmittance`.
    pub name: &'static str,
    /// What was written.
    pub cause: &'static str,
    /// What it does to a picture or a training.
    pub effect: &'static str,
    /// Where it has been seen, and how often.
    pub seen: &'static str,
    /// How to mend it.
    pub fix: &'static str,
    /// How often it was seen: ranks hypotheses that explain equally well.
    pub count: u32,
}

/// A function over named arrays in given conventions.
pub type Function = fn(&Arrays, &Conventions) -> Arrays;

/// One row of the judging contract.
#[derive(Clone, Copy)]
pub struct Component {
    /// Name of the row, e.g. `volume_render`.
    pub name: &'static str,
    /// Its folder under `src/`.
    pub folder: &'static str,
    /// The formula, on a line or two.
    pub formula: &'static str,
    /// Paper and equation, or the code that defines it.
    pub source: &'static str,
    /// Input arrays.
    pub inputs: &'static [Port],
    /// Output arrays.
    pub outputs: &'static [Port],
    /// Conventions that the result depends on (keys of [`crate::convention::CHOICES`]).
    pub conventions: &'static [&'static str],
    /// The oracle.
    pub forward: Function,
    /// The oracle's vector-Jacobian product: inputs and `grad_<output>` -> `grad_<input>`.
    pub vjp: Option<Function>,
}

/// A scalar as an array.
pub fn scalar(x: f64) -> ArrayD<f64> {
    ArrayD::from_elem(IxDyn(&[]), x)
}

/// An array from its shape and its entries, row by row.
///
/// # Panics
/// Where their numbers differ.
pub fn array(shape: &[usize], data: Vec<f64>) -> ArrayD<f64> {
    ArrayD::from_shape_vec(IxDyn(shape), data).expect("as many entries as the shape says")
}
