//! Whether a picture file is there to its end. Decoders paint what is missing gray, or stop where they have all pixels that they need;
//! a file that was cut off shows at its last mark.

/// Whether a PNG, JPEG or GIF has its last mark where it belongs. What is no such file is for the decoder to say.
pub(super) fn whole(bytes: &[u8]) -> bool {
    match bytes {
        [0xff, 0xd8, ..] => jpeg(&bytes[2..]).is_some(),
        [0x89, b'P', b'N', b'G', ..] => png(bytes).is_some(),
        [b'G', b'I', b'F', ..] => gif(bytes).is_some(),
        _ => true,
    }
}

/// Segments up to the end of the image: mark, length, content. Behind a start of scan comes coded data, in which 0xff is followed by 0
/// or by a restart mark.
fn jpeg(mut rest: &[u8]) -> Option<()> {
    loop {
        rest = &rest[rest.iter().position(|&byte| byte == 0xff)?..];
        rest = &rest[rest.iter().position(|&byte| byte != 0xff)?..];
        let mark = rest[0];
        rest = &rest[1..];
        match mark {
            0xd9 => return Some(()),
            0 | 1 | 0xd0..=0xd8 => {}
            _ => {
                let length = u16::from_be_bytes(*rest.first_chunk()?);
                rest = rest.get(usize::from(length)..)?;
            }
        }
    }
}

/// Chunks up to IEND: length, name, content, checksum.
fn png(bytes: &[u8]) -> Option<()> {
    let mut rest = bytes.get(8..)?;
    loop {
        let length = u32::from_be_bytes(*rest.first_chunk()?) as usize;
        let name = rest.get(4..8)?;
        rest = rest.get(12..)?.get(length..)?;
        if name == b"IEND" {
            return Some(());
        }
    }
}

/// Blocks up to the trailer: extensions and images, each with a list of sub-blocks that ends with an empty one.
fn gif(bytes: &[u8]) -> Option<()> {
    let colors = |flags: u8| if flags & 0x80 == 0 { 0 } else { 3 << ((flags & 7) + 1) };
    let mut rest = bytes.get(13 + colors(*bytes.get(10)?)..)?;
    loop {
        let head = match rest.first()? {
            0x3b => return Some(()),
            0x21 => 2,
            0x2c => 11 + colors(*rest.get(9)?),
            _ => return None,
        };
        rest = rest.get(head..)?;
        while let Some(length) = Some(usize::from(*rest.first()?)).filter(|&length| length > 0) {
            rest = rest.get(1 + length..)?;
        }
        rest = &rest[1..];
    }
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use image::{DynamicImage, ImageFormat, Rgb, RgbImage};

    use super::*;

    /// Each file that the encoders write is whole, and none of its beginnings is.
    #[test]
    fn every_cut_shows() {
        let picture = RgbImage::from_fn(40, 30, |i, j| Rgb([(i * 6) as u8, (j * 8) as u8, (i * j) as u8]));
        for format in [ImageFormat::Jpeg, ImageFormat::Png, ImageFormat::Gif] {
            let mut bytes = Cursor::new(vec![]);
            DynamicImage::ImageRgb8(picture.clone()).write_to(&mut bytes, format).unwrap();
            let bytes = bytes.into_inner();
            assert!(whole(&bytes), "{format:?}");
            for length in 12..bytes.len() {
                assert!(!whole(&bytes[..length]), "{format:?}, {length} of {} bytes", bytes.len());
            }
        }
    }
}
