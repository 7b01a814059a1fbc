//! Depth in color: viridis (van der Walt and Smith 2015), whose steps look equally large, near bright and far dark; what is empty is black.

use colorous::VIRIDIS;
use image::{Rgb, RgbImage};

use super::digits;
use crate::evaluation::View;

/// Height of the scale under a picture.
const SCALE: u32 = 14;

/// From 0, near, to 1, far.
fn color(share: f64) -> [u8; 3] {
    let color = VIRIDIS.eval_continuous(1.0 - share.clamp(0.0, 1.0));
    [color.r, color.g, color.b]
}

/// The depth of a view between `near` and `far`, as dark as its rays are empty.
pub(crate) fn picture(view: &View, near: f64, far: f64) -> RgbImage {
    let (height, width) = view.depth.dim();
    RgbImage::from_fn(width as u32, height as u32, |i, j| {
        let at = [j as usize, i as usize];
        let share = (f64::from(view.depth[at]) - near) / (far - near);
        let opacity = f64::from(view.opacity[at].clamp(0.0, 1.0));
        Rgb(color(share).map(|x| (f64::from(x) * opacity).round() as u8))
    })
}

/// The same with its scale under it: the colors from near to far, with both distances where there is room for them.
pub(crate) fn with_scale(picture: &RgbImage, near: f64, far: f64) -> RgbImage {
    let (width, height) = picture.dimensions();
    let mut whole = RgbImage::new(width, height + SCALE);
    image::imageops::replace(&mut whole, picture, 0, 0);
    let labels = [near, far].map(digits::short);
    let widths = labels.each_ref().map(|label| digits::width(label));
    let room = width >= widths[0] + widths[1] + 24;
    let margins = if room { widths.map(|w| w + 6) } else { [1, 1] };
    let (from, to) = (margins[0], width.saturating_sub(margins[1]));
    for i in from..to {
        let share = f64::from(i - from) / f64::from((to - from - 1).max(1));
        (height + 3..height + SCALE - 2).for_each(|j| whole.put_pixel(i, j, Rgb(color(share))));
    }
    if room {
        digits::draw(&mut whole, 3, height + 5, &labels[0]);
        digits::draw(&mut whole, width - widths[1] - 3, height + 5, &labels[1]);
    }
    whole
}

#[cfg(test)]
mod tests {
    use ndarray::{Array2, Array3};

    use super::*;

    #[test]
    fn near_is_bright_far_is_dark_and_empty_is_black() {
        let mut view = View {
            rgb: Array3::zeros((1, 4, 3)),
            opacity: Array2::from_elem((1, 4), 1.0),
            depth: Array2::from_shape_vec((1, 4), vec![2.0, 4.0, 6.0, 9.0]).unwrap(),
        };
        let seen = picture(&view, 2.0, 6.0);
        // The ends and the middle of matplotlib's table.
        assert_eq!(seen[(0, 0)].0, [253, 231, 37]);
        let middle = seen[(1, 0)].0;
        assert!(middle.iter().zip([33, 145, 140]).all(|(a, b)| a.abs_diff(b) <= 2), "{middle:?}");
        assert_eq!((seen[(2, 0)].0, seen[(3, 0)].0), ([68, 1, 84], [68, 1, 84]));
        view.opacity.fill(0.0);
        assert_eq!(picture(&view, 2.0, 6.0)[(0, 0)].0, [0; 3]);
    }

    #[test]
    fn the_scale_lies_under_the_picture() {
        let whole = with_scale(&RgbImage::from_pixel(100, 20, Rgb([9; 3])), 2.0, 6.5);
        assert_eq!(whole.dimensions(), (100, 20 + SCALE));
        assert_eq!(whole[(50, 19)].0, [9; 3]);
        let row = |i: u32| whole[(i, 27)].0.map(u32::from).iter().sum::<u32>();
        assert!(row(20) > row(50) && row(50) > row(75), "near is on the left");
        let white = |range: std::ops::Range<u32>| {
            range.flat_map(|i| (20..34).map(move |j| (i, j))).filter(|&at| whole[at].0 == [255; 3]).count()
        };
        assert!(white(0..8) > 5 && white(82..100) > 12, "2 on the left, 6.5 on the right");
        for narrow in 1..40 {
            let whole = with_scale(&RgbImage::new(narrow, 1), 2.0, 6.0);
            assert_eq!(whole.dimensions(), (narrow, 1 + SCALE));
        }
    }
}
