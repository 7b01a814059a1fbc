//! What happens to a chunk between two matrix products: one pass over it while it is in the cache, vectorised at run time.
//!
//! Rows are points, `width` entries of a row are used. A gradient `g` is masked where the activation behind the ReLU is 0,
//! which is where its input was not positive.

use pulp::Arch;

/// x = relu(x + bias). A NaN stays one.
pub(super) fn bias_relu(arch: Arch, x: &mut [f32], stride: usize, bias: &[f32]) {
    arch.dispatch(
        #[inline(always)]
        || {
            for row in x.chunks_mut(stride) {
                for (x, b) in row.iter_mut().zip(bias) {
                    let z = *x + b;
                    *x = if z < 0.0 { 0.0 } else { z };
                }
            }
        },
    );
}

/// g = g where h > 0, else 0; adds the sum over points to `g_bias`.
pub(super) fn relu_backward(arch: Arch, g: &mut [f32], h: &[f32], stride: usize, g_bias: &mut [f32]) {
    arch.dispatch(
        #[inline(always)]
        || {
            for (g, h) in g.chunks_exact_mut(g_bias.len()).zip(h.chunks(stride)) {
                for ((g, h), sum) in g.iter_mut().zip(h).zip(g_bias.iter_mut()) {
                    *g = if *h > 0.0 { *g } else { 0.0 };
                    *sum += *g;
                }
            }
        },
    );
}

/// The gradient of one linear output z = w h, joined with `g` and masked: g = (g + g_z w) where h > 0. Adds g_z h to `g_w`
/// and the sum over points to `g_bias`.
#[allow(clippy::too_many_arguments, reason = "one pass over memory is the point")]
pub(super) fn join_backward(
    arch: Arch,
    g: &mut [f32],
    h: &[f32],
    stride: usize,
    g_z: &[f32],
    w: &[f32],
    g_w: &mut [f32],
    g_bias: &mut [f32],
) {
    arch.dispatch(
        #[inline(always)]
        || {
            for ((g, h), &g_z) in g.chunks_exact_mut(w.len()).zip(h.chunks(stride)).zip(g_z) {
                let columns = g.iter_mut().zip(h).zip(w).zip(g_w.iter_mut().zip(g_bias.iter_mut()));
                for (((g, &h), w), (g_w, sum)) in columns {
                    *g = if h > 0.0 { *g + g_z * w } else { 0.0 };
                    *g_w += g_z * h;
                    *sum += *g;
                }
            }
        },
    );
}

/// K linear outputs of every row: z = w x + bias. Sixteen running sums, added up in a fixed order.
pub(super) fn heads<const K: usize>(arch: Arch, x: &[f32], stride: usize, w: &[f32], bias: &[f32], z: &mut [f32]) {
    let width = w.len() / K;
    arch.dispatch(
        #[inline(always)]
        || {
            for (x, z) in x.chunks(stride).zip(z.chunks_exact_mut(K)) {
                for ((z, w), b) in z.iter_mut().zip(w.chunks_exact(width)).zip(bias) {
                    *z = b + dot(&x[..width], w);
                }
            }
        },
    );
}

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

/// Backward of [`heads`] behind a ReLU: g_x = w^T g_z where x > 0; adds g_z x to `g_w` and g_z to `g_bias`.
#[allow(clippy::too_many_arguments, reason = "one pass over memory is the point")]
pub(super) fn heads_backward<const K: usize>(
    arch: Arch,
    x: &[f32],
    stride: usize,
    g_z: &[f32],
    w: &[f32],
    g_w: &mut [f32],
    g_bias: &mut [f32],
    g_x: &mut [f32],
) {
    let width = w.len() / K;
    arch.dispatch(
        #[inline(always)]
        || {
            for ((x, g_z), g_x) in x.chunks(stride).zip(g_z.chunks_exact(K)).zip(g_x.chunks_exact_mut(width)) {
                g_x.fill(0.0);
                for k in 0..K {
                    let g = g_z[k];
                    g_bias[k] += g;
                    let columns = k * width..(k + 1) * width;
                    for (((g_x, x), w), g_w) in g_x.iter_mut().zip(x).zip(&w[columns.clone()]).zip(&mut g_w[columns]) {
                        *g_x += g * w;
                        *g_w += g * x;
                    }
                }
                for (g_x, x) in g_x.iter_mut().zip(x) {
                    *g_x = if *x > 0.0 { *g_x } else { 0.0 };
                }
            }
        },
    );
}

/// sum += row, entry by entry.
pub(super) fn add(arch: Arch, sum: &mut [f32], row: &[f32]) {
    arch.dispatch(
        #[inline(always)]
        || {
            for (sum, x) in sum.iter_mut().zip(row) {
                *sum += x;
            }
        },
    );
}
