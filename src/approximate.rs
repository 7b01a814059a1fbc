//! Exponential and sine of a stated grade in f32, free of branches, so that loops over them become vector code: the only ones in f32.
//! The lower grades' shorter polynomials are for the bolder variants that `bench` compares; the oracle has nothing from here.
//!
//! A grade is the largest relative error in units of f32's last place. The lower grades' coefficients minimize the largest relative
//! error (weighted least squares, repeated until the error is level); the tests measure what is stated.

/// A stated accuracy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Grade {
    /// Within 8,192 ULP: 11 correct bits.
    Low,
    /// Exponential within 256 ULP, sine within 32.
    Middle,
    /// Within 2 ULP: what training and rendering use.
    Full,
}

impl Grade {
    /// The largest error of [`attenuation`], in ULP.
    pub const fn exp_ulp(self) -> f64 {
        match self {
            Grade::Low => 8192.0,
            Grade::Middle => 256.0,
            Grade::Full => 2.0,
        }
    }

    /// The largest error of [`sin_cos_pi`], and of [`sin_cos_pi_wide`], in ULP.
    pub const fn sin_ulp(self) -> f64 {
        match self {
            Grade::Low => 8192.0,
            Grade::Middle => 32.0,
            Grade::Full => 2.0,
        }
    }
}

/// (e^-x, 1 - e^-x) for x >= 0.
///
/// Where the grade is full: -x = n ln 2 + r, see `power_and_rest`; else -x log2 e = n + f with |f| <= 1/2 and p = 2^f - 1. Either way
/// p is a polynomial without constant, so that thin samples keep their relative accuracy; e^-x = 2^n + 2^n p.
#[inline(always)]
pub fn attenuation(x: f32, grade: Grade) -> (f32, f32) {
    if grade == Grade::Full {
        // e^-104 is below the smallest subnormal. Written so that a NaN stays NaN.
        let (n, p) = power_and_rest(if x > 104.0 { -104.0 } else { -x });
        let [a, b] = two_powers(n);
        let scale = a * b;
        return ((1.0 + p) * a * b, (1.0 - scale) - p * scale);
    }
    // Beyond e^-87 f32 has no normal numbers: those are 0 here.
    let y = -std::f32::consts::LOG2_E * if x > 87.0 { 87.0 } else { x };
    let n = y.round_ties_even();
    let f = y - n;
    let p = if grade == Grade::Low {
        0.055_503_916f32.mul_add(f, 0.242_028_86).mul_add(f, 0.693_178_3) * f
    } else {
        0.009_618_105f32.mul_add(f, 0.055_837_29).mul_add(f, 0.240_232_53).mul_add(f, 0.693_136_9) * f
    };
    let scale = power_of_two(n);
    let keep = if x > 87.0 { 0.0 } else { scale + scale * p };
    (keep, (1.0 - scale) - scale * p)
}

/// e^x within 2 ULP (above the smallest normal number), infinite and 0 where it leaves f32.
#[inline(always)]
pub fn exp(x: f32) -> f32 {
    // Written so that a NaN stays NaN.
    let x = if x > 104.0 { 104.0 } else { x };
    let (n, p) = power_and_rest(if x < -104.0 { -104.0 } else { x });
    let [a, b] = two_powers(n);
    (1.0 + p) * a * b
}

/// n and p = e^r - 1, by its series, where x = n ln 2 + r with |r| <= ln 2 / 2: e^x = 2^n (1 + p).
#[inline(always)]
fn power_and_rest(x: f32) -> (f32, f32) {
    let n = (x * std::f32::consts::LOG2_E).round_ties_even();
    // ln 2 in two parts: n times the first is exact.
    let r = n.mul_add(-0.693_359_4, x);
    let r = n.mul_add(2.121_944_4e-4, r);
    let p = (1.0f32 / 5040.0).mul_add(r, 1.0 / 720.0).mul_add(r, 1.0 / 120.0).mul_add(r, 1.0 / 24.0);
    (n, p.mul_add(r, 1.0 / 6.0).mul_add(r, 0.5).mul_add(r * r, r))
}

/// 2^n in two factors: n reaches 150 on either side, beyond the exponents of normal numbers.
#[inline(always)]
fn two_powers(n: f32) -> [f32; 2] {
    let half = (0.5 * n).floor();
    [power_of_two(half), power_of_two(n - half)]
}

