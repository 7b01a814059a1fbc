//! The parts of sharded work, read and put together: all of one work, each whole, none missing.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde_json::Value;

use super::output;
use super::shard::{FILE, MOST, SCHEMA, picture_of};
use crate::error::{Error, Input, Result};
use crate::files::json::Holds::{self, *};
use crate::files::{self, json as parsed, picture};

const PART: Holds = Object(&[
    ("schema", Word(&[SCHEMA])),
    ("work", Object(&[])),
    ("shard", Whole(1, MOST as u64)),
    ("shards", Whole(1, MOST as u64)),
    ("count", Whole(1, 1 << 32)),
    ("pieces", Object(&[])),
]);

pub(super) const REMEDY: &str = "Do this part again, by the command that made it.";

/// A part that is whole.
struct Part {
    folder: PathBuf,
    json: Value,
}

/// All pieces of a work, in their order.
pub(super) struct Merged {
    /// What determines them.
    pub work: Value,
    /// What is known of each.
    pub values: Vec<Value>,
    /// The part that each is from.
    folders: Vec<PathBuf>,
}

impl Merged {
    /// A number of piece `n`, with all of its bits.
    ///
    /// # Errors
    /// Where there is none.
    pub(super) fn number(&self, n: usize, name: &str) -> Result<f64> {
        let number = self.values[n][name].as_str().and_then(|text| text.parse().ok());
        number.ok_or_else(|| self.wrong(n, name))
    }

    /// An error about a field of piece `n`.
    pub(super) fn wrong(&self, n: usize, name: &str) -> Error {
        let (file, field) = (self.folders[n].join(FILE).display().to_string(), format!("pieces.{n}.{name}"));
        let (found, expected) = (parsed::short(&self.values[n][name]), "what --shard writes there");
        Error::input(Input { file, field, found, expected, remedy: REMEDY })
    }

    /// The picture of each piece.
    ///
    /// # Errors
    /// Where one can't be read.
    pub(super) fn pictures(&self) -> Result<Vec<image::RgbImage>> {
        let read = |(n, folder): (usize, &PathBuf)| {
            let path = picture_of(folder, n);
            Ok(picture::to_rgb(picture::read(&path)?.view()))
        };
        self.folders.iter().enumerate().map(read).collect()
    }
}

/// Reads parts and puts their pieces into one order.
pub(super) fn whole(folders: &[PathBuf]) -> Result<Merged> {
    let mut parts: BTreeMap<u64, Part> = BTreeMap::new();
    let mut cut_off = vec![];
    for folder in folders {
        let Some(part) = read(folder)? else {
            output::say(&format!("warning: {}: no {FILE}: this part was cut off.", folder.display()));
            cut_off.push(folder.display().to_string());
            continue;
        };
        if let Some(first) = parts.values().next() {
            same_work(first, &part)?;
        }
        let number = part.json["shard"].as_u64().unwrap_or_default();
        match parts.get(&number) {
            Some(other) => same_part(other, &part)?,
            None => drop(parts.insert(number, part)),
        }
    }
    let Some(first) = parts.values().next() else {
        let (file, expected) = (folders[0].display(), "at least one part that is whole");
        return Err(Error::input(Input { file, field: FILE, found: "none", expected, remedy: REMEDY }));
    };
    let shards = first.json["shards"].as_u64().unwrap_or_default();
    let missing: Vec<String> =
        (1..=shards).filter(|n| !parts.contains_key(n)).map(|n| format!("{n}/{shards}")).collect();
    if !missing.is_empty() {
        let cut =
            if cut_off.is_empty() { String::new() } else { format!(" (cut off: {})", cut_off.join(", ")) };
        let found = format!("{} of {shards}, without {}{cut}", parts.len(), missing.join(", "));
        let remedy = "Run the same command with each --shard that is missing, and merge again.";
        let (file, expected) = ("parts", "every part of the work");
        return Err(Error::input(Input { file, field: "shards", found, expected, remedy }));
    }
    let (work, count) = (first.json["work"].clone(), first.json["count"].as_u64().unwrap_or_default());
    let (mut values, mut from) = (vec![], vec![]);
    for n in 0..count {
        let part = &parts[&(n % shards + 1)];
        let Some(value) = part.json["pieces"].get(n.to_string()) else {
            let (file, field) = (part.folder.join(FILE).display().to_string(), format!("pieces.{n}"));
            let expected = "a piece of this part";
            return Err(Error::input(Input { file, field, found: "none", expected, remedy: REMEDY }));
        };
        values.push(value.clone());
        from.push(part.folder.clone());
    }
    Ok(Merged { work, values, folders: from })
}

/// A part; `None` where it was cut off.
fn read(folder: &Path) -> Result<Option<Part>> {
    let path = folder.join(FILE);
    if folder.is_dir() && !path.exists() {
        return Ok(None);
    }
    let file = path.display().to_string();
    let json = parsed::parse(&files::read_text(&path)?).map_err(|error| {
        let expected = "a part, as --shard writes it";
        Error::input(Input { file: &file, field: "JSON", found: error, expected, remedy: REMEDY })
    })?;
    PART.check(&file, "", &json, REMEDY)?;
    Ok(Some(Part { folder: folder.to_path_buf(), json }))
}

/// Refuses a part of other work, by the first field in which it differs.
fn same_work(first: &Part, part: &Part) -> Result<()> {
    let mut fields: Vec<(String, &Value, &Value)> = vec![];
    for name in ["shards", "count"] {
        fields.push((name.into(), &part.json[name], &first.json[name]));
    }
    let objects = [&part.json["work"], &first.json["work"]];
    for name in objects.iter().flat_map(|work| work.as_object().into_iter().flat_map(|work| work.keys())) {
        fields.push((format!("work.{name}"), &objects[0][name], &objects[1][name]));
    }
    let Some((field, found, had)) = fields.into_iter().find(|(_, found, had)| found != had) else {
        return Ok(());
    };
    let expected = format!("{}, as {} has", parsed::short(had), first.folder.display());
    let remedy = "Merge parts of one run alone: the same run, options and number of shards.";
    let (file, found) = (part.folder.join(FILE).display().to_string(), parsed::short(found));
    Err(Error::input(Input { file, field, found, expected, remedy }))
}

/// Refuses a second copy of a part that isn't the same, but for seconds.
fn same_part(first: &Part, part: &Part) -> Result<()> {
    let timeless = |part: &Part| {
        let mut pieces = part.json["pieces"].clone();
        for piece in pieces.as_object_mut().into_iter().flat_map(|pieces| pieces.values_mut()) {
            piece.as_object_mut().map(|piece| piece.shift_remove("seconds"));
        }
        pieces
    };
    let pieces = |part: &Part| -> Vec<String> {
        part.json["pieces"].as_object().into_iter().flat_map(|pieces| pieces.keys().cloned()).collect()
    };
    let mut differs = timeless(first) != timeless(part);
    for number in pieces(part).iter().filter_map(|number| number.parse().ok()) {
        let [one, other] = [first, part].map(|part| picture_of(&part.folder, number));
        differs |= one.exists() != other.exists();
        differs = differs || (one.exists() && std::fs::read(&one).ok() != std::fs::read(&other).ok());
    }
    if !differs {
        return Ok(());
    }
    let (file, field) = (part.folder.display().to_string(), format!("part {}", part.json["shard"]));
    let found = "other results than those of the same part before";
    let expected = format!("those of {}", first.folder.display());
    let remedy = "Keep the right one: results don't depend on the number of threads, but may on the kind of processor.";
    Err(Error::input(Input { file, field, found, expected, remedy }))
}
