//! Other languages, without a library of ours. What isn't installed here is skipped, and said.

mod checkers;
mod examples;
#[path = "../types/mod.rs"]
mod types;

use std::io::Write;
use std::process::{Command, Output};

const ORACLE: &str = env!("CARGO_BIN_EXE_nerf-oracle");

/// Whether a command that says its version, or that tries an import, succeeds; if not, says so past the test harness, which would keep it to
/// itself.
fn installed(program: &str) -> bool {
    available(program, &["--version"])
}

/// The same of any command.
fn available(program: &str, args: &[&str]) -> bool {
    let there = Command::new(program).args(args).output().is_ok_and(|output| output.status.success());
    if !there {
        let _ = writeln!(std::io::stderr(), "skipped: `{program} {}` isn't to be had", args.join(" "));
    }
    there
}

/// Exit code and all output of a command.
fn ended(command: &mut Command) -> (Option<i32>, String) {
    let Output { status, stdout, stderr } = command.output().expect("it starts");
    let text = [stdout, stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
    (status.code(), text.concat())
}

/// What a command that must succeed prints.
fn succeeds(command: &mut Command) -> String {
    let (code, said) = ended(command);
    assert_eq!(code, Some(0), "{command:?}: {said}");
    said
}
