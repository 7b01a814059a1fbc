//! Closed forms, what doesn't depend on the direction, and slopes.

use approx::assert_relative_eq;
use proptest::prelude::*;

use super::{Form, backward, color};
use crate::contract::testing::{properties, slope};
use crate::convention::HarmonicSign::{Alternating, Plain};
use crate::convention::SplatColor::{Clamped, Shifted, Sum};

const FORM: Form = Form { sign: Alternating, color: Clamped };

/// Sixteen coefficients from as many triples.
fn coefficients() -> impl Strategy<Value = Vec<[f64; 3]>> {
    prop::collection::vec(prop::array::uniform3(-0.5..0.5), 16)
}

fn mean() -> impl Strategy<Value = [f64; 3]> {
    prop::array::uniform3(-2.0..2.0)
        .prop_filter("not in the camera", |m: &[f64; 3]| m.iter().map(|x| x * x).sum::<f64>() > 0.25)
}

proptest! {
    #![proptest_config(properties())]

    /// The distance is no matter, and neither is where both are.
    #[test]
    fn directions_alone_matter(m in mean(), f in coefficients(), by in 0.1..10.0f64, shift in prop::array::uniform3(-2.0..2.0)) {
        let here = color(m, [0.0; 3], &f, FORM);
        let there = color([0, 1, 2].map(|k| by * m[k] + shift[k]), shift, &f, FORM);
        (0..3).for_each(|k| assert!((here[k] - there[k]).abs() < 1e-13));
        let (g_mean, _) = backward::color(m, [0.0; 3], &f, FORM, [1.0, -0.5, 0.25]);
        let along: f64 = (0..3).map(|k| g_mean[k] * m[k]).sum();
        prop_assert!(along.abs() < 1e-13, "the gradient is across the direction: {along:e}");
    }

    #[test]
    fn gradients_are_those_of_differences(m in mean(), f in coefficients(), g in prop::array::uniform3(-1.0..1.0)) {
        for form in [FORM, Form { sign: Plain, color: Shifted }, Form { sign: Alternating, color: Sum }] {
            // A difference across the clamp has no slope.
            let raw = color(m, [0.25; 3], &f, Form { color: Shifted, ..form });
            prop_assume!(raw.iter().all(|x| x.abs() > 0.05));
            let inner = |m: [f64; 3], f: &[[f64; 3]]| -> f64 {
                let found = color(m, [0.25; 3], f, form);
                (0..3).map(|k| g[k] * found[k]).sum()
            };
            let (g_mean, g_f) = backward::color(m, [0.25; 3], &f, form, g);
            for k in 0..3 {
                let h = 1.0 / 64.0;
                let by_differences = slope(|s| { let mut at = m; at[k] += h * s; inner(at, &f) }) / h;
                prop_assert!((g_mean[k] - by_differences).abs() < 1e-6 * (1.0 + by_differences.abs()));
            }
            for n in 0..16 {
                let by_differences = slope(|s| { let mut at = f.clone(); at[n][n % 3] += 0.0625 * s; inner(m, &at) }) * 16.0;
                prop_assert!((g_f[n][n % 3] - by_differences).abs() < 1e-9);
            }
        }
    }
}

/// The signs of 3D Gaussian splatting: -y, z, -x in band 1.
#[test]
fn the_first_band_is_that_of_the_rasterizer() {
    let mut f = [[0.0; 3]; 4];
    (f[1][0], f[2][1], f[3][2]) = (0.5, 0.5, 0.5);
    let c1 = 0.488_602_511_902_919_9;
    let (x, y, z) = (2.0 / 3.0, -1.0 / 3.0, 2.0 / 3.0);
    let found = color([5.0, 1.0, 7.0], [3.0, 2.0, 5.0], &f, FORM);
    for (found, expected) in found.iter().zip([0.5 - 0.5 * c1 * y, 0.5 + 0.5 * c1 * z, 0.5 - 0.5 * c1 * x]) {
        assert_relative_eq!(*found, expected, max_relative = 1e-15);
    }
    let plain = color([5.0, 1.0, 7.0], [3.0, 2.0, 5.0], &f, Form { sign: Plain, ..FORM });
    assert_relative_eq!(plain[0], 0.5 + 0.5 * c1 * y, max_relative = 1e-15);
}

/// GS6: what is clamped is black and learns nothing, channel by channel; at 0 itself the gradient passes.
#[test]
fn below_zero_nothing_is_learned() {
    let y0 = 0.282_094_791_773_878_14;
    let f = [[-2.0, 1.0, -0.5 / y0]];
    let seen = |color_form| {
        let form = Form { color: color_form, ..FORM };
        let (_, g_f) = backward::color([1.0, 0.0, 0.0], [0.0; 3], &f, form, [1.0, 2.0, 4.0]);
        (color([1.0, 0.0, 0.0], [0.0; 3], &f, form), g_f[0])
    };
    let (clamped, g) = seen(Clamped);
    assert_eq!(clamped[0], 0.0);
    assert_eq!(g, [0.0, 2.0 * y0, 4.0 * y0]);
    let (shifted, g) = seen(Shifted);
    assert_eq!(g, [y0, 2.0 * y0, 4.0 * y0]);
    assert_relative_eq!(shifted[0], 0.5 - 2.0 * y0, max_relative = 1e-15);
    assert_eq!(seen(Sum).0[1], y0);
}

#[test]
fn bands_are_whole() {
    for width in [1, 4, 9, 16, 25] {
        assert_eq!(color([1.0, 0.0, 0.0], [0.0; 3], &vec![[0.0; 3]; width], FORM), [0.5; 3]);
    }
    for width in [0, 2, 3, 5, 15, 36] {
        let answer =
            std::panic::catch_unwind(|| color([1.0, 0.0, 0.0], [0.0; 3], &vec![[0.0; 3]; width], FORM));
        assert!(answer.is_err(), "{width}");
    }
}
