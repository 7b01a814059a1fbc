//! What goes into a case: shared by its copies until one of them changes it.

use std::ops::{Deref, DerefMut};
use std::sync::{Arc, OnceLock};

use super::arrays::Arrays;

/// Named arrays that copies share. What is written to is a copy's own from then on.
#[derive(Clone, Debug, Default)]
pub struct Inputs(Arc<Shared>);

/// The arrays, and what a search asks of them thousands of times, once it was asked.
#[derive(Clone, Debug, Default)]
struct Shared {
    arrays: Arrays,
    size: OnceLock<usize>,
    finite: OnceLock<bool>,
}

impl Inputs {
    /// How many numbers they are.
    pub fn size(&self) -> usize {
        *self.0.size.get_or_init(|| self.values().map(|array| array.len()).sum())
    }

    /// Whether all of them are finite.
    pub fn finite(&self) -> bool {
        *self.0.finite.get_or_init(|| self.values().flatten().all(|x| x.is_finite()))
    }
}

impl From<Arrays> for Inputs {
    fn from(arrays: Arrays) -> Inputs {
        Inputs(Arc::new(Shared { arrays, ..Shared::default() }))
    }
}

impl Deref for Inputs {
    type Target = Arrays;

    fn deref(&self) -> &Arrays {
        &self.0.arrays
    }
}

/// What was known of them is forgotten.
impl DerefMut for Inputs {
    fn deref_mut(&mut self) -> &mut Arrays {
        let shared = Arc::make_mut(&mut self.0);
        (shared.size, shared.finite) = Default::default();
        &mut shared.arrays
    }
}

/// Copies are equal without a look at their numbers.
impl PartialEq for Inputs {
    fn eq(&self, other: &Inputs) -> bool {
        Arc::ptr_eq(&self.0, &other.0) || self.0.arrays == other.0.arrays
    }
}

#[cfg(test)]
mod tests {
    use super::super::arrays::{array, arrays};
    use super::*;

    #[test]
    fn a_copy_that_changes_leaves_the_others() {
        let of = |x| Inputs::from(arrays([("x", array(&[1], vec![x]))]));
        let first = of(1.0);
        let mut copy = first.clone();
        assert_eq!(copy, first);
        copy.insert("x".to_string(), array(&[1], vec![2.0]));
        assert_eq!((&first, &copy), (&of(1.0), &of(2.0)));
        assert_ne!(first, copy);
    }

    #[test]
    fn what_is_known_is_forgotten_where_it_changes() {
        let mut inputs = Inputs::from(arrays([("x", array(&[1], vec![1.0]))]));
        assert!(inputs.size() == 1 && inputs.finite());
        inputs.insert("y".to_string(), array(&[2], vec![2.0, f64::INFINITY]));
        assert!(inputs.size() == 3 && !inputs.finite());
    }
}
