//! The operations of arithmetic, so that a formula of many steps is written once: with [`Arithmetic`] it is a running error analysis,
//! with [`Machine`] an honest implementation.
//!
//! A component whose honest code has several ways to its result numbers them. A machine takes one, the bound is the widest of all.

use super::arithmetic::Arithmetic;
use super::bounded::{Bounded, any_order, exact, hyper};
use super::machine::Machine;
use super::operation::Operation;
use crate::math::{expm1, ln, ln_1p, pow};

/// Arithmetic on numbers of some kind.
pub(crate) trait Operations {
    /// A number.
    type Number: Copy;

    /// A number that the type holds.
    fn exact(&self, y: f64) -> Self::Number;
    /// A constant or hyper-parameter: given in f64, rounded to the type.
    fn hyper(&self, y: f64) -> Self::Number;
    /// Whether it is 0, exactly.
    fn is_zero(&self, a: Self::Number) -> bool;
    /// -a.
    fn neg(&self, a: Self::Number) -> Self::Number;
    /// a + b.
    fn add(&self, a: Self::Number, b: Self::Number) -> Self::Number;
    /// a b.
    fn mul(&self, a: Self::Number, b: Self::Number) -> Self::Number;
    /// a / b.
    fn div(&self, a: Self::Number, b: Self::Number) -> Self::Number;
    /// The square root.
    fn sqrt(&self, a: Self::Number) -> Self::Number;
    /// e^a.
    fn exp(&self, a: Self::Number) -> Self::Number;
    /// The natural logarithm, for a > 0.
    fn ln(&self, a: Self::Number) -> Self::Number;
    /// a^b, for a > 0.
    fn pow(&self, a: Self::Number, b: Self::Number) -> Self::Number;
    /// sin a.
    fn sin(&self, a: Self::Number) -> Self::Number;
    /// cos a.
    fn cos(&self, a: Self::Number) -> Self::Number;
    /// The larger of two.
    fn max(&self, a: Self::Number, b: Self::Number) -> Self::Number;
    /// g where a is above b, else 0: a gradient through a limit.
    fn above(&self, a: Self::Number, b: Self::Number, g: Self::Number) -> Self::Number;
    /// A sum, in any order.
    fn sum(&self, terms: &[Self::Number]) -> Self::Number;
    /// A sum of products, in any order, fused or not.
    fn dot(&self, a: &[Self::Number], b: &[Self::Number]) -> Self::Number;

    /// a - b.
    fn sub(&self, a: Self::Number, b: Self::Number) -> Self::Number {
        self.add(a, self.neg(b))
    }

    /// The smaller of two.
    fn min(&self, a: Self::Number, b: Self::Number) -> Self::Number {
        self.neg(self.max(self.neg(a), self.neg(b)))
    }

    /// A product with a number that is exact, such as 2.
    fn times(&self, a: f64, b: Self::Number) -> Self::Number {
        self.mul(self.exact(a), b)
    }
}

/// How far off the logarithm of a positive number may be.
fn logarithm_off(a: Bounded) -> f64 {
    -ln_1p(-a.e / a.y)
}

impl Operations for Arithmetic {
    type Number = Bounded;

