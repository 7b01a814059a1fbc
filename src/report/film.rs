//! Frames as one file: a GIF, an animated PNG in full color, or an MP4 by `ffmpeg`.

use std::fs;
use std::io;
use std::path::Path;
use std::process::Command;
use std::time::Duration;

use image::RgbImage;
use png::{BitDepth, ColorType};

use super::palette::Palette;
use crate::error::{Error, Input, Result};
use crate::files;
use crate::parallel;
use crate::process::{self, Ended};

/// What a film is written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Format {
    /// 256 colors, the same for the whole film, mixed by dots.
    Gif,
    /// Every color, and no loss; browsers play it.
    Png,
    /// What players and slides take.
    Mp4,
}

/// How long `ffmpeg` may take, and what it may say.
const TIME: Duration = Duration::from_secs(1800);
const WORDS: u64 = 1 << 20;

impl Format {
    /// The format that a file's name asks for; `None` where it is no film's.
    pub(crate) fn of(path: &Path) -> Option<Format> {
        let named =
            |format: &&(&str, Format)| path.extension().is_some_and(|end| end.eq_ignore_ascii_case(format.0));
        [("gif", Format::Gif), ("png", Format::Png), ("mp4", Format::Mp4)]
            .iter()
            .find(named)
            .map(|(_, format)| *format)
    }

    /// That this machine can write it, before an hour of rendering.
    ///
    /// # Errors
    /// Where `ffmpeg` is needed, and isn't on the path.
    pub(crate) fn check(self, path: &Path) -> Result<()> {
        if self != Format::Mp4 {
            return Ok(());
        }
        let mut version = Command::new("ffmpeg");
        version.arg("-version");
        let found = match process::run(version, Duration::from_secs(20), WORDS) {
            Ok(said) if said.status.success() => return Ok(()),
            Ok(said) => format!("one that ends with {}", said.status),
            Err(Ended::Other(error)) if error.kind() == io::ErrorKind::NotFound => "no such program".into(),
            Err(ended) => ended.in_words(Duration::from_secs(20), WORDS),
        };
        Err(Error::input(Input {
            file: path.display(),
            field: "ffmpeg",
            found,
            expected: "the program ffmpeg on the path, which makes MP4",
            remedy: "Install it, or write a .png (animated, in full color) or a .gif.",
        }))
    }

    /// Writes frames, which have one size, as a film that repeats for ever where its format knows of that.
    ///
    /// # Errors
    /// Where the file can't be written.
    pub(crate) fn write(self, path: &Path, frames: &[RgbImage], frames_per_second: u16) -> Result<()> {
        match self {
            Format::Gif => {
                files::write_with(path, |out| gif(out, frames, frames_per_second).map_err(io::Error::other))
            }
            Format::Png => {
                files::write_with(path, |out| png(out, frames, frames_per_second).map_err(io::Error::other))
            }
            Format::Mp4 => mp4(path, frames, frames_per_second),
        }
    }
}

fn gif(
    out: &mut impl io::Write,
    frames: &[RgbImage],
    frames_per_second: u16,
) -> Result<(), gif::EncodingError> {
    let side = |pixels: u32| u16::try_from(pixels).unwrap_or(u16::MAX);
    let (width, height) = frames.first().map_or((1, 1), |frame| frame.dimensions());
    let palette = Palette::of(frames);
    let mut encoder = gif::Encoder::new(out, side(width), side(height), &palette.bytes())?;
    encoder.set_repeat(gif::Repeat::Infinite)?;
    let dotted = parallel::map(frames.len(), |n| {
        let mut frame =
            gif::Frame::from_indexed_pixels(side(width), side(height), palette.dotted(&frames[n]), None);
        frame.delay = 100 / frames_per_second;
        frame.make_lzw_pre_encoded();
        frame
    });
    dotted.iter().try_for_each(|frame| encoder.write_lzw_pre_encoded_frame(frame))
}

fn png(
    out: &mut impl io::Write,
    frames: &[RgbImage],
    frames_per_second: u16,
) -> Result<(), png::EncodingError> {
    let (width, height) = frames.first().map_or((1, 1), |frame| frame.dimensions());
    let mut encoder = png::Encoder::new(out, width, height);
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_animated(frames.len() as u32, 0)?;
    encoder.set_frame_delay(1, frames_per_second)?;
    let mut writer = encoder.write_header()?;
    frames.iter().try_for_each(|frame| writer.write_image_data(frame))?;
    writer.finish()
}

