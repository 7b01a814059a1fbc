//! A submission in Python: copied, asked in a process of its own, and heard.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::{Value, json};

use super::answers::{self, Heard, Place};
use super::rubric::{Row, Rubric};
use super::sandbox::{Job, Sandbox, last_line, seconds};
use super::submission::{Submission, scan};
use crate::contract::check::Kind;
use crate::judge::Exam;
use crate::process::{Ended, Said};

/// Letters of what a submission says that are shown.
const SHOWN: usize = 400;

/// The questions that are put to Python: the rubric's, and of a gradient's row the forward ones, whose outputs autograd goes through.
pub(crate) fn asked(rubric: &Rubric) -> crate::error::Result<Exam> {
    let mut names: BTreeSet<_> = rubric.rows.iter().map(|row| (row.component.name, row.kind)).collect();
    names.extend(rubric.rows.iter().map(|row| (row.component.name, Kind::Forward)));
    let names: Vec<_> = names.into_iter().collect();
    Exam::of(&names, rubric.exam.dtype, rubric.exam.profile)
}

/// Runs a submission, and reads what it has answered. Where it is stopped in the middle of a component, the others are asked in a new
/// process: an endless loop costs its own rows. One that doesn't get through its imports isn't asked any more.
///
/// # Errors
/// Why there is nothing to judge.
pub(crate) fn ask(rubric: &Rubric, submission: &Submission, sandbox: &Sandbox) -> Result<Heard, String> {
    let job = sandbox.job(&submission.slug).map_err(|error| error.to_string())?;
    submission.copy(&job.code())?;
    let mut parts = plan(rubric);
    let mut stops: BTreeMap<String, String> = BTreeMap::new();
    let log = loop {
        let ended = sandbox.run(&job, &[("components", json!(parts))]);
        let log = Log::read(&job, sandbox);
        let Some(why) = why_stopped(ended, &log, rubric, |text| sandbox.plain(text, &job))? else {
            break log;
        };
        let at = parts.iter().position(|part| part["component"] == *log.component);
        let left = match at.filter(|_| !log.doing.starts_with("importing")) {
            Some(at) => parts.split_off(at + 1),
            None => vec![],
        };
        // What was asked before it has its own outcome.
        let last = parts.iter().skip(at.unwrap_or(0));
        stops.extend(last.map(|part| (name(part), why.clone())));
        parts = left;
        if parts.is_empty() {
            break log;
        }
    };
    let stopped = stops.values().next().cloned();
    let regular = std::fs::symlink_metadata(job.answers()).is_ok_and(|there| there.is_dir());
    let gone = || Err("the folder of its answers is gone".to_string());
    let links = if regular { scan(&job.answers(), "", 0, &mut vec![]) } else { gone() };
    if let Err(reason) = links {
        return Err(stopped.unwrap_or(reason));
    }
    let mut heard = answers::read(&rubric.exam, &job.answers())?;
    for question in &heard.exam.questions {
        let component = question.component.name;
        let why = log.failed.get(component).or(stops.get(component)).or(log.unsupported.get(&question.row()));
        if let Some(why) = why {
            heard.absent.entry(question.row()).or_insert(why.clone());
        }
    }
    (heard.places, heard.stopped) = (log.places, stopped);
    Ok(heard)
}

fn name(part: &Value) -> String {
    part["component"].as_str().unwrap_or_default().to_string()
}

/// Why a process didn't get to its end, if it didn't.
///
/// # Errors
/// Where it couldn't even be started.
fn why_stopped(
    ended: Result<Said, Ended>,
    log: &Log,
    rubric: &Rubric,
    plain: impl Fn(&str) -> String,
) -> Result<Option<String>, String> {
    let doing = if log.doing.is_empty() { String::new() } else { format!(", while {}", log.doing) };
    Ok(match ended {
        Err(Ended::TooLong) => Some(format!("no end within {}{doing}", seconds(rubric.limits.time))),
        Err(Ended::TooMuch) => Some(format!("more than {} MiB of output{doing}", rubric.limits.output_mib)),
        Err(Ended::Other(error)) => return Err(format!("it can't be started: {error}")),
        Ok(_) if log.done => None,
        Ok(said) => {
            let last =
                last_line(&said.stderr).map_or(String::new(), |line| format!(": {}", shorter(&plain(&line))));
            Some(format!("it ended by itself, {}{doing}{last}", said.status))
        }
    })
}

