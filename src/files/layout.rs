//! How the arrays of a case lie in files: as an archive, or as bare numbers.

use std::fmt;
use std::fs;
use std::path::Path;
use std::str::FromStr;

use super::npz::{self, Array, Arrays, Npz};
use super::raw::{self, Raw};
use crate::error::{Error, Result};

/// Either layout. A place is a path without extension, `volume_render/forward-slab`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Layout {
    /// An npz at the place.
    #[default]
    Npz,
    /// A folder at the place with one file an array, and an index ([`raw`]).
    Raw,
}

impl Layout {
    /// The file that says what arrays there are.
    pub fn file(self, place: &str) -> String {
        match self {
            Layout::Npz => format!("{place}.npz"),
            Layout::Raw => format!("{place}/{}", raw::INDEX),
        }
    }

    /// Writes the arrays to a place below a folder. Returns the bytes written.
    ///
    /// # Errors
    /// Where they can't be written.
    pub fn write(self, folder: &Path, place: &str, arrays: &Arrays) -> Result<u64> {
        let path = folder.join(self.file(place));
        match self {
            Layout::Npz => {
                npz::write(&path, arrays, false)?;
                fs::metadata(&path).map(|data| data.len()).map_err(Error::reading(&path))
            }
            Layout::Raw => raw::write(&folder.join(place), arrays),
        }
    }
}

impl fmt::Display for Layout {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.pad(match self {
            Layout::Npz => "npz",
            Layout::Raw => "raw",
        })
    }
}

impl FromStr for Layout {
    type Err = Error;
    fn from_str(s: &str) -> Result<Self> {
        let found = [Layout::Npz, Layout::Raw].into_iter().find(|layout| layout.to_string() == s);
        found.ok_or_else(|| Error::usage("layout", s, "npz or raw"))
    }
}

/// Arrays that lie somewhere, in either layout.
#[derive(Debug)]
pub enum Store {
    /// An archive.
    Npz(Npz),
    /// A folder.
    Raw(Raw),
}

impl Store {
    /// Opens what lies at a place below a folder in this layout.
    ///
    /// # Errors
    /// As [`Npz::open`] and [`Raw::open`].
    pub fn open(layout: Layout, folder: &Path, place: &str) -> Result<Store> {
        match layout {
            Layout::Npz => Npz::open(&folder.join(layout.file(place))).map(Store::Npz),
            Layout::Raw => Raw::open(&folder.join(place)).map(Store::Raw),
        }
    }

    /// The names of the arrays.
    pub fn names(&self) -> Vec<String> {
        match self {
            Store::Npz(npz) => npz.names().map(String::from).collect(),
            Store::Raw(raw) => raw.names().map(String::from).collect(),
        }
    }

    /// The bytes that they say they have, unpacked.
    pub fn bytes(&mut self) -> u64 {
        match self {
            Store::Npz(npz) => npz.unpacked_bytes(),
            Store::Raw(raw) => raw.bytes(),
        }
    }

    /// Reads one array.
    ///
    /// # Errors
    /// As [`Npz::array`] and [`Raw::array`].
    pub fn array(&mut self, name: &str) -> Result<Array> {
        match self {
            Store::Npz(npz) => npz.array(name),
            Store::Raw(raw) => raw.array(name),
        }
    }
}
