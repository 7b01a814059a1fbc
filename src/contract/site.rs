//! Operations in the text of a formula.

use std::panic::Location;

use super::operation::Operation;

/// An operation in the text of a formula.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Site {
    /// What is done there.
    pub operation: Operation,
    /// Where that is.
    pub at: &'static Location<'static>,
}

impl PartialEq for Site {
    /// Asked at every operation: what differs most often comes first.
    fn eq(&self, other: &Site) -> bool {
        let place = |site: &Site| (site.at.line(), site.at.column());
        place(self) == place(other) && self.operation == other.operation && self.at.file() == other.at.file()
    }
}

/// A number of an operation that was done before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Origin {
    /// Where that was.
    pub site: Site,
    /// Its first number, its second one, or (2) what came out.
    pub place: usize,
}
