//! The rubric: which rows are asked, in which arithmetic and conventions, within which limits, and what each is worth.

use std::collections::BTreeMap;
use std::path::{Component as Part, Path};
use std::time::Duration;

use serde::Deserialize;

use crate::contract::arithmetic::Dtype;
use crate::contract::check::Kind;
use crate::contract::component::Component;
use crate::contract::hazard::of_case;
use crate::convention::profiles::{self, Profile};
use crate::error::{Error, Input, Result};
use crate::files;
use crate::judge::exam::Question;
use crate::judge::{Exam, judging};
use crate::registry::all_rows;

/// The schema of a rubric.
const SCHEMA: &str = "nerf-oracle/rubric/1";

/// What to do about a rubric that isn't one.
const REMEDY: &str = "Correct the rubric; tools/examples/grading/rubric.json is one that works.";

/// The file, field by field.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    schema: String,
    title: String,
    #[serde(default = "f32")]
    dtype: String,
    profile: Option<String>,
    #[serde(default = "exp_ulp")]
    exp_ulp: f64,
    #[serde(default = "timeout_s")]
    timeout_s: f64,
    #[serde(default = "memory_mib")]
    memory_mib: u64,
    #[serde(default = "output_mib")]
    output_mib: u64,
    rows: Vec<WrittenRow>,
}

/// A row of the file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenRow {
    component: String,
    #[serde(default = "forward")]
    direction: String,
    points: f64,
    #[serde(default)]
    points_if_imprecise: f64,
    #[serde(default)]
    points_if_only_edge_cases_fail: f64,
    edge_cases: Option<Vec<String>>,
    #[serde(default)]
    outputs: Vec<String>,
    function: Option<String>,
    #[serde(default)]
    parameters: BTreeMap<String, String>,
}

fn f32() -> String {
    "f32".into()
}

fn exp_ulp() -> f64 {
    judging::EXP_ULP
}

fn timeout_s() -> f64 {
    60.0
}

fn memory_mib() -> u64 {
    4096
}

fn output_mib() -> u64 {
    16
}

fn forward() -> String {
    "forward".into()
}

/// What a submission written in Python may use.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits {
    /// From its start to its end.
    pub(crate) time: Duration,
    /// Address space, MiB.
    pub(crate) memory_mib: u64,
    /// What it may print, and the largest file that it may write, MiB.
    pub(crate) output_mib: u64,
}

/// A rubric that can be used.
#[derive(Debug)]
pub(crate) struct Rubric {
    /// What the course calls it.
    pub(crate) title: String,
    /// How far off exp, log, sin and cos may be, in ULP.
    pub(crate) exp_ulp: f64,
    /// Of each submission.
    pub(crate) limits: Limits,
    /// What is asked.
    pub(crate) rows: Vec<Row>,
    /// The questions of these rows, in pipeline order.
    pub(crate) exam: Exam,
    /// The file's bytes: another rubric grades again.
    pub(crate) text: String,
}

/// What a row is worth.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    /// The row of the contract.
    pub(crate) component: &'static Component,
    /// Forward or VJP.
    pub(crate) kind: Kind,
    /// Points where it passes.
    pub(crate) points: f64,
    /// Points for the right formula with too many digits lost.
    pub(crate) if_imprecise: f64,
    /// Points where only edge cases fail.
    pub(crate) if_only_edge_cases_fail: f64,
    /// The ids of those edge cases.
    pub(crate) edge_cases: Vec<String>,
    /// Outputs that have to be answered; where none is named, any will do.
    pub(crate) outputs: Vec<String>,
    /// Where a Python submission has it: `name` or `file.py:name`; by default the row's name.
    pub(crate) function: Option<String>,
    /// Parameters of that function that the contract calls otherwise: theirs -> the contract's.
    pub(crate) parameters: BTreeMap<String, String>,
}

impl Row {
    /// `forward`, `vjp`, `trace` or `statistics`.
    pub(crate) fn direction(&self) -> &'static str {
        crate::judge::exam::kind_name(self.component, self.kind)
    }

    /// As tables head its column.
    pub(crate) fn name(&self) -> String {
        format!("{} {}", self.component.name, self.direction())
    }
}

