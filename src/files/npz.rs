//! NumPy archives: a zip of `.npy` files, each array by its name.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufReader, Cursor, Read};
use std::path::{Path, PathBuf};

use half::f16;
use ndarray::{ArrayD, Dimension, IxDyn};
use npyz::{DType, NpyFile, NpyHeader, Order, TypeChar, WriterBuilder};
use zip::ZipArchive;

use crate::error::{Error, Input, Result};
use crate::files;
use crate::limits::{self, ARRAY};

/// Bytes that a deflated byte can unpack to, and a little for an empty array's header.
const DEFLATE: u64 = 1032;

/// Longest header that is parsed; NumPy itself stops at 10,000 characters.
const LONGEST_HEADER: usize = 16_384;

/// Brackets in one another in a header: NumPy's have three, around a field of a record's shape.
const DEEPEST: usize = 6;

/// An array of any shape in one of the types that cross a file boundary.
#[derive(Clone, Debug, PartialEq)]
pub enum Array {
    /// 64-bit floats.
    F64(ArrayD<f64>),
    /// 32-bit floats.
    F32(ArrayD<f32>),
    /// 16-bit floats.
    F16(ArrayD<f16>),
    /// Bytes; truth values are read as 0 and 1.
    U8(ArrayD<u8>),
    /// 64-bit integers; every other signed or unsigned integer is read as these.
    I64(ArrayD<i64>),
}

/// Arrays by name, in the names' order.
pub type Arrays = BTreeMap<String, Array>;

impl Array {
    /// The shape, outermost first; empty for a scalar.
    pub fn shape(&self) -> &[usize] {
        match self {
            Array::F64(a) => a.shape(),
            Array::F32(a) => a.shape(),
            Array::F16(a) => a.shape(),
            Array::U8(a) => a.shape(),
            Array::I64(a) => a.shape(),
        }
    }

    /// The element type's usual name: `f64`, `f32`, `f16`, `u8`, `i64`.
    pub fn dtype(&self) -> &'static str {
        match self {
            Array::F64(_) => "f64",
            Array::F32(_) => "f32",
            Array::F16(_) => "f16",
            Array::U8(_) => "u8",
            Array::I64(_) => "i64",
        }
    }

    /// Every element as f64 (exact, but for integers beyond 2^53).
    pub fn to_f64(&self) -> ArrayD<f64> {
        match self {
            Array::F64(a) => a.clone(),
            Array::F32(a) => a.mapv(f64::from),
            Array::F16(a) => a.mapv(f64::from),
            Array::U8(a) => a.mapv(f64::from),
            Array::I64(a) => a.mapv(|x| x as f64),
        }
    }
}

/// From an ndarray of any dimension.
macro_rules! from_ndarray {
    ($($element:ty => $variant:ident),*) => {$(
        impl<D: Dimension> From<ndarray::Array<$element, D>> for Array {
            fn from(array: ndarray::Array<$element, D>) -> Self {
                Array::$variant(array.into_dyn())
            }
        }
    )*};
}
from_ndarray!(f64 => F64, f32 => F32, f16 => F16, u8 => U8, i64 => I64);

/// An open archive. Arrays are read on demand, so that one of an unknown type does no harm unless it is needed.
#[derive(Debug)]
pub struct Npz {
    path: PathBuf,
    archive: ZipArchive<BufReader<File>>,
    names: BTreeMap<String, usize>,
}

impl Npz {
    /// Opens an archive and lists its arrays.
    ///
    /// # Errors
    /// Where the file can't be read, or isn't a whole zip.
    pub fn open(path: &Path) -> Result<Npz> {
        let file = files::open(path, u64::MAX)?;
        let mut archive = ZipArchive::new(BufReader::new(file)).map_err(|error| {
            let remedy = "Fetch the file again if it was cut short; numpy.savez writes such archives.";
            Error::input(Input {
                file: path.display(),
                field: "archive",
                found: error,
                expected: "a whole .npz (zip) archive",
                remedy,
            })
        })?;
        let mut names = BTreeMap::new();
        for index in 0..archive.len() {
            let Ok(entry) = archive.by_index_raw(index) else { continue };
            let Ok(name) = entry.name() else { continue };
            if let Some(name) = name.strip_suffix(".npy") {
                names.insert(name.to_string(), index);
            }
        }
        Ok(Npz { path: path.to_path_buf(), archive, names })
    }

