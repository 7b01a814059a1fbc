//! Pictures in memory, as small as they came: a byte a channel where the file had bytes.

use std::sync::Arc;

use ndarray::Array3;

use super::mask::Mask;

/// A picture whose colors are read one by one; copies share the pixels.
#[derive(Clone, Debug)]
pub struct Photo {
    height: usize,
    width: usize,
    /// What lies under transparent pixels.
    background: [f32; 3],
    seen_through: bool,
    pixels: Arc<Pixels>,
    /// Which pixels count; all, where there is none.
    mask: Option<Arc<Mask>>,
}

#[derive(Debug)]
enum Pixels {
    /// Red, green, blue; 255 is 1.
    Opaque(Vec<[u8; 3]>),
    /// The same with opacity, not multiplied in.
    Cut(CutOut),
    /// Colors in [0, 1] of files that hold more than bytes.
    Fine(Vec<[f32; 3]>),
}

/// Of each row, what lies between its first and its last pixel that isn't wholly transparent: most of a cut-out is empty.
#[derive(Debug)]
struct CutOut {
    width: usize,
    /// The column of each row's first pixel, and where that lies among `pixels`; one more for the end.
    rows: Vec<(usize, usize)>,
    pixels: Vec<[u8; 4]>,
}

impl CutOut {
    fn new(width: usize, all: &[[u8; 4]]) -> Self {
        let (mut rows, mut pixels) = (vec![], vec![]);
        for row in all.chunks(width.max(1)) {
            let seen = |pixel: &[u8; 4]| pixel[3] > 0;
            let first = row.iter().position(seen).unwrap_or(0);
            let end = row.iter().rposition(seen).map_or(0, |last| last + 1);
            rows.push((first, pixels.len()));
            // Whatever color is there, nobody sees it.
            pixels.extend(row[first..end].iter().map(|pixel| if seen(pixel) { *pixel } else { [0; 4] }));
        }
        rows.push((0, pixels.len()));
        pixels.shrink_to_fit();
        CutOut { width, rows, pixels }
    }

    /// Pixel `n` of the whole picture, row by row.
    #[inline(always)]
    fn at(&self, n: usize) -> [u8; 4] {
        let (j, i) = (n / self.width, n % self.width);
        let ((first, start), (_, end)) = (self.rows[j], self.rows[j + 1]);
        // Left of the first the number wraps around, and lies beyond the end too.
        let place = i.wrapping_sub(first);
        if place < end - start { self.pixels[start + place] } else { [0; 4] }
    }

    /// The rows as they are seen, margins and all.
    fn whole_rows(&self) -> impl Iterator<Item = Vec<[u8; 4]>> {
        self.rows.windows(2).map(|ends| {
            let ((first, start), (_, end)) = (ends[0], ends[1]);
            let mut row = vec![[0; 4]; self.width];
            row[first..first + end - start].copy_from_slice(&self.pixels[start..end]);
            row
        })
    }
}

/// A byte's value.
fn value(byte: u8) -> f32 {
    f32::from(byte) / 255.0
}

impl Photo {
    fn new(height: usize, width: usize, background: [f32; 3], pixels: Pixels) -> Self {
        let seen_through = matches!(pixels, Pixels::Cut(_));
        Photo { height, width, background, seen_through, pixels: Arc::new(pixels), mask: None }
    }

    /// Of bytes, row by row.
    ///
    /// # Panics
    /// Where there aren't width x height pixels.
    pub fn opaque(height: usize, width: usize, pixels: Vec<[u8; 3]>) -> Self {
        assert_eq!(pixels.len(), height * width, "a pixel for every place");
        Photo::new(height, width, [0.0; 3], Pixels::Opaque(pixels))
    }

