//! The pictures of a capture: where they lie, whatever the folder is called, and reading all of them, as far as memory allows.

use std::ffi::OsString;
use std::fs;
use std::path::{Component, Path, PathBuf};

use super::fields::listed;
use super::{Photo, Scene};
use crate::error::{Error, Input, Result};
use crate::files::mask::Mask;
use crate::files::picture;
use crate::limits;
use crate::parallel;

/// Endings of pictures that are read.
const ENDINGS: [&str; 4] = ["png", "jpg", "jpeg", "gif"];

/// Folders of pictures as captures have them, the largest pictures first.
const FOLDERS: [&str; 5] = ["images", "images_2", "images_4", "images_8", "input"];

/// The folder of COLMAP's masks, beside that of the pictures; of `images_4`, it is `masks_4`.
const MASKS: &str = "masks";

/// Whether a name leads to a file below the folder that it is taken from.
pub(super) fn stays_below(name: &str) -> bool {
    let path = Path::new(name);
    let inside = |part| matches!(part, Component::Normal(_) | Component::CurDir);
    // Another system's way up is one here too: the model may have been made there.
    path.components().all(inside) && path.file_name().is_some() && !name.split('\\').any(|part| part == "..")
}

/// The file of a picture that is called so: with its ending, or any other.
pub(super) fn file(folder: &Path, name: &str) -> Option<PathBuf> {
    let beside = folder.join(name);
    if beside.is_file() {
        return Some(beside);
    }
    let ending = |ending: &str| {
        let mut path = OsString::from(&beside);
        path.push(format!(".{ending}"));
        [PathBuf::from(path), beside.with_extension(ending)]
    };
    let endings = ENDINGS.iter().flat_map(|name| [name.to_string(), name.to_uppercase()]);
    endings.flat_map(|name| ending(&name)).find(|path| path.is_file())
}

/// The pictures in a folder, sorted by name; none where it isn't one.
pub(super) fn all(folder: &Path) -> Vec<PathBuf> {
    let picture = |path: &PathBuf| {
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
        // A system's own notes beside pictures (macOS: `._a.jpg`) are none.
        let hidden = path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
        !hidden && ending.is_some_and(|ending| ENDINGS.contains(&ending.as_str())) && path.is_file()
    };
    let entries = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let mut found: Vec<PathBuf> = entries.filter(picture).collect();
    found.sort();
    found
}

/// A capture's folder, and that of its pictures where it was chosen.
pub(super) struct Capture<'a> {
    /// The folder with the cameras.
    pub root: &'a Path,
    /// The folder that was given, where it is one of pictures.
    pub chosen: Option<&'a Path>,
}

impl<'a> Capture<'a> {
    /// The folder that was given, if it has cameras; or the one that it lies in, if that has them, and it the pictures.
    pub(super) fn at(path: &'a Path, has_cameras: impl Fn(&Path) -> bool) -> Option<Capture<'a>> {
        if !path.is_dir() {
            return None;
        }
        if has_cameras(path) {
            return Some(Capture { root: path, chosen: None });
        }
        let parent = path.parent().filter(|parent| has_cameras(parent))?;
        (!all(path).is_empty()).then_some(Capture { root: parent, chosen: Some(path) })
    }

    /// Folders that have the pictures by custom: the chosen one, or those with such names and the capture's own.
    fn customary(&self) -> Vec<PathBuf> {
        match self.chosen {
            Some(chosen) => vec![chosen.to_path_buf()],
            None => {
                FOLDERS.iter().map(|name| self.root.join(name)).chain([self.root.to_path_buf()]).collect()
            }
        }
    }

    /// The file of each picture that is named, from the first folder that has any of them, customary ones first. Where none has, smaller
    /// copies may have names of their own, in the same order. `None` where one isn't there.
    pub(super) fn named(&self, names: &[String], scene: &mut Scene) -> Vec<Option<PathBuf>> {
        let customary = self.customary();
        let mut folders = customary.clone();
        if self.chosen.is_none() {
            let entries = fs::read_dir(self.root).into_iter().flatten().flatten().map(|entry| entry.path());
            let masks =
                |path: &Path| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(MASKS));
            let mut others: Vec<PathBuf> =
                entries.filter(|path| path.is_dir() && !customary.contains(path) && !masks(path)).collect();
            others.sort();
            folders.extend(others);
        }
        for folder in &folders {
            let found: Vec<_> = names.iter().map(|name| file(folder, name)).collect();
            if found.iter().any(Option::is_some) {
                return found;
            }
        }
        for folder in &customary {
            let copies = all(folder);
            if !copies.is_empty() && copies.len() == names.len() {
                let (file, name) = (copies[0].display(), &names[0]);
                let of = "pictures have other names than the cameras, and are taken in their order";
                scene.warnings.push(format!("{}: {of}: {file} for {name}.", folder.display()));
                return copies.into_iter().map(Some).collect();
            }
        }
        vec![None; names.len()]
    }

