//! What was found out about the answers to a question: several rounds ask the same, in the conventions that the row reads.

use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

use super::mark::Marks;
use crate::contract::arithmetic::Grade;
use crate::convention::Conventions;

/// It holds of these answers alone: others begin with nothing.
#[derive(Debug, Default)]
pub(crate) struct Known {
    holds: Memory<bool>,
    marks: Memory<(Marks, Option<Grade>)>,
}

type Memory<T> = Mutex<HashMap<Conventions, T>>;

impl Known {
    /// Whether they are right in these conventions.
    pub(super) fn holds(&self, c: Conventions, computed: impl FnOnce(&Conventions) -> bool) -> bool {
        once(&self.holds, c, computed)
    }

    /// Their marks in these.
    pub(super) fn marks(
        &self,
        c: Conventions,
        computed: impl FnOnce(&Conventions) -> (Marks, Option<Grade>),
    ) -> (Marks, Option<Grade>) {
        once(&self.marks, c, computed)
    }
}

/// Two threads may compute the same: they get the same, and nobody waits.
fn once<T: Clone>(memory: &Memory<T>, c: Conventions, computed: impl FnOnce(&Conventions) -> T) -> T {
    let lock = || memory.lock().unwrap_or_else(PoisonError::into_inner);
    let known = lock().get(&c).cloned();
    known.unwrap_or_else(|| {
        let made = computed(&c);
        lock().insert(c, made.clone());
        made
    })
}
