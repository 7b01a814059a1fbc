//! Files: written whole or not at all, locked, read; arrays and pictures.

use std::fs;
use std::path::Path;

use crate::error::{Error, Result};

#[doc(hidden)]
pub mod fault;
pub mod lock;
pub mod npz;
pub mod photo;
pub mod picture;
mod writing;

pub use writing::{
    Partial, append, check_replaceable, check_writable, make_folder, move_aside, remove_partial, sync, write,
    write_with,
};

/// The whole of a text file.
///
/// # Errors
/// Where it can't be read or isn't UTF-8.
pub fn read_text(path: &Path) -> Result<String> {
    fs::read_to_string(path).map_err(Error::reading(path))
}
