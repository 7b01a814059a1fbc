use proptest::prelude::*;

use super::*;
use crate::contract::testing::{properties, slope};
use crate::convention::CS180;

const EVERY_ORDER: [Columns; 6] = [
    Columns::BandSinCos,
    Columns::DimSinCos,
    Columns::DimInterleaved,
    Columns::AllSinAllCos,
    Columns::AllSinAllCosByBand,
    Columns::BandInterleaved,
];

#[test]
fn column_orders_as_they_are_written_out() {
    // Two dimensions a, b and two bands; s0a is the sine of band 0 of a.
    for (columns, order) in [
        (Columns::BandSinCos, "s0a s0b c0a c0b s1a s1b c1a c1b"),
        (Columns::DimSinCos, "s0a s1a c0a c1a s0b s1b c0b c1b"),
        (Columns::DimInterleaved, "s0a c0a s1a c1a s0b c0b s1b c1b"),
        (Columns::AllSinAllCos, "s0a s1a s0b s1b c0a c1a c0b c1b"),
        (Columns::AllSinAllCosByBand, "s0a s0b s1a s1b c0a c0b c1a c1b"),
        (Columns::BandInterleaved, "s0a c0a s0b c0b s1a c1a s1b c1b"),
    ] {
        let x = [0.3, -1.7];
        for identity in [false, true] {
            let encoding = Encoding { columns, identity, ..Encoding::new(2, &CS180) };
            let mut expected = if identity { x.to_vec() } else { vec![] };
            for name in order.split(' ') {
                let name = name.as_bytes();
                let angle = f64::from(1 << (name[1] - b'0')) * x[usize::from(name[2] - b'a')];
                expected.push(if name[0] == b's' { sin_pi(angle) } else { cos_pi(angle) });
            }
            assert_eq!(positional_encoding(&x, &encoding), expected, "{columns:?}");
            assert_eq!(encoding.width(2), expected.len());
            let last = Encoding { identity_place: IdentityPlace::Last, ..encoding };
            let front = expected.clone();
            expected.rotate_left(if identity { 2 } else { 0 });
            assert_eq!(positional_encoding(&x, &last), expected, "{columns:?}");
            let own = Encoding { identity_place: IdentityPlace::ByDimension, ..encoding };
            // y moves behind the four waves of x, where these stand together.
            let together = matches!(columns, Columns::DimSinCos | Columns::DimInterleaved);
            let expected: Vec<f64> = match identity && together {
                true => [&front[..1], &front[2..6], &front[1..2], &front[6..]].concat(),
                false => front,
            };
            assert_eq!(positional_encoding(&x, &own), expected, "{columns:?}");
        }
    }
}

#[test]
fn a_coordinate_stands_in_front_of_its_own_bands() {
    let columns = Columns::DimInterleaved;
    let own = Encoding { identity_place: IdentityPlace::ByDimension, columns, ..Encoding::new(3, &CS180) };
    assert_eq!([0, 1].map(|d| own.identity_column(2, d)), [0, 7]);
    assert_eq!([0, 1].map(|d| own.column(2, 0, d, 0)), [1, 8]);
}

