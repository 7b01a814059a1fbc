//! Structural similarity: how alike two pictures look, window by window.
//!
//! Wang et al. 2004. Letters: within a window, m_a and m_b are weighted means, v_a and v_b variances, v_ab the covariance.

use ndarray::ArrayView3;

use crate::convention::{SsimPadding, SsimVariance, SsimWindow};
use crate::math::{Sum, exp};

pub(crate) mod arrays;
pub mod backward;
pub(crate) mod bound;
pub(crate) mod cases;
pub(crate) mod component;
pub mod fast;
pub(crate) mod honest;
pub mod judge;
pub(crate) mod mistakes;

pub use judge::judge;

#[cfg(test)]
mod tests;

/// How code bases take windows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Form {
    /// Size and weights of a window.
    pub window: SsimWindow,
    /// Windows that reach beyond the picture.
    pub padding: SsimPadding,
    /// What variances are divided by.
    pub variance: SsimVariance,
}

/// The mean over all channels and windows of (2 m_a m_b + c1) (2 v_ab + c2) / ((m_a^2 + m_b^2 + c1) (v_a + v_b + c2)), with
/// c1 = (0.01 peak)^2 and c2 = (0.03 peak)^2.
///
/// # Shapes
/// (H, W, C) both, H and W at least 11.
///
/// # Units
/// Those of the colors, from 0 to `peak`; the result has none, and is 1 for equal pictures.
///
/// # Convention
/// As published: 11 x 11 pixels, weights of a Gaussian with standard deviation 1.5, which add up to 1, and windows inside of the picture.
/// `form` has what others take; their figures differ (ME2).
///
/// # Panics
/// Where the shapes differ or a side is below 11.
///
/// ```
/// use ndarray::Array3;
/// use nerf_oracle::ssim::{Form, ssim};
/// let flat = |x| Array3::from_elem((11, 12, 3), x);
/// assert_eq!(ssim(flat(0.5).view(), flat(0.5).view(), 1.0, Form::default()), 1.0);
/// // Black on white: c1 / (1 + c1), and nothing of the variances.
/// assert!(ssim(flat(0.0).view(), flat(1.0).view(), 1.0, Form::default()) < 1e-4);
/// ```
pub fn ssim(a: ArrayView3<f64>, b: ArrayView3<f64>, peak: f64, form: Form) -> f64 {
    let windows = Windows::new(a, b, form);
    let mut sum = Sum::default();
    for place in windows.places() {
        let [luminance, over, structure, under] = windows.moments(place).parts(peak);
        sum.add(luminance * structure / (over * under));
    }
    sum.value() / windows.places().len() as f64
}

/// Two pictures and the windows over them.
struct Windows<'a> {
    a: ArrayView3<'a, f64>,
    b: ArrayView3<'a, f64>,
    /// The weights of a window along one axis; they add up to 1.
    weights: Vec<f64>,
    /// Of each window, which row its rows are; `None` beyond the picture, where zeros are.
    rows: Vec<Vec<Option<usize>>>,
    /// The same of columns.
    columns: Vec<Vec<Option<usize>>>,
    /// What variances are multiplied by: 1, or n / (n - 1).
    unbiased: f64,
}

