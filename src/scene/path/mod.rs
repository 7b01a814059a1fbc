//! Paths of a film's camera: a circle around the scene, a spiral before it, the capture's own path, or through key cameras.

use std::f64::consts::TAU;

use glam::{DMat3, DMat4, DVec3};

use super::Scene;
use crate::camera::{Camera, Intrinsics};

mod keys;

pub use keys::{key, smoothed, through};

/// A circle of cameras that look at the scene's focus, with the mean distance, height and up direction of the training cameras; where
/// those stand on one side only (a hand-held capture), an ellipse among them instead of a path around the back.
pub fn orbit(scene: &Scene, count: usize) -> Vec<Camera> {
    let first = scene.train[0].camera;
    let places = places(scene);
    let (n, up) = (places.len() as f64, up(scene));
    let mean = places.iter().sum::<DVec3>() / n;
    let offset = mean - scene.focus;
    let distance = places.iter().map(|p| (*p - scene.focus).length()).sum::<f64>() / n;
    let around = (offset - up * offset.dot(up)).length() < 0.5 * distance;
    let (center, a, b) = if around {
        let height = up * offset.dot(up);
        let radius = (distance * distance - height.length_squared()).max(0.0).sqrt();
        let (x, y) = up.any_orthonormal_pair();
        (scene.focus + height, x * radius, y * radius)
    } else {
        let forward = -offset.normalize();
        let right = forward.cross(up).normalize_or(forward.any_orthonormal_vector());
        let spread =
            |axis: DVec3| (places.iter().map(|p| (*p - mean).dot(axis).powi(2)).sum::<f64>() / n).sqrt();
        (mean, right * spread(right), right.cross(forward) * spread(right.cross(forward)))
    };
    let place = |k: usize| {
        let angle = TAU * k as f64 / count as f64;
        center + a * angle.cos() + b * angle.sin()
    };
    (0..count).map(|k| Camera { c2w: look_at(place(k), scene.focus, up), ..first }).collect()
}

/// LLFF's spiral for cameras that stand side by side: two rounds about their mean, as wide as nine of ten of them stand from it along
/// each of its axes, once forth and back meanwhile, looking at the scene's focus.
pub fn spiral(scene: &Scene, count: usize) -> Vec<Camera> {
    const ROUNDS: f64 = 2.0;
    let first = scene.train[0].camera;
    let (places, up) = (places(scene), up(scene));
    let mean = places.iter().sum::<DVec3>() / places.len() as f64;
    let axes = DMat3::from_mat4(look_at(mean, scene.focus, up));
    let reach = |axis: DVec3| {
        let mut along: Vec<f64> = places.iter().map(|place| (*place - mean).dot(axis).abs()).collect();
        along.sort_by(f64::total_cmp);
        along[((along.len() - 1) as f64 * 0.9).round() as usize]
    };
    let [x, y, z] = [axes.x_axis, axes.y_axis, axes.z_axis].map(|axis| axis * reach(axis));
    let place = |k: usize| {
        let angle = TAU * ROUNDS * k as f64 / count as f64;
        mean + x * angle.cos() - y * angle.sin() - z * (angle / ROUNDS).sin()
    };
    (0..count).map(|k| Camera { c2w: look_at(place(k), scene.focus, up), ..first }).collect()
}

/// The scene's first camera at another place: from `eye` to `target`, with `up`; `angle` is its angle of view across, in radians.
pub fn looking(scene: &Scene, [eye, target, up]: [DVec3; 3], angle: f64) -> Camera {
    let like = scene.train[0].camera;
    let focal = 0.5 * like.width as f64 / libm::tan(0.5 * angle);
    let k = Intrinsics { fx: focal, fy: like.k.fy * focal / like.k.fx, ..like.k };
    Camera { c2w: look_at(eye, target, up.normalize_or(DVec3::Z)), k, ..like }
}

/// The same field of view on another grid of pixels: K scales with the picture, the principal point with it.
pub fn resized(camera: &Camera, width: usize, height: usize) -> Camera {
    let (sx, sy) = (width as f64 / camera.width as f64, height as f64 / camera.height as f64);
    let Intrinsics { fx, fy, cx, cy } = camera.k;
    Camera { width, height, k: Intrinsics { fx: fx * sx, fy: fy * sy, cx: cx * sx, cy: cy * sy }, ..*camera }
}

/// Where the training cameras stand.
fn places(scene: &Scene) -> Vec<DVec3> {
    scene.train.iter().map(|frame| frame.camera.c2w.w_axis.truncate()).collect()
}

/// The mean of what is up in their pictures.
pub fn up(scene: &Scene) -> DVec3 {
    let down = scene.train.iter().map(|frame| frame.camera.c2w.y_axis.truncate()).sum::<DVec3>();
    -down.normalize_or(DVec3::Z)
}

/// A pose with OpenCV axes at `eye` that looks at `target`, its picture upright.
fn look_at(eye: DVec3, target: DVec3, up: DVec3) -> DMat4 {
    let z = (target - eye).normalize_or(DVec3::Z);
    let x = z.cross(up).normalize_or(z.any_orthonormal_vector());
    let y = z.cross(x);
    DMat4::from_cols(x.extend(0.0), y.extend(0.0), z.extend(0.0), eye.extend(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Options, load};

    #[test]
    fn a_camera_looks_at_its_target_with_up_up() {
        let pose = look_at(DVec3::new(0.0, -4.0, 1.0), DVec3::ZERO, DVec3::Z);
        let (x, y, z) = (pose.x_axis.truncate(), pose.y_axis.truncate(), pose.z_axis.truncate());
        assert!((x.cross(y) - z).length() < 1e-12, "right-handed");
        assert!(y.z < 0.0, "the picture's down is the world's down");
        assert!(((DVec3::ZERO - DVec3::new(0.0, -4.0, 1.0)).normalize() - z).length() < 1e-12);
    }

    /// Cameras of a wall, 8 before the focus: the spiral stays among them, upright, and returns to where it began.
    #[test]
    fn a_spiral_stays_among_cameras_that_stand_side_by_side() {
        let mut scene = load("builtin:spheres,size=8,views=9", &Options::default()).unwrap();
        for (n, frame) in scene.train.iter_mut().enumerate() {
            let place = DVec3::new(n as f64 % 3.0 - 1.0, -8.0, (n / 3) as f64 - 1.0);
            frame.camera.c2w = look_at(place, place + DVec3::Y, DVec3::Z);
        }
        let path = spiral(&scene, 40);
        for (camera, next) in path.iter().zip(path.iter().cycle().skip(1)) {
            let [x, y, z] = camera.c2w.w_axis.truncate().to_array();
            assert!(x.abs() < 1.0 + 1e-9 && z.abs() < 1.0 + 1e-9 && (y + 8.0).abs() < 1e-9, "{x} {y} {z}");
            assert!(camera.c2w.y_axis.z < -0.9, "down is down");
            assert!((camera.c2w.w_axis - next.c2w.w_axis).length() < 0.4, "no jump");
        }
    }
}