/// By ffmpeg, from the frames' bytes in a folder of its own; sides are made even, as the format wants them.
fn mp4(path: &Path, frames: &[RgbImage], frames_per_second: u16) -> Result<()> {
    let folder = tempfile::tempdir().map_err(Error::writing(&std::env::temp_dir()))?;
    let (raw, film) = (folder.path().join("frames.rgb"), folder.path().join("film.mp4"));
    let mut bytes = io::BufWriter::new(fs::File::create(&raw).map_err(Error::writing(&raw))?);
    let written = frames.iter().try_for_each(|frame| io::Write::write_all(&mut bytes, frame));
    written.and_then(|()| io::Write::flush(&mut bytes)).map_err(Error::writing(&raw))?;
    let (width, height) = frames.first().map_or((1, 1), |frame| frame.dimensions());
    let mut ffmpeg = Command::new("ffmpeg");
    ffmpeg.args(["-hide_banner", "-nostdin", "-y", "-f", "rawvideo", "-pixel_format", "rgb24"]);
    ffmpeg.args(["-video_size", &format!("{width}x{height}"), "-framerate", &frames_per_second.to_string()]);
    ffmpeg.arg("-i").arg(&raw);
    ffmpeg.args([
        "-vf",
        "pad=ceil(iw/2)*2:ceil(ih/2)*2",
        "-pix_fmt",
        "yuv420p",
        "-b:v",
        "8M",
        "-movflags",
        "+faststart",
    ]);
    ffmpeg.arg(&film);
    let found = match process::run(ffmpeg, TIME, WORDS) {
        Ok(said) if said.status.success() && film.exists() => {
            return files::write(path, fs::read(&film).map_err(Error::reading(&film))?);
        }
        Ok(said) => {
            let words =
                String::from_utf8_lossy(&said.stderr).trim_end().lines().last().unwrap_or("").to_string();
            format!("{}: {words}", said.status)
        }
        Err(ended) => ended.in_words(TIME, WORDS),
    };
    Err(Error::input(Input {
        file: path.display(),
        field: "ffmpeg",
        found,
        expected: "a film",
        remedy: "Write a .png (animated, in full color) or a .gif.",
    }))
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

#[cfg(test)]
mod tests {
    use image::codecs::gif::GifDecoder;
    use image::codecs::png::PngDecoder;
    use image::{AnimationDecoder, Rgb};

    use super::*;

    /// A ramp from black to a bright red, and a highlight that is small and white.
    fn frames() -> Vec<RgbImage> {
        (0..3)
            .map(|n| {
                RgbImage::from_fn(60, 40, |i, j| match (i + n, j) {
                    (20..24, 10..14) => Rgb([255; 3]),
                    _ => Rgb([(4 * i) as u8, j as u8, 10 * n as u8]),
                })
            })
            .collect()
    }

    fn written(format: Format, frames: &[RgbImage]) -> Vec<u8> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("film");
        format.write(&path, frames, 20).unwrap();
        fs::read(path).unwrap()
    }

    #[test]
    fn names_say_what_is_written() {
        let of = |name: &str| Format::of(Path::new(name));
        assert_eq!(
            (of("a/film.GIF"), of("film.png"), of("b.mp4")),
            (Some(Format::Gif), Some(Format::Png), Some(Format::Mp4))
        );
        assert_eq!((of("film"), of("film.webm"), of(".gif")), (None, None, None));
    }

    /// Bit by bit, in order, at its pace.
    #[test]
    fn an_animated_png_has_every_color() {
        let bytes = written(Format::Png, &frames());
        let decoder = PngDecoder::new(io::Cursor::new(bytes)).unwrap().apng().unwrap();
        let read: Vec<image::Frame> = decoder.into_frames().map(|frame| frame.unwrap()).collect();
        assert_eq!(read.len(), 3);
        for (frame, was) in read.iter().zip(frames()) {
            assert_eq!(frame.delay().numer_denom_ms(), (50, 1));
            let back: RgbImage = image::DynamicImage::ImageRgba8(frame.buffer().clone()).into_rgb8();
            assert_eq!(back, was);
        }
    }

    /// Means of 4 x 4 pixels, as an eye sees dots, stay; so does a highlight, and black stays black.
    #[test]
    fn a_gif_has_neither_blocks_nor_cut_off_highlights() {
        let decoder = GifDecoder::new(io::Cursor::new(written(Format::Gif, &frames()))).unwrap();
        let read: Vec<image::Frame> = decoder.into_frames().map(|frame| frame.unwrap()).collect();
        assert_eq!(read.len(), 3);
        for (n, (frame, was)) in read.iter().zip(frames()).enumerate() {
            assert_eq!(frame.delay().numer_denom_ms(), (50, 1));
            let light = frame.buffer()[(21 - n as u32, 12)].0;
            assert!(light[..3].iter().all(|&x| x > 240), "{light:?}");
            for (i, j) in (0..15).flat_map(|i| (0..10).map(move |j| (4 * i, 4 * j))) {
                for k in 0..3 {
                    let sum = |at: &dyn Fn(u32, u32) -> u8| {
                        (0..16).map(|n| i32::from(at(i + n % 4, j + n / 4))).sum::<i32>() / 16
                    };
                    let (seen, wanted) =
                        (sum(&|i, j| frame.buffer()[(i, j)].0[k]), sum(&|i, j| was[(i, j)].0[k]));
                    assert!((seen - wanted).abs() <= 12, "{n} {i} {j} {k}: {seen}, not {wanted}");
                }
            }
        }
        for side in [1, 2] {
            let small = vec![RgbImage::from_pixel(side, 1, Rgb([7, 8, 9])); 2];
            let decoder = GifDecoder::new(io::Cursor::new(written(Format::Gif, &small))).unwrap();
            let frame = decoder.into_frames().next().unwrap().unwrap();
            assert_eq!(frame.buffer()[(0, 0)].0, [7, 8, 9, 255], "the color of most pixels is kept as it is");
        }
    }
}
