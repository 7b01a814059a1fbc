//! 256 colors for a whole film: found by a small neural network (Dekker 1994), and mixed by dots, so that what lies between two of them
//! has no edge (Floyd and Steinberg 1976).

use std::collections::HashMap;

use color_quant::NeuQuant;
use image::RgbImage;

use crate::parallel;

/// Colors that are shown to the network, about.
const SHOWN: usize = 400_000;

/// How far beyond black and white a color may be wanted, where those before it weren't dark or bright enough.
const MARGIN: i32 = 96;

/// Side of the cubes by which the nearest color is looked up, and how many there are along each channel.
const STEP: i32 = 7;
const SIDE: usize = 64;

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
        let mut colors = kept(&counts);
        if counts.len() <= 256 {
            let mut rest: Vec<[u8; 3]> = counts.into_keys().filter(|color| !colors.contains(color)).collect();
            rest.sort_unstable();
            colors.extend(rest);
        } else {
            let network = NeuQuant::new(3, 256 - colors.len(), &bytes);
            colors.extend(network.color_map_rgb().as_chunks::<3>().0);
        }
        let nearest = nearest(&colors);
        Palette { colors, nearest }
    }

    /// Red, green, blue, color after color.
    pub(super) fn bytes(&self) -> Vec<u8> {
        self.colors.concat()
    }

    /// A frame in these colors, as their numbers: what a pixel's color is off is handed on to the pixels that come after it. Nothing is cut
    /// off at black or white, as what is lost there would be lost all over a dark or a bright part.
    pub(super) fn dotted(&self, frame: &RgbImage) -> Vec<u8> {
        let width = frame.width() as usize;
        let mut numbers = Vec::with_capacity(frame.len() / 3);
        // Sixteenths, of this row and of the next; a pixel more at either end.
        let [mut here, mut below] = [vec![[0; 3]; width + 2], vec![[0; 3]; width + 2]];
        for row in frame.rows() {
            for (i, pixel) in row.enumerate() {
                let wanted: [i32; 3] = std::array::from_fn(|k| i32::from(pixel.0[k]) + here[i + 1][k] / 16);
                let number = self.nearest_to(wanted);
                numbers.push(number as u8);
                for k in 0..3 {
                    let off = (wanted[k] - i32::from(self.colors[number][k])).clamp(-MARGIN, MARGIN);
                    here[i + 2][k] += 7 * off;
                    below[i][k] += 3 * off;
                    below[i + 1][k] += 5 * off;
                    below[i + 2][k] += off;
                }
            }
            here = std::mem::replace(&mut below, vec![[0; 3]; width + 2]);
        }
        numbers
    }

    fn nearest_to(&self, wanted: [i32; 3]) -> usize {
        let exact = |color: &[u8; 3]| (0..3).all(|k| i32::from(color[k]) == wanted[k]);
        // Colors of one cube are told apart where they are exact.
        self.colors.iter().position(exact).unwrap_or_else(|| {
            let cell = wanted.iter().fold(0, |cell, &x| {
                let at = (x + MARGIN).clamp(0, 255 + 2 * MARGIN) / STEP;
                cell * SIDE + at as usize
            });
            self.nearest[cell].into()
        })
    }
}

/// Colors that are kept as they are: the one that most pixels have, so that it stays without a dot, and the outermost ones. The network's
/// colors are means, and means alone would cut off whatever is brightest, darkest or purest.
fn kept(counts: &HashMap<[u8; 3], usize>) -> Vec<[u8; 3]> {
    let most = counts.iter().max_by_key(|(color, count)| (**count, **color)).map(|(color, _)| *color);
    let mut kept: Vec<[u8; 3]> = most.into_iter().collect();
    for n in 0..27 {
        let along = [n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1];
        let reach = |color: &[u8; 3]| (0..3).map(|k| along[k] * i32::from(color[k])).sum::<i32>();
        let outermost = counts.keys().max_by_key(|color| (reach(color), **color)).copied();
        kept.extend(outermost.filter(|color| !kept.contains(color)));
    }
    kept
}

/// The number of the color that is nearest to the middle of each cube of a lookup.
fn nearest(colors: &[[u8; 3]]) -> Vec<u8> {
    let slices = parallel::map(SIDE, |r| {
        let at = |n: usize| STEP * n as i32 + STEP / 2 - MARGIN;
        let mut slice = Vec::with_capacity(SIDE * SIDE);
        for (g, b) in (0..SIDE * SIDE).map(|n| (n / SIDE, n % SIDE)) {
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
