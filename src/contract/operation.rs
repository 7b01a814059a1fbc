//! The operations of a formula.

use crate::math::{cos, exp, ln, pow, sin};

/// What is done with one number, with two, or with many.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Operation {
    /// A number that is given: an input, or a constant.
    Given,
    /// A result that the machine only rounds.
    Rounded,
    Neg,
    Sqrt,
    Exp,
    Expm1,
    Ln,
    Sin,
    Cos,
    Add,
    Sub,
    Mul,
    Div,
    Pow,
    Max,
    Min,
    /// A number that passes where another is above a third.
    Above,
    Sum,
    Dot,
}

impl Operation {
    /// Of two numbers; a function takes the first.
    pub(crate) fn of(self, a: f64, b: f64) -> f64 {
        match self {
            Operation::Given | Operation::Rounded | Operation::Above | Operation::Sum | Operation::Dot => a,
            Operation::Neg => -a,
            Operation::Sqrt => a.sqrt(),
            Operation::Exp => exp(a),
            Operation::Expm1 => crate::math::expm1(a),
            Operation::Ln => ln(a),
            Operation::Sin => sin(a),
            Operation::Cos => cos(a),
            Operation::Add => a + b,
            Operation::Sub => a - b,
            Operation::Mul => a * b,
            Operation::Div => a / b,
            Operation::Pow => pow(a, b),
            Operation::Max => a.max(b),
            Operation::Min => a.min(b),
        }
    }
}
