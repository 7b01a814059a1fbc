//! Registry row of the spherical harmonics.

use super::{arrays, bound, cases, honest, mistakes};
use crate::contract::component::{Component, Direction, Entries, Port};
use crate::contract::special::{Reach, Special};

/// Spherical harmonics of directions.
pub(crate) const SPHERICAL_HARMONICS: Component = Component {
    name: "spherical_harmonics",
    folder: "spherical_harmonics",
    code: include_str!("honest.rs"),
    formula: "Y_l^m(d) for l = 0, ..., degree and m = -l, ..., l, real, orthonormal, sign (-1)^m (none by convention)",
    source: "Sloan, Stupid Spherical Harmonics Tricks (2008), A2; Instant-NGP (Mueller et al. 2022) section 5.3",
    inputs: &[
        Port::smooth("d", "M,3", "directions of length 1, components in [-1, 1]"),
        Port::plain("degree", "", "last band, 0 to 4").of(Entries::Count),
    ],
    outputs: &[Port::smooth("harmonics", "M,(degree+1)^2", "band by band, m ascending")],
    conventions: &["harmonic_sign", "harmonic_form"],
    forward: Direction {
        oracle: arrays::harmonics,
        bound: bound::harmonics,
        honest: honest::harmonics,
        wrong: mistakes::harmonics,
    },
    vjp: Some(Direction {
        oracle: arrays::harmonics_vjp,
        bound: bound::harmonics_vjp,
        honest: honest::harmonics_vjp,
        wrong: mistakes::harmonics_vjp,
    }),
    cases: cases::spherical_harmonics,
    mistakes: mistakes::SPHERICAL_HARMONICS,
    // Plenoxels go to degree 2, splats to degree 3.
    special: Special {
        reach: Some(Reach { input: "degree", least: 1.0 }),
        large: cases::large,
        ..Special::NONE
    },
};
