//! The changes of an array that are tried, by its shape.

use super::super::super::answer::Answer;
use super::each::{By, EACH};
use super::slip::{ALONG, Change, turned};
use crate::contract::arrays::Arrays;
use crate::contract::case::Case;

/// Axes at most this long are taken for components: red, green, blue; x, y, z.
pub(super) const SHORT: usize = 4;

/// What happens to single entries of matrices, of [`EACH`]: they are left out, or have the other sign.
const CELL: [usize; 2] = [0, 1];

/// What can happen along the axes of an array of this shape.
pub(super) fn of_axes(shape: &[usize]) -> Vec<Change> {
    let mut all = vec![];
    for axis in (0..shape.len()).rev() {
        all.extend((0..ALONG.len()).map(|n| Change::Along(n, axis)));
        if shape[axis] <= SHORT {
            for i in 0..shape[axis] {
                all.extend((i + 1..shape[axis]).map(|j| Change::Exchanged(axis, i, j)));
                all.push(Change::Opposite(axis, i));
            }
        }
        all.extend((0..axis).filter(|b| shape[*b] == shape[axis]).map(|b| Change::Transposed(b, axis)));
        all.extend((axis > 0).then(|| Change::Refolded(axis - 1, axis)));
    }
    // What happens to one component alone comes after what happens to all.
    let short = (0..shape.len()).filter(|axis| shape[*axis] <= SHORT && shape[*axis] > 1);
    for (axis, element) in short.flat_map(|axis| (0..shape[axis]).map(move |element| (axis, element))) {
        all.extend((0..EACH.len()).map(|n| Change::One { axis, element, by: By::Each(n) }));
        let others = (0..shape[axis]).filter(|to| *to != element);
        all.extend(others.map(|to| Change::Twice { axis, from: element, to }));
    }
    let frames = (0..shape.len()).filter(|axis| (3..=SHORT).contains(&shape[*axis]));
    all.extend(frames.flat_map(|axis| turned().map(move |n| Change::Turned(axis, n))));
    if let [.., rows, columns] = *shape
        && rows.max(columns) <= SHORT
        && rows.min(columns) > 1
    {
        let places = (0..rows * columns).flat_map(|n| CELL.map(|by| ([n / columns, n % columns], by)));
        all.extend(places.map(|(at, by)| Change::Cell { at, by: By::Each(by) }));
    }
    if let [rows, columns] = *shape
        && rows.max(columns) <= SHORT
    {
        let places = || (0..rows * columns).map(|n| [n / columns, n % columns]);
        let pairs = places().flat_map(|from| places().map(move |to| (from, to)));
        all.extend(pairs.filter(|(a, b)| a != b).map(|(from, to)| Change::Entry { from, to }));
    }
    all
}

/// Means that are sums, and sums that are means, over any axis of an input.
pub(super) fn lengths(inputs: &Arrays) -> Vec<Change> {
    let axes = inputs.iter().flat_map(|(name, a)| (0..a.ndim()).map(move |axis| (name, axis)));
    let both = |(name, axis): (&String, usize)| {
        [false, true].map(|over| Change::Length { input: name.clone(), axis, over })
    };
    axes.flat_map(both).collect()
}

/// Orders of an output's last axis whose groups are as long as an axis of an input, in any case.
pub(super) fn groups(output: &str, cases: &[(&Case, &Answer)]) -> Vec<Change> {
    let mut all = vec![];
    for (case, answer) in cases {
        let n = answer.get(output).and_then(|given| given.values.shape().last().copied()).unwrap_or(0);
        let axes =
            case.inputs.iter().flat_map(|(name, a)| a.shape().iter().enumerate().map(move |x| (name, x)));
        for (input, (axis, _)) in
            axes.filter(|(_, (_, group))| **group > 1 && **group < n && n % **group == 0)
        {
            let both = [false, true].map(|back| Change::Regrouped { input: input.clone(), axis, back });
            all.extend(both.into_iter().filter(|change| !all.contains(change)).collect::<Vec<_>>());
        }
    }
    all
}
