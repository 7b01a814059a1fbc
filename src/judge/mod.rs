//! Verdicts on other people's programs: questions, answers, marks, and the mistake that explains them.

// What is asked: cases, and what is true of them.
#[doc(hidden)]
pub mod exam;
#[doc(hidden)]
pub mod large;
mod truths;

// Who answers: closures, kernels with types of their own, files.
#[doc(hidden)]
pub mod answer;
#[doc(hidden)]
pub mod asking;
pub(crate) mod candidate;
#[doc(hidden)]
pub mod declared;
pub(crate) mod door;
#[cfg(feature = "files")]
#[doc(hidden)]
pub mod exchange;
mod rearranged;
mod repeat;
pub(crate) mod typed;

// Answers against the truth: element by element, in the conventions of the whole run, in any layout.
pub(crate) mod assignment;
mod best;
#[doc(hidden)]
#[cfg(feature = "cli")]
pub(crate) mod errors;
mod known;
pub(crate) mod layout;
#[doc(hidden)]
pub mod mark;
pub(crate) mod partial;
#[doc(hidden)]
pub mod statistics;
mod transposed;
pub(crate) mod within;

// What explains wrong ones.
#[doc(hidden)]
pub mod diagnosis;

// From all that to a verdict on each row, and a report.
mod edges;
mod example;
pub mod explain;
#[doc(hidden)]
pub mod judging;
mod observed;
pub(crate) mod page;
mod reach;
#[doc(hidden)]
pub mod report;
mod round;

pub use candidate::{Candidate, judge, judge_large};
pub use door::Door;
pub use exam::Exam;
pub use large::LargeExam;
pub use report::{Report, Verdict};
pub use typed::{Element, Input, Output, Outputs};
