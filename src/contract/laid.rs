//! Large cases, laid out: asked whole, and judged in parts of a few rays or points.

use std::ops::Range;

use ndarray::{ArrayD, Axis, Slice};

use super::arithmetic::Dtype;
use super::arrays::{Arrays, array};
use super::case::Case;
use super::check::Kind;
use super::component::{Component, Port};
use super::large::{Large, Made, Packed};
use super::recipe::{Recipe, signed};
use crate::convention::Conventions;

/// A large case in a direction and a type, ready to be asked and to be cut.
#[derive(Clone, Debug)]
pub struct Laid {
    component: &'static Component,
    /// The case, with the cotangents of a VJP.
    pub large: Large,
    dtype: Dtype,
    /// Where each ray's samples begin and, last, their number, where rays are packed.
    offsets: Vec<usize>,
    /// Names and shapes of the outputs.
    pub outputs: Vec<(String, Vec<usize>)>,
}

impl Laid {
    /// A large case of a row. Cotangents are of both signs, from 1/16 to 1.
    ///
    /// # Panics
    /// Where the row doesn't have this direction.
    pub fn new(
        component: &'static Component,
        kind: Kind,
        large: Large,
        dtype: Dtype,
        c: &Conventions,
    ) -> Laid {
        let mut laid = Laid { component, large, dtype, offsets: vec![], outputs: vec![] };
        if let Some(packed) = laid.large.packed {
            laid.offsets = laid.made(packed.offsets).iter().map(|&x| x as usize).collect();
        }
        // The gradient of what all items share adds them up.
        let shared = |port: &Port| port.gradient && laid.axis(port, 0..0).is_none();
        if kind == Kind::Vjp && component.inputs.iter().any(shared) {
            laid.large.block = laid.large.items;
        }
        // One item shows the shapes, unless a case makes sense as a whole alone.
        let one = 0..if laid.large.block == laid.large.items { laid.large.items } else { 1 };
        let outputs = laid.shapes(&(component.forward.oracle)(&laid.part(one.clone()).inputs, c));
        if kind == Kind::Forward {
            return Laid { outputs, ..laid };
        }
        for (name, shape) in outputs {
            if component.outputs.iter().any(|port| port.gradient && port.covers(&name)) {
                laid.large = laid.large.with(format!("grad_{name}"), &shape, signed(-4, 4));
            }
        }
        let direction = component.direction(kind).expect("a row has its direction");
        laid.outputs = laid.shapes(&(direction.oracle)(&laid.part(one).inputs, c));
        laid
    }

    /// The shapes that arrays have which have these of one item.
    fn shapes(&self, one: &Arrays) -> Vec<(String, Vec<usize>)> {
        let whole = |(name, array): (&String, &ArrayD<f64>)| {
            let mut shape = array.shape().to_vec();
            if let Some(span) = self.span(name, 0..self.large.items) {
                shape[0] = span.end;
            }
            (name.clone(), shape)
        };
        one.iter().map(whole).collect()
    }

    /// All entries of an input.
    fn made(&self, name: &str) -> Vec<f64> {
        let made = self.large.inputs.iter().find(|made| made.name == name).expect("an input of the case");
        self.entries(made, 0..made.shape.iter().product())
    }

    fn entries(&self, made: &Made, range: Range<usize>) -> Vec<f64> {
        let name = format!("{}/{}/{}", self.component.name, self.large.id, made.name);
        made.recipe.entries(&name, range, made.shape.last().copied().unwrap_or(1), self.dtype)
    }

    /// The generator's key of an input.
    pub fn key(&self, made: &Made) -> [u64; 2] {
        Recipe::key(&format!("{}/{}/{}", self.component.name, self.large.id, made.name))
    }

