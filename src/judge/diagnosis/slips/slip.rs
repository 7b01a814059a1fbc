//! Slips: simple things that happen to one array and that no catalogue can list for every component: an input that is taken for its
//! running sum, normalized first, or for another one of its shape; an output that is halved, reversed or clamped.

use ndarray::{ArrayD, Axis, IxDyn};

use super::columns::{Changed, regrouped};
use super::each::{By, EACH};
use super::formula_slip::FormulaSlip;
use crate::contract::arrays::Arrays;
use crate::contract::component::Component;

/// What happens to an array.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Change {
    /// Each element by itself.
    All(By),
    /// Times the length of another array's axis (of an input), or over it.
    Length { input: String, axis: usize, over: bool },
    /// All elements along an axis together, by their place in [`ALONG`].
    Along(usize, usize),
    /// Two elements of a short axis are exchanged.
    Exchanged(usize, usize, usize),
    /// One element of a short axis has the other sign.
    Opposite(usize, usize),
    /// One element of a short axis alone.
    One { axis: usize, element: usize, by: By },
    /// One element of a short axis is taken for another, too.
    Twice { axis: usize, from: usize, to: usize },
    /// One entry of every small matrix alone, by its row and column.
    Cell { at: [usize; 2], by: By },
    /// One entry of a small matrix is taken for another, too: c_x for c_y.
    Entry { from: [usize; 2], to: [usize; 2] },
    /// The first three elements of a short axis are others of them, with either sign: another frame's x, y, z. By [`frame`].
    Turned(usize, usize),
    /// The last axis has another order: what went by an input's axis last goes by it first, or (`back`) the other way around.
    Regrouped { input: String, axis: usize, back: bool },
    /// Some elements of a long axis.
    Columns(Changed),
    /// Two axes are exchanged, of the same length.
    Transposed(usize, usize),
    /// The numbers of two axes are read as if the other of them were the first: (N, R) for (R, N), without moving any.
    Refolded(usize, usize),
    /// Another array stands in its place.
    Other(String),
}

/// All elements along an axis.
pub(crate) const ALONG: &[(&str, fn(&[f64]) -> Vec<f64>)] = &[
    ("divided by its length", |x| over(x, x.iter().map(|x| x * x).sum::<f64>().sqrt())),
    ("divided by its sum", |x| over(x, x.iter().sum())),
    ("taken for its running sum", |x| running(x, 0.0, |sum, x| sum + x)),
    ("taken for its running sum without the element itself", |x| {
        later(&running(x, 0.0, |sum, x| sum + x), 0.0)
    }),
    ("taken for its running product", |x| running(x, 1.0, |product, x| product * x)),
    ("taken for its differences", |x| x.iter().zip(later(x, 0.0)).map(|(x, before)| x - before).collect()),
    ("moved one on, with 0 in front", |x| later(x, 0.0)),
    ("moved one on, with the first twice", |x| later(x, x[0])),
    ("moved one on, around the end", |x| later(x, x[x.len() - 1])),
    ("moved one back, with 0 behind", |x| earlier(x, 0.0)),
    ("moved one back, with the last twice", |x| earlier(x, x[x.len() - 1])),
    ("moved one back, around the end", |x| earlier(x, x[0])),
    ("back to front", |x| x.iter().rev().copied().collect()),
    ("mapped to [0, 1] from its first to its last", |x| {
        over(&x.iter().map(|y| y - x[0]).collect::<Vec<_>>(), x[x.len() - 1] - x[0])
    }),
    ("taken for its mean", |x| vec![x.iter().sum::<f64>() / x.len() as f64; x.len()]),
    ("taken for its first element for all", |x| vec![x[0]; x.len()]),
    ("taken for its last element for all", |x| vec![x[x.len() - 1]; x.len()]),
    ("without its last element", |x| [&x[..x.len() - 1], &[0.0]].concat()),
    ("without its first element", |x| [&[0.0], &x[1..]].concat()),
];

/// 0 stays 0: whoever divides by a sum sees to that.
fn over(x: &[f64], by: f64) -> Vec<f64> {
    x.iter().map(|&x| if x == 0.0 { 0.0 } else { x / by }).collect()
}

