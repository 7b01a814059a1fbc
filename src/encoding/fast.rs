//! Positional encoding in f32, vectorized over points: x, then per band sin 2^k pi x and cos 2^k pi x.
//!
//! 2^k x mod 2 is exact in binary, so it is taken in f64 before anything is rounded; what is left, r in [-pi/4, pi/4], is
//! rounded once to f32, and sin r and cos r are short polynomials (Cephes `sinf`, `cosf`). Every band is therefore as good as
//! band 0 (2 ULP), where `sin(2^9 pi x)` in plain f32 loses ten bits.

use pulp::{Arch, Simd, WithSimd};

use crate::approximate::sin_cos_pi_wide;

/// Points that are encoded together: their sines stay in the first-level cache until they are stored row by row.
const BLOCK: usize = 64;

/// Encodes the points of `x` into rows of `out`, `stride` entries apart (what lies after the encoding stays as it is).
///
/// # Shapes
/// `x` (M, `dims`), `out` (M, `stride`) with `stride` at least `dims` (1 + 2 `levels`).
///
/// # Convention
/// That of the profile `cs180`: identity, then for each band the sines of all dimensions, then their cosines.
///
/// ```
/// use nerf_oracle::encoding::fast::positional_encoding;
/// let mut row = [0.0; 7];
/// positional_encoding(nerf_oracle::simd::arch(), &[0.5], 1, 3, &mut row, 7);
/// assert_eq!(row, [0.5, 1.0, 0.0, 0.0, -1.0, 0.0, 1.0]);
/// ```
pub fn positional_encoding(
    arch: Arch,
    x: &[f64],
    dims: usize,
    levels: usize,
    out: &mut [f32],
    stride: usize,
) {
    assert!(
        stride >= dims * (1 + 2 * levels) && out.len() >= x.len() / dims * stride,
        "rows hold the encoding"
    );
    for (x, out) in x.chunks(BLOCK * dims).zip(out.chunks_mut(BLOCK * stride)) {
        arch.dispatch(Block { x, dims, levels, out, stride });
    }
}

struct Block<'a> {
    x: &'a [f64],
    dims: usize,
    levels: usize,
    out: &'a mut [f32],
    stride: usize,
}

impl WithSimd for Block<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Block { x, dims, levels, out, stride } = self;
        let (mut column, mut sin, mut cos) = ([0.0; BLOCK], [0.0; BLOCK], [0.0; BLOCK]);
        for d in 0..dims {
            for (c, x) in column.iter_mut().zip(x.chunks_exact(dims)) {
                *c = x[d];
            }
            for (x, row) in x.chunks_exact(dims).zip(out.chunks_exact_mut(stride)) {
                row[d] = x[d] as f32;
            }
            for k in 0..levels {
                for ((c, sin), cos) in column.iter_mut().zip(&mut sin).zip(&mut cos) {
                    (*sin, *cos) = sin_cos_pi_wide(*c);
                    *c *= 2.0;
                }
                let at = dims * (1 + 2 * k) + d;
                for ((row, sin), cos) in out.chunks_exact_mut(stride).zip(sin).zip(cos) {
                    row[at] = sin;
                    row[at + dims] = cos;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::convention::CS180;
    use crate::encoding::{Encoding, positional_encoding as oracle};

    /// Within 2 ULP of the oracle in every band, or 2^-24 of 2^-24 next to a zero; the scalar path gives the same bits.
    #[test]
    fn agrees_with_the_oracle() {
        let x: Vec<f64> = (0..3 * 1000).map(|i| f64::from((i as f32 * 0.754_877_7).sin() * 7.3)).collect();
        let mut fast = vec![f32::NAN; 1000 * 64];
        positional_encoding(crate::simd::arch(), &x, 3, 10, &mut fast, 64);
        let mut scalar = vec![f32::NAN; 1000 * 64];
        positional_encoding(Arch::Scalar, &x, 3, 10, &mut scalar, 64);
        let encoding = Encoding::new(10, &CS180);
        let mut worst = 0.0f64;
        for ((x, fast), scalar) in x.chunks(3).zip(fast.chunks(64)).zip(scalar.chunks(64)) {
            for ((&f, &s), e) in fast.iter().zip(scalar).zip(oracle(x, &encoding)) {
                assert_eq!(f.to_bits(), s.to_bits());
                let ulp = f64::from((e as f32).abs().next_up() - (e as f32).abs());
                worst = worst.max((f64::from(f) - e).abs() / ulp.max((-48f64).exp2()));
            }
            assert!(fast[63].is_nan(), "nothing is written after the encoding");
        }
        assert!((0.5..2.0).contains(&worst), "{worst} ULP");
    }
}