    /// The mask of each picture, where there is one: `masks/a.jpg.png` or `masks/a.png` for `images/a.jpg`.
    pub(super) fn masks(&self, pictures: &[Option<PathBuf>], scene: &mut Scene) -> Vec<Option<PathBuf>> {
        let mask = |picture: &PathBuf| {
            let below = picture.strip_prefix(self.root).ok()?;
            let folder = below.components().next()?.as_os_str().to_str()?;
            let name = below.strip_prefix(folder).ok()?.to_str()?;
            let of = folder.strip_prefix(FOLDERS[0]).unwrap_or_default();
            file(&self.root.join(format!("{MASKS}{of}")), name)
        };
        let found: Vec<_> = pictures.iter().map(|picture| picture.as_ref().and_then(mask)).collect();
        let (masks, there) = (found.iter().flatten().count(), pictures.iter().flatten().count());
        if masks < there && self.root.join(MASKS).is_dir() {
            let root = self.root.display();
            scene.warnings.push(format!("{root}: {masks} of {there} pictures have a mask in {MASKS}."));
        }
        found
    }

    /// All pictures of the first customary folder that has as many as `count`.
    pub(super) fn counted(&self, count: usize) -> Result<Vec<PathBuf>> {
        let mut most = (0, self.root.join(FOLDERS[0]));
        for folder in self.customary() {
            let found = all(&folder);
            if found.len() == count {
                return Ok(found);
            }
            if found.len() > most.0 {
                most = (found.len(), folder);
            }
        }
        let (found, folder) = most;
        let remedy = "Every pose needs its picture, in the order of their names.";
        Err(Error::input(Input {
            file: folder.display(),
            field: "pictures",
            found,
            expected: format!("{count}, as there are poses"),
            remedy,
        }))
    }
}

/// Reads pictures; `None` where there is no path. `file` names the scene; `stated` has each camera's width and height, where they are known.
///
/// # Errors
/// Where one is no whole picture, or all of them don't fit into memory.
pub(super) fn read(
    file: &str,
    paths: &[Option<PathBuf>],
    stated: &[Option<[usize; 2]>],
    background: [f64; 3],
) -> Result<Vec<Option<Photo>>> {
    let bytes = parallel::map(paths.len(), |n| paths[n].as_deref().map_or(Ok(0), picture::held_bytes));
    let bytes = bytes.into_iter().sum::<Result<u64>>()? as f64;
    limits::fits(file, bytes, "Make the pictures smaller, or list fewer of them.")?;
    let background = background.map(|c| c as f32);
    let read = |n: usize| {
        paths[n].as_deref().map(|path| picture::read_photo(path, background, stated[n])).transpose()
    };
    parallel::map(paths.len(), read).into_iter().collect()
}

/// Pictures, each with its mask where there is one.
pub(super) fn all_masked(
    photos: Vec<Option<Photo>>,
    masks: &[Option<PathBuf>],
) -> Result<Vec<Option<Photo>>> {
    let one = |n: usize| match (photos[n].clone(), &masks[n]) {
        (Some(photo), Some(mask)) => masked(photo, mask).map(Some),
        (photo, _) => Ok(photo),
    };
    parallel::map(photos.len(), one).into_iter().collect()
}

/// The picture, of which only the pixels count that aren't black in the mask.
///
/// # Errors
/// Where the mask has another size, or no pixel that counts.
pub(super) fn masked(photo: Photo, path: &Path) -> Result<Photo> {
    let (height, width, counts) = picture::read_mask(path)?;
    let wrong = |found: String, expected: String| {
        let remedy = "Make the mask again: as large as its picture, black where nothing is to be learned.";
        Error::input(Input { file: path.display(), field: "mask", found, expected, remedy })
    };
    let (h, w) = photo.size();
    if (height, width) != (h, w) {
        return Err(wrong(format!("{width}x{height}"), format!("{w}x{h}, as its picture has")));
    }
    let mask = Mask::new(counts).ok_or_else(|| wrong("black alone".into(), "a pixel that counts".into()))?;
    Ok(photo.masked(mask))
}

/// Names pictures that are missing in a warning.
///
/// # Errors
/// Where all are.
pub(super) fn missing(file: &str, names: &[&str], of: usize, remedy: &str, scene: &mut Scene) -> Result<()> {
    if names.len() == of {
        let (found, expected) =
            (format!("none of {of} pictures, {} the first", names[0]), "the pictures that it names");
        return Err(Error::input(Input { file, field: "frames", found, expected, remedy }));
    }
    if !names.is_empty() {
        scene.warnings.push(format!("{file}: left out, picture missing: {}", listed(names)));
    }
    Ok(())
}
