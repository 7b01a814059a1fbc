//! Closed forms, what other programs have, borders by hand, and slopes.

use ndarray::{Array3, s};
use proptest::prelude::*;

use super::{Form, backward, reach, ssim, weights};
use crate::contract::testing::{properties, slope};
use crate::convention::{SsimPadding, SsimVariance, SsimWindow};
use crate::math::exp;

const FORM: Form =
    Form { window: SsimWindow::Gaussian, padding: SsimPadding::Valid, variance: SsimVariance::Population };

/// All forms.
fn forms() -> Vec<Form> {
    let mut all = vec![];
    for window in [SsimWindow::Gaussian, SsimWindow::Uniform] {
        for padding in [SsimPadding::Valid, SsimPadding::Zero, SsimPadding::Reflect] {
            for variance in [SsimVariance::Population, SsimVariance::Sample] {
                all.push(Form { window, padding, variance });
            }
        }
    }
    all
}

fn noise(scale: f64) -> Array3<f64> {
    Array3::from_shape_fn((13, 17, 3), |(j, i, c)| {
        scale * ((37 * j + 101 * i + 53 * c) as f64 * 0.618_033_988_75).fract()
    })
}

#[test]
fn me2_ssim_window_11_deviation_1_5() {
    let kernel = weights(SsimWindow::Gaussian);
    assert_eq!(kernel.len(), 11);
    assert!((kernel.iter().sum::<f64>() - 1.0).abs() < 1e-15);
    assert!((kernel[5] / kernel[8] - exp(2.0)).abs() < 1e-13, "two deviations beside the middle: e^2");
    assert_eq!(weights(SsimWindow::Uniform), [1.0 / 7.0; 7]);
    let a = noise(1.0);
    assert_eq!(ssim(a.view(), a.view(), 1.0, FORM), 1.0);
    // Two flat pictures differ only in luminance: (2ab + c1) / (a^2 + b^2 + c1).
    let flat = |x| Array3::from_elem((11, 12, 3), x);
    let expected = (2.0 * 0.4 * 0.5 + 1e-4) / (0.16 + 0.25 + 1e-4);
    assert!((ssim(flat(0.4).view(), flat(0.5).view(), 1.0, FORM) - expected).abs() < 1e-14);
    // A negative has covariance -variance: with means of 1/2 over the window, the structure term changes its sign.
    let negative = a.mapv(|x| 1.0 - x);
    assert!(ssim(a.view(), negative.view(), 1.0, FORM) < -0.8);
    // Symmetric, and independent of the unit.
    let b = noise(0.9);
    assert_eq!(ssim(a.view(), b.view(), 1.0, FORM), ssim(b.view(), a.view(), 1.0, FORM));
    let bytes = |x: &Array3<f64>| x.mapv(|x| 255.0 * x);
    let of_bytes = ssim(bytes(&a).view(), bytes(&b).view(), 255.0, FORM);
    assert!((of_bytes - ssim(a.view(), b.view(), 1.0, FORM)).abs() < 1e-12);
}

#[test]
fn ssim_of_a_contrast_change_by_hand() {
    // Around one window's mean m, b = m + s (a - m): (2 s v + c2) / ((1 + s^2) v + c2) with v the window's variance.
    let a = Array3::from_shape_fn((11, 11, 1), |(j, i, _)| if (i + j) % 2 == 0 { 0.25 } else { 0.75 });
    let kernel = weights(SsimWindow::Gaussian);
    let weight = |j: usize, i: usize| kernel[j] * kernel[i];
    let (mut mean, mut square) = (0.0, 0.0);
    for j in 0..11 {
        for i in 0..11 {
            mean += weight(j, i) * a[[j, i, 0]];
            square += weight(j, i) * a[[j, i, 0]] * a[[j, i, 0]];
        }
    }
    let v = square - mean * mean;
    let b = a.mapv(|x| mean + 0.5 * (x - mean));
    for (variance, factor) in [(SsimVariance::Population, 1.0), (SsimVariance::Sample, 121.0 / 120.0)] {
        let expected = (factor * v + 9e-4) / (1.25 * factor * v + 9e-4);
        assert!((ssim(a.view(), b.view(), 1.0, Form { variance, ..FORM }) - expected).abs() < 1e-13);
    }
}

