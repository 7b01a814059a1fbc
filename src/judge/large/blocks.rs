//! Whole answers, judged block by block: what is off, where first, and how it looks when it is asked alone.

use std::ops::Range;

use crate::contract::arithmetic::Grade;
use crate::contract::case::Case;
use crate::contract::laid::Laid;
use crate::convention::Conventions;
use crate::judge::answer::{Answer, Answers, Given, Reply, reshaped};
use crate::judge::exam::Question;
use crate::judge::layout;
use crate::judge::mark::{MarkOptions, Marks, mark};
use crate::judge::round::marks;
use crate::parallel;

/// Items that a failure is cut down to.
const CUT: usize = 3;

/// An answer to a large case: its arrays are as long as the case is.
pub(super) struct Whole {
    answer: Answer,
    /// Arrays of wrong shapes.
    pub(super) faults: Vec<String>,
}

impl Whole {
    pub(super) fn new(laid: &Laid, answer: Answer) -> Whole {
        let mut whole = Whole { answer: Answer::new(), faults: vec![] };
        for (name, given) in answer {
            let Some((_, expected)) = laid.outputs.iter().find(|(output, _)| *output == name) else {
                continue;
            };
            if laid.fits(&name, &given.values) && given.values.ndim() == expected.len() {
                whole.answer.insert(name, given);
            } else if let Some((values, _)) = reshaped(&given.values, expected) {
                whole.answer.insert(name, Given { values, ..given });
            } else if given.values.shape().iter().rev().eq(expected.iter()) {
                // Two axes in each other's place.
                let values = given.values.t().as_standard_layout().into_owned();
                whole.answer.insert(name, Given { values, ..given });
            } else {
                let found = given.values.shape();
                whole
                    .faults
                    .push(format!("{}: {name}: wrong shape {found:?}, expected {expected:?}", laid.large.id));
            }
        }
        whole
    }

    /// The answer to some items.
    pub(super) fn cut(&self, laid: &Laid, items: Range<usize>) -> Answer {
        let one = |(name, given): (&String, &Given)| {
            (name.clone(), Given { values: laid.cut(name, &given.values, items.clone()), dtype: given.dtype })
        };
        self.answer.iter().map(one).collect()
    }

    /// A fingerprint of all bits.
    pub(super) fn bits(&self) -> u64 {
        let all = self.answer.values().flat_map(|given| given.values.iter());
        all.fold(0xcbf2_9ce4_8422_2325, |hash, x| (hash ^ x.to_bits()).wrapping_mul(0x0100_0000_01b3))
    }
}

/// A question of some items alone.
fn question_of(question: &Question, case: Case) -> Question {
    Question::new(question.component, question.kind, vec![case])
}

/// What the blocks of one case showed.
pub(super) struct Seen {
    pub(super) marks: Marks,
    pub(super) grade: Option<Grade>,
    /// The first items that are off.
    pub(super) first: Option<Range<usize>>,
    blocks: usize,
    off: usize,
}

/// How blocks are marked.
pub(super) struct Marking<'a> {
    pub(super) conventions: &'a Conventions,
    /// Whether the first items were laid otherwise.
    pub(super) arranged: bool,
    /// Whether the two formulas' bounds of the first items differ. Where those of later ones alone do, what is within the stable
    /// formula's has no grade.
    pub(super) graded: bool,
    pub(super) options: &'a MarkOptions,
}

impl Marking<'_> {
    /// Marks of a block. Bounds are most of the work: an answer within those of the stable formula needs no others.
    fn marks(&self, block: &Question, answers: &Answers) -> (Marks, Option<Grade>) {
        let (c, options) = (self.conventions, self.options);
        if block.admits(c) {
            let stable = mark(block, answers, c, options, Grade::A);
            if stable.right() {
                return (stable, self.graded.then_some(Grade::A));
            }
        }
        marks(block, answers, c, options)
    }
}

