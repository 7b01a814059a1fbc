//! Photographs of built-in scenes, taken by the reference renderer.

use glam::{DMat4, DVec3};
use ndarray::Array3;

use super::{Medium, ray_box};
use crate::camera::{Camera, Intrinsics};
use crate::convention::{Delta, Grid, LastDelta, PixelCenter, ProductEps, Rest};
use crate::error::{Error, Result};
use crate::limits;
use crate::math::{cos_pi, sin_pi};
use crate::parallel;
use crate::ray::{Ray, camera_ray, pixel_position};
use crate::sample::{rest_u, sample_along_ray, step_sizes};
use crate::scene::layout::{Backdrop, settle};
use crate::scene::{Frame, Options, Scene};
use crate::volume_rendering::{Rendering, composite_background, volume_render};

/// Samples a ray, all of them inside the scene's box; in pictures larger than [`Shot::default`]'s, which have many rays.
const SAMPLES: [usize; 2] = [192, 64];
/// Photographs to measure on.
const VAL: usize = 4;
/// The part of a picture of 40 degrees, from a distance of 4, that the bodies fill, about.
const FILLED: f64 = 0.27;
/// Poses of the film.
const FILM: usize = 60;

/// How a built-in scene is photographed: `builtin:NAME,size=N,views=N,fill=X`.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Shot {
    /// Width and height in pixels.
    size: usize,
    /// Photographs to learn from.
    views: usize,
    /// Distance of the cameras from the origin.
    distance: f64,
    /// Focal length over half of the size.
    focal: f64,
}

impl Default for Shot {
    fn default() -> Self {
        // 40 degrees across: the box of +-1.2 fills the picture.
        Shot { size: 64, views: 24, distance: 4.0, focal: 2.75 }
    }
}

impl Shot {
    /// From what stands after the name. To fill less of the picture, cameras step back; to fill more, they look closer.
    fn parse(options: &str) -> Result<Shot> {
        let mut shot = Shot::default();
        for option in options.split(',').filter(|option| !option.is_empty()) {
            let wrong = || {
                let expected = "size=4 to 4096, views=1 to 1000, fill=0.001 to 1";
                Error::usage("builtin", option, expected)
            };
            let (name, value) = option.split_once('=').ok_or_else(wrong)?;
            let whole =
                |most| value.parse::<usize>().ok().filter(|n| (1..=most).contains(n)).ok_or_else(wrong);
            match name {
                "size" => shot.size = whole(4096)?.max(4),
                "views" => shot.views = whole(1000)?,
                "fill" => {
                    let fill =
                        value.parse::<f64>().ok().filter(|x| (0.001..=1.0).contains(x)).ok_or_else(wrong)?;
                    let scale = (fill / FILLED).sqrt();
                    (shot.distance, shot.focal) = (4.0 / scale.min(1.0), 2.75 * scale.max(1.0));
                }
                _ => return Err(wrong()),
            }
        }
        Ok(shot)
    }
}

/// Loads `builtin:NAME`.
pub fn load(name: &str, options: &Options) -> Result<Scene> {
    let (body, shot) = name.split_once(',').unwrap_or((name, ""));
    let (medium, shot) = (Medium::named(body)?, Shot::parse(shot)?);
    let mut scene = Scene::empty(&format!("builtin:{name}"), options);
    let pixels = ((shot.views + VAL) * shot.size * shot.size) as f64;
    limits::fits(&scene.name, limits::FINE_PIXEL * pixels, "Choose a smaller size, or fewer views.")?;
    scene.bounds = Some(medium.bounds);
    let unseen = |name: String, camera| Frame { name, camera, image: None };
    // Validation views stand between training views: the same spiral, shifted by half a view.
    let spiral = |n: usize, i: usize, shift: f64| {
        let at = i as f64 + shift;
        shot.camera(6.0 + 62.0 * at / n as f64, 137.50776 * at)
    };
    scene.train =
        (0..shot.views).map(|i| unseen(format!("train[{i}]"), spiral(shot.views, i, 0.0))).collect();
    scene.val = (0..VAL).map(|i| unseen(format!("val[{i}]"), spiral(VAL, i, 0.5))).collect();
    let circle = |i| shot.camera(25.0, 360.0 * i as f64 / FILM as f64);
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
        frame.image = Some(photograph(&medium, &frame.camera, near, far, background)?.into());
    }
    Ok(scene)
}

impl Shot {
    /// A camera that looks at the origin; `elevation` above the horizon and `azimuth` in degrees, z up.
    fn camera(&self, elevation: f64, azimuth: f64) -> Camera {
        let (e, a) = (elevation / 180.0, azimuth / 180.0);
        let away = DVec3::new(cos_pi(e) * cos_pi(a), cos_pi(e) * sin_pi(a), sin_pi(e));
        let right = DVec3::new(-sin_pi(a), cos_pi(a), 0.0);
        let down = right.cross(away);
        let column = |v: DVec3| v.extend(0.0);
        let place = (self.distance * away).extend(1.0);
        let c2w = DMat4::from_cols(column(right), column(down), column(-away), place);
        let half = self.size as f64 / 2.0;
        let k = Intrinsics { fx: self.focal * half, fy: self.focal * half, cx: half, cy: half };
        Camera { width: self.size, height: self.size, k, c2w, distortion: None }
    }
}

/// A picture of every pixel's ray, (H, W, 3).
fn photograph(
    medium: &Medium,
    camera: &Camera,
    near: f64,
    far: f64,
    background: [f64; 3],
) -> Result<Array3<f32>> {
    let samples = SAMPLES[usize::from(camera.width > Shot::default().size)];
    let rows = parallel::map(camera.height, |j| {
        let mut row = Vec::with_capacity(3 * camera.width);
        for i in 0..camera.width {
            let ray = camera_ray(camera, pixel_position(i, j, PixelCenter::Half))?;
            // Nothing on the way: no need to look for it.
            let empty = medium.optical_depth(&ray, near, far) == 0.0;
            let seen = render(medium, &ray, near, far, if empty { 0 } else { samples });
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shot_has_the_size_the_views_and_the_fill_it_is_asked_for() {
        let plain = load("spheres", &Options::default()).unwrap();
        let filled = |scene: &Scene| {
            let pixels = scene
                .train
                .iter()
                .flat_map(|frame| frame.image.as_ref().unwrap().colors())
                .map(|c| c.iter().sum::<f32>() > 0.05);
            let (count, lit) = pixels.fold((0, 0), |(n, m), lit| (n + 1, m + usize::from(lit)));
            lit as f64 / count as f64
        };
        assert!((filled(&plain) / FILLED - 1.0).abs() < 0.25, "{}", filled(&plain));
        for fill in [0.05, 0.5, 1.0] {
            let scene = load(&format!("spheres,size=24,views=5,fill={fill}"), &Options::default()).unwrap();
            assert_eq!((scene.size(), scene.train.len(), scene.val.len()), ((24, 24), 5, 4));
            assert!((filled(&scene) / fill - 1.0).abs() < 0.4, "{} for {fill}", filled(&scene));
        }
        for wrong in
            ["spheres,size=0", "spheres,fill=2", "spheres,large", "spheres,views=x", "nothing,size=9"]
        {
            assert!(load(wrong, &Options::default()).is_err(), "{wrong}");
        }
    }
}
