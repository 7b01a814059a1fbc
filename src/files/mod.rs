//! Files: written whole or not at all, locked, read; arrays and pictures.

pub mod bytes;
#[doc(hidden)]
pub mod fault;
pub mod json;
pub mod layout;
pub mod lock;
pub mod mask;
pub mod npz;
pub mod photo;
pub mod picture;
pub mod raw;
mod reading;
#[cfg(feature = "cli")]
pub mod safetensors;
mod whole;
mod writing;

pub use reading::{open, read, read_text};
pub use writing::{
    Partial, append, check_replaceable, check_writable, make_folder, move_aside, remove_partial, sync, write,
    write_with,
};
