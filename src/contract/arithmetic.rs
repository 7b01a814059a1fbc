//! The arithmetic under test: number types, what rounding costs in them, and the grades of the bound.

use std::fmt;
use std::str::FromStr;

use crate::error::{Error, Result};

/// What a candidate computes in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Dtype {
    /// IEEE double.
    F64,
    /// IEEE single.
    F32,
    /// 10 fraction bits, 8 exponent bits (NVIDIA's TensorFloat), kept in f32 arrays.
    Tf32,
    /// 7 fraction bits, 8 exponent bits, kept in f32 arrays.
    Bf16,
    /// IEEE half: 10 fraction bits, 5 exponent bits.
    F16,
}

impl Dtype {
    /// All of them, widest first.
    pub const ALL: [Dtype; 5] = [Dtype::F64, Dtype::F32, Dtype::Tf32, Dtype::Bf16, Dtype::F16];

    /// Significant bits, the hidden one included.
    pub fn bits(self) -> i32 {
        match self {
            Dtype::F64 => 53,
            Dtype::F32 => 24,
            Dtype::Tf32 | Dtype::F16 => 11,
            Dtype::Bf16 => 8,
        }
    }

    /// u = 2^-bits: the largest relative error of one rounding.
    pub fn unit_roundoff(self) -> f64 {
        libm::ldexp(1.0, -self.bits())
    }

    /// The smallest normal number. Whatever is smaller may be flushed to zero.
    pub fn smallest_normal(self) -> f64 {
        match self {
            Dtype::F64 => f64::MIN_POSITIVE,
            Dtype::F32 | Dtype::Tf32 | Dtype::Bf16 => libm::ldexp(1.0, -126),
            Dtype::F16 => libm::ldexp(1.0, -14),
        }
    }

    /// The largest finite number.
    pub fn largest(self) -> f64 {
        let exponent = match self {
            Dtype::F64 => return f64::MAX,
            Dtype::F32 | Dtype::Tf32 | Dtype::Bf16 => 127,
            Dtype::F16 => 15,
        };
        libm::ldexp(2.0 - 2.0 * self.unit_roundoff(), exponent)
    }

    /// x rounded to the type, to nearest, ties to even; overflow gives infinity, numbers below the smallest normal are subnormal.
    ///
    /// ```
    /// use nerf_oracle::contract::Dtype;
    /// assert_eq!(Dtype::Bf16.round(1.0 + 1.0 / 256.0), 1.0);
    /// assert_eq!(Dtype::F16.round(1e6), f64::INFINITY);
    /// ```
    pub fn round(self, x: f64) -> f64 {
        if self == Dtype::F64 || x == 0.0 || !x.is_finite() {
            return x;
        }
        // The weight of the last bit at the size of x, or that of subnormal numbers; scaling by it is exact.
        let (_, exponent) = libm::frexp(x);
        let (_, smallest) = libm::frexp(self.smallest_normal());
        let last = exponent.max(smallest) - self.bits();
        let rounded = libm::ldexp(libm::rint(libm::ldexp(x, -last)), last);
        if rounded.abs() > self.largest() { f64::INFINITY.copysign(x) } else { rounded }
    }

    /// Whether x is one of the type's numbers.
    pub fn holds(self, x: f64) -> bool {
        x.is_nan() || self.round(x) == x
    }

    /// The distance of neighboring numbers at the size of x.
    pub fn ulp(self, x: f64) -> f64 {
        let (_, exponent) = libm::frexp(x.abs().max(self.smallest_normal()));
        libm::ldexp(1.0, exponent - self.bits())
    }
}

impl fmt::Display for Dtype {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.pad(match self {
            Dtype::F64 => "f64",
            Dtype::F32 => "f32",
            Dtype::Tf32 => "tf32",
            Dtype::Bf16 => "bf16",
            Dtype::F16 => "f16",
        })
    }
}

impl FromStr for Dtype {
    type Err = Error;
    fn from_str(s: &str) -> Result<Self> {
        let found = Dtype::ALL.into_iter().find(|dtype| dtype.to_string() == s);
        found.ok_or_else(|| Error::usage("dtype", s, "f64, f32, tf32, bf16 or f16"))
    }
}

/// Which formula the bound follows, where a stable and a textbook form differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Grade {
    /// The stable formula, e.g. -expm1(-x).
    A,
    /// The textbook formula, e.g. 1 - exp(-x).
    B,
}

/// What rounding costs an honest implementation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arithmetic {
    /// Unit roundoff of every result.
    pub u: f64,
    /// Unit roundoff inside sums: f32's for the short types.
    pub u_sum: f64,
    /// Absolute error of flushing to zero.
    pub tiny: f64,
    /// Largest finite number.
    pub largest: f64,
    /// Error of exp, log, sin, cos in ULP.
    pub elementary_ulp: f64,
    /// Which formula.
    pub grade: Grade,
}

impl Arithmetic {
    /// The contract's arithmetic for `dtype`: elementary functions within 4 ULP, sums of short types in f32.
    pub fn new(dtype: Dtype, grade: Grade) -> Self {
        let u = dtype.unit_roundoff();
        Arithmetic {
            u,
            u_sum: u.min(Dtype::F32.unit_roundoff()),
            tiny: dtype.smallest_normal(),
            largest: dtype.largest(),
            elementary_ulp: 4.0,
            grade,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounds_like_the_hardware() {
        let key = crate::random::Key::new(1, crate::random::Purpose::Cases);
        for n in 0..20_000 {
            let scale = libm::ldexp(1.0, (key.below(300, 0, n, 1) as i32) - 150);
            let x = (key.uniform(0, n, 0) - 0.5) * scale;
            assert_eq!(Dtype::F32.round(x), f64::from(x as f32), "{x:e}");
            assert_eq!(Dtype::F16.round(x), half::f16::from_f64(x).to_f64(), "{x:e}");
            // From f32: `half` looks only at the upper 32 bits of an f64, and so rounds 1 in 2^20 numbers as a tie that isn't one.
            let x = x as f32;
            assert_eq!(Dtype::Bf16.round(f64::from(x)), half::bf16::from_f32(x).to_f64(), "{x:e}");
        }
    }

    #[test]
    fn names_parse() {
        for dtype in Dtype::ALL {
            assert_eq!(dtype.to_string().parse::<Dtype>().unwrap(), dtype);
        }
        assert!("f8".parse::<Dtype>().is_err());
    }
}
