//! The smallest case that is wrong, in full: so that it can be followed by hand.

use std::fmt;

use ndarray::ArrayD;
use serde_json::{Value, json};

use super::answer::{Answers, reshaped};
use super::assignment::small_cases;
use super::exam::Question;
use super::mark::MarkOptions;
use super::within::within;
use crate::contract::arithmetic::Grade;
use crate::convention::Conventions;

/// Numbers of an array that are written out.
const SHOWN: usize = 24;

/// A case with what was answered and what is right.
#[derive(Clone, Debug)]
pub struct Example {
    /// The case.
    pub id: String,
    /// What it probes.
    pub comment: &'static str,
    /// Its inputs.
    pub inputs: Vec<(String, ArrayD<f64>)>,
    /// The outputs that are off: name, answer, truth.
    pub off: Vec<(String, ArrayD<f64>, ArrayD<f64>)>,
}

/// The smallest case of which an output is off in these conventions.
pub(crate) fn smallest(
    question: &Question,
    answers: &Answers,
    c: &Conventions,
    options: &MarkOptions,
) -> Option<Example> {
    small_cases(question, answers).into_iter().find_map(|(case, answer)| {
        let truth = options.truth(question, case, c, Grade::B);
        let (expected, bound) = (&truth.expected, &truth.bound);
        let off = |name: &&String| {
            let one =
                |from: &crate::contract::arrays::Arrays| [((*name).clone(), from[*name].clone())].into();
            let given = answer.get(*name)?;
            let alone = [((*name).clone(), given.clone())].into();
            let wrong = !within(&alone, &one(expected), None, [one(bound)]);
            let (got, _) = reshaped(&given.values, expected[*name].shape()).filter(|_| wrong)?;
            Some(((*name).clone(), got, expected[*name].clone()))
        };
        let off: Vec<_> = question.ordered(expected.keys()).iter().filter_map(off).collect();
        (!off.is_empty()).then(|| Example {
            id: case.id.clone(),
            comment: case.comment,
            inputs: case.inputs.iter().map(|(name, array)| (name.clone(), array.clone())).collect(),
            off,
        })
    })
}

impl Example {
    /// As JSON, arrays as nested lists.
    pub fn json(&self) -> Value {
        let inputs = self.inputs.iter().map(|(name, array)| (name.clone(), nested(array)));
        let off = self.off.iter().map(|(name, got, expected)| {
            (name.clone(), json!({ "got": nested(got), "expected": nested(expected) }))
        });
        json!({
            "id": self.id, "comment": self.comment, "inputs": inputs.collect::<serde_json::Map<_, _>>(),
            "off": off.collect::<serde_json::Map<_, _>>(),
        })
    }
}

impl fmt::Display for Example {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        writeln!(f, "  the smallest case that is wrong: {}, {}", self.id, self.comment)?;
        for (name, array) in &self.inputs {
            writeln!(f, "    {name} = {}", text(array))?;
        }
        for (name, got, expected) in &self.off {
            writeln!(f, "    {name}: got {}, expected {}", text(got), text(expected))?;
        }
        Ok(())
    }
}

/// An array as nested lists; infinities and NaN, which JSON doesn't have, as strings.
fn nested(array: &ArrayD<f64>) -> Value {
    if array.ndim() == 0 {
        let x = array.first().copied().unwrap_or(f64::NAN);
        return if x.is_finite() { json!(x) } else { json!(x.to_string()) };
    }
    array.outer_iter().map(|part| nested(&part.to_owned())).collect()
}

/// The same for people: the shape alone where it is long.
fn text(array: &ArrayD<f64>) -> String {
    if array.len() > SHOWN {
        let shape = array.shape().iter().map(ToString::to_string).collect::<Vec<_>>().join(" x ");
        return format!("{shape} numbers, the first {}", array.first().copied().unwrap_or(f64::NAN));
    }
    nested(array).to_string().replace('"', "").replace(',', ", ")
}
