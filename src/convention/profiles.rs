//! Profiles: conventions of well-known code, as data, each value with the file it was read from.

use std::collections::BTreeMap;

use super::*;
use crate::error::{Error, Result};

/// The conventions of one code base.
pub struct Profile {
    /// Name, as `--profile` takes it.
    pub name: &'static str,
    /// What it is.
    pub title: &'static str,
    /// The assignment.
    pub conventions: Conventions,
    /// Convention -> the file that its value was read from, with what stands there.
    pub sources: &'static [(&'static str, &'static str)],
    /// What of this code no convention expresses.
    pub beyond: &'static str,
}

/// All of them; the default first.
pub const PROFILES: &[Profile] = &[
    Profile {
        name: "cs180",
        title: "Berkeley CS180, project on neural radiance fields: the paper's text taken literally",
        conventions: CS180,
        sources: &[],
        beyond: "",
    },
    Profile {
        name: "nerf2020",
        title: "the original NeRF (bmild/nerf)",
        conventions: Conventions {
            axes: Axes::Opengl,
            pixel_centre: PixelCentre::Integer,
            directions: Directions::Depth,
            grid: Grid::EndsBetweenMidpoints,
            delta: Delta::Differences,
            last_delta: LastDelta::TenToTen,
            product_eps: ProductEps::TenToMinusTen,
            frequency: Frequency::One,
            skip_layer: 5,
            skip_order: SkipOrder::EncodingFirst,
            depth: Depth::Plain,
            bytes: Bytes::Truncate,
            ..CS180
        },
        sources: &[],
        beyond: "",
    },
];

/// A profile by name.
///
/// # Errors
/// A name that isn't in [`PROFILES`].
pub fn find(name: &str) -> Result<&'static Profile> {
    let names = PROFILES.iter().map(|profile| profile.name).collect::<Vec<_>>().join(", ");
    let found = PROFILES.iter().find(|profile| profile.name == name);
    found.ok_or_else(|| Error::usage("--profile", name, format!("one of {names}")))
}

/// An assignment in words: the profile next to it, and where it deviates.
pub fn describe(assignment: &BTreeMap<&'static str, String>) -> String {
    let deviations = |profile: &Profile| -> Vec<String> {
        let off = assignment.iter().filter(|(key, value)| profile.conventions.get(key) != **value);
        off.map(|(key, value)| format!("{key} = {value}")).collect()
    };
    let nearest = PROFILES.iter().min_by_key(|profile| deviations(profile).len()).expect("there are profiles");
    let off = deviations(nearest);
    if off.is_empty() { nearest.name.into() } else { format!("{} with {}", nearest.name, off.join(", ")) }
}
