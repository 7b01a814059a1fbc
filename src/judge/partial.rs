//! The conventions that a row reads, by their names; the search for an assignment goes through their values.

use std::collections::BTreeMap;

use crate::contract::component::Component;
use crate::convention::{CHOICES, CS180, Conventions};

/// Values of some conventions, spelled as in [`CHOICES`].
pub(crate) type Partial = BTreeMap<&'static str, &'static str>;

/// The value of a convention as its static name.
pub(crate) fn value(c: &Conventions, key: &str) -> &'static str {
    let (_, values) =
        CHOICES.iter().find(|(name, _)| *name == key).expect("components name known conventions");
    let value = c.get(key);
    values.iter().find(|v| **v == value).expect("every value is listed")
}

/// The conventions of `component` in `c`.
pub(crate) fn partial(component: &Component, c: &Conventions) -> Partial {
    component.conventions.iter().map(|key| (*key, value(c, key))).collect()
}

/// `base` with the values of `partial`.
pub(crate) fn apply(partial: &Partial, base: &Conventions) -> Conventions {
    partial.iter().fold(*base, |c, (key, value)| c.with(key, value).expect("listed values"))
}

/// The conventions that the component reads; the others can't change what is true of it.
pub(crate) fn read(component: &Component, c: &Conventions) -> Conventions {
    c.of(component.conventions, CS180)
}

/// `partial` with another value of one.
pub(crate) fn with(partial: &Partial, key: &'static str, value: &'static str) -> Partial {
    let mut partial = partial.clone();
    partial.insert(key, value);
    partial
}

/// In how many conventions `a` differs from `b`.
pub(crate) fn changes(a: &Partial, b: &Partial) -> usize {
    a.iter().filter(|(key, value)| b.get(*key).is_some_and(|other| other != *value)).count()
}
