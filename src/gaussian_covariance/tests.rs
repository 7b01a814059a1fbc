//! Closed forms, what a rotation leaves as it is, and slopes.

use approx::assert_relative_eq;
use proptest::prelude::*;

use super::{Form, backward, covariance, rotation};
use crate::contract::testing::{properties, slope};
use crate::convention::QuaternionLength::{AsGiven, Divided};
use crate::convention::QuaternionOrder::{RealFirst, RealLast};
use crate::convention::SplatScale::{Log, Plain};

fn forms() -> Vec<Form> {
    let mut forms = vec![];
    for order in [RealFirst, RealLast] {
        for length in [Divided, AsGiven] {
            for scale in [Plain, Log] {
                forms.push(Form { order, length, scale });
            }
        }
    }
    forms
}

fn quaternion() -> impl Strategy<Value = [f64; 4]> {
    prop::array::uniform4(-2.0..2.0)
        .prop_filter("a direction", |q| q.iter().map(|x| x * x).sum::<f64>() > 0.1)
}

/// v turned by Rodrigues' formula: another way to the same matrix.
fn turned(axis: [f64; 3], angle: f64, v: [f64; 3]) -> [f64; 3] {
    let (sin, cos) = (crate::math::sin(angle), crate::math::cos(angle));
    let along: f64 = (0..3).map(|a| axis[a] * v[a]).sum();
    let cross = |a: usize| axis[(a + 1) % 3] * v[(a + 2) % 3] - axis[(a + 2) % 3] * v[(a + 1) % 3];
    [0, 1, 2].map(|a| v[a] * cos + cross(a) * sin + axis[a] * along * (1.0 - cos))
}

proptest! {
    #![proptest_config(properties())]

    #[test]
    fn a_rotation_is_that_of_its_axis_and_angle(d in prop::array::uniform3(-1.0..1.0), angle in -3.0..3.0f64) {
        let length = d.iter().map(|x: &f64| x * x).sum::<f64>().sqrt();
        prop_assume!(length > 0.1);
        let axis = d.map(|x| x / length);
        let (sin, cos) = (crate::math::sin(angle / 2.0), crate::math::cos(angle / 2.0));
        let r = rotation([cos, axis[0] * sin, axis[1] * sin, axis[2] * sin]);
        for column in 0..3 {
            let mut e = [0.0; 3];
            e[column] = 1.0;
            let expected = turned(axis, angle, e);
            for row in 0..3 {
                prop_assert!((r[row][column] - expected[row]).abs() < 4e-15);
            }
        }
    }

    /// The trace is the sum of variances and the determinant their product, whatever the rotation; and it is symmetric.
    #[test]
    fn invariants_are_those_of_the_scales(q in quaternion(), s in prop::array::uniform3(0.1..2.0)) {
        let c = covariance(q, s, Form::default());
        let trace = c[0][0] + c[1][1] + c[2][2];
        prop_assert!((trace - (s[0] * s[0] + s[1] * s[1] + s[2] * s[2])).abs() < 1e-14 * trace);
        let minor = |a: usize, b: usize| c[1][a] * c[2][b] - c[1][b] * c[2][a];
        let det = c[0][0] * minor(1, 2) - c[0][1] * minor(0, 2) + c[0][2] * minor(0, 1);
        let product = s[0] * s[1] * s[2];
        prop_assert!((det - product * product).abs() < 1e-12 * (1.0 + det));
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            prop_assert_eq!(c[i][j], c[j][i]);
        }
    }

    /// GS1: neither length nor sign of a quaternion matters where it is divided.
    #[test]
    fn length_and_sign_are_no_matter(q in quaternion(), s in prop::array::uniform3(0.1..2.0), factor in 0.01..100.0f64) {
        let (c, scaled) = (covariance(q, s, Form::default()), covariance(q.map(|x| -factor * x), s, Form::default()));
        for (a, b) in c.iter().flatten().zip(scaled.iter().flatten()) {
            prop_assert!((a - b).abs() < 1e-14);
        }
    }

    #[test]
    fn gradients_are_those_of_differences(
        q in quaternion(),
        s in prop::array::uniform3(-1.5..1.5),
        g in prop::array::uniform3(prop::array::uniform3(-1.0..1.0)),
    ) {
        for form in forms() {
            let (g_q, g_s) = backward::covariance(q, s, g, form);
            let inner = |q, s| -> f64 {
                let c = covariance(q, s, form);
                (0..9).map(|n| g[n / 3][n % 3] * c[n / 3][n % 3]).sum()
            };
            let size = 1.0 + g_q.iter().chain(&g_s).fold(0.0, |size: f64, g| size.max(g.abs()));
            for a in 0..4 {
                let by_differences = slope(|step| { let mut at = q; at[a] += step; inner(at, s) });
                prop_assert!((g_q[a] - by_differences).abs() < 1e-7 * size, "{form:?} q{a}: {} {by_differences}", g_q[a]);
            }
            for k in 0..3 {
                let by_differences = slope(|step| { let mut at = s; at[k] += step; inner(q, at) });
                prop_assert!((g_s[k] - by_differences).abs() < 1e-7 * size, "{form:?} s{k}: {} {by_differences}", g_s[k]);
            }
        }
    }
}

/// GS1: nothing that a quaternion's length could learn comes back.
#[test]
fn the_gradient_is_across_the_quaternion() {
    let (q, g) = ([0.5, -2.0, 1.5, 4.0], [[1.0, 2.0, -1.0], [0.5, -3.0, 1.0], [2.0, 0.25, 1.0]]);
    let (g_q, _) = backward::covariance(q, [0.5, 1.0, 2.0], g, Form::default());
    let along: f64 = (0..4).map(|a| q[a] * g_q[a]).sum();
    assert!(along.abs() < 1e-14 && g_q.iter().any(|g| g.abs() > 0.1), "{along:e} {g_q:?}");
}

#[test]
fn forms_say_the_same_in_other_words() {
    let (q, s) = ([0.5, -0.5, 0.5, 0.5], [0.25f64, 1.0, 4.0]);
    let expected = covariance(q, s, Form::default());
    assert_eq!(covariance([-0.5, 0.5, 0.5, 0.5], s, Form { order: RealLast, ..Form::default() }), expected);
    assert_eq!(covariance(q, s, Form { length: AsGiven, ..Form::default() }), expected);
    let logarithms = covariance(q, s.map(crate::math::ln), Form { scale: Log, ..Form::default() });
    for (a, b) in expected.iter().flatten().zip(logarithms.iter().flatten()) {
        assert_relative_eq!(*a, *b, max_relative = 1e-14, epsilon = 1e-15);
    }
}
