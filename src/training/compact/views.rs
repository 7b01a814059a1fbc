//! The training pictures, laid out for drawing single pixels: colors, and directions from one table per lens.

use glam::{DMat4, DVec3};

use super::settings::CompactSettings;
use crate::camera::{Camera, Distortion, Intrinsics};
use crate::error::Result;
use crate::evaluation::camera_rays;
use crate::random::Key;
use crate::ray::{Ray, draw_index};
use crate::scene::{Photo, Scene};

/// A ray in units of the box.
#[derive(Clone, Copy, Debug)]
pub(super) struct BoxRay {
    /// Origin; the box is [0, 1]^3.
    pub o: [f32; 3],
    /// Direction, so that t keeps the scene's unit.
    pub d: [f32; 3],
    /// Unit direction in the scene.
    pub unit: [f32; 3],
}

impl BoxRay {
    /// A ray of the scene in units of the box.
    pub(super) fn new(ray: &Ray, settings: &CompactSettings) -> Self {
        let f32s = |v: DVec3| v.to_array().map(|x| x as f32);
        BoxRay {
            o: f32s((ray.o - settings.low) / settings.size),
            d: f32s(ray.d / settings.size),
            unit: f32s(ray.d.normalize()),
        }
    }
}

struct View {
    origin: [f32; 3],
    /// Row r: component r of the scene's direction from the camera's.
    rotation: [[f32; 3]; 3],
    colors: Photo,
    /// Whether its rays are learned over any background.
    any_background: bool,
    lens: usize,
}

/// All training pixels.
pub(super) struct Views {
    views: Vec<View>,
    lenses: Vec<Vec<[f32; 3]>>,
    /// Width and height of a picture.
    size: [usize; 2],
    pixels: usize,
    inverse_size: f32,
    /// The scene's.
    background: [f32; 3],
}

impl Views {
    /// The training frames of a scene.
    ///
    /// # Errors
    /// Where a lens has no inverse at some pixel.
    pub(super) fn new(scene: &Scene, settings: &CompactSettings) -> Result<Self> {
        let mut known: Vec<(Intrinsics, Option<Distortion>)> = vec![];
        let (mut lenses, mut views) = (vec![], vec![]);
        for frame in &scene.train {
            let camera = &frame.camera;
            let lens = known.iter().position(|k| *k == (camera.k, camera.distortion)).unwrap_or(known.len());
            if lens == known.len() {
                known.push((camera.k, camera.distortion));
                let upright = Camera { c2w: DMat4::IDENTITY, ..*camera };
                lenses.push(
                    camera_rays(&upright)?.iter().map(|ray| ray.d.to_array().map(|x| x as f32)).collect(),
                );
            }
            let colors = frame.image.clone().expect("training frames have pictures");
            let origin = (camera.c2w.w_axis.truncate() - settings.low) / settings.size;
            let rotation = std::array::from_fn(|r| std::array::from_fn(|c| camera.c2w.col(c)[r] as f32));
            let any_background = colors.keeps_opacity() && settings.any_background;
            views.push(View {
                any_background,
                origin: origin.to_array().map(|x| x as f32),
                rotation,
                colors,
                lens,
            });
        }
        let (width, height) = scene.size();
        Ok(Views {
            views,
            lenses,
            size: [width, height],
            pixels: width * height,
            inverse_size: (1.0 / settings.size) as f32,
            background: settings.background.map(|b| b as f32),
        })
    }

    /// Pixels of all pictures.
    pub(super) fn len(&self) -> usize {
        self.views.len() * self.pixels
    }

    /// A random pixel of all: picture, row and column from the first three numbers of `ray` in `step`.
    #[inline(always)]
    pub(super) fn draw(&self, key: &Key, step: u64, ray: u64) -> usize {
        let ([u, v, w, _], [width, height]) = (key.four(step, ray), self.size);
        (draw_index(u, self.views.len()) * height + draw_index(v, height)) * width + draw_index(w, width)
    }

    /// Number of pictures.
    pub(super) fn count(&self) -> usize {
        self.views.len()
    }

    /// Rays all over a picture, its border included: about so many along each side.
    pub(super) fn lattice(&self, view: usize, lines: usize) -> impl Iterator<Item = BoxRay> {
        let [width, height] = self.size;
        let along = move |n: usize| (0..n).step_by(n.div_ceil(lines)).chain([n - 1]);
        let pixels = along(height).flat_map(move |j| along(width).map(move |i| j * width + i));
        pixels.map(move |pixel| self.ray(view * self.pixels + pixel))
    }

    /// The color of pixel `n` of all and the background that it is seen over: `drawn` where the picture's opacity is known, so that
    /// nothing but an empty ray has the right color, the scene's where it isn't.
    #[inline(always)]
    pub(super) fn color(&self, n: usize, drawn: [f32; 3]) -> [[f32; 3]; 2] {
        let view = &self.views[n / self.pixels];
        let background = if view.any_background { drawn } else { self.background };
        [view.colors.pixel_over(n % self.pixels, background), background]
    }

    /// The ray of pixel `n` of all.
    #[inline(always)]
    pub(super) fn ray(&self, n: usize) -> BoxRay {
        let (view, pixel) = (&self.views[n / self.pixels], n % self.pixels);
        let c = self.lenses[view.lens][pixel];
        let unit = view.rotation.map(|r| r[0] * c[0] + r[1] * c[1] + r[2] * c[2]);
        BoxRay { o: view.origin, d: unit.map(|x| x * self.inverse_size), unit }
    }
}
