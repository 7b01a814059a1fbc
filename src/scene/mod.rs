//! Scenes: cameras with their photographs, from built-in formulas or from files.
//!
//! Whatever a file's own convention, a [`Scene`] has OpenCV axes (x right, y down, z forward), pixels as intrinsics and colors
//! in [0, 1]. `near` and `far` are distances along unit directions.

use std::borrow::Borrow;
use std::path::Path;

use glam::DVec3;
use serde_json::{Map, Value};

use crate::camera::{Camera, Intrinsics};
use crate::error::{Error, Result};
use crate::parallel;
use crate::random::Key;
use crate::ray::draw_index;

#[cfg(feature = "cli")]
pub(crate) mod aim;
mod border;
pub mod builtin;
mod card;
mod check;
pub mod cloud;
mod colmap;
pub(crate) mod digest;
mod doubts;
mod fields;
mod hint;
mod layout;
mod lens;
mod llff;
mod npz;
pub mod path;
mod pictures;
mod ply;
mod rays;
mod sweep;
mod transforms;

use crate::files::mask::Mask;
pub use crate::files::photo::Photo;
pub use builtin::Medium;
pub use card::card;
pub use cloud::Cloud;
pub use layout::common_focus;
pub use rays::pixel_ray;
#[cfg(feature = "cli")]
pub(crate) use {fields::listed, layout::widest_slope};

/// One camera, with its photograph.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// The picture's path as the scene writes it, or the array and index it comes from.
    pub name: String,
    /// The camera.
    pub camera: Camera,
    /// The photograph; `None` if the scene has only a pose (a film path).
    pub image: Option<Photo>,
}

/// Everything that training and evaluation need to know about a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// Its name, as given to [`load`].
    pub name: String,
    /// Frames to learn from, at least one, all with images.
    pub train: Vec<Frame>,
    /// Frames to measure on, with images.
    pub val: Vec<Frame>,
    /// The film path, in order, or the frames of a test split; may be empty. Images only where [`Options::test_images`] asks for
    /// them and the scene has them.
    pub test: Vec<Frame>,
    /// Where samples start, scene units from the camera.
    pub near: f64,
    /// Where they end.
    pub far: f64,
    /// Whether a caller said so.
    pub far_given: bool,
    /// The color behind everything, red, green, blue in [0, 1]: what transparent pixels were composited over.
    pub background: [f64; 3],
    /// The box that holds everything of interest, lower and upper corner, if the scene states it.
    pub bounds: Option<(DVec3, DVec3)>,
    /// Points of its surfaces, where it has them.
    pub cloud: Option<Cloud>,
    /// The point closest to all cameras' axes; where there is none, the middle of the first camera's view.
    pub focus: DVec3,
    /// Warnings, a sentence each.
    pub warnings: Vec<String>,
    /// The derived values with their reasons, by field, for `run.json`.
    pub reasons: Map<String, Value>,
}

/// What a caller may say about a scene; `None` leaves it to the scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Options {
    /// Where samples start.
    pub near: Option<f64>,
    /// Where they end.
    pub far: Option<f64>,
    /// Every Nth frame, sorted by file_path and from index 0, is for validation where the scene has no split.
    pub holdout: Option<usize>,
    /// The color under transparent pixels (black by default).
    pub background: Option<[f64; 3]>,
    /// N: pictures of one pixel for each square of N x N.
    pub shrink: Option<usize>,
    /// Whether the ray of a pixel goes through the point that its numbers are, as the program assumed that another's weights are from:
    /// half a pixel less to the right and down.
    pub integer_pixels: bool,
    /// Whether photographs of a test split are loaded too; they are many, and only an evaluation on them needs them.
    pub test_images: bool,
}

impl Frame {
    /// Every `n`th pixel of every `n`th row, from the first on: the same rays and the same colors. Of a mask without any of them, all count.
    pub fn thinned(&self, n: usize) -> Frame {
        let Camera { width, height, k: Intrinsics { fx, fy, cx, cy }, .. } = self.camera;
        // The center of pixel i is i + 1/2, in either picture.
        let [cx, cy] = [cx, cy].map(|c| (c - 0.5) / n as f64 + 0.5);
        let k = Intrinsics { fx: fx / n as f64, fy: fy / n as f64, cx, cy };
        let camera = Camera { width: width.div_ceil(n), height: height.div_ceil(n), k, ..self.camera };
        Frame { name: self.name.clone(), camera, image: self.image.as_ref().map(|image| image.thinned(n)) }
    }
}

/// Frame, row and column of a random pixel that isn't masked: from the first three numbers of `ray` in `step`.
pub fn random_pixel<F: Borrow<Frame>>(frames: &[F], key: &Key, step: u64, ray: u64) -> [usize; 3] {
    let [u, v, w, _] = key.four(step, ray);
    let n = draw_index(u, frames.len());
    let frame = frames[n].borrow();
    let camera = &frame.camera;
    let mask = frame.image.as_ref().and_then(Photo::mask);
    let pixel = draw_place(mask, [camera.height, camera.width], [v, w]);
    [n, pixel / camera.width, pixel % camera.width]
}

/// A random pixel of a picture, height and width, by two numbers in [0, 1): its row and its column, or, of those that count, by the first.
#[inline(always)]
pub(crate) fn draw_place(mask: Option<&Mask>, [height, width]: [usize; 2], [v, w]: [f64; 2]) -> usize {
    match mask {
        Some(mask) => mask.of(draw_index(v, mask.count())),
        None => draw_index(v, height) * width + draw_index(w, width),
    }
}

