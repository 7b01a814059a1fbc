//! What a scene holds as one hash, whatever files it came from: another scene, or the same with a changed picture, has another.

use sha2::{Digest, Sha256};

use super::{Frame, Scene};
use crate::camera::{Camera, Distortion, Intrinsics, Lens};
use crate::parallel;

impl Scene {
    /// SHA-256 of all that is learned from and measured on, in hexadecimal digits: pictures, cameras, near, far and background.
    pub fn digest(&self) -> String {
        let frames: Vec<&Frame> = self.train.iter().chain(&self.val).collect();
        let mut whole = Sha256::new();
        whole.update((self.train.len() as u64).to_le_bytes());
        parallel::map(frames.len(), |n| of_frame(frames[n]))
            .into_iter()
            .for_each(|frame| whole.update(frame));
        let bounds = self.bounds.map(|(low, high)| [low, high].map(|corner| corner.to_array()).concat());
        let rest = [&[self.near, self.far], &self.background[..], &self.focus.to_array()].concat();
        numbers(&mut whole, &rest);
        numbers(&mut whole, &bounds.unwrap_or_default());
        hex(&whole.finalize())
    }
}

/// SHA-256 of one picture (H, W, 3), in hexadecimal digits.
#[cfg(feature = "cli")]
pub(crate) fn of_picture(picture: &ndarray::Array3<f32>) -> String {
    let mut hash = Sha256::new();
    numbers(&mut hash, &[picture.dim().0 as f64, picture.dim().1 as f64]);
    picture.iter().for_each(|x| hash.update(x.to_le_bytes()));
    hex(&hash.finalize())
}

/// Bytes as hexadecimal digits.
pub(crate) fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn of_frame(frame: &Frame) -> [u8; 32] {
    let mut hash = Sha256::new();
    camera(&mut hash, &frame.camera);
    if let Some(image) = &frame.image {
        image.each_part(|part| hash.update(part));
    }
    hash.finalize().into()
}

fn camera(hash: &mut Sha256, camera: &Camera) {
    let Camera { width, height, k: Intrinsics { fx, fy, cx, cy }, c2w, distortion } = *camera;
    numbers(hash, &[width as f64, height as f64, fx, fy, cx, cy]);
    numbers(hash, &c2w.to_cols_array());
    match distortion {
        None => {}
        Some(Lens::Opencv(Distortion { k1, k2, p1, p2, k3, k4, k5, k6 })) => {
            numbers(hash, &[k1, k2, p1, p2]);
            // Lenses without these keep the hash that they had before these were read.
            if [k3, k4, k5, k6] != [0.0; 4] {
                numbers(hash, &[k3, k4, k5, k6]);
            }
        }
        Some(Lens::Fisheye(k)) => {
            hash.update("fisheye");
            numbers(hash, &k);
        }
    }
}

fn numbers(hash: &mut Sha256, numbers: &[f64]) {
    numbers.iter().for_each(|x| hash.update(x.to_le_bytes()));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::photo::Photo;
    use crate::scene::{Options, load};

    /// The same scene gives the same hash; a camera or a pixel that is another gives another.
    #[test]
    fn a_change_shows() {
        let load = || load("builtin:spheres,size=8,views=4", &Options::default()).unwrap();
        let scene = load();
        assert_eq!(scene.digest(), load().digest());
        assert_eq!(scene.digest().len(), 64);
        let changed = |change: &dyn Fn(&mut Scene)| {
            let mut scene = load();
            change(&mut scene);
            scene.digest()
        };
        let pixel = |photo: &Photo| {
            let mut image = photo.to_array();
            image[[3, 4, 1]] += 0.01;
            Photo::from(image)
        };
        let digests = [
            scene.digest(),
            changed(&|scene| scene.far += 1e-9),
            changed(&|scene| scene.train[0].camera.k.fx += 1e-9),
            changed(&|scene| scene.val[0].camera.c2w.w_axis.x += 1e-9),
            changed(&|scene| scene.train[1].image = scene.train[1].image.as_ref().map(pixel)),
            changed(&|scene| scene.val[1].image = scene.val[1].image.as_ref().map(pixel)),
            changed(&|scene| scene.train.swap(0, 1)),
            changed(&|scene| scene.val.insert(0, scene.train[0].clone())),
        ];
        let distinct: std::collections::BTreeSet<&String> = digests.iter().collect();
        assert_eq!(distinct.len(), digests.len());
    }
}
