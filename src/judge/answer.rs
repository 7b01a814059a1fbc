//! Answers: arrays as a candidate gave them, and what can be wrong with them before any number is compared.

use std::collections::BTreeMap;

use ndarray::{ArrayD, IxDyn};

use crate::contract::arithmetic::Dtype;
use crate::contract::arrays::Arrays;
use crate::contract::component::Entries;

/// One array of an answer.
#[derive(Clone, Debug, PartialEq)]
pub struct Given {
    /// The values; every type a candidate may use fits into f64.
    pub values: ArrayD<f64>,
    /// Its type in the file: `f64`, `f32`, `f16`, `u8`, `i64`.
    pub dtype: &'static str,
}

/// Output name -> array, of one case.
pub type Answer = BTreeMap<String, Given>;

/// Answers of one question, case by case; `None` where there is none.
pub type Answers = Vec<Option<Answer>>;

/// f64 arrays (or f32 ones, widened) from a closure as an answer.
pub fn given(arrays: Arrays) -> Answer {
    arrays.into_iter().map(|(name, values)| (name, Given { values, dtype: "f64" })).collect()
}

/// Whether a type can represent all that `dtype` computes. Pixel positions, bytes, bits and counts may be integers too.
pub fn wide_enough(entries: Entries, given: &str, dtype: Dtype) -> bool {
    match given {
        _ if entries.whole() => true,
        "f64" => true,
        "f32" => dtype != Dtype::F64,
        "f16" => dtype == Dtype::F16,
        "i64" => entries == Entries::Pixel,
        _ => false,
    }
}

/// The answer in the expected shape: as it is, with merged axes split (rays of an (H, W) picture as H W rows), or with axes of length 1
/// added or left off. The text says which layout it was.
pub fn reshaped(values: &ArrayD<f64>, expected: &[usize]) -> Option<(ArrayD<f64>, Option<String>)> {
    if values.shape() == expected {
        return Some((values.clone(), None));
    }
    let merged = values.ndim() < expected.len() && merges(values.shape(), expected);
    let array = (merged || long(values.shape()).eq(long(expected))).then(|| {
        let flat: Vec<f64> = values.iter().copied().collect();
        ArrayD::from_shape_vec(IxDyn(expected), flat).expect("as many elements")
    })?;
    let layout = if merged { "flattened to" } else { "with other axes of length 1, as" };
    Some((array, Some(format!("{:?} {layout} {:?}", expected, values.shape()))))
}

/// The axes that are longer than 1.
fn long(shape: &[usize]) -> impl Iterator<Item = &usize> {
    shape.iter().filter(|n| **n != 1)
}

/// Whether `short` comes from `long` by multiplying neighboring axes.
fn merges(short: &[usize], long: &[usize]) -> bool {
    match short.split_first() {
        None => long.is_empty(),
        Some((&first, rest)) => {
            (1..=long.len()).any(|n| long[..n].iter().product::<usize>() == first && merges(rest, &long[n..]))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flattening_merges_neighbors_only() {
        assert!(merges(&[20, 3], &[4, 5, 3]) && merges(&[60], &[4, 5, 3]));
        assert!(!merges(&[12, 5], &[4, 5, 3]) && !merges(&[4, 3, 5], &[4, 5, 3]));
        assert!(
            reshaped(&ArrayD::zeros(IxDyn(&[2, 2])), &[4]).is_none(),
            "an axis too many is a wrong shape"
        );
        let (column, layout) = reshaped(&ArrayD::zeros(IxDyn(&[4, 1])), &[4]).unwrap();
        assert_eq!(column.shape(), [4]);
        assert_eq!(layout.unwrap(), "[4] with other axes of length 1, as [4, 1]");
    }

    #[test]
    fn narrow_types_are_named() {
        let real = |given, dtype| wide_enough(Entries::Real, given, dtype);
        assert!(!real("f32", Dtype::F64) && !real("f16", Dtype::Bf16) && real("f32", Dtype::Bf16));
        assert!(!real("i64", Dtype::F32) && !real("u8", Dtype::F32));
        let pixel = |given, dtype| wide_enough(Entries::Pixel, given, dtype);
        assert!(pixel("i64", Dtype::F64) && !pixel("f32", Dtype::F64) && !pixel("u8", Dtype::F64));
        for entries in [Entries::Byte, Entries::Bit, Entries::Count] {
            assert!(wide_enough(entries, "u8", Dtype::F64) && wide_enough(entries, "i64", Dtype::F64));
            assert!(wide_enough(entries, "f16", Dtype::F64));
        }
    }
}
