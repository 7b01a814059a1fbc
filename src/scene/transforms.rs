//! Scenes as `transforms*.json`: Blender's (one angle, a file a split) and instant-ngp's or nerfstudio's (intrinsics in pixels).

use std::path::{Path, PathBuf};

use glam::DVec3;
use serde_json::Value;

use super::fields::{self, listed};
use super::layout::{Backdrop, settle};
use super::lens::{intrinsics, lens, stated_size};
use super::{Cloud, Frame, Options, Photo, Scene, check, pictures, ply};
use crate::camera::Camera;
use crate::error::{Error, Input, Result};
use crate::files::{self, json};
use crate::parallel;

/// One parsed file.
pub(super) struct Transforms {
    /// Where it lies.
    pub path: PathBuf,
    /// All of it: an object whose fields hold what they may.
    pub json: Value,
    /// Fields that aren't used, which [`fields`] tells.
    unused: Vec<String>,
}

impl Transforms {
    fn read(path: &Path) -> Result<Transforms> {
        let text = files::read_text(path)?;
        let wrong = |found: String| {
            let remedy = "Write it again with instant-ngp's, nerfstudio's or Blender's exporter.";
            let (file, expected) = (path.display(), "a whole transforms.json, one object");
            Error::input(Input { file, field: "JSON", found, expected, remedy })
        };
        // Some editors begin a text with a byte order mark.
        let text = text.trim_start_matches('\u{feff}');
        let json = json::parse(text).map_err(|error| wrong(error.to_string()))?;
        let object = json.as_object().ok_or_else(|| wrong(json::short(&json)))?;
        let (file, mut unused) = (path.display().to_string(), vec![]);
        fields::check(&file, "", object, &["frames"], &mut unused)?;
        for frame in object.get("frames").and_then(Value::as_array).into_iter().flatten() {
            let of = match frame["file_path"].as_str() {
                Some(name) => format!(" of {name}"),
                None => String::new(),
            };
            let own = ["file_path", "transform_matrix"];
            frame.as_object().map_or(Ok(()), |frame| fields::check(&file, &of, frame, &own, &mut unused))?;
        }
        Ok(Transforms { path: path.to_path_buf(), json, unused })
    }

    /// The file's name for messages.
    pub(super) fn file(&self) -> String {
        self.path.display().to_string()
    }

    /// The frames, sorted by `file_path`.
    fn frames(&self) -> Result<Vec<(&str, &Value)>> {
        let remedy = "Check which program wrote the file.";
        let Some(frames) = self.json["frames"].as_array().filter(|frames| !frames.is_empty()) else {
            return Err(Error::input(Input {
                file: self.file(),
                field: "frames",
                found: "none",
                expected: "a list of frames",
                remedy,
            }));
        };
        let mut named = Vec::with_capacity(frames.len());
        for (i, frame) in frames.iter().enumerate() {
            let Some(name) = frame["file_path"].as_str().filter(|name| !name.is_empty()) else {
                let field = format!("frames[{i}].file_path");
                return Err(Error::input(Input {
                    file: self.file(),
                    field,
                    found: json::short(&frame["file_path"]),
                    expected: "a path",
                    remedy,
                }));
            };
            named.push((name, frame));
        }
        named.sort_by_key(|(name, _)| *name);
        Ok(named)
    }

    /// Whether any frame has its picture.
    fn any_picture(&self) -> Result<bool> {
        Ok(self.frames()?.iter().any(|(name, _)| self.picture(name).is_some()))
    }

    /// The picture of a frame: beside the file, or in `images` there; with any ending where the path has none (Blender), with Windows'
    /// separators too. A path from another machine's root is looked for by its last part. `None` where it isn't there.
    fn picture(&self, name: &str) -> Option<PathBuf> {
        let folder = self.path.parent().unwrap_or(Path::new(""));
        let find = |name: &str| {
            pictures::file(folder, name).or_else(|| pictures::file(&folder.join("images"), name))
        };
        let slashes = name.replace('\\', "/");
        let rooted = slashes.starts_with('/') || slashes.as_bytes().get(1) == Some(&b':');
        let last = slashes.rsplit('/').next().filter(|_| rooted);
        find(name).or_else(|| find(&slashes)).or_else(|| last.and_then(find))
    }
}