impl<'a> Windows<'a> {
    fn new(a: ArrayView3<'a, f64>, b: ArrayView3<'a, f64>, form: Form) -> Windows<'a> {
        assert_eq!(a.dim(), b.dim(), "a and b: images of the same shape");
        let (height, width, _) = a.dim();
        assert!(height >= 11 && width >= 11, "images of at least 11 x 11 pixels");
        let weights = weights(form.window);
        let n = (weights.len() * weights.len()) as f64;
        let unbiased = if form.variance == SsimVariance::Sample { n / (n - 1.0) } else { 1.0 };
        let [rows, columns] = [height, width].map(|length| reach(length, weights.len(), form.padding));
        Windows { a, b, weights, rows, columns, unbiased }
    }

    /// All windows: down, across, and channel.
    fn places(&self) -> Vec<[usize; 3]> {
        let mut places = vec![];
        for j in 0..self.rows.len() {
            for i in 0..self.columns.len() {
                (0..self.a.dim().2).for_each(|c| places.push([j, i, c]));
            }
        }
        places
    }

    /// The pixels of a window: their weights, and where they are.
    fn pixels(&self, [j, i, c]: [usize; 3]) -> Vec<(f64, Option<[usize; 3]>)> {
        let mut pixels = vec![];
        for (y, row) in self.rows[j].iter().enumerate() {
            for (x, column) in self.columns[i].iter().enumerate() {
                let at = row.zip(*column).map(|(row, column)| [row, column, c]);
                pixels.push((self.weights[y] * self.weights[x], at));
            }
        }
        pixels
    }

    /// Means, variances and covariance of a window.
    fn moments(&self, place: [usize; 3]) -> Moments {
        let pixels = self.pixels(place);
        let (mut mean_a, mut mean_b) = (Sum::default(), Sum::default());
        for (weight, at) in &pixels {
            mean_a.add(weight * value(&self.a, *at));
            mean_b.add(weight * value(&self.b, *at));
        }
        let (mean_a, mean_b) = (mean_a.value(), mean_b.value());
        // Central moments: E[a^2] - E[a]^2 would cancel where the window is nearly flat.
        let (mut var_a, mut var_b, mut cov) = (Sum::default(), Sum::default(), Sum::default());
        for (weight, at) in &pixels {
            let (a, b) = (value(&self.a, *at) - mean_a, value(&self.b, *at) - mean_b);
            var_a.add(weight * a * a);
            var_b.add(weight * b * b);
            cov.add(weight * a * b);
        }
        let [var_a, var_b, cov] = [var_a, var_b, cov].map(|sum| self.unbiased * sum.value());
        Moments { mean_a, mean_b, var_a, var_b, cov }
    }
}

/// The color there, 0 beyond the picture.
fn value(image: &ArrayView3<f64>, at: Option<[usize; 3]>) -> f64 {
    at.map_or(0.0, |at| image[at])
}

/// The size of a window whose pixels all weigh the same.
fn uniform(window: SsimWindow) -> Option<usize> {
    match window {
        SsimWindow::Gaussian => None,
        SsimWindow::Uniform => Some(7),
        SsimWindow::UniformEleven => Some(11),
        SsimWindow::UniformThree => Some(3),
    }
}

/// The weights of a window along one axis; they add up to 1.
fn weights(window: SsimWindow) -> Vec<f64> {
    if let Some(size) = uniform(window) {
        return vec![1.0 / size as f64; size];
    }
    let weights: Vec<f64> = (-5..=5).map(|x| exp(-0.5 * f64::from(x * x) / (1.5 * 1.5))).collect();
    let mut sum = Sum::default();
    weights.iter().for_each(|&w| sum.add(w));
    weights.iter().map(|w| w / sum.value()).collect()
}

/// Which pixels of an axis each window of `size` covers.
fn reach(length: usize, size: usize, padding: SsimPadding) -> Vec<Vec<Option<usize>>> {
    let (length, size, before) = (length as i64, size as i64, size as i64 / 2);
    let (first, windows) =
        if padding == SsimPadding::Valid { (0, length - size + 1) } else { (-before, length) };
    let pixel = |n: i64| match padding {
        SsimPadding::Reflect if n < length => Some(n.unsigned_abs() as usize),
        SsimPadding::Reflect => Some((2 * (length - 1) - n) as usize),
        _ => (0..length).contains(&n).then_some(n as usize),
    };
    (0..windows).map(|window| (0..size).map(|n| pixel(first + window + n)).collect()).collect()
}

/// What a window knows of its pixels.
struct Moments {
    mean_a: f64,
    mean_b: f64,
    var_a: f64,
    var_b: f64,
    cov: f64,
}

impl Moments {
    /// Luminance over its largest value, and structure over its largest.
    fn parts(&self, peak: f64) -> [f64; 4] {
        let (c1, c2) = ((0.01 * peak) * (0.01 * peak), (0.03 * peak) * (0.03 * peak));
        let Moments { mean_a, mean_b, var_a, var_b, cov } = self;
        let luminance = 2.0 * mean_a * mean_b + c1;
        [luminance, mean_a * mean_a + mean_b * mean_b + c1, 2.0 * cov + c2, var_a + var_b + c2]
    }
}
