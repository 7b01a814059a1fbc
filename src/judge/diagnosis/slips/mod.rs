//! Slips: simple things that happen to one array, or to one operation of a formula, and that no catalogue can list for every component.

// Of arrays.
mod changes;
mod columns;
pub(crate) mod each;
pub(crate) mod of_arrays;
pub(crate) mod slip;

// Of formulas, whose operations honest implementations tell.
mod formula_slip;
mod infix;
pub(crate) mod misdone;
mod other_numbers;
mod places;
mod several;
mod tried;

// Of both.
pub(crate) mod proved;
pub(crate) mod slipping;
