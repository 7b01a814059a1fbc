//! The harness around the components: what a component is, how it is checked, and how others' programs are judged.

pub mod component;

pub use component::{Arrays, Component, Mistake, Port};
