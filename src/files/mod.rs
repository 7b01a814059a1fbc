//! Files: written under a temporary name and renamed, so that a stop in the middle leaves the old file; arrays and pictures.

use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::Path;

use crate::error::{Error, Result};

pub mod json;
pub mod npz;
pub mod photo;
pub mod picture;
mod reading;
mod whole;

pub use reading::{open, read, read_text};

/// Makes `folder` and those above it, where they aren't there yet.
///
/// # Errors
/// Where it can't be made.
pub fn make_folder(folder: &Path) -> Result<()> {
    fs::create_dir_all(folder).map_err(Error::writing(folder))
}

/// Writes `bytes` to `path` by way of [`write_with`].
///
/// # Errors
/// Where the file can't be written.
pub fn write(path: &Path, bytes: impl AsRef<[u8]>) -> Result<()> {
    write_with(path, |file| file.write_all(bytes.as_ref()))
}

/// Lets `fill` write a file beside `path` (its name and `.partial`), forces it to the disk, then renames it to `path`.
///
/// A reader therefore sees the whole old file or the whole new file, whenever the program is stopped. Folders above are made.
///
/// # Errors
/// Where the folder or the file can't be written; the old file is still there then.
pub fn write_with(path: &Path, fill: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> Result<()> {
    if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        make_folder(folder)?;
    }
    let mut aside = OsString::from(path);
    aside.push(".partial");
    let written = (|| {
        let mut file = BufWriter::new(File::create(&aside)?);
        fill(&mut file)?;
        file.flush()?;
        file.get_ref().sync_all()?;
        fs::rename(&aside, path)
    })();
    if written.is_err() {
        // This error matters more than a leftover that can't be removed either.
        let _ = fs::remove_file(&aside);
    }
    written.map_err(Error::writing(path))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_the_old_file_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("deep/er/file");
        write(&path, "old").unwrap();
        let failed = write_with(&path, |file| {
            file.write_all(b"half of the ne")?;
            Err(io::Error::other("the disk is full"))
        });
        assert!(matches!(failed, Err(Error::Io { .. })));
        assert_eq!(read_text(&path).unwrap(), "old");
        assert_eq!(fs::read_dir(path.parent().unwrap()).unwrap().count(), 1, "nothing is left beside it");
        write(&path, "new").unwrap();
        assert_eq!(read_text(&path).unwrap(), "new");
    }
}
