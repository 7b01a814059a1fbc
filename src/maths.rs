//! Elementary functions that give the same bits on every machine, and a compensated sum.
//!
//! `std`'s `exp`, `sin`, ... go to the platform's library and differ from it on about one input in ten. The oracle calls
//! the `libm` crate through this file instead. `sqrt`, `+`, `*`, `/` are IEEE operations and are equal everywhere.

use std::f64::consts::PI;

/// e^x, within 1 ULP.
pub fn exp(x: f64) -> f64 {
    libm::exp(x)
}

/// e^x - 1 without the cancellation of `exp(x) - 1` near 0.
pub fn expm1(x: f64) -> f64 {
    libm::expm1(x)
}

/// Natural logarithm.
pub fn ln(x: f64) -> f64 {
    libm::log(x)
}

/// ln(1 + x) without the rounding of `1 + x` near 0.
pub fn ln_1p(x: f64) -> f64 {
    libm::log1p(x)
}

/// Decimal logarithm.
pub fn log10(x: f64) -> f64 {
    libm::log10(x)
}

/// sin x.
pub fn sin(x: f64) -> f64 {
    libm::sin(x)
}

/// cos x.
pub fn cos(x: f64) -> f64 {
    libm::cos(x)
}

/// x^y.
pub fn pow(x: f64, y: f64) -> f64 {
    libm::pow(x, y)
}

/// sin(pi x), exact where it is 0, +-1, and within 4 ULP elsewhere.
///
/// x is reduced to x - n/2 in [-1/4, 1/4], which is exact in binary: `sin(PI * x)` instead rounds `PI * x`, so that
/// `sin(PI * 512.0)` is -6e-14 and at x = 2^9 + 1/3 thousands of ULP are lost.
///
/// ```
/// use nerf_oracle::maths::sin_pi;
/// assert_eq!(sin_pi(512.0), 0.0);
/// assert_eq!(sin_pi(0.5), 1.0);
/// assert_eq!(sin_pi(-1.5), 1.0);
/// ```
pub fn sin_pi(x: f64) -> f64 {
    let (quadrant, r) = reduce(x);
    match quadrant {
        0 => libm::sin(PI * r),
        1 => libm::cos(PI * r),
        2 => -libm::sin(PI * r),
        _ => -libm::cos(PI * r),
    }
}

/// cos(pi x), exact where it is 0, +-1, and within 4 ULP elsewhere.
///
/// ```
/// use nerf_oracle::maths::cos_pi;
/// assert_eq!(cos_pi(512.0), 1.0);
/// assert_eq!(cos_pi(0.5), 0.0);
/// ```
pub fn cos_pi(x: f64) -> f64 {
    let (quadrant, r) = reduce(x);
    match quadrant {
        0 => libm::cos(PI * r),
        1 => -libm::sin(PI * r),
        2 => -libm::cos(PI * r),
        _ => libm::sin(PI * r),
    }
}

/// x = quadrant / 2 + r (mod 2), with r in [-1/4, 1/4]. Every step is exact: `%` is, and the difference of two numbers
/// within a factor of 2 of each other is (Sterbenz).
fn reduce(x: f64) -> (i64, f64) {
    let x = x % 2.0;
    let half_turns = libm::rint(2.0 * x);
    ((half_turns as i64).rem_euclid(4), x - half_turns / 2.0)
}

/// A sum that carries its own rounding error along (Neumaier 1974): n terms cost 2 roundings of the result instead of n.
///
/// ```
/// let mut sum = nerf_oracle::maths::Sum::default();
/// for x in [1.0, 1e100, 1.0, -1e100] { sum.add(x); }
/// assert_eq!(sum.value(), 2.0);
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct Sum {
    high: f64,
    low: f64,
}

impl Sum {
    /// Adds one term.
    pub fn add(&mut self, x: f64) {
        let sum = self.high + x;
        if sum.is_finite() {
            // The exact rounding error of the line above, whichever operand was the larger.
            self.low +=
                if self.high.abs() >= x.abs() { (self.high - sum) + x } else { (x - sum) + self.high };
        }
        self.high = sum;
    }

    /// The sum so far.
    pub fn value(&self) -> f64 {
        self.high + self.low
    }
}
