//! Whether a checkpoint is what training writes: checked value by value before anything is computed with it.

use std::collections::BTreeSet;

use super::model::Model;
use super::watch::Watch;
use crate::error::{Error, Input, Result};
use crate::files::npz::{Array, Arrays};
use crate::limits::STEPS;

/// What a checkpoint puts before the name of an array of another program, which could be one of training's.
pub(crate) const FOREIGN: &str = "weights.";

const REMEDY: &str = "Use the checkpoint of this very run, or train it again.";

/// Loads a checkpoint's state into its model, all of it: numbers that training can't have written, arrays that the model doesn't have
/// and values that it doesn't take as they are are refused.
///
/// # Errors
/// Where anything isn't what training writes; `file` is named in the message.
pub(crate) fn restore(model: &mut dyn Model, state: &Arrays, step: u64, file: &str) -> Result<()> {
    numbers(state, step, file)?;
    model.restore(state, file)?;
    let mut unknown: BTreeSet<&String> = state.keys().filter(|name| !Watch::has(name)).collect();
    for (name, mine) in model.arrays() {
        unknown.remove(&name);
        let Some(array) = state.get(&name).filter(|array| **array != mine) else { continue };
        let whole = |array: &Array| matches!(array, Array::I64(_) | Array::U8(_));
        if mine.shape() != array.shape() || whole(&mine) != whole(array) {
            let of = |array: &Array| format!("{} {:?}", array.dtype(), array.shape());
            return wrong(file, &name, of(array), of(&mine));
        }
        // What the f64 reference has written is rounded where it is read for the f32 path.
        let (had, got) = (array.to_f64(), mine.to_f64());
        let other = |(had, got): &(&f64, &f64)| had != got && **had as f32 != **got as f32;
        if let Some((had, got)) = had.iter().zip(&got).find(other) {
            return wrong(file, &name, had, format!("{got}, or what else training can write"));
        }
    }
    match unknown.first() {
        Some(name) => wrong(file, name, "an array that this model doesn't have", "the model's own arrays"),
        None => Ok(()),
    }
}

/// That floats are finite, and second moments no less than 0; that steps are the checkpoint's.
///
/// # Errors
/// Where they aren't; `file` is named in the message.
pub(crate) fn numbers(state: &Arrays, step: u64, file: &str) -> Result<()> {
    state.iter().try_for_each(|(name, array)| numbers_of(name, array, step, file))
}

fn numbers_of(name: &str, array: &Array, step: u64, file: &str) -> Result<()> {
    if name.starts_with(FOREIGN) {
        // Another program's names mean nothing here; who takes the arrays checks them.
        return Ok(());
    }
    if let Array::I64(whole) = array {
        let counts = ["adam_step", "compact_progress"].iter().any(|counter| name.ends_with(counter));
        return match whole.first() {
            Some(&first) if counts && first != step as i64 => {
                wrong(file, name, first, format!("{step}, as step has"))
            }
            _ => Ok(()),
        };
    }
    // "v", "v.trunk0_w", "fine.v.trunk0_w", "level0_v".
    let squares = name == "v" || name.starts_with("v.") || name.contains(".v.") || name.ends_with("_v");
    let sound = |x: f64| x.is_finite() && !(squares && x < 0.0);
    let bad = match array {
        Array::F32(a) => a.iter().map(|&x| f64::from(x)).find(|&x| !sound(x)),
        Array::F64(a) => a.iter().copied().find(|&x| !sound(x)),
        _ => None,
    };
    let expected = if squares { "finite numbers, 0 or more" } else { "finite numbers" };
    bad.map_or(Ok(()), |x| wrong(file, name, x, expected))
}

/// The counts of a checkpoint: steps, seconds and samples so far, as they stand in the file.
///
/// # Errors
/// Where no run can have come to them.
pub(crate) fn counts(step: f64, seconds: f64, samples: f64, file: &str) -> Result<()> {
    // 2^53: beyond it a float skips whole numbers.
    let most = 9_007_199_254_740_992.0;
    for (name, value, most, whole) in [
        ("step", step, STEPS as f64, true),
        ("seconds", seconds, 1e10, false),
        ("samples", samples, most, true),
    ] {
        if !(0.0..=most).contains(&value) || (whole && value.fract() != 0.0) {
            let kind = if whole { "whole number" } else { "number" };
            return wrong(file, name, value, format!("a {kind} from 0 to {most}"));
        }
    }
    Ok(())
}

fn wrong(file: &str, field: &str, found: impl ToString, expected: impl ToString) -> Result<()> {
    Err(Error::input(Input { file, field, found, expected, remedy: REMEDY }))
}
