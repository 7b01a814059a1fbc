//! Layouts: the same numbers in another order. Found by assignment, reported, and passed.

use std::collections::BTreeMap;
use std::f64::consts::FRAC_1_PI;

use ndarray::{ArrayD, Axis};

use super::answer::{Answer, Answers};
use super::assignment::{admitted, assignments, holds, open, possible};
use super::diagnosis::fitted::written;
use super::diagnosis::hypothesis::Hypothesis;
use super::exam::Question;
use super::mark::MarkOptions;
use super::partial::apply;
use super::transposed::transposed;
use crate::contract::case::Case;
use crate::contract::check::{Kind, budget_used};
use crate::contract::component::Mistake;
use crate::contract::special::Chosen;
use crate::convention::Conventions;

/// Answers in another layout: right in it, or in one that their shapes show.
pub(crate) struct Arranged {
    /// In the contract's.
    pub answers: Answers,
    /// Theirs, in words.
    pub says: String,
    /// Where theirs is an order of columns.
    pub orders: Option<Orders>,
}

impl Arranged {
    fn new(answers: Answers, says: String) -> Arranged {
        Arranged { answers, says, orders: None }
    }
}

/// For each width of an input and of its encoding: the order of columns.
pub(crate) type Orders = BTreeMap<(usize, usize), Order>;

/// Columns in an order of their own.
pub(crate) struct Order {
    /// Which of theirs stands for each of ours.
    columns: Vec<usize>,
    /// Whether the answers fit no other order, but for columns that are the same function: their gradients are the same in any.
    only: bool,
}

/// The answers in the contract's layout; `None` if no layout makes them right, and none shows in their shapes. Numbers that programs choose for
/// themselves count as layout, where no profile is pinned that has chosen one.
pub(crate) fn normalized(
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    pinned: bool,
    options: &MarkOptions,
) -> Option<Arranged> {
    if question.kind == Kind::Vjp || question.statistics() {
        return None;
    }
    let turned = transposed(question, answers, base);
    let answers = turned.as_ref().map_or(answers, |(turned, _)| turned);
    let other = swapped(question, answers, base, options)
        .or_else(|| columns(question, answers, base, options))
        .or_else(|| (!pinned).then(|| chosen(question, answers, base, options))?);
    let Some((_, turned)) = &turned else { return other };
    let turns = format!("{}: the two axes are in each other's place", turned.join(", "));
    Some(match other {
        Some(other) => Arranged { says: format!("{turns}; {}", other.says), ..other },
        None => Arranged::new(answers.clone(), turns),
    })
}

/// A number that the program chooses for itself, replaced by that of a listed convention.
fn chosen(
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    options: &MarkOptions,
) -> Option<Arranged> {
    let chosen = question.component.special.chosen?;
    let less = chosen.less.map(Some).into_iter().chain([None]);
    let found = less.rev().find_map(|less| Some((less, replaced(question, answers, &chosen, less)?)));
    let (less, (listed, number)) = found?;
    let mut all = assignments(question.component, base).into_iter().map(|p| apply(&p, base));
    let right = all.any(|c| holds(question, &listed, &c, options));
    let taken_off = less.map_or(String::new(), |name| format!(" less {name}"));
    let says = format!("{}: {} is {number:e}{taken_off} in all cases", chosen.output, chosen.what);
    right.then(|| Arranged::new(listed, says))
}

/// The answers with the listed number in the place of the chosen one, and that; `None` where it isn't the same everywhere.
fn replaced(
    question: &Question,
    answers: &Answers,
    chosen: &Chosen,
    less: Option<&str>,
) -> Option<(Answers, f64)> {
    let (mut found, mut listed) = (None::<f64>, answers.clone());
    for (case, answer) in question.cases.iter().zip(&mut listed) {
        let Some(given) = answer.as_mut().and_then(|answer| answer.get_mut(chosen.output)) else { continue };
        let shape = given.values.shape().to_vec();
        for (index, value) in given.values.indexed_iter_mut() {
            let at = ndarray::Dimension::slice(&index);
            if at.len() != shape.len() || !(chosen.at)(at, &shape) {
                continue;
            }
            let taken_off = less.map_or(Some(&0.0), |name| case.inputs.get(name)?.get(&index));
            let number = *value + taken_off?;
            let same =
                |first: f64| first == number || less.is_some() && (first - number).abs() <= ROUNDED * first;
            // Everywhere the same, and no NaN. Nothing at all is no choice: it takes away what stands there.
            if !same(*found.get_or_insert(number)) || *value <= 0.0 {
                return None;
            }
            *value = chosen.listed;
        }
    }
    let number = found?;
    // What it was before something was taken off it has fewer digits.
    let written = format!("{number:.4e}").parse().unwrap_or(number);
    Some((listed, if less.is_some() { written } else { number }))
}

