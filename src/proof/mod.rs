//! What our own tests need: fixtures, the reference's own error, numeric gradients, and the tables of bounds and mistakes.

pub mod catalogue;
pub mod golden;
pub mod gradient;
pub mod own_error;
pub mod selfcheck;
pub mod tables;
