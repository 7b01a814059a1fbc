//! The operations that an evaluation comes by, how often, and what other numbers are there then.

use std::cell::RefCell;
use std::collections::VecDeque;

use super::how::How;
use super::operation::Operation;
use super::site::{Origin, Site};

/// A site that an evaluation came by.
#[derive(Clone, Debug)]
pub(crate) struct Seen {
    /// Which.
    pub site: Site,
    /// How often it did.
    pub times: usize,
    /// What came out, where it was the same each time.
    pub value: Option<f64>,
    /// Other numbers that were there when it came by first, the latest first.
    pub others: Vec<Origin>,
}

impl Seen {
    /// The ways to take another number for one of its own.
    pub(crate) fn mixed_up(&self) -> Vec<How> {
        let numbers = self.numbers();
        let others = self.others.iter().flat_map(|other| (0..numbers).map(|n| How::Other(n, *other)));
        self.both().chain(others).collect()
    }

    /// The ways to take one of its own numbers for the other, too.
    pub(crate) fn both(&self) -> impl Iterator<Item = How> + use<> {
        let two = self.numbers() == 2;
        (0..2).filter(move |_| two).map(How::Both)
    }

    /// How many numbers it has.
    fn numbers(&self) -> usize {
        use Operation as O;
        match self.site.operation {
            O::Add | O::Sub | O::Mul | O::Div | O::Max | O::Min | O::Pow => 2,
            O::Sqrt | O::Exp | O::Expm1 | O::Ln | O::Sin | O::Cos => 1,
            _ => 0,
        }
    }
}

/// Numbers that one may be taken for.
pub(crate) const OTHERS: usize = 24;

/// Numbers of the operations before that are looked at for them.
const LATEST: usize = 192;

thread_local! {
    static SEEN: RefCell<Vec<Seen>> = const { RefCell::new(vec![]) };
    static LATEST_NUMBERS: RefCell<VecDeque<(Origin, f64)>> = const { RefCell::new(VecDeque::new()) };
}

/// An evaluation begins.
pub(super) fn begin() {
    SEEN.with_borrow_mut(Vec::clear);
    LATEST_NUMBERS.with_borrow_mut(VecDeque::clear);
}

/// What it came by.
pub(super) fn all() -> Vec<Seen> {
    SEEN.take()
}

/// Writes down what came out of two numbers.
pub(super) fn saw(site: Site, numbers: [f64; 2], value: f64) {
    SEEN.with_borrow_mut(|all| match all.iter_mut().find(|seen| seen.site == site) {
        Some(seen) => {
            seen.times += 1;
            seen.value = seen.value.filter(|had| *had == value);
        }
        None => all.push(Seen { site, times: 1, value: Some(value), others: others(numbers, value) }),
    });
    LATEST_NUMBERS.with_borrow_mut(|latest| {
        for (place, number) in [numbers[0], numbers[1], value].into_iter().enumerate() {
            latest.push_front((Origin { site, place }, number));
        }
        latest.truncate(LATEST);
    });
}

/// Numbers that differ from these and from one another, the latest first.
fn others(numbers: [f64; 2], value: f64) -> Vec<Origin> {
    let mut known = vec![numbers[0], numbers[1], value];
    LATEST_NUMBERS.with_borrow(|latest| {
        let new = latest.iter().filter(|(_, number)| {
            let new = !known.contains(number) && !number.is_nan();
            known.extend(new.then_some(*number));
            new
        });
        new.map(|(origin, _)| *origin).take(OTHERS).collect()
    })
}
