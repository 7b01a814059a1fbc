//! Runs that are killed at random times, and resumed until they have ended, come to the bits of a run that wasn't disturbed.

use std::fs;
use std::path::Path;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

use nerf_oracle::random::{Key, Purpose};

use super::program::{Kept, command, ends, times, told};

/// The most times that one run is killed.
const MOST: usize = 4;

#[rustfmt::skip]
const RUNS: [(&str, &[&str]); 5] = [
    ("compact", &["train", SCENE, "--steps", "60", "--val-every", "25", "--seed", "1"]),
    ("nerf", &["train", SCENE, "--model", "nerf", "--width", "16", "--rays", "64", "--samples", "16", "--steps", "60", "--seed", "1", "--val-every", "25"]),
    ("fine", &["train", SCENE, "--model", "nerf", "--fine", "8", "--width", "16", "--rays", "32", "--samples", "16", "--steps", "60", "--seed", "1", "--val-every", "25"]),
    ("skip", &["train", SCENE, "--model", "nerf", "--skip", "--width", "16", "--rays", "16", "--samples", "16", "--steps", "330", "--seed", "1", "--val-every", "150"]),
    ("fit", &["fit-image", "builtin:card", "--size", "32", "--batch", "200", "--width", "32", "--steps", "250", "--seed", "1"]),
];

const SCENE: &str = "builtin:spheres,size=16,views=6";

/// How a run is stopped, and the codes that it may end with then: 0 where it was faster.
#[derive(Clone, Copy, Debug)]
enum Stop {
    Kill,
    #[cfg(unix)]
    Interrupt,
    #[cfg(unix)]
    Terminate,
}

impl Stop {
    #[cfg(unix)]
    const ALL: &[Stop] = &[Stop::Kill, Stop::Interrupt, Stop::Terminate];
    #[cfg(not(unix))]
    const ALL: &[Stop] = &[Stop::Kill];

    fn send(self, child: &mut Child) {
        match self {
            Stop::Kill => child.kill().expect("killed"),
            #[cfg(unix)]
            Stop::Interrupt => signal("-INT", child),
            #[cfg(unix)]
            Stop::Terminate => signal("-TERM", child),
        }
    }

    /// Whether it explains this code; `None`: the signal ended the program, as it does before there is anything to keep.
    fn explains(self, code: Option<i32>) -> bool {
        match self {
            Stop::Kill => matches!(code, None | Some(0)) || cfg!(windows),
            #[cfg(unix)]
            Stop::Interrupt => matches!(code, None | Some(0 | 130)),
            #[cfg(unix)]
            Stop::Terminate => matches!(code, None | Some(0 | 143)),
        }
    }
}

#[cfg(unix)]
pub(crate) fn signal(name: &str, child: &Child) {
    // The child hasn't been waited for, so that its number is still its own.
    let sent = std::process::Command::new("kill").args([name, &child.id().to_string()]).status();
    assert!(sent.expect("kill").success());
}

/// Starts the run, or goes on with it.
fn start(args: &[&str], run: &Path) -> Child {
    let resume: &[&str] = if run.join("run.json").exists() { &["--resume"] } else { &[] };
    let all = [args, &["--out", run.to_str().expect("a name in UTF-8")], resume].concat();
    command(&all).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("the program starts")
}

#[test]
fn killed_runs_come_to_the_same_end() {
    let folder = tempfile::tempdir().expect("a folder");
    let times = times().unwrap_or(1);
    let seed = std::env::var("NERF_ORACLE_SEED").ok().map_or(0, |seed| seed.parse().expect("a number"));
    let key = Key::new(seed, Purpose::Probe);
    for (n, (name, args)) in RUNS.into_iter().enumerate() {
        let whole = folder.path().join(format!("{name}_whole"));
        let began = Instant::now();
        ends(0, &[args, &["--out", whole.to_str().expect("a name in UTF-8")]].concat());
        let (took, whole) = (began.elapsed().as_secs_f64(), Kept::of(&whole));
        for time in 0..times {
            let run = folder.path().join(format!("{name}_{time}"));
            let mut stops = vec![];
            for kill in 0..MOST {
                let u = |k: usize| key.uniform(n as u64, time, (2 * kill + k) as u64);
                let stop = Stop::ALL[(u(0) * Stop::ALL.len() as f64) as usize];
                let mut child = start(args, &run);
                std::thread::sleep(Duration::from_secs_f64(0.9 * took * u(1)));
                stop.send(&mut child);
                let output = child.wait_with_output().expect("it ends");
                let code = output.status.code();
                assert!(stop.explains(code), "{name}, {stop:?}: {}", String::from_utf8_lossy(&output.stderr));
                stops.push((stop, code));
                if code == Some(0) {
                    break;
                }
            }
            let what = format!("{name}, seed {seed}, number {time}, stopped by {stops:?}");
            told(0, &start(args, &run).wait_with_output().expect("it ends"), &what);
            Kept::of(&run).assert_same(&whole, &what);
        }
    }
}

/// A last validation may take longer than what came before it: its checkpoint is there, and resuming measures what wasn't.
#[test]
fn a_run_killed_in_its_last_validation_is_measured_when_it_is_resumed() {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, args) in RUNS.into_iter().filter(|(name, _)| *name != "fit") {
        let run = folder.path().join(name);
        ends(0, &[args, &["--out", run.to_str().expect("a name in UTF-8")]].concat());
        let whole = Kept::of(&run);
        let log = fs::read_to_string(run.join("log.jsonl")).expect("a log");
        let (before, last) = log.trim_end().rsplit_once('\n').expect("more than one line");
        assert!(last.contains("\"val_psnr\":"), "{last}");
        fs::write(run.join("log.jsonl"), format!("{before}\n")).expect("written");
        told(0, &start(args, &run).wait_with_output().expect("it ends"), name);
        Kept::of(&run).assert_same(&whole, name);
    }
}

/// The first signal lets a step finish and be kept, the second ends the program at once.
#[cfg(unix)]
#[test]
fn a_second_signal_ends_at_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = folder.path().join("run");
    // Steps of minutes, in f64.
    let args = [
        "train",
        SCENE,
        "--threads",
        "1",
        "--model",
        "nerf",
        "--backend",
        "reference",
        "--rays",
        "8192",
        "--steps",
        "9",
    ];
    let mut child = start(&args, &run);
    while !run.join("checkpoint.npz").exists() {
        assert!(child.try_wait().expect("a state").is_none(), "it ended by itself");
        std::thread::sleep(Duration::from_millis(20));
    }
    // By then its first step has begun.
    std::thread::sleep(Duration::from_millis(500));
    signal("-TERM", &child);
    std::thread::sleep(Duration::from_millis(300));
    assert!(child.try_wait().expect("a state").is_none(), "the first signal let no step finish");
    let began = Instant::now();
    signal("-INT", &child);
    assert_eq!(child.wait().expect("it ends").code(), Some(130));
    assert!(began.elapsed() < Duration::from_secs(3));
}