    /// Of bytes with opacity, over a background. Without transparent pixels the opacity isn't kept.
    ///
    /// # Panics
    /// Where there aren't width x height pixels.
    pub fn cut(height: usize, width: usize, pixels: Vec<[u8; 4]>, background: [f32; 3]) -> Self {
        assert_eq!(pixels.len(), height * width, "a pixel for every place");
        if pixels.iter().all(|pixel| pixel[3] == 255) {
            return Photo::opaque(height, width, pixels.iter().map(|&[r, g, b, _]| [r, g, b]).collect());
        }
        Photo::new(height, width, background, Pixels::Cut(CutOut::new(width, &pixels)))
    }

    /// (H, W, 3) in [0, 1], composited already where it had transparent pixels.
    pub fn fine(image: Array3<f32>, seen_through: bool) -> Self {
        let (height, width, _) = image.dim();
        let pixels = image.rows().into_iter().map(|c| [c[0], c[1], c[2]]).collect();
        Photo { seen_through, ..Photo::new(height, width, [0.0; 3], Pixels::Fine(pixels)) }
    }

    /// The same picture, of which only some pixels count.
    ///
    /// # Panics
    /// Where the mask hasn't as many pixels.
    pub fn masked(self, mask: Mask) -> Self {
        assert_eq!(mask.len(), self.len(), "a place for every pixel");
        Photo { mask: (!mask.is_full()).then(|| Arc::new(mask)), ..self }
    }

    /// Which pixels count, where not all do.
    pub fn mask(&self) -> Option<&Mask> {
        self.mask.as_deref()
    }

    /// Height and width.
    pub fn size(&self) -> (usize, usize) {
        (self.height, self.width)
    }

    /// Number of pixels.
    pub fn len(&self) -> usize {
        self.height * self.width
    }

    /// Whether it has no pixel.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Whether it has transparent pixels.
    pub fn seen_through(&self) -> bool {
        self.seen_through
    }

    /// The color of row `j`, column `i`.
    pub fn at(&self, j: usize, i: usize) -> [f32; 3] {
        self.pixel(j * self.width + i)
    }

    /// The color of pixel `n`, row by row: c a + b (1 - a) over background `b`.
    #[inline(always)]
    pub fn pixel(&self, n: usize) -> [f32; 3] {
        self.pixel_over(n, self.background)
    }

    /// The color of pixel `n` over another background; where the picture's opacity isn't kept, the color that it has.
    #[inline(always)]
    pub fn pixel_over(&self, n: usize, background: [f32; 3]) -> [f32; 3] {
        match &*self.pixels {
            Pixels::Opaque(pixels) => pixels[n].map(value),
            Pixels::Cut(pixels) => {
                let [r, g, b, a] = pixels.at(n).map(value);
                let over = |c: f32, k: usize| c * a + background[k] * (1.0 - a);
                [over(r, 0), over(g, 1), over(b, 2)]
            }
            Pixels::Fine(pixels) => pixels[n],
        }
    }

    /// Whether the opacity of its pixels is kept, so that they can be seen over any background.
    pub fn keeps_opacity(&self) -> bool {
        matches!(*self.pixels, Pixels::Cut(_))
    }

    /// Its pixels, a part at a time: bytes, wholly transparent ones 0, or floats in little-endian order.
    pub(crate) fn each_part(&self, mut part: impl FnMut(&[u8])) {
        match &*self.pixels {
            Pixels::Opaque(pixels) => part(pixels.as_flattened()),
            Pixels::Cut(pixels) => pixels.whole_rows().for_each(|row| part(row.as_flattened())),
            Pixels::Fine(pixels) => {
                for some in pixels.chunks(1024) {
                    part(&some.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>());
                }
            }
        }
        if let Some(mask) = &self.mask {
            (0..self.len()).for_each(|n| part(&[u8::from(mask.counts(n))]));
        }
    }

    /// All colors, row by row.
    pub fn colors(&self) -> impl Iterator<Item = [f32; 3]> {
        (0..self.len()).map(|n| self.pixel(n))
    }

