//! Exponential and sine of a stated grade in f32: shorter polynomials than full accuracy needs, free of branches, so that loops over
//! them become vector code. For the less accurate variants that `bench` compares; the oracle uses nothing from here.
//!
//! A grade is the largest relative error in units of f32's last place. Coefficients minimize the largest relative error (weighted
//! least squares, repeated until the error is level); the tests measure the stated errors.

/// A stated accuracy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Grade {
    /// Within 8,192 ULP: 11 correct bits.
    Low,
    /// Exponential within 256 ULP, sine within 32.
    Middle,
}

impl Grade {
    /// The largest error of [`attenuation`], in ULP.
    pub const fn exp_ulp(self) -> f64 {
        match self {
            Grade::Low => 8192.0,
            Grade::Middle => 256.0,
        }
    }

    /// The largest error of [`sin_cos_pi`], in ULP.
    pub const fn sin_ulp(self) -> f64 {
        match self {
            Grade::Low => 8192.0,
            Grade::Middle => 32.0,
        }
    }
}

/// (e^-x, 1 - e^-x) for x >= 0.
///
/// -x log2 e = n + f with |f| <= 1/2; p = 2^f - 1 by a polynomial without constant, so that thin samples keep their relative accuracy;
/// e^-x = 2^n + 2^n p.
#[inline(always)]
pub fn attenuation(x: f32, grade: Grade) -> (f32, f32) {
    // Below e^-87 f32 has no normal numbers: those are 0 here.
    let y = -std::f32::consts::LOG2_E * if x > 87.0 { 87.0 } else { x };
    let n = y.round_ties_even();
    let f = y - n;
    let p = match grade {
        Grade::Low => 0.055_503_916f32.mul_add(f, 0.242_028_86).mul_add(f, 0.693_178_3) * f,
        Grade::Middle => {
            0.009_618_105f32.mul_add(f, 0.055_837_29).mul_add(f, 0.240_232_53).mul_add(f, 0.693_136_9) * f
        }
    };
    let scale = f32::from_bits(((n as i32 + 127) as u32) << 23);
    let keep = if x > 87.0 { 0.0 } else { scale + scale * p };
    (keep, (1.0 - scale) - scale * p)
}

/// (sin pi y, cos pi y) for |y| < 2^22: y is reduced exactly to r in [-1/4, 1/4], in f32.
#[inline(always)]
pub fn sin_cos_pi(y: f32, grade: Grade) -> (f32, f32) {
    let y = y - 2.0 * (0.5 * y).round_ties_even();
    let quarter = (2.0 * y).round_ties_even();
    let r = y - 0.5 * quarter;
    let z = r * r;
    let (s, c) = match grade {
        Grade::Low => (
            (-5.008_688_4f32).mul_add(z, 3.140_313_6) * r,
            3.941_021_2f32.mul_add(z, -4.932_439).mul_add(z, 1.0),
        ),
        Grade::Middle => (
            2.494_091_5f32.mul_add(z, -5.166_385_7).mul_add(z, 3.141_588) * r,
            (-1.306_706_2f32).mul_add(z, 4.057_651_5).mul_add(z, -4.934_790_6).mul_add(z, 1.0),
        ),
    };
    // Quarter turns: odd ones swap the two, the next bit is the sign.
    let q = quarter as i32;
    let (sin, cos) = if q & 1 == 0 { (s, c) } else { (c, s) };
    let sign = |x: f32, negative: i32| f32::from_bits(x.to_bits() ^ ((negative as u32 & 2) << 30));
    (sign(sin, q), sign(cos, q + 1))
}

/// x rounded to bf16, to nearest, ties to even, as bits.
#[inline(always)]
pub fn to_bf16(x: f32) -> u16 {
    let bits = x.to_bits();
    ((bits + 0x7fff + (bits >> 16 & 1)) >> 16) as u16
}

/// The number that has these bf16 bits.
#[inline(always)]
pub fn from_bf16(bits: u16) -> f32 {
    f32::from_bits(u32::from(bits) << 16)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math;

    fn ulps(got: f32, exact: f64) -> f64 {
        let size = exact.abs().max(f64::from(f32::MIN_POSITIVE));
        (f64::from(got) - exact).abs() / crate::contract::Dtype::F32.ulp(size)
    }

    /// The stated errors hold, and are sharp: more than half of each is used.
    #[test]
    fn attenuation_is_of_its_grade() {
        for grade in [Grade::Low, Grade::Middle] {
            let mut worst = 0.0f64;
            for i in 0..200_000 {
                let x = math::exp(f64::from(i) * 1e-4 - 15.6) as f32;
                let (keep, alpha) = attenuation(x, grade);
                worst = worst.max(ulps(alpha, -math::expm1(-f64::from(x))));
                if x < 87.0 {
                    worst = worst.max(ulps(keep, math::exp(-f64::from(x))));
                }
            }
            let stated = grade.exp_ulp();
            assert!(worst <= stated && worst > 0.5 * stated, "{grade:?}: {worst} ULP");
            assert_eq!(attenuation(0.0, grade), (1.0, 0.0));
            assert_eq!(attenuation(1e10, grade), (0.0, 1.0));
        }
    }

    #[test]
    fn sine_is_of_its_grade() {
        for grade in [Grade::Low, Grade::Middle] {
            let mut worst = 0.0f64;
            for i in -100_000..100_000 {
                let y = i as f32 * 0.012_345_6;
                let (sin, cos) = sin_cos_pi(y, grade);
                worst = worst.max(ulps(sin, math::sin_pi(y.into()))).max(ulps(cos, math::cos_pi(y.into())));
            }
            let stated = grade.sin_ulp();
            assert!(worst <= stated && worst > 0.5 * stated, "{grade:?}: {worst} ULP");
            assert_eq!((sin_cos_pi(3.0, grade).0, sin_cos_pi(0.5, grade).1), (0.0, 0.0));
        }
    }

    #[test]
    fn bf16_rounds_as_half_does() {
        let key = crate::random::Key::new(3, crate::random::Purpose::Cases);
        for n in 0..10_000 {
            let x = (key.uniform(0, n, 0) - 0.5) as f32 * (key.below(60, 0, n, 1) as f32 - 30.0).exp2();
            assert_eq!(to_bf16(x), half::bf16::from_f32(x).to_bits());
            assert_eq!(from_bf16(to_bf16(x)), half::bf16::from_f32(x).to_f32());
        }
    }
}
