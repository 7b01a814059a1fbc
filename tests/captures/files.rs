//! One small capture in the layouts that programs write: cameras on an arc about a cube of points. Formulas of its own, so that a
//! reader's mistake isn't made twice.

use std::fs;
use std::path::Path;

/// Photographs: so many, of this size, and half a turn of the arc apart.
pub(crate) const NAMES: [&str; 4] = ["a.png", "b.png", "c.png", "d.png"];
pub(crate) const SIZE: [usize; 2] = [12, 8];
pub(crate) const FOCAL: f64 = 10.0;

/// The distance of the cameras from the origin, and the angle between two.
const DISTANCE: f64 = 4.0;
const TURN: f64 = 0.4;

/// World to camera of a photograph: x_c = R x_w + t, a turn about y.
pub(crate) fn rotation(n: usize) -> [[f64; 3]; 3] {
    let (s, c) = (TURN * n as f64).sin_cos();
    [[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]]
}

/// Camera to world with OpenCV axes: R^T, and R^T (0, 0, -distance).
pub(crate) fn pose(n: usize) -> [[f64; 4]; 4] {
    let r = rotation(n);
    let row = |i: usize| [r[0][i], r[1][i], r[2][i], -DISTANCE * r[2][i]];
    [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]]
}

/// The points: 5 x 5 x 5 in a cube of edge 2.
pub(crate) fn points() -> Vec<[f64; 3]> {
    let at = |k: usize| 0.5 * k as f64 - 1.0;
    (0..125).map(|n| [at(n % 5), at(n / 5 % 5), at(n / 25)]).collect()
}

/// Where a photograph shows a point, by a pinhole with the principal point in the middle.
pub(crate) fn seen(n: usize, point: [f64; 3]) -> [f64; 2] {
    let r = rotation(n);
    let c = |i: usize| r[i][0] * point[0] + r[i][1] * point[1] + r[i][2] * point[2];
    let depth = c(2) + DISTANCE;
    [FOCAL * c(0) / depth + 0.5 * SIZE[0] as f64, FOCAL * c(1) / depth + 0.5 * SIZE[1] as f64]
}

/// The same through a lens, by formulas of its own: OpenCV's fisheye, or its rational distortion.
pub(crate) fn seen_through(lens: &Lens, n: usize, point: [f64; 3]) -> [f64; 2] {
    let [u, v] = seen(n, point);
    let [x, y] = [(u - 0.5 * SIZE[0] as f64) / FOCAL, (v - 0.5 * SIZE[1] as f64) / FOCAL];
    let [x, y] = match (lens.name, &lens.parameters[..]) {
        ("OPENCV_FISHEYE", [_, _, _, _, k @ ..]) => {
            let r = x.hypot(y).max(1e-12);
            let theta = r.atan();
            let bent = (0..4).fold(theta, |sum, i| sum + k[i] * theta.powi(2 * i as i32 + 3));
            [x * bent / r, y * bent / r]
        }
        ("FULL_OPENCV", [_, _, _, _, k1, k2, p1, p2, k3, k4, k5, k6]) => {
            let s = x * x + y * y;
            let of = |a: &f64, b: &f64, c: &f64| 1.0 + s * (a + s * (b + s * c));
            let radial = of(k1, k2, k3) / of(k4, k5, k6);
            let (a, b) = (2.0 * x * y, s + 2.0 * x * x);
            [x * radial + p1 * a + p2 * b, y * radial + p1 * (s + 2.0 * y * y) + p2 * a]
        }
        _ => return [u, v],
    };
    [FOCAL * x + 0.5 * SIZE[0] as f64, FOCAL * y + 0.5 * SIZE[1] as f64]
}

/// Writes the photographs, each `size`, into a folder.
pub(crate) fn pictures(folder: &Path, [width, height]: [usize; 2]) {
    fs::create_dir_all(folder).expect("a folder");
    for (n, name) in NAMES.iter().enumerate() {
        let color = |i: u32, j: u32| image::Rgb([20 * (i % 12) as u8, 30 * (j % 8) as u8, 60 * n as u8]);
        image::RgbImage::from_fn(width as u32, height as u32, color)
            .save(folder.join(name))
            .expect("written");
    }
}

/// COLMAP's camera, of any model: its number, and its parameters.
pub(crate) struct Lens {
    pub id: u32,
    pub name: &'static str,
    pub parameters: Vec<f64>,
}

/// The pinhole that [`seen`] has.
pub(crate) fn pinhole() -> Lens {
    let parameters = vec![FOCAL, 0.5 * SIZE[0] as f64, 0.5 * SIZE[1] as f64];
    Lens { id: 0, name: "SIMPLE_PINHOLE", parameters }
}

/// A camera with every coefficient that is read: a pinhole but for a thousandth.
pub(crate) fn opencv() -> Lens {
    let [width, height] = SIZE.map(|side| side as f64);
    let parameters = vec![FOCAL, FOCAL, 0.5 * width, 0.5 * height, 1e-3, -1e-3, 1e-4, -1e-4];
    Lens { id: 4, name: "OPENCV", parameters }
}

