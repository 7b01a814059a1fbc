//! Means over Gaussians by sums, what a point and two blurs are, and slopes.

use proptest::prelude::*;

use super::{backward, integrated_encoding};
use crate::contract::testing::{properties, slope};
use crate::convention::{Bands, CS180, Columns, Frequency, IdentityPlace};
use crate::encoding::{Encoding, positional_encoding};
use crate::math::exp;

/// The mean of the encoding over N(x, v): a sum over 9 standard deviations to either side, which is exact to rounding as long as a wave
/// is longer than a few steps.
fn by_sums(x: f64, v: f64, encoding: &Encoding) -> Vec<f64> {
    let step = 1.0 / 16.0;
    let mut sum = vec![0.0; encoding.width(1)];
    for n in -144..=144 {
        let z = f64::from(n) * step;
        let weight = step * exp(-0.5 * z * z) / (2.0 * std::f64::consts::PI).sqrt();
        let at = positional_encoding(&[x + v.sqrt() * z], encoding);
        sum.iter_mut().zip(at).for_each(|(sum, y)| *sum += weight * y);
    }
    sum
}

fn bare(levels: usize) -> Encoding {
    Encoding { identity: false, ..Encoding::new(levels, &CS180) }
}

fn close(a: &[f64], b: &[f64], off: f64) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= off)
}

proptest! {
    #![proptest_config(properties())]

    #[test]
    fn it_is_the_mean_of_the_encoding(x in -1.0..1.0f64, deviation in 0.0..0.5f64) {
        for frequency in [Frequency::Pi, Frequency::One, Frequency::TwoPi] {
            let encoding = Encoding { frequency, ..bare(4) };
            let v = deviation * deviation;
            let (found, expected) = (integrated_encoding(&[x], &[v], &encoding), by_sums(x, v, &encoding));
            prop_assert!(close(&found, &expected, 1e-13), "{found:?} {expected:?}");
        }
    }

    /// Blurred once by the sum of two variances, or twice.
    #[test]
    fn blurs_add_up(x in -1.0..1.0f64, v in 0.0..0.1f64, w in 0.0..0.1f64) {
        let of = |v: f64| integrated_encoding(&[x], &[v], &bare(4));
        let quotients: Vec<f64> = of(v).iter().zip(of(0.0)).map(|(y, p)| y / p).collect();
        let twice: Vec<f64> = of(w).iter().zip(&quotients).map(|(y, q)| y * q).collect();
        prop_assert!(close(&twice, &of(v + w), 1e-14));
    }

    /// sin^2 + cos^2 of a band is what is left of it, squared: less the wider the Gaussian and the higher the band.
    #[test]
    fn wider_and_higher_is_less(x in -1.0..1.0f64, v in 0.0..0.02f64) {
        let left = |v: f64| -> Vec<f64> {
            integrated_encoding(&[x], &[v], &bare(4)).chunks(2).map(|y| y[0] * y[0] + y[1] * y[1]).collect()
        };
        let (narrow, wide) = (left(v), left(2.0 * v + 1e-4));
        prop_assert!(narrow.iter().zip(&wide).all(|(narrow, wide)| wide < narrow));
        prop_assert!(wide.is_sorted_by(|a, b| a > b));
    }

    #[test]
    fn a_point_is_encoded_as_ever(x in prop::collection::vec(-2.0..2.0, 1..4), identity: bool) {
        let encoding = Encoding { identity, ..bare(6) };
        prop_assert_eq!(
            integrated_encoding(&x, &vec![0.0; x.len()], &encoding),
            positional_encoding(&x, &encoding)
        );
    }
}

#[test]
fn gradients_in_every_convention() {
    let (x, v) = ([0.3, -0.7], [0.002, 0.01]);
    for frequency in [Frequency::Pi, Frequency::One, Frequency::TwoPi] {
        for (bands, identity) in [
            (Bands::Octaves, true),
            (Bands::Linear, false),
            (Bands::Stretched, true),
            (Bands::Widened, false),
        ] {
            let encoding = Encoding {
                identity,
                identity_place: IdentityPlace::Last,
                frequency,
                bands,
                columns: Columns::AllSinAllCosByBand,
                ..Encoding::new(3, &CS180)
            };
            let g: Vec<f64> = (0..encoding.width(2)).map(|i| 0.5 - 0.375 * i as f64).collect();
            let (g_x, g_v) = backward::integrated_encoding(&x, &v, &encoding, &g);
            let pulled = |x: [f64; 2], v: [f64; 2]| -> f64 {
                integrated_encoding(&x, &v, &encoding).iter().zip(&g).map(|(y, g)| y * g).sum()
            };
            for d in 0..2 {
                let plus = |mut a: [f64; 2], h: f64| {
                    a[d] += h;
                    a
                };
                // Short steps keep h^4 small in the last band.
                let by_differences = slope(|h| 256.0 * pulled(plus(x, h / 256.0), v));
                assert!((g_x[d] - by_differences).abs() < 1e-7, "{frequency:?} {bands:?}: {g_x:?}");
                let by_differences = slope(|h| 256.0 * pulled(x, plus(v, h / 256.0)));
                let allowed = 1e-7 * (1.0 + g_v[d].abs());
                assert!((g_v[d] - by_differences).abs() < allowed, "{frequency:?} {bands:?}: {g_v:?}");
            }
        }
    }
}

/// What has faded altogether is 0, with its gradient; a point's variance has one.
#[test]
fn far_beyond_a_period_nothing_is_left() {
    let encoding = bare(4);
    assert_eq!(integrated_encoding(&[0.3], &[1e4], &encoding), [0.0; 8]);
    let (g_x, g_v) = backward::integrated_encoding(&[0.3], &[1e4], &encoding, &[1.0; 8]);
    assert_eq!((g_x[0], g_v[0]), (0.0, 0.0));
    let (_, g_v) = backward::integrated_encoding(&[0.0], &[0.0], &bare(1), &[0.0, 1.0]);
    assert!((g_v[0] + 0.5 * std::f64::consts::PI.powi(2)).abs() < 1e-15);
}
