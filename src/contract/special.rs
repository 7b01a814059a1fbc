//! What only a few rows of the contract need.

use ndarray::ArrayD;

use super::arithmetic::Dtype;
use super::arrays::Arrays;
use super::case::{Case, Draw};
use super::large::Large;
use super::laws::Laws;
use crate::convention::Conventions;

/// What only a few rows need; most have [`Special::NONE`].
#[derive(Clone, Copy, Debug)]
pub struct Special {
    /// What the forward direction is called in files and reports.
    pub forward_name: &'static str,
    /// The conventions that each output depends on, where these aren't all of the row's: a search for conventions rules them out
    /// output by output.
    pub reads: &'static [(&'static str, &'static [&'static str])],
    /// Conventions that few programs follow and that change nearly every answer: a search for mistakes leaves them aside where nothing speaks
    /// for them.
    pub seldom: &'static [&'static str],
    /// Outputs that none of the row's mistakes reaches: whatever is wrong, they show their conventions.
    pub untouched: &'static [&'static str],
    /// Gives a case's inputs the shapes that conventions ask for.
    pub reshape: fn(&mut Arrays, &Conventions),
    /// Whether inputs have the shapes that conventions ask for.
    pub admits: fn(&Arrays, &Conventions) -> bool,
    /// The convention that orders the output's columns, and its value from which any other order is recognized.
    pub columns: Option<(&'static str, &'static str)>,
    /// Adds to inputs that are off by `relative` what an honest formula rounds inside, which wrong code may magnify.
    pub rounds_inside: fn(&mut Arrays, relative: f64, &mut Draw),
    /// A number that a program chooses for itself, the same in all cases.
    pub chosen: Option<Chosen>,
    /// How all cases are judged together, where single elements say nothing.
    pub statistics: Option<Statistics>,
    /// The forms in which functions take less than all inputs, or others in their place.
    pub forms: &'static [Form],
    /// Cases of real sizes, if it has some.
    pub large: fn() -> Vec<Large>,
    /// The input that says how far a function is asked to go, where many go less far.
    pub reach: Option<Reach>,
    /// The lengths of an input's axis of which functions are often written for one alone.
    pub only: Option<Only>,
    /// What an element costs, in those of a usual row: searches try so many hypotheses less.
    pub work: usize,
    /// Outputs that aren't read everywhere.
    pub unread: Option<Unread>,
    /// Outputs that many programs have as 1 less another: what is left of that has the digits of 1.
    pub left_of_one: &'static [&'static str],
    /// What a gradient alone shows of the conventions, done to one that differences of the forward function show.
    pub of_gradients: fn(&Arrays, &Conventions, Arrays) -> Arrays,
    /// The formulas that people write in its place, and those that they write for its gradient.
    pub laws: Option<Laws>,
    /// See `laws`.
    pub gradient_laws: Option<Laws>,
}

/// Outputs with another one that says where they are read: where that is 0, they may be anything.
#[derive(Clone, Copy, Debug)]
pub struct Unread {
    /// What isn't read everywhere.
    pub outputs: &'static [&'static str],
    /// What says where.
    pub by: &'static str,
    /// The same from the inputs and those outputs, in their order: what their user asks where it isn't answered.
    pub told: fn(&Arrays, &[ArrayD<f64>]) -> ArrayD<f64>,
}

/// A number, or a length, up to which a function may go: it is judged as far as it does.
#[derive(Clone, Copy, Debug)]
pub struct Reach {
    /// The input.
    pub input: &'static str,
    /// As far as it must go at least.
    pub least: f64,
}

/// Lengths of an axis: points of three coordinates, pictures of three channels, harmonics of one degree. A function that answers to one of them
/// alone is asked that one alone.
#[derive(Clone, Copy, Debug)]
pub struct Only {
    /// The input.
    pub input: &'static str,
    /// Its axis.
    pub axis: usize,
    /// The lengths.
    pub lengths: &'static [usize],
    /// What there are so many of.
    pub what: &'static str,
}

/// A number that stands at places of an output whatever the inputs. Programs choose it freely: it is told, and not compared.
#[derive(Clone, Copy, Debug)]
pub struct Chosen {
    /// The output.
    pub output: &'static str,
    /// What it is, as in "the last step is 1e20".
    pub what: &'static str,
    /// Whether it stands at this index of an array of this shape.
    pub at: fn(index: &[usize], shape: &[usize]) -> bool,
    /// The input at this index that may have been taken off it, as of the last step: 1e5 - t.
    pub less: Option<&'static str>,
    /// The number of a listed convention in its place.
    pub listed: f64,
}

impl Special {
    /// The formulas of the forward direction, or of the gradient.
    pub(crate) fn laws_of(&self, forward: bool) -> Option<Laws> {
        if forward { self.laws } else { self.gradient_laws }
    }

    /// A row whose elements are compared one by one, in all conventions.
    pub const NONE: Special = Special {
        forward_name: "forward",
        reads: &[],
        seldom: &[],
        untouched: &[],
        reshape: |_, _| {},
        admits: |_, _| true,
        columns: None,
        rounds_inside: |_, _, _| {},
        chosen: None,
        statistics: None,
        forms: &[],
        large: Vec::new,
        reach: None,
        only: None,
        work: 1,
        unread: None,
        left_of_one: &[],
        of_gradients: |_, _, gradients| gradients,
        laws: None,
        gradient_laws: None,
    };
}

/// A form in which functions often take a row's inputs: some of them are left off and assumed, or something else is taken in their place.
/// Cases whose inputs can't be had in this form are left out for such a function.
#[derive(Clone, Copy, Debug)]
pub struct Form {
    /// The inputs that it does without.
    pub without: &'static [&'static str],
    /// What is taken in their place; `None`: nothing, they are assumed.
    pub takes: Option<&'static str>,
    /// What that is, or what is assumed.
    pub meaning: &'static str,
    /// Whether a case's inputs can be had in this form in a type.
    pub holds: fn(&Arrays, Dtype) -> bool,
}

/// A row that is judged by statistics over its cases.
#[derive(Clone, Copy, Debug)]
pub struct Statistics {
    /// Outputs that needn't be answered.
    pub optional: &'static [&'static str],
    /// The finding behind which nothing else is asked.
    pub last_word: &'static str,
    /// What the answers show, given in the order of the cases: of the expected shapes, and finite.
    pub findings: for<'a> fn(&'a [Case], &[Arrays], &Conventions) -> Findings<'a>,
}

/// What was found, one after the other as it is asked for: the cheapest first.
pub type Findings<'a> = Box<dyn Iterator<Item = Finding> + 'a>;

/// Something that right answers show with a negligible probability, or a choice.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// The mistake's name, or the choice's.
    pub name: &'static str,
    /// Whether it is a choice that right programs make: told, and passed.
    pub honest: bool,
    /// What was seen, and what should have been.
    pub says: String,
}
