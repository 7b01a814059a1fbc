//! A camera of its own that looks at points, lines and pictures in space: drawn over each other by depth, twice as large as shown.

use glam::{DMat4, DVec2, DVec3};
use image::{Rgb, RgbImage, imageops};

use crate::camera::{Camera, Intrinsics, camera_to_pixel};
use crate::convention::PixelCenter;
use crate::ray::{camera_ray, pixel_position};

/// How many drawn pixels, along each side, become one that is shown.
const FINER: usize = 2;

/// Anything nearer than this share of the distance to the target isn't drawn: perspective would magnify it too much.
const NEAREST: f64 = 0.02;

/// A picture under construction.
pub(crate) struct Canvas {
    camera: Camera,
    pixels: RgbImage,
    depths: Vec<f64>,
    nearest: f64,
}

impl Canvas {
    /// An empty picture, `width` x `height` when shown, of `target` from `eye` with `up` pointing up, 40 degrees high.
    pub(crate) fn new(width: usize, height: usize, eye: DVec3, target: DVec3, up: DVec3) -> Canvas {
        let forward = (target - eye).normalize();
        let right = forward.cross(up).normalize();
        let down = forward.cross(right);
        let column = |v: DVec3| v.extend(0.0);
        let c2w = DMat4::from_cols(column(right), column(down), column(forward), eye.extend(1.0));
        let (width, height) = (width * FINER, height * FINER);
        let focal = 1.374 * height as f64;
        let k = Intrinsics { fx: focal, fy: focal, cx: width as f64 / 2.0, cy: height as f64 / 2.0 };
        Canvas {
            camera: Camera { width, height, k, c2w, distortion: None },
            pixels: RgbImage::from_pixel(width as u32, height as u32, Rgb([250, 250, 248])),
            depths: vec![f64::INFINITY; width * height],
            nearest: NEAREST * (target - eye).length(),
        }
    }

    /// The picture as it is shown.
    pub(crate) fn finish(self) -> RgbImage {
        let (width, height) = (self.camera.width / FINER, self.camera.height / FINER);
        imageops::resize(&self.pixels, width as u32, height as u32, imageops::FilterType::Triangle)
    }

    /// A point in this picture's camera space.
    fn seen(&self, x: DVec3) -> DVec3 {
        self.camera.c2w.inverse().transform_point3(x)
    }

    /// One pixel, unless something nearer is drawn there.
    fn dot(&mut self, i: i64, j: i64, depth: f64, color: [u8; 3]) {
        let (width, height) = (self.camera.width as i64, self.camera.height as i64);
        if i < 0 || j < 0 || i >= width || j >= height {
            return;
        }
        let old = &mut self.depths[(j * width + i) as usize];
        if depth <= *old {
            *old = depth;
            self.pixels.put_pixel(i as u32, j as u32, Rgb(color));
        }
    }

    /// A disc of `radius` drawn pixels.
    pub(crate) fn point(&mut self, x: DVec3, radius: i64, color: [u8; 3]) {
        let seen = self.seen(x);
        if seen.z < self.nearest {
            return;
        }
        let at = camera_to_pixel(&self.camera.k, seen);
        for dj in -radius..=radius {
            for di in -radius..=radius {
                if di * di + dj * dj <= radius * radius {
                    self.dot(at.x.floor() as i64 + di, at.y.floor() as i64 + dj, seen.z, color);
                }
            }
        }
    }

