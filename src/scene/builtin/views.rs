//! Photographs of built-in scenes, taken by the reference renderer.

use glam::{DMat4, DVec3};
use ndarray::Array3;

use super::{Medium, ray_box};
use crate::camera::{Camera, Intrinsics};
use crate::convention::{Delta, Grid, LastDelta, PixelCenter, ProductEps, Rest};
use crate::error::Result;
use crate::math::{cos_pi, sin_pi};
use crate::parallel;
use crate::ray::{Ray, camera_ray, pixel_position};
use crate::sample::{rest_u, sample_along_ray, step_sizes};
use crate::scene::layout::{Backdrop, settle};
use crate::scene::{Frame, Options, Scene};
use crate::volume_rendering::{Rendering, composite_background, volume_render};

/// Width and height of a photograph, in pixels.
const SIZE: usize = 64;
/// Samples per ray, all of them inside the scene's box.
const SAMPLES: usize = 192;
/// Numbers of training and validation views.
const VIEWS: (usize, usize) = (24, 4);
/// Poses of the film.
const FILM: usize = 60;

/// Loads `builtin:NAME`.
pub fn load(name: &str, options: &Options) -> Result<Scene> {
    let medium = Medium::named(name)?;
    let mut scene = Scene::empty(&format!("builtin:{name}"), options);
    scene.bounds = Some(medium.bounds);
    let unseen = |name: String, camera| Frame { name, camera, image: None };
    // Validation views stand between training views: the same spiral, shifted by half a view.
    let spiral =
        |n, i, shift| camera_at(6.0 + 62.0 * (i as f64 + shift) / n as f64, 137.50776 * (i as f64 + shift));
    scene.train = (0..VIEWS.0).map(|i| unseen(format!("train[{i}]"), spiral(VIEWS.0, i, 0.0))).collect();
    scene.val = (0..VIEWS.1).map(|i| unseen(format!("val[{i}]"), spiral(VIEWS.1, i, 0.5))).collect();
    let circle = |i| camera_at(25.0, 360.0 * i as f64 / FILM as f64);
    scene.test = (0..FILM).map(|i| unseen(format!("test[{i}]"), circle(i))).collect();
    let name = scene.name.clone();
    settle(&mut scene, &name, Backdrop::Plain, options)?;
    let background = scene.background;
    let (near, far) = (scene.near, scene.far);
    let mut shown: Vec<&mut Frame> = scene.train.iter_mut().chain(&mut scene.val).collect();
    if options.test_images {
        shown.extend(&mut scene.test);
    }
    for frame in shown {
        frame.image = Some(photograph(&medium, &frame.camera, near, far, background)?);
    }
    Ok(scene)
}

/// A camera 4 from the origin, looking at it; `elevation` above the horizon and `azimuth` in degrees, z up.
fn camera_at(elevation: f64, azimuth: f64) -> Camera {
    let (e, a) = (elevation / 180.0, azimuth / 180.0);
    let away = DVec3::new(cos_pi(e) * cos_pi(a), cos_pi(e) * sin_pi(a), sin_pi(e));
    let right = DVec3::new(-sin_pi(a), cos_pi(a), 0.0);
    let down = right.cross(away);
    let column = |v: DVec3| v.extend(0.0);
    let c2w = DMat4::from_cols(column(right), column(down), column(-away), (4.0 * away).extend(1.0));
    let half = SIZE as f64 / 2.0;
    // 40 degrees across: the box of +-1.2 fills the picture.
    let k = Intrinsics { fx: 2.75 * half, fy: 2.75 * half, cx: half, cy: half };
    Camera { width: SIZE, height: SIZE, k, c2w, distortion: None }
}

/// A picture of every pixel's ray, (H, W, 3).
fn photograph(
    medium: &Medium,
    camera: &Camera,
    near: f64,
    far: f64,
    background: [f64; 3],
) -> Result<Array3<f32>> {
    let rows = parallel::map(camera.height, |j| {
        let mut row = Vec::with_capacity(3 * camera.width);
        for i in 0..camera.width {
            let ray = camera_ray(camera, pixel_position(i, j, PixelCenter::Half))?;
            let seen = render(medium, &ray, near, far, SAMPLES);
            row.extend(composite_background(seen.color, seen.opacity, background).map(|c| c as f32));
        }
        Ok(row)
    });
    let rows: Vec<Vec<f32>> = rows.into_iter().collect::<Result<_>>()?;
    Ok(Array3::from_shape_vec((camera.height, camera.width, 3), rows.concat()).expect("H rows of W colors"))
}

/// A ray between `near` and `far`, rendered by the reference: `samples` in the middles of equal intervals of the part inside the box.
pub fn render(medium: &Medium, ray: &Ray, near: f64, far: f64, samples: usize) -> Rendering {
    let Some((enter, leave)) = ray_box(ray, medium.bounds, near, far) else {
        return volume_render(&[], &[], &[], ProductEps::None);
    };
    let t = sample_along_ray(enter, leave, &vec![rest_u(Rest::Mid); samples], Grid::Intervals);
    let deltas = step_sizes(&t, enter, leave, Delta::Width, LastDelta::Width);
    let points: Vec<DVec3> = t.iter().map(|&t| ray.at(t)).collect();
    let sigmas: Vec<f64> = points.iter().map(|&x| medium.density(x)).collect();
    let rgbs: Vec<[f64; 3]> = points.iter().map(|&x| medium.color(x, ray.d)).collect();
    volume_render(&sigmas, &rgbs, &deltas, ProductEps::None)
}