fn running(x: &[f64], start: f64, next: fn(f64, f64) -> f64) -> Vec<f64> {
    let step = |state: &mut f64, x: &f64| {
        *state = next(*state, *x);
        Some(*state)
    };
    x.iter().scan(start, step).collect()
}

fn later(x: &[f64], first: f64) -> Vec<f64> {
    [&[first], &x[..x.len() - 1]].concat()
}

fn earlier(x: &[f64], last: f64) -> Vec<f64> {
    [&x[1..], &[last]].concat()
}

/// What another formula begins with, in reports for machines too.
const OTHER_FORMULA: &str = "another formula: ";

/// What no catalogue lists.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Slip {
    /// It happens to an array.
    Array(ArraySlip),
    /// It happens to an operation of the formula.
    Formula(FormulaSlip),
    /// The formula is another one.
    Law(LawSlip),
}

/// Another formula of the row's family.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LawSlip {
    /// Its choice of every part.
    pub choices: Vec<usize>,
    /// What it says, on a line.
    pub said: String,
    /// Whether it rounds to whole numbers.
    pub rounds: bool,
    /// Whether it is one of the forward function, also where a gradient is asked for.
    pub forward: bool,
}

impl LawSlip {
    /// The formulas without one of its parts, each beside that part, where it differs from the right one in several.
    pub(crate) fn without_each(&self) -> Vec<(usize, LawSlip)> {
        let wrong: Vec<usize> = (0..self.choices.len()).filter(|part| self.choices[*part] > 0).collect();
        let without = |part: &usize| {
            let mut law = self.clone();
            law.choices[*part] = 0;
            (*part, law)
        };
        if wrong.len() > 1 { wrong.iter().map(without).collect() } else { vec![] }
    }

    /// Says of one of its parts that few numbers show it.
    pub(crate) fn hardly_shown(&mut self, part: usize, component: &Component) {
        let Some(laws) = component.special.laws_of(self.forward) else { return };
        let mut others = self.choices.clone();
        others[part] = 0;
        let said = (laws.says)(part, self.choices[part]);
        self.said = format!("{}; and probably {said}, which few numbers show", laws.said(&others));
    }
}

impl Slip {
    /// Whether it is one of the forward function, also where a gradient is asked for.
    pub(crate) fn forward(&self) -> bool {
        match self {
            Slip::Array(slip) => slip.forward,
            Slip::Formula(slip) => slip.forward,
            Slip::Law(slip) => slip.forward,
        }
    }

    /// Whether an array is rounded to whole numbers.
    pub(crate) fn rounds(&self) -> bool {
        match self {
            Slip::Array(slip) => slip.change.rounds(),
            Slip::Formula(_) => false,
            Slip::Law(slip) => slip.rounds,
        }
    }

    /// What it says, on a line.
    pub(crate) fn says(&self) -> String {
        match self {
            Slip::Array(slip) => slip.says(),
            Slip::Formula(slip) => slip.says(),
            Slip::Law(slip) => format!("{OTHER_FORMULA}{}", slip.said),
        }
    }

    /// The same with what it is.
    pub(crate) fn named(&self) -> String {
        match self {
            Slip::Law(_) => self.says(),
            _ => format!("a slip: {}", self.says()),
        }
    }
}

/// What happens to an input, or to an output.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ArraySlip {
    /// Whether it is an input.
    pub input: bool,
    /// Name of the array.
    pub array: String,
    /// What happens to it.
    pub change: Change,
    /// Whether it is one of the forward function, also where a gradient is asked for.
    pub forward: bool,
}

impl ArraySlip {
    /// The inputs as they are used.
    pub(crate) fn on_inputs(&self, inputs: &Arrays) -> Arrays {
        let mut changed = inputs.clone();
        if self.input && inputs.contains_key(&self.array) {
            changed.insert(self.array.clone(), self.change.of(&self.array, inputs, inputs));
        }
        changed
    }

    /// The outputs as they are answered.
    pub(crate) fn on_outputs(&self, inputs: &Arrays, outputs: Arrays) -> Arrays {
        let mut changed = outputs;
        if !self.input && changed.contains_key(&self.array) {
            let array = self.change.of(&self.array, &changed, inputs);
            changed.insert(self.array.clone(), array);
        }
        changed
    }

