//! Elementary functions that give the same bits on every machine, and a compensated sum.
//!
//! `std`'s `exp`, `sin`, ... use the platform's library, which gives other bits on about one input in ten. The oracle calls
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

/// 2^n, exact.
pub fn power_of_two(n: i32) -> f64 {
    libm::ldexp(1.0, n)
}

/// The error function, 2 / sqrt(pi) times the integral of e^(-t^2) from 0 to x.
pub fn erf(x: f64) -> f64 {
    libm::erf(x)
}

/// sin(pi x), exact where it is 0, +-1, and within 4 ULP elsewhere.
///
/// x is reduced to x - n/2 in [-1/4, 1/4], which is exact in binary: `sin(PI * x)` instead rounds `PI * x`, so that
/// `sin(PI * 512.0)` is -6e-14 and at x = 2^9 + 1/3 thousands of ULP are lost.
///
/// ```
/// use nerf_oracle::math::sin_pi;
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
/// use nerf_oracle::math::cos_pi;
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

/// A compensated sum (Neumaier 1974): the error of n terms is that of 2 roundings of the result instead of n.
///
/// ```
/// let mut sum = nerf_oracle::math::Sum::default();
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

    /// The sum times x, rounding error of the product included.
    pub fn times(&self, x: f64) -> Sum {
        let high = self.high * x;
        Sum { high, low: self.high.mul_add(x, -high) + self.low * x }
    }
}

/// A compensated product, like [`Sum`]: the error of n factors is that of 2 roundings of the result instead of n.
/// Factors are sums, since the rounding error of a factor counts as much as that of the product (1 - alpha near alpha = 0).
///
/// ```
/// use nerf_oracle::math::{Product, Sum};
/// let mut nine_tenths = Sum::default();
/// [1.0, -0.1].iter().for_each(|&x| nine_tenths.add(x));
/// let mut product = Product::default();
/// for _ in 0..64 { product.multiply(nine_tenths); }
/// assert_eq!(product.value(), 0.0011790184577738579); // one rounding at a time: ...8598, 9 ULP off
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Product {
    high: f64,
    low: f64,
}

impl Default for Product {
    /// The empty product, 1.
    fn default() -> Self {
        Product { high: 1.0, low: 0.0 }
    }
}

impl Product {
    /// Multiplies by one factor.
    pub fn multiply(&mut self, x: Sum) {
        let product = self.high * x.high;
        // The exact rounding error of the line above, and the compensations of the two operands.
        let error = self.high.mul_add(x.high, -product);
        self.low = error + (self.high * x.low + self.low * x.high);
        self.high = product;
    }

