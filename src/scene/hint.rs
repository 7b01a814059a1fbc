//! What is said where a path is no scene: what it is instead, and how a scene comes of it.

use std::fs;
use std::path::{Path, PathBuf};

use super::{is_folder_of_scene, pictures};
use crate::error::{Error, Input};

/// How far above and below a folder scenes are looked for, and in how many of a folder's folders.
const DEPTH: usize = 3;
const BREADTH: usize = 20;

/// The refusal of a path.
pub(super) fn no_scene(scene: &str) -> Error {
    let (found, remedy) = of(Path::new(scene));
    let expected =
        "builtin:NAME, an .npz, a folder or file of transforms*.json, or a folder that COLMAP or LLFF wrote";
    Error::input(Input { file: scene, field: "scene", found, expected, remedy })
}

/// What is there, and what to do with it.
fn of(path: &Path) -> (String, String) {
    let start = "Start with builtin:spheres, which needs no file.".to_string();
    if !path.exists() {
        return ("nothing there".into(), start);
    }
    if !path.is_dir() {
        let other = "a file of another kind";
        return match instead(path) {
            Some((what, remedy)) => (format!("{other}: {what}"), remedy.into()),
            None => (other.into(), start),
        };
    }
    let without = "a folder without transforms.json, transforms_train.json, sparse/0 or poses_bounds.npy";
    let whole = fs::canonicalize(path).unwrap_or(path.to_path_buf());
    if let Some(above) = whole.ancestors().skip(1).take(DEPTH).find(|above| is_folder_of_scene(above)) {
        let remedy = format!("Give that folder: {}.", above.display());
        return (format!("{without}; a folder above it has one"), remedy);
    }
    let deeper = scenes_below(path, DEPTH);
    if let Some(first) = deeper.first() {
        let remedy = format!("Give such a folder: {}.", first.display());
        return (format!("{without}; there are some below it: {}", shown(&deeper, path)), remedy);
    }
    if path.join("run.json").is_file() {
        let remedy = "Render and evaluate take runs; train takes the scene that run.json names.";
        return (format!("{without}: a run"), remedy.into());
    }
    let entries = fs::read_dir(path).into_iter().flatten().flatten().map(|entry| entry.path());
    let mut files: Vec<PathBuf> = entries.filter(|path| path.is_file()).collect();
    files.sort();
    if let Some(file) = files.iter().find(|file| may_be_scene(file)) {
        let remedy = format!("Give that file: {}.", file.display());
        return (format!("{without}; there is {} in it", name(file)), remedy);
    }
    let count =
        [path.to_path_buf(), path.join("images")].iter().map(|folder| pictures::all(folder).len()).max();
    if let Some(count) = count.filter(|count| *count > 0) {
        let remedy = "Let COLMAP find their cameras (its automatic_reconstructor, or nerfstudio's ns-process-data), then give the folder with its \
                      sparse/0 or transforms.json.";
        return (
            format!("{without}: pictures ({count}), and nothing that says where they were taken from"),
            remedy.into(),
        );
    }
    if let Some((file, (what, remedy))) = files.iter().find_map(|file| Some((file, instead(file)?))) {
        return (format!("{without}; there is {what} in it: {}", name(file)), remedy.into());
    }
    (without.into(), start)
}

/// A file's name.
fn name(file: &Path) -> String {
    file.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// Whether a file may be a scene by itself.
fn may_be_scene(file: &Path) -> bool {
    let name = name(file).to_lowercase();
    name.ends_with(".npz") || name.starts_with("transforms") && name.ends_with(".json")
}

/// Files that people have in the place of a scene.
fn instead(path: &Path) -> Option<(&'static str, &'static str)> {
    let ending = path.extension()?.to_string_lossy().to_lowercase();
    Some(match ending.as_str() {
        "zip" | "tar" | "gz" | "tgz" | "7z" | "rar" => ("an archive", "Unpack it, and give the folder."),
        "mp4" | "mov" | "avi" | "mkv" | "webm" => (
            "a film",
            "Take pictures out of it (`ffmpeg -i FILM -r 2 images/%04d.png`), and let COLMAP find their cameras.",
        ),
        _ => return None,
    })
}

/// The first scenes below a folder, those that lie less deep first.
fn scenes_below(folder: &Path, depth: usize) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let seen = entries.filter(|entry| !entry.file_name().to_string_lossy().starts_with('.'));
    let mut folders: Vec<PathBuf> = seen
        .filter(|entry| entry.file_type().is_ok_and(|kind| kind.is_dir()))
        .map(|entry| entry.path())
        .collect();
    folders.sort();
    folders.truncate(BREADTH);
    let found: Vec<PathBuf> = folders.iter().filter(|folder| is_folder_of_scene(folder)).cloned().collect();
    if !found.is_empty() || depth == 1 {
        return found;
    }
    folders.iter().flat_map(|folder| scenes_below(folder, depth - 1)).collect()
}

/// A few of them, as they are called from the folder that was given.
fn shown(scenes: &[PathBuf], from: &Path) -> String {
    let name = |path: &PathBuf| path.strip_prefix(from).unwrap_or(path).display().to_string();
    let some: Vec<String> = scenes.iter().take(3).map(name).collect();
    let more = if scenes.len() > 3 { ", ..." } else { "" };
    format!("{}{more}", some.join(", "))
}
