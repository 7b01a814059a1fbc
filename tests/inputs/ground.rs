//! Good files of every kind that the program reads, small, in a folder of their own.

use std::cell::RefCell;
use std::fs;
use std::path::{Path, PathBuf};

use image::{ImageFormat, Rgb, RgbImage, Rgba, RgbaImage};
use ndarray::{Array, Array3, Array4};
use nerf_oracle::files::npz::{self, Arrays};
use serde_json::{Value, json};

use super::{Ended, captures};

/// A folder with the good files; those that a test has changed come back by `restore`.
pub(crate) struct Ground {
    folder: tempfile::TempDir,
    /// Every good file, by its path in the folder.
    files: Vec<(PathBuf, Vec<u8>)>,
    /// Those that may be others by now.
    touched: RefCell<Vec<String>>,
}

/// Two cameras 4 from the origin, along x and along y, looking at it: rows of OpenGL poses.
const POSES: [[[f64; 4]; 4]; 2] = [
    [[0.0, 0.0, 1.0, 4.0], [1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]],
    [[-1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 4.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]],
];

/// The options of the run in `run/`.
pub(crate) const RUN: &str =
    "builtin:blob,size=8,views=2 --model nerf --width 8 --rays 8 --samples 4 --steps 2";

/// Those of the run in `compact/`, which is large for a test: 24 MB.
const COMPACT: &str = "builtin:blob,size=4,views=2 --steps 2";

impl Ground {
    /// Writes the good files; those of a run are written by the program.
    pub(crate) fn new(run: impl Fn(&Path, &[String]) -> Ended) -> Ground {
        let ground = Ground {
            folder: tempfile::tempdir().expect("a folder"),
            files: vec![],
            touched: RefCell::default(),
        };
        let folder = ground.folder();
        fs::create_dir(folder.join("scene")).expect("a folder");
        fs::write(folder.join("scene/transforms.json"), transforms().to_string()).expect("written");
        for name in ["a.png", "b.png"] {
            let picture =
                RgbaImage::from_fn(6, 4, |i, j| Rgba([40 * i as u8, 60 * j as u8, 128, 255 - i as u8]));
            picture.save(folder.join("scene").join(name)).expect("written");
        }
        let photo = RgbImage::from_fn(24, 18, |i, j| Rgb([10 * i as u8, 14 * j as u8, (i * j) as u8]));
        for (name, format) in [
            ("photo.png", ImageFormat::Png),
            ("photo.jpg", ImageFormat::Jpeg),
            ("photo.gif", ImageFormat::Gif),
        ] {
            photo.save_with_format(folder.join(name), format).expect("written");
        }
        for capture in ["colmap", "text", "llff"] {
            captures::pictures(&folder.join(capture).join("images"), captures::SIZE);
        }
        captures::binary(&folder.join("colmap/sparse/0"), &captures::opencv(), 0.0);
        captures::text(&folder.join("text/sparse/0"), &captures::pinhole());
        captures::llff(&folder.join("llff"), 8.0);
        fs::write(folder.join("keys.json"), keys().to_string()).expect("written");
        npz::write(&folder.join("cs180.npz"), &cs180(), true).expect("written");
        npz::write(&folder.join("tiny.npz"), &tiny_nerf(), false).expect("written");
        for args in [format!("train {RUN} --out run"), format!("train {COMPACT} --out compact")] {
            let ended = run(&folder, &words(&args));
            assert_eq!(ended.code, Some(0), "{}", ended.stderr);
        }
        ground.remembered()
    }

