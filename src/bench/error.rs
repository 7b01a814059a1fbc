//! The stated tolerance of a variant, and the distribution of its errors.

use ndarray::ArrayD;

use super::rounds::quantile;
use crate::contract::arithmetic::Dtype;
use crate::contract::arrays::Arrays;

/// The largest relative error of rounding to bf16 (8 significant bits).
pub const BF16: f64 = 1.0 / 256.0;

/// The largest relative error of rounding to f16 (11 significant bits).
pub const F16: f64 = 1.0 / 2048.0;

/// The stated accuracy of a variant, against which it is checked before it is timed; all parts add up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// The component's own f32 bound, with exp, sin and cos within this many ULP.
    pub exp_ulp: Option<f64>,
    /// Relative to each element.
    pub relative: f64,
    /// Relative to the output's largest element.
    pub of_largest: f64,
    /// Absolute.
    pub absolute: f64,
}

impl Tolerance {
    /// Bit for bit.
    pub const fn exact() -> Tolerance {
        Tolerance { exp_ulp: None, relative: 0.0, of_largest: 0.0, absolute: 0.0 }
    }

    /// The component's f32 bound: elementary functions within 4 ULP.
    pub const fn f32() -> Tolerance {
        Tolerance::grade(4.0)
    }

    /// The component's f32 bound, with elementary functions of a stated grade, in ULP.
    pub const fn grade(ulp: f64) -> Tolerance {
        Tolerance { exp_ulp: Some(ulp), ..Tolerance::exact() }
    }

    /// Adds an error relative to each element: that of rounding to a short type for storage.
    pub const fn stored(self, relative: f64) -> Tolerance {
        Tolerance { relative, ..self }
    }

    /// Adds an error relative to the output's largest element.
    pub const fn of_largest(self, of_largest: f64) -> Tolerance {
        Tolerance { of_largest, ..self }
    }

    /// Adds an absolute error for every element.
    pub const fn within(self, absolute: f64) -> Tolerance {
        Tolerance { absolute, ..self }
    }

    /// The allowed error of each element.
    pub fn bound(&self, component: Option<&Arrays>, expected: &Arrays) -> Arrays {
        let of = |(name, y): (&String, &ArrayD<f64>)| {
            let constant = self.absolute + self.of_largest * largest(y);
            let mut bound = y.mapv(|y| constant + self.relative * y.abs());
            if let Some(component) = component {
                bound += &component[name];
            }
            (name.clone(), bound)
        };
        expected.iter().map(of).collect()
    }
}

fn largest(y: &ArrayD<f64>) -> f64 {
    y.iter().fold(0.0, |max, y| max.max(y.abs()))
}

/// The distribution of a variant's errors over all elements of all outputs. An element below 1/1024 of its output's largest counts
/// as that large: otherwise the sine next to a zero would dominate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// Largest relative error.
    pub max: f64,
    /// 99% of the elements are below.
    pub p99: f64,
    /// Mean of the signed relative error.
    pub bias: f64,
    /// Largest error in units of the last place of the variant's type.
    pub max_ulp: f64,
    /// Largest error.
    pub absolute: f64,
    /// Largest error over the component's bound in the variant's type; `None` if the component has no bound.
    pub budget: Option<f64>,
    /// Largest error over the stated tolerance.
    pub tolerance: f64,
}

impl Errors {
    /// Measures them.
    pub fn measure(
        got: &Arrays,
        expected: &Arrays,
        dtype: Dtype,
        budget: Option<f64>,
        tolerance: f64,
    ) -> Self {
        let (mut relative, mut sum) = (vec![], 0.0);
        let mut errors =
            Errors { max: 0.0, p99: 0.0, bias: 0.0, max_ulp: 0.0, absolute: 0.0, budget, tolerance };
        for (name, y) in expected {
            let floor = (largest(y) / 1024.0).max(f64::MIN_POSITIVE);
            for (got, y) in got[name].iter().zip(y) {
                let (off, size) = (got - y, y.abs().max(floor));
                relative.push(off.abs() / size);
                sum += off / size;
                errors.absolute = errors.absolute.max(off.abs());
                errors.max_ulp = errors.max_ulp.max(off.abs() / dtype.ulp(size));
            }
        }
        errors.max = relative.iter().fold(0.0, |max: f64, e| max.max(*e));
        errors.p99 = quantile(&relative, 0.99);
        errors.bias = sum / relative.len() as f64;
        errors
    }
}

/// Whether a variant's outputs have the oracle's names and shapes.
pub fn same_shapes(got: &Arrays, expected: &Arrays) -> Result<(), String> {
    for (name, y) in expected {
        match got.get(name) {
            None => return Err(format!("no output {name}")),
            Some(x) if x.shape() != y.shape() => {
                return Err(format!("{name} has shape {:?}, not {:?}", x.shape(), y.shape()));
            }
            Some(_) => {}
        }
    }
    Ok(())
}
