//! What people look at: curves, films, contact sheets, tables, pages.

pub(crate) mod canvas;
mod chart;
pub(crate) mod curve;
pub(crate) mod depth;
mod digits;
pub(crate) mod film;
pub(crate) mod heat;
pub(crate) mod inspect;
pub(crate) mod page;
mod palette;
pub(crate) mod ply;
pub(crate) mod scatter;
pub(crate) mod sheet;
pub(crate) mod space;
pub(crate) mod table;
pub(crate) mod training;
pub(crate) mod views;
