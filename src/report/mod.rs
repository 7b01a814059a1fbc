//! What people look at: curves, films, contact sheets, tables, pages.

pub mod curve;
pub mod film;
pub mod page;
pub mod sheet;
pub mod table;
