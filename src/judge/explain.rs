//! What a name stands for: components, mistakes, conventions, profiles, and hazards by their ids.

use serde_json::{Value, json};

use crate::contract::arithmetic::{Arithmetic, Dtype, Grade};
use crate::contract::check::{Kind, tolerance};
use crate::contract::component::{Component, Mistake, Port};
use crate::contract::hazard::{HAZARDS, Hazard, of_case};
use crate::convention::profiles::{PROFILES, Profile};
use crate::convention::{CHOICES, CS180, american};
use crate::error::{Error, Result};
use crate::registry::{COMPONENTS, all_rows};

/// Everything of this name, for machines and for people. British spellings are read too.
///
/// # Errors
/// A name that nothing has; names that resemble it are suggested.
///
/// ```
/// use nerf_oracle::judge::explain::explain;
/// assert!(explain("VR9").unwrap().1.starts_with("VR9: a hazard"));
/// assert_eq!(explain("centre_swapped").unwrap(), explain("center_swapped").unwrap());
/// ```
pub fn explain(name: &str) -> Result<(Value, String)> {
    let name = &*american(name);
    let mut found: Vec<(Value, String)> = all_rows().filter(|c| c.name == name).map(component).collect();
    let rows = all_rows().flat_map(|c| c.mistakes.iter().map(move |m| (c, m)));
    found.extend(rows.filter(|(_, m)| m.name == name).map(|(c, m)| mistake(c, m)));
    found.extend(CHOICES.iter().filter(|(key, _)| *key == name).map(|(key, values)| convention(key, values)));
    found.extend(PROFILES.iter().filter(|p| p.name == name).map(profile));
    found.extend(HAZARDS.iter().filter(|h| h.id == name).map(hazard));
    if found.is_empty() {
        return Err(Error::usage("name", name, suggestions(name)));
    }
    let (objects, texts): (Vec<_>, Vec<_>) = found.into_iter().unzip();
    Ok((json!({ "name": name, "found": objects }), texts.join("\n")))
}

/// Names that share a part with `name`, or where to look.
fn suggestions(name: &str) -> String {
    let mistakes = all_rows().flat_map(|c| c.mistakes.iter().map(|m| m.name));
    let others = CHOICES.iter().map(|(key, _)| *key).chain(PROFILES.iter().map(|p| p.name));
    let others = others.chain(HAZARDS.iter().map(|h| h.id));
    let all = all_rows().map(|c| c.name).chain(mistakes).chain(others);
    let near = |other: &&str| name.split(['_', '-']).any(|part| part.len() > 2 && other.contains(part));
    let near: Vec<_> = all.filter(near).collect();
    if near.is_empty() {
        "the name of a row, a convention, a profile, a mistake or a hazard".into()
    } else {
        near.join(", ")
    }
}

fn component(c: &Component) -> (Value, String) {
    let ports = |ports: &[Port]| {
        let line = |p: &Port| {
            format!("  {:<16}({}){} {}\n", p.name, p.shape, if p.gradient { " *" } else { "" }, p.meaning)
        };
        ports.iter().map(line).collect::<String>()
    };
    let mut text = format!("{}: a component\n\n  {}\n  source: {}\n", c.name, c.formula, c.source);
    text += &format!("\ninputs (* differentiable)\n{}outputs\n{}", ports(c.inputs), ports(c.outputs));
    text +=
        "\ntolerance: derived element by element; on this component's cases, bound over the largest output\n";
    let sizes: Vec<(Dtype, f64)> =
        Dtype::ALL.into_iter().map(|dtype| (dtype, size_of_bound(c, dtype))).collect();
    for (dtype, size) in &sizes {
        text += &format!("  {dtype:<6}{size:.1e}\n");
    }
    for key in c.conventions {
        text += &format!("convention: {key}\n");
    }
    for m in c.mistakes {
        text += &format!("mistake: {}: {}\n", m.name, m.cause);
    }
    let object = json!({
        "what": "component", "name": c.name, "formula": c.formula, "source": c.source,
        "tolerance": sizes.iter().map(|(d, s)| (d.to_string(), json!(s))).collect::<serde_json::Map<_, _>>(),
        "conventions": c.conventions, "mistakes": c.mistakes.iter().map(|m| m.name).collect::<Vec<_>>(),
    });
    (object, text)
}

