//! Every row of the contract as JSON, so that the Python half names none.

use nerf_oracle::contract::{Component, Mistake, Port};
use nerf_oracle::convention::CHOICES;
use nerf_oracle::convention::profiles::PROFILES;
use nerf_oracle::registry::all_rows;
use pyo3::prelude::*;
use serde_json::{Value, json};

/// Rows, profiles and conventions.
#[pyfunction]
pub(crate) fn registry() -> String {
    let profiles = PROFILES.iter().map(|p| json!({ "name": p.name, "title": p.title }));
    let choices = CHOICES.iter().map(|(key, values)| json!({ "name": key, "values": values }));
    json!({
        "version": env!("CARGO_PKG_VERSION"),
        "rows": all_rows().map(row).collect::<Vec<_>>(),
        "profiles": profiles.collect::<Vec<_>>(),
        "conventions": choices.collect::<Vec<_>>(),
    })
    .to_string()
}

fn row(c: &Component) -> Value {
    let forms = c.special.forms.iter();
    json!({
        "name": c.name,
        "kind": c.special.forward_name,
        "formula": c.formula,
        "source": c.source,
        "inputs": c.inputs.iter().map(port).collect::<Vec<_>>(),
        "outputs": c.outputs.iter().map(port).collect::<Vec<_>>(),
        "vjp": c.vjp.is_some(),
        "statistics": c.special.statistics.is_some(),
        "conventions": c.conventions,
        "forms": forms.map(|f| json!({ "without": f.without, "takes": f.takes, "meaning": f.meaning })).collect::<Vec<_>>(),
        "mistakes": c.mistakes.iter().map(mistake).collect::<Vec<_>>(),
    })
}

fn port(port: &Port) -> Value {
    json!({
        "name": port.name,
        "shape": port.shape,
        "meaning": port.meaning,
        "gradient": port.gradient,
        "whole": port.entries.whole(),
    })
}

fn mistake(m: &Mistake) -> Value {
    json!({ "name": m.name, "cause": m.cause, "effect": m.effect, "fix": m.fix, "seen": m.seen })
}
