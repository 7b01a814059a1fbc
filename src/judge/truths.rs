//! What is true of a case, and how far off an answer may be: asked thousands of times in a search, computed once per assignment. And the
//! case's nudged inputs, computed once for all hypotheses.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use super::partial::read;
use crate::contract::arithmetic::{Arithmetic, Dtype, Grade};
use crate::contract::arrays::Arrays;
use crate::contract::case::Case;
use crate::contract::check::{Kind, oracle_error, with_oracle_error};
use crate::contract::component::{Component, Direction};
use crate::contract::inputs::Inputs;
use crate::convention::Conventions;

/// Elements that a question remembers; what is beyond is computed each time.
const REMEMBERED: usize = 8_000_000;

/// The true outputs of a case, and the bound of an answer.
#[derive(Debug, Default)]
pub struct Truth {
    /// By the oracle.
    pub expected: Arc<Arrays>,
    /// How far off each element may be.
    pub bound: Arrays,
}

/// What is true whoever answers.
#[derive(Debug)]
struct Exact {
    /// By the oracle.
    expected: Arc<Arrays>,
    /// How far off that may be, once it was asked for.
    error: OnceLock<Arrays>,
}

/// What a bound depends on beside the case and its conventions: the type, the bits of the accuracy of elementary functions, and the grade.
type Key = (Conventions, Dtype, u64, Grade);

/// The number of a nudge, and the bits of how far it goes.
type Nudge = (u64, u64);

/// The truths of one case, and the inputs that they are of, as they are and nudged.
#[derive(Debug)]
struct OfCase {
    inputs: Inputs,
    nudged: HashMap<Nudge, Arc<Arrays>>,
    exact: HashMap<Conventions, Arc<Exact>>,
    truths: HashMap<Key, Arc<Truth>>,
    scales: HashMap<(Dtype, u64), Arc<Option<Arc<Truth>>>>,
}

/// The truths of a question's cases, as they are asked for.
#[derive(Debug, Default)]
pub(crate) struct Truths(Arc<Mutex<Memory>>);

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

impl Truths {
    /// The same memory for a question that has some of these cases.
    pub(crate) fn shared(&self) -> Truths {
        Truths(self.0.clone())
    }

    /// What `known` finds in the memory of a case, or what `computed` gives, which `keep` puts there. Two threads may compute the same:
    /// they get the same, and nobody waits.
    fn get<T>(
        &self,
        case: &Case,
        known: impl FnOnce(&OfCase) -> Option<Arc<T>>,
        computed: impl FnOnce() -> (T, usize),
        keep: impl FnOnce(&mut OfCase, Arc<T>),
    ) -> Arc<T> {
        let lock = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let found = lock().cases.get(&case.id).filter(|of| of.inputs == case.inputs).and_then(known);
        if let Some(found) = found {
            return found;
        }
        let (made, elements) = computed();
        let made = Arc::new(made);
        let mut memory = lock();
        memory.elements += elements;
        if memory.elements <= REMEMBERED {
            let new = || {
                let (nudged, exact, truths, scales) = Default::default();
                OfCase { inputs: case.inputs.clone(), nudged, exact, truths, scales }
            };
            let of = memory.cases.entry(case.id.clone()).or_insert_with(new);
            if of.inputs == case.inputs {
                keep(of, made.clone());
            }
        }
        made
    }
}

fn size(arrays: &Arrays) -> usize {
    arrays.values().map(|array| array.len()).sum()
}

/// A row in one direction.
pub(crate) type Row = (&'static Component, Kind);

fn direction((component, kind): Row) -> &'static Direction {
    component.direction(kind).expect("a question has its direction")
}

impl Truths {
    fn exact(&self, row: Row, case: &Case, c: Conventions) -> Arc<Exact> {
        let known = |of: &OfCase| of.exact.get(&c).cloned();
        let computed = || {
            let expected = (direction(row).oracle)(&case.inputs, &c);
            let elements = size(&expected);
            (Exact { expected: Arc::new(expected), error: OnceLock::new() }, elements)
        };
        self.get(case, known, computed, |of, exact| {
            of.exact.insert(c, exact);
        })
    }

