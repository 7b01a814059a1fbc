//! Where the cameras look, and from that where samples start and end.

use glam::{DMat3, DVec2, DVec3};
use serde_json::Value;

use super::{Cloud, Options, Scene, doubts};
use crate::camera::{Camera, pixel_to_camera, rotate};
use crate::error::{Error, Input, Result};

/// The least-squares point closest to all optical axes: sum (I - d d^T) (x - o) = 0 over the cameras.
///
/// `None` where the axes are too close to parallel to meet, or meet behind most cameras.
pub fn common_focus(cameras: &[&Camera]) -> Option<DVec3> {
    let (mut normal, mut right) = (DMat3::ZERO, DVec3::ZERO);
    for camera in cameras {
        let (o, d) = (center(camera), axis(camera));
        let across = DMat3::IDENTITY - DMat3::from_cols(d * d.x, d * d.y, d * d.z);
        normal += across;
        right += across * o;
    }
    let n = cameras.len() as f64;
    // det / n^3 is the product of the mean's eigenvalues, each in [0, 1]; 1e-5 is a fan of about a third of a degree.
    if n == 0.0 || normal.determinant() / (n * n * n) < 1e-5 {
        return None;
    }
    let focus = normal.inverse() * right;
    let in_front = cameras.iter().filter(|camera| (focus - center(camera)).dot(axis(camera)) > 0.0).count();
    (2 * in_front > cameras.len()).then_some(focus)
}

/// The camera's center.
fn center(camera: &Camera) -> DVec3 {
    camera.c2w.w_axis.truncate()
}

/// The direction it looks in.
fn axis(camera: &Camera) -> DVec3 {
    camera.c2w.z_axis.truncate().normalize()
}

/// What lies behind the object decides how far samples must reach.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Backdrop {
    /// One color: rendered or cut-out objects.
    Plain,
    /// The world: photographs.
    World,
    /// The world, whose depths the scene states.
    Between { near: f64, far: f64 },
}

/// Where samples start and end, and why.
struct Range {
    near: f64,
    far: f64,
    why: String,
}

/// Sets `focus`, `near`, `far` and, where depths are known, `bounds`, with their reasons: given, or derived.
pub(super) fn settle(scene: &mut Scene, file: &str, backdrop: Backdrop, options: &Options) -> Result<()> {
    // Held-out cameras count too: the scene doesn't change when another frame is held out.
    let cameras: Vec<Camera> = scene.train.iter().chain(&scene.val).map(|frame| frame.camera).collect();
    let cameras: Vec<&Camera> = cameras.iter().collect();
    let focus = common_focus(&cameras);
    let range = match (backdrop, scene.cloud.as_ref().and_then(of_points)) {
        (Backdrop::Between { near, far }, _) => Some(of_depths(near, far, &cameras)),
        (Backdrop::World, Some(range)) => Some(range),
        _ => focus.map(|focus| of_focus(focus, backdrop, &cameras)),
    };
    choose(scene, file, range, options)?;
    let (near, far) = (scene.near, scene.far);
    let known = scene.cloud.is_some() || matches!(backdrop, Backdrop::Between { .. });
    let seen = |focus: &DVec3| {
        let mean = cameras.iter().map(|camera| (*focus - center(camera)).length()).sum::<f64>();
        !known || (near..far).contains(&(mean / cameras.len() as f64))
    };
    let (focus, why) = match focus.filter(seen) {
        Some(focus) => (focus, "point closest to all cameras' axes"),
        None if known => (
            ahead(&cameras, 2.0 / (1.0 / near + 1.0 / far)),
            "before the mean camera, halfway in 1 / distance",
        ),
        None => (
            center(cameras[0]) + axis(cameras[0]) * (0.5 * (near + far)),
            "middle of the first camera's range",
        ),
    };
    scene.focus = focus;
    scene.reasons.insert("focus".into(), Value::from(why));
    if scene.bounds.is_none() && known {
        bound(scene, &cameras);
    }
    scene.warnings.extend(doubts::doubts(scene));
    Ok(())
}

/// From the cameras' distance to their common focus.
///
/// The nearest camera at distance r: near = r / 2. With a smaller near, a field explains single photographs with specks in front of their
/// cameras. The farthest at R: far = 3 R / 2 over a plain background (an object as large as half the distance to it), 2 R in front of the
/// real world. On the synthetic scenes of the NeRF paper, r = R = 4.03, this is their customary 2 and 6, which is used exactly.
fn of_focus(focus: DVec3, backdrop: Backdrop, cameras: &[&Camera]) -> Range {
    let distances = cameras.iter().map(|camera| (focus - center(camera)).length());
    let (low, high) = distances.fold((f64::INFINITY, 0.0f64), |(low, high), r| (low.min(r), high.max(r)));
    if backdrop == Backdrop::Plain && low > 3.9 && high < 4.2 {
        let why = format!("customary where cameras stand {low:.3} to {high:.3} from their focus");
        return Range { near: 2.0, far: 6.0, why };
    }
    let factor = if backdrop == Backdrop::Plain { 1.5 } else { 2.0 };
    let why = format!(
        "cameras stand {low:.3} to {high:.3} from their common focus: near is 0.5 of the smallest, far {factor} of the largest"
    );
    Range { near: 0.5 * low, far: factor * high, why }
}