/// 2^n for whole n from -126 to 127.
#[inline(always)]
fn power_of_two(n: f32) -> f32 {
    f32::from_bits(((n as i32 + 127) as u32) << 23)
}

/// (sin pi y, cos pi y) for |y| < 2^22: y is reduced exactly to r in [-1/4, 1/4], in f32. Of a lower grade.
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
        Grade::Full => sin_cos((std::f64::consts::PI * f64::from(r)) as f32),
    };
    turned(s, c, quarter as i32)
}

/// The same of the full grade and for any y: it is reduced in f64, before anything is rounded.
#[inline(always)]
pub fn sin_cos_pi_wide(y: f64) -> (f32, f32) {
    let y = y - 2.0 * (0.5 * y).round_ties_even();
    let quarter = (2.0 * y).round_ties_even();
    let (s, c) = sin_cos((std::f64::consts::PI * (y - 0.5 * quarter)) as f32);
    turned(s, c, quarter as i32)
}

/// (sin r, cos r) for r in [-pi/4, pi/4] (Cephes `sinf`, `cosf`).
#[inline(always)]
fn sin_cos(r: f32) -> (f32, f32) {
    let z = r * r;
    let s = (-1.951_529_6e-4f32).mul_add(z, 8.332_161e-3).mul_add(z, -0.166_666_55).mul_add(z * r, r);
    let c = 2.443_315_7e-5f32
        .mul_add(z, -1.388_731_6e-3)
        .mul_add(z, 4.166_664_6e-2)
        .mul_add(z * z, 1.0 - 0.5 * z);
    (s, c)
}

/// Sine and cosine `q` quarter turns on: odd ones swap the two, the next bit is the sign.
#[inline(always)]
fn turned(s: f32, c: f32, q: i32) -> (f32, f32) {
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
    fn attenuation_is_within_two_ulp() {
        let mut worst = 0.0f64;
        for i in 0..200_000 {
            let x = (f64::from(i) * 2e-4 - 20.0).exp() as f32;
            let (keep, alpha) = attenuation(x, Grade::Full);
            for (got, exact) in [(keep, (-f64::from(x)).exp()), (alpha, -(-f64::from(x)).exp_m1())] {
                let ulp = f64::from((exact as f32).next_up() - exact as f32).max((-149f64).exp2());
                worst = worst.max((f64::from(got) - exact).abs() / ulp);
            }
        }
        assert!((0.5..2.0).contains(&worst), "{worst} ULP");
        assert_eq!(attenuation(0.0, Grade::Full), (1.0, 0.0));
        assert_eq!(attenuation(1e10, Grade::Full), (0.0, 1.0));
        assert!(attenuation(f32::NAN, Grade::Full).0.is_nan());
    }

    #[test]
    fn exp_is_within_two_ulp() {
        let mut worst = 0.0f64;
        for i in -87_000..=88_000 {
            let x = i as f32 * 1e-3;
            worst = worst.max(ulps(exp(x), math::exp(x.into())));
        }
        assert!((0.5..2.0).contains(&worst), "{worst} ULP");
        assert_eq!(
            [exp(0.0), exp(89.0), exp(1e10), exp(-106.0), exp(-1e10)],
            [1.0, f32::INFINITY, f32::INFINITY, 0.0, 0.0]
        );
        assert!(exp(f32::NAN).is_nan());
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

    /// Within 2 ULP, or 2^-24 of 2^-24 next to a zero, however many turns; the f32 reduction too.
    #[test]
    fn the_full_sine_is_within_two_ulp() {
        let mut worst = 0.0f64;
        for i in -100_000..100_000 {
            let y = f64::from(i) * 0.123_456_7;
            let exact = [math::sin_pi(y), math::cos_pi(y)];
            for (got, exact) in <[f32; 2]>::from(sin_cos_pi_wide(y)).into_iter().zip(exact) {
                let ulp = crate::contract::Dtype::F32.ulp(exact.abs()).max((-48f64).exp2());
                worst = worst.max((f64::from(got) - exact).abs() / ulp);
            }
            let short = f64::from(y as f32);
            assert_eq!(sin_cos_pi(short as f32, Grade::Full), sin_cos_pi_wide(short), "{short}");
        }
        assert!((0.5..2.0).contains(&worst), "{worst} ULP");
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
