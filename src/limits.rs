//! What the program takes at most, all in one place. Sizes that no honest input has are refused before anything is allocated for
//! them; what would be honest, but doesn't fit into this machine's memory, too.
//!
//! | what | limit |
//! |---|---|
//! | a text file (JSON, a log) | `TEXT` bytes; nested at most 128 deep, which is serde_json's own limit |
//! | a file of a COLMAP model | `MODEL` bytes; its counts, what the file holds |
//! | a file of weights | `WEIGHTS` bytes |
//! | a picture | `PICTURE_FILE` bytes as a file, `PIXELS` pixels |
//! | an array of an npz | `ARRAY` bytes in memory; the archive's arrays together `fits` |
//! | sides of pictures | `SIDE` pixels |
//! | places and lengths | `LENGTH` scene units |
//! | threads, steps, rays, samples, widths, layers, bands | the constants below |
//! | another program in a bench | `PEER_TIME` a round, `PEER_OUTPUT` bytes |
//!
//! What depends on several of these is estimated and compared with the memory that the machine has left: `fits`.

use crate::error::{Error, Input, Result};

/// Bytes of a text file: a `transforms.json` of 100,000 frames has 60 MB.
pub(crate) const TEXT: u64 = 128 << 20;

/// Bytes of a file of a structure-from-motion model: 1,000 photographs with 20,000 features each have 480 MB.
pub(crate) const MODEL: u64 = 1 << 30;

/// Bytes of a file of weights.
#[cfg(feature = "cli")]
pub(crate) const WEIGHTS: u64 = 1 << 32;

/// Bytes of a picture file.
pub(crate) const PICTURE_FILE: u64 = 512 << 20;

/// Pixels of a picture: 8192 x 8192. Decoded that is 256 MiB, and 1 GiB where a file has 16 bits a channel.
pub(crate) const PIXELS: u64 = 1 << 26;

/// Bytes of an array in memory: 100 pictures of 800 x 800 as f32 are 0.72 of it.
pub const ARRAY: u64 = 1 << 30;

/// A picture's width or height.
pub(crate) const SIDE: usize = 16_384;

/// Distances, places of cameras, focal lengths: beyond them squares lose the digits that matter.
pub(crate) const LENGTH: f64 = 1e9;

/// Steps of a run: 12 days at a millisecond each.
#[cfg(feature = "cli")]
pub(crate) const STEPS: usize = 1 << 30;

/// Threads: more than any machine's cores that this was tried on, few enough to be started.
#[cfg(feature = "cli")]
pub(crate) const THREADS: usize = 1024;

/// Rays (or pixels of a 2D fit) of a step.
#[cfg(feature = "cli")]
pub(crate) const RAYS: usize = 1 << 20;

/// Samples of a ray.
#[cfg(feature = "cli")]
pub(crate) const SAMPLES: usize = 1 << 14;

/// Units of a hidden layer.
#[cfg(feature = "cli")]
pub(crate) const WIDTH: usize = 4096;

/// Hidden layers of a 2D network.
#[cfg(feature = "cli")]
pub(crate) const LAYERS: usize = 64;

/// Bands of an encoding: the last one's period is 2^-31 of a picture.
#[cfg(feature = "cli")]
pub(crate) const LEVELS: usize = 32;

/// Frames of a film.
#[cfg(feature = "cli")]
pub(crate) const FRAMES: usize = 10_000;

/// Rounds of a bench.
#[cfg(feature = "cli")]
pub(crate) const ROUNDS: usize = 1000;

/// Wall clock of one round of another program.
#[cfg(feature = "cli")]
pub(crate) const PEER_TIME: std::time::Duration = std::time::Duration::from_secs(600);

/// Bytes that it may print in a round, on stdout and on stderr.
#[cfg(feature = "cli")]
pub(crate) const PEER_OUTPUT: u64 = 16 << 20;

/// Bytes that this machine has left, or what a container grants at most.
fn memory() -> u64 {
    let mut system = sysinfo::System::new();
    system.refresh_memory();
    let granted = system.cgroup_limits().map_or(u64::MAX, |limits| limits.total_memory);
    match system.available_memory().min(granted) {
        // A system that doesn't tell refuses nothing.
        0 => u64::MAX,
        bytes => bytes,
    }
}

/// Where `bytes`, an estimate, don't fit into the memory that the machine has left: what was found, and what was expected.
pub(crate) fn short_of(bytes: f64) -> Option<(String, String)> {
    /// What every machine has, and not worth asking for.
    const LITTLE: f64 = 16e6;
    let gib = |bytes: f64| format!("{:.1} GiB", bytes / f64::from(1 << 30));
    let left = if bytes > LITTLE { memory() as f64 } else { LITTLE };
    let found = || format!("about {} that it would take", gib(bytes));
    (bytes > left).then(|| (found(), format!("at most {}, which this machine has left", gib(left))))
}

/// That `bytes`, an estimate, fit into the memory that the machine has left.
///
/// # Errors
/// Where they don't: what needs them (a file, or a sentence's subject), and what to change.
pub(crate) fn fits(what: impl ToString, bytes: f64, change: &str) -> Result<()> {
    short_of(bytes).map_or(Ok(()), |(found, expected)| {
        Err(Error::input(Input { file: what, field: "memory", found, expected, remedy: change }))
    })
}

/// Bytes of a training step of rays with so many samples: positions, step lengths, what is drawn for them. Measured 27 to 39.
#[cfg(feature = "cli")]
pub(crate) const STEP_SAMPLE: f64 = 64.0;

/// The same of the compact model, which keeps every sample's features for the way back. Measured 226.
#[cfg(feature = "cli")]
pub(crate) const COMPACT_SAMPLE: f64 = 256.0;

/// Bytes of a sample that `inspect` writes. Measured 184, with a field.
#[cfg(feature = "cli")]
pub(crate) const SHOWN_SAMPLE: f64 = 256.0;

/// Bytes of a network's parameter, with its gradient, Adam's moments, and a checkpoint of all in f64. Measured 66 at most.
#[cfg(feature = "cli")]
pub(crate) const PARAMETER: f64 = 80.0;

/// Bytes of a pixel of a view while it is rendered, or fitted: its ray, colors, depth. Measured 75 for a fit.
#[cfg(feature = "cli")]
pub(crate) const VIEW_PIXEL: f64 = 200.0;

/// Bytes of a pixel of a picture that is kept for a film or a contact sheet, and of that sheet.
#[cfg(feature = "cli")]
pub(crate) const KEPT_PIXEL: f64 = 6.0;

/// Bytes of a pixel of a photograph in floats.
pub(crate) const FINE_PIXEL: f64 = 12.0;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_no_machine_has_is_refused_with_what_to_change() {
        fits("a step", 1e6, "Lower `rays`.").unwrap();
        let message = fits("a step", 1e18, "Lower `rays`.").unwrap_err().to_string();
        for words in ["a step", "931322574.6 GiB", "has left", "Lower `rays`."] {
            assert!(message.contains(words), "{words:?} isn't in: {message}");
        }
    }
}
