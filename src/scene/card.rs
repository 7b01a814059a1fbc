//! A picture by formula, for 2D fields: letters with hard edges over a zone plate, whose frequency grows outward.

use ndarray::Array3;

use crate::math::cos_pi;

/// Columns of a letter, five wide, seven high; bit 6 is the top row.
const LETTERS: [(char, [u8; 5]); 8] = [
    ('N', [0x7f, 0x20, 0x10, 0x08, 0x7f]),
    ('E', [0x7f, 0x49, 0x49, 0x49, 0x41]),
    ('R', [0x7f, 0x48, 0x4c, 0x4a, 0x31]),
    ('F', [0x7f, 0x48, 0x48, 0x48, 0x40]),
    ('O', [0x3e, 0x41, 0x41, 0x41, 0x3e]),
    ('A', [0x3f, 0x48, 0x48, 0x48, 0x3f]),
    ('C', [0x3e, 0x41, 0x41, 0x41, 0x22]),
    ('L', [0x7f, 0x01, 0x01, 0x01, 0x01]),
];

/// The card, (size, size, 3) in [0, 1].
///
/// With p in [-1, 1]^2 the plate is 0.5 + 0.5 cos(pi f |p|^2 / 2), f = size / 8: its frequency, f |p| / 2 periods a unit, stays
/// below a quarter of the pixels' at the edges' middles, so that the card is the same at every size.
pub fn card(size: usize) -> Array3<f32> {
    let lines = ["NERF", "ORACLE"];
    Array3::from_shape_fn((size, size, 3), |(j, i, k)| {
        let unit = |n: usize| (n as f64 + 0.5) / size as f64;
        let (u, v) = (unit(i), unit(j));
        let (x, y) = (2.0 * u - 1.0, 2.0 * v - 1.0);
        let plate = 0.5 + 0.5 * cos_pi(size as f64 / 16.0 * (x * x + y * y));
        let tint = [0.35 + 0.5 * u, 0.35 + 0.5 * v, 0.8 - 0.4 * u][k];
        let ink = [0.98, 0.95, 0.85][k];
        let written = (0..2).any(|line| {
            // Cells of 1/40 of the card; a letter takes 5 and a gap of 1.
            let cells = 6 * lines[line].len() - 1;
            let column = u * 40.0 - (40 - cells) as f64 / 2.0;
            let row = v * 40.0 - [11.0, 22.0][line];
            inked(lines[line], column, row)
        });
        if written { ink } else { (tint * (0.25 + 0.75 * plate)) as f32 }
    })
}

/// Whether a cell of a line of text is ink.
fn inked(line: &str, column: f64, row: f64) -> bool {
    if column < 0.0 || !(0.0..7.0).contains(&row) {
        return false;
    }
    let (column, row) = (column as usize, row as usize);
    let letter = line.chars().nth(column / 6).and_then(|c| LETTERS.iter().find(|(name, _)| *name == c));
    letter.is_some_and(|(_, columns)| column % 6 < 5 && columns[column % 6] >> (6 - row) & 1 == 1)
}
