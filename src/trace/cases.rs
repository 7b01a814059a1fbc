//! Cases of the trace: a picture that isn't square, a center off the middle, a random pose, at rest and jittered.

use crate::camera::cases::{random_rotation, rigid};
use crate::contract::arrays::{array, scalar};
use crate::contract::case::{Case, Draw};

/// H, W and N: small, and all different.
const SIZE: [usize; 3] = [3, 4, 6];
const PORTRAIT: [usize; 3] = [5, 3, 4];

/// The trace of a picture.
pub(crate) fn render_trace() -> Vec<Case> {
    let dim = [0.05, 1.0];
    let cases = [
        traced("at_rest", "evaluation: u = 1/2 everywhere", SIZE, Some(0.5), 0, dim),
        traced("left_edges", "u = 0 everywhere: the grid itself", SIZE, Some(0.0), 1, dim),
        traced("jittered", "training: u differs from ray to ray and sample to sample", SIZE, None, 2, dim),
        traced("portrait", "taller than wide", PORTRAIT, None, 3, dim),
        traced("colors_beyond", "colors below 0 and above 1 aren't clipped", SIZE, None, 4, [-2.0, 3.0]),
    ];
    cases.iter().flat_map(rigid).collect()
}

fn traced(
    id: &str,
    comment: &'static str,
    size: [usize; 3],
    u: Option<f64>,
    stream: u64,
    [low, high]: [f64; 2],
) -> Case {
    let mut draw = Draw::new("render_trace", stream);
    let [h, w, n] = size;
    let jitter = match u {
        Some(u) => array(&size, vec![u; h * w * n]),
        None => draw.array(&size, 0.02, 0.95),
    };
    let sigmas =
        (0..h * w * n).map(|_| if draw.unit() < 0.25 { 0.0 } else { draw.decades(-1.5, 0.7) }).collect();
    Case::new(
        id,
        comment,
        vec![
            ("height", scalar(h as f64)),
            ("width", scalar(w as f64)),
            ("focal", scalar(5.5)),
            ("cx", scalar(0.5 * w as f64)),
            ("cy", scalar(0.5 * h as f64)),
            ("c2w", array(&[4, 4], random_rotation(&mut draw).to_vec())),
            ("near", scalar(2.0)),
            ("far", scalar(6.0)),
            ("u", jitter),
            ("sigmas", array(&size, sigmas)),
            ("rgbs", draw.array(&[h, w, n, 3], low, high)),
            ("background", array(&[3], vec![0.75, 0.5, 0.25])),
        ],
    )
}
