//! A model of structure from motion in memory, whichever files it came from, and what it must satisfy.

use std::cmp::Ordering;
use std::collections::BTreeMap;

use glam::{DMat4, DQuat, DVec2, DVec3};

use super::faulty::faulty;
use super::lens::Lens;
use crate::convention::{Axes, Quaternion};
use crate::error::Result;
use crate::limits::LENGTH;
use crate::pose::from_colmap;

/// Cameras, photographs and points.
#[derive(Debug, Default)]
pub(super) struct Model {
    /// By number.
    pub cameras: BTreeMap<u32, Lens>,
    /// In the file's order.
    pub views: Vec<View>,
    /// By number.
    pub points: BTreeMap<u64, Point>,
}

/// A point of a surface.
#[derive(Debug)]
pub(super) struct Point {
    /// Where it is.
    pub place: DVec3,
    /// How far from where photographs show it the program says its projections lie: the mean, in pixels.
    pub error: f64,
}

/// A photograph.
#[derive(Debug)]
pub(super) struct View {
    /// Its path below the folder of pictures.
    pub name: String,
    /// Its camera's number.
    pub camera: u32,
    /// World to camera, a quaternion: w, x, y, z.
    pub rotation: [f64; 4],
    /// World to camera.
    pub translation: [f64; 3],
    /// Which points it shows, and where.
    pub sights: Vec<Sight>,
}

/// Where a photograph shows a point, in pixels.
#[derive(Debug)]
pub(super) struct Sight {
    /// The position.
    pub uv: DVec2,
    /// The point's number.
    pub point: u64,
}

impl Model {
    /// Adds a camera that holds what every camera does.
    pub(super) fn add_camera(&mut self, file: &str, id: u32, lens: Lens) -> Result<()> {
        lens.check(file, id)?;
        match self.cameras.insert(id, lens) {
            None => Ok(()),
            Some(_) => {
                let remedy = "Write the model again with COLMAP.";
                Err(faulty(file, "cameras", format!("camera {id} twice"), "each number once", remedy))
            }
        }
    }

    /// Adds a point that is somewhere.
    pub(super) fn add_point(&mut self, file: &str, id: u64, point: Point) -> Result<()> {
        let remedy = "Write the model again with COLMAP.";
        if point.place.is_nan() || point.place.abs().max_element() > LENGTH {
            let expected = "finite numbers, none beyond 1e9";
            return Err(faulty(file, format!("place of point {id}"), point.place, expected, remedy));
        }
        if !point.error.is_finite() {
            return Err(faulty(
                file,
                format!("error of point {id}"),
                point.error,
                "a number of pixels",
                remedy,
            ));
        }
        match self.points.insert(id, point) {
            None => Ok(()),
            Some(_) => Err(faulty(file, "points", format!("point {id} twice"), "each number once", remedy)),
        }
    }
}

impl View {
    /// Camera to world: x_c = R x_w + t, so that R^T and -R^T t.
    ///
    /// # Errors
    /// Where the quaternion is no rotation, or a number isn't finite.
    pub(super) fn pose(&self, file: &str) -> Result<DMat4> {
        let ([w, x, y, z], t) = (self.rotation, DVec3::from_array(self.translation));
        let q = DQuat::from_xyzw(x, y, z, w);
        let remedy = "Write the model again with COLMAP.";
        if (q.length() - 1.0).abs().partial_cmp(&1e-3) != Some(Ordering::Less) {
            let (field, found) = (format!("rotation of {}", self.name), format!("{:?}", self.rotation));
            return Err(faulty(file, field, found, "a quaternion of length 1", remedy));
        }
        if t.is_nan() || t.abs().max_element() > LENGTH {
            let (field, found) = (format!("translation of {}", self.name), format!("{:?}", self.translation));
            return Err(faulty(file, field, found, "finite numbers, none beyond 1e9", remedy));
        }
        if let Some(sight) = self.sights.iter().find(|sight| !sight.uv.is_finite()) {
            let (field, found) = (format!("points of {}", self.name), format!("one at {}", sight.uv));
            return Err(faulty(file, field, found, "finite numbers of pixels", remedy));
        }
        Ok(from_colmap(self.rotation, self.translation, Axes::Opencv, Quaternion::Normalized))
    }
}