/// Marks a case block by block.
pub(super) fn blocks(question: &Question, laid: &Laid, whole: &Whole, marking: &Marking) -> Seen {
    let mark = |items: Range<usize>| {
        let (alone, mut answers) =
            (question_of(question, laid.part(items.clone())), vec![Some(whole.cut(laid, items))]);
        let (marks, grade) = marking.marks(&alone, &answers);
        if marks.right() || !marking.arranged {
            return (marks, grade);
        }
        // In the layout that the first items have, too.
        if let Some(laid) = layout::normalized(&alone, &answers, marking.conventions, true, marking.options) {
            answers = laid.answers;
        }
        marking.marks(&alone, &answers)
    };
    let ranges = laid.blocks();
    let marked = parallel::map(ranges.len(), |n| mark(ranges[n].clone()));
    let off: Vec<usize> = (0..ranges.len()).filter(|&n| !marked[n].0.right()).collect();
    let first = off.first().map(|&n| {
        let block = ranges[n].clone();
        let divides = laid.large.block < laid.large.items;
        let one = divides.then(|| first_off(block.clone(), |items| mark(items).0.right())).flatten();
        one.map_or(block.clone(), |item| item..block.end.min(item + CUT))
    });
    let (blocks, off) = (ranges.len(), off.len());
    let mut sum = Seen { marks: Marks::default(), grade: None, first, blocks, off };
    for (n, (marks, grade)) in marked.into_iter().enumerate() {
        sum.grade = sum.grade.max(grade);
        merge(&mut sum.marks, shifted(marks, laid, ranges[n].start), n == 0);
    }
    sum
}

/// The first item that is off of those that are, by halves; `None` where it is right by itself.
fn first_off(mut items: Range<usize>, right: impl Fn(Range<usize>) -> bool) -> Option<usize> {
    while items.len() > 1 {
        let middle = items.start + items.len() / 2;
        if right(items.start..middle) {
            items.start = middle;
        } else {
            items.end = middle;
        }
    }
    let first = items.start;
    (!right(items)).then_some(first)
}

/// Marks whose worst element lies where it does in the whole case.
fn shifted(mut marks: Marks, laid: &Laid, first: usize) -> Marks {
    if let Some(worst) = marks.worst.as_mut().filter(|worst| !worst.index.is_empty()) {
        worst.index[0] += laid.shift(&worst.output, first);
    }
    marks
}

/// Adds the marks of more items. What is proved by some is proved.
pub(super) fn merge(sum: &mut Marks, more: Marks, first: bool) {
    if sum.worst.is_none() || more.budget_used > sum.budget_used {
        sum.worst = more.worst.or(sum.worst.take());
    }
    sum.budget_used = sum.budget_used.max(more.budget_used);
    sum.vacuous += more.vacuous;
    if first {
        sum.unproved = more.unproved;
    } else {
        sum.unproved.retain(|name| more.unproved.contains(name));
    }
    for fault in more.faults {
        if !sum.faults.contains(&fault) {
            sum.faults.push(fault);
        }
    }
    sum.missing.extend(more.missing);
    sum.layouts.extend(more.layouts);
    sum.off.extend(more.off.into_iter().filter(|_| sum.off.is_empty()).collect::<Vec<_>>());
}

impl Seen {
    /// What is seen of a failure, in words.
    pub(super) fn told(&self, laid: &Laid, alone: Option<bool>) -> String {
        let first = self.first.as_ref().map_or(0, |items| items.start);
        let (Seen { blocks, off, .. }, large) = (self, &laid.large);
        let alone = match alone {
            Some(true) => "; the same few, asked alone, are right: the fault comes with the size",
            Some(false) => "; so they are when asked alone",
            None => "",
        };
        format!(
            "{}: number {first} of {} is the first that is off, and {off} of {blocks} blocks are{alone}",
            large.id, large.items
        )
    }
}

/// Whether the items that a failure was cut down to are right when they are asked alone; `None` where they weren't answered.
pub(super) fn alone_is_right(
    question: &Question,
    case: &Case,
    reply: Reply,
    c: &Conventions,
    options: &MarkOptions,
) -> Option<bool> {
    let Reply::Answer(answer) = reply else { return None };
    Some(marks(&question_of(question, case.clone()), &vec![Some(answer)], c, options).0.right())
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    #[test]
    fn the_first_item_that_is_off_is_found_by_halves() {
        for (count, off) in [(1, vec![0]), (7, vec![6]), (50_002, vec![3, 4, 49_999]), (1000, vec![999, 500])]
        {
            let asked = Cell::new(0);
            let right = |items: Range<usize>| {
                asked.set(asked.get() + 1);
                !off.iter().any(|item| items.contains(item))
            };
            assert_eq!(first_off(0..count, right), off.iter().min().copied());
            assert!(asked.get() <= 18, "{} of {count}", asked.get());
        }
        // Off together alone: no item is.
        assert_eq!(first_off(10..20, |items| items.len() < 10), None);
    }
}