/// What is left of a number's digits where something small was taken off it in single precision.
const ROUNDED: f64 = 1e-6;

/// Two outputs of the same shape exchanged, as (d, o) for (o, d).
fn swapped(
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    options: &MarkOptions,
) -> Option<Arranged> {
    let outputs = question.component.outputs;
    let pairs = outputs.iter().enumerate().flat_map(|(n, a)| outputs[n + 1..].iter().map(move |b| (a, b)));
    let pairs: Vec<_> = pairs.filter(|(a, b)| a.shape == b.shape).map(|(a, b)| (a.name, b.name)).collect();
    if pairs.is_empty() {
        return None;
    }
    // What stays in its place shows its conventions once for all pairs.
    let (all, shown) = (admitted(question, base), open(question, answers, base, options));
    let untouched = question.component.special.untouched;
    for (a, b) in pairs {
        let all = if untouched.contains(&a) || untouched.contains(&b) { &all } else { &shown };
        let change = |answer: &Option<Answer>| answer.as_ref().map(|answer| exchange(answer, a, b));
        let exchanged: Answers = answers.iter().map(change).collect();
        let right = possible(question, &exchanged, all.clone(), base, options)
            .iter()
            .any(|p| holds(question, &exchanged, &apply(p, base), options));
        if right {
            let says = format!("{a} and {b} are in each other's place");
            return Some(Arranged::new(exchanged, says));
        }
    }
    None
}

/// The answer with two outputs' names exchanged.
fn exchange(answer: &Answer, a: &str, b: &str) -> Answer {
    let rename = |name: &String| match name.as_str() {
        name if name == a => b.to_string(),
        name if name == b => a.to_string(),
        name => name.to_string(),
    };
    answer.iter().map(|(name, given)| (rename(name), given.clone())).collect()
}

/// Columns of an encoding in an order that no convention names: one permutation for each width. Where none makes the answers right, one
/// that makes them those of a mistake: what is wrong in them is found in the contract's order.
fn columns(
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    options: &MarkOptions,
) -> Option<Arranged> {
    let (key, value) = question.component.special.columns?;
    let name = question.component.outputs[0].name;
    let home = assignments(question.component, base).into_iter().filter(|p| p.get(key) == Some(&value));
    let home: Vec<Conventions> = home.map(|p| apply(&p, base)).collect();
    let forward = question.component.mistakes.iter().filter(|m| !m.gradient);
    let numbered = |m: &'static Mistake| written(m).map(move |x| (vec![m.name], vec![x]));
    let wrong = forward.flat_map(|m| std::iter::once((vec![m.name], vec![])).chain(numbered(m)));
    let all = std::iter::once((vec![], vec![])).chain(wrong);
    let tried = all.flat_map(|(wrong, fitted)| {
        home.iter().map(move |c| Hypothesis { fitted: fitted.clone(), ..Hypothesis::new(wrong.clone(), *c) })
    });
    let found = tried.into_iter().find_map(|h| {
        let orders = orders(question, answers, name, &h, options)?;
        // The contract's: what is wrong with it is no matter of layout.
        if orders.values().all(|order| order.columns.is_sorted()) {
            return Some(None);
        }
        let mut ordered = answers.clone();
        for (case, answer) in question.cases.iter().zip(&mut ordered) {
            let given = answer.as_mut()?.get_mut(name)?;
            given.values = given.values.select(Axis(1), &orders[&shape(case, &given.values)].columns);
        }
        let explained = |(case, answer): (&Case, &Option<Answer>)| {
            answer.as_ref().is_some_and(|answer| h.explains(question, case, answer, options))
        };
        let fits = match h.right() {
            true => holds(question, &ordered, &h.conventions, options),
            false => question.cases.iter().zip(&ordered).all(explained),
        };
        fits.then(|| {
            let widest = orders.values().map(|order| &order.columns);
            let widest = widest.max_by_key(|columns| columns.len()).expect("there are cases");
            let says = format!("{name}: columns in an order of their own, {widest:?} of theirs in ours");
            Some(Arranged { orders: Some(orders), ..Arranged::new(ordered, says) })
        })
    });
    found.flatten()
}