    /// The product so far.
    pub fn value(&self) -> f64 {
        self.high + self.low
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Distance in units of the last place of `expected`.
    fn ulps(got: f64, expected: f64) -> u64 {
        (got.to_bits() as i64).abs_diff(expected.to_bits() as i64)
    }

    /// (x, sin pi x, cos pi x) from mpmath at 60 digits, rounded to f64, at the f64 that x denotes.
    #[allow(clippy::approx_constant, clippy::excessive_precision)]
    const EXACT: [(f64, f64, f64); 12] = [
        (0.3333333333333333, 0.8660254037844386, 0.5),
        (0.1, 0.30901699437494745, 0.9510565162951535),
        (0.25, 0.7071067811865476, 0.7071067811865476),
        (0.7, 0.8090169943749475, -0.587785252292473),
        (1e-05, 3.141592653073022e-05, 0.9999999995065197),
        (512.3333333333334, 0.8660254037844982, 0.4999999999998969),
        (-1.9, 0.3090169943749477, 0.9510565162951535),
        (123456.789, 0.6153863701685053, -0.7882256119987674),
        (1099511627776.375, 0.9238795325112867, 0.3826834323650898),
        (1e-300, 3.1415926535897936e-300, 1.0),
        (0.49999999999999994, 1.0, 1.743934249004316e-16),
        (361.3315651863258, -0.8632346583339092, -0.5048028572137236),
    ];

    #[test]
    fn sin_pi_and_cos_pi_are_within_4_ulp() {
        for (x, sine, cosine) in EXACT {
            assert!(ulps(sin_pi(x), sine) <= 4, "sin_pi({x}) = {}, not {sine}", sin_pi(x));
            assert!(ulps(cos_pi(x), cosine) <= 4, "cos_pi({x}) = {}, not {cosine}", cos_pi(x));
        }
        // PE3: the textbook form sin(PI * x) at the same points is off by millions.
        assert!(ulps(sin(PI * 123456.789), 0.6153863701685053) > 1_000);
        assert!(ulps(sin(PI * 1099511627776.375), 0.9238795325112867) > 1_000_000);
    }

    #[test]
    fn pe3_zeros_and_extremes_are_exact() {
        for n in [0.0, 1.0, 2.0, 3.0, 511.0, 1024.0, 1e15, power_of_two(52) + 1.0, 1e300] {
            let sign = if n % 2.0 == 0.0 { 1.0 } else { -1.0 };
            for n in [n, -n] {
                assert_eq!((sin_pi(n), cos_pi(n)), (0.0, sign));
            }
        }
        for (x, expected) in
            [(0.5, (1.0, 0.0)), (-0.5, (-1.0, 0.0)), (1.5, (-1.0, 0.0)), (513.5, (-1.0, 0.0))]
        {
            assert_eq!((sin_pi(x), cos_pi(x)), expected);
        }
        assert_eq!((sin_pi(-0.0), cos_pi(-0.0)), (0.0, 1.0));
        assert_eq!((sin_pi(5e-324), cos_pi(5e-324)), (1.5e-323, 1.0));
        assert!(sin_pi(f64::INFINITY).is_nan() && cos_pi(f64::NAN).is_nan());
    }

    #[test]
    fn sin_pi_has_its_symmetries_bit_for_bit() {
        for n in 0..1000 {
            let x = f64::from(n) / 128.0 + f64::from(n) * power_of_two(-40);
            assert_eq!(sin_pi(-x), -sin_pi(x));
            assert_eq!(cos_pi(-x), cos_pi(x));
            assert_eq!(sin_pi(x + 2.0), sin_pi(x), "x + 2 is exact here");
            assert_eq!(cos_pi(x), sin_pi(x + 0.5));
            assert!((sin_pi(x) * sin_pi(x) + cos_pi(x) * cos_pi(x) - 1.0).abs() <= 4.0 * f64::EPSILON);
        }
    }

    #[test]
    fn powers_of_two_are_exact() {
        let mut power = 1.0;
        for n in 0..1024 {
            assert_eq!((power_of_two(n), power_of_two(-n)), (power, 1.0 / power));
            power *= 2.0;
        }
    }

    #[test]
    fn wrappers_keep_digits_near_0() {
        assert_eq!((expm1(1e-20), ln_1p(1e-20)), (1e-20, 1e-20));
        assert_eq!(
            (exp(0.0), ln(1.0), log10(1000.0), sin(0.0), cos(0.0), pow(2.0, 10.0)),
            (1.0, 0.0, 3.0, 0.0, 1.0, 1024.0)
        );
        // 2 / sqrt(pi) (1 - 1/3 + 1/10 - ...), from mpmath.
        assert!(erf(0.0) == 0.0 && ulps(erf(1.0), 0.8427007929497149) <= 1 && erf(-1.0) == -erf(1.0));
        assert!(ulps(exp(1.0), std::f64::consts::E) <= 1 && ulps(ln(10.0), std::f64::consts::LN_10) <= 1);
        assert!(ulps(sin(1.0), 0.8414709848078965) <= 1 && ulps(cos(1.0), 0.5403023058681398) <= 1);
    }

    #[test]
    fn a_sum_times_a_number_keeps_its_digits() {
        // (1 + 2^-60) 0.1 - 0.1: the product rounds to 0.1, 0.1 2^-60 is left.
        let mut sum = Sum::default();
        [1.0, power_of_two(-60)].iter().for_each(|&x| sum.add(x));
        let mut left = sum.times(0.1);
        left.add(-0.1);
        assert_eq!(left.value(), 0.1 * power_of_two(-60));
        // (1 + 2^-30)^2 = 1 + 2^-29 + 2^-60, whose last term the rounded product lacks.
        let mut sum = Sum::default();
        sum.add(1.0 + power_of_two(-30));
        let mut left = sum.times(1.0 + power_of_two(-30));
        left.add(-1.0 - power_of_two(-29));
        assert_eq!(left.value(), power_of_two(-60));
    }

    #[test]
    fn a_product_costs_two_roundings_however_long() {
        // (1 + 2^-30)^1024 by the binomial theorem: 1 + 2^-20 + 523,776 2^-60 + ...
        let mut factor = Sum::default();
        [1.0, power_of_two(-30)].iter().for_each(|&x| factor.add(x));
        let mut product = Product::default();
        (0..1024).for_each(|_| product.multiply(factor));
        assert_eq!(product.value(), 1.0 + (power_of_two(-20) + 523_776.0 * power_of_two(-60)));
        let plain = (0..1024).fold(1.0, |product: f64, _| product * (1.0 + power_of_two(-30)));
        assert!(ulps(plain, product.value()) >= 1, "the plain product drifts");
        // Each factor's own rounding counts too: (1 - 0.1)^64, 0.1 as an f64, from exact rationals.
        let mut factor = Sum::default();
        [1.0, -0.1].iter().for_each(|&x| factor.add(x));
        let mut product = Product::default();
        (0..64).for_each(|_| product.multiply(factor));
        assert_eq!(product.value(), 0.0011790184577738579);
        // A factor below the first one's last digit: 1 - 2^-60, 2^10 times over.
        let mut factor = Sum::default();
        [1.0, -power_of_two(-60)].iter().for_each(|&x| factor.add(x));
        let mut product = Product::default();
        (0..1024).for_each(|_| product.multiply(factor));
        assert_eq!(product.value(), 1.0 - power_of_two(-50));
        assert_eq!(Product::default().value(), 1.0);
        product.multiply(Sum::default());
        assert_eq!(product.value(), 0.0);
    }

    #[test]
    fn a_sum_costs_two_roundings_however_long() {
        // 0.1 a million times: the exact sum of the f64 next to 0.1.
        let (mut sum, mut plain) = (Sum::default(), 0.0);
        for _ in 0..1_000_000 {
            sum.add(0.1);
            plain += 0.1;
        }
        assert_eq!(sum.value(), 100000.0);
        assert!((plain - 100000.0_f64).abs() > 1e-7, "the plain sum drifts");
        // Small before large: the error of the larger operand's side.
        let mut sum = Sum::default();
        [1.0, 1e100, 1.0, -1e100].iter().for_each(|&x| sum.add(x));
        assert_eq!(sum.value(), 2.0);
        // An infinite term stays infinite instead of turning into inf - inf.
        let mut sum = Sum::default();
        [1.0, f64::INFINITY, 1.0].iter().for_each(|&x| sum.add(x));
        assert_eq!(sum.value(), f64::INFINITY);
    }
}
