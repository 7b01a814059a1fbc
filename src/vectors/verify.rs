//! Vectors that somebody keeps: whether they are whole, and whether this version of the library would write them.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use super::index::{Case, INDEX, Index, SCHEMA};
use super::release::Release;
use super::sums;
use crate::convention::profiles;
use crate::error::{Error, Input, Result};
use crate::files::layout::{Layout, Store};
use crate::files::npz::Array;
use crate::files::{self, raw};
use crate::parallel;

/// What was found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Verified {
    /// Files with their sums.
    pub files: usize,
    /// Cases, valid and invalid.
    pub cases: usize,
    /// The version that wrote them.
    pub version: String,
    /// What differs, a line each; empty where they are whole and today's.
    pub differences: Vec<String>,
}

/// Compares every file with its sum and, where all of them are whole, every case with what this library gives today.
///
/// # Errors
/// A folder without sums or index, or with some that aren't vectors' of this schema.
pub fn verify(folder: &Path) -> Result<Verified> {
    let (listed, there) = (sums::read(folder)?, sums::of(folder)?);
    let differences = damaged(&listed, &there);
    if !differences.is_empty() {
        return Ok(Verified { files: there.len(), cases: 0, version: String::new(), differences });
    }
    let index = read_index(folder)?;
    let layout: Layout = index.layout.parse().map_err(|_| wrong(folder, "layout", &index.layout))?;
    let profile = profiles::find(&index.profile).map_err(|_| wrong(folder, "profile", &index.profile))?;
    let today =
        Release::new(&index.filter, profile, layout).map_err(|_| wrong(folder, "filter", &index.filter))?;
    let mut differences = of_index(&index, &today.index);
    let places: Vec<_> = today.arrays.iter().collect();
    // Where a case is new, its file is missing: the index has said so.
    let kept = |place: &str| listed.contains_key(&layout.file(place));
    let found = parallel::map(places.len(), |n| {
        let (place, arrays) = places[n];
        if kept(place) { of_arrays(layout, folder, place, arrays) } else { Ok(vec![]) }
    });
    for lines in found {
        differences.extend(lines?);
    }
    Ok(Verified { files: there.len(), cases: index.cases.len(), version: index.version, differences })
}

/// Files that aren't those that the sums were taken of.
fn damaged(listed: &BTreeMap<String, String>, there: &BTreeMap<String, String>) -> Vec<String> {
    let names: BTreeSet<&String> = listed.keys().chain(there.keys()).collect();
    let says = |name: &&String| match (listed.get(*name), there.get(*name)) {
        (Some(_), None) => Some(format!("{name}: listed in {}, and not there", sums::SUMS)),
        (None, Some(_)) => Some(format!("{name}: not listed in {}", sums::SUMS)),
        (listed, there) if listed != there => {
            Some(format!("{name}: not the bytes that its sum was taken of"))
        }
        _ => None,
    };
    names.iter().filter_map(says).collect()
}

/// That the index isn't one of today's.
fn wrong(folder: &Path, field: &str, found: &str) -> Error {
    let file = folder.join(INDEX);
    let expected = format!("{SCHEMA} as this version of the library knows it");
    let remedy = "Take the vectors from where they were published, or write them again.";
    Error::input(Input { file: file.display(), field, found, expected, remedy })
}

fn read_index(folder: &Path) -> Result<Index> {
    let index: Index = serde_json::from_str(&files::read_text(&folder.join(INDEX))?)
        .map_err(|error| wrong(folder, "JSON", &error.to_string()))?;
    if index.schema == SCHEMA { Ok(index) } else { Err(wrong(folder, "schema", &index.schema)) }
}

/// What the index says otherwise than today's.
fn of_index(kept: &Index, today: &Index) -> Vec<String> {
    let by_id = |index: &Index| -> BTreeMap<String, Case> {
        index.cases.iter().map(|case| (case.id.clone(), case.clone())).collect()
    };
    let (old, new) = (by_id(kept), by_id(today));
    let ids: BTreeSet<&String> = old.keys().chain(new.keys()).collect();
    let case = |id: &&String| match (old.get(*id), new.get(*id)) {
        (Some(_), None) => Some(format!("{id}: today there is no such case")),
        (None, Some(_)) => Some(format!("{id}: new since")),
        (old, new) if old != new => Some(format!("{id}: described otherwise today")),
        _ => None,
    };
    let mut differences: Vec<String> = ids.iter().filter_map(case).collect();
    for (what, same) in [
        ("rows", kept.rows == today.rows),
        ("flags", kept.flags == today.flags),
        ("left_out", kept.left_out == today.left_out),
        ("accept", kept.accept == today.accept),
    ] {
        differences.extend((!same).then(|| format!("{INDEX}: {what}: described otherwise today")));
    }
    differences
}

/// Arrays of a case that have other bits today.
fn of_arrays(
    layout: Layout,
    folder: &Path,
    place: &str,
    today: &BTreeMap<String, Array>,
) -> Result<Vec<String>> {
    let file = layout.file(place);
    let mut store = Store::open(layout, folder, place)?;
    let names: BTreeSet<String> = store.names().into_iter().collect();
    let mut differences = vec![];
    for name in names.iter().chain(today.keys().filter(|name| !names.contains(*name))) {
        let says = match (names.contains(name), today.get(name)) {
            (true, Some(today)) => difference(&store.array(name)?, today),
            (true, None) => Some("today there is no such array".into()),
            _ => Some("new since".into()),
        };
        differences.extend(says.map(|says| format!("{file}: {name}: {says}")));
    }
    Ok(differences)
}

/// The first element that differs, and how many do.
fn difference(kept: &Array, today: &Array) -> Option<String> {
    if (kept.shape(), kept.dtype()) != (today.shape(), today.dtype()) {
        let [kept, today] = [kept, today].map(|array| format!("{} {:?}", array.dtype(), array.shape()));
        return Some(format!("{kept}, today {today}"));
    }
    if raw::encoded(kept) == raw::encoded(today) {
        return None;
    }
    let (kept, today) = (kept.to_f64(), today.to_f64());
    let off: Vec<_> =
        kept.indexed_iter().zip(&today).filter(|((_, a), b)| a.to_bits() != b.to_bits()).collect();
    let ((index, was), now) = off.first()?;
    let at = ndarray::Dimension::slice(index);
    let more = if off.len() > 1 { format!(", and {} more", off.len() - 1) } else { String::new() };
    Some(format!("{at:?} is {was:e}, today {now:e}{more}"))
}