/// Width of the input and of the encoding.
fn shape(case: &Case, encoding: &ArrayD<f64>) -> (usize, usize) {
    let x = case.inputs.iter().find(|(name, a)| a.ndim() == 2 && !name.starts_with("grad_"));
    let x = x.map_or(0, |(_, a)| a.shape()[1]);
    (x, encoding.shape().get(1).copied().unwrap_or(0))
}

/// Where each case's columns lie, if they are the predicted ones in one order for each width.
fn orders(
    question: &Question,
    answers: &Answers,
    name: &str,
    h: &Hypothesis,
    options: &MarkOptions,
) -> Option<Orders> {
    let mut fits: BTreeMap<(usize, usize), Fits> = BTreeMap::new();
    for (case, answer) in question.cases.iter().zip(answers) {
        let got = &answer.as_ref()?.get(name)?.values;
        let (expected, bound) = h.allowed(question, case, options);
        let (expected, bound) = (&expected[name], &bound[name]);
        if got.shape() != expected.shape() || got.ndim() != 2 {
            return None;
        }
        let all = vec![vec![true; got.shape()[1]]; got.shape()[1]];
        let new = || Fits { table: all.clone(), same: all };
        let Fits { table, same } = fits.entry(shape(case, got)).or_insert_with(new);
        for (ours, row) in table.iter_mut().enumerate() {
            let (e, b) = (expected.index_axis(Axis(1), ours), bound.index_axis(Axis(1), ours));
            for (theirs, fits) in row.iter_mut().enumerate().filter(|(_, fits)| **fits) {
                let g = got.index_axis(Axis(1), theirs);
                *fits = g.iter().zip(&e).zip(&b).all(|((&g, &e), &b)| budget_used(g, e, b) <= 1.0);
            }
            // A column that nothing of theirs is, as in most orders that are tried.
            if !row.contains(&true) {
                return None;
            }
        }
        let elsewhere = &h.prediction(question, &moved(question, case)).0[name];
        for (ours, row) in same.iter_mut().enumerate() {
            let of = |column| elsewhere.index_axis(Axis(1), column);
            let alike = |other| ours == other || !elsewhere.is_empty() && of(ours) == of(other);
            row.iter_mut().enumerate().for_each(|(other, same)| *same &= alike(other));
        }
    }
    let order = |fits: Fits| matching(&fits.table, &fits.same);
    fits.into_iter().map(|(shape, fits)| order(fits).map(|order| (shape, order))).collect()
}

/// What is known of the columns of one width.
struct Fits {
    /// Whether a column of theirs may be one of ours.
    table: Vec<Vec<bool>>,
    /// Whether two of ours are the same function.
    same: Vec<Vec<bool>>,
}

/// The case with its points, the first of the inputs, elsewhere, each coordinate by another step: columns that are the same there too are the
/// same function.
fn moved(question: &Question, case: &Case) -> Case {
    let mut case = case.clone();
    let points = case.inputs.get_mut(question.component.inputs[0].name);
    let each = points.expect("an input").iter_mut().enumerate();
    each.for_each(|(n, x)| *x += (n + 1) as f64 * FRAC_1_PI);
    case
}