    fn remembered(mut self) -> Ground {
        let mut left = vec![self.folder()];
        while let Some(folder) = left.pop() {
            for entry in fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path())
            {
                if entry.is_dir() {
                    left.push(entry);
                } else {
                    let name = entry.strip_prefix(self.folder.path()).expect("below it").to_path_buf();
                    self.files.push((name, fs::read(&entry).expect("readable")));
                }
            }
        }
        self
    }

    /// The same files in another folder.
    pub(crate) fn copy(&self) -> Ground {
        let (folder, files) = (tempfile::tempdir().expect("a folder"), self.files.clone());
        let copy = Ground { folder, files, touched: RefCell::default() };
        self.files.iter().for_each(|(name, bytes)| copy.write(&name.to_string_lossy(), bytes));
        copy.touched.take();
        copy
    }

    /// Where they lie.
    pub(crate) fn folder(&self) -> PathBuf {
        self.folder.path().to_path_buf()
    }

    /// The good bytes of a file.
    pub(crate) fn bytes(&self, name: &str) -> Vec<u8> {
        let file = self.files.iter().find(|(path, _)| path == Path::new(name));
        file.unwrap_or_else(|| panic!("no good {name}")).1.clone()
    }

    /// The good JSON of a file.
    pub(crate) fn json(&self, name: &str) -> Value {
        serde_json::from_slice(&self.bytes(name)).expect("JSON")
    }

    /// The path of a file that may be changed there.
    pub(crate) fn touch(&self, name: &str) -> PathBuf {
        self.touched.borrow_mut().push(name.into());
        self.folder().join(name)
    }

    /// Writes a file in the place of a good one.
    pub(crate) fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        let path = self.touch(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        fs::write(path, bytes).expect("written");
    }

    /// Puts all files back, and takes away what was written besides.
    pub(crate) fn restore(&self) {
        for entry in
            fs::read_dir(self.folder()).expect("a folder").map(|entry| entry.expect("an entry").path())
        {
            let name = entry.file_name().expect("a name");
            if !self.files.iter().any(|(path, _)| path.starts_with(name)) {
                remove(&entry);
            }
        }
        for name in self.touched.take() {
            remove(&self.folder().join(&name));
            self.write(&name, self.bytes(&name));
        }
        self.touched.take();
    }
}

/// Takes away a file or a folder, if it is there.
fn remove(path: &Path) {
    let about = fs::symlink_metadata(path);
    match about.map(|about| about.is_dir()) {
        Ok(true) => fs::remove_dir_all(path).expect("removed"),
        Ok(false) => fs::remove_file(path).expect("removed"),
        Err(_) => {}
    }
}

/// A line of arguments, split at spaces.
pub(crate) fn words(line: &str) -> Vec<String> {
    line.split(' ').filter(|word| !word.is_empty()).map(String::from).collect()
}

/// All that instant-ngp, nerfstudio and Blender write, but for what would be named in a warning.
fn transforms() -> Value {
    let frame = |name: &str, pose: [[f64; 4]; 4]| {
        json!({
            "file_path": name, "transform_matrix": pose, "sharpness": 30.5, "rotation": 0.01, "colmap_im_id": 7,
            "depth_file_path": "depth/1.png", "k1": 0.01,
        })
    };
    json!({
        "camera_angle_x": 0.7, "camera_angle_y": 0.6, "fl_x": 8.0, "fl_y": 7.0, "cx": 2.5, "cy": 1.5, "w": 6.0, "h": 4,
        "k1": 0.05, "k2": -0.01, "k3": 0, "k4": 0.0, "p1": 0.001, "p2": 0.0, "camera_model": "OPENCV", "is_fisheye": false,
        "aabb_scale": 4, "scale": 0.33, "applied_transform": [[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0]], "applied_scale": 1.0,
        "ply_file_path": "points.ply", "orientation_override": "none", "enable_depth_loading": true, "integer_depth_scale": 0.001,
        "up": [0.0, 0.0, 1.0], "frames": [frame("a.png", POSES[0]), frame("b.png", POSES[1])],
    })
}

/// Key cameras of a film.
fn keys() -> Value {
    let frame = |pose: [[f64; 4]; 4]| json!({"transform_matrix": pose, "camera_angle_x": 0.7});
    json!({"frames": POSES.map(frame)})
}

/// `n` of the two poses, turned to OpenCV axes where `opencv`.
fn poses(n: usize, opencv: bool) -> Array3<f64> {
    let sign = |j: usize| if opencv && (j == 1 || j == 2) { -1.0 } else { 1.0 };
    Array::from_shape_fn((n, 4, 4), |(n, i, j)| sign(j) * POSES[n % 2][i][j])
}

fn cs180() -> Arrays {
    let images = |n| Array4::from_shape_fn((n, 4, 6, 3), |(n, j, i, k)| (n + 20 * j + 10 * i + 30 * k) as u8);
    [
        ("images_train", images(2).into()),
        ("c2ws_train", poses(2, true).into()),
        ("images_val", images(2).into()),
        ("c2ws_val", poses(2, true).into()),
        ("c2ws_test", poses(2, true).into()),
        ("focal", ndarray::arr0(8.0).into()),
    ]
    .map(|(name, array)| (name.to_string(), array))
    .into()
}

fn tiny_nerf() -> Arrays {
    let images = Array4::from_shape_fn((4, 4, 6, 3), |(n, j, i, k)| (n + j + i + k) as f32 / 16.0);
    [("images", images.into()), ("poses", poses(4, false).into()), ("focal", ndarray::arr0(8.0).into())]
        .map(|(name, array)| (name.to_string(), array))
        .into()
}
