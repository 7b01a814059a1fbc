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
