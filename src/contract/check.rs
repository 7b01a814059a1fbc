//! Comparing answers with the truth: the error that a candidate may have, and whether it exceeds that.

use ndarray::{ArrayD, Zip};

use super::arithmetic::{Arithmetic, Dtype, Grade};
use super::arrays::Arrays;
use super::case::{Case, Draw, lengthen};
use super::component::{Component, Direction};
use crate::convention::Conventions;

/// Forward or backward.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Kind {
    /// Inputs -> outputs.
    Forward,
    /// Inputs and cotangents -> gradients.
    Vjp,
}

impl Component {
    /// The functions of this direction, if the component has it.
    pub fn direction(&self, kind: Kind) -> Option<&Direction> {
        match kind {
            Kind::Forward => Some(&self.forward),
            Kind::Vjp => self.vjp.as_ref(),
        }
    }

    /// The cases of this direction: for the VJP the forward ones, with cotangents k / 16 (k = +-1, ..., +-16) that every type holds, or
    /// near those and of every bit of a type, as the case's own numbers.
    pub fn cases_of(&self, kind: Kind, c: &Conventions) -> Vec<Case> {
        let mut cases = (self.cases)();
        cases.iter_mut().for_each(|case| (self.special.reshape)(&mut case.inputs, c));
        if kind == Kind::Vjp {
            cases.retain(|case| !case.forward_only);
            for (n, case) in cases.iter_mut().enumerate() {
                let outputs = (self.forward.oracle)(&case.inputs, c);
                let mut draw = Draw::new(self.name, 1000 + n as u64);
                for port in self.outputs.iter().filter(|port| port.gradient) {
                    let mut cotangent = outputs[port.name].mapv(|_| {
                        let k = 1.0 + draw.below(16) as f64;
                        if draw.below(2) == 0 { k / 16.0 } else { -k / 16.0 }
                    });
                    if let Some(dtype) = case.full {
                        lengthen(&mut cotangent, dtype, &mut draw);
                    }
                    case.inputs.insert(format!("grad_{}", port.name), cotangent);
                }
            }
        }
        cases
    }
}

/// The error that an answer in `arithmetic` may have: its own bound, plus the oracle's (which rounds in f64).
pub fn tolerance(direction: &Direction, inputs: &Arrays, c: &Conventions, arithmetic: &Arithmetic) -> Arrays {
    with_oracle_error((direction.bound)(inputs, c, arithmetic), &oracle_error(direction, inputs, c))
}

/// How far off the oracle itself may be.
pub(crate) fn oracle_error(direction: &Direction, inputs: &Arrays, c: &Conventions) -> Arrays {
    (direction.bound)(inputs, c, &Arithmetic::new(Dtype::F64, Grade::A))
}

/// A bound of one's own, plus the oracle's error.
pub(crate) fn with_oracle_error(mut own: Arrays, oracle: &Arrays) -> Arrays {
    own.iter_mut().for_each(|(name, bound)| *bound += &oracle[name]);
    own
}

/// One output against its bound.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Largest error over bound; infinite where an answer is NaN or off where the bound is 0.
    pub budget_used: f64,
    /// Where (index into the array, row-major).
    pub worst: usize,
    /// Elements whose bound reaches their size: they prove nothing.
    pub vacuous: usize,
    /// Elements in all.
    pub elements: usize,
}

/// Compares an answer with the truth. Equal infinities match; a NaN matches nothing but a NaN.
pub fn compare(got: &ArrayD<f64>, expected: &ArrayD<f64>, bound: &ArrayD<f64>) -> Outcome {
    let mut outcome = Outcome { budget_used: 0.0, worst: 0, vacuous: 0, elements: expected.len() };
    let mut index = 0;
    Zip::from(got).and(expected).and(bound).for_each(|&got, &expected, &bound| {
        let used = budget_used(got, expected, bound);
        if used > outcome.budget_used {
            (outcome.budget_used, outcome.worst) = (used, index);
        }
        outcome.vacuous += usize::from(expected.is_finite() && bound >= expected.abs() && bound > 0.0);
        index += 1;
    });
    outcome
}

/// |got - expected| / bound of one element.
pub fn budget_used(got: f64, expected: f64, bound: f64) -> f64 {
    if got == expected || (got.is_nan() && expected.is_nan()) || bound == f64::INFINITY {
        return 0.0;
    }
    let error = (got - expected).abs();
    // An exact element (bound 0) that is off, or a NaN, exceeds any bound.
    if error.is_nan() || bound == 0.0 { f64::INFINITY } else { error / bound }
}

/// The worst outcome over all of a direction's outputs. An output of another shape exceeds any bound.
pub fn worst(got: &Arrays, expected: &Arrays, bound: &Arrays) -> f64 {
    let used = |(name, expected): (&String, &ArrayD<f64>)| {
        let got = &got[name];
        if got.shape() == expected.shape() {
            compare(got, expected, &bound[name]).budget_used
        } else {
            f64::INFINITY
        }
    };
    expected.iter().map(used).fold(0.0, f64::max)
}
