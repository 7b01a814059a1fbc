//! Cases: named inputs, generated from a seed, exactly representable in the types that they are for.

use ndarray::ArrayD;

use super::arithmetic::Dtype;
use super::arrays::{Arrays, array};
use crate::random::{Key, Purpose};

/// One case of a component.
#[derive(Clone, Debug)]
pub struct Case {
    /// Unique within the component, e.g. `spikes` or `VR1_tiny_alpha`.
    pub id: String,
    /// What it probes, in a sentence.
    pub comment: &'static str,
    /// Input arrays.
    pub inputs: Arrays,
    /// Left out of the VJP's cases, e.g. for its size.
    pub forward_only: bool,
}

impl Case {
    /// A named case.
    pub fn new(id: impl ToString, comment: &'static str, inputs: Vec<(&str, ArrayD<f64>)>) -> Self {
        let inputs = inputs.into_iter().map(|(name, array)| (name.to_string(), array)).collect();
        Case { id: id.to_string(), comment, inputs, forward_only: false }
    }

    /// The same without a VJP case.
    pub fn forward_only(self) -> Self {
        Case { forward_only: true, ..self }
    }

    /// Whether all inputs are numbers of `dtype`. Hyper-parameters (scalars) are f64 in every type.
    pub fn exists_in(&self, dtype: Dtype) -> bool {
        self.inputs.values().filter(|a| a.ndim() > 0).all(|a| a.iter().all(|&x| dtype.holds(x)))
    }
}

/// A seeded source of short numbers: 7 significant bits, so that every type holds them.
#[derive(Debug)]
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
