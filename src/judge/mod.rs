//! Verdicts on other people's programs: questions, answers, marks, and the mistake that explains them.

pub mod answer;
pub mod assignment;
pub mod diagnose;
pub mod door;
pub mod exam;
#[cfg(feature = "files")]
pub mod exchange;
pub mod explain;
pub mod hypothesis;
pub mod judging;
pub mod layout;
pub mod mark;
pub mod numeric;
pub mod page;
pub mod report;
pub mod statistics;
pub mod typed;

pub use door::Door;
pub use exam::Exam;
pub use judging::{Candidate, judge};
pub use report::{Report, Verdict};
pub use typed::{Element, Input, Output, Outputs};
