//! Operations of a formula that are done in another way: what code with a slip of the pen does. An honest implementation does all its
//! arithmetic with a [`Machine`](super::machine::Machine), which asks here, so that any operation of any component can be tried.

use std::cell::Cell;
use std::panic::{Location, resume_unwind};

use super::how::How;
use super::operation::Operation;
use super::seen::{self, Seen};
use super::site::Site;

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
    static LEFT: Cell<usize> = const { Cell::new(0) };
    static WAITING: Cell<Option<Waiting>> = const { Cell::new(None) };
    static OTHER: Cell<Option<f64>> = const { Cell::new(None) };
    static TIMES: Cell<[usize; AT_ONCE]> = const { Cell::new([0; AT_ONCE]) };
}

/// Which of the times that an evaluation comes by a site: one entry of every point's matrix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Nth {
    /// Counted from 0.
    pub index: usize,
    /// Of so many, again and again.
    pub of: usize,
}

/// An operation that is done in another way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Wrong {
    /// Where.
    pub site: Site,
    /// How.
    pub how: How,
    /// When, where it isn't each time.
    pub nth: Option<Nth>,
}

/// Operations that are done in another way at once, at most.
pub(crate) const AT_ONCE: usize = 3;

/// What is done in another way.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Fault {
    /// Each operation that is.
    pub wrong: [Option<Wrong>; AT_ONCE],
    /// Nothing; but the sites are written down.
    pub observed: bool,
}

impl Fault {
    /// What is wrong.
    pub(crate) fn all(&self) -> impl Iterator<Item = &Wrong> {
        self.wrong.iter().flatten()
    }

    /// These, as many as there is room for.
    pub(crate) fn of(all: impl IntoIterator<Item = Wrong>) -> Fault {
        all.into_iter().fold(Fault::default(), |fault, wrong| fault.with(wrong).unwrap_or(fault))
    }

    /// One operation more: elsewhere, where there is room, and where two don't ask for more than their own numbers.
    pub(crate) fn with(&self, wrong: Wrong) -> Option<Fault> {
        let clash = |had: &Wrong| had.site == wrong.site || had.how.asks_more() && wrong.how.asks_more();
        let mut more = *self;
        *more.wrong.iter_mut().find(|place| place.is_none())? = Some(wrong);
        (!self.all().any(clash)).then_some(more)
    }

    /// The sites that a function comes by.
    pub(crate) fn observed(function: impl FnOnce(Fault)) -> Vec<Seen> {
        seen::begin();
        Fault::begin(usize::MAX);
        function(Fault { observed: true, ..Fault::default() });
        seen::all()
    }

    /// A new evaluation begins, of at most so many operations: a loop whose numbers are wrong may have no end.
    ///
    /// # Panics
    /// Then the evaluation does, without a word.
    pub(crate) fn begin(operations: usize) {
        WAITING.set(None);
        OTHER.set(None);
        LEFT.set(operations);
        TIMES.set([0; AT_ONCE]);
    }

    /// What is done in another way here and now.
    fn here(&self, site: Site) -> Option<&Wrong> {
        match LEFT.get() {
            0 => resume_unwind(Box::new("no end in sight")),
            left => LEFT.set(left - 1),
        }
        let mut found = None;
        for (n, wrong) in self.wrong.iter().enumerate() {
            let Some(wrong) = wrong.as_ref().filter(|wrong| wrong.site == site) else { continue };
            if wrong.nth.is_none_or(|nth| nth.is_now(n, site.operation)) {
                found = Some(wrong);
            }
        }
        found
    }

    /// An operation on two numbers, or a function of the first.
    pub(crate) fn done(&self, operation: Operation, a: f64, b: f64, at: &'static Location<'static>) -> f64 {
        let site = Site { operation, at };
        if self.observed {
            seen::saw(site, [a, b], operation.of(a, b));
        }
        for wrong in self.all() {
            if let How::Other(_, origin) = wrong.how
                && origin.site == site
            {
                OTHER.set(Some([a, b, operation.of(a, b)][origin.place]));
            }
        }
        match self.here(site) {
            Some(wrong) => wrong.how.done(operation, a, b),
            None => self.caught_up(operation, a, b).unwrap_or_else(|| operation.of(a, b)),
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
        let wrong = self.all().find(|wrong| wrong.how.of_parenthesis())?;
        let own = wrong.site.operation;
        let found = match (wrong.how, operation) {
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
        let each = |change: fn(f64) -> f64, n: usize| {
            let one = |(i, x): (usize, &f64)| if i == n { change(*x) } else { *x };
            Some(terms.iter().enumerate().map(one).collect())
        };
        match self.here(Site { operation, at })?.how {
            How::Without(n) => each(|_| 0.0, n),
            How::Less(n) => each(|x| -x, n),
            _ => None,
        }
    }
}

impl How {
    /// The operation done in this way.
    fn done(self, operation: Operation, a: f64, b: f64) -> f64 {
        let right = operation.of(a, b);
        let wait = |meant: f64| {
            let shown = meant.next_up();
            WAITING.set(Some(Waiting { shown, meant, numbers: [a, b] }));
            shown
        };
        match self {
            How::Without(_) | How::Less(_) => right,
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
}

impl Nth {
    /// Whether it is this time, of the n-th that is wrong. A sum is asked twice: for its terms, and for what comes out.
    fn is_now(self, n: usize, operation: Operation) -> bool {
        let asked = if matches!(operation, Operation::Sum | Operation::Dot) { 2 } else { 1 };
        let mut times = TIMES.get();
        let now = times[n] / asked % self.of == self.index;
        times[n] += 1;
        TIMES.set(times);
        now
    }
}
