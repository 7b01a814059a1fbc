//! The catalogue of conventions, mistakes and hazards as a page, generated from the code.
#![doc = include_str!("../../tests/pages/CATALOGUE.md")]

use super::selfcheck;
use crate::contract::arithmetic::Dtype;
use crate::contract::component::{Component, Mistake};
use crate::contract::hazard::{HAZARDS, of_case};
use crate::convention::CHOICES;
use crate::convention::profiles::PROFILES;
use crate::registry::{COMPONENTS, STATISTICAL};

/// The page.
pub fn page() -> String {
    let mut page = String::from(
        "# Conventions, profiles, mistakes and hazards\n\nWritten by `nerf-oracle check --catalogue`; a test keeps it current.\n",
    );
    page += "\n## Conventions by profile\n\n| convention |";
    for p in PROFILES {
        page += &format!(" `{}` |", p.name);
    }
    page += &format!("\n|---|{}\n", "---|".repeat(PROFILES.len()));
    for (key, _) in CHOICES {
        page += &format!("| {key} |");
        for p in PROFILES {
            page += &format!(" {} |", p.conventions.get(key));
        }
        page += "\n";
    }
    page += "\n## Where the values were read\n\n";
    for p in PROFILES {
        page += &format!("* **{}**, {}.\n", p.name, p.title);
        for (key, source) in p.sources {
            page += &format!("  * {key}: {}\n", escaped(source));
        }
        if !p.beyond.is_empty() {
            page += &format!("  * beyond any convention here: {}\n", escaped(p.beyond));
        }
    }
    page += "\n## Mistakes\n\n`f32`, `bf16`: whether the mistake exceeds the bound there on some case (in f64 all do).\n";
    COMPONENTS.iter().for_each(|c| page += &table(c));
    page += &STATISTICAL.iter().map(by_statistics).collect::<String>();
    page + &hazards()
}

/// The glossary of hazards, with the cases of each.
fn hazards() -> String {
    let mut text = String::from("\n## Hazards\n\nThe id of a hard case begins with that of its hazard.\n\n");
    text += "| hazard | what it is | what goes wrong | seen | cases |\n|---|---|---|---|---|\n";
    for h in HAZARDS {
        let rows = COMPONENTS.iter().flat_map(|c| (c.cases)().into_iter().map(move |case| (c.name, case.id)));
        let cases: Vec<String> = rows
            .filter(|(_, id)| of_case(id).is_some_and(|other| other.id == h.id))
            .map(|(name, id)| escaped(&format!("{name} {id}")))
            .collect();
        let cells = [h.title, h.effect, h.seen].map(escaped).join(" | ");
        text += &format!("| {} | {cells} | {} |\n", h.id, cases.join(", "));
    }
    text
}

/// The mistakes that only statistics over several calls show.
fn by_statistics(c: &Component) -> String {
    let mut text = format!("\n### {}\n\n`{}`\n\n", c.name, c.formula);
    text += "| mistake | what was written | effect | to fix | seen |\n|---|---|---|---|---|\n";
    for m in c.mistakes {
        let cells = [m.cause, m.effect, m.fix, m.seen].map(escaped).join(" | ");
        text += &format!("| {} | {cells} |\n", m.name);
    }
    text
}

fn table(c: &Component) -> String {
    let rows = selfcheck::all();
    let caught = |m: &Mistake, dtype: Dtype| {
        let shows =
            |r: &&selfcheck::Row| r.name == c.name && r.dtype == dtype && (r.kind == "vjp") == m.gradient;
        let missed = rows.iter().find(shows).is_none_or(|r| r.missed_names().contains(&m.name));
        if missed { "no" } else { "yes" }
    };
    let mut text = format!("\n### {}\n\n`{}`\n\n", c.name, c.formula);
    if c.mistakes.is_empty() {
        return text + "None.\n";
    }
    text += "| mistake | what was written | effect | to fix | seen | f32 | bf16 |\n|---|---|---|---|---|---|---|\n";
    for m in c.mistakes {
        let cells = [m.cause, m.effect, m.fix, m.seen].map(escaped).join(" | ");
        text +=
            &format!("| {} | {cells} | {} | {} |\n", m.name, caught(m, Dtype::F32), caught(m, Dtype::Bf16));
    }
    text
}

/// Text for a table's cell, in which rustdoc sees no links and no HTML.
fn escaped(text: &str) -> String {
    text.replace('|', "\\|")
        .replace('[', "\\[")
        .replace(']', "\\]")
        .replace('<', "&lt;")
        .replace('*', "\\*")
        .replace('_', "\\_")
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_page_is_current() {
        let current = super::page() == include_str!("../../tests/pages/CATALOGUE.md");
        assert!(current, "write it again: nerf-oracle check --catalogue tests/pages/CATALOGUE.md");
    }
}
