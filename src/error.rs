//! One error type. Each message says what was read, what was found, what was expected, and what to try next.

use std::path::{Path, PathBuf};

/// Everything that can be wrong with a user's input. The program ends with exit code 2 on any of these.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file, an array or a field that isn't what it should be.
    #[error("{file}: {field}: found {found}; expected {expected}. {advice}")]
    Input {
        /// The file (or scene, or folder) that was read.
        file: String,
        /// The array, the JSON field or the part of the file.
        field: String,
        /// What was there.
        found: String,
        /// What should have been there.
        expected: String,
        /// The next thing to try, a whole sentence.
        advice: String,
    },
    /// An argument that can't be used.
    #[error("{argument}: found {found}; expected {expected}")]
    Usage {
        /// Its name, e.g. `near`.
        argument: String,
        /// Its value.
        found: String,
        /// What it may be.
        expected: String,
    },
    /// The operating system refused.
    #[error("{}: {action}: {source}. {advice}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What was being done, e.g. "can't be read".
        action: &'static str,
        /// The system's own words.
        source: std::io::Error,
        /// The next thing to try, a whole sentence.
        advice: String,
    },
}

/// The crate's result.
pub type Result<T, E = Error> = std::result::Result<T, E>;

impl Error {
    /// An input that isn't what it should be: `file`, `field`, what was found, what was expected, what to do.
    pub fn input(
        file: impl ToString,
        field: impl ToString,
        found: impl ToString,
        expected: impl ToString,
        advice: impl ToString,
    ) -> Self {
        Error::Input {
            file: file.to_string(),
            field: field.to_string(),
            found: found.to_string(),
            expected: expected.to_string(),
            advice: advice.to_string(),
        }
    }

    /// An argument that can't be used.
    pub fn usage(argument: impl ToString, found: impl ToString, expected: impl ToString) -> Self {
        Error::Usage {
            argument: argument.to_string(),
            found: found.to_string(),
            expected: expected.to_string(),
        }
    }

    /// A closure for `map_err` on a read of `path`.
    pub fn reading(path: &Path) -> impl FnOnce(std::io::Error) -> Error + '_ {
        move |source| Error::Io {
            path: path.to_path_buf(),
            action: "can't be read",
            source,
            advice: "Check the path and its permissions.".into(),
        }
    }

    /// A closure for `map_err` on a write to `path`.
    pub fn writing(path: &Path) -> impl FnOnce(std::io::Error) -> Error + '_ {
        move |source| Error::Io {
            path: path.to_path_buf(),
            action: "can't be written",
            source,
            advice: "Choose an output folder that exists or can be made, with space left.".into(),
        }
    }
}
