//! Writing: to a file of a random name beside the right one, forced to the disk, then renamed, so that a stop in the middle leaves the
//! old file whole.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, ErrorKind, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use super::fault;
use crate::error::{Error, Result};

/// How the names of files begin that aren't whole yet; a killed program leaves them behind.
const PARTIAL: &str = ".partial-";

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

/// Lets `fill` write a new file beside `path`, forces it to the disk, then renames it to `path`.
///
/// A reader therefore sees the whole old file or the whole new file, whenever the program is stopped. The new file has a random name,
/// never one that exists or that a link leads from, and the old one's permissions. Folders above are made.
///
/// # Errors
/// Where the folder or the file can't be written; the old file is still there then.
pub fn write_with(path: &Path, fill: impl FnOnce(&mut BufWriter<Partial>) -> io::Result<()>) -> Result<()> {
    make_folder(folder_of(path))?;
    replace(path, fill).map_err(Error::writing(path))
}

fn replace(path: &Path, fill: impl FnOnce(&mut BufWriter<Partial>) -> io::Result<()>) -> io::Result<()> {
    let folder = folder_of(path);
    let old = old_file(path)?;
    fault::strike()?;
    let mut file = BufWriter::with_capacity(1 << 16, Partial(new_file(folder)?));
    fill(&mut file)?;
    let Partial(file) = file.into_inner().map_err(io::IntoInnerError::into_error)?;
    if let Some(old) = old.filter(|_| cfg!(unix)) {
        file.as_file().set_permissions(old.permissions())?;
    }
    fault::strike()?;
    file.as_file().sync_all()?;
    fault::strike()?;
    file.persist(path)?;
    sync_folder(folder)
}

/// Adds `bytes` to the end of a file that exists. A stop in the middle leaves a part of them.
///
/// # Errors
/// Where the file can't be written.
pub fn append(path: &Path, bytes: impl AsRef<[u8]>) -> Result<()> {
    struct Whole(File);
    impl Write for Whole {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            write_some(&mut self.0, bytes)
        }

        fn flush(&mut self) -> io::Result<()> {
            self.0.flush()
        }
    }
    let file = OpenOptions::new().append(true).open(path);
    file.and_then(|file| Whole(file).write_all(bytes.as_ref())).map_err(Error::writing(path))
}

/// Forces what was appended to a file to the disk.
///
/// # Errors
/// Where the disk refuses.
pub fn sync(path: &Path) -> Result<()> {
    let sync = || {
        fault::strike()?;
        OpenOptions::new().append(true).open(path)?.sync_all()
    };
    sync().map_err(Error::writing(path))
}

/// Whether files can be written to `folder`, once it is made: asked before long work. Leaves nothing behind, no folder either.
///
/// # Errors
/// Where they can't.
pub fn check_writable(folder: &Path) -> Result<()> {
    let mut there = folder;
    while !there.try_exists().unwrap_or(true) {
        there = folder_of(there);
    }
    new_file(there).map(drop).map_err(Error::writing(folder))
}

/// The same for a file in the place of `path`.
///
/// # Errors
/// Where it can't be written.
pub fn check_replaceable(path: &Path) -> Result<()> {
    old_file(path).map_err(Error::writing(path))?;
    check_writable(folder_of(path))
}

/// Renames a folder to the first free of `NAME.old-1`, `NAME.old-2`, ...
///
/// # Errors
/// Where it has no name of its own (`..`), or can't be renamed.
pub fn move_aside(folder: &Path) -> Result<PathBuf> {
    let moved = (1..).map(|n| {
        let mut name = folder.file_name().unwrap_or_default().to_os_string();
        name.push(format!(".old-{n}"));
        folder.with_file_name(name)
    });
    let free = moved.into_iter().find(|path| fs::symlink_metadata(path).is_err());
    let free = free.expect("folders are fewer than numbers");
    let rename = || {
        if folder.file_name().is_none() {
            return Err(io::Error::new(
                ErrorKind::InvalidInput,
                "a folder without a name can't be moved aside",
            ));
        }
        fault::strike()?;
        fs::rename(folder, &free)?;
        sync_folder(folder_of(folder))
    };
    rename().map_err(Error::writing(folder))?;
    Ok(free)
}

/// Removes what a killed program left unfinished in a folder where nobody else is writing.
pub fn remove_partial(folder: &Path) {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    for entry in entries.filter(|entry| entry.file_name().to_string_lossy().starts_with(PARTIAL)) {
        // They are in nobody's way.
        let _ = fs::remove_file(entry.path());
    }
}

