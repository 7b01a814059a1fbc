//! The training pictures, laid out for drawing single pixels: colors, and directions, from a table where pictures share a lens.

use glam::{DMat4, DVec3};

use super::settings::CompactSettings;
use crate::camera::Camera;
use crate::error::{Error, Input, Result};
use crate::parallel;
use crate::random::Key;
use crate::ray::{Ray, draw_index};
use crate::scene::{Photo, Scene, draw_place, pixel_ray};

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

/// What a training pixel shows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Target {
    /// Its color over what lies behind it; over black where that is anything.
    pub color: [f32; 3],
    pub behind: Behind,
}

impl Target {
    /// Black, over black: for pixels that nothing is held against.
    pub(crate) const NOTHING: Target = Target { color: [0.0; 3], behind: Behind::Color([0.0; 3]) };
}

/// What lies behind a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Behind {
    Color([f32; 3]),
    /// All backgrounds at once count; the pixel lets so much of their light through.
    Anything {
        clear: f32,
    },
}

struct View {
    origin: [f32; 3],
    /// Row r: component r of the scene's direction from the camera's.
    rotation: [[f32; 3]; 3],
    colors: Photo,
    /// Whether its rays are learned over any background.
    any_background: bool,
    lens: usize,
    /// Width and height.
    size: [usize; 2],
}

/// Directions through the pixels of a camera that stands upright in the origin.
enum Lens {
    /// All of them: several pictures share it.
    Shared(Vec<[f32; 3]>),
    /// One by one: a table would take four times what its only picture takes.
    Alone(Box<Camera>),
}

/// All training pixels.
pub(super) struct Views {
    views: Vec<View>,
    lenses: Vec<Lens>,
    /// Pixels of the largest picture: pixel i of picture v is number v times this + i.
    pixels: usize,
    inverse_size: f32,
    /// The scene's.
    background: [f32; 3],
}

impl Views {
    /// The training frames of a scene.
    ///
    /// # Errors
    /// Where a lens has no inverse at some pixel that is tried (of a picture's own lens every 16th), or there are more pixels than can be numbered.
    pub(super) fn new(scene: &Scene, settings: &CompactSettings) -> Result<Self> {
        let upright = |camera: &Camera| Camera { c2w: DMat4::IDENTITY, ..*camera };
        let cameras: Vec<Camera> = scene.train.iter().map(|frame| upright(&frame.camera)).collect();
        let mut known: Vec<Camera> = vec![];
        let (mut lenses, mut views) = (vec![], vec![]);
        for (frame, camera) in scene.train.iter().zip(&cameras) {
            let lens = known.iter().position(|known| known == camera).unwrap_or(known.len());
            if lens == known.len() {
                known.push(*camera);
                let shared = cameras.iter().filter(|other| *other == camera).count() > 1;
                lenses.push(if shared { Lens::shared(camera) } else { Lens::alone(camera) }?);
            }
            let colors = frame.image.clone().expect("training frames have pictures");
            let pose = &frame.camera.c2w;
            let origin = (pose.w_axis.truncate() - settings.low) / settings.size;
            let rotation = std::array::from_fn(|r| std::array::from_fn(|c| pose.col(c)[r] as f32));
            let any_background = colors.keeps_opacity() && settings.any_background;
            views.push(View {
                any_background,
                origin: origin.to_array().map(|x| x as f32),
                rotation,
                colors,
                lens,
                size: [camera.width, camera.height],
            });
        }
        let pixels = views.iter().map(|view| view.size[0] * view.size[1]).max().unwrap_or(0);
        if views.len() * pixels > u32::MAX as usize {
            let found = format!("{} pictures of up to {pixels} pixels", views.len());
            let (expected, remedy) = ("at most 2^32 pixels in all", "Make the pictures smaller (`scale`).");
            return Err(Error::input(Input {
                file: &scene.name,
                field: "pictures",
                found,
                expected,
                remedy,
            }));
        }
        Ok(Views {
            views,
            lenses,
            pixels,
            inverse_size: (1.0 / settings.size) as f32,
            background: settings.background.map(|b| b as f32),
        })
    }

