//! Where the cameras look, and from that where samples start and end.

use glam::{DMat3, DVec2, DVec3};
use serde_json::Value;

use super::{Cloud, Options, Scene, border, doubts, sweep};
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

/// Sets the background, `focus`, `near`, `far` and, where depths are known, `bounds`, with their reasons: given, or derived.
pub(super) fn settle(scene: &mut Scene, file: &str, backdrop: Backdrop, options: &Options) -> Result<()> {
    border::settle(scene, options);
    // Held-out cameras count too: the scene doesn't change when another frame is held out, but for points that photographs agree on.
    let cameras: Vec<Camera> = scene.train.iter().chain(&scene.val).map(|frame| frame.camera).collect();
    let cameras: Vec<&Camera> = cameras.iter().collect();
    let focus = common_focus(&cameras);
    let given = options.near.is_some() && options.far.is_some();
    // Axes that hardly differ meet anywhere, or nowhere: then photographs say more than cameras.
    if backdrop == Backdrop::World
        && scene.cloud.is_none()
        && !given
        && !(focus.is_some() && fan(&cameras) >= FAN)
    {
        find_points(scene);
    }
    let points = scene.cloud.as_ref().and_then(of_points);
    let depths =
        matches!(backdrop, Backdrop::Between { .. }) || backdrop == Backdrop::World && points.is_some();
    if focus.is_none() && !depths && !given {
        scene.warnings.push(PARALLEL.into());
    }
    let range = match (backdrop, points) {
        (Backdrop::Between { near, far }, _) => Some(of_depths(near, far, &cameras)),
        (Backdrop::World, Some(range)) => Some(range),
        _ => focus.map(|focus| of_focus(focus, backdrop, &cameras)).or_else(|| of_spread(&cameras)),
    };
    distrust_box(scene, focus, &cameras);
    choose(scene, file, range, options)?;
    let (near, far) = (scene.near, scene.far);
    // Where axes meet nowhere, depths that are given are all that says where things are.
    let known =
        scene.cloud.is_some() || matches!(backdrop, Backdrop::Between { .. }) || focus.is_none() && given;
    let seen = |focus: &DVec3| {
        let mean = cameras.iter().map(|camera| (*focus - center(camera)).length()).sum::<f64>();
        !known || (near..far).contains(&(mean / cameras.len() as f64))
    };
    let (focus, why) = match focus.filter(seen) {
        Some(focus) => (focus, "point closest to all cameras' axes"),
        None if known => (
            ahead(&cameras, if near > 0.0 { 2.0 / (1.0 / near + 1.0 / far) } else { 0.5 * far }),
            "before the mean camera, halfway in 1 / distance",
        ),
        None => (
            ahead(&cameras, spread(&cameras)),
            "before the cameras or between them, as far as they stand from one another",
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
/// The nearest camera stands at distance r, the farthest at R.
///
/// Near is r / 2, or where that is less, r (1 - sin a) for a camera that sees as far as an angle a to one side: there a ball begins that
/// fills the picture. With a smaller near, a field explains single photographs with specks in front of their cameras. In the real world,
/// axes that hardly differ meet anywhere, far behind what they look at too: there near is r / 10.
///
/// Far is 2 R in front of the real world. Over a plain background it is 3 R / 2, or where that is more, R (1 + tan a), but 2 R at the most:
/// so far away is the end of a bar that just fits into the picture from the side.
///
/// On the synthetic scenes of the NeRF paper, r = R = 4.03, this is their customary 2 and 6, which is used exactly.
fn of_focus(focus: DVec3, backdrop: Backdrop, cameras: &[&Camera]) -> Range {
    let distances = cameras.iter().map(|camera| (focus - center(camera)).length());
    let (low, high) = distances.fold((f64::INFINITY, 0.0f64), |(low, high), r| (low.min(r), high.max(r)));
    if backdrop == Backdrop::Plain && low > 3.9 && high < 4.2 {
        let why = format!("customary where cameras stand {low:.3} to {high:.3} from their focus");
        return Range { near: 2.0, far: 6.0, why };
    }
    let ball = cameras.iter().map(|camera| 1.0 - widest(camera)).fold(0.5, f64::min);
    let (near, factor) = match backdrop {
        Backdrop::Plain => {
            (ball, 1.0 + cameras.iter().map(|camera| widest_slope(camera)).fold(0.5, f64::max).min(1.0))
        }
        _ if fan(cameras) < FAN => (0.1, 2.0),
        _ => (ball, 2.0),
    };
    let why = format!(
        "cameras stand {low:.3} to {high:.3} from their common focus: near is {near:.3} of the smallest, far {factor:.3} of the largest"
    );
    Range { near: near * low, far: factor * high, why }
}

/// Cameras that look in one direction, within this angle to the mean.
const FAN: f64 = 10.0 * std::f64::consts::PI / 180.0;

/// The largest angle between a camera's axis and the mean one.
fn fan(cameras: &[&Camera]) -> f64 {
    let mean = cameras.iter().map(|camera| axis(camera)).sum::<DVec3>();
    // Axes to all sides have no mean.
    if mean.length() < 1e-9 * cameras.len() as f64 {
        return std::f64::consts::PI;
    }
    cameras.iter().map(|camera| axis(camera).angle_between(mean)).fold(0.0, f64::max)
}

/// The sine of the angle that a camera sees to one side, at the most.
fn widest(camera: &Camera) -> f64 {
    let slope = widest_slope(camera);
    slope / (1.0 + slope * slope).sqrt()
}

/// How far a camera sees to one side at depth 1, were the principal point in the middle: the larger of w / 2 fx and h / 2 fy.
pub(crate) fn widest_slope(camera: &Camera) -> f64 {
    (0.5 * camera.width as f64 / camera.k.fx).max(0.5 * camera.height as f64 / camera.k.fy)
}

/// What people are told where cameras have no common focus.
const PARALLEL: &str = "The cameras' axes meet nowhere in front of them: near, far and the middle of the scene are guessed from how far the \
     cameras stand apart. If the cameras do look at one thing, their axes aren't those of the file's convention (OpenGL looks along -z, \
     OpenCV along z), or the poses are world to camera. Give both near and far where they are known.";

/// Where axes meet nowhere: a street, a flight, a room from inside. Things are about as far away as the cameras stand from one another;
/// near is their usual distance from the next one, within 1% and 10% of that. `None` where all stand in one place.
fn of_spread(cameras: &[&Camera]) -> Option<Range> {
    let spread = spread(cameras);
    let next = median(cameras.iter().map(|camera| {
        let away = |other: &&Camera| (center(other) - center(camera)).length();
        cameras.iter().map(away).filter(|r| *r > 0.0).fold(f64::INFINITY, f64::min)
    }));
    let why = format!(
        "the axes meet nowhere, the cameras stand {spread:.3} from their middle and {next:.3} from one another: near is the latter, \
         0.01 to 0.1 of the former, far 10 of it"
    );
    let near = next.max(0.01 * spread).min(0.1 * spread);
    // What rounding leaves of equal places is no distance.
    (spread > 1e-9 * middle(cameras).length()).then_some(Range { near, far: 10.0 * spread, why })
}

/// The median of the cameras' distances from their middle.
fn spread(cameras: &[&Camera]) -> f64 {
    let middle = middle(cameras);
    median(cameras.iter().map(|camera| (center(camera) - middle).length()))
}

fn middle(cameras: &[&Camera]) -> DVec3 {
    cameras.iter().map(|camera| center(camera)).sum::<DVec3>() / cameras.len() as f64
}

/// The upper one of two in the middle.
fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Leaves out a box that the file states in units of its own: one that doesn't hold what the cameras look at, or is small beside their
/// distance from it.
fn distrust_box(scene: &mut Scene, focus: Option<DVec3>, cameras: &[&Camera]) {
    let (Some((low, high)), Some(focus)) = (scene.bounds, focus) else { return };
    let holds = focus.cmpge(low).all() && focus.cmple(high).all();
    let away = median(cameras.iter().map(|camera| (focus - center(camera)).length()));
    let width = (high - low).max_element();
    if holds && width > 0.1 * away {
        return;
    }
    let what = if holds { "is small beside" } else { "doesn't hold the point that the cameras look at," };
    let stated = scene.reasons.remove("bounds").unwrap_or_default();
    scene.bounds = None;
    scene.warnings.push(format!(
        "The scene's box, {width:.3} wide ({}), {what} {away:.3} away from them: it isn't used.",
        stated.as_str().unwrap_or("stated")
    ));
}

/// Gives the scene the points that its photographs agree on, where these are all of it; held-out ones aren't looked at. A warning where
/// they agree on too few.
fn find_points(scene: &mut Scene) {
    let agreement = sweep::sweep(&scene.train);
    let (found, places) = (agreement.cloud.points.len(), agreement.places);
    if agreement.refuted() {
        scene.warnings.push(format!(
            "Of {places} places, neighboring photographs agree on {found} only: near and far are guessed. Either the cameras stand too close \
             to one another or too far apart for what they see, or poses, axes or focal length aren't these photographs'. Give both near and \
             far where they are known."
        ));
    }
    if agreement.open() && !agreement.refuted() {
        let beyond = agreement.beyond;
        let why = format!(
            "none: {beyond} of {places} places are farther away than photographs so close to one another can tell"
        );
        scene.reasons.insert("points".into(), Value::from(why));
    }
    if agreement.trusted() {
        let why = format!("{found} of {places} places that neighboring photographs agree on");
        scene.reasons.insert("points".into(), Value::from(why));
        scene.cloud = Some(agreement.cloud);
    }
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
    let derived = range.is_some();
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
        let found = match derived {
            false => "cameras that all stand in one place".to_string(),
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

/// The point so far before the mean camera.
fn ahead(cameras: &[&Camera], distance: f64) -> DVec3 {
    // Of cameras that look to all sides, the mean axis is short: the point is between them.
    let forward = cameras.iter().map(|camera| axis(camera)).sum::<DVec3>() / cameras.len() as f64;
    middle(cameras) + forward * distance
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
