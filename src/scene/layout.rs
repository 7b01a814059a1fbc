//! Where the cameras look, and from that where samples start and end.

use glam::{DMat3, DVec3};
use serde_json::Value;

use super::{Options, Scene};
use crate::camera::Camera;
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
}

/// Sets `focus`, `near` and `far` with their reasons: given, or derived from the cameras' distance to their common focus.
///
/// The nearest camera at distance r: near = r / 2. With a smaller near, a field explains single photographs with specks in front of their
/// cameras. The farthest at R: far = 3 R / 2 over a plain background (an object as large as half the distance to it), 2 R in front of the
/// real world. On the synthetic scenes of the NeRF paper, r = R = 4.03, this is their customary 2 and 6, which is used exactly.
pub(super) fn settle(scene: &mut Scene, file: &str, backdrop: Backdrop, options: &Options) -> Result<()> {
    // Held-out cameras count too: the scene doesn't change when another frame is held out.
    let cameras: Vec<&Camera> = scene.train.iter().chain(&scene.val).map(|frame| &frame.camera).collect();
    let focus = common_focus(&cameras);
    let distances = focus.map(|focus| {
        let distances = cameras.iter().map(|camera| (focus - center(camera)).length());
        distances.fold((f64::INFINITY, 0.0f64), |(low, high), r| (low.min(r), high.max(r)))
    });
    let (near, far, why) = match (distances, backdrop) {
        (Some((low, high)), Backdrop::Plain) if low > 3.9 && high < 4.2 => {
            (2.0, 6.0, format!("customary where cameras stand {low:.3} to {high:.3} from their focus"))
        }
        (Some((low, high)), _) => {
            let factor = if backdrop == Backdrop::Plain { 1.5 } else { 2.0 };
            let why = format!(
                "cameras stand {low:.3} to {high:.3} from their common focus: near is 0.5 of the smallest, far {factor} of the largest"
            );
            (0.5 * low, factor * high, why)
        }
        (None, _) => (f64::NAN, f64::NAN, String::new()),
    };
    let mut choose = |name: &str, given: Option<f64>, derived: f64| {
        let why = if given.is_some() { "given" } else { &why };
        scene.reasons.insert(name.into(), Value::from(format!("{:.4}: {why}", given.unwrap_or(derived))));
        given.unwrap_or(derived)
    };
    scene.near = choose("near", options.near, near);
    scene.far = choose("far", options.far, far);
    if scene.near.partial_cmp(&scene.far) != Some(std::cmp::Ordering::Less) {
        let found = match distances {
            None => "cameras whose axes meet nowhere in front of them".to_string(),
            Some(_) => format!("near {}, far {}", scene.near, scene.far),
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
    let middle = 0.5 * (scene.near + scene.far);
    scene.focus = focus.unwrap_or_else(|| center(cameras[0]) + axis(cameras[0]) * middle);
    let why = if focus.is_some() {
        "point closest to all cameras' axes"
    } else {
        "middle of the first camera's range"
    };
    scene.reasons.insert("focus".into(), Value::from(why));
    Ok(())
}
