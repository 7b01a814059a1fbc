//! Arrays without a container, for programs that have no reader of archives: a folder with a file of bare numbers for each array, and an
//! index of them that C reads with fscanf.
//!
//! A line of the index is `name dtype ndim sizes file`, as in `rgbs f32 3 1 4 3 rgbs.bin`; a scalar has no sizes. The numbers are
//! little-endian, rows first; a dtype is f64, f32, f16, u8 or i64.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use half::f16;
use ndarray::{ArrayD, IxDyn};

use super::npz::{Array, Arrays};
use crate::error::{Error, Input, Result};
use crate::files;
use crate::limits::ARRAY;

/// The name of the index in each folder.
pub const INDEX: &str = "index.txt";

/// An index longer than this isn't one of ours.
const LONGEST: u64 = 1 << 20;

/// Dimensions that an array has at most: NumPy's own limit was 32 for a long time.
const MOST_DIMENSIONS: usize = 32;

/// Writes the arrays, and then the index: a folder that has one is whole. Returns the bytes written.
///
/// # Errors
/// Where a file can't be written.
///
/// # Panics
/// Where an array's name has a space or a path in it.
pub fn write(folder: &Path, arrays: &Arrays) -> Result<u64> {
    let (mut index, mut bytes) = (String::new(), 0);
    for (name, array) in arrays {
        assert!(plain(name) && !name.contains(char::is_whitespace), "{name}: no name for a file");
        let numbers = encoded(array);
        let sizes: String = array.shape().iter().map(|n| format!(" {n}")).collect();
        index += &format!("{name} {} {}{sizes} {name}.bin\n", array.dtype(), array.shape().len());
        bytes += numbers.len() as u64;
        files::write(&folder.join(format!("{name}.bin")), numbers)?;
    }
    files::write(&folder.join(INDEX), &index)?;
    Ok(bytes + index.len() as u64)
}

/// The numbers of an array as the file has them.
pub fn encoded(array: &Array) -> Vec<u8> {
    match array {
        Array::F64(a) => a.iter().flat_map(|x| x.to_le_bytes()).collect(),
        Array::F32(a) => a.iter().flat_map(|x| x.to_le_bytes()).collect(),
        Array::F16(a) => a.iter().flat_map(|x| x.to_le_bytes()).collect(),
        Array::U8(a) => a.iter().copied().collect(),
        Array::I64(a) => a.iter().flat_map(|x| x.to_le_bytes()).collect(),
    }
}

/// A folder whose index has been read, and found to fit its files. Arrays are read on demand.
#[derive(Debug)]
pub struct Raw {
    index: PathBuf,
    lines: BTreeMap<String, Line>,
}

/// A line of the index.
#[derive(Debug)]
struct Line {
    dtype: String,
    shape: Vec<usize>,
    file: PathBuf,
    bytes: u64,
}

impl Raw {
    /// Reads a folder's index, and compares each file's size with it.
    ///
    /// # Errors
    /// A line that isn't as above, a name that is there twice, a file of another size, and whatever else lies in the folder.
    pub fn open(folder: &Path) -> Result<Raw> {
        let path = folder.join(INDEX);
        let text = String::from_utf8_lossy(&files::read(&path, LONGEST)?).into_owned();
        let mut raw = Raw { index: path, lines: BTreeMap::new() };
        for (n, text) in text.lines().enumerate() {
            let Some((name, line)) = line(folder, text) else {
                return raw.wrong(&format!("line {}", n + 1), text, "name dtype ndim sizes file, each once");
            };
            let size = fs::symlink_metadata(&line.file).map_err(Error::reading(&line.file))?;
            if !size.is_file() || size.len() != line.bytes {
                let found = format!("{} bytes in {}", size.len(), line.file.display());
                return raw.wrong(
                    &format!("array {name}"),
                    &found,
                    &format!("a file of {} bytes", line.bytes),
                );
            }
            if raw.lines.insert(name.clone(), line).is_some() {
                return raw.wrong(&format!("line {}", n + 1), &name, "each name once");
            }
        }
        raw.nothing_else(folder)?;
        Ok(raw)
    }

