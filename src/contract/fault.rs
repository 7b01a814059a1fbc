//! One operation of a formula that is done in another way: what code with a slip of the pen does. An honest implementation does all its
//! arithmetic with a [`Machine`](super::machine::Machine), which asks here, so that any operation of any component can be tried.

use std::cell::{Cell, RefCell};
use std::collections::VecDeque;
use std::panic::{Location, resume_unwind};

use super::operation::Operation;

/// An operation in the text of a formula.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Site {
    /// What is done there.
    pub operation: Operation,
    /// Where that is.
    pub at: &'static Location<'static>,
}

impl PartialEq for Site {
    /// Asked at every operation: what differs most often comes first.
    fn eq(&self, other: &Site) -> bool {
        let place = |site: &Site| (site.at.line(), site.at.column());
        place(self) == place(other) && self.operation == other.operation && self.at.file() == other.at.file()
    }
}

/// A number of an operation that was done before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Origin {
    /// Where that was.
    pub site: Site,
    /// Its first number, its second one, or (2) what came out.
    pub place: usize,
}

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
        use Operation as O;
        let numbers = match self.site.operation {
            O::Add | O::Sub | O::Mul | O::Div | O::Max | O::Min | O::Pow => 2,
            O::Sqrt | O::Exp | O::Expm1 | O::Ln | O::Sin | O::Cos => 1,
            _ => 0,
        };
        let one_of_both = (0..numbers).filter(|_| numbers == 2).map(How::Both);
        let others = self.others.iter().flat_map(|other| (0..numbers).map(|n| How::Other(n, *other)));
        one_of_both.chain(others).collect()
    }
}

/// In which other way it is done. The likelier come first in [`How::all`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum How {
    /// As it should be; the sites are written down.
    Observed,
    /// Without the second number, or without the function.
    First,
    /// Without the first.
    Second,
    /// Another operation.
    Done(Operation),
    /// Another operation, the other way around: b / a for a b.
    Crossed(Operation),
    /// The other way around: b - a, b / a.
    Exchanged,
    /// With the other sign.
    Opposite,
    /// The function of -a.
    OfOpposite,
    /// Squared.
    Squared,
    /// Its square root.
    Root,
    /// The first number or the second one has so much more.
    PlusInside(usize, f64),
    /// It is squared.
    SquaredInside(usize),
    /// Its square root is taken.
    RootInside(usize),
    /// Half of it.
    Halved,
    /// Twice of it.
    Doubled,
    /// Another number.
    Taken(f64),
    /// So many times as much.
    Times(f64),
    /// So much more.
    Plus(f64),
    /// The first or the second number is taken for both.
    Both(usize),
    /// Another number is taken for the first or the second one.
    Other(usize, Origin),
    /// A sum without one of its terms.
    Without(usize),
    /// A sum with one of its terms subtracted.
    Less(usize),
    /// The second number of a sum is taken outside of the parenthesis: a / c + b for (a + b) / c.
    SecondOutside,
    /// The first one: a + b / c.
    FirstOutside,
    /// The parenthesis closes after what follows: a / b + c is (a + c) / b.
    Wider,
}

/// Numbers that one may be taken for.
pub(crate) const OTHERS: usize = 24;

/// Numbers of the operations before that are looked at for them.
const LATEST: usize = 192;

/// Terms of a sum that may be left out, one at a time.
const TERMS: usize = 6;

impl How {
    /// Whether what comes out depends on what is done next.
    pub(crate) fn of_parenthesis(self) -> bool {
        matches!(self, How::FirstOutside | How::SecondOutside | How::Wider)
    }