    /// What it says, on a line.
    pub(crate) fn says(&self) -> String {
        let name = &self.array;
        match &self.change {
            Change::All(by) => format!("{name} {}", by.says()),
            Change::Length { input, axis, over } => {
                let word = if *over { "over" } else { "times" };
                format!(
                    "{name} {word} the length of axis {axis} of {input}: a mean is a sum, or a sum a mean"
                )
            }
            Change::Along(n, axis) => format!("{name} {}, along axis {axis}", ALONG[*n].0),
            Change::Exchanged(axis, i, j) => {
                format!("{name} with elements {i} and {j} of axis {axis} exchanged")
            }
            Change::Opposite(axis, i) => {
                format!("{name} with the other sign in element {i} of axis {axis}")
            }
            Change::One { axis, element, by } => {
                format!("element {element} of axis {axis} of {name} {}", by.says())
            }
            Change::Twice { axis, from, to } => {
                format!("element {from} of axis {axis} of {name} in the place of element {to}")
            }
            Change::Cell { at, by } => format!("entry {at:?} of {name} {}", by.says()),
            Change::Entry { from, to } => format!("{name}{from:?} in the place of {name}{to:?}"),
            Change::Turned(axis, n) => {
                let [x, y, z] = frame(*n).map(|(from, sign)| format!("{sign}{}", ['x', 'y', 'z'][from]));
                format!("{name} with x, y, z of axis {axis} taken for {x}, {y}, {z}")
            }
            Change::Regrouped { input, axis, back } => {
                let by = format!("{name} with its last axis ordered by axis {axis} of {input}");
                if *back { format!("{by} at the end") } else { format!("{by} before all else") }
            }
            Change::Columns(changed) => changed.says(name),
            Change::Transposed(a, b) => format!("{name} with axes {a} and {b} exchanged"),
            Change::Refolded(a, b) => {
                format!(
                    "{name} read as if axis {b} came before axis {a}: reshaped where it should be transposed"
                )
            }
            Change::Other(other) => format!("{other} in the place of {name}"),
        }
    }
}

impl Change {
    fn rounds(&self) -> bool {
        match self {
            Change::All(by) | Change::One { by, .. } | Change::Cell { by, .. } => by.rounds(),
            _ => false,
        }
    }

    /// Whether it happens to one component of an array, not to all of it.
    pub(crate) fn of_one(&self) -> bool {
        self.rank() > 0
    }

    /// The likelier has the lower one, whichever array it happens to: what happens to one component may look like something else elsewhere.
    pub(crate) fn rank(&self) -> usize {
        match self {
            Change::One { by: By::Each(n), .. } | Change::Cell { by: By::Each(n), .. } => 1 + n,
            Change::One { .. }
            | Change::Cell { .. }
            | Change::Twice { .. }
            | Change::Entry { .. }
            | Change::Columns(_)
            | Change::Turned(..) => 1 + EACH.len(),
            _ => 0,
        }
    }