/// Reads a folder with `transforms_train.json` (and `_val`, `_test`) or `transforms.json`, or one such file.
pub(super) fn load(path: &Path, options: &Options) -> Result<Scene> {
    let split = |name: &str| path.join(format!("transforms_{name}.json"));
    if path.is_dir() && split("train").is_file() {
        return splits(path, split("train"), split("val"), split("test"), options);
    }
    let file = if path.is_dir() { path.join("transforms.json") } else { path.to_path_buf() };
    let transforms = Transforms::read(&file)?;
    let mut scene = Scene::empty(&path.display().to_string(), options);
    let mut reader = Reader { scene: &mut scene, seen_through: false, size: None };
    let frames = reader.frames(&transforms, true)?;
    let backdrop = reader.backdrop();
    scene.hold_out(frames, options);
    scene.bounds = ngp_box(&transforms, &mut scene);
    scene.cloud = points(&transforms, &mut scene)?;
    finish(scene, &transforms.file(), backdrop, options)
}

/// Blender's three files. Without a validation split, a test split with pictures is what is measured on, and all training frames are
/// learned from; without that, or where `--holdout` asks for it, frames of the training split are held out.
fn splits(folder: &Path, train: PathBuf, val: PathBuf, test: PathBuf, options: &Options) -> Result<Scene> {
    let mut scene = Scene::empty(&folder.display().to_string(), options);
    let mut reader = Reader { scene: &mut scene, seen_through: false, size: None };
    let train_frames = reader.frames(&Transforms::read(&train)?, true)?;
    let mut val_frames = Vec::new();
    if val.is_file() {
        val_frames = reader.frames(&Transforms::read(&val)?, true)?;
    }
    let mut test_frames = Vec::new();
    let mut measured = false;
    if test.is_file() {
        let test = Transforms::read(&test)?;
        measured = val_frames.is_empty() && options.holdout.is_none() && test.any_picture()?;
        test_frames = reader.frames(&test, options.test_images || measured)?;
    }
    let backdrop = reader.backdrop();
    scene.test = test_frames;
    if measured {
        scene.train = train_frames;
        scene.val.clone_from(&scene.test);
        if !options.test_images {
            scene.test.iter_mut().for_each(|frame| frame.image = None);
        }
        let why = format!("the {} test frames: the scene has no validation split", scene.val.len());
        scene.warnings.push(format!(
            "Validation is on {why}. All {} training frames are learned from.",
            scene.train.len()
        ));
        scene.reasons.insert("val".into(), Value::from(why));
    } else if val_frames.is_empty() {
        scene.hold_out(train_frames, options);
    } else {
        scene.train = train_frames;
        scene.val = val_frames;
        scene.reasons.insert("val".into(), Value::from("the scene's own split"));
        if options.holdout.is_some() {
            scene.warnings.push("holdout is not used: the scene has a validation split of its own.".into());
        }
    }
    finish(scene, &train.display().to_string(), backdrop, options)
}

fn finish(mut scene: Scene, file: &str, backdrop: Backdrop, options: &Options) -> Result<Scene> {
    check::frames(file, &scene.train, &scene.val)?;
    settle(&mut scene, file, backdrop, options)?;
    Ok(scene)
}

/// Reads frames into a scene's warnings and background.
struct Reader<'a> {
    scene: &'a mut Scene,
    /// Whether any picture had transparent pixels.
    seen_through: bool,
    /// The size of the last picture: that of poses without one.
    size: Option<(usize, usize)>,
}

