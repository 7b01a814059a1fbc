//! One function a kind of file: bytes in; it returns, whatever they are.

use std::cell::OnceCell;
use std::fs;
use std::io::{Cursor, Write};
use std::path::{Path, PathBuf};

use ndarray::Array3;
use nerf_oracle::contract::Dtype;
use nerf_oracle::files::{npz as archive, picture as pictures};
use nerf_oracle::judge::{Exam, exchange};
use nerf_oracle::scene::{self, Options};
use nerf_oracle::training::checkpoint::RunFolder;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

/// All of them, by the names of their corpora.
pub const ALL: [(&str, fn(&[u8])); 6] = [
    ("npz", npz),
    ("npy", npy),
    ("picture", picture),
    ("transforms", transforms),
    ("run", run),
    ("declarations", declarations),
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
    let _ = pictures::read_photo(&path, [0.0; 3]);
}

/// A scene's cameras.
pub fn transforms(bytes: &[u8]) {
    let folder = folder();
    let photo = folder.join("a.png");
    if !photo.exists() {
        pictures::write_png(&photo, Array3::zeros((1, 1, 3)).view()).expect("written");
    }
    let path = put("transforms.json", bytes);
    let _ = scene::load(text(&path), &options());
}

/// What a run says of itself, and the state that it has.
pub fn run(bytes: &[u8]) {
    let path = put("run.json", bytes);
    let Ok(run) = RunFolder::open(path.parent().expect("a folder")) else { return };
    let _ = run.settings();
    let _ = run.load();
}

/// What a candidate says that it takes.
pub fn declarations(bytes: &[u8]) {
    let path = put("answers.json", bytes);
    let exam = Exam::new("mse", Dtype::F32, None).expect("a row");
    let _ = exchange::declared(exam, path.parent().expect("a folder"));
}

fn options() -> Options {
    Options { near: Some(1.0), far: Some(2.0), ..Options::default() }
}

/// A folder of this thread, in memory where the system has such a place.
fn folder() -> PathBuf {
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
