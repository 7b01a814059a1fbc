//! Captures whose cameras all look one way: the cube of normalized device coordinates that they share, and what a model is in it.

use glam::{DMat3, DMat4, DQuat, DVec3};
use serde_json::{Map, Value, json};

use super::{NerfModel, NerfSettings};
use crate::camera::Camera;
use crate::convention::NdcDepth;
use crate::ndc::View;
use crate::ndc::cube::Cube;
use crate::ray::Ray;
use crate::scene::{Scene, pixel_ray};
use crate::training::compact::extent::cut_out;
use crate::training::probe::Probe;
use crate::training::reference::Field;

/// How far from the mean camera's axis rays lie at the most, as a cosine, in a scene for which the cube is chosen unasked: 60 degrees.
const ONE_WAY: f64 = 0.5;

/// The cube of a scene's mean camera, whose near plane nothing lies before that is `near` away from a camera; with the least cosine
/// between its axis and a training ray.
///
/// # Errors
/// Why there is none.
pub fn cube(scene: &Scene) -> Result<(Cube, f64), &'static str> {
    let cameras: Vec<&Camera> = scene.train.iter().map(|frame| &frame.camera).collect();
    let c2w = mean(&cameras).ok_or("the cameras look in all directions, and their mean in none")?;
    let (w2c, axis) = (c2w.inverse(), c2w.z_axis.truncate());
    // Of a pinhole all other rays lie between these.
    let rays: Option<Vec<Vec<Ray>>> = cameras.iter().map(|camera| corners(camera)).collect();
    let rays = rays.ok_or("a lens has no rays at its pictures' corners")?.concat();
    let cosine = rays.iter().map(|ray| ray.d.dot(axis)).fold(1.0, f64::min);
    let near =
        rays.iter().map(|ray| w2c.transform_point3(ray.at(scene.near)).z).fold(f64::INFINITY, f64::min);
    // The widest picture's slopes, so that none sees beyond the cube's sides from where the mean camera stands.
    let width = cameras.iter().map(|c| c.width as f64 / c.k.fx).fold(0.0, f64::max);
    let height = cameras.iter().map(|c| c.height as f64 / c.k.fy).fold(0.0, f64::max);
    let cube = Cube { w2c, view: View { width, height, focal: 1.0, near, depth: NdcDepth::Positive } };
    match () {
        () if !rays.iter().all(|ray| cube.faces(ray)) => {
            Err("some rays go across or against the mean camera's axis")
        }
        () if near <= 0.0 => {
            Err("some cameras stand so far behind others that no near plane lies between them and the scene")
        }
        () => Ok((cube, cosine)),
    }
}

/// Camera to world of the mean camera: mean place, mean axes; `None` where these cancel.
fn mean(cameras: &[&Camera]) -> Option<DMat4> {
    let (mut place, mut axes) = (DVec3::ZERO, [DVec3::ZERO; 3]);
    for camera in cameras {
        place += camera.c2w.w_axis.truncate() / cameras.len() as f64;
        let own = DMat3::from_mat4(camera.c2w);
        axes[1] += own.y_axis;
        axes[2] += own.z_axis;
    }
    let z = axes[2].try_normalize()?;
    let y = (axes[1] - axes[1].dot(z) * z).try_normalize()?;
    let turn = DQuat::from_mat3(&DMat3::from_cols(y.cross(z), y, z));
    Some(DMat4::from_rotation_translation(turn.normalize(), place))
}

/// The rays through a picture's corners; `None` where one has none.
fn corners(camera: &Camera) -> Option<Vec<Ray>> {
    let (last, bottom) = (camera.width - 1, camera.height - 1);
    let all = [(0, 0), (last, 0), (0, bottom), (last, bottom)];
    all.into_iter().map(|(i, j)| pixel_ray(camera, i, j).ok().flatten()).collect()
}

impl NerfSettings {
    /// Normalized device coordinates where all rays go one way, and see more than an object.
    pub fn choose_space(&mut self, scene: &Scene) {
        (self.cube, self.space_reason) = match cube(scene) {
            Ok(_) if cut_out(scene) => {
                (None, "the scene's coordinates: the pictures' borders are background")
            }
            Ok((cube, cosine)) if cosine > ONE_WAY => (
                Some(cube),
                "normalized device coordinates: all rays lie within 60 degrees of the mean camera's axis",
            ),
            Ok(_) => {
                (None, "the scene's coordinates: rays lie more than 60 degrees off the mean camera's axis")
            }
            Err(why) => (None, why),
        };
    }
}

impl NerfModel {
    /// What the field is at a distance along a ray, in the scene's own unit.
    pub(super) fn probed(&self, field: &Field, ray: &Ray, t: f64) -> Probe {
        let x = ray.at(t).to_array();
        let (x, stretch) = match &self.settings.cube {
            None => (x, 1.0),
            Some(cube) if cube.faces(ray) && cube.holds(ray, t) => (cube.point(x), cube.stretch(ray, t)),
            Some(_) => return Probe::default(),
        };
        if self.grid.as_ref().is_some_and(|grid| !grid.live(x)) {
            return Probe::default();
        }
        let tape = field.at(ray, t);
        Probe { density: tape.sigma * stretch, rgb: tape.rgb }
    }

    /// The settings of space for `run.json`; the view is derived from the scene's cameras.
    pub(super) fn space_settings(&self) -> Map<String, Value> {
        let Value::Object(settings) = (match &self.settings.cube {
            None => json!({"space": "box"}),
            Some(Cube { view, .. }) => json!({
                "space": "ndc", "ndc_near": view.near, "ndc_slopes": [view.width / view.focal, view.height / view.focal],
            }),
        }) else {
            unreachable!("an object literal")
        };
        settings
    }
}
