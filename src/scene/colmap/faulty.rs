//! Errors about the files of a model.

use crate::error::{Error, Input};

/// An error about a file of the model.
pub(super) fn faulty(
    file: &str,
    field: impl ToString,
    found: impl ToString,
    expected: &str,
    remedy: &str,
) -> Error {
    Error::input(Input { file, field, found, expected, remedy })
}