    /// A straight line, two drawn pixels wide.
    pub(crate) fn line(&mut self, a: DVec3, b: DVec3, color: [u8; 3]) {
        let (mut a, mut b) = (self.seen(a), self.seen(b));
        if a.z < b.z {
            (a, b) = (b, a);
        }
        if a.z < self.nearest {
            return;
        }
        if b.z < self.nearest {
            b = a + (b - a) * ((a.z - self.nearest) / (a.z - b.z));
        }
        let (p, q) = (camera_to_pixel(&self.camera.k, a), camera_to_pixel(&self.camera.k, b));
        // A line that reaches far outside of the picture is still drawn in steps of a pixel, but not in more than this many.
        let steps = (q - p).abs().max_element().ceil().clamp(1.0, 50_000.0) as usize;
        for step in 0..=steps {
            let share = step as f64 / steps as f64;
            let at: DVec2 = p + (q - p) * share;
            // 1 / z is linear along a line on a picture.
            let depth = 1.0 / (1.0 / a.z + (1.0 / b.z - 1.0 / a.z) * share);
            let (i, j) = (at.x.floor() as i64, at.y.floor() as i64);
            for (di, dj) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                self.dot(i + di, j + dj, depth, color);
            }
        }
    }

    /// A photograph as a plane at `depth` in front of its camera; `pixel(u, v)` is its color at a share of its width and height.
    pub(crate) fn photograph(&mut self, shot: &Camera, depth: f64, pixel: impl Fn(f64, f64) -> [u8; 3]) {
        let corners = corners(shot, depth).map(|corner| self.seen(corner));
        if corners.iter().any(|corner| corner.z < self.nearest) {
            return;
        }
        let corners = corners.map(|corner| camera_to_pixel(&self.camera.k, corner));
        let low = corners.iter().fold(corners[0], |low, c| low.min(*c)).max(DVec2::ZERO);
        let end = DVec2::new(self.camera.width as f64, self.camera.height as f64);
        let high = corners.iter().fold(corners[0], |high, c| high.max(*c)).min(end);
        let (center, axis) = (shot.c2w.w_axis.truncate(), shot.c2w.z_axis.truncate());
        for j in low.y as usize..high.y.ceil().max(0.0) as usize {
            for i in low.x as usize..high.x.ceil().max(0.0) as usize {
                let Ok(ray) = camera_ray(&self.camera, pixel_position(i, j, PixelCenter::Half)) else {
                    continue;
                };
                let t = (depth - (ray.o - center).dot(axis)) / ray.d.dot(axis);
                let seen = shot.c2w.inverse().transform_point3(ray.at(t));
                let uv = camera_to_pixel(&shot.k, seen);
                let (u, v) = (uv.x / shot.width as f64, uv.y / shot.height as f64);
                if t > 0.0 && (0.0..1.0).contains(&u) && (0.0..1.0).contains(&v) {
                    let depth = self.seen(ray.at(t)).z;
                    self.dot(i as i64, j as i64, depth, pixel(u, v));
                }
            }
        }
    }
}

/// The corners of a camera's picture at `depth`, in order around it.
pub(crate) fn corners(camera: &Camera, depth: f64) -> [DVec3; 4] {
    let (w, h) = (camera.width as f64, camera.height as f64);
    [(0.0, 0.0), (w, 0.0), (w, h), (0.0, h)].map(|(u, v)| {
        let x_c = crate::camera::pixel_to_camera(&camera.k, DVec2::new(u, v), depth);
        crate::camera::transform(&camera.c2w, x_c)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Looks at the origin along -z from 10 away, y up.
    fn canvas() -> Canvas {
        Canvas::new(60, 40, DVec3::Z * 10.0, DVec3::ZERO, DVec3::Y)
    }

    fn middle(canvas: Canvas) -> [u8; 3] {
        canvas.finish()[(30, 20)].0
    }

    #[test]
    fn what_is_nearer_covers_what_is_behind_whatever_comes_first() {
        let (red, green) = ([200, 0, 0], [0, 200, 0]);
        let (mut a, mut b) = (canvas(), canvas());
        a.point(DVec3::ZERO, 4, red);
        a.point(DVec3::Z, 4, green);
        b.point(DVec3::Z, 4, green);
        b.point(DVec3::ZERO, 4, red);
        assert_eq!((middle(a), middle(b)), (green, green));
    }

    #[test]
    fn a_line_through_the_eye_s_plane_is_cut_off_and_the_rest_is_drawn() {
        let mut canvas = canvas();
        canvas.line(DVec3::new(0.0, -1.0, 20.0), DVec3::new(0.0, 0.0, 0.0), [9; 3]);
        let drawn = canvas.finish();
        // Below the middle, where the line comes toward the eye; when the picture is reduced, it is mixed with its neighbors.
        assert!(drawn[(30, 25)].0[0] < 150, "{:?}", drawn[(30, 25)]);
        assert_eq!(drawn[(30, 10)].0, [250, 250, 248]);
    }

    #[test]
    fn a_photograph_stands_upright_before_its_camera() {
        let mut canvas = canvas();
        let k = Intrinsics { fx: 10.0, fy: 10.0, cx: 5.0, cy: 5.0 };
        let down = DMat4::from_cols(
            DVec3::X.extend(0.0),
            (-DVec3::Y).extend(0.0),
            (-DVec3::Z).extend(0.0),
            (DVec3::Z * 3.0).extend(1.0),
        );
        let shot = Camera { width: 10, height: 10, k, c2w: down, distortion: None };
        canvas.photograph(&shot, 2.0, |u, v| [(u * 10.0) as u8, (v * 10.0) as u8, 0]);
        let drawn = canvas.finish();
        // The plane is at z = 1, 9 from the eye, from -1 to 1: 40 * 1.374 / 9 = 6.1 pixels to each side.
        let (left, right) = (drawn[(25, 20)].0, drawn[(34, 20)].0);
        assert!(left[0] < 2 && right[0] > 7, "{left:?} {right:?}");
        let (top, bottom) = (drawn[(30, 15)].0, drawn[(30, 24)].0);
        assert!(top[1] < 2 && bottom[1] > 7, "{top:?} {bottom:?}");
        assert_eq!(drawn[(22, 20)].0, [250, 250, 248]);
    }
}
