use ndarray::Array3;
use proptest::prelude::*;

use super::*;
use crate::contract::testing::properties;

#[test]
fn psnr_of_known_errors() {
    // Every value off by 0.1: mse .01, 20 dB; against a peak of 255, 20 log10(2550) dB.
    assert!((psnr(mse(&[0.1; 6], &[0.0; 6]), 1.0) - 20.0).abs() < 1e-13);
    assert_eq!([psnr(1e-3, 1.0), psnr(1.0, 1.0), psnr(100.0, 10.0)], [30.0, 0.0, 0.0]);
    assert!((psnr(0.01, 255.0) - 68.130_803_608_679_1).abs() < 1e-12);
}

#[test]
fn me1_identical_pictures_are_infinitely_good() {
    assert_eq!(psnr(mse(&[0.3, 0.7], &[0.3, 0.7]), 1.0), f64::INFINITY);
    let (exact, off, target) = ([0.5; 4], [0.6; 4], [0.5; 4]);
    let of = |of| psnr_of_images(&[&exact, &off], &[&target, &target], 1.0, of, PsnrFloor::None);
    assert_eq!(of(PsnrOf::Images), f64::INFINITY, "one exact picture poisons the mean");
    assert!((of(PsnrOf::MeanError) - 23.010_299_956_639_81).abs() < 1e-12);
}

/// With a floor equal pictures have 100 dB, whatever the peak, and others what they had.
#[test]
fn a_floor_keeps_equal_pictures_finite() {
    let of =
        |p: &[f64], peak, of| psnr_of_images(&[p, &[0.5]], &[&[0.5], &[0.5]], peak, of, PsnrFloor::Small);
    for peak in [1.0, 255.0] {
        assert!((of(&[0.5], peak, PsnrOf::Images) - 100.0).abs() < 1e-12);
        assert!((of(&[0.5], peak, PsnrOf::MeanError) - 100.0).abs() < 1e-12);
    }
    // An error of 1/100 and one of 0: 20 dB and 100 dB.
    assert!((of(&[0.6], 1.0, PsnrOf::Images) - 60.0).abs() < 1e-12);
    assert!((of(&[0.6], 1.0, PsnrOf::MeanError) - 23.010_299_956_639_81).abs() < 1e-12);
}

#[test]
fn the_mean_of_psnrs_is_not_the_psnr_of_the_mean() {
    let (a, b) = ([0.1], [0.001f64.sqrt()]);
    let of = |of| psnr_of_images(&[&a, &b], &[&[0.0], &[0.0]], 1.0, of, PsnrFloor::None);
    assert!((of(PsnrOf::Images) - 25.0).abs() < 1e-12);
    assert!((of(PsnrOf::MeanError) - 22.596_373_105_057_56).abs() < 1e-12);
}

fn noise(scale: f64) -> Array3<f64> {
    Array3::from_shape_fn((13, 17, 3), |(j, i, c)| {
        scale * ((37 * j + 101 * i + 53 * c) as f64 * 0.618_033_988_75).fract()
    })
}

#[test]
fn me2_ssim_window_11_deviation_1_5() {
    let kernel = gaussian_window::<11>(1.5);
    assert!((kernel.iter().sum::<f64>() - 1.0).abs() < 1e-15);
    assert!((kernel[5] / kernel[8] - exp(2.0)).abs() < 1e-13, "two deviations beside the middle: e^2");
    let a = noise(1.0);
    assert_eq!(ssim(a.view(), a.view(), 1.0), 1.0);
    // Two flat pictures differ only in luminance: (2ab + c1) / (a^2 + b^2 + c1).
    let flat = |x| Array3::from_elem((11, 12, 3), x);
    let expected = (2.0 * 0.4 * 0.5 + 1e-4) / (0.16 + 0.25 + 1e-4);
    assert!((ssim(flat(0.4).view(), flat(0.5).view(), 1.0) - expected).abs() < 1e-14);
    // A negative has covariance -variance: with means of 1/2 over the window, the structure term changes its sign.
    let negative = a.mapv(|x| 1.0 - x);
    assert!(ssim(a.view(), negative.view(), 1.0) < -0.8);
    // Symmetric, and independent of the unit.
    let b = noise(0.9);
    assert_eq!(ssim(a.view(), b.view(), 1.0), ssim(b.view(), a.view(), 1.0));
    let bytes = |x: &Array3<f64>| x.mapv(|x| 255.0 * x);
    assert!((ssim(bytes(&a).view(), bytes(&b).view(), 255.0) - ssim(a.view(), b.view(), 1.0)).abs() < 1e-12);
}

#[test]
fn ssim_of_a_contrast_change_by_hand() {
    // Around one window's mean m, b = m + s (a - m): (2 s v + c2) / ((1 + s^2) v + c2) with v the window's variance.
    let a = Array3::from_shape_fn((11, 11, 1), |(j, i, _)| if (i + j) % 2 == 0 { 0.25 } else { 0.75 });
    let kernel = gaussian_window::<11>(1.5);
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
    let expected = (v + 9e-4) / (1.25 * v + 9e-4);
    assert!((ssim(a.view(), b.view(), 1.0) - expected).abs() < 1e-13);
}

/// At 40 digits by mpmath; scikit-image 0.26, kornia 0.9 and torchmetrics 1.9 agree (`tools/libraries/beside.py`, `pictures`).
#[test]
fn ssim_as_other_programs_have_it() {
    let a = noise(1.0);
    let of = |b: Array3<f64>| ssim(a.view(), b.view(), 1.0);
    assert!((of(noise(0.9)) - 0.989_014_841_255_578_3).abs() < 1e-15);
    assert!((of(a.mapv(|x| 1.0 - x)) + 0.984_848_964_453_503).abs() < 1e-15);
}

#[test]
fn bytes_are_clipped() {
    assert_eq!(
        [-1.0, 0.0, 0.998, 0.999, 1.0, 7.0].map(|x| to_uint8(x, Bytes::Round)),
        [0, 0, 254, 255, 255, 255]
    );
    assert_eq!([0.998, 0.999, 1.0, 1.01].map(|x| to_uint8(x, Bytes::Truncate)), [254, 254, 255, 255]);
}

proptest! {
    #![proptest_config(properties())]

    #[test]
    fn mse_is_a_parabola_with_its_gradient(p in prop::collection::vec(-2.0..2.0f64, 1..20), shift in 0.01..1.0f64) {
        let n = p.len() as f64;
        let target: Vec<f64> = p.iter().map(|p| p - shift).collect();
        prop_assert!((mse(&p, &target) - shift * shift).abs() < 1e-14);
        prop_assert_eq!(backward::mse(&p, &target, 3.0).len(), p.len());
        for g in backward::mse(&p, &target, 3.0) {
            prop_assert!((g - 6.0 * shift / n).abs() < 1e-14);
        }
    }
}
