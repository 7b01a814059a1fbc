//! Points of a capture's surfaces, as structure from motion finds them: how far away things are, and whether the cameras fit.

use glam::{DVec2, DVec3};

use crate::camera::{Camera, camera_to_pixel};

/// Points, and how far the photographs that show them are from them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cloud {
    /// Where they are.
    pub points: Vec<DVec3>,
    /// Distances between a point and a camera whose photograph shows it, ascending.
    pub distances: Vec<f64>,
    /// How well the cameras fit, where it is known where the photographs show the points.
    pub reprojection: Option<Reprojection>,
}

/// How far the points, seen through the cameras, are from where the photographs show them.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Reprojection {
    /// Where points are shown, over all photographs.
    pub sights: usize,
    /// How many of these points lie behind the camera.
    pub behind: usize,
    /// The mean distance of the others, in pixels.
    pub pixels: f64,
    /// The same as the program that found the points says.
    pub stated: f64,
}

impl Cloud {
    /// Points of which it isn't known which photograph shows them: each that some picture could, from its camera. Of many, some.
    pub(super) fn around(points: Vec<DVec3>, cameras: &[&Camera]) -> Self {
        const SOME: usize = 5000;
        let mut distances = vec![];
        for camera in cameras {
            let frame = DVec2::new(camera.width as f64, camera.height as f64);
            for point in points.iter().step_by(points.len().div_ceil(SOME).max(1)) {
                let uv = project(camera, *point);
                if uv.is_some_and(|uv| uv.cmpge(DVec2::ZERO).all() && uv.cmple(frame).all()) {
                    distances.push((*point - camera.c2w.w_axis.truncate()).length());
                }
            }
        }
        distances.sort_by(f64::total_cmp);
        Cloud { points, distances, reprojection: None }
    }

    /// The cloud, if photographs show any of it; a warning where they show nothing of what there is.
    pub(super) fn useful(self, warnings: &mut Vec<String>) -> Option<Self> {
        if self.distances.is_empty() && !self.points.is_empty() {
            let count = self.points.len();
            warnings.push(format!(
                "No photograph shows any of the {count} points: cameras and points don't fit, and the points aren't used."
            ));
        }
        (!self.distances.is_empty()).then_some(self)
    }

    /// The distance that a share `q` of all is below.
    pub(super) fn distance(&self, q: f64) -> Option<f64> {
        quantile(&self.distances, q)
    }

    /// The box that holds the points, each axis but for a share `q` of them at either end.
    pub(super) fn bounds(&self, q: f64) -> Option<(DVec3, DVec3)> {
        let axis = |k: usize| {
            let mut along: Vec<f64> = self.points.iter().map(|point| point[k]).collect();
            along.sort_by(f64::total_cmp);
            Some((quantile(&along, q)?, quantile(&along, 1.0 - q)?))
        };
        let ((x, a), (y, b), (z, c)) = (axis(0)?, axis(1)?, axis(2)?);
        Some((DVec3::new(x, y, z), DVec3::new(a, b, c)))
    }
}

/// The entry of a sorted list below which a share `q` lies.
fn quantile(sorted: &[f64], q: f64) -> Option<f64> {
    let last = sorted.len().checked_sub(1)?;
    Some(sorted[(q * last as f64).round() as usize])
}

/// The pixel position on which a point falls, through the lens where there is one; `None` where it lies behind the camera.
pub(super) fn project(camera: &Camera, point: DVec3) -> Option<DVec2> {
    image_of(camera, camera.c2w.inverse().transform_point3(point))
}

/// The same of a point in the camera's own axes.
pub(super) fn image_of(camera: &Camera, seen: DVec3) -> Option<DVec2> {
    if seen.z <= 0.0 {
        return None;
    }
    Some(match camera.distortion {
        None => camera_to_pixel(&camera.k, seen),
        Some(lens) => camera_to_pixel(&camera.k, lens.distort(seen.truncate() / seen.z).extend(1.0)),
    })
}