    /// Whether there is a pixel of this number.
    pub(super) fn has(&self, n: usize) -> bool {
        self.views.get(n / self.pixels).is_some_and(|view| n % self.pixels < view.colors.len())
    }

    /// A random pixel of all: picture, row and column from the first three numbers of `ray` in `step`.
    #[inline(always)]
    pub(super) fn draw(&self, key: &Key, step: u64, ray: u64) -> usize {
        let [u, v, w, _] = key.four(step, ray);
        let n = draw_index(u, self.views.len());
        let View { colors, size: [width, height], .. } = &self.views[n];
        n * self.pixels + draw_place(colors.mask(), [*height, *width], [v, w])
    }

    /// Number of pictures.
    pub(super) fn count(&self) -> usize {
        self.views.len()
    }

    /// Rays all over a picture, its border included: about so many along each side; none where there are none.
    pub(super) fn lattice(&self, view: usize, lines: usize) -> impl Iterator<Item = BoxRay> {
        let [width, height] = self.views[view].size;
        let along = move |n: usize| (0..n).step_by(n.div_ceil(lines)).chain([n - 1]);
        let pixels = along(height).flat_map(move |j| along(width).map(move |i| j * width + i));
        let rays = pixels.map(move |pixel| self.ray(view * self.pixels + pixel));
        rays.filter(|ray| ray.unit != [0.0; 3])
    }

    /// What pixel `n` of all shows: over all backgrounds where the picture's opacity is known, so that nothing but an empty ray is right,
    /// over the scene's where it isn't.
    #[inline(always)]
    pub(super) fn target(&self, n: usize) -> Target {
        let (View { colors, any_background, .. }, pixel) = (&self.views[n / self.pixels], n % self.pixels);
        if *any_background {
            let [color, white] = [0.0, 1.0].map(|background| colors.pixel_over(pixel, [background; 3]));
            return Target { color, behind: Behind::Anything { clear: white[0] - color[0] } };
        }
        let color = colors.pixel_over(pixel, self.background);
        Target { color, behind: Behind::Color(self.background) }
    }

    /// The ray of pixel `n` of all.
    #[inline(always)]
    pub(super) fn ray(&self, n: usize) -> BoxRay {
        let (view, pixel) = (&self.views[n / self.pixels], n % self.pixels);
        let c = self.lenses[view.lens].direction(pixel);
        let unit = view.rotation.map(|r| r[0] * c[0] + r[1] * c[1] + r[2] * c[2]);
        BoxRay { o: view.origin, d: unit.map(|x| x * self.inverse_size), unit }
    }
}

impl Lens {
    fn shared(camera: &Camera) -> Result<Lens> {
        let row = |j: usize| -> Result<Vec<_>> {
            (0..camera.width).map(|i| Ok(direction(pixel_ray(camera, i, j)?))).collect()
        };
        let rows: Result<Vec<_>> = parallel::map(camera.height, row).into_iter().collect();
        Ok(Lens::Shared(rows?.concat()))
    }

    /// Every 16th pixel of every 16th row, and the last ones, stand for all: a lens that folds over does so over more of the picture.
    fn alone(camera: &Camera) -> Result<Lens> {
        let along = |n: usize| (0..n).step_by(16).chain([n - 1]);
        for (j, i) in along(camera.height).flat_map(|j| along(camera.width).map(move |i| (j, i))) {
            pixel_ray(camera, i, j)?;
        }
        Ok(Lens::Alone(Box::new(*camera)))
    }

    #[inline(always)]
    fn direction(&self, pixel: usize) -> [f32; 3] {
        match self {
            Lens::Shared(directions) => directions[pixel],
            Lens::Alone(camera) => {
                direction(pixel_ray(camera, pixel % camera.width, pixel / camera.width).ok().flatten())
            }
        }
    }
}

/// A ray's direction; 0 where there is none, at pixels that are never drawn.
fn direction(ray: Option<Ray>) -> [f32; 3] {
    ray.map_or(DVec3::ZERO, |ray| ray.d).to_array().map(|x| x as f32)
}
