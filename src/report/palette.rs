//! 256 colors for a whole film: found by a small neural network (Dekker 1994), and mixed by dots, so that what lies between two of them
//! has no edge (Floyd and Steinberg 1976).

use std::collections::HashMap;

use color_quant::NeuQuant;
use image::imageops::{ColorMap, dither};
use image::{Rgb, RgbImage};

use crate::parallel;

/// Colors that are shown to the network, about.
const SHOWN: usize = 400_000;

/// Bits of a channel by which the nearest color is looked up.
const BITS: u32 = 6;

/// Up to 256 colors, and which is nearest to any.
pub(super) struct Palette {
    colors: Vec<[u8; 3]>,
    nearest: Vec<u8>,
}

impl Palette {
    /// That of some frames.
    pub(super) fn of(frames: &[RgbImage]) -> Palette {
        let all: usize = frames.iter().map(|frame| frame.len() / 3).sum();
        // No multiple of a width, which would be a column.
        let stride = (all / SHOWN).max(1) | 1;
        let shown = frames.iter().flat_map(|frame| frame.pixels()).step_by(stride).map(|pixel| pixel.0);
        let mut counts: HashMap<[u8; 3], usize> = HashMap::new();
        let mut bytes = vec![];
        for color in shown {
            *counts.entry(color).or_default() += 1;
            bytes.extend([color[0], color[1], color[2], 255]);
        }
        // The network's colors are near; the one that most pixels have is exact, so that it stays without a dot.
        let most = counts.iter().max_by_key(|(color, count)| (**count, **color)).map(|(color, _)| *color);
        let mut colors: Vec<[u8; 3]> = most.into_iter().collect();
        if counts.len() <= 256 {
            let mut rest: Vec<[u8; 3]> = counts.into_keys().filter(|color| Some(*color) != most).collect();
            rest.sort_unstable();
            colors.extend(rest);
        } else {
            let network = NeuQuant::new(3, 255, &bytes);
            colors.extend(network.color_map_rgb().as_chunks::<3>().0);
        }
        let nearest = nearest(&colors);
        Palette { colors, nearest }
    }

    /// Red, green, blue, color after color.
    pub(super) fn bytes(&self) -> Vec<u8> {
        self.colors.concat()
    }

    /// A frame in these colors, as their numbers.
    pub(super) fn dotted(&self, frame: &RgbImage) -> Vec<u8> {
        let mut frame = frame.clone();
        // A line of pixels has no neighbors below to hand its error to.
        if frame.width() > 1 && frame.height() > 1 {
            dither(&mut frame, self);
        }
        frame.pixels().map(|pixel| self.index_of(pixel) as u8).collect()
    }
}

/// The number of the color that is nearest to the middle of each cube of a lookup.
fn nearest(colors: &[[u8; 3]]) -> Vec<u8> {
    let (side, step) = (1 << BITS, 1 << (8 - BITS));
    let slices = parallel::map(side, |r| {
        let at = |n: usize| (step * n + step / 2) as i32;
        let mut slice = Vec::with_capacity(side * side);
        for (g, b) in (0..side * side).map(|n| (n / side, n % side)) {
            let middle = [at(r), at(g), at(b)];
            let distance = |color: &[u8; 3]| {
                color.iter().zip(middle).map(|(&x, y)| (i32::from(x) - y).pow(2)).sum::<i32>()
            };
            slice.push((0..colors.len()).min_by_key(|&n| distance(&colors[n])).unwrap_or(0) as u8);
        }
        slice
    });
    slices.concat()
}

impl ColorMap for Palette {
    type Color = Rgb<u8>;

    fn index_of(&self, color: &Rgb<u8>) -> usize {
        let cell = color.0.iter().fold(0, |cell, &x| cell << BITS | usize::from(x >> (8 - BITS)));
        let found = self.nearest[cell].into();
        // Colors of one cube are told apart where they are exact.
        if self.colors[found] == color.0 {
            found
        } else {
            self.colors.iter().position(|known| *known == color.0).unwrap_or(found)
        }
    }

    fn map_color(&self, color: &mut Rgb<u8>) {
        *color = Rgb(self.colors[self.index_of(color)]);
    }
}