    /// All ways in which this operation can be done wrong.
    pub(crate) fn all(operation: Operation) -> Vec<How> {
        use How::*;
        use Operation as O;
        let mut all = match operation {
            O::Add => {
                vec![First, Second, Done(O::Sub), Crossed(O::Sub), Done(O::Mul), FirstOutside, SecondOutside]
            }
            O::Sub => vec![First, Second, Done(O::Add), Exchanged, FirstOutside, SecondOutside],
            O::Mul => vec![First, Second, Done(O::Div), Crossed(O::Div), Done(O::Add), Wider],
            O::Div => vec![First, Second, Done(O::Mul), Exchanged, Wider],
            O::Max => vec![First, Second, Done(O::Min)],
            O::Min => vec![First, Second, Done(O::Max)],
            O::Pow => vec![First, Exchanged],
            // Twice the other sign is none at all.
            O::Neg => vec![],
            O::Sqrt | O::Ln => vec![First],
            O::Exp => vec![First, OfOpposite, Done(O::Expm1)],
            O::Expm1 => vec![First, OfOpposite, Done(O::Exp)],
            O::Sin => vec![First, Done(O::Cos)],
            O::Cos => vec![First, Done(O::Sin)],
            O::Sum | O::Dot => (0..TERMS).flat_map(|n| [Without(n), Less(n)]).collect(),
            O::Above => vec![Second],
            O::Given | O::Rounded => vec![],
        };
        if matches!(operation, O::Add | O::Sub | O::Mul | O::Div) {
            all.extend([RootInside(0), RootInside(1), SquaredInside(0), SquaredInside(1)]);
        }
        // Counted from 1, or up to the last one.
        if matches!(operation, O::Mul | O::Div | O::Pow) {
            all.extend([PlusInside(0, 1.0), PlusInside(0, -1.0), PlusInside(1, 1.0), PlusInside(1, -1.0)]);
        }
        all.extend([Opposite, Halved, Doubled, Squared, Root, Taken(0.0), Taken(1.0)]);
        if matches!(operation, O::Given | O::Rounded) {
            all.extend([Plus(1.0), Plus(-1.0), Plus(0.5), Plus(-0.5)]);
        }
        all
    }
}

/// A number that waits for the operation that it belongs to.
#[derive(Clone, Copy)]
struct Waiting {
    /// What the next operation takes, but for its last bit, by which it is known again.
    shown: f64,
    /// What that stands for.
    meant: f64,
    numbers: [f64; 2],
}

thread_local! {
    static SEEN: RefCell<Vec<Seen>> = const { RefCell::new(vec![]) };
    static LEFT: Cell<usize> = const { Cell::new(0) };
    static WAITING: Cell<Option<Waiting>> = const { Cell::new(None) };
    static LATEST_NUMBERS: RefCell<VecDeque<(Origin, f64)>> = const { RefCell::new(VecDeque::new()) };
    static OTHER: Cell<Option<f64>> = const { Cell::new(None) };
}

/// A site with what happens there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fault {
    /// Where.
    pub site: Option<Site>,
    /// How.
    pub how: How,
}

impl Fault {
    /// The sites that a function comes by.
    pub(crate) fn observed(function: impl FnOnce(Fault)) -> Vec<Seen> {
        SEEN.with_borrow_mut(Vec::clear);
        LATEST_NUMBERS.with_borrow_mut(VecDeque::clear);
        Fault::begin(usize::MAX);
        function(Fault { site: None, how: How::Observed });
        SEEN.take()
    }

    /// A new evaluation begins, of at most so many operations: a loop whose numbers are wrong may have no end.
    ///
    /// # Panics
    /// Then the evaluation does, without a word.
    pub(crate) fn begin(operations: usize) {
        WAITING.set(None);
        OTHER.set(None);
        LEFT.set(operations);
    }

    fn here(&self, operation: Operation, at: &'static Location<'static>) -> bool {
        match LEFT.get() {
            0 => resume_unwind(Box::new("no end in sight")),
            left => LEFT.set(left - 1),
        }
        self.site == Some(Site { operation, at })
    }

