//! Pictures: PNG, JPEG and GIF read as floats, floats written as PNG.

use std::cmp::Ordering;
use std::io::{self, BufReader, Cursor};
use std::path::Path;

use image::metadata::Orientation;
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits, RgbImage};
use ndarray::{Array3, ArrayView3};

use super::photo::Photo;
use super::whole::whole;
use crate::error::{Error, Input, Result};
use crate::files;
use crate::limits;

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
    // Decoded, as floats, and those copied.
    limits::fits(path.display(), 10.0 * held_bytes(path)? as f64, "Make the picture smaller.")?;
    // 32 bits a channel keep what 16-bit files hold.
    let picture = decode(path)?.into_rgba32f();
    let shape = (picture.height() as usize, picture.width() as usize, 4);
    Ok(Array3::from_shape_vec(shape, picture.into_raw()).expect("a picture's length is its shape's"))
}

/// Reads a picture over a background, as bytes where the file has bytes. Its pixels are taken as they are stored, as most programs
/// do; but where `stated`, the width and height that its camera is said to have, is upright and the picture lies, or the other way round, it
/// is turned as its EXIF data say.
///
/// # Errors
/// As [`read_rgba`].
pub fn read_photo(path: &Path, background: [f32; 3], stated: Option<[usize; 2]>) -> Result<Photo> {
    let mut picture = decode(path)?;
    let otherwise = |[width, height]: [usize; 2]| match picture.width().cmp(&picture.height()) {
        Ordering::Less => width > height,
        Ordering::Equal => false,
        Ordering::Greater => width < height,
    };
    if stated.is_some_and(otherwise) {
        picture.apply_orientation(orientation(path)?);
    }
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

/// Reads a mask, height, width and a truth value a pixel: whatever isn't black counts.
///
/// # Errors
/// As [`read_rgba`].
pub fn read_mask(path: &Path) -> Result<(usize, usize, Vec<bool>)> {
    let picture = decode(path)?.into_rgb8();
    let (height, width) = (picture.height() as usize, picture.width() as usize);
    let counts = picture.into_raw().as_chunks().0.iter().map(|rgb: &[u8; 3]| *rgb != [0; 3]).collect();
    Ok((height, width, counts))
}

/// Bytes of a picture in memory once [`read_photo`] has read it, from the beginning of the file.
///
/// # Errors
/// Where it isn't a picture, or has more than `limits::PIXELS`.
pub fn held_bytes(path: &Path) -> Result<u64> {
    let file = BufReader::new(files::open(path, limits::PICTURE_FILE)?);
    let reader = ImageReader::new(file).with_guessed_format().map_err(Error::reading(path))?;
    let decoder = reader.into_decoder().map_err(|error| wrong(path, error))?;
    let (width, height) = decoder.dimensions();
    let (width, height) = (u64::from(width), u64::from(height));
    if width * height > limits::PIXELS {
        let expected = format!("at most {} pixels", limits::PIXELS);
        let remedy = "Make it smaller: no training sees that many pixels.";
        let found = format!("{width}x{height} pixels");
        return Err(Error::input(Input { file: path.display(), field: "picture", found, expected, remedy }));
    }
    let color = decoder.color_type();
    let fine = color.bytes_per_pixel() > color.channel_count();
    // Three floats, or a byte a channel.
    Ok(width * height * if fine { 12 } else { 3 + u64::from(color.has_alpha()) })
}

/// What a file's EXIF data say of how its picture is to be turned.
fn orientation(path: &Path) -> Result<Orientation> {
    let file = BufReader::new(files::open(path, limits::PICTURE_FILE)?);
    let reader = ImageReader::new(file).with_guessed_format().map_err(Error::reading(path))?;
    let said = reader.into_decoder().and_then(|mut decoder| decoder.orientation());
    said.map_err(|error| wrong(path, error))
}

fn decode(path: &Path) -> Result<DynamicImage> {
    held_bytes(path)?;
    let bytes = files::read(path, limits::PICTURE_FILE)?;
    if !whole(&bytes) {
        return Err(wrong(path, format!("a file that was cut off, {} bytes", bytes.len())));
    }
    let decode = || {
        let mut reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format()?;
        let mut most = Limits::default();
        // 4 channels of 16 bits, and as much again for the decoder.
        most.max_alloc = Some(16 * limits::PIXELS);
        reader.limits(most);
        reader.decode()
    };
    decode().map_err(|error| wrong(path, error))
}

fn wrong(path: &Path, found: impl ToString) -> Error {
    let (expected, remedy) =
        ("a whole PNG, JPEG or GIF file", "Fetch it again, or save it again as PNG or JPEG.");
    Error::input(Input { file: path.display(), field: "picture", found, expected, remedy })
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
