//! `index.json`: what the vectors are, row by row and case by case. `schema.json` says the same for other programs.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::contract::check::Kind;
use crate::contract::component;
use crate::convention::Conventions;
use crate::judge::exam::Question;

/// The schema of `index.json`: another name where a field changes its meaning.
pub const SCHEMA: &str = "nerf-oracle/vectors/1";

/// The name of its file.
pub(super) const INDEX: &str = "index.json";

/// When an element is accepted.
pub(super) const ACCEPT: &str = "An element of an answer is right where got == expected, or |got - expected| <= allowed; where allowed is \
                                 infinite anything is, NaN too. Compare in f64, and the shapes first.";

/// All of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Index {
    /// [`SCHEMA`].
    pub schema: String,
    /// Of the crate that wrote it.
    pub version: String,
    /// The conventions' name.
    pub profile: String,
    /// Part of the names of the components that were asked for; empty: all.
    pub filter: String,
    /// `npz` or `raw`.
    pub layout: String,
    /// The rule by which an answer is accepted.
    pub accept: String,
    /// What each row takes and returns.
    pub rows: Vec<Row>,
    /// What the cases' flags mean.
    pub flags: BTreeMap<String, Flag>,
    /// Rows and cases that aren't here, each with its reason.
    pub left_out: BTreeMap<String, String>,
    /// Every case.
    pub cases: Vec<Case>,
}

/// A component in one direction.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Row {
    /// `component/kind`.
    pub name: String,
    /// The formula, on a line or two.
    pub formula: String,
    /// Paper and equation.
    pub source: String,
    /// The conventions that it depends on, as they are here.
    pub conventions: BTreeMap<String, String>,
    /// What it takes.
    pub inputs: Vec<Port>,
    /// What it returns.
    pub outputs: Vec<Port>,
}

/// An array of a row.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Port {
    /// Its name; a last `*` stands for a number.
    pub name: String,
    /// Its shape in letters, as `R,N,3`; empty for a scalar.
    pub shape: String,
    /// What it is, with units.
    pub meaning: String,
}

/// What a flag means.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Flag {
    /// In a few words.
    pub title: String,
    /// What goes wrong, and what is right.
    pub effect: String,
    /// Where it was seen.
    pub seen: String,
}

/// What a checker must say of a case's answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Outcome {
    /// It is right.
    Valid,
    /// It is wrong.
    Invalid,
}

/// A case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// `component/kind/case`, and behind it the mistake of an invalid one.
    pub id: String,
    /// Its row.
    pub row: String,
    /// Whether the answer is right.
    pub result: Outcome,
    /// Where its arrays are: `inputs.NAME`, `expected.NAME`, `allowed_f64.NAME` and, for f32, `allowed_f32.NAME`.
    pub file: String,
    /// What the names of the answer's arrays begin with: `expected`, or `wrong.` and the mistake.
    pub answer: String,
    /// Types that it exists in (valid: those that hold the inputs), or in which it is to be rejected (invalid).
    pub dtypes: Vec<String>,
    /// What it probes, or what was written wrong.
    pub comment: String,
    /// Its hazards and peculiarities.
    pub flags: Vec<String>,
    /// Shapes of the inputs.
    pub inputs: BTreeMap<String, Vec<usize>>,
    /// Shapes of the answer; of a wrong one, of the outputs that are off.
    pub outputs: BTreeMap<String, Vec<usize>>,
}

impl Row {
    /// Of a question in these conventions.
    pub(super) fn new(question: &Question, c: &Conventions) -> Row {
        let component = question.component;
        let forward = |ports: &[component::Port]| ports.iter().map(|p| port(p.name.into(), p, "")).collect();
        let gradient = |p: &component::Port| {
            port(format!("grad_{}", p.name), p, "the loss's derivative with respect to: ")
        };
        let (mut inputs, mut outputs): (Vec<Port>, Vec<Port>) =
            (forward(component.inputs), forward(component.outputs));
        if question.kind == Kind::Vjp {
            let smooth = component.outputs.iter().filter(|p| p.gradient);
            inputs.extend(smooth.map(gradient));
            outputs = component.differentiable().map(gradient).collect();
        }
        Row {
            name: question.row(),
            formula: component.formula.into(),
            source: component.source.into(),
            conventions: component.conventions.iter().map(|key| (key.to_string(), c.get(key))).collect(),
            inputs,
            outputs,
        }
    }
}

fn port(name: String, port: &component::Port, of: &str) -> Port {
    Port { name, shape: port.shape.into(), meaning: format!("{of}{}", port.meaning) }
}