/// The median over cases and outputs of the largest bound, relative to the largest value.
fn size_of_bound(c: &Component, dtype: Dtype) -> f64 {
    let mut sizes = vec![];
    for case in c.cases_of(Kind::Forward, &CS180).iter().filter(|case| case.exists_in(dtype)) {
        let expected = (c.forward.oracle)(&case.inputs, &CS180);
        let bound = tolerance(&c.forward, &case.inputs, &CS180, &Arithmetic::new(dtype, Grade::B));
        let largest = |a: &ndarray::ArrayD<f64>| a.iter().fold(0.0, |max: f64, x| max.max(x.abs()));
        sizes.extend(expected.iter().map(|(n, e)| largest(&bound[n]) / largest(e)).filter(|s| s.is_finite()));
    }
    sizes.sort_by(f64::total_cmp);
    sizes.get(sizes.len() / 2).copied().unwrap_or(0.0)
}

fn mistake(c: &Component, m: &Mistake) -> (Value, String) {
    let what = if m.gradient { "a mistake in the gradient" } else { "a mistake" };
    let text = format!(
        "{}: {what} of {}\n\n  formula: {}\n  right:   {}\n  effect:  {}\n  to fix:  {}\n  seen:    {}\n  source:  {}\n",
        m.name, c.name, m.cause, c.formula, m.effect, m.fix, m.seen, c.source
    );
    let object = json!({
        "what": "mistake", "name": m.name, "component": c.name, "gradient": m.gradient, "formula": m.cause,
        "right": c.formula, "effect": m.effect, "fix": m.fix, "seen": m.seen, "count": m.count, "source": c.source,
    });
    (object, text)
}

fn convention(key: &str, values: &[&str]) -> (Value, String) {
    let depend: Vec<&str> =
        COMPONENTS.iter().filter(|c| c.conventions.contains(&key)).map(|c| c.name).collect();
    let mut text = format!("{key}: a convention (a choice, never a mistake) of {}\n\n", depend.join(", "));
    for value in values {
        let with = PROFILES.iter().filter(|p| p.conventions.get(key) == *value).map(|p| p.name);
        text += &format!("  {value:<24}{}\n", with.collect::<Vec<_>>().join(", "));
    }
    let sources = PROFILES.iter().flat_map(|p| p.sources.iter().map(move |s| (p.name, s)));
    for (name, (_, source)) in sources.filter(|(_, (other, _))| *other == key) {
        text += &format!("  {name}: {source}\n");
    }
    (json!({ "what": "convention", "name": key, "values": values, "components": depend }), text)
}

fn profile(p: &Profile) -> (Value, String) {
    let mut text = format!("{}: a profile, {}\n\n", p.name, p.title);
    let source =
        |key: &str| p.sources.iter().find(|(other, _)| *other == key).map_or("", |(_, source)| source);
    for (key, _) in CHOICES {
        text += &format!("  {key:<14}{:<22}{}\n", p.conventions.get(key), source(key));
    }
    if !p.beyond.is_empty() {
        text += &format!("  beyond any convention here: {}\n", p.beyond);
    }
    let values = CHOICES
        .iter()
        .map(|(key, _)| (key.to_string(), json!({ "value": p.conventions.get(key), "source": source(key) })));
    let values = values.collect::<serde_json::Map<_, _>>();
    (
        json!({ "what": "profile", "name": p.name, "title": p.title, "conventions": values, "beyond": p.beyond }),
        text,
    )
}

fn hazard(h: &Hazard) -> (Value, String) {
    let mut text =
        format!("{}: a hazard, {}\n\n  effect:  {}\n  seen:    {}\n", h.id, h.title, h.effect, h.seen);
    let mut cases = vec![];
    for component in COMPONENTS {
        let of_this = |id: &str| of_case(id).is_some_and(|other| other.id == h.id);
        for case in (component.cases)().iter().filter(|case| of_this(&case.id)) {
            text += &format!("case: {} {}: {}\n", component.name, case.id, case.comment);
            cases.push(json!({ "component": component.name, "id": case.id, "meaning": case.comment }));
        }
    }
    let object = json!({
        "what": "hazard", "name": h.id, "title": h.title, "effect": h.effect, "seen": h.seen, "cases": cases,
    });
    (object, text)
}
