//! COLMAP's camera models, and what they are as a pinhole with a lens.

use super::faulty::faulty;
use crate::camera::{self, Distortion, Intrinsics};
use crate::error::Result;
use crate::limits::{LENGTH, SIDE};

/// A model: its name in text files, and how many parameters it has. Its place in this list is its number in binary files.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Kind(usize);

#[rustfmt::skip]
const KINDS: [(&str, usize); 12] = [
    ("SIMPLE_PINHOLE", 3), ("PINHOLE", 4), ("SIMPLE_RADIAL", 4), ("RADIAL", 5), ("OPENCV", 8), ("OPENCV_FISHEYE", 8),
    ("FULL_OPENCV", 12), ("FOV", 5), ("SIMPLE_RADIAL_FISHEYE", 4), ("RADIAL_FISHEYE", 5), ("THIN_PRISM_FISHEYE", 12),
    ("RAD_TAN_THIN_PRISM_FISHEYE", 16),
];

impl Kind {
    /// The model of a number.
    pub(super) fn of_id(id: u32) -> Option<Kind> {
        Some(id as usize).filter(|&id| id < KINDS.len()).map(Kind)
    }

    /// The model of a name.
    pub(super) fn of_name(name: &str) -> Option<Kind> {
        KINDS.iter().position(|kind| kind.0 == name).map(Kind)
    }

    /// Its name.
    pub(super) fn name(self) -> &'static str {
        KINDS[self.0].0
    }

    /// How many parameters it has.
    pub(super) fn parameters(self) -> usize {
        KINDS[self.0].1
    }
}

/// A camera of the model: several photographs may be of one.
#[derive(Clone, Debug)]
pub(super) struct Lens {
    /// Its model.
    pub kind: Kind,
    /// Width and height in pixels.
    pub size: [u64; 2],
    /// As many as the model has.
    pub parameters: Vec<f64>,
}

impl Lens {
    /// Checks what every model has: a size, and numbers.
    pub(super) fn check(&self, file: &str, id: u32) -> Result<()> {
        let remedy = "Write the model again with COLMAP.";
        let [width, height] = self.size;
        if self.size.iter().any(|side| !(1..=SIDE as u64).contains(side)) {
            let (found, expected) = (format!("{width}x{height}"), format!("sides from 1 to {SIDE} pixels"));
            return Err(faulty(file, format!("size of camera {id}"), found, &expected, remedy));
        }
        if let Some(x) = self.parameters.iter().find(|x| !(-LENGTH..=LENGTH).contains(*x)) {
            let expected = "finite numbers, none beyond 1e9";
            return Err(faulty(file, format!("parameters of camera {id}"), x, expected, remedy));
        }
        Ok(())
    }

    /// The pinhole and what bends its rays, in pixels of the camera's own size.
    ///
    /// # Errors
    /// Where the model bends rays in a way that neither of OpenCV's lenses does.
    pub(super) fn pinhole(&self, file: &str, id: u32) -> Result<(Intrinsics, Option<camera::Lens>)> {
        let Some((k, lens)) = self.read() else {
            let expected = "a pinhole, a RADIAL, OPENCV or FULL_OPENCV lens, or a FISHEYE without thin prism";
            let remedy =
                "Undistort the pictures (colmap image_undistorter) and give the folder that it writes.";
            return Err(faulty(file, format!("model of camera {id}"), self.kind.name(), expected, remedy));
        };
        let [fx, fy, cx, cy] = k;
        if fx <= 0.0 || fy <= 0.0 {
            let (found, expected) = (format!("{fx}, {fy}"), "positive numbers of pixels");
            let remedy = "Write the model again with COLMAP.";
            return Err(faulty(file, format!("focal length of camera {id}"), found, expected, remedy));
        }
        Ok((Intrinsics { fx, fy, cx, cy }, lens))
    }

    /// fx, fy, cx, cy and the lens; `None` where the model has another one.
    fn read(&self) -> Option<([f64; 4], Option<camera::Lens>)> {
        let opencv = |k: &[f64]| {
            let lens = Distortion::from_opencv(k);
            (lens != Distortion::default()).then_some(camera::Lens::Opencv(lens))
        };
        let fisheye = |k: [f64; 4]| Some(camera::Lens::Fisheye(k));
        let none = [0.0; 4];
        Some(match (self.kind.name(), &self.parameters[..]) {
            ("SIMPLE_PINHOLE", &[f, cx, cy]) => ([f, f, cx, cy], None),
            ("PINHOLE", &[fx, fy, cx, cy]) => ([fx, fy, cx, cy], None),
            ("SIMPLE_RADIAL", &[f, cx, cy, k1]) => ([f, f, cx, cy], opencv(&[k1, 0.0, 0.0, 0.0])),
            ("RADIAL", &[f, cx, cy, k1, k2]) => ([f, f, cx, cy], opencv(&[k1, k2, 0.0, 0.0])),
            ("OPENCV" | "FULL_OPENCV", &[fx, fy, cx, cy, ref k @ ..]) => ([fx, fy, cx, cy], opencv(k)),
            ("SIMPLE_RADIAL_FISHEYE", &[f, cx, cy, k1]) => ([f, f, cx, cy], fisheye([k1, 0.0, 0.0, 0.0])),
            ("RADIAL_FISHEYE", &[f, cx, cy, k1, k2]) => ([f, f, cx, cy], fisheye([k1, k2, 0.0, 0.0])),
            ("OPENCV_FISHEYE", &[fx, fy, cx, cy, k1, k2, k3, k4]) => {
                ([fx, fy, cx, cy], fisheye([k1, k2, k3, k4]))
            }
            ("THIN_PRISM_FISHEYE", &[fx, fy, cx, cy, k1, k2, p1, p2, k3, k4, s1, s2])
                if [p1, p2, s1, s2] == none =>
            {
                ([fx, fy, cx, cy], fisheye([k1, k2, k3, k4]))
            }
            _ => return None,
        })
    }
}
