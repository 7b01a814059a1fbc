//! Pixels that have a ray. A fisheye's picture often ends inside of the file: beyond the lens' circle there is no ray, and what stands
//! there isn't learned, measured or rendered.

use std::collections::BTreeMap;

use glam::DMat4;

use super::{Frame, Scene};
use crate::camera::{Camera, Lens};
use crate::convention::PixelCenter;
use crate::error::{Error, Input, Result};
use crate::files::mask::Mask;
use crate::parallel;
use crate::ray::{Ray, camera_ray, pixel_position};

/// The ray through the center of the pixel in column `i` and row `j`; `None` beyond a fisheye's circle.
///
/// # Errors
/// Where another lens has no inverse there: such a lens is wrong.
pub fn pixel_ray(camera: &Camera, i: usize, j: usize) -> Result<Option<Ray>> {
    match camera_ray(camera, pixel_position(i, j, PixelCenter::Half)) {
        Err(_) if matches!(camera.distortion, Some(Lens::Fisheye(_))) => Ok(None),
        ray => ray.map(Some),
    }
}

/// Leaves the pixels out that have no ray, beside those that a mask does, and says how many.
///
/// # Errors
/// Where nothing is left of a picture.
pub(super) fn leave_out(scene: &mut Scene) -> Result<()> {
    let (mut known, mut share, mut frames) = (vec![], BTreeMap::new(), 0);
    for frame in scene.train.iter_mut().chain(&mut scene.val).chain(&mut scene.test) {
        if !matches!(frame.camera.distortion, Some(Lens::Fisheye(_))) {
            continue;
        }
        let upright = Camera { c2w: DMat4::IDENTITY, ..frame.camera };
        let lens = known.iter().position(|(camera, _)| *camera == upright).unwrap_or(known.len());
        if lens == known.len() {
            known.push((upright, seen(&upright)?));
        }
        let seen = &known[lens].1;
        let without = seen.iter().filter(|seen| !**seen).count();
        if without > 0 {
            frames += 1;
            share.insert(lens, without as f64 / seen.len() as f64);
            mask(frame, seen, &scene.name)?;
        }
    }
    if let Some(most) = share.into_values().reduce(f64::max) {
        scene.warnings.push(format!(
            "Fisheye: up to {:.1}% of the pixels of {frames} pictures have no ray less than 90 degrees off the axis, and are left out.",
            100.0 * most
        ));
    }
    Ok(())
}

/// Which pixels have a ray.
fn seen(camera: &Camera) -> Result<Vec<bool>> {
    let row = |j: usize| -> Result<Vec<bool>> {
        (0..camera.width).map(|i| Ok(pixel_ray(camera, i, j)?.is_some())).collect()
    };
    Ok(parallel::map(camera.height, row).into_iter().collect::<Result<Vec<_>>>()?.concat())
}

fn mask(frame: &mut Frame, seen: &[bool], scene: &str) -> Result<()> {
    let Some(photo) = frame.image.take() else { return Ok(()) };
    let counts = |n: usize| seen[n] && photo.mask().is_none_or(|mask| mask.counts(n));
    let mask = Mask::new((0..seen.len()).map(counts).collect()).ok_or_else(|| {
        Error::input(Input {
            file: scene,
            field: format!("lens of {}", frame.name),
            found: "no pixel that counts and has a ray",
            expected: "a fisheye that sees something less than 90 degrees off its axis",
            remedy: "Check its coefficients and focal length, and the mask.",
        })
    })?;
    frame.image = Some(photo.masked(mask));
    Ok(())
}