/// At 40 digits by mpmath; scikit-image 0.26, kornia 0.9 and torchmetrics 1.9 agree (`tools/libraries/beside.py`, `pictures`).
#[test]
fn ssim_as_other_programs_have_it() {
    let a = noise(1.0);
    let of = |b: Array3<f64>| ssim(a.view(), b.view(), 1.0, FORM);
    assert!((of(noise(0.9)) - 0.989_014_841_255_578_3).abs() < 1e-15);
    assert!((of(a.mapv(|x| 1.0 - x)) + 0.984_848_964_453_503).abs() < 1e-15);
}

/// What lies beyond the picture: nothing, zeros, or the picture once more, its edge not repeated.
#[test]
fn borders_by_hand() {
    let pixels = |padding| reach(4, 3, padding);
    assert_eq!(pixels(SsimPadding::Valid), [[Some(0), Some(1), Some(2)], [Some(1), Some(2), Some(3)]]);
    let zero = pixels(SsimPadding::Zero);
    assert_eq!(
        (zero.len(), &zero[0], &zero[3]),
        (4, &vec![None, Some(0), Some(1)], &vec![Some(2), Some(3), None])
    );
    let reflect = reach(6, 5, SsimPadding::Reflect);
    assert_eq!(reflect[0], [Some(2), Some(1), Some(0), Some(1), Some(2)]);
    assert_eq!(reflect[5], [Some(3), Some(4), Some(5), Some(4), Some(3)]);
}

/// Padding by hand is padding by convention: windows inside of the padded picture are those over the edge.
#[test]
fn padded_pictures_have_the_same_windows() {
    let (a, b) = (noise(1.0), noise(0.7));
    let padded = |x: &Array3<f64>, padding| {
        let at = |n: usize, length: usize| match padding {
            SsimPadding::Reflect => Some(n.abs_diff(5)).map(|n| n.min(2 * (length - 1) - n)),
            _ => (5..length + 5).contains(&n).then(|| n - 5),
        };
        let (h, w, c) = x.dim();
        Array3::from_shape_fn((h + 10, w + 10, c), |(j, i, c)| {
            at(j, h).zip(at(i, w)).map_or(0.0, |(j, i)| x[[j, i, c]])
        })
    };
    for padding in [SsimPadding::Zero, SsimPadding::Reflect] {
        let by_hand = ssim(padded(&a, padding).view(), padded(&b, padding).view(), 1.0, FORM);
        assert!((ssim(a.view(), b.view(), 1.0, Form { padding, ..FORM }) - by_hand).abs() < 1e-14);
    }
}

/// Any picture one pixel higher than a window.
fn picture() -> impl Strategy<Value = Array3<f64>> {
    prop::collection::vec(0.0..1.0, 12 * 11)
        .prop_map(|colors| Array3::from_shape_vec((12, 11, 1), colors).unwrap())
}

proptest! {
    // A simpler picture says no more, and takes long to find.
    #![proptest_config(proptest::test_runner::Config { cases: 6, max_shrink_iters: 0, ..properties() })]

    #[test]
    fn the_gradient_is_that_of_differences(a in picture(), b in picture(), g in -2.0..2.0) {
        for form in forms() {
            let by_hand = backward::ssim(a.view(), b.view(), 1.0, form, g);
            for at in [[0, 0, 0], [3, 10, 0], [6, 5, 0], [11, 2, 0]] {
                let moved = |s: f64| {
                    let mut a = a.clone();
                    a[at] += s;
                    g * ssim(a.view(), b.view(), 1.0, form)
                };
                let expected = slope(moved);
                prop_assert!((by_hand[at] - expected).abs() <= 1e-8 * (1.0 + expected.abs()), "{form:?} {at:?}");
            }
        }
    }
}

/// A pixel that no window covers has no gradient, and channels don't see each other.
#[test]
fn channels_are_apart() {
    let (a, b) = (noise(1.0), noise(0.7));
    let whole = backward::ssim(a.view(), b.view(), 1.0, FORM, 3.0);
    for c in 0..3 {
        let [a, b] = [&a, &b].map(|x| x.slice(s![.., .., c..=c]).to_owned());
        let alone = backward::ssim(a.view(), b.view(), 1.0, FORM, 1.0);
        whole.slice(s![.., .., c..=c]).iter().zip(&alone).for_each(|(x, y)| assert!((x - y).abs() < 1e-15));
    }
}
