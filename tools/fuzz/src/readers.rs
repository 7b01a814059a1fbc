//! One function a kind of file: bytes in; it returns, whatever they are.

use std::cell::OnceCell;
use std::fs;
use std::io::{Cursor, Write};
use std::path::{Path, PathBuf};

use ndarray::Array3;
use nerf_oracle::contract::Dtype;
use nerf_oracle::files::raw::{INDEX, Raw};
use nerf_oracle::files::{npz as archive, picture as pictures};
use nerf_oracle::judge::{Exam, exchange};
use nerf_oracle::scene::{self, Options};
use nerf_oracle::training::checkpoint::RunFolder;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

/// All of them, by the names of their corpora.
pub const ALL: [(&str, fn(&[u8])); 10] = [
    ("npz", npz),
    ("npy", npy),
    ("picture", picture),
    ("transforms", transforms),
    ("colmap", colmap),
    ("llff", llff),
    ("ply", ply),
    ("run", run),
    ("declarations", declarations),
    ("index", index),
];

/// An archive: its directory, the headers of its arrays, their numbers; as arrays, and as a scene.
pub fn npz(bytes: &[u8]) {
    let path = put("scene.npz", bytes);
    let _ = archive::read(&path);
    let _ = scene::load(text(&path), &options());
}

/// One array in a sound archive: a fuzzer doesn't guess checksums.
pub fn npy(bytes: &[u8]) {
    let _ = archive::read(&put("array.npz", &stored("array.npy", bytes)));
}

/// A picture; the first byte says of which kind.
pub fn picture(bytes: &[u8]) {
    let Some((kind, bytes)) = bytes.split_first() else { return };
    let path = put(["a.png", "a.jpg", "a.gif"][usize::from(kind % 3)], bytes);
    let _ = pictures::held_bytes(&path);
    // As it is stored; turned as its EXIF data say, if it lies or stands.
    for stated in [None, Some([1, 2]), Some([2, 1])] {
        let _ = pictures::read_photo(&path, [0.0; 3], stated);
    }
}

/// A scene's cameras.
pub fn transforms(bytes: &[u8]) {
    picture_at(&folder().join("a.png"));
    let path = put("transforms.json", bytes);
    let _ = scene::load(text(&path), &options());
}

/// COLMAP's model: the first byte says which of its three files the others are; a sound one of a camera and two pictures is about it.
pub fn colmap(bytes: &[u8]) {
    let Some((which, bytes)) = bytes.split_first() else { return };
    let root = folder().join("colmap");
    let model = root.join("sparse/0");
    fs::create_dir_all(&model).expect("a folder");
    for name in NAMES {
        picture_at(&root.join(name));
    }
    for (n, (name, sound)) in
        [("cameras.bin", cameras()), ("images.bin", images()), ("points3D.bin", vec![0; 8])]
            .into_iter()
            .enumerate()
    {
        let fuzzed = usize::from(which % 3) == n;
        fs::write(model.join(name), if fuzzed { bytes } else { &sound }).expect("written");
    }
    let _ = scene::load(text(&root), &options());
}

/// LLFF's array of cameras and depths.
pub fn llff(bytes: &[u8]) {
    let root = folder().join("llff");
    for name in NAMES {
        picture_at(&root.join("images").join(name));
    }
    fs::write(root.join("poses_bounds.npy"), bytes).expect("written");
    let _ = scene::load(text(&root), &options());
}

/// A scene's points.
pub fn ply(bytes: &[u8]) {
    let root = folder().join("ply");
    picture_at(&root.join("a.png"));
    fs::write(root.join("points.ply"), bytes).expect("written");
    let scene = r#"{"fl_x": 1.0, "ply_file_path": "points.ply", "frames": [{"file_path": "a.png",
        "transform_matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 4], [0, 0, 0, 1]]}]}"#;
    fs::write(root.join("transforms.json"), scene).expect("written");
    let _ = scene::load(text(&root), &options());
}

const NAMES: [&str; 2] = ["a.png", "b.png"];

fn picture_at(path: &Path) {
    if !path.exists() {
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        pictures::write_png(path, Array3::zeros((1, 1, 3)).view()).expect("written");
    }
}

/// One SIMPLE_PINHOLE of 1 x 1 pixels.
fn cameras() -> Vec<u8> {
    let mut out = 1u64.to_le_bytes().to_vec();
    out.extend([7u32, 0].iter().flat_map(|x| x.to_le_bytes()));
    out.extend([1u64, 1].iter().flat_map(|x| x.to_le_bytes()));
    out.extend([1.0, 0.5, 0.5].iter().flat_map(|x: &f64| x.to_le_bytes()));
    out
}

/// Two pictures at distance 4, without features.
fn images() -> Vec<u8> {
    let mut out = 2u64.to_le_bytes().to_vec();
    for (n, name) in NAMES.iter().enumerate() {
        out.extend((n as u32 + 1).to_le_bytes());
        out.extend([1.0, 0.0, 0.0, 0.0, n as f64, 0.0, 4.0].iter().flat_map(|x| x.to_le_bytes()));
        out.extend(7u32.to_le_bytes());
        out.extend(name.bytes().chain([0]));
        out.extend(0u64.to_le_bytes());
    }
    out
}

/// What a run says of itself.
pub fn run(bytes: &[u8]) {
    let path = put("run.json", bytes);
    let Ok(run) = RunFolder::open(path.parent().expect("a folder")) else { return };
    let _ = run.settings();
}

/// What a candidate says that it takes.
pub fn declarations(bytes: &[u8]) {
    let path = put("answers.json", bytes);
    let exam = Exam::new("mse", Dtype::F32, None).expect("a row");
    let _ = exchange::declared(exam, path.parent().expect("a folder"));
}

/// The index of a folder of bare numbers: one file has a number of eight bytes, the other none.
pub fn index(bytes: &[u8]) {
    let place = folder().join("raw");
    fs::create_dir_all(&place).expect("a folder");
    for (name, bytes) in [("a.bin", &[0; 8][..]), ("b.bin", &[]), (INDEX, bytes)] {
        fs::write(place.join(name), bytes).expect("written");
    }
    let Ok(raw) = Raw::open(&place) else { return };
    raw.names().for_each(|name| drop(raw.array(name)));
}

fn options() -> Options {
    Options { near: Some(1.0), far: Some(2.0), ..Options::default() }
}

/// A folder of this thread, in memory where the system has such a place.
pub fn folder() -> PathBuf {
    thread_local!(static FOLDER: OnceCell<PathBuf> = const { OnceCell::new() });
    let make = || {
        let memory = Path::new("/dev/shm");
        let place = if memory.is_dir() { memory.to_path_buf() } else { std::env::temp_dir() };
        let name = format!("nerf-oracle-fuzz-{}-{:?}", std::process::id(), std::thread::current().id());
        let folder = place.join(name);
        fs::create_dir_all(&folder).expect("a folder");
        folder
    };
    FOLDER.with(|folder| folder.get_or_init(make).clone())
}

fn put(name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder().join(name);
    fs::write(&path, bytes).expect("written");
    path
}

fn text(path: &Path) -> &str {
    path.to_str().expect("UTF-8")
}

/// An archive of one file that isn't compressed.
fn stored(name: &str, bytes: &[u8]) -> Vec<u8> {
    let mut archive = ZipWriter::new(Cursor::new(vec![]));
    let plain = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
    archive.start_file(name, plain).expect("in memory");
    archive.write_all(bytes).expect("in memory");
    archive.finish().expect("in memory").into_inner()
}