    /// The names of the arrays.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.lines.keys().map(String::as_str)
    }

    /// Bytes of all files.
    pub fn bytes(&self) -> u64 {
        self.lines.values().map(|line| line.bytes).sum()
    }

    /// Reads one array.
    ///
    /// # Errors
    /// Where there is none of this name, or its file can't be read.
    pub fn array(&self, name: &str) -> Result<Array> {
        let Some(line) = self.lines.get(name) else {
            let there = self.names().collect::<Vec<_>>().join(", ");
            return self.wrong(name, &format!("only [{there}]"), "an array of this name");
        };
        let bytes = files::read(&line.file, line.bytes)?;
        match decoded(&line.dtype, &line.shape, &bytes) {
            Some(array) => Ok(array),
            // It was shortened since.
            None => self.wrong(name, &format!("{} bytes", bytes.len()), &format!("{} bytes", line.bytes)),
        }
    }

    fn nothing_else(&self, folder: &Path) -> Result<()> {
        let listed = |path: &Path| *path == self.index || self.lines.values().any(|line| line.file == path);
        for entry in fs::read_dir(folder).map_err(Error::reading(folder))? {
            let path = entry.map_err(Error::reading(folder))?.path();
            if !listed(&path) {
                return self.wrong("files", &path.display().to_string(), "only files that it lists");
            }
        }
        Ok(())
    }

    fn wrong<T>(&self, field: &str, found: &str, expected: &str) -> Result<T> {
        let remedy = "Write the folder again: numbers little-endian, rows first, a line for each file.";
        Err(Error::input(Input { file: self.index.display(), field, found, expected, remedy }))
    }
}

/// Whether a name is that of something directly in its folder.
fn plain(name: &str) -> bool {
    !name.is_empty() && name != "." && name != ".." && !name.contains(['/', '\\', ':', '\0'])
}

/// The name of an array, and the rest of its line.
fn line(folder: &Path, text: &str) -> Option<(String, Line)> {
    let words: Vec<&str> = text.split_ascii_whitespace().collect();
    let [name, dtype, ndim, sizes @ .., file] = &words[..] else { return None };
    let item = match *dtype {
        "f64" | "i64" => 8,
        "f32" => 4,
        "f16" => 2,
        "u8" => 1,
        _ => return None,
    };
    let shape = sizes.iter().map(|size| size.parse().ok()).collect::<Option<Vec<usize>>>()?;
    let fits =
        ndim.parse() == Ok(shape.len()) && shape.len() <= MOST_DIMENSIONS && plain(file) && *file != INDEX;
    let bytes = shape.iter().try_fold(item, |bytes: u64, &n| bytes.checked_mul(n as u64))?;
    let line = Line { dtype: dtype.to_string(), shape, file: folder.join(file), bytes };
    (fits && bytes <= ARRAY).then(|| (name.to_string(), line))
}