impl Rubric {
    /// Reads a rubric, checks it, and prepares its questions.
    ///
    /// # Errors
    /// A file that can't be read, fields that are absent, unknown or impossible, rows that aren't in the contract.
    pub(crate) fn read(path: &Path) -> Result<Rubric> {
        let text = files::read_text(path)?;
        let refuse = |field: &str, found: String, expected: String| {
            Error::input(Input { file: path.display(), field, found, expected, remedy: REMEDY })
        };
        let mut from = serde_json::Deserializer::from_str(&text);
        let written: Written = serde_path_to_error::deserialize(&mut from).map_err(|error| {
            let field = error.path().to_string();
            let field = if field == "." { "rubric".into() } else { field };
            refuse(&field, error.into_inner().to_string(), "a rubric, as the program's help has it".into())
        })?;
        from.end().map_err(|error| refuse("rubric", error.to_string(), "one JSON object".into()))?;
        let wrong = |(field, found, expected): Wrong| refuse(&field, found, expected);
        written.check().map_err(wrong)?;
        let (dtype, profile) = written.arithmetic().map_err(wrong)?;
        let mut rows: Vec<Row> = vec![];
        for (n, row) in written.rows.iter().enumerate() {
            let row = row
                .found(dtype, profile)
                .map_err(|(field, found, expected)| wrong((format!("rows[{n}].{field}"), found, expected)))?;
            if rows.iter().any(|other| (other.component.name, other.kind) == (row.component.name, row.kind)) {
                let expected = "each row in each direction once".into();
                return Err(wrong((format!("rows[{n}]"), row.name(), expected)));
            }
            rows.push(row);
        }
        let names: Vec<_> = rows.iter().map(|row| (row.component.name, row.kind)).collect();
        let exam = Exam::of(&names, dtype, profile)?;
        let limits = Limits {
            time: Duration::from_secs_f64(written.timeout_s),
            memory_mib: written.memory_mib,
            output_mib: written.output_mib,
        };
        Ok(Rubric { title: written.title, exp_ulp: written.exp_ulp, limits, rows, exam, text })
    }

    /// All points that there are.
    pub(crate) fn points(&self) -> f64 {
        self.rows.iter().map(|row| row.points).sum()
    }
}

/// Field, what was found, what was expected.
type Wrong = (String, String, String);

fn wrong(field: &str, found: impl ToString, expected: impl ToString) -> Wrong {
    (field.into(), found.to_string(), expected.to_string())
}

impl Written {
    fn check(&self) -> Result<(), Wrong> {
        if self.schema != SCHEMA {
            return Err(wrong("schema", &self.schema, SCHEMA));
        }
        if !(self.exp_ulp >= 0.5 && self.exp_ulp <= 1e6) {
            return Err(wrong("exp_ulp", self.exp_ulp, "a number from 0.5 to 1e6"));
        }
        if !(self.timeout_s >= 1.0 && self.timeout_s <= 86_400.0) {
            return Err(wrong("timeout_s", self.timeout_s, "seconds from 1 to 86400"));
        }
        for (field, value) in [("memory_mib", self.memory_mib), ("output_mib", self.output_mib)] {
            let least = if field == "memory_mib" { 256 } else { 1 };
            if !(least..=1 << 20).contains(&value) {
                return Err(wrong(field, value, format!("MiB from {least} to {}", 1 << 20)));
            }
        }
        if self.rows.is_empty() {
            return Err(wrong("rows", "an empty list", "one row at least"));
        }
        Ok(())
    }

    fn arithmetic(&self) -> Result<(Dtype, Option<&'static Profile>), Wrong> {
        let dtype =
            self.dtype.parse().map_err(|_| wrong("dtype", &self.dtype, "f64, f32, tf32, bf16 or f16"));
        let profile = self.profile.as_deref().map(profiles::find).transpose().map_err(|error| match error {
            Error::Usage { found, expected, .. } => wrong("profile", found, expected),
            other => wrong("profile", other, "a profile"),
        });
        Ok((dtype?, profile?))
    }
}

