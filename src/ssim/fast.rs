//! SSIM of whole pictures, in the form that is published: a window's weights are a product, so that sums go down its rows first and then
//! across, 2 x 11 terms a pixel where the oracle has 121.
//!
//! In f64, where the mean of a^2 less that of a, squared, loses nothing that shows beside c2: within 1e-12 of the oracle (a test).

use ndarray::ArrayView3;

use super::{Moments, weights};
use crate::convention::SsimWindow;
use crate::math::Sum;
use crate::parallel;

/// Pixels along a side of a window.
const SIZE: usize = 11;

/// What windows sum up of a pixel of both pictures.
type Sums = [f64; 5];

/// [`super::ssim`] in its default form, row by row on all threads.
///
/// # Panics
/// Where the shapes differ or a side is below 11.
pub fn ssim(a: ArrayView3<f64>, b: ArrayView3<f64>, peak: f64) -> f64 {
    assert_eq!(a.dim(), b.dim(), "a and b: images of the same shape");
    let (height, width, channels) = a.dim();
    assert!(height >= SIZE && width >= SIZE, "images of at least 11 x 11 pixels");
    let (a, b) = (a.as_standard_layout(), b.as_standard_layout());
    let pictures = [&a, &b].map(|picture| picture.as_slice().expect("standard layout"));
    let rows = parallel::map(height - SIZE + 1, |j| {
        let along = width * channels;
        let columns = down(pictures.map(|picture| &picture[j * along..(j + SIZE) * along]), along);
        across(&columns, channels, peak)
    });
    let mut sum = Sum::default();
    rows.iter().for_each(|&row| sum.add(row));
    sum.value() / (rows.len() * (width - SIZE + 1) * channels) as f64
}

/// The sums of each column over the rows of a window.
fn down([a, b]: [&[f64]; 2], along: usize) -> Vec<Sums> {
    let mut columns = vec![[0.0; 5]; along];
    for ((a, b), w) in a.chunks(along).zip(b.chunks(along)).zip(weights(SsimWindow::Gaussian)) {
        for ((sums, &a), &b) in columns.iter_mut().zip(a).zip(b) {
            let terms = [a, b, a * a, b * b, a * b];
            (0..5).for_each(|n| sums[n] += w * terms[n]);
        }
    }
    columns
}

/// The similarity of all windows of a row, added up.
fn across(columns: &[Sums], channels: usize, peak: f64) -> f64 {
    let weights = weights(SsimWindow::Gaussian);
    let mut sum = 0.0;
    for first in 0..columns.len() - (SIZE - 1) * channels {
        let mut window = [0.0; 5];
        for (sums, w) in columns[first..].iter().step_by(channels).zip(&weights) {
            (0..5).for_each(|n| window[n] += w * sums[n]);
        }
        let [mean_a, mean_b, a2, b2, ab] = window;
        let (var_a, var_b, cov) = (a2 - mean_a * mean_a, b2 - mean_b * mean_b, ab - mean_a * mean_b);
        let [luminance, over, structure, under] = Moments { mean_a, mean_b, var_a, var_b, cov }.parts(peak);
        sum += luminance * structure / (over * under);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Key, Purpose};
    use crate::ssim::{self, Form};
    use ndarray::Array3;

    /// Pictures of a size, the second one near the first.
    fn pictures(height: usize, width: usize, channels: usize) -> [Array3<f64>; 2] {
        let key = Key::new(height as u64, Purpose::Rays);
        let noise = key.uniforms(0, 0, 2 * height * width * channels);
        let at = |j, i, c| (j * width + i) * channels + c;
        let smooth = |j: usize, i: usize| (0.3 * j as f64).sin() * (0.2 * i as f64).cos();
        let a = Array3::from_shape_fn((height, width, channels), |(j, i, c)| {
            0.5 + 0.3 * smooth(j, i) + 0.2 * noise[at(j, i, c)]
        });
        let b = Array3::from_shape_fn(a.dim(), |(j, i, c)| {
            a[[j, i, c]] + 0.1 * noise[height * width * channels + at(j, i, c)]
        });
        [a, b]
    }

    #[test]
    fn it_is_the_oracle() {
        for (height, width, channels) in [(11, 11, 1), (12, 31, 3), (40, 17, 3)] {
            let [a, b] = pictures(height, width, channels);
            let truth = ssim::ssim(a.view(), b.view(), 1.0, Form::default());
            let found = ssim(a.view(), b.view(), 1.0);
            assert!((found - truth).abs() < 1e-12, "{found} {truth}");
            assert!(truth < 0.999, "pictures that are alike show nothing");
        }
    }

    /// Nothing varies: what rounding leaves of the variances mustn't show.
    #[test]
    fn flat_pictures() {
        let flat = |x| Array3::from_elem((20, 20, 3), x);
        for [x, y] in [[0.7, 0.7], [0.7, 0.2], [1.0, 0.0]] {
            let (a, b) = (flat(x), flat(y));
            let truth = ssim::ssim(a.view(), b.view(), 1.0, Form::default());
            assert!((ssim(a.view(), b.view(), 1.0) - truth).abs() < 1e-12);
        }
    }
}
