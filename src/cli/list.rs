//! `list`: what there is to check.

use std::process::ExitCode;

use serde_json::{Value, json};

use super::output;
use crate::contract::Component;
use crate::convention::CHOICES;
use crate::convention::profiles::PROFILES;
use crate::error::Result;
use crate::registry::all_rows;

/// List components, their mistakes, conventions and profiles.
#[derive(clap::Args, Debug)]
pub(super) struct Args {}

/// Runs it.
///
/// # Errors
/// None.
pub(super) fn run(_: &Args, json: bool) -> Result<ExitCode> {
    let object = json!({
        "components": all_rows().map(object).collect::<Vec<_>>(),
        "conventions": CHOICES.iter().map(|(key, values)| json!({ "name": key, "values": values })).collect::<Vec<_>>(),
        "profiles": PROFILES.iter().map(|p| json!({ "name": p.name, "title": p.title })).collect::<Vec<_>>(),
    });
    output::print(json, &object, &text())?;
    Ok(ExitCode::SUCCESS)
}

fn object(c: &Component) -> Value {
    json!({
        "name": c.name,
        "folder": c.folder,
        "formula": c.formula,
        "source": c.source,
        "vjp": c.vjp.is_some(),
        "conventions": c.conventions,
        "variants": variants(c),
        "mistakes": c.mistakes.iter().map(|m| m.name).collect::<Vec<_>>(),
        "gradient_mistakes": c.mistakes.iter().filter(|m| m.gradient).map(|m| m.name).collect::<Vec<_>>(),
    })
}

/// The directions that can be judged.
fn variants(c: &Component) -> Vec<&'static str> {
    match c.vjp {
        None if c.special.statistics.is_some() => vec![c.special.forward_name],
        Some(_) => vec!["forward", "vjp"],
        None => vec!["forward"],
    }
}

fn text() -> String {
    let mut text = String::new();
    for c in all_rows() {
        let names = c.mistakes.iter().map(|m| m.name).collect::<Vec<_>>().join(", ");
        text += &format!("{:<24}{:<14}{}\n", c.name, variants(c).join(", "), c.formula);
        if !c.conventions.is_empty() {
            text += &format!("    conventions: {}\n", c.conventions.join(", "));
        }
        if !names.is_empty() {
            text += &format!("    mistakes: {names}\n");
        }
    }
    let profiles = PROFILES.iter().map(|p| p.name).collect::<Vec<_>>().join(", ");
    text + &format!("\nprofiles: {profiles}\nnerf-oracle explain NAME tells more about any of these names.\n")
}
