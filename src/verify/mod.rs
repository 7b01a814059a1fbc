//! The harness around the components: what a component is, how it is checked, and how others' programs are judged.

pub mod arithmetic;
pub mod bounded;
pub mod case;
pub mod check;
pub mod component;
pub mod machine;

pub use arithmetic::{Arithmetic, Dtype, Grade};
pub use bounded::Bounded;
pub use case::{Case, Draw};
pub use check::Kind;
pub use component::{Arrays, Component, Mistake, Pass, Port};
pub use machine::Machine;
