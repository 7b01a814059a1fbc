//! Pictures side by side.

use image::{Rgb, RgbImage, imageops};

/// Pictures of one size in rows of `columns`, with a thin white gap.
pub(crate) fn contact_sheet(pictures: &[RgbImage], columns: usize) -> RgbImage {
    const GAP: u32 = 4;
    let (w, h) = pictures.first().map_or((1, 1), |p| p.dimensions());
    let columns = columns.clamp(1, pictures.len().max(1)) as u32;
    let rows = (pictures.len() as u32).div_ceil(columns);
    let size = |cells: u32, cell: u32| cells * cell + cells.saturating_sub(1) * GAP;
    let mut sheet = RgbImage::from_pixel(size(columns, w), size(rows, h).max(1), Rgb([255; 3]));
    for (n, picture) in pictures.iter().enumerate() {
        let (column, row) = (n as u32 % columns, n as u32 / columns);
        imageops::replace(&mut sheet, picture, i64::from(column * (w + GAP)), i64::from(row * (h + GAP)));
    }
    sheet
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_stand_in_rows() {
        let pictures: Vec<_> = (0..3).map(|n| RgbImage::from_pixel(2, 3, Rgb([n; 3]))).collect();
        let sheet = contact_sheet(&pictures, 2);
        assert_eq!(sheet.dimensions(), (2 * 2 + 4, 2 * 3 + 4));
        assert_eq!([sheet[(0, 0)][0], sheet[(6, 0)][0], sheet[(0, 7)][0], sheet[(6, 7)][0]], [0, 1, 2, 255]);
    }
}