    /// The names of the arrays.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.names.keys().map(String::as_str)
    }

    /// What the archive says all of its entries unpack to, in bytes; an entry that unpacks to more is refused when it is read.
    pub fn unpacked_bytes(&mut self) -> u64 {
        let entries = 0..self.archive.len();
        let archive = &mut self.archive;
        let size = |index| archive.by_index_raw(index).map_or(0, |entry| entry.size());
        entries.map(size).fold(0, u64::saturating_add)
    }

    /// Whether there is an array of this name.
    pub fn has(&self, name: &str) -> bool {
        self.names.contains_key(name)
    }

    /// Reads one array.
    ///
    /// # Errors
    /// Where it is missing, cut short, damaged, larger than [`ARRAY`], or of a type that isn't a number's.
    pub fn array(&mut self, name: &str) -> Result<Array> {
        let file = self.path.display().to_string();
        let Some(&index) = self.names.get(name) else {
            let there = self.names().collect::<Vec<_>>().join(", ");
            let remedy = "Check which program wrote the file, and under which names.";
            return Err(Error::input(Input {
                file,
                field: name,
                found: format!("only [{there}]"),
                expected: "an array of this name",
                remedy,
            }));
        };
        self.read(index).map_err(|(found, expected)| {
            let remedy = "Write the array again, as plain numbers, with numpy.savez.";
            Error::input(Input { file, field: format!("array {name}"), found, expected, remedy })
        })
    }

    /// The entry's bytes, checked against what its header declares before they are read.
    fn read(&mut self, index: usize) -> Result<Array, (String, String)> {
        let whole = |error: &dyn std::fmt::Display| (error.to_string(), "a whole .npy entry".to_string());
        let mut entry = self.archive.by_index(index).map_err(|error| whole(&error))?;
        let header = NpyHeader::from_reader(&read_header(&mut entry)?[..]).map_err(|error| whole(&error))?;
        if header.uses_pickled_array() {
            return Err(("Python objects".into(), "an array of numbers".into()));
        }
        let (declared, held) = sizes(&header);
        if held > ARRAY {
            let found = format!("{held} bytes in memory for {:?}", header.shape());
            return Err((found, format!("at most {ARRAY} bytes")));
        }
        // No archive can unpack to more than this: such a shape is false, and not worth the memory to find out.
        let packed = entry.compressed_size();
        if declared > packed.saturating_mul(DEFLATE) {
            return Err((
                format!("{packed} packed bytes for {:?}", header.shape()),
                format!("{declared} bytes"),
            ));
        }
        // The file's bytes, and the elements made of them.
        limits::short_of((declared + held) as f64).map_or(Ok(()), Err)?;
        // One byte more is read: it detects an entry that is too long, and makes the reader compare the archive's checksum.
        let mut data = Vec::with_capacity(declared as usize + 1);
        entry.take(declared + 1).read_to_end(&mut data).map_err(|error| whole(&error))?;
        if data.len() as u64 != declared {
            let more = if data.len() as u64 > declared { "more than " } else { "" };
            let found = data.len().min(declared as usize);
            return Err((
                format!("{more}{found} bytes for {:?}", header.shape()),
                format!("{declared} bytes"),
            ));
        }
        decode(header, &data)
    }
}

/// Reads an `.npy`: one array that is a file of its own.
///
/// # Errors
/// Where it is no whole array of numbers, or larger than [`ARRAY`].
pub fn read_npy(path: &Path) -> Result<Array> {
    let bytes = files::read(path, ARRAY)?;
    let read = || {
        let whole = |error: &dyn std::fmt::Display| (error.to_string(), "a whole .npy file".to_string());
        let mut data = &bytes[..];
        let header = NpyHeader::from_reader(&read_header(&mut data)?[..]).map_err(|error| whole(&error))?;
        if header.uses_pickled_array() {
            return Err(("Python objects".into(), "an array of numbers".into()));
        }
        let (declared, _) = sizes(&header);
        if data.len() as u64 != declared {
            let found = format!("{} bytes for {:?}", data.len(), header.shape());
            return Err((found, format!("{declared} bytes")));
        }
        decode(header, data)
    };
    read().map_err(|(found, expected)| {
        let remedy = "Write the array again, as plain numbers, with numpy.save.";
        Error::input(Input { file: path.display(), field: "array", found, expected, remedy })
    })
}

