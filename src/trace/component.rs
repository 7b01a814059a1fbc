//! The registry row of the trace.

use super::{Trace, bound, cases, honest, mistakes, trace_pixel};
use crate::camera::Camera;
use crate::contract::component::{Arrays, Component, Pass, Port, array, arrays, input, number, values};
use crate::convention::Conventions;
use crate::ray::component::picture;
use crate::volume_rendering::component::rgb;

const fn plain(name: &'static str, shape: &'static str, meaning: &'static str) -> Port {
    Port { name, shape, meaning, gradient: false }
}

/// The conventions that each output depends on, where these aren't all: a search for conventions rules them out output by output.
pub const READS: &[(&str, &[&str])] = &[
    ("uv", &["pixel_center"]),
    ("rays_o", &[]),
    ("rays_d", &["axes", "pixel_center", "directions"]),
    ("t", &["grid"]),
    ("deltas", &["axes", "pixel_center", "directions", "grid", "delta", "last_delta"]),
];

/// The whole way from the pixel to its color.
pub const RENDER_TRACE: Component = Component {
    name: "render_trace",
    folder: "trace",
    formula: "image_rays, sample_along_rays, step_sizes, volume_render and composite_background one after the other",
    source: "NeRF (Mildenhall et al. 2020) sections 4 and 5.2",
    inputs: &[
        plain("height", "", "H"),
        plain("width", "", "W"),
        plain("focal", "", "in pixels"),
        plain("cx", "", "principal point, in pixels"),
        plain("cy", "", "principal point, in pixels"),
        plain("c2w", "4,4", "pose"),
        plain("near", "", "where rays begin"),
        plain("far", "", "where rays end"),
        plain("u", "H,W,N", "numbers in [0, 1), one for every sample"),
        plain("sigmas", "H,W,N", "densities of the samples"),
        plain("rgbs", "H,W,N,3", "colors of the samples"),
        plain("background", "3", "color behind everything"),
    ],
    outputs: &[
        plain("uv", "H,W,2", "pixel positions"),
        plain("rays_o", "H,W,3", "origins"),
        plain("rays_d", "H,W,3", "directions"),
        plain("t", "H,W,N", "sample positions"),
        plain("deltas", "H,W,N", "step lengths"),
        plain("weights", "H,W,N", "T alpha"),
        plain("colors", "H,W,3", "over the background"),
    ],
    conventions: &["axes", "pixel_center", "directions", "grid", "delta", "last_delta", "product_eps"],
    forward: Pass {
        oracle: render_trace,
        bound: bound::render_trace,
        honest: honest::render_trace,
        wrong: mistakes::render_trace,
    },
    vjp: None,
    cases: cases::render_trace,
    mistakes: mistakes::RENDER_TRACE,
};

/// Height, width and number of samples.
pub(crate) fn size(a: &Arrays) -> [usize; 3] {
    let shape = input(a, "u").shape();
    [shape[0], shape[1], shape[2]]
}

fn render_trace(a: &Arrays, c: &Conventions) -> Arrays {
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
