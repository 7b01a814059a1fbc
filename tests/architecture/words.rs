//! The library speaks to callers in Rust: options and commands are the program's own words, which `cli` puts in their place.

use std::fs;

use super::{code, name, root, sources};

/// What may speak of the command line, and why.
const MAY: &[(&str, &str)] = &[
    ("cli", "it is the command line"),
    ("proof", "its messages are for people who work on this crate, whose remedy is a command"),
];

/// The commands of the program: the files of `cli`.
fn commands() -> Vec<String> {
    let files = sources(&root().join("src/cli"));
    files.iter().map(|file| format!("nerf-oracle {}", name(file).replace('_', "-"))).collect()
}

/// Whether a line of code has an option such as `--near`, unless it is one of another program in `tools/`, or a command of ours.
fn speaks(line: &str, commands: &[String]) -> bool {
    let option = |at: usize| {
        let letter = line[at + 2..].starts_with(|c: char| c.is_ascii_lowercase());
        letter && !line[..at].ends_with(|c: char| c == '-' || c.is_alphanumeric())
    };
    let options = line.match_indices("--").any(|(at, _)| option(at)) && !line.contains("tools/");
    options || commands.iter().any(|command| line.contains(command))
}

#[test]
fn only_the_command_line_speaks_of_options() {
    let (src, commands) = (root().join("src"), commands());
    for (room, why) in MAY {
        let text: Vec<String> = sources(&src.join(room)).iter().map(|file| code(file)).collect();
        let there = text.iter().flat_map(|text| text.lines()).any(|line| speaks(line, &commands));
        assert!(there, "{room} no longer does ({why}): take it off MAY");
    }
    for file in sources(&src) {
        let below = file.strip_prefix(&src).expect("below src");
        if MAY.iter().any(|(room, _)| below.starts_with(room)) {
            continue;
        }
        for (n, line) in fs::read_to_string(&file).expect("readable source").lines().enumerate() {
            let line = line.trim_start();
            assert!(
                line.starts_with("//") || !speaks(line, &commands),
                "{}:{}: an option or a command: name the setting in backticks, `near`, which src/cli/spelling.rs makes --near",
                file.display(),
                n + 1
            );
        }
    }
}

#[test]
fn planted_options_are_found() {
    let commands = commands();
    let found =
        [r#""Lower --lr.""#, r#""try (--near)""#, r#""start with nerf-oracle fit-image""#, "`--peer`"];
    let fine = [
        r#""Lower `lr`.""#,
        "a -- b",
        "x---y",
        "<!-- head",
        "tools/bench_torch.py --rounds 1",
        "the nerf-oracle crate",
    ];
    assert!(found.iter().all(|line| speaks(line, &commands)));
    assert!(!fine.iter().any(|line| speaks(line, &commands)));
}
