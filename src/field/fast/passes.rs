//! The element-wise passes over a chunk between two matrix products, while it is in the cache; vectorized at run time.
//!
//! Rows are points. A gradient `g` is masked where the activation after the ReLU is 0, which is where its input was not
//! positive. Each pass is a struct, because only `with_simd` is compiled for the instructions it is called with; the
//! loops are plain and left to the compiler.

use pulp::{Simd, WithSimd};

/// x = relu(x + bias). A NaN stays one.
pub(crate) struct BiasRelu<'a> {
    pub x: &'a mut [f32],
    pub stride: usize,
    pub bias: &'a [f32],
}

impl WithSimd for BiasRelu<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        for row in self.x.chunks_mut(self.stride) {
            for (x, b) in row.iter_mut().zip(self.bias) {
                let z = *x + b;
                *x = if z < 0.0 { 0.0 } else { z };
            }
        }
    }
}

/// g = g where h > 0, else 0; adds the sum over points to `g_bias`.
pub(crate) struct ReluBackward<'a> {
    pub g: &'a mut [f32],
    pub h: &'a [f32],
    pub stride: usize,
    pub g_bias: &'a mut [f32],
}

impl WithSimd for ReluBackward<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        for (g, h) in self.g.chunks_exact_mut(self.g_bias.len()).zip(self.h.chunks(self.stride)) {
            for ((g, h), sum) in g.iter_mut().zip(h).zip(self.g_bias.iter_mut()) {
                *g = if *h > 0.0 { *g } else { 0.0 };
                *sum += *g;
            }
        }
    }
}

/// The gradient of one linear output z = w h, joined with `g` and masked: g = (g + g_z w) where h > 0. Adds g_z h to `g_w`
/// and the sum over points to `g_bias`.
pub(crate) struct JoinBackward<'a> {
    pub g: &'a mut [f32],
    pub h: &'a [f32],
    pub g_z: &'a [f32],
    pub w: &'a [f32],
    pub g_w: &'a mut [f32],
    pub g_bias: &'a mut [f32],
}

impl WithSimd for JoinBackward<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let JoinBackward { g, h, g_z, w, g_w, g_bias } = self;
        for ((g, h), &g_z) in g.chunks_exact_mut(w.len()).zip(h.chunks_exact(w.len())).zip(g_z) {
            let columns = g.iter_mut().zip(h).zip(w).zip(g_w.iter_mut().zip(g_bias.iter_mut()));
            for (((g, &h), w), (g_w, sum)) in columns {
                *g = if h > 0.0 { *g + g_z * w } else { 0.0 };
                *g_w += g_z * h;
                *sum += *g;
            }
        }
    }
}

/// K linear outputs of every row: z = w x + bias.
pub(crate) struct Heads<'a, const K: usize> {
    pub x: &'a [f32],
    pub w: &'a [f32],
    pub bias: &'a [f32],
    pub z: &'a mut [f32],
}

impl<const K: usize> WithSimd for Heads<'_, K> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let width = self.w.len() / K;
        for (x, z) in self.x.chunks_exact(width).zip(self.z.chunks_exact_mut(K)) {
            for ((z, w), b) in z.iter_mut().zip(self.w.chunks_exact(width)).zip(self.bias) {
                *z = b + dot(x, w);
            }
        }
    }
}

/// Sixteen running sums, added up in a fixed order.
#[inline(always)]
fn dot(a: &[f32], b: &[f32]) -> f32 {
    let mut sums = [0.0f32; 16];
    let (blocks_a, blocks_b) = (a.chunks_exact(16), b.chunks_exact(16));
    let mut rest = 0.0;
    for (a, b) in blocks_a.remainder().iter().zip(blocks_b.remainder()) {
        rest += a * b;
    }
    for (a, b) in blocks_a.zip(blocks_b) {
        for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
            *sum += a * b;
        }
    }
    for half in [8, 4, 2, 1] {
        for i in 0..half {
            sums[i] += sums[i + half];
        }
    }
    sums[0] + rest
}

/// Backward of [`Heads`] after a ReLU: g_x = w^T g_z where x > 0; adds g_z x to `g_w` and g_z to `g_bias`.
pub(crate) struct HeadsBackward<'a, const K: usize> {
    pub x: &'a [f32],
    pub g_z: &'a [f32],
    pub w: &'a [f32],
    pub g_w: &'a mut [f32],
    pub g_bias: &'a mut [f32],
    pub g_x: &'a mut [f32],
}

impl<const K: usize> WithSimd for HeadsBackward<'_, K> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let HeadsBackward { x, g_z, w, g_w, g_bias, g_x } = self;
        let width = w.len() / K;
        for ((x, g_z), g_x) in x.chunks_exact(width).zip(g_z.chunks_exact(K)).zip(g_x.chunks_exact_mut(width))
        {
            g_x.fill(0.0);
            for k in 0..K {
                let g = g_z[k];
                g_bias[k] += g;
                let columns = k * width..(k + 1) * width;
                for (((g_x, x), w), g_w) in
                    g_x.iter_mut().zip(x).zip(&w[columns.clone()]).zip(&mut g_w[columns])
                {
                    *g_x += g * w;
                    *g_w += g * x;
                }
            }
            for (g_x, x) in g_x.iter_mut().zip(x) {
                *g_x = if *x > 0.0 { *g_x } else { 0.0 };
            }
        }
    }
}

/// sum += each row of `rows`.
pub(crate) struct AddRows<'a> {
    pub sum: &'a mut [f32],
    pub rows: &'a [f32],
}

impl WithSimd for AddRows<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        for row in self.rows.chunks_exact(self.sum.len()) {
            for (sum, x) in self.sum.iter_mut().zip(row) {
                *sum += x;
            }
        }
    }
}
