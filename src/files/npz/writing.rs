//! Writing archives as NumPy's `savez` does (`savez_compressed` where they are deflated), to a temporary file that is then renamed.
//!
//! The same arrays give the same bytes: entries have the zip format's earliest date.

use std::io::{self, BufWriter, Cursor, Seek, Write};
use std::path::Path;

use ndarray::ArrayD;
use npyz::WriterBuilder;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use super::{Array, Arrays};
use crate::error::{Error, Result};
use crate::files;

/// Writes all arrays, each entry with its size before it, for readers that go from the front to the end.
///
/// # Errors
/// Where the file can't be written.
pub fn write(path: &Path, arrays: &Arrays, compress: bool) -> Result<()> {
    let archive = || {
        // In memory, since sizes are written last; with room for all, so that it isn't copied as it grows.
        let room = if compress { 0 } else { arrays.values().map(|array| array.bytes() + 1024).sum() };
        let mut zip = ZipWriter::new(Cursor::new(Vec::with_capacity(room)));
        arrays.iter().try_for_each(|(name, array)| add(&mut zip, name, array, compress))?;
        Ok(zip.finish()?.into_inner())
    };
    files::write(path, archive().map_err(Error::writing(path))?)
}

/// Writes arrays as they come, so that never all of them are in memory, stored, each entry with its size behind it.
///
/// # Errors
/// Where the file can't be written.
pub fn write_each(path: &Path, arrays: impl IntoIterator<Item = (String, Array)>) -> Result<()> {
    files::write_with(path, |file| {
        let mut zip = ZipWriter::new_stream(Patient { file, error: None });
        arrays.into_iter().try_for_each(|(name, array)| add(&mut zip, &name, &array, false))?;
        zip.finish()?.into_inner().error.map_or(Ok(()), Err)
    })
}

/// Takes everything, and keeps the first error for the end: a zip's writer that meets one may panic as it is dropped.
struct Patient<W> {
    file: W,
    error: Option<io::Error>,
}

impl<W: Write> Write for Patient<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.error.is_none() {
            self.error = self.file.write_all(bytes).err();
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// One array's entry.
fn add<W: Write + Seek>(zip: &mut ZipWriter<W>, name: &str, array: &Array, compress: bool) -> io::Result<()> {
    let method = if compress { CompressionMethod::Deflated } else { CompressionMethod::Stored };
    let options = SimpleFileOptions::default()
        .compression_method(method)
        .last_modified_time(DateTime::DEFAULT)
        .large_file(array.bytes() > (u32::MAX / 2) as usize);
    zip.start_file(format!("{name}.npy"), options)?;
    match array {
        Array::F64(a) => write_npy(zip, a),
        Array::F32(a) => write_npy(zip, a),
        Array::F16(a) => write_npy(zip, a),
        Array::U8(a) => write_npy(zip, a),
        Array::I64(a) => write_npy(zip, a),
    }
}

/// One array in C order.
fn write_npy<T: npyz::AutoSerialize + Copy>(out: &mut impl Write, array: &ArrayD<T>) -> io::Result<()> {
    let shape: Vec<u64> = array.shape().iter().map(|&n| n as u64).collect();
    // Element by element is how npyz writes: through a buffer, otherwise every 8 bytes are a call into the zip.
    let mut out = BufWriter::new(out);
    let mut writer = npyz::WriteOptions::new().default_dtype().shape(&shape).writer(&mut out).begin_nd()?;
    writer.extend(array.iter().copied())?;
    writer.finish()?;
    out.flush()
}