/// From how far away the points are that the photographs show, but for the outermost of them, which may be mistakes.
fn of_points(cloud: &Cloud) -> Option<Range> {
    let (low, high) = (cloud.distance(0.01)?, cloud.distance(0.99)?);
    let why = format!(
        "98% of the points that photographs show are {low:.3} to {high:.3} away: near is 0.7 of the smallest, far 1.2 of the largest"
    );
    Some(Range { near: 0.7 * low, far: 1.2 * high, why })
}

/// From depths along the cameras' axes: 0.9 of the nearest as the NeRF paper has it, and the farthest as far as a corner of the picture is.
fn of_depths(near: f64, far: f64, cameras: &[&Camera]) -> Range {
    let slant =
        cameras.iter().map(|camera| corners(camera).map(|d| d.length()).into_iter().fold(1.0, f64::max));
    let slant = slant.fold(1.0, f64::max);
    let why = format!(
        "the scene's depths are {near:.3} to {far:.3}: near is 0.9 of the smallest, far the largest in a picture's corner"
    );
    Range { near: 0.9 * near, far: slant * far, why }
}

/// Sets `near` and `far`.
fn choose(scene: &mut Scene, file: &str, range: Option<Range>, options: &Options) -> Result<()> {
    let cameras_meet = range.is_some();
    let Range { near, far, why } =
        range.unwrap_or(Range { near: f64::NAN, far: f64::NAN, why: String::new() });
    let mut choose = |name: &str, given: Option<f64>, derived: f64| {
        let why = if given.is_some() { "given" } else { &why };
        scene.reasons.insert(name.into(), Value::from(format!("{:.4}: {why}", given.unwrap_or(derived))));
        given.unwrap_or(derived)
    };
    scene.near = choose("near", options.near, near);
    scene.far = choose("far", options.far, far);
    if scene.near.partial_cmp(&scene.far) != Some(std::cmp::Ordering::Less) {
        let found = match cameras_meet {
            false => "cameras whose axes meet nowhere in front of them".to_string(),
            true => format!("near {}, far {}", scene.near, scene.far),
        };
        let remedy = "Give both near and far, in the units of the cameras' positions.";
        return Err(Error::input(Input {
            file,
            field: "near and far",
            found,
            expected: "near < far",
            remedy,
        }));
    }
    Ok(())
}

/// The point so far before the mean of the cameras.
fn ahead(cameras: &[&Camera], distance: f64) -> DVec3 {
    let mean = cameras.iter().map(|camera| center(camera)).sum::<DVec3>() / cameras.len() as f64;
    let forward = cameras.iter().map(|camera| axis(camera)).sum::<DVec3>();
    mean + forward.normalize_or(axis(cameras[0])) * distance
}

/// Directions through a picture's corners, of depth 1; a lens bends them a little.
fn corners(camera: &Camera) -> [DVec3; 4] {
    let (w, h) = (camera.width as f64, camera.height as f64);
    [(0.0, 0.0), (w, 0.0), (0.0, h), (w, h)]
        .map(|(u, v)| rotate(&camera.c2w, pixel_to_camera(&camera.k, DVec2::new(u, v), 1.0)))
}

/// Sets `bounds`: the points' box, or what the cameras see between near and far.
fn bound(scene: &mut Scene, cameras: &[&Camera]) {
    const OUTSIDE: f64 = 0.01;
    let (low, high, why) = match scene.cloud.as_ref().and_then(|cloud| cloud.bounds(OUTSIDE)) {
        Some((low, high)) => {
            // Points of a wall have no depth, a single one no extent at all.
            let half = (0.6 * (high - low)).max(DVec3::splat(0.05 * scene.far));
            let middle = 0.5 * (low + high);
            (
                middle - half,
                middle + half,
                "98% of the points along each axis, and a tenth more at either end",
            )
        }
        None => {
            let seen = |camera: &Camera| {
                let ends = corners(camera)
                    .map(|d| [scene.near, scene.far].map(|t| center(camera) + d.normalize() * t));
                ends.concat()
            };
            let ends: Vec<DVec3> = cameras.iter().flat_map(|camera| seen(camera)).collect();
            let low = ends.iter().fold(DVec3::INFINITY, |low, end| low.min(*end));
            let high = ends.iter().fold(DVec3::NEG_INFINITY, |high, end| high.max(*end));
            (low, high, "what the cameras see between near and far")
        }
    };
    scene.bounds = Some((low, high));
    scene.reasons.insert("bounds".into(), Value::from(why));
}
