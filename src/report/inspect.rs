//! A still picture of a scene from outside: cameras with their photographs, rays, samples.

use glam::DVec3;
use image::RgbImage;

use super::canvas::{Canvas, corners};
use crate::camera::Camera;
use crate::ray::Ray;

/// What is drawn.
pub(crate) struct Outside<'a> {
    /// Every camera, with a small version of its photograph.
    pub cameras: &'a [(Camera, RgbImage)],
    /// Rays, each with the positions t of its samples.
    pub rays: &'a [(Ray, Vec<f64>)],
    /// Where the rays end.
    pub far: f64,
    /// The point that the picture is centered on.
    pub focus: DVec3,
}

impl Outside<'_> {
    /// From where everything is seen: eye, target, up.
    pub(crate) fn viewpoint(&self) -> (DVec3, DVec3, DVec3) {
        viewpoint(self)
    }

    /// How far before its camera a photograph is drawn.
    pub(crate) fn depth(&self) -> f64 {
        let (eye, target, _) = viewpoint(self);
        0.04 * (eye - target).length()
    }
}

/// Width and height of the picture.
const SIZE: (usize, usize) = (1200, 900);

const FRUSTUM: [u8; 3] = [60, 70, 80];
const RAY: [u8; 3] = [150, 180, 215];
const SAMPLE: [u8; 3] = [220, 95, 30];

/// Draws frustums in gray, rays in blue, samples in orange.
pub(crate) fn draw(scene: &Outside) -> RgbImage {
    let (eye, target, up) = viewpoint(scene);
    let mut canvas = Canvas::new(SIZE.0, SIZE.1, eye, target, up);
    let depth = scene.depth();
    for (camera, photograph) in scene.cameras {
        let center = camera.c2w.w_axis.truncate();
        let around = corners(camera, depth);
        for k in 0..4 {
            canvas.line(center, around[k], FRUSTUM);
            canvas.line(around[k], around[(k + 1) % 4], FRUSTUM);
        }
        let (w, h) = (f64::from(photograph.width()), f64::from(photograph.height()));
        canvas.photograph(camera, depth, |u, v| photograph[((u * w) as u32, (v * h) as u32)].0);
    }
    for (ray, samples) in scene.rays {
        canvas.line(ray.o, ray.at(scene.far), RAY);
        for &t in samples {
            canvas.point(ray.at(t), 3, SAMPLE);
        }
    }
    canvas.finish()
}

/// A point from which cameras and focus are all seen: to the side of where the cameras stand, and a little higher.
fn viewpoint(scene: &Outside) -> (DVec3, DVec3, DVec3) {
    let centers: Vec<DVec3> = scene.cameras.iter().map(|(camera, _)| camera.c2w.w_axis.truncate()).collect();
    let mut up = DVec3::ZERO;
    for (camera, _) in scene.cameras {
        up -= camera.c2w.y_axis.truncate();
    }
    let up = up.try_normalize().unwrap_or(DVec3::Z);
    let low = centers.iter().fold(scene.focus, |low, c| low.min(*c));
    let high = centers.iter().fold(scene.focus, |high, c| high.max(*c));
    let target = 0.5 * (low + high);
    // From the cameras' side of the focus, turned by 50 degrees about `up`; any level direction where they stand all around.
    let mean = centers.iter().fold(DVec3::ZERO, |sum, c| sum + (*c - scene.focus)) / centers.len() as f64;
    let level = mean - up * mean.dot(up);
    let level =
        if level.length() > 0.1 * mean.length() { level.normalize() } else { up.any_orthonormal_vector() };
    let aside = level * 0.643 + up.cross(level) * 0.766;
    let away = (aside + 0.45 * up).normalize();
    // As near as keeps every camera within 20 degrees (and a third more sideways), with a margin for the frustums.
    let right = up.cross(away).normalize();
    let above = away.cross(right);
    let mut distance: f64 = 1e-6;
    for center in centers.iter().chain([&scene.focus]) {
        let offset = *center - target;
        let aside = offset.dot(above).abs().max(offset.dot(right).abs() * 0.75);
        distance = distance.max(offset.dot(away) + 1.2 * aside / 0.364);
    }
    (target + away * distance, target, up)
}