    /// The colors along its four sides; a corner is on two of them.
    pub fn border(&self) -> impl Iterator<Item = [f32; 3]> {
        let (h, w) = self.size();
        let along = (0..w).flat_map(move |i| [(0, i), (h - 1, i)]);
        let down = (0..h).flat_map(move |j| [(j, 0), (j, w - 1)]);
        along.chain(down).map(|(j, i)| self.at(j, i))
    }

    /// (H, W, 3).
    pub fn to_array(&self) -> Array3<f32> {
        let flat = self.colors().flatten().collect();
        Array3::from_shape_vec((self.height, self.width, 3), flat).expect("three channels a pixel")
    }

    /// Every `n`th pixel of every `n`th row, from the first on.
    pub fn thinned(&self, n: usize) -> Self {
        let (height, width) = (self.height.div_ceil(n), self.width.div_ceil(n));
        let at = |m: usize| m / width * n * self.width + m % width * n;
        let of = 0..height * width;
        let pixels = match &*self.pixels {
            Pixels::Opaque(pixels) => Pixels::Opaque(of.clone().map(|m| pixels[at(m)]).collect()),
            Pixels::Cut(pixels) => {
                let all: Vec<_> = of.clone().map(|m| pixels.at(at(m))).collect();
                Pixels::Cut(CutOut::new(width, &all))
            }
            Pixels::Fine(pixels) => Pixels::Fine(of.clone().map(|m| pixels[at(m)]).collect()),
        };
        let small = Photo::new(height, width, self.background, pixels);
        let mask = self.mask().and_then(|mask| Mask::new(of.map(|m| mask.counts(at(m))).collect()));
        mask.map_or(small.clone(), |mask| small.masked(mask))
    }

    /// One pixel for each whole square of `n` x `n`: the mean of its premultiplied colors over the mean of its opacities; columns and
    /// rows left over at the right and at the bottom go. Bytes stay bytes.
    pub fn shrunk(&self, n: usize) -> Self {
        let (height, width) = (self.height / n, self.width / n);
        // Sums of color times opacity, and of opacity, over a square.
        let sums = |square: usize| {
            let (j, i) = (square / width * n, square % width * n);
            let mut sums = [0.0f64; 4];
            for m in (0..n * n).map(|m| (j + m / n) * self.width + i + m % n) {
                let [r, g, b, a] = match &*self.pixels {
                    Pixels::Opaque(pixels) => [pixels[m][0], pixels[m][1], pixels[m][2], 255].map(f64::from),
                    Pixels::Cut(pixels) => pixels.at(m).map(f64::from),
                    Pixels::Fine(pixels) => {
                        let [r, g, b] = pixels[m].map(|c| 255.0 * f64::from(c));
                        [r, g, b, 255.0]
                    }
                };
                let new = [r * a, g * a, b * a, a];
                (0..4).for_each(|k| sums[k] += new[k]);
            }
            sums
        };
        let color = |s: [f64; 4]| [0, 1, 2].map(|k| if s[3] > 0.0 { s[k] / s[3] } else { 0.0 });
        let byte = |x: f64| x.round() as u8;
        let squares = (0..height * width).map(sums);
        let pixels = match &*self.pixels {
            Pixels::Opaque(_) => Pixels::Opaque(squares.map(|s| color(s).map(byte)).collect()),
            Pixels::Cut(_) => {
                let whole = |s: [f64; 4]| {
                    let [r, g, b] = color(s).map(byte);
                    [r, g, b, byte(s[3] / (n * n) as f64)]
                };
                Pixels::Cut(CutOut::new(width, &squares.map(whole).collect::<Vec<_>>()))
            }
            Pixels::Fine(_) => Pixels::Fine(squares.map(|s| color(s).map(|c| (c / 255.0) as f32)).collect()),
        };
        let small = Photo::new(height, width, self.background, pixels);
        match &self.mask {
            // Where the pixels that count are all among those left over, all count.
            Some(mask) => match mask.shrunk(self.height, self.width, n) {
                Some(mask) => small.masked(mask),
                None => small,
            },
            None => small,
        }
    }
}

