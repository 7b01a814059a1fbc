//! Backward: from the gradients of raw colors and densities to those of all weights and of the encodings.

use pulp::Simd;

use super::chunk::{Chunk, Pass, TILE};
use super::kernels::Multiply;
use super::networks::{GEOMETRY, HIDDEN};
use crate::hash_grid::fast::WIDTH;
use crate::simd::CacheAligned;

/// ReLU's gradient: 0 where the activation is 0.
#[inline(always)]
fn mask<const N: usize>(gradient: &mut [[f32; N]], activation: &[[f32; N]]) {
    for (g, h) in gradient.as_flattened_mut().iter_mut().zip(activation.as_flattened()) {
        *g = if *h > 0.0 { *g } else { 0.0 };
    }
}

/// The colors' three rows into the three columns that are used.
#[inline(always)]
fn turn_colors(rows: &[[f32; HIDDEN]; 16], columns: &mut [[f32; 16]]) {
    for (k, row) in columns.iter_mut().enumerate() {
        (0..3).for_each(|color| row[color] = rows[color][k]);
    }
}

/// Fills `gradient`, and `encoding` with its own gradient. A tile at a time, so that its activations are read once.
#[inline(always)]
pub(super) fn backward<S: Simd>(s: S, pass: &Pass, c: &mut Chunk, on: &impl Multiply) {
    let (nets, rows, n) = (pass.nets, c.rows(), c.points.len());
    c.gradient.clear();
    c.rgb[n..rows].fill([0.0; 16]);
    c.rays.iter_mut().for_each(|ray| ray.view = [0.0; HIDDEN]);
    let (mut hidden, mut geometry) =
        (CacheAligned([[0f32; HIDDEN]; TILE]), CacheAligned([[0f32; GEOMETRY]; TILE]));
    let mut encoding = CacheAligned([[0f32; WIDTH]; TILE]);
    // Three rows where the weights have three of sixteen columns.
    let mut color1_t = CacheAligned([[0f32; HIDDEN]; 16]);
    for first in (0..rows).step_by(TILE) {
        let tile = first..(first + TILE).min(rows);
        let (hidden, geometry) = (&mut hidden.0[..tile.len()], &mut geometry.0[..tile.len()]);
        let encoding = &mut encoding.0[..tile.len()];
        let rgb = &mut c.rgb[tile.clone()];
        on.product(s, rgb, 3, &nets.color1_t, hidden, false, false);
        mask(hidden, &c.hidden1[tile.clone()]);
        on.product(s, hidden, HIDDEN, &nets.color0_t, geometry, false, false);
        for (g, d) in geometry.iter_mut().zip(&mut *rgb) {
            g[0] += std::mem::take(&mut d[3]);
        }
        on.outer(s, rgb, 3, &c.hidden1[tile.clone()], &mut color1_t.0);
        on.outer(s, &c.geometry[tile.clone()], GEOMETRY, hidden, &mut c.gradient.color0);
        for (p, g) in (first..tile.end.min(n)).zip(&*hidden) {
            let view = &mut c.rays[c.ray_of[p] as usize].view;
            view.iter_mut().zip(g).for_each(|(v, g)| *v += g);
        }
        on.product(s, geometry, GEOMETRY, &nets.density1_t, hidden, false, false);
        mask(hidden, &c.hidden0[tile.clone()]);
        on.outer(s, &c.hidden0[tile.clone()], HIDDEN, geometry, &mut c.gradient.density1);
        c.gather(first, encoding);
        on.outer(s, encoding, WIDTH, hidden, &mut c.gradient.density0);
        on.product(s, hidden, HIDDEN, &nets.density0_t, encoding, false, false);
        c.spread(first, encoding);
    }
    turn_colors(&color1_t.0, &mut c.gradient.color1);
    for ray in c.rays.iter().filter(|ray| ray.count > 0 && pass.view_dependent) {
        for (&h, row) in ray.harmonics.iter().zip(c.gradient.view.iter_mut()) {
            row.iter_mut().zip(&ray.view).for_each(|(r, v)| *r += h * v);
        }
    }
}
