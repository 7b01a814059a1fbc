//! Cases: named inputs, generated from a seed, exactly representable in the types that they are for.

use ndarray::ArrayD;

use super::arithmetic::Dtype;
use super::arrays::{Arrays, array};
use super::inputs::Inputs;
use crate::random::{Key, Purpose};

/// One case of a component.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// Unique within the component, e.g. `spikes` or `VR1_tiny_alpha`.
    pub id: String,
    /// What it probes, in a sentence.
    pub comment: &'static str,
    /// Input arrays.
    pub inputs: Inputs,
    /// Left out of the VJP's cases, e.g. for its size.
    pub forward_only: bool,
    /// The type whose every bit the numbers use, if they do ([`in_full`]): cotangents do then too.
    pub full: Option<Dtype>,
    /// The only type that it is for, where its numbers mean something else in others.
    pub only: Option<Dtype>,
    /// What makes it an edge case, which few programs ever meet: no samples, one sample.
    pub edge: Option<&'static str>,
}

impl Case {
    /// A named case.
    pub fn new(id: impl ToString, comment: &'static str, inputs: Vec<(&str, ArrayD<f64>)>) -> Self {
        let inputs: Arrays = inputs.into_iter().map(|(name, array)| (name.to_string(), array)).collect();
        let inputs = inputs.into();
        Case { id: id.to_string(), comment, inputs, forward_only: false, full: None, only: None, edge: None }
    }

    /// How many numbers go in.
    pub fn size(&self) -> usize {
        self.inputs.size()
    }

    /// Whether all that goes in is a finite number.
    pub fn finite(&self) -> bool {
        self.inputs.finite()
    }

    /// The same without a VJP case.
    pub fn forward_only(self) -> Self {
        Case { forward_only: true, ..self }
    }

    /// The same as an edge case.
    pub fn edge(self, what: &'static str) -> Self {
        Case { edge: Some(what), ..self }
    }

    /// Whether it is for `dtype`, and all inputs are numbers of it. Hyper-parameters (scalars) are f64 in every type.
    pub fn exists_in(&self, dtype: Dtype) -> bool {
        self.only.is_none_or(|only| only == dtype)
            && self.inputs.values().filter(|a| a.ndim() > 0).all(|a| a.iter().all(|&x| dtype.holds(x)))
    }
}

/// The cases, and that of this id twice more, with numbers near its own that use every bit of f32 and of f64: whoever rounds an input to
/// a shorter type on the way is off there.
///
/// # Panics
/// Without a case of this id.
pub fn in_full(mut cases: Vec<Case>, id: &str) -> Vec<Case> {
    let short = cases.iter().find(|case| case.id == id).unwrap_or_else(|| panic!("no case {id}")).clone();
    for (dtype, comment) in
        [(Dtype::F32, "numbers that use every bit of f32"), (Dtype::F64, "numbers that use every bit of f64")]
    {
        let mut case = Case { id: format!("{id}_{dtype}"), comment, full: Some(dtype), ..short.clone() };
        let mut draw = Draw::new(&case.id, 0);
        case.inputs.values_mut().for_each(|array| lengthen(array, dtype, &mut draw));
        cases.push(case);
    }
    cases
}

/// Moves numbers by up to 2^-8 of their size to others of `dtype`. Whole ones stay: they are counts, or exact in every type for a reason
/// (the last row of a pose). So do scalars, which are hyper-parameters.
pub fn lengthen(array: &mut ArrayD<f64>, dtype: Dtype, draw: &mut Draw) {
    if array.ndim() > 0 {
        let near = |x: f64, u: f64| dtype.round(x * (1.0 + (u - 0.5) / 128.0));
        array.mapv_inplace(|x| if x.fract() == 0.0 { x } else { near(x, draw.unit()) });
    }
}

/// A seeded source of short numbers: 7 significant bits, so that every type holds them.
#[derive(Clone, Debug)]
pub struct Draw {
    key: Key,
    stream: u64,
    next: u64,
}

impl Draw {
    /// Stream `stream` of the cases of a component; keyed by its name, so that adding a component changes no other's cases.
    pub fn new(component: &str, stream: u64) -> Self {
        let seed =
            component.bytes().fold(0, |hash: u64, byte| hash.wrapping_mul(31).wrapping_add(byte.into()));
        Draw { key: Key::new(seed, Purpose::Cases), stream, next: 0 }
    }

    /// A number in [0, 1).
    pub fn unit(&mut self) -> f64 {
        self.next += 1;
        self.key.uniform(0, self.stream, self.next - 1)
    }

    /// A whole number in [0, n).
    pub fn below(&mut self, n: u64) -> u64 {
        (self.unit() * n as f64) as u64
    }

    /// A number in [low, high], rounded to 7 significant bits.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        short(low + (high - low) * self.unit())
    }

    /// 10^x with x uniform in [low, high].
    pub fn decades(&mut self, low: f64, high: f64) -> f64 {
        short(crate::math::pow(10.0, low + (high - low) * self.unit()))
    }

    /// An array of numbers in [low, high].
    pub fn array(&mut self, shape: &[usize], low: f64, high: f64) -> ArrayD<f64> {
        let n = shape.iter().product();
        array(shape, (0..n).map(|_| self.between(low, high)).collect())
    }
}

/// x rounded to 7 significant bits.
pub fn short(x: f64) -> f64 {
    let (fraction, exponent) = libm::frexp(x);
    libm::ldexp(libm::rint(libm::ldexp(fraction, 7)), exponent - 7)
}
