//! Who may import whom. `src/lib.rs` states the order of the rooms, in its numbered list; this file reads it there and holds the
//! tree to it.
//!
//! An import is a path that begins with `crate`, `super` or `self`, in a `use` or in code, outside of tests. What a module hands on
//! from its own children (`pub use mlp::Mlp;`) is none.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use super::{code, root, sources};

/// Imports against the order, each with its reason: at most five. One that is gone fails too.
const AGAINST_THE_ORDER: &[(&str, &str, &str)] = &[(
    "evaluation",
    "training",
    "evaluation asks whatever is trained for its pixels, by the trait that training trains",
)];

/// Files that import one another, each circle with its reason. One that is gone fails too.
const CIRCLES: &[(&[&str], &str)] = &[
    (
        &["cli::recipe", "cli::train"],
        "a recipe is made of the options that `train` takes, and `train` follows it",
    ),
    (
        &["field::fast::chunk", "field::fast::network"],
        "a network owns the buffers of its chunks, and each chunk goes through it",
    ),
    (&["scene::lens", "scene::transforms"], "a lens is read from the fields of transforms.json"),
    (
        &["training::nerf", "training::nerf::path", "training::nerf::samples", "training::nerf::skipping"],
        "one model in four files: its settings, its two ways to compute, where it does so, and what it skips",
    ),
];

/// The rooms that may iterate all components.
const ITERATE: [&str; 5] = ["registry", "judge", "proof", "bench", "cli"];

/// The room of all files `fast` in components' folders, and that of their `judge`.
const FAST: &str = "fast";
const DOORS: &str = "doors";

/// A file of the crate: its module, e.g. `field::fast::chunk`, and its code.
struct Source {
    module: String,
    code: String,
}

/// The numbered list of `lib.rs`: the names in backticks of each item. Its third item are the components.
pub(crate) fn rooms() -> Vec<Vec<String>> {
    let text = fs::read_to_string(root().join("src/lib.rs")).expect("lib.rs");
    let lines = text.lines().skip_while(|line| !line.starts_with("//! 1. "));
    let mut items: Vec<String> = vec![];
    for line in lines.take_while(|line| *line != "//!").map(|line| line.trim_start_matches("//! ")) {
        if line.starts_with(|c: char| c.is_ascii_digit()) {
            items.push(String::new());
        }
        items.last_mut().expect("an item begins the list").push_str(line);
    }
    let name = |name: &str| if name == "judge.rs" { DOORS.into() } else { name.to_string() };
    items.iter().map(|item| item.split('`').skip(1).step_by(2).map(name).collect()).collect()
}

/// The components' folders.
pub(crate) fn component_folders() -> Vec<String> {
    let folders = rooms().swap_remove(2);
    assert!(
        folders.iter().any(|folder| folder == "camera"),
        "the list of src/lib.rs has the components third"
    );
    folders
}

/// The module that a file is, below the crate.
fn module_of(file: &Path) -> String {
    let below = file.strip_prefix(root().join("src")).expect("below src").with_extension("");
    let parts: Vec<String> = below.iter().map(|part| part.to_string_lossy().into_owned()).collect();
    let parts: Vec<String> = parts.into_iter().filter(|part| part != "mod").collect();
    parts.join("::")
}

/// The crate's files without tests: no module that is declared below `#[cfg(test)]`.
fn crate_sources() -> Vec<Source> {
    let mut found: Vec<Source> = vec![];
    let mut tests: Vec<String> = vec![];
    for file in sources(&root().join("src")) {
        let module = module_of(&file);
        let code = code(&file);
        for declared in code.split("#[cfg(test)]").skip(1) {
            let declaration = declared.trim_start().split(['{', ';']).next().unwrap_or_default();
            if let Some((_, name)) = declaration.split_once("mod ") {
                tests.push(if module == "lib" { name.into() } else { format!("{module}::{name}") });
            }
        }
        found.push(Source { module, code });
    }
    let root_files = ["lib", "main"];
    found.retain(|source| {
        let test = tests
            .iter()
            .any(|test| source.module == *test || source.module.starts_with(&format!("{test}::")));
        !test && !root_files.contains(&source.module.as_str())
    });
    found
}

