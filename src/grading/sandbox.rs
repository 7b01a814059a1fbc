//! Where submissions in Python run: a process of its own with a time, an amount of output, memory and file sizes; on Linux, where the
//! system permits it, without network, with process numbers of its own, and with the other submissions and the results out of sight.
//!
//! Nobody should take it for a prison: what a program of the same user can read elsewhere, a submission can read.

use std::env;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use serde_json::{Value, json};
use tempfile::TempDir;

use super::rubric::Limits;
use crate::error::{Error, Input, Result};
use crate::files;
use crate::process::{self, Ended, Said};

/// The program that asks a submission, and what it asks with.
const RUNNER: &str = include_str!("runner.py");
const CANDIDATE: &str = include_str!("../../tools/candidate.py");

/// What stays of the environment: where programs and libraries are, and nothing that only the teacher should have.
const KEPT: [&str; 12] = [
    "PATH",
    "LANG",
    "LC_ALL",
    "LD_LIBRARY_PATH",
    "DYLD_LIBRARY_PATH",
    "PYTHONHOME",
    "PYTHONPATH",
    "VIRTUAL_ENV",
    "CONDA_PREFIX",
    "SYSTEMROOT",
    "TEMP",
    "TMP",
];

/// What cuts it off from everything else.
const CLOSED: &str = include_str!("closed.sh");

/// Bytes of a log that are read.
const LONGEST_LOG: u64 = 4 << 20;

/// How Python is started.
#[derive(Debug)]
pub(crate) struct Sandbox {
    /// The interpreter.
    python: String,
    limits: Limits,
    /// Runner, cases, and a folder for each submission that is running.
    root: TempDir,
    /// Folders that no submission sees.
    hidden: Vec<PathBuf>,
    /// Whether network and folders are out of reach.
    closed: bool,
    /// What is installed, and what isn't limited here.
    found: Found,
}

/// What the first run says.
#[derive(Debug, Default)]
struct Found {
    python: String,
    numpy: String,
    refused: Vec<String>,
    wheel: bool,
    /// Folders that are no business of a submission's, and that it can write.
    writable: Vec<String>,
}

impl Sandbox {
    /// Starts Python once, to see what there is and what the system permits.
    ///
    /// # Errors
    /// Where there is no such Python, or no numpy for it.
    pub(crate) fn new(python: &str, limits: Limits, hidden: Vec<PathBuf>) -> Result<Sandbox> {
        let root = tempfile::tempdir().map_err(Error::writing(&env::temp_dir()))?;
        files::write(&root.path().join("runner/runner.py"), RUNNER)?;
        files::write(&root.path().join("runner/candidate.py"), CANDIDATE)?;
        files::write(&root.path().join("runner/closed.sh"), CLOSED)?;
        files::make_folder(&root.path().join("here"))?;
        let python = interpreter(python);
        let mut sandbox = Sandbox {
            python,
            limits,
            root,
            hidden,
            closed: cfg!(target_os = "linux"),
            found: Found::default(),
        };
        match sandbox.probe() {
            Ok(found) => sandbox.found = found,
            // Not permitted here: without it, then.
            Err(_) if sandbox.closed => {
                sandbox.closed = false;
                sandbox.found = sandbox.probe().map_err(|what| sandbox.refused(what))?;
            }
            Err(what) => return Err(sandbox.refused(what)),
        }
        Ok(sandbox)
    }

    fn refused(&self, found: String) -> Error {
        Error::input(Input {
            file: "`python`",
            field: &self.python,
            found,
            expected: "Python 3.9 or later with numpy",
            remedy: "Name one that has both, such as that of a virtual environment.",
        })
    }

    fn probe(&self) -> Result<Found, String> {
        let job = self.job("probe").map_err(|error| error.to_string())?;
        let outside: Vec<PathBuf> =
            env::home_dir().into_iter().chain([self.root.path().join("runner")]).collect();
        let ran = self.run(&job, &[("probe", json!(true)), ("outside", json!(outside))]);
        let said = ran.map_err(|ended| ended.in_words(self.limits.time, self.most()))?;
        let log = job.log();
        let line =
            log.first().ok_or_else(|| last_line(&said.stderr).unwrap_or_else(|| said.status.to_string()))?;
        let text = |name: &str| line[name].as_str().unwrap_or_default().to_string();
        let list = |name: &str| {
            line[name].as_array().into_iter().flatten().filter_map(Value::as_str).map(String::from).collect()
        };
        Ok(Found {
            python: text("python"),
            numpy: text("numpy"),
            refused: list("refused"),
            wheel: line["wheel"] == json!(true),
            writable: list("writable"),
        })
    }

    /// What decides the answers besides the submission.
    pub(crate) fn identity(&self) -> String {
        format!("Python {}, numpy {}", self.found.python, self.found.numpy)
    }

    /// What is limited and what isn't, in sentences.
    pub(crate) fn describe(&self) -> Vec<String> {
        let Limits { time, memory_mib, output_mib } = self.limits;
        let mut said = vec![format!(
            "{}: {} s, {memory_mib} MiB of memory, {output_mib} MiB of output",
            self.identity(),
            time.as_secs_f64()
        )];
        said.push(match self.closed {
            true => "without network; other submissions and these results are out of sight".to_string(),
            false => "NETWORK AND FILES ARE NOT CUT OFF: this system doesn't permit it (unshare)".into(),
        });
        if self.closed && !self.found.writable.is_empty() {
            said.push(format!("BUT THESE CAN BE WRITTEN: {}", self.found.writable.join(", ")));
        }
        if !self.found.refused.is_empty() {
            said.push(format!("NOT LIMITED, as this system doesn't: {}", self.found.refused.join(", ")));
        }
        if self.found.wheel {
            said.push("this Python has nerf_oracle installed: submissions can't import it, but could find it; better use one without".into());
        }
        said
    }

