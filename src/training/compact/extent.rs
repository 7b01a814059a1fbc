//! What part of space a scene needs: a box, or all that there is; derived from its cameras, its bounds and its pictures.

use glam::DVec3;
use serde_json::Value;

use super::space::Space;
use crate::camera::Camera;
use crate::scene::{Scene, widest_slope};

/// What a user says about the part of space that a model holds (`--space`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Extent {
    /// As the scene asks for it.
    #[default]
    Auto,
    /// The scene's box.
    Box,
    /// All of space, contracted around the scene's middle.
    Contracted,
}

/// How far rays go in contracted space, in half edges of the inner cube; and how far at the most, where numbers of 24 bits still tell
/// steps apart.
const HORIZON: f64 = 100.0;
const FARTHEST: f64 = 1e4;

/// What is less than this of the box, or of `far`, is no extent of the cameras.
const TOGETHER: f64 = 1e-4;

/// From how many times the cameras' own cube on a scene's box is too wide for its cells.
const UNBOUNDED: f64 = 4.0;

/// How many times farther away from the focus than half of the cameras one counts at the most.
const OUTLIER: f64 = 3.0;

fn center(camera: &Camera) -> DVec3 {
    camera.c2w.w_axis.truncate()
}

/// Of the cameras from their focus.
fn distances(scene: &Scene) -> Vec<f64> {
    scene.train.iter().map(|frame| (center(&frame.camera) - scene.focus).length()).collect()
}

/// Distances of which none is more than `OUTLIER` medians: a camera far away from all others takes no resolution from what they see.
fn usual(distances: Vec<f64>) -> Vec<f64> {
    let mut sorted = distances.clone();
    sorted.sort_by(f64::total_cmp);
    let most = OUTLIER * sorted[sorted.len() / 2];
    // Where most cameras stand in the focus itself, the others are all that there is.
    distances.into_iter().map(|r| if most > 0.0 { r.min(most) } else { r }).collect()
}

/// The cube that the unit box holds, or that is the part of contracted space that isn't: its lower corner and its edge, with the reason.
pub(super) fn cube(scene: &Scene, space: Space) -> (DVec3, f64, String) {
    if space == Space::Box {
        return whole_cube(scene);
    }
    let half = inner_half(scene);
    let why = "the part of space that isn't contracted: around the cameras' focus, as far as the farthest of them that isn't an outlier";
    (scene.focus - DVec3::splat(half), 2.0 * half, why.into())
}

/// Where samples end.
pub(super) fn far(scene: &Scene, space: Space) -> f64 {
    let half = inner_half(scene);
    match space {
        Space::Box => scene.far,
        Space::Contracted { .. } if scene.far_given => scene.far.min(FARTHEST * half),
        Space::Contracted { .. } => scene.far.clamp(HORIZON * half, FARTHEST * half),
    }
}

/// The cube that holds the whole scene, with its reason.
fn whole_cube(scene: &Scene) -> (DVec3, f64, String) {
    if let Some((low, high)) = scene.bounds {
        let size = (high - low).max_element();
        let why = scene.reasons.get("bounds").and_then(Value::as_str).unwrap_or("the scene says so");
        return (0.5 * (low + high) - DVec3::splat(0.5 * size), size, why.into());
    }
    let (mut nearest, mut farthest) = (f64::INFINITY, 0f64);
    for r in distances(scene) {
        (nearest, farthest) = (nearest.min(r), farthest.max(r));
    }
    let reach = (scene.far - nearest).max(0.1 * farthest);
    let slope = scene.train.iter().map(|frame| widest_slope(&frame.camera)).fold(0.0, f64::max);
    let (half, why) = if cut_out(scene) {
        let why = "the pictures' borders are background, so the object lies where the pictures look at the cameras' focus";
        (reach.min(farthest * slope), why)
    } else {
        (reach, "the pictures are full, so the box reaches from the cameras' focus as far as samples do")
    };
    (scene.focus - DVec3::splat(half), 2.0 * half, why.into())
}

/// Half the edge of the inner cube of contracted space, around the cameras' focus: it holds the cameras that aren't outliers.
fn inner_half(scene: &Scene) -> f64 {
    let away = |camera: &Camera| (center(camera) - scene.focus).abs().max_element();
    usual(scene.train.iter().map(|frame| away(&frame.camera)).collect()).into_iter().fold(0.0, f64::max)
}

/// Whether the scene has a box that everything in it is in, or all of space around its middle; and why.
pub(super) fn space(scene: &Scene, extent: Extent) -> (Space, String) {
    // Across the cube and back out of it, as seen from a camera.
    let even = usual(distances(scene)).into_iter().fold(0.0, f64::max) + inner_half(scene);
    let contracted = Space::Contracted { even };
    let (_, size, _) = whole_cube(scene);
    let times = size / (2.0 * inner_half(scene));
    match extent {
        Extent::Box => (Space::Box, "a box: as asked for".into()),
        _ if inner_half(scene) <= TOGETHER * size.min(scene.far) => {
            (Space::Box, "a box: the cameras stand at the point that they look at".into())
        }
        Extent::Contracted => (contracted, "contracted: as asked for".into()),
        Extent::Auto if cut_out(scene) => (Space::Box, "a box: the pictures' borders are background".into()),
        Extent::Auto if scene.bounds.is_none() && !scene.far_given => {
            (contracted, "contracted: the pictures are full, and nothing says how far away things are".into())
        }
        Extent::Auto if times > UNBOUNDED => {
            let why = format!(
                "contracted: the scene's box is {times:.1} times as wide as the cameras' ({UNBOUNDED} at most)"
            );
            (contracted, why)
        }
        Extent::Auto => {
            let why =
                format!("a box: {times:.1} times as wide as the cameras' (contracted from {UNBOUNDED} on)");
            (Space::Box, why)
        }
    }
}

/// Whether 95% of the pictures' border pixels are background: within 0.02, or a quarter of what pictures are off it as a whole, so that
/// the dark of a night isn't taken for black.
pub(crate) fn cut_out(scene: &Scene) -> bool {
    let near = (0.25 * off_background(scene)).min(0.02);
    let (mut border, mut plain) = (0, 0);
    for image in scene.train.iter().filter_map(|frame| frame.image.as_ref()) {
        for color in image.border() {
            border += 1;
            plain += usize::from((0..3).all(|k| (f64::from(color[k]) - scene.background[k]).abs() <= near));
        }
    }
    plain * 20 >= border * 19
}

/// The root mean square of the pictures' differences from the background, over every 61st pixel.
fn off_background(scene: &Scene) -> f64 {
    let (mut sum, mut count) = (0.0, 0);
    for image in scene.train.iter().filter_map(|frame| frame.image.as_ref()) {
        for color in (0..image.len()).step_by(61).map(|n| image.pixel(n)) {
            (0..3).for_each(|k| sum += (f64::from(color[k]) - scene.background[k]).powi(2));
            count += 3;
        }
    }
    (sum / f64::from(count.max(1))).sqrt()
}

/// The width of a pixel at the focus, from the mean camera; of different ones, from that with the median focal length.
pub(super) fn pixel_footprint(scene: &Scene) -> f64 {
    let mean = usual(distances(scene)).iter().sum::<f64>() / scene.train.len() as f64;
    let mut focal: Vec<f64> = scene.train.iter().map(|frame| frame.camera.k.fx).collect();
    focal.sort_by(f64::total_cmp);
    mean / focal[focal.len() / 2]
}
