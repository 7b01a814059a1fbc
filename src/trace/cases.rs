//! Cases of the trace: a picture that isn't square, a center off the middle, a random pose, at rest and jittered.

use crate::camera::cases::random_pose;
use crate::contract::arrays::{array, scalar};
use crate::contract::case::{Case, Draw, in_full};

/// H, W and N: small, and all different.
const SIZE: [usize; 3] = [3, 4, 6];

/// The trace of a picture.
pub fn render_trace() -> Vec<Case> {
    let cases = vec![
        traced("at_rest", "evaluation: u = 1/2 everywhere", Some(0.5), 0),
        traced("left_edges", "u = 0 everywhere: the grid itself", Some(0.0), 1),
        traced("jittered", "training: u differs from ray to ray and sample to sample", None, 2),
    ];
    in_full(cases, "jittered")
}

fn traced(id: &str, comment: &'static str, u: Option<f64>, stream: u64) -> Case {
    let mut draw = Draw::new("render_trace", stream);
    let [h, w, n] = SIZE;
    let jitter = match u {
        Some(u) => array(&SIZE, vec![u; h * w * n]),
        None => draw.array(&SIZE, 0.02, 0.95),
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
            ("cx", scalar(2.0)),
            ("cy", scalar(1.5)),
            ("c2w", array(&[4, 4], random_pose(&mut draw).to_vec())),
            ("near", scalar(2.0)),
            ("far", scalar(6.0)),
            ("u", jitter),
            ("sigmas", array(&SIZE, sigmas)),
            ("rgbs", draw.array(&[h, w, n, 3], 0.05, 1.0)),
            ("background", array(&[3], vec![0.75, 0.5, 0.25])),
        ],
    )
}
