//! Options that several subcommands share, and how they are read.

use std::net::IpAddr;

use clap::ValueEnum;
use clap::builder::PossibleValue;
use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::limits::{LENGTH, SIDE, STEPS, THREADS};
use crate::training::compact::{Extent, Part};

/// Which path computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Backend {
    /// f32, batched, threaded.
    Fast,
    /// The f64 oracle: slow.
    Reference,
}

/// The part of space that a model holds, and the coordinates in which.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Space {
    /// As the scene asks for it.
    #[default]
    Auto,
    /// The scene's box.
    Box,
    /// All of space, contracted around the scene's middle (--model compact).
    Contracted,
    /// All in front of a near plane, in normalized device coordinates (--model nerf).
    Ndc,
}

impl Space {
    /// What the compact model makes of it.
    ///
    /// # Errors
    /// Where it has no such space.
    pub(super) fn extent(self) -> Result<Extent> {
        match self {
            Space::Auto => Ok(Extent::Auto),
            Space::Box => Ok(Extent::Box),
            Space::Contracted => Ok(Extent::Contracted),
            Space::Ndc => {
                Err(Error::usage("--space", "ndc", "auto, box or contracted: ndc is for --model nerf"))
            }
        }
    }
}

impl ValueEnum for Part {
    fn value_variants<'a>() -> &'a [Part] {
        &Part::ALL
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        let (name, help) = match self {
            Part::Occupancy => ("occupancy", "The occupancy grid: every cell counts as occupied"),
            Part::Stop => (
                "stop",
                "The early stop, and the end of rays behind opaque cells: all samples of a ray count",
            ),
            Part::Patience => {
                ("patience", "Ending rays behind opaque cells, before their samples are looked at")
            }
            Part::CoarseSteps => ("coarse_steps", "Coarse steps along the rays at first"),
            Part::CoarseLevels => ("coarse_levels", "Coarse levels of the hash grid first"),
            Part::Growth => ("growth", "Batches that grow with the step"),
            Part::Decay => ("decay", "Learning rates that fall"),
            Part::ViewDependence => ("view_dependence", "Colors that depend on the direction"),
            Part::RandomBackgrounds => (
                "random_backgrounds",
                "All colors behind pictures that have opacity, and not the scene's alone",
            ),
            Part::Distortion => ("distortion", "The distortion loss against floaters in photographs"),
            Part::Averaging => ("averaging", "Pictures of the parameters' running mean"),
        };
        Some(PossibleValue::new(name).help(help))
    }
}

/// A color: `black`, `white`, or `R,G,B` in [0, 1].
pub(super) fn color(text: &str) -> Result<[f64; 3], String> {
    match text {
        "black" => return Ok([0.0; 3]),
        "white" => return Ok([1.0; 3]),
        _ => {}
    }
    let channel = |part: &str| part.trim().parse().ok().filter(|x| (0.0..=1.0).contains(x));
    let parts: Option<Vec<f64>> = text.split(',').map(channel).collect();
    match parts.as_deref() {
        Some(&[r, g, b]) => Ok([r, g, b]),
        _ => Err("expected black, white, or three numbers in [0, 1] such as 0.2,0.4,1".into()),
    }
}

/// A scale: `1/N`, as N.
pub(super) fn scale(text: &str) -> Result<usize, String> {
    let n = text.strip_prefix("1/").and_then(|n| n.parse::<usize>().ok()).filter(|n| (1..=64).contains(n));
    n.ok_or_else(|| "expected 1/N, such as 1/2, N at most 64".into())
}

/// A picture's size: `WxH`.
pub(super) fn size(text: &str) -> Result<(usize, usize), String> {
    let (w, h) = text.split_once('x').ok_or("expected WxH, such as 400x300")?;
    match (w.parse(), h.parse()) {
        (Ok(w), Ok(h)) if (1..=SIDE).contains(&w) && (1..=SIDE).contains(&h) => Ok((w, h)),
        _ => Err(format!("expected WxH with both from 1 to {SIDE}, such as 400x300")),
    }
}

/// A whole number above 0, and not so large that memory runs out.
pub(super) fn positive(text: &str) -> Result<usize, String> {
    at_most::<{ 1 << 24 }>(text)
}

/// A whole number from 1 to `MOST`.
pub(super) fn at_most<const MOST: usize>(text: &str) -> Result<usize, String> {
    let number = text.parse().ok().filter(|n| (1..=MOST).contains(n));
    number.ok_or_else(|| format!("expected a whole number above 0 and at most {MOST}"))
}

/// A whole number from 0 to `MOST`.
pub(super) fn none_or<const MOST: usize>(text: &str) -> Result<usize, String> {
    if text == "0" { Ok(0) } else { at_most::<MOST>(text) }
}

/// A finite number.
pub(super) fn finite_number(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|n: &f64| n.is_finite());
    number.ok_or_else(|| "expected a finite number".into())
}

/// A distance in scene units.
pub(super) fn distance(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|x| (0.0..=LENGTH).contains(x));
    number.ok_or_else(|| format!("expected a distance from 0 to {LENGTH:e}"))
}

/// How many threads.
pub(super) fn threads(text: &str) -> Result<usize, String> {
    at_most::<THREADS>(text)
}

/// How many steps.
pub(super) fn steps(text: &str) -> Result<usize, String> {
    at_most::<STEPS>(text)
}

/// An address of this machine.
pub(super) fn host(text: &str) -> Result<IpAddr, String> {
    let own = if text == "localhost" { "127.0.0.1" } else { text };
    own.parse().map_err(|_| {
        "expected an address such as 127.0.0.1, ::1, or 0.0.0.0 for all of this machine's".into()
    })
}

/// A finite number above 0.
pub(super) fn positive_number(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|n: &f64| n.is_finite() && *n > 0.0);
    number.ok_or_else(|| "expected a number above 0".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colors_and_sizes() {
        assert_eq!(color("white"), Ok([1.0; 3]));
        assert_eq!(color("0,0.5,1"), Ok([0.0, 0.5, 1.0]));
        for bad in ["0.5,x,1,0", "0,0,0,x", "nan,0,0", "0,0,inf", "0,,0", ""] {
            assert!(color(bad).is_err(), "{bad}");
        }
        for bad in ["nan", "inf", "-1", "1e10", "", "2m"] {
            assert!(distance(bad).is_err(), "{bad}");
        }
        assert_eq!((distance("0"), distance("2.5"), threads("1024")), (Ok(0.0), Ok(2.5), Ok(1024)));
        assert!(threads("1025").is_err() && threads("0").is_err());
        assert!(color("0,0.5").is_err() && color("2,0,0").is_err() && color("red").is_err());
        assert_eq!(size("4x3"), Ok((4, 3)));
        assert!(size("0x3").is_err() && size("4").is_err());
        assert!(positive("0").is_err() && positive_number("nan").is_err() && finite_number("inf").is_err());
        assert_eq!((at_most::<4>("4"), none_or::<4>("0")), (Ok(4), Ok(0)));
        assert!(positive("18446744073709551615").is_err() && none_or::<4>("5").is_err());
    }
}
