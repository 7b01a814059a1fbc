//! Paths along given cameras: smoothly through a few, or past many.

use std::path::Path;

use glam::{DMat3, DMat4, DQuat, DVec3};
use serde_json::{Value, json};

use crate::camera::{Camera, Intrinsics};
use crate::error::{Error, Input, Result};
use crate::files::json::Holds::{self, *};
use crate::files::{self, json as text};
use crate::scene::{Frame, Scene, check};

/// Frames between two key cameras, where no number is given.
const LEG: usize = 30;

/// What a file of key cameras holds; what else stands there is somebody else's.
const FILE: &[(&str, Holds)] = &[("frames", List(&Anything))];

/// How far to either side the capture's own path is smoothed, in frames: the standard deviation of a Gaussian.
const SMOOTH: f64 = 1.5;

/// A camera's place, rotation and focal length, of which paths are made.
#[derive(Clone, Copy)]
struct Key {
    place: DVec3,
    turn: DQuat,
    focal: f64,
}

impl Key {
    fn of(camera: &Camera) -> Key {
        let turn = DQuat::from_mat3(&DMat3::from_mat4(camera.c2w));
        Key { place: camera.c2w.w_axis.truncate(), turn, focal: camera.k.fx }
    }

    /// The camera, otherwise like `like`.
    fn camera(&self, like: &Camera) -> Camera {
        let zoom = self.focal / like.k.fx;
        let k = Intrinsics { fx: self.focal, fy: like.k.fy * zoom, ..like.k };
        Camera { c2w: DMat4::from_rotation_translation(self.turn, self.place), k, ..*like }
    }

    /// The weighted sum, its rotation made one again; of focal lengths the product of powers, as weights may be below 0.
    fn mix(keys: impl Iterator<Item = (Key, f64)>) -> Key {
        let none = Key { place: DVec3::ZERO, turn: DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0), focal: 0.0 };
        let sum = keys.fold(none, |sum, (key, weight)| Key {
            place: sum.place + key.place * weight,
            turn: sum.turn + key.turn * weight,
            focal: sum.focal + key.focal.ln() * weight,
        });
        Key { turn: sum.turn.normalize(), focal: sum.focal.exp(), ..sum }
    }
}

/// Turns each rotation's quaternion, which has two signs, to the side of the one before.
fn aligned(mut keys: Vec<Key>) -> Vec<Key> {
    for n in 1..keys.len() {
        if keys[n].turn.dot(keys[n - 1].turn) < 0.0 {
            keys[n].turn = -keys[n].turn;
        }
    }
    keys
}

/// The capture's own cameras, in the order of their names, as one smooth path: at each of `count` moments the mean of the cameras about it,
/// by a Gaussian of 1.5 frames.
pub fn smoothed(scene: &Scene, count: usize) -> Vec<Camera> {
    let mut frames: Vec<&Frame> = scene.train.iter().chain(&scene.val).collect();
    frames.sort_by(|a, b| a.name.cmp(&b.name));
    let keys = aligned(frames.iter().map(|frame| Key::of(&frame.camera)).collect());
    let at = |n: usize| {
        let moment = (keys.len() - 1) as f64 * n as f64 / (count - 1).max(1) as f64;
        let weight = |k: usize| (-0.5 * ((k as f64 - moment) / SMOOTH).powi(2)).exp();
        let total: f64 = (0..keys.len()).map(weight).sum();
        Key::mix(keys.iter().enumerate().map(|(k, key)| (*key, weight(k) / total)))
    };
    (0..count).map(|n| at(n).camera(&frames[0].camera)).collect()
}

/// Cameras through the key cameras of a JSON file: `frames`, each with a `transform_matrix` as `transforms.json` has it, and a
/// `camera_angle_x` where it isn't the scene's. Between two, places, rotations and focal lengths follow Catmull and Rom's curve.
///
/// # Errors
/// Where the file isn't such.
pub fn through(path: &Path, scene: &Scene, count: Option<usize>) -> Result<Vec<Camera>> {
    let like = scene.train[0].camera;
    let keys = aligned(read(path, &like)?);
    let legs = keys.len() - 1;
    let count = count.unwrap_or((LEG * legs).max(1));
    let key = |k: isize| keys[k.clamp(0, legs as isize) as usize];
    let at = |n: usize| {
        let moment = legs as f64 * n as f64 / (count - 1).max(1) as f64;
        let k = (moment as usize).min(legs.saturating_sub(1));
        let t = moment - k as f64;
        let weights = catmull_rom(t);
        Key::mix((0..4).map(|i| (key(k as isize + i as isize - 1), weights[i])))
    };
    Ok((0..count).map(|n| at(n).camera(&like)).collect())
}

/// A camera as such a file's frame: [`through`] reads it.
pub fn key(camera: &Camera) -> Value {
    // Each column of the turned axes; rows are what is written.
    let m = check::opengl_to_opencv(camera.c2w).transpose();
    let rows = [m.x_axis, m.y_axis, m.z_axis, m.w_axis].map(|row| row.to_array());
    let angle = 2.0 * libm::atan(0.5 * camera.width as f64 / camera.k.fx);
    json!({"transform_matrix": rows, "camera_angle_x": angle})
}

/// Weights of four neighbors for a point between the middle two: 0.5 (1, t, t^2, t^3) times Catmull and Rom's matrix.
fn catmull_rom(t: f64) -> [f64; 4] {
    let (t2, t3) = (t * t, t * t * t);
    [
        0.5 * (-t + 2.0 * t2 - t3),
        0.5 * (2.0 - 5.0 * t2 + 3.0 * t3),
        0.5 * (t + 4.0 * t2 - 3.0 * t3),
        0.5 * (-t2 + t3),
    ]
}

