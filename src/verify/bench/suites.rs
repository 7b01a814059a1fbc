//! Every component's suite, in pipeline order. To add a variant: one entry in the component's `variants.rs`.

use super::{Scaling, Suite};
use crate::{encoding, volume_rendering};

/// All suites.
pub const SUITES: &[Suite] = &[encoding::variants::SUITE, volume_rendering::variants::SUITE];

/// Time and memory against size, of all components.
pub fn scalings() -> Vec<Scaling> {
    [encoding::variants::SCALING, volume_rendering::variants::SCALING].concat()
}
