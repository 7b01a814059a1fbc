//! Pictures: PNG, JPEG and GIF read as floats, floats written as PNG.

use std::io::{self, Cursor};
use std::path::Path;

use image::{DynamicImage, ImageFormat, ImageReader, Limits, RgbImage};
use ndarray::{Array3, ArrayView3};

use super::photo::Photo;
use crate::error::{Error, Input, Result};
use crate::files;

/// The most bytes a picture may take when decoded.
const LARGEST: u64 = 1 << 30;

/// Reads a picture as (H, W, 3) in [0, 1], transparent pixels over black.
///
/// # Errors
/// As [`read_rgba`].
pub fn read(path: &Path) -> Result<Array3<f32>> {
    Ok(over(read_rgba(path)?.view(), [0.0; 3]))
}

/// Reads a picture as (H, W, 4): red, green, blue and opacity (not multiplied in; 1 where the file has none), each in [0, 1].
///
/// # Errors
/// Where the file can't be read, isn't a picture, or is too large to decode.
pub fn read_rgba(path: &Path) -> Result<Array3<f32>> {
    // 32 bits a channel keep what 16-bit files hold.
    let picture = decode(path)?.into_rgba32f();
    let shape = (picture.height() as usize, picture.width() as usize, 4);
    Ok(Array3::from_shape_vec(shape, picture.into_raw()).expect("a picture's length is its shape's"))
}

/// Reads a picture over a background, as bytes where the file has bytes.
///
/// # Errors
/// As [`read_rgba`].
pub fn read_photo(path: &Path, background: [f32; 3]) -> Result<Photo> {
    let picture = decode(path)?;
    let (height, width) = (picture.height() as usize, picture.width() as usize);
    let color = picture.color();
    if color.bytes_per_pixel() > color.channel_count() {
        let rgba = picture.into_rgba32f();
        let shape = (height, width, 4);
        let rgba = Array3::from_shape_vec(shape, rgba.into_raw()).expect("a picture's length is its shape's");
        let cut = rgba.iter().skip(3).step_by(4).any(|&a| a < 1.0);
        return Ok(Photo::fine(over(rgba.view(), background), cut));
    }
    Ok(if color.has_alpha() {
        Photo::cut(height, width, picture.into_rgba8().into_raw().as_chunks().0.to_vec(), background)
    } else {
        Photo::opaque(height, width, picture.into_rgb8().into_raw().as_chunks().0.to_vec())
    })
}

fn decode(path: &Path) -> Result<DynamicImage> {
    let bytes = std::fs::read(path).map_err(Error::reading(path))?;
    let decode = || {
        let mut reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format()?;
        let mut limits = Limits::default();
        limits.max_alloc = Some(LARGEST);
        reader.limits(limits);
        reader.decode()
    };
    decode().map_err(|error| {
        let remedy = "Save it again as PNG or JPEG.";
        Error::input(Input {
            file: path.display(),
            field: "picture",
            found: error,
            expected: "a whole PNG, JPEG or GIF file",
            remedy,
        })
    })
}

/// Drops the opacity: c a + b (1 - a) over background `b`.
pub fn over(rgba: ArrayView3<f32>, background: [f32; 3]) -> Array3<f32> {
    let (height, width, _) = rgba.dim();
    Array3::from_shape_fn((height, width, 3), |(j, i, k)| {
        let a = rgba[[j, i, 3]];
        rgba[[j, i, k]] * a + background[k] * (1.0 - a)
    })
}

/// (H, W, 3) in [0, 1] to bytes: round(255 x), NaN to 0.
pub fn to_rgb(picture: ArrayView3<f32>) -> RgbImage {
    RgbImage::from_fn(picture.dim().1 as u32, picture.dim().0 as u32, |i, j| {
        let byte = |k| (picture[[j as usize, i as usize, k]].clamp(0.0, 1.0) * 255.0).round() as u8;
        image::Rgb([byte(0), byte(1), byte(2)])
    })
}

/// Writes (H, W, 3) in [0, 1] as an 8-bit PNG.
///
/// # Errors
/// Where the file can't be written.
pub fn write_png(path: &Path, picture: ArrayView3<f32>) -> Result<()> {
    write_rgb(path, &to_rgb(picture))
}

/// Writes bytes as a PNG.
///
/// # Errors
/// Where the file can't be written.
pub fn write_rgb(path: &Path, picture: &RgbImage) -> Result<()> {
    let mut bytes = Cursor::new(Vec::new());
    let encoded = picture.write_to(&mut bytes, ImageFormat::Png);
    encoded.map_err(io::Error::other).map_err(Error::writing(path))?;
    files::write(path, bytes.into_inner())
}
