//! The oracle of this folder on named arrays, and what turns these into its types and back.

use super::{Trace, trace_pixel};
use crate::camera::Camera;
use crate::contract::arrays::{Arrays, array, arrays, input, number, rgb, values};
use crate::convention::Conventions;
use crate::ray::arrays::picture;

/// Height, width and number of samples.
pub(crate) fn size(a: &Arrays) -> [usize; 3] {
    let shape = input(a, "u").shape();
    [shape[0], shape[1], shape[2]]
}

pub(super) fn render_trace(a: &Arrays, c: &Conventions) -> Arrays {
    let [h, w, n] = size(a);
    let (height, width, k, c2w) = picture(a);
    let camera = Camera { width, height, k, c2w, distortion: None };
    let bounds = (number(a, "near"), number(a, "far"));
    let (u, sigmas, rgbs) = (values(a, "u"), values(a, "sigmas"), values(a, "rgbs"));
    let background = rgb(&values(a, "background"));
    let pixel = |p: usize| {
        let rgbs: Vec<[f64; 3]> = rgbs[3 * p * n..3 * (p + 1) * n].chunks_exact(3).map(rgb).collect();
        let (u, sigmas) = (&u[p * n..(p + 1) * n], &sigmas[p * n..(p + 1) * n]);
        trace_pixel(&camera, (p % w, p / w), bounds, u, sigmas, &rgbs, background, c)
    };
    let traces: Vec<Trace> = (0..h * w).map(pixel).collect();
    let each = |f: fn(&Trace) -> Vec<f64>| traces.iter().flat_map(f).collect::<Vec<_>>();
    arrays([
        ("uv", array(&[h, w, 2], each(|t| t.uv.to_vec()))),
        ("rays_o", array(&[h, w, 3], each(|t| t.ray.o.to_array().to_vec()))),
        ("rays_d", array(&[h, w, 3], each(|t| t.ray.d.to_array().to_vec()))),
        ("t", array(&[h, w, n], each(|t| t.t.clone()))),
        ("deltas", array(&[h, w, n], each(|t| t.deltas.clone()))),
        ("weights", array(&[h, w, n], each(|t| t.rendering.weights.clone()))),
        ("colors", array(&[h, w, 3], each(|t| t.color.to_vec()))),
    ])
}
