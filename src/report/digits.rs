//! Numbers in a picture: digits of 3 x 5 pixels, white.

use image::{Rgb, RgbImage};

/// A sign's rows from above, three bits each, the highest on the left.
#[rustfmt::skip]
const SIGNS: [(char, [u8; 5]); 13] = [
    ('0', [0b111, 0b101, 0b101, 0b101, 0b111]), ('1', [0b010, 0b110, 0b010, 0b010, 0b111]), ('2', [0b111, 0b001, 0b111, 0b100, 0b111]),
    ('3', [0b111, 0b001, 0b011, 0b001, 0b111]), ('4', [0b101, 0b101, 0b111, 0b001, 0b001]), ('5', [0b111, 0b100, 0b111, 0b001, 0b111]),
    ('6', [0b111, 0b100, 0b111, 0b101, 0b111]), ('7', [0b111, 0b001, 0b010, 0b010, 0b010]), ('8', [0b111, 0b101, 0b111, 0b101, 0b111]),
    ('9', [0b111, 0b101, 0b111, 0b001, 0b111]), ('.', [0b000, 0b000, 0b000, 0b000, 0b010]), ('-', [0b000, 0b000, 0b111, 0b000, 0b000]),
    ('e', [0b000, 0b111, 0b111, 0b100, 0b111]),
];

/// A number in three digits.
pub(super) fn short(x: f64) -> String {
    match x.abs() {
        0.0 => "0".into(),
        a if (0.001..1000.0).contains(&a) => {
            let digits = (2 - a.log10().floor() as i32).max(0) as usize;
            let text = format!("{x:.digits$}");
            if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').into() } else { text }
        }
        _ => format!("{x:.1e}"),
    }
}

/// How wide a text is.
pub(super) fn width(text: &str) -> u32 {
    (4 * text.chars().count() as u32).saturating_sub(1)
}

/// Draws a text with its upper left corner at (`x`, `y`); what lies outside of the picture isn't drawn.
pub(super) fn draw(picture: &mut RgbImage, x: u32, y: u32, text: &str) {
    for (n, sign) in text.chars().enumerate() {
        let rows = SIGNS.iter().find(|(known, _)| *known == sign).map_or([0; 5], |(_, rows)| *rows);
        for (j, row) in rows.into_iter().enumerate() {
            for i in (0..3).filter(|i| row >> (2 - i) & 1 == 1) {
                let at = (x + 4 * n as u32 + i, y + j as u32);
                if let Some(pixel) = picture.get_pixel_mut_checked(at.0, at.1) {
                    *pixel = Rgb([255; 3]);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_drawn() {
        let cases =
            [(2.0, "2"), (6.5, "6.5"), (0.125, "0.125"), (1234.5, "1.2e3"), (0.0, "0"), (400.0, "400")];
        for (x, text) in cases {
            assert_eq!(short(x), text);
            assert!(text.chars().all(|sign| SIGNS.iter().any(|(known, _)| *known == sign)), "{text}");
        }
        let mut picture = RgbImage::new(8, 6);
        draw(&mut picture, 1, 0, "17");
        let row =
            |j| (0..8).map(|i| if picture[(i, j)].0 == [255; 3] { '#' } else { ' ' }).collect::<String>();
        assert_eq!(
            (0..6).map(row).collect::<Vec<_>>(),
            ["  #  ###", " ##    #", "  #   # ", "  #   # ", " ###  # ", "        "]
        );
        draw(&mut picture, 7, 4, "8");
        assert_eq!(width("17"), 7);
    }
}