#[test]
fn factors_and_bands() {
    let base = Encoding::new(4, &CS180);
    let linear = Encoding { bands: Bands::Linear, ..base };
    assert_eq!([0, 1, 2, 3].map(|k| base.band(k)), [1.0, 2.0, 4.0, 8.0]);
    assert_eq!([0, 3].map(|k| linear.band(k)), [1.0, 8.0]);
    assert!((linear.band(1) - 10.0 / 3.0).abs() < 1e-15 && (linear.band(2) - 17.0 / 3.0).abs() < 1e-15);
    assert_eq!(Encoding { levels: 1, ..linear }.band(0), 1.0);
    // Four values in three even steps from 2^0 to 2^2.
    let stretched = Encoding { bands: Bands::Stretched, ..base };
    assert_eq!([0, 3].map(|k| stretched.band(k)), [1.0, 4.0]);
    assert!(
        (stretched.band(1).powi(3) - 4.0).abs() < 1e-14 && (stretched.band(2).powi(3) - 16.0).abs() < 1e-13
    );
    assert_eq!(Encoding { levels: 1, ..stretched }.band(0), 1.0);
    // And in three from 2^0 to 2^4.
    let widened = Encoding { bands: Bands::Widened, ..base };
    assert_eq!([0, 3].map(|k| widened.band(k)), [1.0, 16.0]);
    assert!(
        (widened.band(1).powi(3) - 16.0).abs() < 1e-13 && (widened.band(2).powi(3) - 256.0).abs() < 1e-12
    );
    assert_eq!(Encoding { levels: 1, ..widened }.band(0), 1.0);
    let band0 =
        |frequency| positional_encoding(&[0.3], &Encoding { frequency, levels: 1, identity: false, ..base });
    assert_eq!(band0(Frequency::One), [sin(0.3), cos(0.3)]);
    assert_eq!(band0(Frequency::TwoPi), [sin_pi(0.6), cos_pi(0.6)]);
    assert_eq!(band0(Frequency::Pi), [sin_pi(0.3), cos_pi(0.3)]);
    assert_eq!(positional_encoding(&[0.3, 0.4], &Encoding { levels: 0, ..base }), [0.3, 0.4]);
    assert_eq!([10, 4].map(|levels| Encoding::new(levels, &CS180).width(3)), [63, 27]);
}

#[test]
fn gradients_in_every_convention() {
    let (x, levels) = ([0.3, -0.7], 3);
    for frequency in [Frequency::Pi, Frequency::One, Frequency::TwoPi] {
        for (bands, identity) in [
            (Bands::Octaves, true),
            (Bands::Linear, false),
            (Bands::Stretched, true),
            (Bands::Widened, false),
        ] {
            let encoding = Encoding {
                identity,
                frequency,
                bands,
                columns: Columns::DimSinCos,
                ..Encoding::new(levels, &CS180)
            };
            let encoding = Encoding { identity_place: IdentityPlace::Last, ..encoding };
            let g: Vec<f64> = (0..encoding.width(2)).map(|i| 0.5 - 0.375 * i as f64).collect();
            let g_x = backward::positional_encoding(&x, &encoding, &g);
            for d in 0..2 {
                let pulled = |h: f64| {
                    let mut x = x;
                    // Period 1/8 in the shortest band: a shorter step keeps h^4 small.
                    x[d] += h / 128.0;
                    128.0 * positional_encoding(&x, &encoding).iter().zip(&g).map(|(y, g)| y * g).sum::<f64>()
                };
                let by_differences = slope(pulled);
                assert!(
                    (g_x[d] - by_differences).abs() < 1e-8,
                    "{frequency:?} {bands:?}: {} {by_differences}",
                    g_x[d]
                );
            }
        }
    }
    // Band 1 of each factor: twice the angle.
    let band1 = |frequency| {
        let y = positional_encoding(&[0.3], &Encoding { frequency, ..Encoding::new(2, &CS180) });
        [y[3], y[4]]
    };
    assert_eq!(band1(Frequency::One), [sin(0.6), cos(0.6)]);
    assert_eq!(band1(Frequency::Pi), [sin_pi(0.6), cos_pi(0.6)]);
    assert_eq!(band1(Frequency::TwoPi), [sin_pi(1.2), cos_pi(1.2)]);
}

#[test]
fn pe1_an_input_rounded_to_f32_moves_the_last_band_by_more_than_any_arithmetic() {
    let x = 0.7;
    let last = |x: f64| positional_encoding(&[x], &Encoding::new(10, &CS180))[19];
    let moved = (last(f64::from(x as f32)) - last(x)).abs();
    // The slope 2^9 pi times the rounding of x.
    let slope_times_rounding = 512.0 * PI * (f64::from(x as f32) - x).abs();
    assert!(moved > 1e-6 && moved <= slope_times_rounding, "{moved}");
}

