//! The exam: every case of every component and direction for one type, and its manifest.

use std::collections::BTreeMap;
use std::sync::Arc;

use ndarray::ArrayD;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::truths::Truths;
use crate::contract::arithmetic::Dtype;
use crate::contract::arrays::Arrays;
use crate::contract::case::Case;
use crate::contract::check::Kind;
use crate::contract::component::{Component, Entries};
use crate::contract::hazard;
use crate::convention::profiles::Profile;
use crate::convention::{CS180, Conventions, american};
use crate::error::{Error, Result};
use crate::registry::all_rows;

/// The manifest's schema.
pub const SCHEMA: &str = "nerf-oracle/cases/1";

/// One component in one direction with all of its cases.
#[derive(Clone, Debug)]
pub struct Question {
    /// The row of the contract.
    pub component: &'static Component,
    /// Forward or VJP.
    pub kind: Kind,
    /// Its cases in the exam's type.
    pub cases: Vec<Case>,
    /// Cases that need more than the candidate takes, with the inputs that they need.
    pub left_out: BTreeMap<String, String>,
    /// Cases on which the candidate crashed, with what it said.
    pub crashed: BTreeMap<String, String>,
    pub(crate) truths: Truths,
}

/// All questions that a candidate is asked.
#[derive(Clone, Debug)]
pub struct Exam {
    /// What the candidate computes in.
    pub dtype: Dtype,
    /// The pinned profile, if there is one.
    pub profile: Option<&'static Profile>,
    /// Which components: a part of their name or folder.
    pub filter: String,
    /// The questions, in pipeline order.
    pub questions: Vec<Question>,
    /// Cases whose inputs the type can't represent, by `component/kind-id`.
    pub left_out: Vec<String>,
}

/// `cases.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    /// [`SCHEMA`].
    pub schema: String,
    /// The crate's version: another one may ask other questions.
    pub version: String,
    /// What the candidate computes in.
    pub dtype: String,
    /// The pinned profile, or null.
    pub profile: Option<String>,
    /// The filter that chose the components.
    pub filter: String,
    /// Cases that the type can't represent.
    pub left_out: Vec<String>,
    /// How the arrays lie in files, where that isn't npz.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub layout: Option<String>,
    /// The tier, where it isn't the small one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tier: Option<String>,
    /// One entry per case.
    pub cases: Vec<Value>,
}

impl Exam {
    /// The questions on the components whose name or folder contains `filter`, in `dtype`.
    ///
    /// # Errors
    /// A filter that no component matches.
    pub fn new(filter: &str, dtype: Dtype, profile: Option<&'static Profile>) -> Result<Exam> {
        let filter = &american(filter);
        let wanted = |c: &Component, _| c.name.contains(filter) || c.folder.contains(filter);
        let exam = Exam { filter: filter.to_string(), ..Exam::asking(wanted, dtype, profile) };
        if exam.questions.is_empty() {
            return Err(Error::usage("filter", filter, format!("a part of one of: {}", names())));
        }
        Ok(exam)
    }

    /// The questions on these rows alone, by their exact names.
    ///
    /// # Errors
    /// A row that isn't in the contract (for this type).
    pub fn of(rows: &[(&str, Kind)], dtype: Dtype, profile: Option<&'static Profile>) -> Result<Exam> {
        let exam = Exam::asking(|c, kind| rows.contains(&(c.name, kind)), dtype, profile);
        let asked =
            |name: &str, kind| exam.questions.iter().any(|s| s.component.name == name && s.kind == kind);
        match rows.iter().find(|(name, kind)| !asked(name, *kind)) {
            Some((name, kind)) => {
                Err(Error::usage("component", format!("{name} ({kind:?}, {dtype})"), names()))
            }
            None => Ok(exam),
        }
    }

    fn asking(
        wanted: impl Fn(&Component, Kind) -> bool,
        dtype: Dtype,
        profile: Option<&'static Profile>,
    ) -> Exam {
        let mut exam = Exam { dtype, profile, filter: String::new(), questions: vec![], left_out: vec![] };
        // Statistics need types in which a sampler's numbers are fine enough.
        let fine = [Dtype::F64, Dtype::F32].contains(&dtype);
        for component in all_rows().filter(|c| fine || c.special.statistics.is_none()) {
            let asked = |&kind: &Kind| component.direction(kind).is_some() && wanted(component, kind);
            for kind in [Kind::Forward, Kind::Vjp].into_iter().filter(asked) {
                let (cases, out): (Vec<_>, Vec<_>) = component
                    .cases_of(kind, &exam.conventions())
                    .into_iter()
                    .partition(|case| case.exists_in(dtype));
                exam.left_out.extend(out.iter().map(|case| path(component, kind, &case.id)));
                exam.questions.push(Question::new(component, kind, cases));
            }
        }
        exam
    }