/// Bytes of an array in the file, and in memory, where integers take eight.
fn sizes(header: &NpyHeader) -> (u64, u64) {
    let dtype = header.dtype();
    let item = dtype.num_bytes().map_or(u64::MAX, |bytes| bytes as u64);
    let held = match &dtype {
        DType::Plain(plain) if plain.type_char() == TypeChar::Int => 8,
        DType::Plain(plain) if plain.type_char() == TypeChar::Uint && item > 1 => 8,
        _ => item,
    };
    (header.len().saturating_mul(item), header.len().saturating_mul(held))
}

/// Reads every array of an archive.
///
/// # Errors
/// As [`Npz::open`] and [`Npz::array`].
pub fn read(path: &Path) -> Result<Arrays> {
    let mut npz = Npz::open(path)?;
    limits::fits(
        path.display(),
        2.0 * npz.unpacked_bytes() as f64,
        "Check that it is the file that was meant.",
    )?;
    let names: Vec<String> = npz.names().map(String::from).collect();
    names.into_iter().map(|name| npz.array(&name).map(|array| (name, array))).collect()
}

/// The raw header, rejected if parsing it could be expensive: too long, nested too deep (the parser
/// recurses), or with numbers whose product overflows (the parser multiplies them).
fn read_header(entry: &mut impl Read) -> Result<Vec<u8>, (String, String)> {
    let short = |error: std::io::Error| (error.to_string(), "a whole .npy header".to_string());
    let refused = |found: &str| Err((found.to_string(), "a .npy header as NumPy writes it".to_string()));
    let mut text = vec![0; 10];
    entry.read_exact(&mut text).map_err(short)?;
    let mut length = usize::from(u16::from_le_bytes([text[8], text[9]]));
    if text[6] > 1 {
        let mut rest = [0; 2];
        entry.read_exact(&mut rest).map_err(short)?;
        length += usize::from(u16::from_le_bytes(rest)) << 16;
        text.extend(rest);
    }
    if &text[..6] != b"\x93NUMPY" {
        return refused("no NumPy signature");
    }
    if length > LONGEST_HEADER {
        return refused(&format!("{length} characters"));
    }
    let start = text.len();
    text.resize(start + length, 0);
    entry.read_exact(&mut text[start..]).map_err(short)?;
    let body = String::from_utf8_lossy(&text[start..]);
    // Each bracket that isn't closed doubles the parser's time.
    let depth = body.chars().scan(0usize, |depth, c| {
        *depth = (*depth + usize::from("([{".contains(c))).saturating_sub(usize::from(")]}".contains(c)));
        Some(*depth)
    });
    if depth.max().unwrap_or(0) > DEEPEST {
        return refused("brackets nested too deep");
    }
    let numbers = body.split(|c: char| !c.is_ascii_digit()).filter(|digits| !digits.is_empty());
    let product = numbers.map(|digits| digits.parse::<u64>().ok()).try_fold(1u64, |product, number| {
        product.checked_mul(number?.max(1)).filter(|&product| product < 1 << 62)
    });
    if product.is_none() {
        return refused("a shape of more elements than any memory holds");
    }
    Ok(text)
}

/// Bytes to elements, by the header's type, in C order.
fn decode(header: NpyHeader, data: &[u8]) -> Result<Array, (String, String)> {
    let foreign =
        |descr: String| (format!("element type {descr}"), "floats, integers or truth values".into());
    let dtype = header.dtype();
    let DType::Plain(ref plain) = dtype else { return Err(foreign(dtype.descr())) };
    Ok(match (plain.type_char(), plain.num_bytes()) {
        (TypeChar::Float, Some(8)) => Array::F64(elements(header, data)?),
        (TypeChar::Float, Some(4)) => Array::F32(elements(header, data)?),
        (TypeChar::Float, Some(2)) => Array::F16(elements(header, data)?),
        (TypeChar::Bool, _) => Array::U8(elements::<bool>(header, data)?.mapv(u8::from)),
        (TypeChar::Uint, Some(1)) => Array::U8(elements(header, data)?),
        (TypeChar::Uint, Some(2)) => Array::I64(elements::<u16>(header, data)?.mapv(i64::from)),
        (TypeChar::Uint, Some(4)) => Array::I64(elements::<u32>(header, data)?.mapv(i64::from)),
        (TypeChar::Uint, Some(8)) => {
            let wide = elements::<u64>(header, data)?;
            if let Some(x) = wide.iter().find(|&&x| x > i64::MAX as u64) {
                return Err((x.to_string(), "integers below 2^63".into()));
            }
            Array::I64(wide.mapv(|x| x as i64))
        }
        (TypeChar::Int, Some(1)) => Array::I64(elements::<i8>(header, data)?.mapv(i64::from)),
        (TypeChar::Int, Some(2)) => Array::I64(elements::<i16>(header, data)?.mapv(i64::from)),
        (TypeChar::Int, Some(4)) => Array::I64(elements::<i32>(header, data)?.mapv(i64::from)),
        (TypeChar::Int, Some(8)) => Array::I64(elements(header, data)?),
        _ => return Err(foreign(dtype.descr())),
    })
}

