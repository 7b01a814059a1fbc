//! `SHA256SUMS`: a line for each file, as `sha256sum` writes and checks them.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use sha2::{Digest, Sha256};

use crate::error::{Error, Input, Result};
use crate::files;
use crate::limits::ARRAY;

/// Its name.
pub(super) const SUMS: &str = "SHA256SUMS";

/// Folders in one another: component, case.
const DEEPEST: usize = 4;

/// Writes the sums of everything in a folder. Returns the bytes written.
pub(super) fn write(folder: &Path) -> Result<u64> {
    let lines: String = of(folder)?.iter().map(|(name, sum)| format!("{sum}  {name}\n")).collect();
    files::write(&folder.join(SUMS), &lines)?;
    Ok(lines.len() as u64)
}

/// The sums that the file lists, by name.
pub(super) fn read(folder: &Path) -> Result<BTreeMap<String, String>> {
    let path = folder.join(SUMS);
    let mut sums = BTreeMap::new();
    for (n, line) in files::read_text(&path)?.lines().enumerate() {
        let sum = line
            .split_once("  ")
            .filter(|(sum, _)| sum.len() == 64 && sum.bytes().all(|b| b.is_ascii_hexdigit()));
        let new = sum.map(|(sum, name)| sums.insert(name.to_string(), sum.to_string()).is_none());
        if new != Some(true) {
            return Err(Error::input(Input {
                file: path.display(),
                field: format!("line {}", n + 1),
                found: line,
                expected: "64 hexadecimal digits, two spaces and a file's name, each once",
                remedy: "Take the file from where the vectors were published.",
            }));
        }
    }
    Ok(sums)
}

/// The sums of the files below a folder, by their names with `/` between, but for [`SUMS`] itself. What is no file has a sum that none has.
pub(super) fn of(folder: &Path) -> Result<BTreeMap<String, String>> {
    let mut sums = BTreeMap::new();
    gather(folder, "", DEEPEST, &mut sums)?;
    sums.remove(SUMS);
    Ok(sums)
}

fn gather(folder: &Path, below: &str, deepest: usize, sums: &mut BTreeMap<String, String>) -> Result<()> {
    for entry in fs::read_dir(folder).map_err(Error::reading(folder))? {
        let entry = entry.map_err(Error::reading(folder))?;
        let name = format!("{below}{}", entry.file_name().to_string_lossy());
        let kind = entry.file_type().map_err(Error::reading(folder))?;
        if kind.is_dir() && deepest > 0 {
            gather(&entry.path(), &format!("{name}/"), deepest - 1, sums)?;
        } else if kind.is_file() {
            let sum = Sha256::digest(files::read(&entry.path(), ARRAY)?);
            sums.insert(name, sum.iter().map(|byte| format!("{byte:02x}")).collect());
        } else {
            sums.insert(name, "no file".into());
        }
    }
    Ok(())
}