    /// The pinned conventions, or the default's.
    pub fn conventions(&self) -> Conventions {
        self.profile.map_or(CS180, |profile| profile.conventions)
    }

    /// What `cases.json` says.
    pub fn manifest(&self) -> Manifest {
        let cases = self.questions.iter().flat_map(|s| s.cases.iter().map(move |case| self.entry(s, case)));
        self.manifest_of(cases.collect())
    }

    /// The same with these entries.
    pub(super) fn manifest_of(&self, cases: Vec<Value>) -> Manifest {
        Manifest {
            schema: SCHEMA.into(),
            version: env!("CARGO_PKG_VERSION").into(),
            dtype: self.dtype.to_string(),
            profile: self.profile.map(|profile| profile.name.to_string()),
            filter: self.filter.clone(),
            left_out: self.left_out.clone(),
            layout: None,
            tier: None,
            cases,
        }
    }

    fn entry(&self, question: &Question, case: &Case) -> Value {
        let Question { component, kind, .. } = question;
        let direction = component.direction(*kind).expect("a question has its direction");
        let outputs = (direction.oracle)(&case.inputs, &self.conventions());
        let shape = |(name, array): (&String, &ArrayD<f64>)| (name.clone(), array.shape().to_vec());
        let inputs = case.inputs.iter().map(shape).map(|(name, shape)| self.input(question, &name, &shape));
        let outputs: BTreeMap<String, Vec<usize>> = outputs.iter().map(shape).collect();
        self.described(question, case, inputs.collect(), &outputs)
    }

    /// What the manifest says of an input.
    pub(super) fn input(&self, question: &Question, name: &str, shape: &[usize]) -> Value {
        port(question.component, name, shape, question.stored(name, shape.len(), self.dtype))
    }

    /// What the manifest says of a case with these inputs and shapes of outputs.
    pub(super) fn described(
        &self,
        question: &Question,
        case: &Case,
        inputs: Vec<Value>,
        outputs: &BTreeMap<String, Vec<usize>>,
    ) -> Value {
        let (Question { component, kind, .. }, c) = (question, self.conventions());
        let pinned = component.conventions.iter().map(|key| (key.to_string(), c.get(key)));
        let output = |name: &String| {
            port(component, name, &outputs[name], answer_type(component.output_entries(name), self.dtype))
        };
        json!({
            "id": case.id,
            "component": component.name,
            "kind": question.kind_name(),
            "file": path(component, *kind, &case.id) + ".npz",
            "inputs": inputs,
            "outputs": question.ordered(outputs.keys()).into_iter().map(output).collect::<Vec<_>>(),
            // Without a profile nothing is pinned, and the judge looks for the assignment that holds.
            "conventions": match self.profile {
                Some(_) => json!(pinned.collect::<BTreeMap<_, _>>()),
                None => json!({}),
            },
            "forms": component.special.forms.iter().map(|form| json!({
                "without": form.without, "takes": form.takes, "holds": (form.holds)(&case.inputs, self.dtype),
            })).collect::<Vec<_>>(),
            "flags": flags(case),
            "comment": case.comment,
        })
    }
}

/// What the manifest says of an array.
fn port(component: &Component, name: &str, shape: &[usize], stored: Stored) -> Value {
    json!({ "name": name, "shape": shape, "dtype": stored.name(), "meaning": meaning(component, name) })
}

impl Question {
    /// These cases of a row in one direction.
    pub fn new(component: &'static Component, kind: Kind, cases: Vec<Case>) -> Question {
        let (left_out, crashed, truths) = Default::default();
        Question { component, kind, cases, left_out, crashed, truths }
    }

