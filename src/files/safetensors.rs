//! Weights as `.safetensors`: a header of JSON, then the numbers of all arrays.

use std::path::Path;

use ::safetensors::{Dtype, SafeTensors};
use half::{bf16, f16};
use ndarray::{ArrayD, IxDyn};

use super::npz::{Array, Arrays};
use crate::error::{Error, Input, Result};
use crate::files;
use crate::limits::{self, WEIGHTS};

/// All arrays of floats in a file, bf16 as f32; and the names of those of other types.
///
/// # Errors
/// Where it can't be read, or isn't a whole file of this kind.
pub fn read(path: &Path) -> Result<(Arrays, Vec<String>)> {
    let bytes = files::read(path, WEIGHTS)?;
    limits::fits(path.display(), 2.0 * bytes.len() as f64, "Import fewer arrays at once.")?;
    let tensors = SafeTensors::deserialize(&bytes).map_err(|error| {
        let (expected, remedy) = ("a whole .safetensors file", "Fetch the file again if it was cut short.");
        Error::input(Input { file: path.display(), field: "header", found: error, expected, remedy })
    })?;
    let (mut arrays, mut others) = (Arrays::new(), vec![]);
    for (name, tensor) in tensors.tensors() {
        let (shape, data) = (IxDyn(tensor.shape()), tensor.data());
        let array = match tensor.dtype() {
            Dtype::F64 => Array::F64(array(shape, data, f64::from_le_bytes)),
            Dtype::F32 => Array::F32(array(shape, data, f32::from_le_bytes)),
            Dtype::F16 => Array::F16(array(shape, data, f16::from_le_bytes)),
            Dtype::BF16 => Array::F32(array(shape, data, |bytes| bf16::from_le_bytes(bytes).to_f32())),
            _ => {
                others.push(name);
                continue;
            }
        };
        arrays.insert(name, array);
    }
    Ok((arrays, others))
}

/// Numbers of `N` bytes each; the reader has checked that there are as many as the shape says.
fn array<const N: usize, T>(shape: IxDyn, data: &[u8], number: impl Fn([u8; N]) -> T) -> ArrayD<T> {
    let numbers = data.as_chunks::<N>().0.iter().map(|bytes| number(*bytes)).collect();
    ArrayD::from_shape_vec(shape, numbers).expect("as many numbers as the shape says")
}
