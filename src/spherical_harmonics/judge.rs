//! Somebody's spherical harmonics, judged.

use ndarray::ArrayView2;

use super::component::SPHERICAL_HARMONICS;
use crate::judge::door::front_door;

front_door! {
    /// Judges the harmonics of one direction: (d, degree) -> (degree + 1)^2 numbers, band by band.
    ///
    /// ```
    /// use nerf_oracle::convention::{HarmonicForm::Sphere, HarmonicSign::Alternating};
    /// use nerf_oracle::spherical_harmonics::{backward, harmonics, judge};
    /// judge(|d, degree| harmonics(d, degree, Sphere, Alternating))
    ///     .vjp(|d, degree, g| backward::harmonics(d, degree, Sphere, Alternating, g))
    ///     .assert_pass();
    /// ```
    each SPHERICAL_HARMONICS: judge as Direction(d: [f64; 3], degree: usize);
    /// With its gradient: (d, degree, grad_harmonics) -> grad_d.
    each_vjp(grad_harmonics: &[f64]);
}

front_door! {
    /// Judges the harmonics of many directions: `d` (M, 3), degree -> (M, (degree + 1)^2).
    whole SPHERICAL_HARMONICS: judge_batch as Directions(d: ArrayView2<f64>, degree: usize);
    /// With its gradient: the same and grad_harmonics -> grad_d.
    whole_vjp(grad_harmonics: ArrayView2<f64>);
}