#[test]
fn pe2_the_cosine_is_no_shifted_sine() {
    // In f32, sin(a + pi/2) at a = 2^k pi x rounds the sum, even with a perfect sine: band 9, then band 19.
    for (band, at_least) in [(512.0f32, 4e-6), (524_288.0, 2e-2)] {
        let lost = |n: i32| {
            let a = band * std::f32::consts::PI * (n as f32 / 100.0);
            (sin(f64::from(a + std::f32::consts::FRAC_PI_2)) - cos(f64::from(a))).abs()
        };
        assert!((1..100).map(lost).fold(0.0, f64::max) > at_least);
    }
    // The reference's cosine agrees with its own sine to rounding, at every band.
    for (s, c) in positional_encoding(&[0.7], &Encoding::new(20, &CS180))[1..].chunks(2).map(|p| (p[0], p[1]))
    {
        assert!((s * s + c * c - 1.0).abs() <= 4.0 * f64::EPSILON);
    }
}

#[test]
fn pe3_whole_numbers_zeros_and_30_octaves() {
    let encoding = Encoding { identity: false, ..Encoding::new(31, &CS180) };
    for x in [0.0, -0.0, 1.0, -3.0] {
        for (k, wave) in positional_encoding(&[x], &encoding).chunks(2).enumerate() {
            let cosine = if k == 0 && x % 2.0 != 0.0 { -1.0 } else { 1.0 };
            assert_eq!(wave, [0.0, cosine], "band {k} of {x}");
        }
    }
    // The textbook form sin(2^k pi x) is not 0 at x = 1, and at 2^30 x it is noise.
    assert!(sin(power_of_two(30) * PI).abs() > 1e-8);
    // x = 1/3 as an f64 is 1/3 - 2^-54/3: band 30 sees the angle 2^30 / 3 = 357913941 + 1/3, less 2^-24 / 3.
    let third = positional_encoding(&[1.0 / 3.0], &encoding)[60];
    let remainder = 1.0 / 3.0 - power_of_two(-24) / 3.0;
    assert!(
        (third + sin_pi(remainder)).abs() < 4.0 * f64::EPSILON,
        "an odd number of half turns turns the sign"
    );
    let tiny = positional_encoding(&[5e-324], &encoding);
    assert_eq!((tiny[0], tiny[1]), (1.5e-323, 1.0));
    let gradient = backward::positional_encoding(&[0.0], &encoding, &[1.0; 62]);
    assert_eq!(gradient, [PI * (power_of_two(31) - 1.0)]);
}

proptest! {
    #![proptest_config(properties())]

    #[test]
    fn a_column_order_is_a_permutation(x in prop::collection::vec(-2.0..2.0, 1..4), levels in 0usize..6) {
        let sorted = |columns| {
            let mut y = positional_encoding(&x, &Encoding { columns, ..Encoding::new(levels, &CS180) });
            y.sort_by(f64::total_cmp);
            y
        };
        for columns in EVERY_ORDER {
            prop_assert_eq!(sorted(columns), sorted(Columns::BandSinCos));
        }
    }

    #[test]
    fn period_2_and_parity(n in -4096i32..4096, turns in -50i32..50) {
        let x = f64::from(n) / 1024.0; // a short number, so that x + 2 n is exact
        let encoding = Encoding { identity: false, ..Encoding::new(10, &CS180) };
        let y = positional_encoding(&[x], &encoding);
        prop_assert_eq!(&positional_encoding(&[x + 2.0 * f64::from(turns)], &encoding), &y);
        for (plus, minus) in y.chunks(2).zip(positional_encoding(&[-x], &encoding).chunks(2)) {
            prop_assert_eq!((minus[0], minus[1]), (-plus[0], plus[1]));
        }
    }

    #[test]
    fn each_band_doubles_the_angle_of_the_one_before(x in -3.0..3.0f64) {
        let y = positional_encoding(&[x], &Encoding { identity: false, ..Encoding::new(16, &CS180) });
        for pair in y.chunks(2).collect::<Vec<_>>().windows(2) {
            let ([s, c], [s2, c2]) = ([pair[0][0], pair[0][1]], [pair[1][0], pair[1][1]]);
            prop_assert!((s2 - 2.0 * s * c).abs() < 8.0 * f64::EPSILON);
            prop_assert!((c2 - (c * c - s * s)).abs() < 8.0 * f64::EPSILON);
        }
    }
}
