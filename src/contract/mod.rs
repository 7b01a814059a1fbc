//! What a component is: named arrays, cases, types and how far an honest implementation in them may be off. Knows no component.

pub mod arithmetic;
pub mod arrays;
pub mod bounded;
pub mod case;
pub mod check;
pub mod component;
pub(crate) mod fault;
pub mod hazard;
pub(crate) mod how;
pub mod inputs;
pub mod laid;
pub mod large;
pub mod laws;
pub mod machine;
pub(crate) mod operation;
pub(crate) mod operations;
pub mod propagate;
pub mod recipe;
pub(crate) mod seen;
pub(crate) mod site;
pub mod special;

#[cfg(test)]
pub(crate) mod testing;

pub use arithmetic::{Arithmetic, Dtype, Grade};
pub use arrays::Arrays;
pub use bounded::Bounded;
pub use case::{Case, Draw};
pub use check::Kind;
pub use component::{Component, Direction, Entries, Mistake, Port};
pub use machine::Machine;
pub use special::{Finding, Form, Special, Statistics};