/// The quaternion of [`rotation`].
fn quaternion(n: usize) -> [f64; 4] {
    let half = 0.5 * TURN * n as f64;
    [half.cos(), 0.0, half.sin(), 0.0]
}

/// Little-endian bytes of numbers.
fn bytes(numbers: &[f64]) -> Vec<u8> {
    numbers.iter().flat_map(|x| x.to_le_bytes()).collect()
}

/// COLMAP's binary model; features are `off` pixels from where the points are seen, along u.
pub(crate) fn binary(folder: &Path, lens: &Lens, off: f64) {
    fs::create_dir_all(folder).expect("a folder");
    let (points, mut cameras, mut images, mut cloud) = (points(), vec![], vec![], vec![]);
    cameras.extend(1u64.to_le_bytes());
    cameras.extend([7, lens.id].iter().flat_map(|x| x.to_le_bytes()));
    cameras.extend(SIZE.iter().flat_map(|&side| (side as u64).to_le_bytes()));
    cameras.extend(bytes(&lens.parameters));
    images.extend((NAMES.len() as u64).to_le_bytes());
    // Not in the order of their names.
    for n in (0..NAMES.len()).rev() {
        images.extend((n as u32 + 1).to_le_bytes());
        images.extend(bytes(&quaternion(n)));
        images.extend(bytes(&[0.0, 0.0, DISTANCE]));
        images.extend(7u32.to_le_bytes());
        images.extend(NAMES[n].as_bytes());
        images.push(0);
        images.extend((points.len() as u64 + 1).to_le_bytes());
        for (k, point) in points.iter().enumerate() {
            let [u, v] = seen_through(lens, n, *point);
            images.extend(bytes(&[u + off, v]));
            images.extend((k as u64 + 100).to_le_bytes());
        }
        // A feature of no point.
        images.extend(bytes(&[1.0, 2.0]));
        images.extend(u64::MAX.to_le_bytes());
    }
    cloud.extend((points.len() as u64).to_le_bytes());
    for (k, point) in points.iter().enumerate() {
        cloud.extend((k as u64 + 100).to_le_bytes());
        cloud.extend(bytes(point));
        cloud.extend([1, 2, 3]);
        cloud.extend(bytes(&[0.25]));
        cloud.extend((NAMES.len() as u64).to_le_bytes());
        for n in 0..NAMES.len() as u32 {
            cloud.extend([n + 1, k as u32].iter().flat_map(|x| x.to_le_bytes()));
        }
    }
    for (name, bytes) in [("cameras.bin", cameras), ("images.bin", images), ("points3D.bin", cloud)] {
        fs::write(folder.join(name), bytes).expect("written");
    }
}

/// The same as text.
pub(crate) fn text(folder: &Path, lens: &Lens) {
    fs::create_dir_all(folder).expect("a folder");
    let list = |numbers: &[f64]| numbers.iter().map(|x| x.to_string()).collect::<Vec<_>>().join(" ");
    let [width, height] = SIZE;
    let cameras = format!("# cameras\n7 {} {width} {height} {}\n", lens.name, list(&lens.parameters));
    let (mut images, mut cloud) = ("# images, two lines each\n".to_string(), "# points\n".to_string());
    for n in 0..NAMES.len() {
        let (turn, name) = (list(&quaternion(n)), NAMES[n]);
        images += &format!("{} {turn} 0 0 {DISTANCE} 7 {name}\n", n + 1);
        for (k, point) in points().iter().enumerate() {
            images += &format!("{} {} ", list(&seen_through(lens, n, *point)), k + 100);
        }
        images += "1 2 -1\n";
    }
    for (k, point) in points().iter().enumerate() {
        cloud += &format!("{} {} 1 2 3 0.25 1 {k} 2 {k}\n", k + 100, list(point));
    }
    for (name, text) in [("cameras.txt", cameras), ("images.txt", images), ("points3D.txt", cloud)] {
        fs::write(folder.join(name), text).expect("written");
    }
}

/// LLFF's `poses_bounds.npy` for pictures that were `scale` times as large: columns down, right, backward, place, then height, width and
/// focal length; near and far.
pub(crate) fn llff(folder: &Path, scale: f64) {
    let mut numbers = vec![];
    for n in 0..NAMES.len() {
        let c2w = pose(n);
        let size = [SIZE[1] as f64 * scale, SIZE[0] as f64 * scale, FOCAL * scale];
        for i in 0..3 {
            let [x, y, z, o] = c2w[i];
            numbers.extend([y, x, -z, o, size[i]]);
        }
        numbers.extend([2.5, 5.5]);
    }
    let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({}, 17), }}\n", NAMES.len());
    let length = (header.len() as u16).to_le_bytes();
    let npy = [b"\x93NUMPY\x01\x00", &length[..], header.as_bytes(), &bytes(&numbers)].concat();
    fs::create_dir_all(folder).expect("a folder");
    fs::write(folder.join("poses_bounds.npy"), npy).expect("written");
}