    /// `forward`, `vjp` or `trace`.
    pub fn kind_name(&self) -> &'static str {
        kind_name(self.component, self.kind)
    }

    /// What a hypothesis costs on a case, in elements: so much however small the case is.
    pub(crate) fn cost(&self, case: &Case) -> usize {
        100 + self.component.special.work * case.size()
    }

    /// Whether it is judged by the statistics of all of its cases together.
    pub fn statistics(&self) -> bool {
        self.component.special.statistics.is_some()
    }

    /// What an input is stored as: counts as integers, other scalars (hyper-parameters) as f64, arrays in the type under test.
    pub fn stored(&self, name: &str, axes: usize, dtype: Dtype) -> Stored {
        match self.component.input_entries(name) {
            Entries::Count | Entries::Bit => Stored::I64,
            _ if axes == 0 => Stored::F64,
            entries => answer_type(entries, dtype),
        }
    }

    /// The true outputs of a case.
    pub(crate) fn expected(&self, case: &Case, c: &Conventions) -> Arc<Arrays> {
        self.truths.expected((self.component, self.kind), case, c)
    }

    /// Whether the cases have the shapes that these conventions need.
    pub fn admits(&self, c: &Conventions) -> bool {
        self.cases.iter().all(|case| (self.component.special.admits)(&case.inputs, c))
    }

    /// Where a case's arrays lie, below the folder, without the extension.
    pub fn path(&self, case: &Case) -> String {
        path(self.component, self.kind, &case.id)
    }

    /// The paths of all cases, those that the candidate isn't asked too.
    pub fn paths(&self) -> impl Iterator<Item = String> {
        let ids = self.cases.iter().map(|case| &case.id).chain(self.left_out.keys());
        ids.map(|id| path(self.component, self.kind, id))
    }

    /// Output names in the contract's order, which is the order in which a mistake propagates.
    pub fn ordered<'a>(&self, names: impl Iterator<Item = &'a String>) -> Vec<&'a String> {
        let ports = if self.kind == Kind::Forward { self.component.outputs } else { self.component.inputs };
        let place = |name: &str| {
            let bare = name.strip_prefix("grad_").unwrap_or(name);
            ports.iter().position(|port| port.covers(bare)).unwrap_or(ports.len())
        };
        let mut names: Vec<_> = names.collect();
        names.sort_by_key(|name| place(name));
        names
    }
}

/// The rows' names on a line.
fn names() -> String {
    all_rows().map(|c| c.name).collect::<Vec<_>>().join(", ")
}

/// `forward`, `vjp` or `trace`.
pub fn kind_name(component: &Component, kind: Kind) -> &'static str {
    match kind {
        Kind::Forward => component.special.forward_name,
        Kind::Vjp => "vjp",
    }
}

fn path(component: &Component, kind: Kind, id: &str) -> String {
    format!("{}/{}-{id}", component.name, kind_name(component, kind))
}

/// The id of a hard case begins with that of its hazard.
fn flags(case: &Case) -> Vec<&'static str> {
    if hard(case) { vec!["hard"] } else { vec![] }
}

/// Whether a case is one of the hard ones, where rounding may do much.
pub fn hard(case: &Case) -> bool {
    hazard::of_case(&case.id).is_some()
}

fn meaning(component: &Component, name: &str) -> String {
    let ports = || component.inputs.iter().chain(component.outputs);
    let find = |name: &str| ports().find(|port| port.covers(name)).map(|port| port.meaning);
    match name.strip_prefix("grad_") {
        Some(bare) => format!("gradient with respect to {bare}"),
        None => find(name).unwrap_or("see the component's formula").to_string(),
    }
}

/// A type in the files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stored {
    /// float64.
    F64,
    /// float32; tf32 and bf16 too.
    F32,
    /// float16.
    F16,
    /// int64.
    I64,
    /// uint8.
    U8,
}

impl Stored {
    /// As the manifest spells it.
    pub fn name(self) -> &'static str {
        match self {
            Stored::F64 => "f64",
            Stored::F32 => "f32",
            Stored::F16 => "f16",
            Stored::I64 => "i64",
            Stored::U8 => "u8",
        }
    }

    /// Bytes of an element.
    pub fn bytes(self) -> usize {
        match self {
            Stored::F64 | Stored::I64 => 8,
            Stored::F32 => 4,
            Stored::F16 => 2,
            Stored::U8 => 1,
        }
    }
}

/// The narrowest type an answer may be given in.
fn answer_type(entries: Entries, dtype: Dtype) -> Stored {
    match dtype {
        _ if entries == Entries::Byte => Stored::U8,
        Dtype::F64 => Stored::F64,
        Dtype::F32 | Dtype::Tf32 | Dtype::Bf16 => Stored::F32,
        Dtype::F16 => Stored::F16,
    }
}
