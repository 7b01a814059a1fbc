//! The three matrix products of a narrow layer, with the weights in L1 cache: register tiles of R rows by V vectors.
//!
//! Rows are points, features are contiguous, so that no product needs a transposed operand or a horizontal sum.
use pulp::Simd;

use crate::simd::fma;

/// Who multiplies in a pass: [`Plain`] does, in training; another one can time or check the products of the very same pass.
pub(crate) trait Multiply: Sync {
    /// [`product`].
    fn product<S: Simd, const K: usize, const N: usize>(
        &self,
        s: S,
        x: &[[f32; K]],
        inner: usize,
        w: &[[f32; N]],
        y: &mut [[f32; N]],
        accumulate: bool,
        relu: bool,
    );

    /// [`outer`].
    fn outer<S: Simd, const K: usize, const N: usize>(
        &self,
        s: S,
        x: &[[f32; K]],
        inner: usize,
        dy: &[[f32; N]],
        dw: &mut [[f32; N]],
    );
}

/// The product, and nothing else.
pub(crate) struct Plain;

impl Multiply for Plain {
    #[inline(always)]
    fn product<S: Simd, const K: usize, const N: usize>(
        &self,
        s: S,
        x: &[[f32; K]],
        inner: usize,
        w: &[[f32; N]],
        y: &mut [[f32; N]],
        accumulate: bool,
        relu: bool,
    ) {
        product(s, x, inner, w, y, accumulate, relu);
    }

    #[inline(always)]
    fn outer<S: Simd, const K: usize, const N: usize>(
        &self,
        s: S,
        x: &[[f32; K]],
        inner: usize,
        dy: &[[f32; N]],
        dw: &mut [[f32; N]],
    ) {
        outer(s, x, inner, dy, dw);
    }
}

#[inline(always)]
fn tile<S: Simd, const K: usize, const N: usize, const R: usize, const V: usize>(
    s: S,
    x: &[[f32; K]; R],
    inner: usize,
    w: &[[f32; N]; K],
    y: &mut [[f32; N]; R],
    accumulate: bool,
    relu: bool,
) {
    for c in 0..N / (V * S::F32_LANES) {
        let mut sum = [[s.splat_f32s(0.0); V]; R];
        if accumulate {
            for r in 0..R {
                let row = S::as_simd_f32s(&y[r]).0;
                for v in 0..V {
                    sum[r][v] = row[c * V + v];
                }
            }
        }
        for k in 0..inner.min(K) {
            let row = S::as_simd_f32s(&w[k]).0;
            let wv: [S::f32s; V] = std::array::from_fn(|v| row[c * V + v]);
            for r in 0..R {
                let xr = s.splat_f32s(x[r][k]);
                for v in 0..V {
                    sum[r][v] = fma(s, xr, wv[v], sum[r][v]);
                }
            }
        }
        let zero = s.splat_f32s(0.0);
        for r in 0..R {
            let row = S::as_mut_simd_f32s(&mut y[r]).0;
            for v in 0..V {
                row[c * V + v] = if relu { s.max_f32s(sum[r][v], zero) } else { sum[r][v] };
            }
        }
    }
}

#[inline(always)]
fn rows<S: Simd, const K: usize, const N: usize, const R: usize, const V: usize>(
    s: S,
    x: &[[f32; K]],
    inner: usize,
    w: &[[f32; N]; K],
    y: &mut [[f32; N]],
    accumulate: bool,
    relu: bool,
) {
    for (x, y) in x.as_chunks::<R>().0.iter().zip(y.as_chunks_mut::<R>().0) {
        tile::<S, K, N, R, V>(s, x, inner, w, y, accumulate, relu);
    }
}

/// `y[p] = x[p][..inner] W[..inner]`, plus `y[p]` itself where `accumulate`, then ReLU where `relu`. Rows in multiples of 16.
#[inline(always)]
pub(crate) fn product<S: Simd, const K: usize, const N: usize>(
    s: S,
    x: &[[f32; K]],
    inner: usize,
    w: &[[f32; N]],
    y: &mut [[f32; N]],
    accumulate: bool,
    relu: bool,
) {
    let w: &[[f32; N]; K] = w.try_into().unwrap();
    match (S::F32_LANES, N) {
        (16, 16) => rows::<S, K, N, 16, 1>(s, x, inner, w, y, accumulate, relu),
        (16, 32) => rows::<S, K, N, 8, 2>(s, x, inner, w, y, accumulate, relu),
        (16, 64) => rows::<S, K, N, 4, 4>(s, x, inner, w, y, accumulate, relu),
        _ => rows::<S, K, N, 4, 2>(s, x, inner, w, y, accumulate, relu),
    }
}

#[inline(always)]
fn outer_tiles<S: Simd, const K: usize, const N: usize, const R: usize, const V: usize>(
    s: S,
    x: &[[f32; K]],
    inner: usize,
    dy: &[[f32; N]],
    dw: &mut [[f32; N]; K],
) {
    for k in (0..inner).step_by(R) {
        for c in 0..N / (V * S::F32_LANES) {
            let mut sum = [[s.splat_f32s(0.0); V]; R];
            for (x, dy) in x.iter().zip(dy) {
                let row = S::as_simd_f32s(dy).0;
                let d: [S::f32s; V] = std::array::from_fn(|v| row[c * V + v]);
                let x: &[f32; R] = x[k..k + R].try_into().unwrap();
                for r in 0..R {
                    let xr = s.splat_f32s(x[r]);
                    for v in 0..V {
                        sum[r][v] = fma(s, xr, d[v], sum[r][v]);
                    }
                }
            }
            for r in 0..R {
                let row = S::as_mut_simd_f32s(&mut dw[k + r]).0;
                for v in 0..V {
                    row[c * V + v] = s.add_f32s(row[c * V + v], sum[r][v]);
                }
            }
        }
    }
}

/// `dW[k] += sum over points of x[p][k] dy[p]` for k < `inner`, and for a few more that fill a register tile.
#[inline(always)]
pub(crate) fn outer<S: Simd, const K: usize, const N: usize>(
    s: S,
    x: &[[f32; K]],
    inner: usize,
    dy: &[[f32; N]],
    dw: &mut [[f32; N]],
) {
    let dw: &mut [[f32; N]; K] = dw.try_into().unwrap();
    match (S::F32_LANES, N) {
        (16, 16) => outer_tiles::<S, K, N, 16, 1>(s, x, inner, dy, dw),
        (16, 32) => outer_tiles::<S, K, N, 8, 2>(s, x, inner, dy, dw),
        (16, 64) => outer_tiles::<S, K, N, 4, 4>(s, x, inner, dy, dw),
        _ => outer_tiles::<S, K, N, 4, 2>(s, x, inner, dy, dw),
    }
}
