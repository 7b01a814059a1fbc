//! A class, graded: every sub-folder of a folder is a submission, a rubric says what each row is worth, and what comes out is a table, a
//! page a submission, and the files that other programs read. A submission that is broken is a row with its reason.
//!
//! Nothing that a submission holds is trusted: answers are read by the judge's own reader, links aren't followed, Python runs in a process
//! of its own within limits, and what it says is shown, never obeyed.

pub(crate) mod answers;
pub(crate) mod class;
pub(crate) mod kept;
pub(crate) mod marks;
pub(crate) mod pages;
pub(crate) mod python;
pub(crate) mod rubric;
pub(crate) mod sandbox;
pub(crate) mod submission;
pub(crate) mod tables;