/// The paths of a tree of imports: `a::{b, c::{d, e}}` is a::b, a::c::d and a::c::e.
fn expanded(import: &str) -> Vec<String> {
    let Some((head, rest)) = import.split_once('{') else { return vec![import.trim().to_string()] };
    let inside = rest.trim_end().strip_suffix('}').unwrap_or(rest);
    let (mut depth, mut parts) = (0, vec![String::new()]);
    for letter in inside.chars() {
        depth += i32::from(letter == '{') - i32::from(letter == '}');
        if letter == ',' && depth == 0 {
            parts.push(String::new());
        } else {
            parts.last_mut().expect("one at least").push(letter);
        }
    }
    let parts = parts.iter().filter(|part| !part.trim().is_empty());
    parts.flat_map(|part| expanded(&format!("{}{}", head.trim_start(), part.trim()))).collect()
}

/// Paths in a file's code that begin with `crate`, `super` or `self`.
fn paths(code: &str) -> BTreeSet<String> {
    let (mut found, mut rest) = (BTreeSet::new(), code);
    let letter = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
    while let Some(at) = ["crate::", "super::", "self::"].iter().filter_map(|head| rest.find(head)).min() {
        let begins = !rest[..at].ends_with(letter);
        let tail = &rest[at..];
        let mut end = tail.find(|c| !letter(c)).unwrap_or(tail.len());
        if tail[end..].starts_with('{') {
            // A tree, to its end.
            end = tail.find(';').unwrap_or(tail.len());
        }
        if begins {
            found.extend(expanded(&tail[..end]));
        }
        rest = &tail[end..];
    }
    found
}

/// The module of the crate that a path in `module` leads to; names that `lib.rs` hands on lead to where they live.
fn target(module: &str, path: &str, modules: &BTreeSet<&str>) -> Option<String> {
    let mut base: Vec<&str> = module.split("::").collect();
    let mut parts: Vec<&str> =
        path.split("::").map(|part| part.split(" as ").next().unwrap_or(part).trim()).collect();
    match parts[0] {
        "crate" => base.clear(),
        "super" => {
            while parts.first() == Some(&"super") {
                base.pop();
                parts.remove(0);
            }
            parts.insert(0, "");
        }
        _ => {}
    }
    base.extend(&parts[1..]);
    match base[..] {
        ["COMPONENTS"] => return Some("registry".into()),
        ["Error" | "Result"] => return Some("error".into()),
        _ => {}
    }
    while !base.is_empty() && !modules.contains(base.join("::").as_str()) {
        base.pop();
    }
    Some(base.join("::")).filter(|found| !found.is_empty() && found != module)
}

/// Module -> modules that it imports.
fn imports(sources: &[Source]) -> BTreeMap<String, BTreeSet<String>> {
    let modules: BTreeSet<&str> = sources.iter().map(|source| source.module.as_str()).collect();
    let of = |source: &Source| {
        let paths = paths(&source.code);
        paths.iter().filter_map(|path| target(&source.module, path, &modules)).collect()
    };
    sources.iter().map(|source| (source.module.clone(), of(source))).collect()
}

/// The room of a module.
fn room(module: &str) -> &str {
    match module.split("::").collect::<Vec<_>>()[..] {
        // The command of that name.
        ["cli", ..] => "cli",
        [_, "fast", ..] => FAST,
        [_, "judge", ..] => DOORS,
        [first, ..] => first,
        [] => module,
    }
}

/// Imports of a room that comes later in the order.
fn against(imports: &BTreeMap<String, BTreeSet<String>>, order: &[String]) -> Vec<(String, String)> {
    let place = |module: &str| {
        let place = order.iter().position(|other| other == room(module));
        place.unwrap_or_else(|| {
            panic!("{module}: the list in src/lib.rs has no room `{}`: add it there", room(module))
        })
    };
    let all = imports.iter().flat_map(|(from, to)| to.iter().map(move |to| (from.clone(), to.clone())));
    all.filter(|(from, to)| place(to) > place(from)).collect()
}

