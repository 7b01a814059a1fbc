//! Honest implementations to test the bound with: the same formulas in emulated arithmetic, with every freedom that the contract
//! gives an implementation.

use std::panic::Location;

use super::arithmetic::Dtype;
use super::fault::Fault;
use super::operation::Operation;
use crate::random::{Key, Purpose};

/// The order in which a sum is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// Left to right.
    Forward,
    /// Right to left.
    Reverse,
    /// Halves, recursively.
    Pairwise,
    /// Eight interleaved partial sums.
    Blocked,
}

/// One honest machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Machine {
    /// Every result is rounded to this type.
    pub dtype: Dtype,
    /// Order of sums.
    pub order: Order,
    /// Products go into sums unrounded.
    pub fused: bool,
    /// The stable formula where there are two (else the textbook's).
    pub stable: bool,
    /// Which of the component's algorithms (e.g. cumulative sum or product), modulo their number.
    pub form: u64,
    /// Errors of elementary functions are drawn from here.
    pub noise: u64,
    /// Operations that it does wrong: then it isn't honest, and elementary functions have no errors.
    pub(crate) fault: Option<Fault>,
}

impl Machine {
    /// Machine number n for `dtype`: enumerates all combinations.
    pub fn number(dtype: Dtype, n: u64) -> Self {
        let order = [Order::Forward, Order::Reverse, Order::Pairwise, Order::Blocked][(n % 4) as usize];
        Machine {
            dtype,
            order,
            fused: n / 4 % 2 == 1,
            stable: n / 8 % 2 == 1,
            form: n / 16,
            noise: n,
            fault: None,
        }
    }

    /// x rounded to the type.
    #[track_caller]
    pub fn round(&self, x: f64) -> f64 {
        self.done(Operation::Rounded, x, 0.0)
    }

    /// a + b.
    #[track_caller]
    pub fn add(&self, a: f64, b: f64) -> f64 {
        self.done(Operation::Add, a, b)
    }

    /// a - b.
    #[track_caller]
    pub fn sub(&self, a: f64, b: f64) -> f64 {
        self.done(Operation::Sub, a, b)
    }

    /// a b.
    #[track_caller]
    pub fn mul(&self, a: f64, b: f64) -> f64 {
        self.done(Operation::Mul, a, b)
    }

    /// a / b.
    #[track_caller]
    pub fn div(&self, a: f64, b: f64) -> f64 {
        self.done(Operation::Div, a, b)
    }

    /// The square root.
    #[track_caller]
    pub fn sqrt(&self, a: f64) -> f64 {
        self.done(Operation::Sqrt, a, 0.0)
    }

    /// An operation on two numbers, or a function of the first, rounded.
    #[track_caller]
    pub(crate) fn done(&self, operation: Operation, a: f64, b: f64) -> f64 {
        self.dtype.round(self.plain(operation, a, b))
    }

    #[track_caller]
    fn plain(&self, operation: Operation, a: f64, b: f64) -> f64 {
        match &self.fault {
            None => operation.of(a, b),
            Some(fault) => fault.done(operation, a, b, Location::caller()),
        }
    }

    /// An elementary function's value y, off by up to 4 ULP (3.5 before rounding), seeded by y and the machine.
    #[track_caller]
    pub fn elementary(&self, y: f64) -> f64 {
        self.off(self.plain(Operation::Rounded, y, 0.0))
    }

    /// The same of one that is known by name.
    #[track_caller]
    pub(crate) fn function(&self, operation: Operation, a: f64, b: f64) -> f64 {
        self.off(self.plain(operation, a, b))
    }

    fn off(&self, y: f64) -> f64 {
        if self.fault.is_some() {
            return self.dtype.round(y);
        }
        let u = Key::new(self.noise, Purpose::Cases).uniform(0, y.to_bits(), 0);
        self.dtype.round(y * (1.0 + 7.0 * (u - 0.5) * self.dtype.unit_roundoff()))
    }

    /// e^x; whatever its error, not above 1 for x <= 0.
    #[track_caller]
    pub fn exp(&self, x: f64) -> f64 {
        let y = self.function(Operation::Exp, x, 0.0);
        if x <= 0.0 && self.fault.is_none() { y.min(1.0) } else { y }
    }

    /// e^x - 1, not below -1.
    #[track_caller]
    pub fn expm1(&self, x: f64) -> f64 {
        let y = self.function(Operation::Expm1, x, 0.0);
        if self.fault.is_none() { y.max(-1.0) } else { y }
    }

    /// The type in which sums accumulate.
    fn accumulator(&self) -> Dtype {
        if self.dtype == Dtype::F64 { Dtype::F64 } else { Dtype::F32 }
    }

    /// A sum in this machine's order.
    #[track_caller]
    pub fn sum(&self, terms: &[f64]) -> f64 {
        self.summed(Operation::Sum, terms)
    }

    /// A sum of products, fused or not.
    #[track_caller]
    pub fn dot(&self, a: &[f64], b: &[f64]) -> f64 {
        let product = |(a, b): (&f64, &f64)| if self.fused { a * b } else { self.dtype.round(a * b) };
        self.summed(Operation::Dot, &a.iter().zip(b).map(product).collect::<Vec<_>>())
    }

    #[track_caller]
    fn summed(&self, operation: Operation, terms: &[f64]) -> f64 {
        let Some(fault) = &self.fault else { return self.dtype.round(self.accumulate(terms)) };
        let sum =
            self.accumulate(fault.terms(operation, terms, Location::caller()).as_deref().unwrap_or(terms));
        self.done(operation, sum, 0.0)
    }

    fn accumulate(&self, terms: &[f64]) -> f64 {
        let add = |sum: f64, x: &f64| self.accumulator().round(sum + x);
        match self.order {
            Order::Forward => terms.iter().fold(0.0, add),
            Order::Reverse => terms.iter().rev().fold(0.0, add),
            Order::Blocked => {
                let lanes: Vec<f64> =
                    (0..8).map(|lane| terms.iter().skip(lane).step_by(8).fold(0.0, add)).collect();
                lanes.iter().fold(0.0, add)
            }
            Order::Pairwise if terms.len() > 2 => {
                let (left, right) = terms.split_at(terms.len() / 2);
                add(self.accumulate(left), &self.accumulate(right))
            }
            Order::Pairwise => terms.iter().fold(0.0, add),
        }
    }

    /// Running sums: entry i is the sum of the first i terms, rounded to the type when it is returned (N + 1 entries).
    pub fn cumulative_sum(&self, terms: &[f64]) -> Vec<f64> {
        (0..=terms.len()).map(|n| self.dtype.round(self.accumulate(&terms[..n]))).collect()
    }

    /// Running products: entry i is the product of the first i factors (N + 1 entries).
    pub fn cumulative_product(&self, factors: &[f64]) -> Vec<f64> {
        let mut products = vec![1.0];
        for (i, &f) in factors.iter().enumerate() {
            products.push(self.dtype.round(products[i] * f));
        }
        products
    }
}