fn read(path: &Path, like: &Camera) -> Result<Vec<Key>> {
    let file = path.display().to_string();
    let remedy = "Give an object with `frames`, each with a transform_matrix as transforms.json has it.";
    let wrong = |field: String, found: String, expected: &str| {
        Error::input(Input { file: &file, field, found, expected, remedy })
    };
    let json = text::parse(&files::read_text(path)?);
    let json = json.map_err(|error| wrong("JSON".into(), error.to_string(), "a whole object"))?;
    let object = json.as_object().ok_or_else(|| wrong("JSON".into(), text::short(&json), "an object"))?;
    for (name, holds) in FILE {
        holds.check(&file, name, object.get(*name).unwrap_or(&Value::Null), remedy)?;
    }
    let frames = json["frames"].as_array().filter(|frames| !frames.is_empty());
    let frames = frames.ok_or_else(|| wrong("frames".into(), "none".into(), "at least one key camera"))?;
    let key = |(n, frame): (usize, &Value)| {
        let field = format!("transform_matrix of frames[{n}]");
        let matrix = check::matrix(&frame["transform_matrix"]);
        let matrix =
            matrix.ok_or_else(|| wrong(field.clone(), "no matrix".into(), "four rows of four numbers"))?;
        let c2w = check::opengl_to_opencv(check::pose(&file, &field, matrix.view())?);
        let key = Key::of(&Camera { c2w, ..*like });
        let angle = &frame["camera_angle_x"];
        Maybe(&Above(0.0, 3.1)).check(&file, &format!("camera_angle_x of frames[{n}]"), angle, remedy)?;
        let focal = angle.as_f64().map(|angle| 0.5 * like.width as f64 / libm::tan(0.5 * angle));
        Ok(Key { focal: focal.unwrap_or(key.focal), ..key })
    };
    frames.iter().enumerate().map(key).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Options, load};

    fn scene() -> Scene {
        load("builtin:spheres,size=8,views=9", &Options::default()).unwrap()
    }

    fn along(keys: &Value, count: Option<usize>) -> Result<Vec<Camera>> {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), keys.to_string()).unwrap();
        through(file.path(), &scene(), count)
    }

    /// OpenGL poses at (x, 0, 4), turned about z.
    fn key(x: f64, degrees: f64) -> Value {
        let (s, c) = degrees.to_radians().sin_cos();
        json!({"transform_matrix": [[c, -s, 0.0, x], [s, c, 0.0, 0.0], [0.0, 0.0, 1.0, 4.0], [0.0, 0.0, 0.0, 1.0]]})
    }

    #[test]
    fn a_path_goes_through_its_keys_and_evenly_where_they_are_even() {
        let mut keys = json!({"frames": [key(0.0, 0.0), key(1.0, 90.0), key(2.0, 180.0), key(3.0, 270.0)]});
        keys["frames"][2]["camera_angle_x"] = json!(1.0);
        let path = along(&keys, Some(7)).unwrap();
        for (n, x) in [(0, 0.0), (2, 1.0), (3, 1.5), (4, 2.0), (6, 3.0)] {
            assert!((path[n].c2w.w_axis.truncate() - DVec3::new(x, 0.0, 4.0)).length() < 1e-12, "{n}");
            let turn = (90.0 * x).to_radians();
            assert!(
                (path[n].c2w.x_axis.truncate() - DVec3::new(turn.cos(), turn.sin(), 0.0)).length() < 1e-12
            );
            assert!((path[n].c2w.z_axis.truncate() + DVec3::Z).length() < 1e-12, "it looks along -z");
        }
        let usual = scene().train[0].camera.k.fx;
        assert!((path[2].k.fx - usual).abs() < 1e-12 && (path[4].k.fx - 4.0 / 0.5f64.tan()).abs() < 1e-12);
        assert_eq!(along(&keys, None).unwrap().len(), 90);
        let one = along(&json!({"frames": [key(2.0, 0.0)]}), None).unwrap();
        assert_eq!((one.len(), one[0].c2w.w_axis.x), (1, 2.0));
        let message = along(&json!({"frames": []}), None).unwrap_err().to_string();
        assert!(message.contains("frames: found none"), "{message}");
    }

    /// Cameras along a line, every other one shaken to a side: the path keeps to the line, from end to end.
    #[test]
    fn the_captures_own_path_is_smooth() {
        let mut scene = scene();
        scene.val.clear();
        for (n, frame) in scene.train.iter_mut().enumerate() {
            frame.name = format!("{n:03}");
            let shake = if n % 2 == 0 { 0.1 } else { -0.1 };
            frame.camera.c2w = DMat4::from_translation(DVec3::new(n as f64, shake, 0.0));
        }
        scene.train.reverse();
        let path = smoothed(&scene, 50);
        let places: Vec<DVec3> = path.iter().map(|camera| camera.c2w.w_axis.truncate()).collect();
        assert!(places.windows(2).all(|pair| pair[1].x > pair[0].x && pair[1].x - pair[0].x < 0.25));
        assert!(places[0].x < 1.5 && places[49].x > 6.5, "{} {}", places[0].x, places[49].x);
        assert!(places[10..40].iter().all(|place| place.y.abs() < 0.01), "{places:?}");
        assert_eq!((path.len(), path[7].width), (50, 8));
    }
}