    /// Where along the first axis of an array these items lie; `None` where all of them share it.
    pub fn span(&self, name: &str, items: Range<usize>) -> Option<Range<usize>> {
        let bare = name.strip_prefix("grad_").unwrap_or(name);
        let mut ports = self.component.inputs.iter().chain(self.component.outputs);
        self.axis(ports.find(|port| port.covers(bare))?, items)
    }

    /// The same of a port's arrays.
    fn axis(&self, port: &Port, items: Range<usize>) -> Option<Range<usize>> {
        let letter = first_letter(port);
        match self.large.packed {
            Some(packed) if letter == packed.letter => {
                Some(self.offsets[items.start]..self.offsets[items.end])
            }
            Some(packed) if port.name == packed.offsets => None,
            Some(packed) => (letter == self.counted(packed)).then_some(items),
            // A single number has no axis.
            None => {
                (!letter.is_empty() && letter == first_letter(&self.component.outputs[0])).then_some(items)
            }
        }
    }

    /// The letter that counts rays: there is one offset more than rays.
    fn counted(&self, packed: Packed) -> &'static str {
        let port =
            self.component.input_port(packed.offsets).expect("the offsets of packed rays are an input");
        port.shape.trim_end_matches("+1")
    }

    /// The items of each block.
    pub fn blocks(&self) -> Vec<Range<usize>> {
        let Large { items, block, .. } = self.large;
        (0..items).step_by(block).map(|first| first..items.min(first + block)).collect()
    }

    /// The case as it is asked.
    pub fn whole(&self) -> Case {
        self.part(0..self.large.items)
    }

    /// Some of its items as a case of their own.
    pub fn part(&self, items: Range<usize>) -> Case {
        let offsets = self.large.packed.map(|packed| packed.offsets);
        let one = |made: &Made| {
            let mut shape = made.shape.clone();
            let data = match self.span(&made.name, items.clone()) {
                _ if offsets == Some(&made.name[..]) && !self.offsets.is_empty() => {
                    shape[0] = items.len() + 1;
                    let first = self.offsets[items.start];
                    self.offsets[items.start..=items.end].iter().map(|&at| (at - first) as f64).collect()
                }
                Some(span) => {
                    let row: usize = shape[1..].iter().product();
                    shape[0] = span.len();
                    self.entries(made, span.start * row..span.end * row)
                }
                None => self.entries(made, 0..shape.iter().product()),
            };
            (made.name.clone(), array(&shape, data))
        };
        let inputs: Arrays = self.large.inputs.iter().map(one).collect();
        Case { inputs: inputs.into(), ..Case::new(self.large.id, self.large.comment, vec![]) }
    }

    /// The part of an answer that belongs to some items.
    pub fn cut(&self, name: &str, whole: &ArrayD<f64>, items: Range<usize>) -> ArrayD<f64> {
        match self.span(name, items) {
            Some(span) if whole.ndim() > 0 => whole.slice_axis(Axis(0), Slice::from(span)).to_owned(),
            _ => whole.clone(),
        }
    }

    /// Where along the first axis of an array the items from `first` on begin.
    pub fn shift(&self, name: &str, first: usize) -> usize {
        self.span(name, first..self.large.items).map_or(0, |span| span.start)
    }

    /// Whether an answer has as many entries along its first axis as there are items.
    pub fn fits(&self, name: &str, whole: &ArrayD<f64>) -> bool {
        self.span(name, 0..self.large.items)
            .is_none_or(|span| whole.ndim() > 0 && whole.shape()[0] == span.end)
    }

    /// Cotangents of 0 for the outputs that `keeps` doesn't want.
    pub fn without_cotangents(&mut self, keeps: impl Fn(&str) -> bool) {
        for made in &mut self.large.inputs {
            if made.name.strip_prefix("grad_").is_some_and(|bare| !keeps(bare)) {
                made.recipe = Recipe::Constant(0.0);
            }
        }
    }
}

fn first_letter(port: &Port) -> &'static str {
    port.shape.split(',').next().unwrap_or_default()
}
