//! One error type. Each message says what was read, what was found, what was expected, and what to try next.
//!
//! Settings are named in backticks, `near`, as a caller in Rust knows them; the program spells them as its options.

use std::fmt;
use std::path::{Path, PathBuf};

use crate::shown::shown;

/// Everything that can be wrong with a user's input. The program ends with exit code 2 on any of these.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file, an array or a field that isn't what it should be.
    #[error("{0}")]
    Input(Input),
    /// An argument that can't be used.
    #[error("{argument}: found {}; expected {expected}", shown(found))]
    Usage {
        /// Its name, e.g. `near`.
        argument: String,
        /// Its value.
        found: String,
        /// What it may be.
        expected: String,
    },
    /// The operating system refused.
    #[error("{}: {action}: {source}. {remedy}", shown(&path.to_string_lossy()))]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What was being done, e.g. "can't be read".
        action: &'static str,
        /// The system's own words.
        source: std::io::Error,
        /// The next thing to try, a whole sentence.
        remedy: String,
    },
}

/// What was read, what was there, and what should have been: [`Error::Input`], made of whatever can be shown.
///
/// ```
/// use nerf_oracle::error::{Error, Input};
/// let remedy = "Round it.";
/// let error = Error::input(Input { file: "run.json", field: "step", found: 1.5, expected: "a whole number", remedy });
/// assert_eq!(error.to_string(), "run.json: step: found 1.5; expected a whole number. Round it.");
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Input<File = String, Field = String, Found = String, Expected = String, Remedy = String> {
    /// The file (or scene, or folder) that was read.
    pub file: File,
    /// The array, the JSON field or the part of the file.
    pub field: Field,
    /// What was there.
    pub found: Found,
    /// What should have been there.
    pub expected: Expected,
    /// The next thing to try, a whole sentence.
    pub remedy: Remedy,
}

impl fmt::Display for Input {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        // File names, array names and what was found come from outside.
        let [file, field, found, expected] =
            [&self.file, &self.field, &self.found, &self.expected].map(|text| shown(text));
        let remedy = &self.remedy;
        write!(f, "{file}: {field}: found {found}; expected {expected}. {remedy}")
    }
}

/// The crate's result.
pub type Result<T, E = Error> = std::result::Result<T, E>;

impl Error {
    /// An input that isn't what it should be.
    pub fn input(
        Input { file, field, found, expected, remedy }: Input<
            impl ToString,
            impl ToString,
            impl ToString,
            impl ToString,
            impl ToString,
        >,
    ) -> Self {
        Error::Input(Input {
            file: file.to_string(),
            field: field.to_string(),
            found: found.to_string(),
            expected: expected.to_string(),
            remedy: remedy.to_string(),
        })
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
            remedy: "Check the path and its permissions.".into(),
        }
    }

    /// A closure for `map_err` on a write to `path`.
    pub fn writing(path: &Path) -> impl FnOnce(std::io::Error) -> Error + '_ {
        move |source| Error::Io {
            path: path.to_path_buf(),
            action: "can't be written",
            source,
            remedy: "Choose an output folder that exists or can be made, with space left.".into(),
        }
    }
}
