//! What belongs to a component. Each check says what to do next; the README's "Adding a component" is the same list.

use std::collections::BTreeSet;
use std::fs;

use nerf_oracle::COMPONENTS;
use nerf_oracle::contract::check::Kind;
use nerf_oracle::contract::component::Component;
use nerf_oracle::convention::CS180;
use nerf_oracle::proof::own_error::OWN_ERRORS;

use super::imports::{component_folders, rooms};
use super::root;

/// The files of a component's folder, which `mod.rs` declares, and what each holds. Any of them but the first may be a folder instead.
const FILES: &[(&str, &str)] = &[
    ("mod", "the formula in plain f64, with its source, shapes and units"),
    ("arrays", "the same on named arrays: fn(&Arrays, &Conventions) -> Arrays"),
    (
        "bound",
        "how far off an honest implementation may be: the formula once more, in the operations of `Arithmetic`",
    ),
    ("honest", "honest implementations: the formula in the operations of `Machine`"),
    ("mistakes", "what people get wrong: a list of `Mistake`, and the formula with mistakes by name"),
    ("cases", "the questions: seeded and hard `Case`s, of numbers that every type holds"),
    ("component", "the row of the registry: a `Component` that puts all of these together"),
    ("judge", "the front door: `front_door!`, by which somebody's own function is judged in a line"),
    ("tests", "closed forms and properties"),
];

/// What lies in `src` and isn't in the list of rooms.
fn without_room() -> Vec<String> {
    let rooms = rooms();
    let entries = fs::read_dir(root().join("src")).expect("src").map(|entry| entry.expect("an entry").path());
    let names = entries.map(|path| path.file_stem().expect("a name").to_string_lossy().into_owned());
    let known =
        |name: &String| name == "lib" || name == "main" || rooms.iter().flatten().any(|room| room == name);
    let step = |name: String| {
        format!(
            "name {name} in the numbered list of src/lib.rs (a component: item 3, in backticks and after those it imports), then run this again"
        )
    };
    names.filter(|name| !known(name)).map(step).collect()
}

/// What is missing in a component's folder and around it.
fn around(folder: &str) -> Vec<String> {
    let src = root().join("src");
    let declared = fs::read_to_string(src.join(folder).join("mod.rs")).unwrap_or_default();
    let (mut missing, mut undeclared) = (vec![], vec![]);
    for (file, what) in FILES {
        let there =
            src.join(folder).join(format!("{file}.rs")).exists() || src.join(folder).join(file).is_dir();
        if !there {
            missing.push(format!("write src/{folder}/{file}.rs: {what}"));
        } else if *file != "mod" && !declared.contains(&format!("mod {file};")) {
            undeclared.push(format!("mod {file};"));
        }
    }
    if !undeclared.is_empty() {
        missing.push(format!("declare in src/{folder}/mod.rs: {}", undeclared.join(" ")));
    }
    let lib = fs::read_to_string(src.join("lib.rs")).expect("lib.rs");
    if !lib.contains(&format!("pub mod {folder};")) {
        missing.push(format!("declare it: `pub mod {folder};` in src/lib.rs"));
    }
    if !COMPONENTS.iter().any(|c| c.folder == folder) {
        missing.push(format!(
            "register it: `{folder}::component::...` among COMPONENTS in src/registry.rs, with `folder: \"{folder}\"`"
        ));
    }
    missing
}

/// What is missing of a row of the registry.
fn of_row(component: &Component) -> Vec<String> {
    let Component { name, folder, .. } = component;
    let row = format!("{name}, in src/{folder}/component.rs");
    let exists = |path: &str| root().join(path).exists();
    let mut missing = vec![];
    let mut check = |fine: bool, next: String| {
        if !fine {
            missing.push(next);
        }
    };
    let backward = exists(&format!("src/{folder}/backward.rs")) || exists(&format!("src/{folder}/backward"));
    check(
        component.vjp.is_none() || backward,
        format!("write src/{folder}/backward.rs: the gradient, by hand"),
    );
    let differentiable = component.inputs.iter().any(|port| port.gradient);
    check(
        differentiable == component.vjp.is_some(),
        format!("{row}: `vjp` and inputs that are `Port::smooth` go together: it has one without the other"),
    );
    check(!component.cases_of(Kind::Forward, &CS180).is_empty(), format!("{row}: at least one case"));
    check(!component.mistakes.is_empty(), format!("{row}: at least one mistake"));
    check(
        !component.formula.is_empty() && !component.source.is_empty(),
        format!("{row}: formula and source"),
    );
    check(
        exists(&format!("tools/golden/{name}.py")),
        format!(
            "write tools/golden/{name}.py: the same formula in mpmath and torch (a short one to start from: trunc_exp.py), with a PURPOSE that no other has"
        ),
    );
    let registry =
        fs::read_to_string(root().join("tools/golden/registry.py")).expect("the fixtures' registry");
    check(
        registry.contains(&format!("\"{name}\",")),
        format!("add \"{name}\" to COMPONENTS in tools/golden/registry.py"),
    );
    check(
        exists(&format!("fixtures/{name}/mpmath.npz")),
        format!("make its fixtures: python tools/golden.py --only {name} (needs tools/requirements.txt)"),
    );
    check(
        OWN_ERRORS.iter().any(|own| own.component == *name),
        format!(
            "add row(\"{name}\", forward, vjp) to OWN_ERRORS in src/proof/own_error.rs; `cargo test --test golden -- --nocapture table` prints what is measured"
        ),
    );
    missing
}

#[test]
fn every_component_is_complete() {
    let mut missing = without_room();
    missing.extend(component_folders().iter().flat_map(|folder| around(folder)));
    missing.extend(COMPONENTS.iter().flat_map(of_row));
    let steps: String = missing.iter().map(|step| format!("\n  * {step}")).collect();
    assert!(
        missing.is_empty(),
        "what is left to do (src/trunc_exp is a small component to look at):{steps}\n"
    );
}

/// What is registered lies in a component's folder.
#[test]
fn every_row_has_its_folder() {
    let folders: BTreeSet<String> = component_folders().into_iter().collect();
    for component in COMPONENTS {
        assert!(
            folders.contains(component.folder),
            "{}: `folder` is \"{}\", which is no component of src/lib.rs",
            component.name,
            component.folder
        );
    }
    let names: BTreeSet<&str> = COMPONENTS.iter().map(|c| c.name).collect();
    assert_eq!(names.len(), COMPONENTS.len(), "names are unique");
}
