//! The rays of a training step: pixels drawn at random, with their colors.

use glam::DVec2;
use ndarray::ArrayView4;

use super::pixel_position;
use crate::convention::PixelCenter;

/// How pixels are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PixelDraws {
    /// Each ray draws from all pixels of all images.
    Pool,
    /// `images` images are drawn first, and each gets N / M rays.
    PerImage {
        /// M, the number of images in a step.
        images: usize,
    },
}

/// One drawn pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelDraw {
    /// Which image.
    pub image: usize,
    /// Where its ray goes through, in pixels: column and row plus the pixel center's shift.
    pub uv: DVec2,
    /// The photograph's color there.
    pub rgb: [f64; 3],
}

/// The floor of u n, for u in [0, 1): which of n images, rows or columns a random number stands for. Whoever draws pixels draws so.
pub fn draw_index(u: f64, n: usize) -> usize {
    ((u * n as f64) as usize).min(n - 1)
}

/// One pixel of an (I, H, W, 3) stack from three numbers in [0, 1): image, row and column, each the floor of u times its range.
///
/// # Panics
/// Where there are no pixels, or they don't have 3 channels.
///
/// ```
/// use ndarray::Array4;
/// use nerf_oracle::{convention::PixelCenter, ray::draw_pixel};
/// let images = Array4::zeros((2, 4, 6, 3));
/// let draw = draw_pixel(images.view(), [0.5, 0.25, 0.99], PixelCenter::Half);
/// assert_eq!((draw.image, draw.uv.x, draw.uv.y), (1, 5.5, 1.5));
/// ```
pub fn draw_pixel(images: ArrayView4<f64>, u: [f64; 3], center: PixelCenter) -> PixelDraw {
    let (count, height, width, channels) = images.dim();
    assert_eq!(channels, 3, "images: (I, H, W, 3)");
    let (image, j, i) = (draw_index(u[0], count), draw_index(u[1], height), draw_index(u[2], width));
    let rgb = [images[[image, j, i, 0]], images[[image, j, i, 1]], images[[image, j, i, 2]]];
    PixelDraw { image, uv: pixel_position(i, j, center), rgb }
}

/// N pixels of an (I, H, W, 3) stack, with replacement. `u` holds N rows of three numbers in [0, 1): image, row, column.
///
/// With [`PixelDraws::PerImage`] ray n belongs to drawn image n mod M, whose number in `u` is that of ray n mod M.
///
/// # Panics
/// Where there are no pixels, they don't have 3 channels, or M is 0.
pub fn sample_random_rays(
    images: ArrayView4<f64>,
    draw: PixelDraws,
    u: &[[f64; 3]],
    center: PixelCenter,
) -> Vec<PixelDraw> {
    let mut rays = Vec::with_capacity(u.len());
    for (n, &[u_image, u_row, u_column]) in u.iter().enumerate() {
        let u_image = match draw {
            PixelDraws::Pool => u_image,
            PixelDraws::PerImage { images } => u[n % images][0],
        };
        rays.push(draw_pixel(images, [u_image, u_row, u_column], center));
    }
    rays
}
