//! An exam whose questions Python answers.

use std::collections::{BTreeMap, HashMap};

use nerf_oracle::contract::{Case, Kind};
use nerf_oracle::judge::answer::{Answer, Given, Manner, Reply};
use nerf_oracle::judge::asking::examine;
use nerf_oracle::judge::declared::Declared;
use nerf_oracle::judge::exam::Question;
use nerf_oracle::judge::judging::EXP_ULP;
use nerf_oracle::judge::large::{self, Asked};
use nerf_oracle::judge::{Exam as Questions, LargeExam as Large, Report, Verdict};
use numpy::PyReadonlyArrayDyn;
use pyo3::prelude::*;
use pyo3::types::PyString;

use crate::arrays::{component, dict, dtype, kind, owned, profile, value_error};

/// Types as the judge names them, which it tells an answer's width by.
const TYPES: [&str; 5] = ["f64", "f32", "f16", "i64", "u8"];

/// The inputs that a candidate takes and the outputs that its gradient goes through; None: all.
type TakesAndReturns = (Option<Vec<String>>, Option<Vec<String>>);

/// Questions on rows in a type.
#[pyclass(frozen)]
pub(crate) struct Exam(Questions);

#[pymethods]
impl Exam {
    /// The judge's own cases of `rows`: (name, direction).
    #[new]
    #[pyo3(signature = (rows, dtype, profile=None))]
    fn new(rows: Vec<(String, String)>, dtype: &str, profile: Option<&str>) -> PyResult<Exam> {
        let rows: Vec<(&str, Kind)> =
            rows.iter().map(|(name, direction)| (&name[..], kind(direction))).collect();
        let exam = Questions::of(&rows, self::dtype(dtype)?, self::profile(profile)?).map_err(value_error)?;
        Ok(Exam(exam))
    }

    /// One case of somebody's own.
    #[staticmethod]
    #[pyo3(signature = (row, direction, inputs, dtype, profile=None))]
    fn on(
        row: &str,
        direction: &str,
        inputs: crate::arrays::Given,
        dtype: &str,
        profile: Option<&str>,
    ) -> PyResult<Exam> {
        let case = Case { inputs: owned(&inputs).into(), ..Case::new("yours", "your own data", vec![]) };
        let (component, kind) = (component(row)?, kind(direction));
        if component.direction(kind).is_none() {
            return Err(value_error(format!("{row}: it has no gradient in the contract")));
        }
        let questions = vec![Question::new(component, kind, vec![case])];
        let (dtype, profile) = (self::dtype(dtype)?, self::profile(profile)?);
        Ok(Exam(Questions { dtype, profile, filter: String::new(), questions, left_out: vec![] }))
    }

    /// `cases.json` of these questions.
    fn manifest(&self) -> PyResult<String> {
        serde_json::to_string(&self.0.manifest()).map_err(value_error)
    }

    /// The inputs of a case, in f64.
    fn inputs<'py>(&self, py: Python<'py>, row: &str, id: &str) -> PyResult<Bound<'py, pyo3::types::PyDict>> {
        let question = self.0.questions.iter().find(|question| question.row() == row);
        let case = question.and_then(|question| question.cases.iter().find(|case| case.id == id));
        dict(py, &case.ok_or_else(|| value_error(format!("{row}: no case {id}")))?.inputs)
    }

    /// Asks `ask(row, id, inputs, strided)` every question, with arrays of those inputs that have gaps between their elements where `strided`, and
    /// judges what it returns: a dict of (array in f64, its type); a text where the candidate crashed; None for no answer. What `ask` raises ends the exam. `declared` is what it takes and returns, by row. Returns
    /// the report as JSON, as a page, and whether it passed.
    fn judge(
        &self,
        py: Python,
        ask: Py<PyAny>,
        declared: HashMap<String, TakesAndReturns>,
        again: bool,
        allowed: Vec<String>,
    ) -> PyResult<(String, String, bool)> {
        let exam = self.0.clone().narrowed(&by_row(declared)).map_err(value_error)?;
        let asked = |question: &Question, case: &Case, manner| put(&ask, question, case, manner);
        let report = py.detach(|| examine(exam, again, asked))?;
        Ok(said(&report, &allowed))
    }
}