/// A perfect matching of rows to columns (Kuhn's augmenting paths).
fn matching(table: &[Vec<bool>], same: &[Vec<bool>]) -> Option<Order> {
    // What may stay where it is does.
    let mut row_of: Vec<Option<usize>> = (0..table.len()).map(|n| table[n][n].then_some(n)).collect();
    for row in (0..table.len()).filter(|&n| !table[n][n]) {
        if !augment(table, row, &mut row_of, &mut vec![false; table.len()]) {
            return None;
        }
    }
    let mut columns = vec![0; table.len()];
    let matched = row_of.iter().map(|row| row.expect("the matching is perfect"));
    matched.enumerate().for_each(|(column, row)| columns[row] = column);
    // There is another one where rows can pass their columns on in a ring.
    let mut left: Vec<usize> = (0..table.len()).collect();
    let ends = |left: &[usize]| {
        let passes =
            |row: usize, other: usize| table[row][columns[other]] && row != other && !same[row][other];
        left.iter().position(|&row| !left.iter().any(|&other| passes(row, other)))
    };
    while let Some(end) = ends(&left) {
        left.swap_remove(end);
    }
    Some(Order { columns, only: left.is_empty() })
}

fn augment(table: &[Vec<bool>], row: usize, row_of: &mut [Option<usize>], seen: &mut [bool]) -> bool {
    for column in 0..table.len() {
        if table[row][column] && !seen[column] {
            seen[column] = true;
            if row_of[column].is_none_or(|other| augment(table, other, row_of, seen)) {
                row_of[column] = Some(row);
                return true;
            }
        }
    }
    false
}

/// The gradient's question with its cotangents in the order of columns that the forward answers have: who arranges an encoding in an order
/// of their own is given the gradient with respect to that. Cases of a width whose order the forward answers don't show are left out.
pub(crate) fn asked_in(question: &Question, answers: &Answers, orders: &Orders) -> (Question, Answers) {
    let name = format!("grad_{}", question.component.outputs[0].name);
    let (mut asked, mut left) = (Question { cases: vec![], ..question.clone() }, vec![]);
    for (case, answer) in question.cases.iter().zip(answers) {
        let (mut case, g) = (case.clone(), &case.inputs[&name]);
        match orders.get(&shape(&case, g)).filter(|order| order.only) {
            Some(order) => {
                let ordered = g.select(Axis(1), &order.columns);
                case.inputs.insert(name.clone(), ordered);
            }
            // A crash is one in any order.
            None if question.crashed.contains_key(&case.id) => {}
            None => {
                let needs = "an order of columns that forward answers of their width show";
                asked.left_out.insert(case.id, needs.into());
                continue;
            }
        }
        asked.cases.push(case);
        left.push(answer.clone());
    }
    (asked, left)
}

#[cfg(test)]
mod tests {
    /// No two columns are the same function.
    fn apart(table: &[Vec<bool>]) -> Vec<Vec<bool>> {
        (0..table.len()).map(|a| (0..table.len()).map(|b| a == b).collect()).collect()
    }

    #[test]
    fn a_matching_takes_back_what_it_gave() {
        let matching = |table: &[Vec<bool>]| super::matching(table, &apart(table));
        let table = [vec![true, true, false], vec![true, false, false], vec![false, true, true]];
        assert_eq!(matching(&table).map(|order| (order.columns, order.only)), Some((vec![1, 0, 2], true)));
        let stays = [vec![true, true], vec![true, true]];
        assert_eq!(matching(&stays).map(|order| order.columns), Some(vec![0, 1]));
        assert!(matching(&[vec![true, false], vec![true, false]]).is_none());
    }

    #[test]
    fn rows_that_can_change_places_have_more_than_one_order() {
        let only = |table: &[Vec<bool>]| super::matching(table, &apart(table)).map(|order| order.only);
        assert_eq!(only(&[vec![true, true], vec![true, true]]), Some(false));
        assert_eq!(only(&[vec![true, true], vec![false, true]]), Some(true));
        // A ring of three.
        let ring = [vec![true, true, false], vec![false, true, true], vec![true, false, true]];
        assert_eq!(only(&ring), Some(false));
        assert_eq!(only(&[]), Some(true));
        // Two columns that are the same function.
        let (table, same) = (vec![vec![true; 2]; 2], vec![vec![true; 2]; 2]);
        assert!(super::matching(&table, &same).is_some_and(|order| order.only));
    }
}
