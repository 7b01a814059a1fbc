//! What a candidate declares (`answers.json`): what it takes and returns. It is asked what it can answer, and told what that leaves out;
//! a case on which it crashed has that for its answer.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::exam::{Exam, Question};
use crate::contract::arithmetic::Dtype;
use crate::contract::arrays::Arrays;
use crate::contract::check::Kind;
use crate::contract::component::Component;
use crate::contract::special::Form;

/// The schema of `answers.json`.
pub const SCHEMA: &str = "nerf-oracle/answers/1";

/// What a candidate says of one row; what it doesn't say is as the contract has it.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Declared {
    /// The inputs that it takes, those of [`Form`]s too; absent: all of the contract's.
    pub takes: Option<Vec<String>>,
    /// The outputs through which its gradients go; absent: all. The cotangents of the others are 0.
    pub returns: Option<Vec<String>>,
    /// Cases on which it crashed, with what it said.
    pub crashed: BTreeMap<String, String>,
}

/// `answers.json`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Declarations {
    /// [`SCHEMA`].
    pub schema: String,
    /// Rows by `component/kind`.
    pub rows: BTreeMap<String, Declared>,
}

/// The inputs that a case needs and a function doesn't take: what it takes in their place, or assumes, isn't what the case has.
pub fn needed(component: &Component, takes: &[String], inputs: &Arrays, dtype: Dtype) -> Vec<&'static str> {
    let taken = |name: &str| takes.iter().any(|t| t == name);
    let forms = component.special.forms;
    let absent = component.inputs.iter().map(|port| port.name).filter(|name| !taken(name));
    let form = |name: &&str| -> Option<&Form> {
        forms.iter().find(|form| form.without.contains(name) && form.takes.is_none_or(taken))
    };
    absent.filter(|name| form(name).is_some_and(|form| !(form.holds)(inputs, dtype))).collect()
}

impl Exam {
    /// The same exam for a candidate that declares something: without the cases that need more than it takes, and with cotangents of 0 for
    /// what it doesn't return.
    ///
    /// # Errors
    /// What is no row, input, output or case of this exam, in words.
    pub fn narrowed(mut self, declared: &BTreeMap<String, Declared>) -> Result<Exam, String> {
        let rows: Vec<String> = self.questions.iter().map(Question::row).collect();
        if let Some(name) = declared.keys().find(|name| !rows.contains(name)) {
            return Err(format!("{name}: no row of these cases"));
        }
        let dtype = self.dtype;
        for question in &mut self.questions {
            if let Some(declared) = declared.get(&question.row()) {
                question.narrow(declared, dtype)?;
            }
        }
        Ok(self)
    }
}

impl Question {
    /// `component/kind`.
    pub fn row(&self) -> String {
        format!("{}/{}", self.component.name, self.kind_name())
    }

    fn narrow(&mut self, declared: &Declared, dtype: Dtype) -> Result<(), String> {
        let component = self.component;
        let unknown = |name: &String, what: &str| Err(format!("{}: {name}: no {what} of it", self.row()));
        let takes = declared.takes.as_deref();
        let input = |name: &String| {
            component.input_port(name).is_some()
                || component.special.forms.iter().any(|form| form.takes == Some(name))
                || name.strip_prefix("grad_").is_some_and(|bare| output(component, bare))
        };
        if let Some(name) = takes.into_iter().flatten().find(|name| !input(name)) {
            return unknown(name, "input");
        }
        let returns = declared.returns.as_deref();
        if let Some(name) = returns.into_iter().flatten().find(|name| !output(component, name)) {
            return unknown(name, "output");
        }
        if let Some(name) = declared.crashed.keys().find(|id| self.cases.iter().all(|case| case.id != **id)) {
            return unknown(name, "case");
        }
        if let Some(takes) = takes {
            let needs = |inputs: &Arrays| needed(component, takes, inputs, dtype).join(", ");
            let out = self.cases.iter().map(|case| (case.id.clone(), needs(&case.inputs)));
            self.left_out = out.filter(|(_, needs)| !needs.is_empty()).collect();
            self.cases.retain(|case| !self.left_out.contains_key(&case.id));
        }
        if let Some(returns) = returns.filter(|_| self.kind == Kind::Vjp) {
            let given = |name: &str| returns.iter().any(|output| output == name);
            for (name, cotangent) in self.cases.iter_mut().flat_map(|case| case.inputs.iter_mut()) {
                if name.strip_prefix("grad_").is_some_and(|bare| !given(bare)) {
                    cotangent.fill(0.0);
                }
            }
        }
        self.crashed = declared.crashed.clone();
        Ok(())
    }
}

fn output(component: &Component, name: &str) -> bool {
    component.outputs.iter().any(|port| port.covers(name))
}