/// Questions of real sizes.
#[pyclass(frozen)]
pub(crate) struct LargeExam(Large);

#[pymethods]
impl LargeExam {
    /// The large cases of `rows`: (name, direction); those without any are left out.
    #[new]
    #[pyo3(signature = (rows, dtype, profile=None))]
    fn new(rows: Vec<(String, String)>, dtype: &str, profile: Option<&str>) -> PyResult<LargeExam> {
        let rows: Vec<(&str, Kind)> =
            rows.iter().map(|(name, direction)| (&name[..], kind(direction))).collect();
        let large = Large::of(&rows, self::dtype(dtype)?, self::profile(profile)?).map_err(value_error)?;
        Ok(LargeExam(large))
    }

    /// `cases.json` of these questions.
    fn manifest(&self) -> PyResult<String> {
        serde_json::to_string(&self.0.manifest()).map_err(value_error)
    }

    /// As the small exam's, each question twice.
    fn judge(
        &self,
        py: Python,
        ask: Py<PyAny>,
        declared: HashMap<String, TakesAndReturns>,
        allowed: Vec<String>,
    ) -> PyResult<(String, String, bool)> {
        let large = self.0.clone().narrowed(&by_row(declared)).map_err(value_error)?;
        let asked = |question: &Question, asked: Asked| match asked {
            Asked::Whole(laid) => put(&ask, question, &laid.whole(), Manner::Plain),
            // The manifest has the shapes of whole cases alone.
            Asked::Alone(_) => Ok(Reply::Nothing),
        };
        let report = py.detach(|| large::examine(large, EXP_ULP, asked))?;
        Ok(said(&report, &allowed))
    }
}

fn by_row(declared: HashMap<String, TakesAndReturns>) -> BTreeMap<String, Declared> {
    let one = |(row, (takes, returns))| (row, Declared { takes, returns, crashed: BTreeMap::new() });
    declared.into_iter().map(one).collect()
}

/// Asks Python a question.
fn put(ask: &Py<PyAny>, question: &Question, case: &Case, manner: Manner) -> PyResult<Reply> {
    let strided = manner == Manner::Strided;
    Python::attach(|py| {
        reply(ask.bind(py).call1((question.row(), &case.id, dict(py, &case.inputs)?, strided))?)
    })
}

/// A report as JSON, as a page, and whether it passed.
fn said(report: &Report, allowed: &[String]) -> (String, String, bool) {
    let allowed: Vec<Verdict> = [Verdict::Imprecise, Verdict::Edge, Verdict::Unproved]
        .into_iter()
        .filter(|verdict| allowed.contains(&verdict.to_string()))
        .collect();
    (report.json().to_string(), report.to_string(), report.exit_code_allowing(&allowed) == 0)
}

fn reply(said: Bound<PyAny>) -> PyResult<Reply> {
    if said.is_none() {
        return Ok(Reply::Nothing);
    }
    if let Ok(text) = said.cast::<PyString>() {
        return Ok(Reply::Crash(text.to_string()));
    }
    let arrays: HashMap<String, (PyReadonlyArrayDyn<f64>, String)> = said.extract()?;
    let given = |(name, (array, dtype)): (String, (PyReadonlyArrayDyn<f64>, String))| {
        let dtype = TYPES.into_iter().find(|known| *known == dtype);
        let dtype = dtype.ok_or_else(|| value_error(format!("{name}: a type that no answer has")))?;
        Ok((name, Given { values: array.as_array().as_standard_layout().into_owned(), dtype }))
    };
    Ok(Reply::Answer(arrays.into_iter().map(given).collect::<PyResult<Answer>>()?))
}
