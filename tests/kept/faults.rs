//! Each operation on files fails, or is the last that the program does: what was there before stays, and the run can go on to the very
//! end that it would have come to.

use std::fs;
use std::path::Path;
use std::process::{Command, ExitCode, Output};

use nerf_oracle::files::fault::{self, Fault};
use tempfile::TempDir;

use super::program::{Kept, files, times, told};
use super::types::types;

/// How a test tells [`child`] what to do.
const ARGS: &str = "KEPT_ARGS";
const FAULT: &str = "KEPT_FAULT";
const COUNT: &str = "KEPT_COUNT";

/// Not a test of its own: the program in this process, where a test below started it with a fault.
#[test]
fn child() {
    let Ok(args) = std::env::var(ARGS) else { return };
    if let Ok(fault) = std::env::var(FAULT) {
        let (kind, nth) = fault.rsplit_once(' ').expect("a kind and a number");
        let kind = KINDS.iter().find(|(name, _)| *name == kind).expect("a kind").1;
        fault::arm(kind, nth.parse().expect("a number"));
    }
    let args = args.split('\n').map(Into::into);
    let code = nerf_oracle::cli::main(args);
    if let Ok(file) = std::env::var(COUNT) {
        fs::write(file, fault::operations().to_string()).expect("written");
    }
    let number = (0..=255).find(|&n| code == ExitCode::from(n)).expect("an exit code is a byte");
    std::process::exit(number.into());
}

const KINDS: [(&str, Fault); 3] =
    [("fails", Fault::Fails), ("fails for good", Fault::FailsForGood), ("ends", Fault::Ends)];

/// The program with these arguments, as a child that may have a fault.
fn start(args: &[&str], fault: Option<(&str, u64)>, count: Option<&Path>) -> Output {
    let mut command = Command::new(std::env::current_exe().expect("this program"));
    command.args(["faults::child", "--exact", "--nocapture"]);
    command.env(ARGS, [&["nerf-oracle"], args].concat().join("\n"));
    fault.map(|(kind, nth)| command.env(FAULT, format!("{kind} {nth}")));
    count.map(|file| command.env(COUNT, file));
    command.output().expect("the child starts")
}

/// A command that writes a run into a folder, from what it finds there.
struct Scenario {
    name: &'static str,
    /// Commands before, without a fault.
    before: &'static [&'static [&'static str]],
    /// The one with a fault.
    struck: &'static [&'static str],
    /// What goes on where a run is there already.
    again: &'static [&'static str],
}

#[rustfmt::skip]
const NERF: &[&str] = &[
    "train", "builtin:blob,size=8,views=4", "--model", "nerf", "--width", "8", "--rays", "16", "--samples", "4", "--val-every", "2",
    "--threads", "1",
];

#[rustfmt::skip]
const FIT: &[&str] = &["fit-image", "builtin:card", "--size", "12", "--batch", "50", "--width", "8", "--levels", "2", "--threads", "1"];

/// Every so many faults, unless more or all are asked for.
fn stride() -> usize {
    if times().is_some() { 1 } else { types(&[12], &[4])[0] }
}

impl Scenario {
    /// Strikes every operation in turn.
    fn run(&self, command: &[&str]) {
        let folder = tempfile::tempdir().expect("a folder");
        let whole = folder.path().join("whole");
        self.prepare(command, &whole);
        let count = folder.path().join("count");
        told(0, &start(&arguments(command, &whole, self.struck), None, Some(&count)), self.name);
        let operations: u64 = fs::read_to_string(&count).expect("a count").parse().expect("a number");
        assert!(operations > 20, "{}: {operations} operations: the seam was not found", self.name);
        let whole = Kept::of(&whole);
        for (offset, (kind, _)) in KINDS.into_iter().enumerate() {
            for nth in (1..=operations).skip(offset).step_by(stride()) {
                self.strike(command, (kind, nth), &whole);
            }
        }
    }

    fn prepare(&self, command: &[&str], run: &Path) {
        for more in self.before {
            told(0, &start(&arguments(command, run, more), None, None), self.name);
        }
    }

    fn strike(&self, command: &[&str], fault: (&str, u64), whole: &Kept) {
        let what = format!("{}, operation {} {}", self.name, fault.1, fault.0);
        let folder: TempDir = tempfile::tempdir().expect("a folder");
        let run = folder.path().join("run");
        self.prepare(command, &run);
        let before = if run.exists() { files(&run) } else { Default::default() };
        let struck = start(&arguments(command, &run, self.struck), Some(fault), None);
        if fault.0 == "ends" {
            assert!(!struck.status.success() && struck.status.code() != Some(2), "{what}: it didn't end");
        } else {
            assert!(told(2, &struck, &what).contains("fault at operation"), "{what}: nothing was said");
        }
        if self.struck.contains(&"--overwrite") {
            self.check_former(&run, &before, &what);
        }
        // Whatever the fault has left: the run goes on, or is begun, to the same end.
        let begun = run.join("run.json").exists() && (self.again.contains(&"--resume"));
        let begun = begun && !(self.struck.contains(&"--overwrite") && files(&run) == before);
        let more = if begun { self.again } else { self.struck };
        told(0, &start(&arguments(command, &run, more), None, None), &what);
        Kept::of(&run).assert_same(whole, &what);
        let left = files(&run).into_keys().find(|path| path.to_string_lossy().contains(".partial-"));
        assert_eq!(left, None, "{what}: a part of a file was left");
    }

    /// The former run is whole, where it was or aside.
    fn check_former(
        &self,
        run: &Path,
        before: &std::collections::BTreeMap<std::path::PathBuf, Vec<u8>>,
        what: &str,
    ) {
        let aside = run.with_file_name("run.old-1");
        let there = if aside.exists() { &aside } else { run };
        for (path, bytes) in before {
            let name = path.strip_prefix(run).expect("below the run");
            assert!(
                fs::read(there.join(name)).is_ok_and(|now| now == *bytes),
                "{what}: {} is lost",
                name.display()
            );
        }
    }
}

fn arguments<'a>(command: &[&'a str], run: &'a Path, more: &[&'a str]) -> Vec<&'a str> {
    [command, &["--out", run.to_str().expect("a name in UTF-8")], more].concat()
}

#[test]
fn a_run_that_is_struck_comes_to_its_end() {
    let new = Scenario {
        name: "new run",
        before: &[],
        struck: &["--steps", "4", "--seed", "1"],
        again: &["--steps", "4", "--seed", "1", "--resume"],
    };
    new.run(NERF);
}

#[test]
fn a_resumed_run_that_is_struck_comes_to_its_end() {
    let resumed = Scenario {
        name: "resumed run",
        before: &[&["--steps", "2", "--seed", "1"]],
        struck: &["--steps", "4", "--seed", "1", "--resume"],
        again: &["--steps", "4", "--seed", "1", "--resume"],
    };
    resumed.run(NERF);
}

#[test]
fn a_run_that_takes_anothers_place_destroys_nothing() {
    let over = Scenario {
        name: "run in the place of another",
        before: &[&["--steps", "2", "--seed", "2"]],
        struck: &["--steps", "4", "--seed", "1", "--overwrite"],
        again: &["--steps", "4", "--seed", "1", "--resume"],
    };
    over.run(NERF);
}

#[test]
fn a_fit_that_is_struck_comes_to_its_end() {
    let fit = Scenario {
        name: "fit",
        before: &[],
        struck: &["--steps", "102"],
        again: &["--steps", "102", "--resume"],
    };
    fit.run(FIT);
}
