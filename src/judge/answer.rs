//! Answers: arrays as a candidate gave them, and what can be wrong with them before any number is compared.

use std::collections::BTreeMap;

use ndarray::{ArrayD, CowArray, IxDyn};

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

/// What became of a question.
#[derive(Clone, Debug)]
pub enum Reply {
    /// Arrays by output.
    Answer(Answer),
    /// It crashed, and said this: that is the case's result.
    Crash(String),
    /// There is no answer.
    Nothing,
}

/// How a question is put.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Manner {
    /// As ever.
    Plain,
    /// With arrays that don't lie in one piece, where the language has such: every other element of longer ones. A candidate may refuse these:
    /// [`Reply::Nothing`].
    Strided,
}

/// f64 arrays (or f32 ones, widened) from a closure as an answer.
pub fn given(arrays: Arrays) -> Answer {
    arrays.into_iter().map(|(name, values)| (name, Given { values, dtype: "f64" })).collect()
}

/// Whether a type can represent all that `dtype` computes. Whole numbers of 64 bits lose nothing that they hold: `return 100`.
pub fn wide_enough(entries: Entries, given: &str, dtype: Dtype) -> bool {
    match given {
        _ if entries.whole() => true,
        "f64" | "i64" => true,
        "f32" => dtype != Dtype::F64,
        "f16" => dtype == Dtype::F16,
        _ => false,
    }
}

/// Predicted arrays beside what was answered for them, where that has their shape.
pub(crate) fn beside<'a>(
    answer: &'a Answer,
    predicted: &'a Arrays,
) -> impl Iterator<Item = (&'a String, &'a ArrayD<f64>, ArrayD<f64>)> {
    predicted.iter().filter_map(|(name, p)| {
        let (got, _) = reshaped(&answer.get(name)?.values, p.shape())?;
        Some((name, p, got))
    })
}

/// The answer in the expected shape: as it is, with other axes of length one, or with merged axes split (rays of an (H, W) picture as H W
/// rows). The text says which layout it was.
pub fn reshaped(values: &ArrayD<f64>, expected: &[usize]) -> Option<(ArrayD<f64>, Option<String>)> {
    if values.shape() == expected {
        return Some((values.clone(), None));
    }
    relaid(values, expected).map(|(array, layout)| (array, Some(layout)))
}

/// The same, borrowed where it has the expected shape.
pub(super) fn in_shape<'a>(values: &'a ArrayD<f64>, expected: &[usize]) -> Option<CowArray<'a, f64, IxDyn>> {
    if values.shape() == expected {
        return Some(values.into());
    }
    relaid(values, expected).map(|(array, _)| array.into())
}

/// An answer of another shape in the expected one.
fn relaid(values: &ArrayD<f64>, expected: &[usize]) -> Option<(ArrayD<f64>, String)> {
    let longer = |shape: &[usize]| shape.iter().copied().filter(|&n| n != 1).collect::<Vec<_>>();
    let ones = longer(values.shape()) == longer(expected);
    let merged = values.ndim() < expected.len() && merges(values.shape(), expected);
    let array = (ones || merged).then(|| {
        let flat: Vec<f64> = values.iter().copied().collect();
        ArrayD::from_shape_vec(IxDyn(expected), flat).expect("neither changes the number of elements")
    })?;
    if ones {
        return Some((array, format!("axes of length one: {:?} for {expected:?}", values.shape())));
    }
    Some((array, format!("{:?} flattened to {:?}", expected, values.shape())))
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
        let of = |given: &[usize], expected: &[usize]| reshaped(&ArrayD::zeros(IxDyn(given)), expected);
        for (given, expected) in [(&[1, 4][..], &[4][..]), (&[4, 1], &[4]), (&[1], &[]), (&[], &[1, 1])] {
            let (array, says) = of(given, expected).unwrap();
            assert!(array.shape() == expected && says.unwrap().contains("length one"));
        }
        assert!(of(&[2, 4], &[4]).is_none() && of(&[4, 2], &[8]).is_none() && of(&[3, 1], &[4]).is_none());
    }

    #[test]
    fn narrow_types_are_named() {
        let real = |given, dtype| wide_enough(Entries::Real, given, dtype);
        assert!(!real("f32", Dtype::F64) && !real("f16", Dtype::Bf16) && real("f32", Dtype::Bf16));
        assert!(real("i64", Dtype::F32) && !real("u8", Dtype::F32));
        let pixel = |given, dtype| wide_enough(Entries::Pixel, given, dtype);
        assert!(pixel("i64", Dtype::F64) && !pixel("f32", Dtype::F64) && !pixel("u8", Dtype::F64));
        for entries in [Entries::Byte, Entries::Bit, Entries::Count] {
            assert!(wide_enough(entries, "u8", Dtype::F64) && wide_enough(entries, "i64", Dtype::F64));
            assert!(wide_enough(entries, "f16", Dtype::F64));
        }
    }
}
