//! `--shard I/N`: one of N processes does every Nth piece of work and leaves a part, a folder with its results and `part.json`.
//!
//! `part.json` is written last: a part without it was cut off, and is done again by the same command. It says what work it is a part of,
//! so that parts of different work are never put together.

use std::io::Read;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use image::RgbImage;
use serde_json::{Map, Value, json};
use sha2::{Digest, Sha256};

use crate::camera::Camera;
use crate::error::{Error, Result};
use crate::files::{self, picture};
use crate::scene::digest;

/// The version of parts.
pub(super) const SCHEMA: &str = "nerf-oracle/part/1";
/// The file that says that a part is whole.
pub(super) const FILE: &str = "part.json";
/// The most parts of one work.
pub(super) const MOST: usize = 100_000;

/// Which part of how many.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Shard {
    /// From 1.
    pub number: usize,
    /// How many there are.
    pub of: usize,
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Shard, String> {
        let parts = text.split_once('/').and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
        parts
            .map(|(number, of)| Shard { number, of })
            .filter(|shard| (1..=shard.of).contains(&shard.number) && shard.of <= MOST)
            .ok_or_else(|| format!("expected I/N, such as 1/8: I from 1 to N, N at most {MOST}"))
    }
}

impl Shard {
    /// Whether piece `n`, from 0, is this shard's.
    pub(super) fn has(self, n: usize) -> bool {
        n % self.of == self.number - 1
    }
}

/// Whether piece `n` is to be done: all are, where there are no shards.
pub(super) fn has(shard: Option<Shard>, n: usize) -> bool {
    shard.is_none_or(|shard| shard.has(n))
}

/// A piece of work that was done.
pub(super) struct Piece {
    /// Its number among all, from 0.
    pub number: usize,
    /// What is known of it.
    pub value: Value,
    /// Its picture, where it has one.
    pub picture: Option<RgbImage>,
}

/// The name of a piece's picture in a part.
pub(super) fn picture_of(part: &Path, number: usize) -> PathBuf {
    part.join(format!("{number:06}.png"))
}

/// Writes a part: `work` is all that determines the results, and `count` how many pieces there are in all of it.
///
/// # Errors
/// Where a file can't be written.
pub(super) fn write(part: &Path, shard: Shard, work: &Value, count: usize, pieces: Vec<Piece>) -> Result<()> {
    files::make_folder(part)?;
    let mut values = Map::new();
    for Piece { number, value, picture } in pieces {
        if let Some(picture) = picture {
            picture::write_rgb(&picture_of(part, number), &picture)?;
        }
        values.insert(number.to_string(), value);
    }
    let whole = json!({
        "schema": SCHEMA, "work": work, "shard": shard.number, "shards": shard.of, "count": count, "pieces": values,
    });
    files::write(&part.join(FILE), whole.to_string() + "\n")
}

/// SHA-256 of a file.
pub(super) fn of_file(path: &Path) -> Result<String> {
    let (mut hash, mut file) = (Sha256::new(), files::open(path, u64::MAX)?);
    let mut some = vec![0; 1 << 20];
    loop {
        match file.read(&mut some).map_err(Error::reading(path))? {
            0 => return Ok(digest::hex(&hash.finalize())),
            read => hash.update(&some[..read]),
        }
    }
}

/// SHA-256 of cameras: of a film's path, however it was made.
pub(super) fn of_cameras(cameras: &[Camera]) -> String {
    let mut hash = Sha256::new();
    for Camera { width, height, k, c2w, distortion } in cameras {
        let numbers = json!([width, height, k, c2w.to_cols_array(), distortion]);
        hash.update(numbers.to_string());
    }
    digest::hex(&hash.finalize())
}

/// A number that comes back with all of its bits, infinite or none too.
pub(super) fn exact(x: f64) -> Value {
    x.to_string().into()
}