/// What there is at `path`, which must be nothing or a file.
fn old_file(path: &Path) -> io::Result<Option<fs::Metadata>> {
    // Where a link leads counts: renaming onto /dev/stdout would replace the link for the whole machine.
    let old = fs::metadata(path).ok();
    if old.as_ref().is_some_and(|old| !old.is_file()) {
        return Err(io::Error::new(ErrorKind::InvalidInput, "it is there already, and no regular file"));
    }
    Ok(old)
}

/// A file that isn't whole yet; removed where it is dropped.
#[derive(Debug)]
pub struct Partial(NamedTempFile);

impl Write for Partial {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        write_some(self.0.as_file_mut(), bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

impl Seek for Partial {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.0.seek(to)
    }
}

/// One write; where a fault strikes, half of it gets through, as when a disk fills up.
fn write_some(file: &mut File, bytes: &[u8]) -> io::Result<usize> {
    fault::strike_after(|| drop(file.write_all(&bytes[..bytes.len() / 2])))?;
    file.write(bytes)
}

/// A new empty file in `folder`, with a random name and the permissions of any new file.
fn new_file(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(PARTIAL);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // The umask takes its share of them; tempfile's own default keeps everybody else out.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder)
}

/// The folder that `path` lies in.
fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Forces a folder's names to the disk, where the system knows how.
fn sync_folder(folder: &Path) -> io::Result<()> {
    fault::strike()?;
    if !cfg!(unix) {
        return Ok(());
    }
    // A folder may be written to without being readable, and some file systems sync files alone.
    let Ok(folder) = File::open(folder) else { return Ok(()) };
    match folder.sync_all() {
        Err(error) if !matches!(error.kind(), ErrorKind::InvalidInput | ErrorKind::Unsupported) => Err(error),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::read_text;

    fn names(folder: &Path) -> Vec<String> {
        fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect()
    }

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
        assert_eq!(names(path.parent().unwrap()), ["file"], "nothing is left beside it");
        write(&path, "new").unwrap();
        assert_eq!(read_text(&path).unwrap(), "new");
    }

    /// Permissions stay, those of a new file are any new file's, links are replaced and what they lead to isn't touched.
    #[cfg(unix)]
    #[test]
    fn permissions_stay_and_links_are_not_followed() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let folder = tempfile::tempdir().unwrap();
        let (path, plain) = (folder.path().join("file"), folder.path().join("plain"));
        fs::write(&plain, "").unwrap();
        write(&path, "old").unwrap();
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
        assert_eq!(mode(&path), mode(&plain));
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
        write(&path, "new").unwrap();
        assert_eq!((mode(&path), read_text(&path).unwrap().as_str()), (0o640, "new"));
        let link = folder.path().join("link");
        symlink(&path, &link).unwrap();
        write(&link, "other").unwrap();
        assert_eq!(
            (read_text(&link).unwrap().as_str(), read_text(&path).unwrap().as_str()),
            ("other", "new")
        );
    }

    #[cfg(unix)]
    #[test]
    fn what_is_no_file_is_not_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let link = folder.path().join("null");
        std::os::unix::fs::symlink("/dev/null", &link).unwrap();
        for path in [folder.path(), &link] {
            assert!(write(path, "text").unwrap_err().to_string().contains("no regular file"), "{path:?}");
        }
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    }

    #[test]
    fn an_unwritable_folder_is_found_and_nothing_is_left() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        write(&file, "").unwrap();
        check_writable(&folder.path().join("not/yet/there")).unwrap();
        assert!(check_writable(&file).is_err() && check_writable(&file.join("below")).is_err());
        assert_eq!(names(folder.path()), ["file"]);
    }

    #[test]
    fn folders_are_moved_to_the_next_free_name_and_leftovers_go() {
        let folder = tempfile::tempdir().unwrap();
        let run = folder.path().join("run");
        for n in 1..3 {
            write(&run.join("file"), n.to_string()).unwrap();
            let moved = move_aside(&run).unwrap();
            assert_eq!(moved, folder.path().join(format!("run.old-{n}")));
            assert_eq!(read_text(&moved.join("file")).unwrap(), n.to_string());
        }
        assert!(!run.exists() && move_aside(Path::new("..")).is_err());
        let old = folder.path().join("run.old-1");
        write(&old.join(".partial-x1"), "").unwrap();
        remove_partial(&old);
        assert_eq!(names(&old), ["file"]);
    }
}
