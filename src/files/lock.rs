//! One process at a time in a folder: a file that the system locks for as long as the process lives.
//!
//! Whether a lock is stale is the system's to say: the one of a process that has ended, however it did, is free.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read, Write};
use std::path::Path;

use crate::error::{Error, Input, Result};

/// Its name in the folder; the number of the process that holds it is in it.
pub const NAME: &str = ".lock";

/// A folder that is this process's until the value is dropped.
#[derive(Debug)]
pub struct Lock {
    /// Locked while it is open.
    _file: File,
}

impl Lock {
    /// Locks a folder that exists.
    ///
    /// # Errors
    /// Where another process has it, or where it can't be written.
    pub fn new(folder: &Path) -> Result<Lock> {
        let path = folder.join(NAME);
        if fs::symlink_metadata(&path).is_ok_and(|there| !there.is_file()) {
            return Err(Error::writing(&path)(io::Error::other("it is there already, and no regular file")));
        }
        let open = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(&path);
        let mut file = open.map_err(Error::writing(&path))?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                let mut pid = String::new();
                // Windows keeps others from reading a locked file.
                let _ = file.read_to_string(&mut pid);
                return Err(Error::input(Input {
                    file: folder.display(),
                    field: NAME,
                    found: format!("process {} at work in this folder", pid.trim()),
                    expected: "no other process",
                    remedy: "Wait until it has ended, or end it; or choose another folder.",
                }));
            }
            Err(TryLockError::Error(error)) => return Err(Error::writing(&path)(error)),
        }
        let mut number = || {
            file.set_len(0)?;
            writeln!(file, "{}", std::process::id())
        };
        number().map_err(Error::writing(&path))?;
        Ok(Lock { _file: file })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_has_one_process_at_a_time() {
        let folder = tempfile::tempdir().unwrap();
        let lock = Lock::new(folder.path()).unwrap();
        let refused = Lock::new(folder.path()).unwrap_err().to_string();
        let expected = format!("found process {} at work", std::process::id());
        assert!(cfg!(windows) || refused.contains(&expected), "{refused}");
        drop(lock);
        // What an ended process has left: a number, and no lock.
        fs::write(folder.path().join(NAME), "1234567\n").unwrap();
        let _lock = Lock::new(folder.path()).unwrap();
        assert!(Lock::new(folder.path()).is_err());
    }

    #[cfg(unix)]
    #[test]
    fn a_link_is_not_followed() {
        let folder = tempfile::tempdir().unwrap();
        let other = folder.path().join("other");
        fs::write(&other, "precious").unwrap();
        std::os::unix::fs::symlink(&other, folder.path().join(NAME)).unwrap();
        assert!(Lock::new(folder.path()).is_err());
        assert_eq!(fs::read_to_string(other).unwrap(), "precious");
    }
}
