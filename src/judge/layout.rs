//! Layouts: the same numbers in another order. Found by assignment, reported, and passed.

use std::collections::BTreeMap;

use ndarray::{ArrayD, Axis};

use super::answer::{Answer, Answers};
use super::assignment::{admitted, assignments, holds, open, possible};
use super::exam::Question;
use super::mark::MarkOptions;
use super::partial::apply;
use crate::contract::arithmetic::Grade;
use crate::contract::case::Case;
use crate::contract::check::{Kind, budget_used};
use crate::convention::Conventions;

/// The answers in the contract's layout, and a description of theirs; `None` if no layout makes them right. Numbers that programs choose
/// for themselves count as layout, where no profile is pinned that has chosen one.
pub(crate) fn normalized(
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    pinned: bool,
    options: &MarkOptions,
) -> Option<(Answers, String)> {
    if question.kind == Kind::Vjp || question.statistics() {
        return None;
    }
    swapped(question, answers, base, options)
        .or_else(|| columns(question, answers, base, options))
        .or_else(|| (!pinned).then(|| chosen(question, answers, base, options))?)
}

/// A number that the program chooses for itself, replaced by that of a listed convention.
fn chosen(
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    options: &MarkOptions,
) -> Option<(Answers, String)> {
    let chosen = question.component.special.chosen?;
    let mut found = None;
    let mut listed = answers.clone();
    for given in listed.iter_mut().flatten().filter_map(|answer| answer.get_mut(chosen.output)) {
        let shape = given.values.shape().to_vec();
        for (index, value) in given.values.indexed_iter_mut() {
            let index = ndarray::Dimension::slice(&index);
            if index.len() != shape.len() || !(chosen.at)(index, &shape) {
                continue;
            }
            // Everywhere the same, and no NaN. Nothing at all is no choice: it takes away what stands there.
            if *found.get_or_insert(*value) != *value || *value <= 0.0 {
                return None;
            }
            *value = chosen.listed;
        }
    }
    let mut all = assignments(question.component, base).into_iter().map(|p| apply(&p, base));
    let right = all.any(|c| holds(question, &listed, &c, options));
    right
        .then(|| Some((listed, format!("{}: {} is {:e} in all cases", chosen.output, chosen.what, found?))))?
}

/// Two outputs of the same shape exchanged, as (d, o) for (o, d).
fn swapped(
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    options: &MarkOptions,
) -> Option<(Answers, String)> {
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
            return Some((exchanged, format!("{a} and {b} are in each other's place")));
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

/// Columns of an encoding in an order that no convention names: one permutation for each width.
fn columns(
    question: &Question,
    answers: &Answers,
    base: &Conventions,
    options: &MarkOptions,
) -> Option<(Answers, String)> {
    let (key, value) = question.component.special.columns?;
    let name = question.component.outputs[0].name;
    let home = assignments(question.component, base);
    for p in home.iter().filter(|p| p.get(key) == Some(&value)) {
        let c = apply(p, base);
        let Some(permutations) = permutations(question, answers, name, &c, options) else { continue };
        let mut ordered = answers.clone();
        for (case, answer) in question.cases.iter().zip(&mut ordered) {
            let given = answer.as_mut()?.get_mut(name)?;
            given.values = given.values.select(Axis(1), &permutations[&shape(case, &given.values)]);
        }
        if holds(question, &ordered, &c, options) {
            let widest = permutations.values().max_by_key(|order| order.len()).expect("there are cases");
            return Some((
                ordered,
                format!("{name}: columns in an order of their own, {widest:?} of theirs in ours"),
            ));
        }
    }
    None
}

/// Width of the input and of the encoding.
fn shape(case: &Case, encoding: &ArrayD<f64>) -> (usize, usize) {
    let x = case.inputs.values().find(|a| a.ndim() == 2).map_or(0, |a| a.shape()[1]);
    (x, encoding.shape().get(1).copied().unwrap_or(0))
}

/// For each width: which of their columns stands for each of ours.
fn permutations(
    question: &Question,
    answers: &Answers,
    name: &str,
    c: &Conventions,
    options: &MarkOptions,
) -> Option<BTreeMap<(usize, usize), Vec<usize>>> {
    let mut fits: BTreeMap<(usize, usize), Vec<Vec<bool>>> = BTreeMap::new();
    for (case, answer) in question.cases.iter().zip(answers) {
        let got = &answer.as_ref()?.get(name)?.values;
        let truth = options.truth(question, case, c, Grade::B);
        let (expected, bound) = (&truth.expected[name], &truth.bound[name]);
        if got.shape() != expected.shape() || got.ndim() != 2 {
            return None;
        }
        let width = got.shape()[1];
        let table = fits.entry(shape(case, got)).or_insert_with(|| vec![vec![true; width]; width]);
        for (ours, row) in table.iter_mut().enumerate() {
            let (e, b) = (expected.index_axis(Axis(1), ours), bound.index_axis(Axis(1), ours));
            for (theirs, fits) in row.iter_mut().enumerate().filter(|(_, fits)| **fits) {
                let g = got.index_axis(Axis(1), theirs);
                *fits = g.iter().zip(&e).zip(&b).all(|((&g, &e), &b)| budget_used(g, e, b) <= 1.0);
            }
        }
    }
    fits.into_iter().map(|(shape, table)| matching(&table).map(|order| (shape, order))).collect()
}

/// A perfect matching of rows to columns (Kuhn's augmenting paths).
fn matching(table: &[Vec<bool>]) -> Option<Vec<usize>> {
    let mut row_of: Vec<Option<usize>> = vec![None; table.len()];
    for row in 0..table.len() {
        if !augment(table, row, &mut row_of, &mut vec![false; table.len()]) {
            return None;
        }
    }
    let mut order = vec![0; table.len()];
    row_of.iter().enumerate().for_each(|(column, row)| order[row.expect("the matching is perfect")] = column);
    Some(order)
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

#[cfg(test)]
mod tests {
    #[test]
    fn a_matching_takes_back_what_it_gave() {
        let table = [vec![true, true, false], vec![true, false, false], vec![false, true, true]];
        assert_eq!(super::matching(&table), Some(vec![1, 0, 2]));
        assert_eq!(super::matching(&[vec![true, false], vec![true, false]]), None);
    }
}
