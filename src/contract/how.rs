//! In which other ways an operation can be done.

use super::operation::Operation;
use super::site::Origin;

/// In which other way it is done. The likelier come first in [`How::all`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum How {
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

/// Terms of a sum that may be left out, one at a time.
const TERMS: usize = 6;

impl How {
    /// Whether what comes out depends on what is done next.
    pub(crate) fn of_parenthesis(self) -> bool {
        matches!(self, How::FirstOutside | How::SecondOutside | How::Wider)
    }

    /// Whether it takes other operations' numbers, or changes what they do.
    pub(super) fn asks_more(self) -> bool {
        self.of_parenthesis() || matches!(self, How::Other(..))
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
