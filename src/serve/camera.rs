//! A view as a request asks for it: where the eye is, what it looks at, what is up, how wide the picture is.

use std::f64::consts::PI;

use glam::DVec3;
use serde::Deserialize;
use serde_json::{Value, json};

use crate::camera::Camera;
use crate::limits::LENGTH;
use crate::scene::{Scene, path};

/// Pixels of a view's sides: what a screen shows, and a model renders while one waits.
const SIDE: usize = 1600;

/// The query of a view.
#[derive(Debug, Deserialize)]
pub(super) struct Asked {
    eye: String,
    target: String,
    up: String,
    /// Angle of view across, radians.
    angle: f64,
    width: usize,
    height: usize,
    /// R,G,B; the scene's where there is none.
    background: Option<String>,
    /// Depth in the place of color, where it is 1.
    depth: Option<u8>,
}

/// A view to render.
#[derive(Debug)]
pub(super) struct View {
    pub camera: Camera,
    pub background: [f32; 3],
    pub depth: bool,
}

impl Asked {
    /// The view; why there is none otherwise.
    pub(super) fn view(&self, scene: &Scene) -> Result<View, String> {
        let [eye, target, up] = [
            point("eye", &self.eye, LENGTH)?,
            point("target", &self.target, LENGTH)?,
            point("up", &self.up, LENGTH)?,
        ];
        if !(self.angle > 0.01 && self.angle < 3.0) {
            return Err(format!("angle: found {}; expected radians from 0.01 to 3", self.angle));
        }
        for (name, pixels) in [("width", self.width), ("height", self.height)] {
            if !(1..=SIDE).contains(&pixels) {
                return Err(format!("{name}: found {pixels}; expected 1 to {SIDE} pixels"));
            }
        }
        let background = match &self.background {
            None => scene.background,
            Some(text) => numbers(text)
                .filter(|color| color.iter().all(|x| (0.0..=1.0).contains(x)))
                .ok_or_else(|| format!("background: found {text:?}; expected R,G,B in [0, 1]"))?,
        };
        let camera = path::looking(scene, [eye, target, up], self.angle);
        Ok(View {
            camera: path::resized(&camera, self.width, self.height),
            background: background.map(|x| x as f32),
            depth: self.depth == Some(1),
        })
    }
}

fn point(name: &str, text: &str, most: f64) -> Result<DVec3, String> {
    let numbers = numbers(text).filter(|numbers| numbers.iter().all(|x| x.abs() <= most));
    numbers.map(DVec3::from_array).ok_or_else(|| format!("{name}: found {text:?}; expected X,Y,Z"))
}

fn numbers(text: &str) -> Option<[f64; 3]> {
    let numbers: Vec<f64> = text.split(',').map(|part| part.trim().parse().ok()).collect::<Option<_>>()?;
    numbers.try_into().ok()
}

/// Where the page begins to look from: at the first photograph's place, at what it shows.
pub(super) fn first(scene: &Scene) -> Value {
    let camera = scene.val.first().unwrap_or(&scene.train[0]).camera;
    let (eye, axis) = (camera.c2w.w_axis.truncate(), camera.c2w.z_axis.truncate());
    let ahead = (scene.focus - eye).dot(axis);
    let target = eye + axis * if ahead > 0.0 { ahead } else { 0.5 * (scene.near + scene.far) };
    let like = scene.train[0].camera;
    let angle = 2.0 * libm::atan(0.5 * like.width as f64 / like.k.fx);
    json!({
        "eye": eye.to_array(), "target": target.to_array(), "up": path::up(scene).to_array(),
        "angle": angle.clamp(0.02, PI * 0.9), "width": like.width, "height": like.height,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Options, load};

    fn asked() -> Asked {
        Asked {
            eye: "0,-4,1".into(),
            target: "0,0,0.5".into(),
            up: "0,0,1".into(),
            angle: 0.6,
            width: 20,
            height: 10,
            background: None,
            depth: None,
        }
    }

    /// What the page saves is what `render` reads: the same camera, but for its number of pixels.
    #[test]
    fn a_saved_key_is_the_view_that_was_seen() {
        let scene = load("builtin:spheres,size=8,views=9", &Options::default()).unwrap();
        let seen = asked().view(&scene).unwrap().camera;
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), json!({"frames": [path::key(&seen)]}).to_string()).unwrap();
        let key = path::through(file.path(), &scene, None).unwrap()[0];
        assert!(key.c2w.abs_diff_eq(seen.c2w, 1e-12), "{key:?} {seen:?}");
        let key = path::resized(&key, 20, 10);
        let near = |a: f64, b: f64| (a - b).abs() < 1e-9;
        assert!(near(key.k.fx, seen.k.fx) && near(key.k.fy, seen.k.fy), "{key:?} {seen:?}");
        assert!(near(seen.k.fx, 10.0 / libm::tan(0.3)) && near(seen.c2w.w_axis.y, -4.0));
    }

    #[test]
    fn what_is_no_view_is_named() {
        let scene = load("builtin:spheres,size=8,views=9", &Options::default()).unwrap();
        let refused = |asked: Asked| asked.view(&scene).unwrap_err();
        assert!(refused(Asked { eye: "0,1".into(), ..asked() }).starts_with("eye"));
        assert!(refused(Asked { target: "0,nan,0".into(), ..asked() }).starts_with("target"));
        assert!(refused(Asked { up: "0,1e300,0".into(), ..asked() }).starts_with("up"));
        assert!(refused(Asked { angle: f64::NAN, ..asked() }).starts_with("angle"));
        assert!(refused(Asked { width: 0, ..asked() }).starts_with("width"));
        assert!(refused(Asked { height: 1601, ..asked() }).starts_with("height"));
        assert!(refused(Asked { background: Some("2,0,0".into()), ..asked() }).starts_with("background"));
        // The eye at its target: any direction will do, but it is one.
        let camera = Asked { target: "0,-4,1".into(), ..asked() }.view(&scene).unwrap().camera;
        assert!(camera.c2w.to_cols_array().iter().all(|x| x.is_finite()));
    }
}
