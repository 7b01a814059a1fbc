//! What goes into a case: shared by its copies until one of them changes it.

use std::ops::{Deref, DerefMut};
use std::sync::Arc;

use super::arrays::Arrays;

/// Named arrays that copies share. What is written to is a copy's own from then on.
#[derive(Clone, Debug, Default)]
pub struct Inputs(Arc<Arrays>);

impl From<Arrays> for Inputs {
    fn from(arrays: Arrays) -> Inputs {
        Inputs(Arc::new(arrays))
    }
}

impl Deref for Inputs {
    type Target = Arrays;

    fn deref(&self) -> &Arrays {
        &self.0
    }
}

impl DerefMut for Inputs {
    fn deref_mut(&mut self) -> &mut Arrays {
        Arc::make_mut(&mut self.0)
    }
}

/// Copies are equal without a look at their numbers.
impl PartialEq for Inputs {
    fn eq(&self, other: &Inputs) -> bool {
        Arc::ptr_eq(&self.0, &other.0) || self.0 == other.0
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
}