/// The functions that are asked, component by component.
fn plan(rubric: &Rubric) -> Vec<Value> {
    let mut parts: Vec<Value> = vec![];
    for question in &rubric.exam.questions {
        let name = question.component.name;
        if parts.iter().any(|part| part["component"] == name) {
            continue;
        }
        let rows: Vec<&Row> = rubric.rows.iter().filter(|row| row.component.name == name).collect();
        let of = |kind: Kind| rows.iter().find(|row| row.kind == kind);
        let gradient = format!("{name}_vjp");
        let given = |kind: Kind, default: &str| {
            of(kind).and_then(|row| row.function.clone()).unwrap_or_else(|| default.to_string())
        };
        let mut functions = vec![(name.to_string(), given(Kind::Forward, name))];
        let mut optional = vec![];
        if let Some(row) = of(Kind::Vjp) {
            functions.push((gradient.clone(), given(Kind::Vjp, &gradient)));
            // By name only where the rubric says so: autograd takes its place.
            if row.function.is_none() {
                optional.push(gradient.clone());
            }
            // And a gradient of its own needs no forward function.
            if of(Kind::Forward).is_none() {
                optional.push(name.to_string());
            }
        }
        let renamed =
            |kind: Kind| of(kind).or(rows.first()).map(|row| row.parameters.clone()).unwrap_or_default();
        parts.push(json!({
            "component": name, "functions": functions.into_iter().collect::<BTreeMap<_, _>>(), "optional": optional,
            "parameters": { name: renamed(Kind::Forward), gradient: renamed(Kind::Vjp) },
        }));
    }
    parts
}

/// What the runner has written of a submission.
#[derive(Default)]
struct Log {
    /// What it was at last, and the component that that was for.
    doing: String,
    component: String,
    done: bool,
    /// Why a component wasn't, by its name.
    failed: BTreeMap<String, String>,
    /// Why a row has no answer, by `component/kind`.
    unsupported: BTreeMap<String, String>,
    /// By `component/kind`.
    places: BTreeMap<String, Place>,
}

impl Log {
    fn read(job: &Job, sandbox: &Sandbox) -> Log {
        let mut log = Log::default();
        for line in job.log() {
            let text = |value: &Value| value.as_str().map(|text| shorter(&sandbox.plain(text, job)));
            let component = text(&line["component"]).unwrap_or_default();
            log.done |= line["done"] == json!(true);
            if let Some(doing) = text(&line["doing"]) {
                (log.doing, log.component) = (doing, component.clone());
            }
            if let Some(why) = text(&line["failed"]) {
                log.failed.insert(component.clone(), why);
            }
            for (row, outcome) in line["outcomes"].as_object().into_iter().flatten() {
                if let Some(why) = text(outcome).filter(|why| !why.starts_with("answered")) {
                    // numpy has no gradients; a student wants to know what would have been one.
                    let numpy = why.ends_with("no function of torch tensors");
                    let gradient =
                        format!("no gradient: neither {component}_vjp nor a function of torch tensors");
                    log.unsupported.insert(row.clone(), if numpy { gradient } else { why });
                }
            }
            for (keyword, place) in line["places"].as_object().into_iter().flatten() {
                let Ok(place) = serde_json::from_value::<Place>(place.clone()) else { continue };
                let (name, kind) =
                    keyword.strip_suffix("_vjp").map_or((&keyword[..], "forward"), |name| (name, "vjp"));
                log.places.insert(format!("{name}/{kind}"), place);
            }
        }
        log
    }
}

/// A text at a length that fits a table.
fn shorter(text: &str) -> String {
    match text.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.to_string(),
    }
}
