//! What is true of a case, and how far off an answer may be: asked thousands of times in a search, computed once per assignment.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use super::exam::Question;
use super::mark::MarkOptions;
use crate::contract::arithmetic::{Dtype, Grade};
use crate::contract::arrays::Arrays;
use crate::contract::case::Case;
use crate::contract::check::tolerance;
use crate::convention::Conventions;

/// Elements that a question remembers; what is beyond is computed each time.
const REMEMBERED: usize = 4_000_000;

/// The true outputs of a case, and the bound of an answer.
#[derive(Debug)]
pub struct Truth {
    /// By the oracle.
    pub expected: Arrays,
    /// How far off each element may be.
    pub bound: Arrays,
}

/// What the truth of one case depends on: conventions, the type, the bits of the accuracy of elementary functions, and the grade.
type Key = (Conventions, Dtype, u64, Grade);

/// The truths of one case, and the inputs that they are of.
#[derive(Debug)]
struct OfCase {
    inputs: Arrays,
    truths: HashMap<Key, Arc<Truth>>,
}

/// The truths of a question's cases, as they are asked for.
#[derive(Debug, Default)]
pub(crate) struct Truths(Mutex<Memory>);

#[derive(Debug, Default)]
struct Memory {
    cases: HashMap<String, OfCase>,
    elements: usize,
}

/// A copy may get other cases: it begins with nothing.
impl Clone for Truths {
    fn clone(&self) -> Truths {
        Truths::default()
    }
}

impl MarkOptions {
    /// The true outputs of a case, and the bound of an answer.
    pub fn truth(&self, question: &Question, case: &Case, c: &Conventions, grade: Grade) -> Arc<Truth> {
        let key = (*c, self.dtype, self.exp_ulp.to_bits(), grade);
        question.truths.get(case, key, || {
            let direction =
                question.component.direction(question.kind).expect("a question has its direction");
            Truth {
                expected: (direction.oracle)(&case.inputs, c),
                bound: tolerance(direction, &case.inputs, c, &self.arithmetic(grade)),
            }
        })
    }
}

impl Truths {
    /// Two threads may compute the same: they get the same, and nobody waits.
    fn get(&self, case: &Case, key: Key, computed: impl FnOnce() -> Truth) -> Arc<Truth> {
        let lock = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let known = lock()
            .cases
            .get(&case.id)
            .filter(|of| of.inputs == case.inputs)
            .and_then(|of| of.truths.get(&key).cloned());
        if let Some(truth) = known {
            return truth;
        }
        let truth = Arc::new(computed());
        let size = |arrays: &Arrays| arrays.values().map(|array| array.len()).sum::<usize>();
        let mut memory = lock();
        memory.elements += size(&truth.expected) + size(&truth.bound);
        if memory.elements <= REMEMBERED {
            let new = || OfCase { inputs: case.inputs.clone(), truths: HashMap::new() };
            let of = memory.cases.entry(case.id.clone()).or_insert_with(new);
            if of.inputs == case.inputs {
                of.truths.insert(key, truth.clone());
            }
        }
        truth
    }
}

#[cfg(test)]
mod tests {
    use super::super::exam::Exam;
    use super::super::judging::EXP_ULP;
    use super::*;
    use crate::convention::CS180;

    #[test]
    fn what_was_asked_before_is_remembered_and_nothing_else() {
        let exam = Exam::new("positional_encoding", Dtype::F32, None).unwrap();
        let (question, options) = (&exam.questions[0], MarkOptions { dtype: Dtype::F32, exp_ulp: EXP_ULP });
        let case = &question.cases[0];
        let truth =
            |case: &Case, c: &Conventions, options: MarkOptions| options.truth(question, case, c, Grade::B);
        let first = truth(case, &CS180, options);
        assert!(Arc::ptr_eq(&first, &truth(case, &CS180, options)));
        let other = CS180.with("frequency", "one").unwrap();
        assert_ne!(truth(case, &other, options).expected, first.expected);
        let doubled = MarkOptions { exp_ulp: 2.0 * EXP_ULP, ..options };
        assert_ne!(truth(case, &CS180, doubled).bound, first.bound);
        // The same name for other inputs.
        let mut moved = case.clone();
        moved.inputs.get_mut("x").unwrap().mapv_inplace(|x| x + 0.25);
        assert_ne!(truth(&moved, &CS180, options).expected, first.expected);
        assert!(question.clone().truths.0.lock().unwrap().cases.is_empty());
    }
}