impl Scene {
    /// A scene of which only the name and the background are known yet.
    fn empty(name: &str, options: &Options) -> Scene {
        let mut reasons = Map::new();
        let why = if options.background.is_some() { "given" } else { "black: nothing says otherwise" };
        reasons.insert("background".into(), Value::from(why));
        Scene {
            name: name.into(),
            train: Vec::new(),
            val: Vec::new(),
            test: Vec::new(),
            near: f64::NAN,
            far: f64::NAN,
            far_given: options.far.is_some(),
            background: options.background.unwrap_or([0.0; 3]),
            bounds: None,
            cloud: None,
            focus: DVec3::ZERO,
            warnings: Vec::new(),
            reasons,
        }
    }

    /// Divides frames into training and validation: every Nth, from index 0, in the order they come.
    fn hold_out(&mut self, frames: Vec<Frame>, options: &Options) {
        let n = options.holdout.unwrap_or(8);
        for (i, frame) in frames.into_iter().enumerate() {
            let split = if i % n == 0 { &mut self.val } else { &mut self.train };
            split.push(frame);
        }
        let why = if options.holdout.is_some() { "given" } else { "the scene has no split of its own" };
        self.reasons.insert("val".into(), Value::from(format!("every {n}th frame: {why}")));
    }

    /// A pixel for each square of `n` x `n`: area means, and the cameras that would have taken them, exactly.
    fn shrunk(mut self, n: usize) -> Result<Scene> {
        let (width, height) = self.size();
        let frames = self.train.iter().chain(&self.val).chain(&self.test);
        if let Some(Camera { width, height, .. }) =
            frames.map(|frame| frame.camera).find(|camera| n > camera.width.min(camera.height))
        {
            let expected = format!("at least 1/{}, a pixel of {width}x{height}", width.min(height));
            return Err(Error::usage("scale", format!("1/{n}"), expected));
        }
        let mut frames: Vec<&mut Frame> =
            self.train.iter_mut().chain(&mut self.val).chain(&mut self.test).collect();
        parallel::for_each(&mut frames, |frame| {
            frame.image = frame.image.take().map(|image| image.shrunk(n));
            frame.camera = shrunk(&frame.camera, n);
        });
        let why = format!("given: 1/{n} of {width}x{height}, area means of premultiplied colors");
        self.reasons.insert("scale".into(), Value::from(why));
        Ok(self)
    }

    /// Moves the principal points of all cameras, so that each pixel's ray is the one of so many pixels before.
    fn move_pixels(&mut self, by: f64) {
        for frame in self.train.iter_mut().chain(&mut self.val).chain(&mut self.test) {
            let k = &mut frame.camera.k;
            (k.cx, k.cy) = (k.cx + by, k.cy + by);
        }
    }

    /// Width and height of the first picture, in pixels.
    pub fn size(&self) -> (usize, usize) {
        (self.train[0].camera.width, self.train[0].camera.height)
    }
}

/// The camera whose pixels are `n` x `n` of this one's, from the upper left corner on: the same rays, so all lengths in pixels are an
/// n-th, the principal point's place included, and distortion coefficients stay.
fn shrunk(camera: &Camera, n: usize) -> Camera {
    let Intrinsics { fx, fy, cx, cy } = camera.k;
    let [fx, fy, cx, cy] = [fx, fy, cx, cy].map(|x| x / n as f64);
    Camera { width: camera.width / n, height: camera.height / n, k: Intrinsics { fx, fy, cx, cy }, ..*camera }
}

/// Loads `builtin:NAME`, an `.npz` (CS180 or tiny-NeRF layout, told apart by its arrays), a folder or file of `transforms*.json`, or the folder
/// of a capture with COLMAP's model (`sparse/0`) or LLFF's `poses_bounds.npy`, or a folder of pictures inside one of these.
///
/// # Errors
/// Where anything in the scene isn't what it should be, by file and field.
pub fn load(scene: &str, options: &Options) -> Result<Scene> {
    check::options(options)?;
    let mut scene = read(scene, options)?;
    if let Some(n) = options.shrink.filter(|n| *n > 1) {
        scene = scene.shrunk(n)?;
    }
    if options.integer_pixels {
        scene.move_pixels(0.5);
    }
    rays::leave_out(&mut scene)?;
    Ok(scene)
}

fn read(scene: &str, options: &Options) -> Result<Scene> {
    if let Some(name) = scene.strip_prefix("builtin:") {
        return builtin::load(name, options);
    }
    let path = Path::new(scene);
    let is = |kind: &str| path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(kind));
    if is("npz") {
        return npz::load(path, options);
    }
    if is("json") || has_transforms(path) {
        return transforms::load(path, options);
    }
    if let Some(capture) = colmap::at(path) {
        return colmap::load(&capture, options);
    }
    if let Some(capture) = llff::at(path) {
        return llff::load(&capture, options);
    }
    Err(hint::no_scene(scene))
}

fn has_transforms(folder: &Path) -> bool {
    ["transforms.json", "transforms_train.json"].iter().any(|file| folder.join(file).is_file())
}

/// Whether a folder is a scene by itself.
fn is_folder_of_scene(folder: &Path) -> bool {
    let whole = |capture: pictures::Capture| capture.chosen.is_none();
    has_transforms(folder) || colmap::at(folder).is_some_and(whole) || llff::at(folder).is_some_and(whole)
}
