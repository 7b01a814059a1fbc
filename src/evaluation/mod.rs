//! Evaluation: whole pictures from a trained field, and how far they are from photographs.

use std::ops::Range;

use glam::DVec2;
use ndarray::{Array2, Array3, ArrayView3};

use crate::camera::Camera;
use crate::convention::Directions;
use crate::error::Result;
use crate::files::mask::Mask;
use crate::loss::{mse, psnr};
use crate::parallel;
use crate::ray::{Ray, camera_ray};
use crate::scene::{Frame, Photo, pixel_ray};
use crate::ssim::fast::ssim;
use crate::training::{Model, Pixel};

/// Pixels of whole rows that are rendered together: work for all threads, and little memory beside the picture.
const TOGETHER: usize = 1 << 17;

/// A rendered view.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// (H, W, 3), over the background.
    pub rgb: Array3<f32>,
    /// (H, W): A.
    pub opacity: Array2<f32>,
    /// (H, W): expected distance.
    pub depth: Array2<f32>,
}

/// The rays of all pixel centers of a camera, row by row.
///
/// # Errors
/// Where the lens has no inverse at some pixel.
pub fn camera_rays(camera: &Camera) -> Result<Vec<Ray>> {
    let row = |j: usize| -> Result<Vec<Ray>> {
        (0..camera.width).map(|i| camera_ray(camera, DVec2::new(i as f64 + 0.5, j as f64 + 0.5))).collect()
    };
    let rows: Result<Vec<_>> = parallel::map(camera.height, row).into_iter().collect();
    Ok(rows?.concat())
}

/// The rays of some rows' pixels, row by row; `None` beyond a fisheye's circle.
fn rows_rays(camera: &Camera, rows: Range<usize>) -> Result<Vec<Option<Ray>>> {
    let row = |j: usize| -> Result<Vec<_>> {
        (0..camera.width).map(|i| pixel_ray(camera, i, rows.start + j)).collect()
    };
    let rows: Result<Vec<_>> = parallel::map(rows.len(), row).into_iter().collect();
    Ok(rows?.concat())
}

/// The rays of those pixels that have one.
///
/// # Errors
/// Where the lens has no inverse at some pixel, other than beyond a fisheye's circle.
#[cfg(feature = "cli")]
pub(crate) fn seen_rays(camera: &Camera) -> Result<Vec<Ray>> {
    Ok(rows_rays(camera, 0..camera.height)?.into_iter().flatten().collect())
}

/// A view over `background`, which is all that is seen beyond a fisheye's circle.
///
/// # Errors
/// Where the lens has no inverse at some pixel.
pub fn render_view(model: &dyn Model, camera: &Camera, background: [f32; 3]) -> Result<View> {
    let axis = camera.c2w.z_axis.truncate();
    let (h, w) = (camera.height, camera.width);
    let mut pixels: Vec<Pixel> = Vec::with_capacity(h * w);
    let rows = (TOGETHER / w.max(1)).max(1);
    for first in (0..h).step_by(rows) {
        let rays = rows_rays(camera, first..h.min(first + rows))?;
        let seen = rays.iter().copied().flatten().map(|ray| match model.directions() {
            Directions::Depth => Ray { d: ray.d / ray.d.dot(axis), ..ray },
            _ => ray,
        });
        let seen: Vec<Ray> = seen.collect();
        let mut seen = model.render(&seen).into_iter();
        pixels.extend(rays.iter().map(|ray| ray.and_then(|_| seen.next()).unwrap_or_default()));
    }
    let at = |j: usize, i: usize| pixels[j * w + i];
    let rgb = Array3::from_shape_fn((h, w, 3), |(j, i, k)| over(at(j, i), background)[k]);
    let opacity = Array2::from_shape_fn((h, w), |(j, i)| at(j, i).opacity);
    let depth = Array2::from_shape_fn((h, w), |(j, i)| at(j, i).depth);
    Ok(View { rgb, opacity, depth })
}

/// A pixel over a background.
pub fn over(pixel: Pixel, background: [f32; 3]) -> [f32; 3] {
    std::array::from_fn(|k| pixel.rgb[k] + (1.0 - pixel.opacity) * background[k])
}

