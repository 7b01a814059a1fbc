//! Frames as one GIF.

use std::path::Path;

use image::codecs::gif::{GifEncoder, Repeat};
use image::{Delay, DynamicImage, Frame, RgbImage};

use crate::error::{Error, Input, Result};
use crate::files;

/// Writes frames as a GIF that repeats for ever.
///
/// # Errors
/// Where the file can't be written.
pub(crate) fn write_gif(path: &Path, frames: &[RgbImage], frames_per_second: u32) -> Result<()> {
    files::write_with(path, |out| {
        // Speed 10 of 1 (best palette) to 30 (fastest).
        let mut encoder = GifEncoder::new_with_speed(out, 10);
        encoder.set_repeat(Repeat::Infinite).map_err(std::io::Error::other)?;
        for frame in frames {
            let rgba = DynamicImage::ImageRgb8(frame.clone()).into_rgba8();
            let delay = Delay::from_numer_denom_ms(1000, frames_per_second);
            encoder.encode_frame(Frame::from_parts(rgba, 0, 0, delay)).map_err(std::io::Error::other)?;
        }
        Ok(())
    })
}

/// Rejects a film without frames before an hour of rendering.
pub(crate) fn check_count(count: usize, scene: &str) -> Result<()> {
    if count > 0 {
        return Ok(());
    }
    let remedy = "Render an orbit: `path` orbit:60.";
    Err(Error::input(Input {
        file: scene,
        field: "test path",
        found: "no cameras",
        expected: "at least one",
        remedy,
    }))
}