    fn exact(&self, y: f64) -> Bounded {
        exact(y)
    }
    fn hyper(&self, y: f64) -> Bounded {
        hyper(y, self)
    }
    fn is_zero(&self, a: Bounded) -> bool {
        a == exact(0.0)
    }
    fn neg(&self, a: Bounded) -> Bounded {
        a.neg()
    }
    fn add(&self, a: Bounded, b: Bounded) -> Bounded {
        Arithmetic::add(self, a, b)
    }
    fn mul(&self, a: Bounded, b: Bounded) -> Bounded {
        Arithmetic::mul(self, a, b)
    }
    fn div(&self, a: Bounded, b: Bounded) -> Bounded {
        Arithmetic::div(self, a, b)
    }
    fn sqrt(&self, a: Bounded) -> Bounded {
        Arithmetic::sqrt(self, a)
    }
    fn exp(&self, a: Bounded) -> Bounded {
        Arithmetic::exp(self, a)
    }
    fn ln(&self, a: Bounded) -> Bounded {
        self.elementary(ln(a.y), logarithm_off(a))
    }
    fn pow(&self, a: Bounded, b: Bounded) -> Bounded {
        let y = pow(a.y, b.y);
        let off = b.size() * logarithm_off(a) + b.e * ln(a.y).abs();
        self.elementary(y, y * expm1(off))
    }
    fn sin(&self, a: Bounded) -> Bounded {
        Arithmetic::sin(self, a)
    }
    fn cos(&self, a: Bounded) -> Bounded {
        Arithmetic::cos(self, a)
    }
    fn max(&self, a: Bounded, b: Bounded) -> Bounded {
        Bounded { y: a.y.max(b.y), e: a.e.max(b.e) }
    }
    fn above(&self, a: Bounded, b: Bounded, g: Bounded) -> Bounded {
        let (apart, open) = (a.y - b.y, a.e + b.e);
        let taken = if apart > 0.0 { g } else { exact(0.0) };
        // Where rounding may put it on either side, 0 and g are both honest.
        if apart.abs() > open { taken } else { Bounded { y: taken.y, e: g.size() } }
    }
    fn sum(&self, terms: &[Bounded]) -> Bounded {
        any_order(terms, self)
    }
    fn dot(&self, a: &[Bounded], b: &[Bounded]) -> Bounded {
        let products: Vec<Bounded> = a.iter().zip(b).map(|(&a, &b)| Arithmetic::mul(self, a, b)).collect();
        any_order(&products, self)
    }
}

impl Operations for Machine {
    type Number = f64;

    #[track_caller]
    fn exact(&self, y: f64) -> f64 {
        if self.fault.is_none() { y } else { self.done(Operation::Given, y, 0.0) }
    }
    #[track_caller]
    fn hyper(&self, y: f64) -> f64 {
        self.done(Operation::Given, y, 0.0)
    }
    fn is_zero(&self, a: f64) -> bool {
        a == 0.0
    }
    #[track_caller]
    fn neg(&self, a: f64) -> f64 {
        self.done(Operation::Neg, a, 0.0)
    }
    #[track_caller]
    fn add(&self, a: f64, b: f64) -> f64 {
        Machine::add(self, a, b)
    }
    #[track_caller]
    fn sub(&self, a: f64, b: f64) -> f64 {
        Machine::sub(self, a, b)
    }
    #[track_caller]
    fn mul(&self, a: f64, b: f64) -> f64 {
        Machine::mul(self, a, b)
    }
    #[track_caller]
    fn div(&self, a: f64, b: f64) -> f64 {
        Machine::div(self, a, b)
    }
    #[track_caller]
    fn sqrt(&self, a: f64) -> f64 {
        Machine::sqrt(self, a)
    }
    #[track_caller]
    fn exp(&self, a: f64) -> f64 {
        Machine::exp(self, a)
    }
    #[track_caller]
    fn ln(&self, a: f64) -> f64 {
        self.function(Operation::Ln, a, 0.0)
    }
    #[track_caller]
    fn pow(&self, a: f64, b: f64) -> f64 {
        self.function(Operation::Pow, a, b)
    }
    #[track_caller]
    fn sin(&self, a: f64) -> f64 {
        self.function(Operation::Sin, a, 0.0)
    }
    #[track_caller]
    fn cos(&self, a: f64) -> f64 {
        self.function(Operation::Cos, a, 0.0)
    }
    #[track_caller]
    fn max(&self, a: f64, b: f64) -> f64 {
        self.done(Operation::Max, a, b)
    }
    #[track_caller]
    fn min(&self, a: f64, b: f64) -> f64 {
        self.done(Operation::Min, a, b)
    }
    #[track_caller]
    fn above(&self, a: f64, b: f64, g: f64) -> f64 {
        self.done(Operation::Above, if a > b { g } else { 0.0 }, g)
    }
    #[track_caller]
    fn sum(&self, terms: &[f64]) -> f64 {
        Machine::sum(self, terms)
    }
    #[track_caller]
    fn dot(&self, a: &[f64], b: &[f64]) -> f64 {
        Machine::dot(self, a, b)
    }
    #[track_caller]
    fn times(&self, a: f64, b: f64) -> f64 {
        self.done(Operation::Mul, a, b)
    }
}
