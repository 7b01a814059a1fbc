//! The f32 path against the oracle.

use approx::assert_abs_diff_eq;

use super::harmonics;
use crate::convention::{HarmonicForm, HarmonicSign};
use crate::spherical_harmonics::harmonics as oracle;
use crate::spherical_harmonics::tests::sphere;

#[test]
fn fast_path_agrees() {
    for d in sphere(20, 17) {
        let d = d.map(|x| x as f32);
        let exact = oracle(d.map(f64::from), 3, HarmonicForm::Sphere, HarmonicSign::Alternating);
        for (a, b) in exact.iter().zip(harmonics(d)) {
            // Five roundings of terms below 3.
            assert_abs_diff_eq!(*a, f64::from(b), epsilon = 8.0 * f64::from(f32::EPSILON));
        }
    }
}
