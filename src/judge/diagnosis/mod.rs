//! Diagnosis: what explains the answers of a row that failed. [`diagnose`](diagnose::diagnose) says what is tried, and in which order: the right
//! formula in other conventions, one mistake, lost digits, two mistakes, then what no catalogue lists.

// What is tried, and how well it explains the answers.
#[doc(hidden)]
pub mod evidence;
#[doc(hidden)]
pub mod hypothesis;
mod left_open;
mod nearness;
mod nudged;
mod numbered;
mod numeric;
mod ranked;
mod shown_together;
mod telling;
mod unread;

// Mistakes of the catalogue: one, with a number of its own, two, three, one output after another.
mod climb;
mod commoner;
#[doc(hidden)]
pub mod diagnose;
mod effects;
pub(crate) mod fitted;
mod fitted_pairs;
mod mostly;
mod paired;
mod peel;
mod sets;
mod stepwise;
mod tripled;

// What isn't in it.
mod beyond;
mod by_outputs;
pub(crate) mod imprecise;
mod lawful;
mod lawful_mostly;
pub(crate) mod slips;

// Gradients beside what the forward answers showed.
pub(crate) mod follows;
pub(crate) mod refuted;