/// How well one view agrees with its photograph.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct ViewScore {
    /// The frame's name.
    pub name: String,
    /// Mean squared error over pixels and channels, the view clipped to [0, 1] and not quantized.
    pub mse: f64,
    /// Its PSNR in dB, peak 1; null in JSON where it is infinite.
    pub psnr: f64,
    /// SSIM, Gaussian window 11, sigma 1.5; absent for pictures below 11 pixels.
    pub ssim: Option<f64>,
}

/// Scores over a set of views.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Scores {
    /// Mean of the views' PSNRs.
    pub psnr: f64,
    /// PSNR of the mean squared error over all views.
    pub psnr_pooled: f64,
    /// Mean of the views' SSIMs.
    pub ssim: Option<f64>,
    /// View by view.
    pub views: Vec<ViewScore>,
}

/// Renders all frames that have a picture and scores them; `seen` gets each view. SSIM only if `with_ssim`.
///
/// # Errors
/// Where the lens has no inverse at some pixel.
pub fn evaluate<'a>(
    model: &dyn Model,
    frames: impl IntoIterator<Item = &'a Frame>,
    background: [f32; 3],
    with_ssim: bool,
    mut seen: impl FnMut(&Frame, &View) -> Result<()>,
) -> Result<Scores> {
    let mut views = vec![];
    for frame in frames {
        let Some(image) = &frame.image else { continue };
        let view = render_view(model, &frame.camera, background)?;
        views.push(score_photo(&frame.name, &view.rgb, image, with_ssim));
        seen(frame, &view)?;
    }
    Ok(summary(views))
}

/// One view's figures, of the pixels of its photograph that count.
pub fn score_photo(name: &str, view: &Array3<f32>, photo: &Photo, with_ssim: bool) -> ViewScore {
    let image = photo.to_array();
    match photo.mask() {
        None => score(name, view.view(), image.view(), with_ssim),
        Some(mask) => masked_score(name, view.clone(), image.view(), mask, with_ssim),
    }
}

/// One view's figures, of all pixels.
pub fn score(name: &str, view: ArrayView3<f32>, image: ArrayView3<f32>, with_ssim: bool) -> ViewScore {
    let view = view.mapv(|x| f64::from(x.clamp(0.0, 1.0)));
    let image = image.mapv(f64::from);
    let error = {
        let (view, image) = (view.as_standard_layout(), image.as_standard_layout());
        let values = "standard layout is one slice";
        mse(view.as_slice().expect(values), image.as_slice().expect(values))
    };
    let large = view.dim().0.min(view.dim().1) >= 11;
    let ssim = (with_ssim && large).then(|| ssim(view.view(), image.view(), 1.0));
    ViewScore { name: name.into(), mse: error, psnr: psnr(error, 1.0), ssim }
}

/// The same of the pixels that count: the others are no error, in the MSE as if they weren't there, in the SSIM as if they were right.
fn masked_score(
    name: &str,
    mut view: Array3<f32>,
    image: ArrayView3<f32>,
    mask: &Mask,
    with_ssim: bool,
) -> ViewScore {
    let width = view.dim().1;
    for n in (0..mask.len()).filter(|&n| !mask.counts(n)) {
        (0..3).for_each(|k| view[[n / width, n % width, k]] = image[[n / width, n % width, k]]);
    }
    let score = score(name, view.view(), image, with_ssim);
    let mse = score.mse * mask.len() as f64 / mask.count() as f64;
    ViewScore { mse, psnr: psnr(mse, 1.0), ..score }
}

/// The scores of all views together.
pub fn summary(views: Vec<ViewScore>) -> Scores {
    let mean = |f: &dyn Fn(&ViewScore) -> f64| views.iter().map(f).sum::<f64>() / views.len() as f64;
    let ssim = views.iter().all(|v| v.ssim.is_some()).then(|| mean(&|v| v.ssim.unwrap_or(0.0)));
    let (of_images, pooled) = (mean(&|v| v.psnr), psnr(mean(&|v| v.mse), 1.0));
    Scores { psnr: of_images, psnr_pooled: pooled, ssim, views }
}
