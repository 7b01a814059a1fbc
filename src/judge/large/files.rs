//! Large cases as files: the manifest has the recipes of their inputs, so that the inputs themselves are written only where that is asked.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use ndarray::ArrayD;
use serde_json::{Value, json};

use super::{Asked, LargeExam, examine, head};
use crate::contract::laid::Laid;
use crate::contract::recipe::Recipe;
use crate::convention::profiles;
use crate::error::{Error, Result};
use crate::files::layout::Layout;
use crate::files::{self, npz};
use crate::judge::answer::Reply;
use crate::judge::exam::{Manifest, Question};
use crate::judge::exchange::{
    as_written, complete, layout_of, narrowed, nothing_else, read_arrays, read_manifest, stored,
};
use crate::judge::report::Report;

/// What the manifest calls this tier.
pub const TIER: &str = "large";

impl LargeExam {
    /// What `cases.json` says: each input with its recipe.
    pub fn manifest(&self) -> Manifest {
        let cases = self.exam.questions.iter().zip(&self.laid);
        let entries =
            cases.flat_map(|(question, laid)| laid.iter().map(move |laid| self.entry(question, laid)));
        Manifest { tier: Some(TIER.into()), ..self.exam.manifest_of(entries.collect()) }
    }

    fn entry(&self, question: &Question, laid: &Laid) -> Value {
        let inputs = laid.large.inputs.iter().map(|made| {
            let mut input = self.exam.input(question, &made.name, &made.shape);
            input["recipe"] = described(&made.recipe);
            input["key"] = json!(laid.key(made));
            input
        });
        let outputs: BTreeMap<String, Vec<usize>> = laid.outputs.iter().cloned().collect();
        self.exam.described(question, &laid.part(0..head(laid)), inputs.collect(), &outputs)
    }
}

/// A recipe for machines.
fn described(recipe: &Recipe) -> Value {
    match *recipe {
        Recipe::Constant(x) => json!({ "law": "constant", "is": x }),
        Recipe::Unit => json!({ "law": "fraction" }),
        Recipe::Float { lowest, binades, signed, empty } => {
            json!({ "law": "float", "lowest": lowest, "binades": binades, "signed": signed, "empty": empty })
        }
        Recipe::Ascending { cells } => json!({ "law": "ascending", "cells": cells }),
        Recipe::Each(each) => json!({ "law": "each", "each": each }),
        Recipe::Cycle(laws) => {
            json!({ "law": "cycle", "of": laws.iter().map(described).collect::<Vec<Value>>() })
        }
        Recipe::Offsets { most } => json!({ "law": "running", "most": most }),
    }
}

/// Writes `cases.json`, and where `inputs` one npz a case. Returns the bytes written.
///
/// # Errors
/// Where the folder can't be written.
pub fn write(large: &LargeExam, folder: &Path, inputs: bool) -> Result<u64> {
    files::make_folder(folder)?;
    let manifest = serde_json::to_string_pretty(&large.manifest()).expect("a manifest is plain data");
    files::write(&folder.join("cases.json"), &manifest)?;
    let mut bytes = manifest.len() as u64;
    for (question, laid) in large.exam.questions.iter().zip(&large.laid).filter(|_| inputs) {
        files::make_folder(&folder.join(question.component.name))?;
        for laid in laid {
            let case = laid.whole();
            let path = folder.join(question.path(&case) + ".npz");
            let arrays = |(name, a): (&String, &ArrayD<f64>)| {
                (name.clone(), stored(name, a, question, large.exam.dtype))
            };
            npz::write(&path, &case.inputs.iter().map(arrays).collect(), false)?;
            bytes += fs::metadata(&path).map(|data| data.len()).map_err(Error::reading(&path))?;
        }
    }
    Ok(bytes)
}

/// The exam that a folder of large cases holds: built again here, then compared. Inputs that were written are compared too.
///
/// # Errors
/// A manifest or an npz that isn't what [`write`] writes, named with its file.
pub fn read(folder: &Path) -> Result<LargeExam> {
    let found = read_manifest(folder)?;
    let profile = found.profile.as_deref().map(profiles::find).transpose()?;
    let large = LargeExam::new(&found.filter, found.dtype.parse()?, profile)?;
    complete(folder, &found, &large.manifest())?;
    for (question, laid) in large.exam.questions.iter().zip(&large.laid) {
        for (laid, case) in laid.iter().zip(&question.cases) {
            let path = folder.join(question.path(case) + ".npz");
            if path.exists() {
                as_written(Layout::Npz, folder, &question.path(case), &laid.whole())?;
            }
        }
    }
    Ok(large)
}

/// Judges the answers in a folder, one file at a time.
///
/// # Errors
/// Anything in the folder that the manifest doesn't list, links, files that are damaged, too large, or don't hold numbers.
pub fn judged(large: LargeExam, folder: &Path, exp_ulp: f64) -> Result<Report> {
    let large = narrowed(large, folder, LargeExam::narrowed)?;
    nothing_else(&large.exam, folder)?;
    examine(large, exp_ulp, |question, asked| match asked {
        Asked::Whole(laid) => answer(question, laid, folder),
        Asked::Alone(_) => Ok(Reply::Nothing),
    })
}

fn answer(question: &Question, laid: &Laid, folder: &Path) -> Result<Reply> {
    let case = question.cases.iter().find(|case| case.id == laid.large.id).expect("a case of the question");
    let place = question.path(case);
    let Some(layout) = layout_of(folder, &place)? else { return Ok(Reply::Nothing) };
    let bytes = |shape: &[usize]| 8 * shape.iter().product::<usize>() as u64;
    let outputs: u64 = laid.outputs.iter().map(|(_, shape)| bytes(shape)).sum();
    let inputs: u64 = laid.large.inputs.iter().map(|made| bytes(&made.shape)).sum();
    let names = laid.outputs.iter().map(|(name, _)| name).collect();
    read_arrays(layout, folder, &place, names, 2 * outputs + inputs).map(Reply::Answer)
}