/// Elements of one type, Fortran order turned to C order.
fn elements<T: npyz::Deserialize + Clone>(
    header: NpyHeader,
    data: &[u8],
) -> Result<ArrayD<T>, (String, String)> {
    let damaged =
        |error: &dyn std::fmt::Display| (error.to_string(), "as many elements as the shape has".into());
    let shape: Vec<usize> = header.shape().iter().map(|&n| n as usize).collect();
    let fortran = header.order() == Order::Fortran;
    let flat = NpyFile::with_header(header, data).into_vec::<T>().map_err(|error| damaged(&error))?;
    if !fortran {
        return ArrayD::from_shape_vec(IxDyn(&shape), flat).map_err(|error| damaged(&error));
    }
    let reversed: Vec<usize> = shape.iter().rev().copied().collect();
    let transposed = ArrayD::from_shape_vec(IxDyn(&reversed), flat).map_err(|error| damaged(&error))?;
    Ok(transposed.reversed_axes().as_standard_layout().into_owned())
}

/// Writes arrays as NumPy's `savez` does (`savez_compressed` where `compress`), to a temporary file that is then renamed.
///
/// The same arrays give the same bytes: entries go in the names' order with the zip format's earliest date.
///
/// # Errors
/// Where the file can't be written.
pub fn write(path: &Path, arrays: &Arrays, compress: bool) -> Result<()> {
    use zip::write::SimpleFileOptions;
    let method = if compress { zip::CompressionMethod::Deflated } else { zip::CompressionMethod::Stored };
    let options = SimpleFileOptions::default()
        .compression_method(method)
        .last_modified_time(zip::DateTime::DEFAULT)
        .large_file(false);
    let archive = || {
        // In memory: dropping a ZipWriter whose file can't be written to may panic. With room for all, so that it isn't copied as it grows.
        let bytes = |array: &Array| 8 * array.shape().iter().product::<usize>() + 1024;
        let room = if compress { 0 } else { arrays.values().map(bytes).sum() };
        let mut zip = zip::ZipWriter::new(Cursor::new(Vec::with_capacity(room)));
        for (name, array) in arrays {
            let large = array.shape().iter().product::<usize>() > (u32::MAX / 16) as usize;
            zip.start_file(format!("{name}.npy"), options.large_file(large))?;
            match array {
                Array::F64(a) => write_npy(&mut zip, a),
                Array::F32(a) => write_npy(&mut zip, a),
                Array::F16(a) => write_npy(&mut zip, a),
                Array::U8(a) => write_npy(&mut zip, a),
                Array::I64(a) => write_npy(&mut zip, a),
            }?;
        }
        Ok(zip.finish()?.into_inner())
    };
    files::write(path, archive().map_err(Error::writing(path))?)
}

/// One array in C order.
fn write_npy<T: npyz::AutoSerialize + Copy>(
    out: &mut impl std::io::Write,
    array: &ArrayD<T>,
) -> std::io::Result<()> {
    let shape: Vec<u64> = array.shape().iter().map(|&n| n as u64).collect();
    // Element by element is how npyz writes: through a buffer, otherwise every 8 bytes are a call into the zip.
    let mut out = std::io::BufWriter::new(out);
    let mut writer = npyz::WriteOptions::new().default_dtype().shape(&shape).writer(&mut out).begin_nd()?;
    writer.extend(array.iter().copied())?;
    writer.finish()?;
    std::io::Write::flush(&mut out)
}