impl Reader<'_> {
    /// Every frame of a file; those whose picture is missing are named in a warning and left out.
    fn frames(&mut self, transforms: &Transforms, images: bool) -> Result<Vec<Frame>> {
        let named = transforms.frames()?;
        if !transforms.unused.is_empty() {
            let names = listed(&transforms.unused);
            self.scene.warnings.push(format!("{}: fields that are not used: {names}.", transforms.file()));
        }
        let paths: Vec<Option<PathBuf>> =
            if images { named.iter().map(|(name, _)| transforms.picture(name)).collect() } else { vec![] };
        let file = transforms.file();
        let stated: Vec<_> = named.iter().map(|(_, frame)| stated_size(transforms, frame)).collect();
        let photos = pictures::read(&file, &paths, &stated, self.scene.background)?;
        let mut photos = masked(transforms, &named, photos)?.into_iter();
        let (mut frames, mut missing) = (Vec::with_capacity(named.len()), Vec::new());
        for &(name, value) in &named {
            match photos.next() {
                Some(None) => missing.push(name),
                Some(photo) => frames.push(self.frame(transforms, name, value, photo)?),
                None => frames.push(self.frame(transforms, name, value, None)?),
            }
        }
        let remedy = "Paths are taken from the folder that the file lies in.";
        pictures::missing(&file, &missing, named.len(), remedy, self.scene)?;
        Ok(frames)
    }

    /// One frame: pose, intrinsics (its own before the file's), picture over the background.
    fn frame(
        &mut self,
        transforms: &Transforms,
        name: &str,
        value: &Value,
        image: Option<Photo>,
    ) -> Result<Frame> {
        let file = transforms.file();
        let field = format!("transform_matrix of {name}");
        let Some(matrix) = check::matrix(&value["transform_matrix"]) else {
            let remedy = "Every frame needs its camera-to-world pose.";
            return Err(Error::input(Input {
                file,
                field,
                found: "no matrix",
                expected: "four rows of four numbers, or the first three of them",
                remedy,
            }));
        };
        let c2w = check::opengl_to_opencv(check::pose(&file, &field, check::whole(matrix).view())?);
        if let Some(photo) = &image {
            let (height, width) = photo.size();
            self.size = Some((width, height));
            self.seen_through |= photo.seen_through();
        }
        let (width, height, k) = intrinsics(transforms, name, value, self.size)?;
        let distortion = lens(transforms, name, value)?;
        Ok(Frame { name: name.into(), camera: Camera { width, height, k, c2w, distortion }, image })
    }

    /// With transparent pixels, the background of a cut-out object; without, that of a photograph.
    fn backdrop(&mut self) -> Backdrop {
        if !self.seen_through {
            return Backdrop::World;
        }
        let background = self.scene.background;
        let why = self.scene.reasons.get("background").and_then(Value::as_str).unwrap_or_default();
        let why = format!("{why}; transparent pixels were composited over {background:?}");
        self.scene.reasons.insert("background".into(), Value::from(why));
        Backdrop::Plain
    }
}

/// The pictures, each with the frame's `mask_path` where it has one.
fn masked(
    transforms: &Transforms,
    named: &[(&str, &Value)],
    photos: Vec<Option<Photo>>,
) -> Result<Vec<Option<Photo>>> {
    let folder = transforms.path.parent().unwrap_or(Path::new(""));
    let one = |n: usize| {
        let Some((photo, mask)) = photos[n].clone().zip(named[n].1["mask_path"].as_str()) else {
            return Ok(photos[n].clone());
        };
        let path = pictures::file(folder, mask).ok_or_else(|| {
            Error::input(Input {
                file: transforms.file(),
                field: format!("mask_path of {}", named[n].0),
                found: format!("{mask:?}, where nothing is"),
                expected: "a mask",
                remedy: "Paths are taken from the folder that the file lies in.",
            })
        })?;
        pictures::masked(photo, &path).map(Some)
    };
    parallel::map(photos.len(), one).into_iter().collect()
}

/// The points of `ply_file_path`, if the file is there.
fn points(transforms: &Transforms, scene: &mut Scene) -> Result<Option<Cloud>> {
    let Some(name) = transforms.json["ply_file_path"].as_str() else { return Ok(None) };
    let path = transforms.path.parent().unwrap_or(Path::new("")).join(name);
    if !path.exists() {
        return Ok(None);
    }
    let cameras: Vec<_> = scene.train.iter().chain(&scene.val).map(|frame| &frame.camera).collect();
    let cloud = Cloud::around(ply::read(&path)?, &cameras);
    Ok(cloud.useful(&mut scene.warnings))
}

/// instant-ngp's box: a cube of `aabb_scale` in its own units, x_ngp = scale x + offset around 0.5, scale 0.33 unless the file says.
fn ngp_box(transforms: &Transforms, scene: &mut Scene) -> Option<(DVec3, DVec3)> {
    let side = transforms.json["aabb_scale"].as_f64()?;
    let scale = transforms.json["scale"].as_f64().unwrap_or(0.33);
    let centered = transforms.json["offset"].is_null();
    if !centered {
        // The offset is in axes that instant-ngp permutes; a box in the wrong place is worse than none.
        return None;
    }
    scene.reasons.insert(
        "bounds".into(),
        Value::from(format!("aabb_scale {side} over scale {scale}, as instant-ngp takes it")),
    );
    let half = DVec3::splat(side / (2.0 * scale));
    Some((-half, half))
}
