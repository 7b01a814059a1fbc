//! Verdicts on other people's programs: questions, answers, marks, and the mistake that explains them.

#[doc(hidden)]
pub mod answer;
#[doc(hidden)]
pub mod asking;
pub(crate) mod assignment;
mod best;
mod beyond;
pub(crate) mod candidate;
mod changes;
mod climb;
mod columns;
#[doc(hidden)]
pub mod declared;
#[doc(hidden)]
pub mod diagnose;
pub(crate) mod door;
mod each;
mod edges;
#[doc(hidden)]
#[cfg(feature = "cli")]
pub(crate) mod errors;
#[doc(hidden)]
pub mod evidence;
#[doc(hidden)]
pub mod exam;
mod example;
#[cfg(feature = "files")]
#[doc(hidden)]
pub mod exchange;
pub mod explain;
mod fitted;
mod fitted_pairs;
mod follows;
mod formula_slip;
#[doc(hidden)]
pub mod hypothesis;
mod imprecise;
mod infix;
#[doc(hidden)]
pub mod judging;
mod known;
#[doc(hidden)]
pub mod large;
mod lawful;
pub(crate) mod layout;
mod left_open;
#[doc(hidden)]
pub mod mark;
mod misdone;
mod mostly;
mod nearness;
pub(crate) mod numeric;
mod observed;
mod other_numbers;
pub(crate) mod page;
mod paired;
pub(crate) mod partial;
mod peel;
mod places;
mod ranked;
mod reach;
mod rearranged;
mod refuted;
mod repeat;
#[doc(hidden)]
pub mod report;
mod round;
mod several;
mod slip;
mod slipping;
mod slips;
#[doc(hidden)]
pub mod statistics;
mod stepwise;
mod telling;
mod tried;
mod tripled;
mod truths;
pub(crate) mod typed;
mod unread;

pub use candidate::{Candidate, judge, judge_large};
pub use door::Door;
pub use exam::Exam;
pub use large::LargeExam;
pub use report::{Report, Verdict};
pub use typed::{Element, Input, Output, Outputs};