impl From<Array3<f32>> for Photo {
    /// (H, W, 3) in [0, 1].
    fn from(image: Array3<f32>) -> Self {
        Photo::fine(image, false)
    }
}

/// The same colors, however they are kept.
impl PartialEq for Photo {
    fn eq(&self, other: &Self) -> bool {
        self.size() == other.size() && self.mask == other.mask && self.colors().eq(other.colors())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colors_by_hand() {
        let cut = Photo::cut(1, 2, vec![[255, 0, 0, 128], [10, 20, 30, 0]], [0.0, 1.0, 0.5]);
        let a = 128.0 / 255.0;
        assert_eq!(cut.at(0, 0), [a, 1.0 - a, 0.5 * (1.0 - a)]);
        assert_eq!((cut.at(0, 1), cut.seen_through()), ([0.0, 1.0, 0.5], true));
        let whole = Photo::cut(2, 1, vec![[51, 102, 255, 255]; 2], [1.0; 3]);
        assert_eq!((whole.at(1, 0), whole.seen_through()), ([0.2, 0.4, 1.0], false));
        assert_eq!(Photo::from(whole.to_array()), whole);
        assert_ne!(cut, whole);
    }

    /// What is left out between cut-outs' edges and the picture's is transparent, wherever it lies.
    #[test]
    fn a_cut_out_keeps_no_empty_margins() {
        let (seen, hole, clear) = ([9, 8, 7, 255], [1, 2, 3, 0], [0; 4]);
        #[rustfmt::skip]
        let all = [
            clear, hole, clear, clear,
            clear, seen, hole, seen,
            seen, clear, clear, clear,
        ];
        let kept = CutOut::new(4, &all);
        assert_eq!(kept.pixels, [seen, clear, seen, seen]);
        let rows: Vec<_> = kept.whole_rows().collect();
        assert_eq!(rows, [[clear; 4], [clear, seen, clear, seen], [seen, clear, clear, clear]]);
        assert_eq!((0..12).map(|n| kept.at(n)).collect::<Vec<_>>(), rows.concat());
        let photo = Photo::cut(3, 4, all.to_vec(), [0.0, 0.5, 1.0]);
        assert_eq!((photo.at(0, 3), photo.at(2, 1)), ([0.0, 0.5, 1.0], [0.0, 0.5, 1.0]));
        assert_eq!(photo.at(2, 0), [9, 8, 7].map(value));
    }

    /// A half-covered red square of which three pixels are clear: opacity a quarter, its color as it was.
    #[test]
    fn a_shrunk_picture_is_the_area_mean_of_premultiplied_colors() {
        let mut pixels = vec![[0, 0, 255, 0]; 15];
        pixels[0] = [200, 100, 0, 255];
        // 5 columns, 3 rows: the last of both are left over.
        let small = Photo::cut(3, 5, pixels, [0.0; 3]).shrunk(2);
        assert_eq!(small.size(), (1, 2));
        let a = 64.0 / 255.0;
        let [r, g, b] = small.at(0, 0);
        assert!((r - a * 200.0 / 255.0).abs() < 1e-6 && (g - a * 100.0 / 255.0).abs() < 1e-6 && b == 0.0);
        assert_eq!(small.at(0, 1), [0.0; 3]);
        let fine = Photo::from(Array3::from_shape_fn((4, 4, 3), |(j, i, k)| (j * 4 + i + k) as f32 / 32.0));
        let mean = |x: f32| (x + x + 1.0 + x + 4.0 + x + 5.0) / 4.0 / 32.0;
        assert_eq!(fine.shrunk(2).at(1, 1), [mean(10.0), mean(11.0), mean(12.0)]);
        let bytes = Photo::opaque(2, 2, vec![[0, 0, 0], [255, 0, 1], [255, 0, 1], [0, 0, 1]]).shrunk(2);
        assert_eq!(bytes.at(0, 0), [128.0 / 255.0, 0.0, 1.0 / 255.0]);
    }
}
