//! Bad inputs, as a user may hand them in: each is refused with exit code 2 and a message that says what and where, whatever it is; none
//! ends in a panic, an abort, a hang, or more memory than the machine should be asked for.
//!
//! `rows` is the table of inputs that are known to be bad, with part of each one's message; `draw` makes more of them out of good files.
//! `NERF_ORACLE_INPUTS=20000 cargo test --release --test inputs` draws as many.

mod bad_captures;
#[path = "../captures/files.rs"]
mod captures;
mod draw;
mod ground;
mod rows;
#[path = "../types/mod.rs"]
mod types;

use std::collections::BTreeSet;
use std::fs;
use std::io::Read;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use ground::Ground;

/// Inputs that are drawn where NERF_ORACLE_INPUTS doesn't say how many, and how many of them must be bad: some changes leave a file good.
const DRAWN: usize = 150;
const BAD: f64 = 0.8;

/// A program that takes longer hangs.
const PATIENCE: Duration = Duration::from_secs(60);

/// Kilobytes of address space: a program that asks for more aborts, and that shows.
const MEMORY: usize = 4_000_000;

/// How a program ended, and what it said.
struct Ended {
    code: Option<i32>,
    stdout: String,
    stderr: String,
}

/// Runs the program on a line of arguments, with a limit of memory where the shell has one.
fn run(folder: &Path, args: &[String]) -> Ended {
    let program = env!("CARGO_BIN_EXE_nerf-oracle");
    let mut command = if cfg!(target_os = "linux") {
        let mut shell = Command::new("sh");
        shell.args(["-c", &format!("ulimit -v {MEMORY}; exec \"$0\" \"$@\""), program]);
        shell
    } else {
        Command::new(program)
    };
    command.args(args).args(["--threads", "1"].iter().filter(|_| takes_threads(args)));
    command.current_dir(folder).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().expect("the program starts");
    let (mut out, mut err) = (child.stdout.take().expect("a pipe"), child.stderr.take().expect("a pipe"));
    let text = |pipe: &mut dyn Read| {
        let mut bytes = vec![];
        pipe.read_to_end(&mut bytes).expect("readable");
        String::from_utf8_lossy(&bytes).into_owned()
    };
    thread::scope(|scope| {
        let stdout = scope.spawn(|| text(&mut out));
        let stderr = scope.spawn(|| text(&mut err));
        let start = Instant::now();
        let status = loop {
            if let Some(status) = child.try_wait().expect("a child") {
                break status;
            }
            if start.elapsed() > PATIENCE {
                child.kill().expect("a child that runs");
            }
            thread::sleep(Duration::from_millis(1));
        };
        Ended {
            code: status.code(),
            stdout: stdout.join().expect("no panic"),
            stderr: stderr.join().expect("no panic"),
        }
    })
}

fn takes_threads(args: &[String]) -> bool {
    let command = args.first().map(String::as_str);
    matches!(command, Some("train" | "render" | "evaluate" | "fit-image"))
        && !args.iter().any(|a| a == "--threads")
}

/// What is wrong with the way a program ended on an input, if anything is. `names` must be in the message of a refusal.
fn complaint(ended: &Ended, names: &[&str]) -> Option<String> {
    let Ended { code, stdout, stderr } = ended;
    let moves = |text: &str| text.chars().any(|c| c.is_control() && c != '\n' && c != '\t');
    let missing = names.iter().find(|name| !stderr.contains(**name));
    match code {
        None => Some("a signal".into()),
        Some(0..=2) if stderr.contains("panicked") => Some("a panic".into()),
        Some(0..=2) if moves(stdout) || moves(stderr) => Some("control characters".into()),
        Some(0 | 1) => None,
        Some(2) if !["error: ", "Usage: "].iter().any(|head| stderr.contains(head)) => {
            Some("no message".into())
        }
        Some(2) => missing.map(|name| format!("no {name:?} in the message")),
        Some(code) => Some(format!("exit code {code}")),
    }
}

/// Does `work` for 0, 1, ... n - 1 on all cores, each with its own copy of the good files; gathers what it returns.
fn on_all_cores<T: Send>(n: usize, work: impl Fn(&Ground, usize) -> T + Sync) -> Vec<T> {
    let (counter, gathered) = (AtomicUsize::new(0), Mutex::new(vec![]));
    let first = Ground::new(run);
    let cores = thread::available_parallelism().map_or(1, usize::from);
    let (next, all, work) = (&counter, &gathered, &work);
    thread::scope(|scope| {
        for ground in (0..cores).map(|_| first.copy()) {
            scope.spawn(move || {
                loop {
                    let this = next.fetch_add(1, Ordering::Relaxed);
                    if this >= n {
                        break;
                    }
                    let done = work(&ground, this);
                    all.lock().expect("no panic").push(done);
                }
            });
        }
    });
    gathered.into_inner().expect("no panic")
}

#[test]
fn every_row_is_refused_with_its_message() {
    let rows = rows::all();
    assert!(rows.len() >= 300, "{} rows", rows.len());
    let names: BTreeSet<String> = rows.iter().map(|row| row.to_string()).collect();
    assert_eq!(names.len(), rows.len(), "a row is there twice");
    // One in eight; with `NERF_ORACLE_TYPES=all` all of them.
    let each = types::types(&[8], &[1])[0];
    let wrong = on_all_cores(rows.len().div_ceil(each), |ground, n| {
        let row = &rows[n * each];
        let args = row.prepare(ground);
        let ended = run(&ground.folder(), &args);
        let said = complaint(&ended, &row.words());
        let said = said.or((ended.code != Some(2)).then(|| format!("exit code {:?}", ended.code)));
        ground.restore();
        said.map(|said| format!("{row}: {said}: {}{}", ended.stdout, ended.stderr))
    });
    let wrong: Vec<String> = wrong.into_iter().flatten().collect();
    assert!(wrong.is_empty(), "{} of {} rows:\n{}", wrong.len(), rows.len() / each, wrong.join("\n"));
}

#[test]
fn nothing_that_is_drawn_gets_through() {
    let drawn = std::env::var("NERF_ORACLE_INPUTS")
        .ok()
        .map_or(DRAWN, |n| n.parse().expect("NERF_ORACLE_INPUTS is a number"));
    let ended = on_all_cores(drawn, |ground, n| {
        let input = draw::input(ground, n as u64);
        let ended = run(&ground.folder(), &input.args);
        let said = complaint(&ended, &[&input.name]);
        ground.restore();
        let said = said.map(|said| format!("{n}: {}: {said}: {}", input.what, ended.stderr));
        (ended.code == Some(2), said)
    });
    let bad = ended.iter().filter(|(bad, _)| *bad).count();
    let wrong: Vec<String> = ended.into_iter().filter_map(|(_, said)| said).collect();
    assert!(wrong.is_empty(), "{} of {drawn} inputs:\n{}", wrong.len(), wrong.join("\n"));
    assert!(bad as f64 >= BAD * drawn as f64, "{bad} of {drawn} were bad");
}

/// The good files that the others are made of are good.
#[test]
fn the_good_files_are_taken() {
    let ground = Ground::new(run);
    for args in draw::commands(&ground) {
        let ended = run(&ground.folder(), &args);
        assert_eq!(ended.code, Some(0), "{args:?}: {}", ended.stderr);
        assert!(!ended.stderr.contains("warning"), "{args:?}: {}", ended.stderr);
        fs::remove_dir_all(ground.folder().join("out")).ok();
    }
}
