//! What people look at: curves, films, contact sheets, tables, pages.

pub mod canvas;
mod chart;
pub mod curve;
pub mod film;
pub mod inspect;
pub mod page;
pub mod scatter;
pub mod sheet;
pub mod table;