    /// Where the cases lie that submissions are asked.
    pub(crate) fn cases(&self) -> PathBuf {
        self.root.path().join("cases")
    }

    fn most(&self) -> u64 {
        self.limits.output_mib << 20
    }

    /// A folder for a submission to run in.
    ///
    /// # Errors
    /// Where it can't be made.
    pub(crate) fn job(&self, name: &str) -> Result<Job> {
        let folder = self.root.path().join("jobs").join(name);
        for part in ["code", "answers"] {
            files::make_folder(&folder.join(part))?;
        }
        Ok(Job { folder })
    }

    /// Runs the runner in the folder `code` of a job, with more to its plan.
    ///
    /// # Errors
    /// Why it was ended.
    pub(crate) fn run(&self, job: &Job, plan: &[(&str, Value)]) -> Result<Said, Ended> {
        let here = if self.closed { self.root.path().join("here") } else { job.folder.clone() };
        let mut whole = json!({
            "cases": self.cases(), "answers": here.join("answers"), "log": here.join("log"),
            "memory_mib": self.limits.memory_mib, "output_mib": self.limits.output_mib,
            "timeout_s": self.limits.time.as_secs_f64(),
        });
        plan.iter().for_each(|(name, value)| whole[*name] = value.clone());
        let written = files::write(&job.folder.join("plan.json"), whole.to_string());
        written.map_err(|error| Ended::Other(std::io::Error::other(error.to_string())))?;
        process::run(self.command(job, &here), self.limits.time, self.most())
    }

    fn command(&self, job: &Job, here: &Path) -> Command {
        let [runner, plan] = [self.root.path().join("runner/runner.py"), here.join("plan.json")];
        // -B: no compiled files; the folder that it runs in is the student's.
        let start = [OsStr::new(&self.python), OsStr::new("-B"), runner.as_os_str(), plan.as_os_str()];
        let mut command = if self.closed {
            let mut command = Command::new("sh");
            command.arg(self.root.path().join("runner/closed.sh")).args([&job.folder, here]);
            command.arg(self.root.path().join("jobs")).args(&self.hidden).arg(":").args(start);
            command
        } else {
            let mut command = Command::new(start[0]);
            command.args(&start[1..]).current_dir(here.join("code"));
            command
        };
        command.env_clear().envs(KEPT.iter().filter_map(|name| Some((*name, env::var_os(name)?))));
        if let Some(home) = env::var_os("HOME") {
            // Where packages of the user's own are looked for; where that is known, nothing else of that folder.
            let local = Path::new(&home).join(".local");
            match cfg!(target_os = "linux") {
                true => command.env("HOME", here).env("PYTHONUSERBASE", local),
                false => command.env("HOME", home),
            };
        }
        command.env("TMPDIR", here).env("MPLBACKEND", "Agg").env("PYTHONHASHSEED", "0");
        for threads in ["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"] {
            command.env(threads, "1");
        }
        command
    }

    /// A text of a submission's without the names of this run's folders, which are others every time.
    pub(crate) fn plain(&self, text: &str, job: &Job) -> String {
        let text = text
            .replace(&*job.folder.to_string_lossy(), "")
            .replace(&*self.root.path().join("here").to_string_lossy(), "");
        text.replace(&*self.root.path().to_string_lossy(), "")
    }
}

/// A path with a folder in it is meant from here, not from where submissions run.
fn interpreter(python: &str) -> String {
    let path = Path::new(python);
    let folder = path.components().count() > 1;
    let whole = std::path::absolute(path).ok().filter(|_| folder);
    whole.map_or_else(|| python.to_string(), |whole| whole.display().to_string())
}

/// The folder of a submission that is running.
#[derive(Debug)]
pub(crate) struct Job {
    folder: PathBuf,
}

impl Job {
    /// Where the submission's own files go.
    pub(crate) fn code(&self) -> PathBuf {
        self.folder.join("code")
    }

    /// Where its answers are.
    pub(crate) fn answers(&self) -> PathBuf {
        self.folder.join("answers")
    }

    /// The lines of its log that are JSON objects. A submission could have written any of them itself.
    pub(crate) fn log(&self) -> Vec<Value> {
        let path = self.folder.join("log");
        let regular = std::fs::symlink_metadata(&path).is_ok_and(|there| there.is_file());
        let bytes = files::read(&path, LONGEST_LOG).ok().filter(|_| regular).unwrap_or_default();
        let text = String::from_utf8_lossy(&bytes);
        text.lines().filter_map(|line| serde_json::from_str(line).ok()).filter(Value::is_object).collect()
    }
}

/// A running submission's folder goes with it, as far as the system lets go of it.
impl Drop for Job {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

/// The last line that isn't empty.
pub(crate) fn last_line(bytes: &[u8]) -> Option<String> {
    let text = String::from_utf8_lossy(bytes);
    text.lines().rev().find(|line| !line.trim().is_empty()).map(|line| line.trim().to_string())
}

/// How long a run may take, for messages.
pub(crate) fn seconds(time: Duration) -> String {
    format!("{} s", time.as_secs_f64())
}