/// Files that can reach one another by imports.
fn circles(imports: &BTreeMap<String, BTreeSet<String>>) -> BTreeSet<BTreeSet<String>> {
    let reach = |from: &String| {
        let (mut seen, mut open) = (BTreeSet::new(), vec![from.clone()]);
        while let Some(next) = open.pop() {
            for to in imports.get(&next).into_iter().flatten() {
                if seen.insert(to.clone()) {
                    open.push(to.clone());
                }
            }
        }
        seen
    };
    let reached: BTreeMap<&String, BTreeSet<String>> =
        imports.keys().map(|from| (from, reach(from))).collect();
    let circle = |from: &&String| -> BTreeSet<String> {
        let both =
            reached[*from].iter().filter(|to| reached.get(to).is_some_and(|back| back.contains(*from)));
        both.cloned().collect()
    };
    reached.keys().map(circle).filter(|circle| circle.len() > 1).collect()
}

#[test]
fn no_import_runs_against_the_order() {
    let sources = crate_sources();
    assert!(sources.len() > 200, "the crate's files were not found: {}", sources.len());
    assert!(AGAINST_THE_ORDER.len() <= 5, "at most five exceptions");
    let found = against(&imports(&sources), &rooms().concat());
    let below = |module: &str, part: &str| module == part || module.starts_with(&format!("{part}::"));
    let listed =
        |from: &str, to: &str| AGAINST_THE_ORDER.iter().find(|(a, b, _)| below(from, a) && below(to, b));
    for (from, to) in &found {
        assert!(
            listed(from, to).is_some(),
            "{from} imports {to}, which comes later in the order of src/lib.rs: move what it needs to an earlier room, or hand it over as an argument"
        );
    }
    for (from, to, _) in AGAINST_THE_ORDER {
        let there = found.iter().any(|(a, b)| below(a, from) && below(b, to));
        assert!(there, "{from} no longer imports {to}: take it off AGAINST_THE_ORDER");
    }
}

#[test]
fn files_do_not_import_one_another_in_circles() {
    let found = circles(&imports(&crate_sources()));
    let listed: BTreeSet<BTreeSet<String>> =
        CIRCLES.iter().map(|(circle, _)| circle.iter().map(|name| name.to_string()).collect()).collect();
    let new: Vec<_> = found.difference(&listed).collect();
    assert!(new.is_empty(), "files that import one another: move what both need to a third file: {new:#?}");
    let gone: Vec<_> = listed.difference(&found).collect();
    assert!(gone.is_empty(), "no circle any more: take it off CIRCLES: {gone:#?}");
}

#[test]
fn components_are_iterated_by_those_around_them_alone() {
    for source in crate_sources() {
        let named =
            source.code.split(|c: char| !c.is_alphanumeric() && c != '_').any(|word| word == "COMPONENTS");
        let room = room(&source.module);
        assert!(!named || ITERATE.contains(&room), "{}: COMPONENTS is for {ITERATE:?} alone", source.module);
    }
}

/// The rules are tried on planted files: each of these is found, and nothing else.
#[test]
fn planted_imports_are_found() {
    let source = |module: &str, code: &str| Source { module: module.into(), code: code.into() };
    let sources = [
        source("contract", ""),
        source("camera", "use super::judge::{Exam, mark::{self, Marks}};"),
        source("camera::judge", "use crate::judge::Exam;"),
        source("camera::fast", "let w = crate::field::fast::product(a, b);"),
        source("field::fast", "use super::super::contract::Case;"),
        source("field", "use crate::{camera, COMPONENTS};"),
        source("judge", "use crate::registry::COMPONENTS; use self::mark::Marks;"),
        source("judge::mark", "use super::Exam;"),
        source("registry", "use crate::camera;"),
    ];
    let imports = imports(&sources);
    let pairs =
        |list: &[(&str, &str)]| list.iter().map(|(a, b)| (a.to_string(), b.to_string())).collect::<Vec<_>>();
    let order = rooms().concat();
    assert_eq!(
        against(&imports, &order),
        pairs(&[("camera", "judge"), ("camera", "judge::mark"), ("field", "registry")])
    );
    let found: Vec<Vec<String>> =
        circles(&imports).into_iter().map(|circle| circle.into_iter().collect()).collect();
    // The judge's two files by `self` and `super`; camera and the registry by way of the judge.
    assert_eq!(found, [["camera", "judge", "judge::mark", "registry"].map(String::from)]);
}
