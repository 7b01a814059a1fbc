//! Marks that are kept: a submission that hasn't changed isn't graded again.

use std::path::{Path, PathBuf};

use super::marks::Graded;
use super::rubric::Rubric;
use crate::error::Result;
use crate::files;

/// Where a submission's marks lie.
fn path(out: &Path, slug: &str) -> PathBuf {
    out.join("marks").join(format!("{slug}.json"))
}

/// Marks of this key, if they are there and fit the rubric.
pub(crate) fn load(out: &Path, slug: &str, key: &str, rubric: &Rubric) -> Option<Graded> {
    let text = files::read_text(&path(out, slug)).ok()?;
    let graded: Graded = serde_json::from_str(&text).ok()?;
    (graded.key == key && graded.rows.len() == rubric.rows.len()).then_some(graded)
}

/// Keeps them.
///
/// # Errors
/// Where they can't be written.
pub(crate) fn store(out: &Path, slug: &str, graded: &Graded) -> Result<()> {
    let text = serde_json::to_string_pretty(graded).expect("marks are plain data");
    write(&path(out, slug), text.as_bytes())
}

/// Writes a file, unless it holds these bytes already.
///
/// # Errors
/// Where it can't be written.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    let same = std::fs::symlink_metadata(path)
        .is_ok_and(|there| there.is_file() && there.len() == bytes.len() as u64)
        && files::read(path, bytes.len() as u64).is_ok_and(|there| there == bytes);
    if same { Ok(()) } else { files::write(path, bytes) }
}
