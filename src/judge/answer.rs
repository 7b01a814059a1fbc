//! Answers: arrays as a candidate gave them, and what can be wrong with them before any number is compared.

use std::collections::BTreeMap;

use ndarray::{ArrayD, IxDyn};

use crate::contract::arithmetic::Dtype;
use crate::contract::arrays::Arrays;

/// One array of an answer.
#[derive(Clone, Debug)]
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

/// Outputs that are small whole numbers: bytes, bits and counts.
const WHOLE: [&str; 5] = ["bytes", "hit", "occupied", "found", "visited"];

/// Whether a float type can represent all that `dtype` computes. Pixel positions, bytes, bits and counts may be integers too.
pub fn wide_enough(name: &str, given: &str, dtype: Dtype) -> bool {
    let whole = WHOLE.contains(&name);
    match given {
        "f64" => true,
        "f32" => dtype != Dtype::F64 || whole,
        "f16" => dtype == Dtype::F16 || whole,
        "i64" => whole || ["uv", "image_ids"].contains(&name),
        _ => whole,
    }
}

/// The answer in the expected shape: as it is, or with merged axes split (rays of an (H, W) picture as H W rows). The text says which
/// layout it was.
pub fn reshaped(values: &ArrayD<f64>, expected: &[usize]) -> Option<(ArrayD<f64>, Option<String>)> {
    if values.shape() == expected {
        return Some((values.clone(), None));
    }
    let merged = values.ndim() < expected.len() && merges(values.shape(), expected);
    let array = merged.then(|| {
        let flat: Vec<f64> = values.iter().copied().collect();
        ArrayD::from_shape_vec(IxDyn(expected), flat).expect("merging keeps the number of elements")
    })?;
    Some((array, Some(format!("{:?} flattened to {:?}", expected, values.shape()))))
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
            reshaped(&ArrayD::zeros(IxDyn(&[1, 4])), &[4]).is_none(),
            "an axis too many is a wrong shape"
        );
    }

    #[test]
    fn narrow_types_are_named() {
        assert!(!wide_enough("colors", "f32", Dtype::F64) && !wide_enough("colors", "f16", Dtype::Bf16));
        assert!(wide_enough("colors", "f32", Dtype::Bf16) && wide_enough("bytes", "u8", Dtype::F64));
        assert!(!wide_enough("colors", "i64", Dtype::F32) && !wide_enough("t_near", "u8", Dtype::F32));
        assert!(wide_enough("hit", "u8", Dtype::F64) && wide_enough("visited", "i64", Dtype::F64));
    }
}
