//! `list`: what there is to check.

use std::process::ExitCode;

use serde_json::{Value, json};

use super::output;
use crate::COMPONENTS;
use crate::contract::Component;
use crate::convention::CHOICES;
use crate::convention::profiles::PROFILES;
use crate::error::Result;
use crate::judge::sampler::SAMPLER;

/// List components, their mistakes, conventions and profiles.
#[derive(clap::Args, Debug)]
pub struct Args {}

/// Runs it.
///
/// # Errors
/// None.
pub fn run(_: &Args, json: bool) -> Result<ExitCode> {
    let object = json!({
        "components": rows().map(object).collect::<Vec<_>>(),
        "conventions": CHOICES.iter().map(|(key, values)| json!({ "name": key, "values": values })).collect::<Vec<_>>(),
        "profiles": PROFILES.iter().map(|p| json!({ "name": p.name, "title": p.title })).collect::<Vec<_>>(),
    });
    output::print(json, &object, &text());
    Ok(ExitCode::SUCCESS)
}

/// The rows of the contract, and the one that is judged by statistics.
fn rows() -> impl Iterator<Item = &'static Component> {
    COMPONENTS.iter().chain([&SAMPLER])
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
    match c.name {
        name if name == SAMPLER.name => vec!["statistics"],
        _ if c.vjp.is_some() => vec!["forward", "vjp"],
        _ => vec!["forward"],
    }
}

fn text() -> String {
    let mut text = String::new();
    for c in rows() {
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