    /// Writes down what came out of two numbers.
    fn saw(site: Site, numbers: [f64; 2], value: f64) {
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

    /// An operation on two numbers, or a function of the first.
    pub(crate) fn done(&self, operation: Operation, a: f64, b: f64, at: &'static Location<'static>) -> f64 {
        if self.how == How::Observed {
            Fault::saw(Site { operation, at }, [a, b], operation.of(a, b));
        }
        if let How::Other(_, Origin { site, place }) = self.how
            && site == (Site { operation, at })
        {
            OTHER.set(Some([a, b, operation.of(a, b)][place]));
        }
        if !self.here(operation, at) {
            return self.caught_up(operation, a, b).unwrap_or_else(|| operation.of(a, b));
        }
        let right = operation.of(a, b);
        let wait = |meant: f64| {
            let shown = meant.next_up();
            WAITING.set(Some(Waiting { shown, meant, numbers: [a, b] }));
            shown
        };
        match self.how {
            How::Observed | How::Without(_) | How::Less(_) => right,
            How::First => a,
            How::Second => b,
            How::Done(other) => other.of(a, b),
            How::Crossed(other) => other.of(b, a),
            How::Exchanged => operation.of(b, a),
            How::Opposite => -right,
            How::OfOpposite => operation.of(-a, b),
            How::Squared => right * right,
            How::Root => right.sqrt(),
            How::PlusInside(0, k) => operation.of(a + k, b),
            How::PlusInside(_, k) => operation.of(a, b + k),
            How::SquaredInside(0) => operation.of(a * a, b),
            How::SquaredInside(_) => operation.of(a, b * b),
            How::RootInside(0) => operation.of(a.sqrt(), b),
            How::RootInside(_) => operation.of(a, b.sqrt()),
            How::Both(0) => operation.of(a, a),
            How::Both(_) => operation.of(b, b),
            How::Other(0, _) => operation.of(OTHER.get().unwrap_or(a), b),
            How::Other(..) => operation.of(a, OTHER.get().unwrap_or(b)),
            How::Halved => 0.5 * right,
            How::Doubled => 2.0 * right,
            How::Taken(x) => x,
            How::Times(k) => k * right,
            How::Plus(k) => right + k,
            How::SecondOutside => wait(a),
            How::FirstOutside => wait(b),
            How::Wider => wait(right),
        }
    }

    /// What an operation gives that takes what is waiting, or nothing.
    fn caught_up(&self, operation: Operation, a: f64, b: f64) -> Option<f64> {
        let waiting = WAITING.get()?;
        let first = a == waiting.shown;
        if !first && b != waiting.shown {
            return None;
        }
        let [a, b] = [a, b].map(|x| if x == waiting.shown { waiting.meant } else { x });
        let [one, two] = waiting.numbers;
        let own = self.site?.operation;
        let found = match (self.how, operation) {
            // The number comes after the operation, not before.
            (How::SecondOutside, Operation::Mul | Operation::Div | Operation::Sqrt | Operation::Neg) => {
                own.of(operation.of(a, b), two)
            }
            (How::FirstOutside, Operation::Mul | Operation::Div | Operation::Sqrt | Operation::Neg) => {
                own.of(one, operation.of(a, b))
            }
            // The sum is taken before the product or the quotient, not after.
            (How::Wider, Operation::Add | Operation::Sub) if first => own.of(operation.of(one, b), two),
            (How::Wider, Operation::Add | Operation::Sub) => own.of(operation.of(a, one), two),
            _ => return None,
        };
        WAITING.set(None);
        Some(found)
    }

    /// The terms of a sum.
    pub(crate) fn terms(
        &self,
        operation: Operation,
        terms: &[f64],
        at: &'static Location<'static>,
    ) -> Option<Vec<f64>> {
        let here = self.here(operation, at);
        let each = |change: fn(f64) -> f64, n: usize| {
            let one = |(i, x): (usize, &f64)| if i == n { change(*x) } else { *x };
            Some(terms.iter().enumerate().map(one).collect())
        };
        match self.how {
            How::Without(n) if here => each(|_| 0.0, n),
            How::Less(n) if here => each(|x| -x, n),
            _ => None,
        }
    }
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