    /// The true outputs of a case.
    pub(crate) fn expected(&self, row: Row, case: &Case, c: &Conventions) -> Arc<Arrays> {
        self.exact(row, case, read(row.0, c)).expected.clone()
    }

    /// The inputs of a case, nudged: the same for every hypothesis.
    pub(crate) fn nudged(&self, case: &Case, by: Nudge, nudged: impl FnOnce() -> Arrays) -> Arc<Arrays> {
        let computed = || {
            let inputs = nudged();
            let elements = size(&inputs);
            (inputs, elements)
        };
        let known = |of: &OfCase| of.nudged.get(&by).cloned();
        self.get(case, known, computed, |of, inputs| {
            of.nudged.insert(by, inputs);
        })
    }

    /// What an answer that may be rejected early is held against, in a type with elementary functions of so many ULP.
    pub(crate) fn scale(
        &self,
        case: &Case,
        (dtype, elementary_ulp): (Dtype, f64),
        scale: impl FnOnce() -> Option<Arc<Truth>>,
    ) -> Option<Arc<Truth>> {
        let key = (dtype, elementary_ulp.to_bits());
        let known = |of: &OfCase| of.scales.get(&key).cloned();
        let keep = |of: &mut OfCase, scale| {
            of.scales.insert(key, scale);
        };
        self.get(case, known, || (scale(), 0), keep).as_ref().clone()
    }

    /// The true outputs of a case, and the bound of an answer in `dtype`.
    pub(crate) fn truth(
        &self,
        row: Row,
        case: &Case,
        c: &Conventions,
        (dtype, arithmetic): (Dtype, &Arithmetic),
    ) -> Arc<Truth> {
        let c = read(row.0, c);
        let key = (c, dtype, arithmetic.elementary_ulp.to_bits(), arithmetic.grade);
        let computed = || {
            let exact = self.exact(row, case, c);
            // Not within the lock: nobody waits.
            let made = exact.error.get().is_none().then(|| oracle_error(direction(row), &case.inputs, &c));
            let error = exact.error.get_or_init(|| made.expect("it wasn't there"));
            let own = (direction(row).bound)(&case.inputs, &c, arithmetic);
            let (expected, bound) = (exact.expected.clone(), with_oracle_error(own, error));
            let elements = 2 * size(&bound);
            (Truth { expected, bound }, elements)
        };
        self.get(
            case,
            |of| of.truths.get(&key).cloned(),
            computed,
            |of, truth| {
                of.truths.insert(key, truth);
            },
        )
    }
}

#[cfg(test)]
impl Truths {
    /// Whether nothing was asked for.
    pub(crate) fn is_empty(&self) -> bool {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).cases.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::super::exam::Exam;
    use super::*;
    use crate::convention::{CHOICES, CS180};

    /// What [`read`] leaves out changes nothing.
    #[test]
    fn rows_read_the_conventions_that_they_list() {
        let mut changed = 0;
        for question in Exam::new("", Dtype::F64, None).unwrap().questions {
            let component = question.component;
            let size = |case: &&Case| size(&case.inputs);
            let case = question.cases.iter().min_by_key(size).expect("a case");
            let direction = component.direction(question.kind).unwrap();
            let arithmetic = Arithmetic::new(Dtype::F32, Grade::B);
            let of = |c: &Conventions| {
                ((direction.oracle)(&case.inputs, c), (direction.bound)(&case.inputs, c, &arithmetic))
            };
            // NaN is like itself.
            let text = |of| format!("{of:?}");
            let right = text(of(&CS180));
            for (key, values) in CHOICES.iter().filter(|(key, _)| !component.conventions.contains(key)) {
                for other in values.iter().filter_map(|value| CS180.with(key, value).ok()) {
                    assert!(text(of(&other)) == right, "{} {:?} {key}", component.name, question.kind);
                    changed += 1;
                }
            }
        }
        assert!(changed > 1000, "{changed}");
    }
}
