//! Files as they are read: regular ones, up to a size.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;

use crate::error::{Error, Input, Result};
use crate::limits;

/// Opens a file of at most `most` bytes to read it.
///
/// # Errors
/// Where it can't be read, is larger, or is no regular file: a pipe or a device may never end, or never begin.
pub fn open(path: &Path, most: u64) -> Result<File> {
    let refuse = |field, found: String, expected, remedy| {
        Err(Error::input(Input { file: path.display(), field, found, expected, remedy }))
    };
    let about = fs::metadata(path).map_err(Error::reading(path))?;
    if !about.is_file() {
        let found = if about.is_dir() { "a folder" } else { "a pipe or a device" };
        let remedy = "Copy what it holds into a file.";
        return refuse("kind of file", found.into(), "a regular file".to_string(), remedy);
    }
    if about.len() > most {
        let found = format!("{} bytes", about.len());
        return refuse(
            "size",
            found,
            format!("at most {most} bytes"),
            "Check that it is the file that was meant.",
        );
    }
    File::open(path).map_err(Error::reading(path))
}

/// The bytes of a file of at most `most` of them.
///
/// # Errors
/// As [`open`].
pub fn read(path: &Path, most: u64) -> Result<Vec<u8>> {
    let mut bytes = vec![];
    // Not beyond the limit, where a file grows meanwhile or has no size of its own (/proc).
    open(path, most)?.take(most).read_to_end(&mut bytes).map_err(Error::reading(path))?;
    Ok(bytes)
}

/// The whole of a text file.
///
/// # Errors
/// Where it can't be read, isn't UTF-8, or is longer than `limits::TEXT`.
pub fn read_text(path: &Path) -> Result<String> {
    let wrong = |error| Error::reading(path)(io::Error::new(io::ErrorKind::InvalidData, error));
    String::from_utf8(read(path, limits::TEXT)?).map_err(wrong)
}