impl WrittenRow {
    /// The row of the contract that is meant.
    fn found(&self, dtype: Dtype, profile: Option<&'static Profile>) -> Result<Row, Wrong> {
        let Some(component) = all_rows().find(|c| c.name == self.component) else {
            let names: Vec<_> = all_rows().map(|c| c.name).collect();
            return Err(wrong("component", &self.component, format!("one of {}", names.join(", "))));
        };
        let kind = match &*self.direction {
            "vjp" => Kind::Vjp,
            other if other == "forward" || other == component.special.forward_name => Kind::Forward,
            other => return Err(wrong("direction", other, "forward or vjp")),
        };
        let Ok(exam) = Exam::of(&[(component.name, kind)], dtype, profile) else {
            let found = format!("{} of {} in {dtype}", self.direction, component.name);
            return Err(wrong("direction", found, "a direction that this row has in this type"));
        };
        self.check(component)?;
        Ok(Row {
            component,
            kind,
            points: self.points,
            if_imprecise: self.points_if_imprecise,
            if_only_edge_cases_fail: self.points_if_only_edge_cases_fail,
            edge_cases: self.edge_cases(&exam.questions[0])?,
            outputs: self.outputs.clone(),
            function: self.function.clone(),
            parameters: self.parameters.clone(),
        })
    }

    fn check(&self, component: &Component) -> Result<(), Wrong> {
        if !(self.points >= 0.0 && self.points <= 1e6) {
            return Err(wrong("points", self.points, "a number from 0 to 1e6"));
        }
        let partial = [
            ("points_if_imprecise", self.points_if_imprecise),
            ("points_if_only_edge_cases_fail", self.points_if_only_edge_cases_fail),
        ];
        if let Some((field, value)) = partial.into_iter().find(|(_, x)| !(*x >= 0.0 && *x <= self.points)) {
            return Err(wrong(field, value, format!("a number from 0 to the row's {} points", self.points)));
        }
        let known = |name: &str| component.outputs.iter().any(|port| port.covers(name));
        if let Some(name) = self.outputs.iter().find(|name| !known(name)) {
            let names: Vec<_> = component.outputs.iter().map(|port| port.name).collect();
            return Err(wrong("outputs", name, format!("some of {}", names.join(", "))));
        }
        let inputs = || component.inputs.iter().map(|port| port.name);
        let forms = || component.special.forms.iter().filter_map(|form| form.takes);
        let input = |name: &String| {
            let bare = name.strip_prefix("grad_").unwrap_or(name);
            component.input_port(name).is_some() || forms().any(|form| form == name) || known(bare)
        };
        if let Some(name) = self.parameters.values().find(|name| !input(name)) {
            let names: Vec<_> = inputs().chain(forms()).collect();
            return Err(wrong("parameters", name, format!("the row's own names: {}", names.join(", "))));
        }
        if let Some((file, _)) = self.function.as_deref().and_then(|function| function.split_once(':')) {
            let plain = Path::new(file).components().all(|part| matches!(part, Part::Normal(_)));
            if !plain || !file.ends_with(".py") {
                return Err(wrong(
                    "function",
                    file,
                    "name, or file.py:name with a file inside the submission",
                ));
            }
        }
        Ok(())
    }

    /// The ids of the row's edge cases: those that the contract calls so, or those that are named here by what they are ("no samples"),
    /// by their hazard ("VR9") or by their own id.
    fn edge_cases(&self, question: &Question) -> Result<Vec<String>, Wrong> {
        let Some(names) = &self.edge_cases else {
            let edges = question.cases.iter().filter(|case| case.edge.is_some());
            return Ok(edges.map(|case| case.id.clone()).collect());
        };
        let mut ids = vec![];
        for name in names {
            let before = ids.len();
            let named = question.cases.iter().filter(|case| {
                case.id == *name || case.edge == Some(name) || of_case(&case.id).is_some_and(|h| h.id == name)
            });
            ids.extend(named.map(|case| case.id.clone()));
            if ids.len() == before {
                return Err(wrong("edge_cases", name, format!("some of {}", there(question))));
            }
        }
        Ok(ids)
    }
}

/// What a row's edge cases can be named by.
fn there(question: &Question) -> String {
    let mut names: Vec<String> = vec![];
    for case in &question.cases {
        let hazard = of_case(&case.id).map(|hazard| hazard.id.to_string());
        names.extend(case.edge.map(String::from).into_iter().chain(hazard).chain([case.id.clone()]));
    }
    let mut seen = std::collections::BTreeSet::new();
    names.retain(|name| seen.insert(name.clone()));
    names.join(", ")
}
