//! What is true of a case, and how far off an answer may be: asked thousands of times in a search, computed once per assignment.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use crate::contract::arithmetic::{Dtype, Grade};
use crate::contract::arrays::Arrays;
use crate::contract::case::Case;
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
pub(crate) type Key = (Conventions, Dtype, u64, Grade);

/// The truths of one case, and the inputs that they are of.
#[derive(Debug)]
struct OfCase {
    inputs: Arrays,
    truths: HashMap<Key, Arc<Truth>>,
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

    /// The truth of a case that `computed` gives, if it wasn't asked for before. Two threads may compute the same: they get the same, and
    /// nobody waits.
    pub(crate) fn get(&self, case: &Case, key: Key, computed: impl FnOnce() -> Truth) -> Arc<Truth> {
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
impl Truths {
    /// Whether nothing was asked for.
    pub(crate) fn is_empty(&self) -> bool {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).cases.is_empty()
    }
}