    /// What becomes of the array `name` among others.
    fn of(&self, name: &str, all: &Arrays, inputs: &Arrays) -> ArrayD<f64> {
        let x = &all[name];
        match self {
            Change::All(by) => x.mapv(|x| by.of(x)),
            Change::Length { input, axis, over } => {
                let length =
                    inputs.get(input).and_then(|a| a.shape().get(*axis)).copied().unwrap_or(1) as f64;
                x * if *over { 1.0 / length } else { length }
            }
            Change::Along(n, axis) => along(x, *axis, ALONG[*n].1),
            Change::Exchanged(axis, i, j) if x.ndim() > *axis && x.len_of(Axis(*axis)) > *j.max(i) => {
                let mut order: Vec<usize> = (0..x.len_of(Axis(*axis))).collect();
                order.swap(*i, *j);
                x.select(Axis(*axis), &order)
            }
            Change::Opposite(axis, i) if x.ndim() > *axis && x.len_of(Axis(*axis)) > *i => {
                let sign = |n: usize| if n == *i { -1.0 } else { 1.0 };
                let mut x = x.clone();
                for (n, mut part) in x.axis_iter_mut(Axis(*axis)).enumerate() {
                    part *= sign(n);
                }
                x
            }
            Change::One { axis, element, by } if x.ndim() > *axis && x.len_of(Axis(*axis)) > *element => {
                let mut x = x.clone();
                x.index_axis_mut(Axis(*axis), *element).mapv_inplace(|x| by.of(x));
                x
            }
            Change::Twice { axis, from, to } if x.ndim() > *axis && x.len_of(Axis(*axis)) > *from.max(to) => {
                let place = |n: usize| if n == *to { *from } else { n };
                x.select(Axis(*axis), &(0..x.len_of(Axis(*axis))).map(place).collect::<Vec<_>>())
            }
            Change::Cell { at, by } if x.ndim() > 1 => {
                let (mut x, rows) = (x.clone(), x.ndim() - 2);
                let there = |index: &IxDyn| ndarray::Dimension::slice(index)[rows..] == *at;
                x.indexed_iter_mut().filter(|(index, _)| there(index)).for_each(|(_, x)| *x = by.of(*x));
                x
            }
            Change::Entry { from, to } if x.get(&from[..]).is_some() && x.get(&to[..]).is_some() => {
                let mut x = x.clone();
                x[&to[..]] = x[&from[..]];
                x
            }
            Change::Turned(axis, n) if x.ndim() > *axis && x.len_of(Axis(*axis)) > 2 => {
                let mut turned = x.clone();
                for (to, (from, sign)) in frame(*n).into_iter().enumerate() {
                    let times = if sign == "-" { -1.0 } else { 1.0 };
                    let part = x.index_axis(Axis(*axis), from).mapv(|x| times * x);
                    turned.index_axis_mut(Axis(*axis), to).assign(&part);
                }
                turned
            }
            Change::Regrouped { input, axis, back } => {
                let group = inputs.get(input).and_then(|a| a.shape().get(*axis)).copied().unwrap_or(1);
                regrouped(x, group, *back)
            }
            Change::Columns(changed) => changed.of(x),
            Change::Transposed(a, b) if x.ndim() > *a.max(b) && x.shape()[*a] == x.shape()[*b] => {
                let mut x = x.clone();
                x.swap_axes(*a, *b);
                x.as_standard_layout().into_owned()
            }
            Change::Refolded(a, b) if x.ndim() > *b => refolded(x, *a, *b),
            Change::Other(other) => all.get(other).filter(|o| o.shape() == x.shape()).unwrap_or(x).clone(),
            _ => x.clone(),
        }
    }
}

/// Element (i, j) of two neighboring axes from where (j, i) of (J, I) is: numbers in their order, in another shape.
fn refolded(x: &ArrayD<f64>, a: usize, b: usize) -> ArrayD<f64> {
    let mut shape = x.shape().to_vec();
    shape.swap(a, b);
    let flat: Vec<f64> = x.iter().copied().collect();
    let mut other = ArrayD::from_shape_vec(shape, flat).expect("as many numbers");
    other.swap_axes(a, b);
    other.as_standard_layout().into_owned()
}

/// The n-th of the 48 frames whose axes are those of another one: where each comes from, and its sign.
fn frame(n: usize) -> [(usize, &'static str); 3] {
    let first = n % 3;
    let second = (first + 1 + n / 3 % 2) % 3;
    let sign = |k: usize| if (n / 6) >> k & 1 == 1 { "-" } else { "" };
    [(first, sign(0)), (second, sign(1)), (3 - first - second, sign(2))]
}

/// The frames that differ from one's own in more than a sign or two axes that are exchanged.
pub(crate) fn turned() -> impl Iterator<Item = usize> {
    (0..48).filter(|n| {
        let (from, moved) = (frame(*n), |(to, (from, _)): (usize, (usize, &str))| to != from);
        let signs = from.iter().filter(|(_, sign)| *sign == "-").count();
        let moved = from.into_iter().enumerate().filter(|x| moved(*x)).count();
        moved + signs > 1 && (moved, signs) != (2, 0)
    })
}

/// `f` of each line along an axis.
fn along(x: &ArrayD<f64>, axis: usize, f: fn(&[f64]) -> Vec<f64>) -> ArrayD<f64> {
    let mut x = x.clone();
    if x.ndim() <= axis || x.len_of(Axis(axis)) == 0 {
        return x;
    }
    for mut line in x.lanes_mut(Axis(axis)) {
        let changed = f(&line.to_vec());
        line.iter_mut().zip(changed).for_each(|(to, from)| *to = from);
    }
    x
}