/// Bytes to elements.
fn decoded(dtype: &str, shape: &[usize], bytes: &[u8]) -> Option<Array> {
    fn array<T, const N: usize>(shape: &[usize], bytes: &[u8], read: fn([u8; N]) -> T) -> Option<ArrayD<T>> {
        let (items, _) = bytes.as_chunks::<N>();
        ArrayD::from_shape_vec(IxDyn(shape), items.iter().map(|&item| read(item)).collect()).ok()
    }
    Some(match dtype {
        "f64" => Array::F64(array(shape, bytes, f64::from_le_bytes)?),
        "f32" => Array::F32(array(shape, bytes, f32::from_le_bytes)?),
        "f16" => Array::F16(array(shape, bytes, f16::from_le_bytes)?),
        "i64" => Array::I64(array(shape, bytes, i64::from_le_bytes)?),
        "u8" => Array::U8(array(shape, bytes, |[byte]| byte)?),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use ndarray::{arr0, arr1, arr2};

    use super::*;

    fn arrays() -> Arrays {
        let arrays: [(&str, Array); 6] = [
            ("deep", ArrayD::<f32>::zeros(IxDyn(&[2, 0, 3])).into()),
            ("half", arr1(&[f16::from_f32(0.5), f16::NAN]).into()),
            ("many", arr2(&[[1.0, -0.0, f64::NAN], [f64::INFINITY, 5e-324, 0.1]]).into()),
            ("one", arr0(7i64).into()),
            ("small", arr2(&[[0.1f32], [-3.0]]).into()),
            ("white", arr1(&[0u8, 255]).into()),
        ];
        arrays.into_iter().map(|(name, array)| (name.to_string(), array)).collect()
    }

    #[test]
    fn what_is_written_is_read_bit_by_bit() {
        let folder = tempfile::tempdir().unwrap();
        let bytes = write(folder.path(), &arrays()).unwrap();
        let index = fs::read_to_string(folder.path().join(INDEX)).unwrap();
        assert!(
            index.contains("deep f32 3 2 0 3 deep.bin\n") && index.contains("one i64 0 one.bin\n"),
            "{index}"
        );
        assert_eq!(fs::read(folder.path().join("small.bin")).unwrap(), [205, 204, 204, 61, 0, 0, 64, 192]);
        let raw = Raw::open(folder.path()).unwrap();
        assert_eq!((raw.bytes() + index.len() as u64, raw.names().count()), (bytes, 6));
        for (name, array) in arrays() {
            let read = raw.array(&name).unwrap();
            assert_eq!((read.shape(), read.dtype()), (array.shape(), array.dtype()));
            assert_eq!(encoded(&read), encoded(&array), "{name}");
        }
        assert!(raw.array("other").unwrap_err().to_string().contains("only [deep, half"));
    }

    #[test]
    fn whatever_does_not_fit_is_refused() {
        let root = tempfile::tempdir().unwrap();
        let folder = root.path().join("case");
        write(&folder, &arrays()).unwrap();
        fs::write(root.path().join("outside.bin"), [0; 8]).unwrap();
        let whole = fs::read_to_string(folder.join(INDEX)).unwrap();
        let refused = |index: &str, word: &str| {
            fs::write(folder.join(INDEX), index).unwrap();
            let message = Raw::open(&folder).map(|_| ()).expect_err(index).to_string();
            assert!(message.contains("index.txt") && message.contains(word), "{message}");
        };
        let with = |line: &str| format!("{whole}{line}\n");
        refused(&with("one i64 0 one.bin"), "each name once");
        for line in [
            "x",
            "x f64 0",
            "x f64 1 one.bin",
            "x f64 2 1 one.bin",
            "x f64 1 -1 one.bin",
            "x f80 0 one.bin",
            "x f64 0 ../outside.bin",
            "x f64 0 ..",
            "x f64 0 index.txt",
            "x f64 3 4294967296 4294967296 4294967296 one.bin",
            "x u8 2 1048576 1048576 one.bin",
            "",
        ] {
            refused(&with(line), "line 7");
        }
        refused(&with("x f64 1 2 one.bin"), "expected a file of 16 bytes");
        refused(&whole.replace("one i64 0 one.bin\n", ""), "only files that it lists");
        fs::write(folder.join(INDEX), with("x f64 0 gone.bin")).unwrap();
        assert!(Raw::open(&folder).unwrap_err().to_string().contains("gone.bin"));
        fs::write(folder.join(INDEX), &whole).unwrap();
        fs::write(folder.join("one.bin"), [0; 7]).unwrap();
        assert!(Raw::open(&folder).unwrap_err().to_string().contains("7 bytes in"));
        fs::remove_file(folder.join("one.bin")).unwrap();
        fs::create_dir(folder.join("one.bin")).unwrap();
        assert!(Raw::open(&folder).is_err());
    }
}
