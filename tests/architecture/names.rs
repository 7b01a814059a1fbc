//! The contract and the judge know no component by name: what is special about one is data or a function of its row.

use std::collections::BTreeSet;

use nerf_oracle::convention::CHOICES;
use nerf_oracle::registry::all_rows;

use super::{code, root, sources};

/// Words of the judge's JSON, and names of operations, that happen to be the name of an array or a mistake as well.
const WORDS: &[(&str, &[&str])] = &[
    ("judge/explain.rs", &["count", "found", "right", "value", "values"]),
    ("judge/diagnosis/slips/infix.rs", &["round", "sum"]),
];

/// Names of components, arrays, conventions, their values, and mistakes.
fn names() -> BTreeSet<&'static str> {
    let mut names = BTreeSet::new();
    for row in all_rows() {
        names.insert(row.name);
        names.extend(row.inputs.iter().chain(row.outputs).map(|port| port.name.trim_end_matches('*')));
        names.extend(row.mistakes.iter().map(|mistake| mistake.name));
    }
    for (key, values) in CHOICES {
        names.insert(*key);
        names.extend(*values);
    }
    names
}

/// The string literals of some code.
fn literals(code: &str) -> Vec<String> {
    let (mut found, mut open, mut letters) = (vec![], None::<String>, code.chars());
    while let Some(letter) = letters.next() {
        match (&mut open, letter) {
            (Some(text), '\\') => text.extend(letters.next()),
            (Some(_), '"') => found.extend(open.take()),
            (Some(text), _) => text.push(letter),
            (None, '"') => open = Some(String::new()),
            // A character in quotes may be a quotation mark.
            (None, '\'') if letters.as_str().starts_with("\"'") => drop(letters.nth(1)),
            (None, _) => {}
        }
    }
    found
}

/// The names that a literal is, or holds as a word where no other word is spelled like them.
fn named(literal: &str, names: &BTreeSet<&'static str>) -> Vec<&'static str> {
    let words: Vec<&str> = literal.split(|c: char| !c.is_alphanumeric() && c != '_').collect();
    names
        .iter()
        .filter(|name| literal == **name || name.contains('_') && words.contains(name))
        .copied()
        .collect()
}

#[test]
fn the_judge_knows_no_component_by_name() {
    let names = names();
    assert!(names.len() > 200, "{} names are too few", names.len());
    for folder in ["contract", "judge"] {
        for file in sources(&root().join("src").join(folder)) {
            let place = file.strip_prefix(root().join("src")).expect("below src").display().to_string();
            let words = WORDS.iter().find(|(file, _)| *file == place).map_or(&[][..], |(_, words)| words);
            let found: BTreeSet<&str> =
                literals(&code(&file)).iter().flat_map(|literal| named(literal, &names)).collect();
            for name in &found {
                assert!(
                    words.contains(name),
                    "src/{place} names {name:?}: make it data or a function of the row (`Port`, `Special`)"
                );
            }
            assert!(
                words.iter().all(|word| found.contains(word)),
                "src/{place} no longer has one of {words:?}"
            );
        }
    }
}

#[test]
fn planted_names_are_found() {
    let names = names();
    let code = r#"if c == '"' { f("sigmas", "a \" of nerf_mlp", "the depth of it") } else { "colors" }"#;
    let found: Vec<_> = literals(code).iter().flat_map(|literal| named(literal, &names)).collect();
    assert_eq!(found, ["sigmas", "nerf_mlp", "colors"]);
}
