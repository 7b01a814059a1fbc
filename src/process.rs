//! Another program's output, within a time and a number of bytes.

use std::io::Read;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::{Duration, Instant};

/// How often it is looked whether the program has ended, once it has closed its output.
const LOOK: Duration = Duration::from_millis(5);

/// What a program said until it ended.
#[derive(Debug)]
pub(crate) struct Said {
    pub(crate) status: ExitStatus,
    pub(crate) stdout: Vec<u8>,
    pub(crate) stderr: Vec<u8>,
}

/// A shell that runs this command.
pub(crate) fn shell(command: &str) -> Command {
    let [program, option] = if cfg!(windows) { ["cmd", "/C"] } else { ["sh", "-c"] };
    let mut shell = Command::new(program);
    shell.args([option, command]);
    shell
}

/// Runs a program, which is stopped with all that it has started when it takes longer than `time` or prints more than `most` bytes to
/// stdout or to stderr.
///
/// # Errors
/// Why it wasn't heard to its end.
pub(crate) fn run(mut program: Command, time: Duration, most: u64) -> Result<Said, Ended> {
    program.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut program, 0);
    let mut child = program.spawn().map_err(Ended::Other)?;
    let said = listen(&mut child, Instant::now() + time, most);
    if said.is_err() {
        stop(&mut child);
    }
    said
}

/// Why a program wasn't heard to its end.
#[derive(Debug)]
pub(crate) enum Ended {
    /// It took longer than it had.
    TooLong,
    /// It printed more than it may.
    TooMuch,
    /// The system's own words: it wasn't there, or couldn't be listened to.
    Other(std::io::Error),
}

impl Ended {
    /// The same of a program that had so much time and so many bytes.
    pub(crate) fn in_words(&self, time: Duration, most: u64) -> String {
        match self {
            Ended::TooLong => format!("no end within {} s", time.as_secs_f64()),
            Ended::TooMuch => format!("more than {most} bytes of output"),
            Ended::Other(error) => error.to_string(),
        }
    }
}

fn listen(child: &mut Child, until: Instant, most: u64) -> Result<Said, Ended> {
    let (send, heard) = channel();
    let pipes: [Box<dyn Read + Send>; 2] = [
        Box::new(child.stdout.take().expect("a pipe was asked for")),
        Box::new(child.stderr.take().expect("a pipe was asked for")),
    ];
    for (n, pipe) in pipes.into_iter().enumerate() {
        let send = send.clone();
        // Not joined: what the program has started may keep its pipes open.
        thread::spawn(move || {
            let mut bytes = vec![];
            let read = pipe.take(most + 1).read_to_end(&mut bytes);
            // Nobody listens any more after a timeout.
            let _ = send.send((n, read.map(|_| bytes)));
        });
    }
    let mut said = [vec![], vec![]];
    for _ in 0..said.len() {
        let left = until.saturating_duration_since(Instant::now());
        let (n, bytes) = heard.recv_timeout(left).map_err(|error| match error {
            RecvTimeoutError::Timeout => Ended::TooLong,
            RecvTimeoutError::Disconnected => Ended::Other(std::io::ErrorKind::BrokenPipe.into()),
        })?;
        said[n] = bytes.map_err(Ended::Other)?;
        if said[n].len() as u64 > most {
            return Err(Ended::TooMuch);
        }
    }
    loop {
        match child.try_wait().map_err(Ended::Other)? {
            Some(status) => {
                let [stdout, stderr] = said;
                return Ok(Said { status, stdout, stderr });
            }
            None if Instant::now() > until => return Err(Ended::TooLong),
            None => thread::sleep(LOOK),
        }
    }
}

/// Ends a program and, where the system has groups of them, all that it has started.
fn stop(child: &mut Child) {
    // One that has ended meanwhile can't be stopped, and needn't.
    #[cfg(unix)]
    let _ = rustix::process::kill_process_group(
        rustix::process::Pid::from_child(child),
        rustix::process::Signal::KILL,
    );
    let _ = child.kill();
    let _ = child.wait();
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn a_program_has_a_time_and_a_number_of_bytes() {
        let time = Duration::from_millis(700);
        let run = |command: &str| run(shell(command), time, 1000).map_err(|ended| ended.in_words(time, 1000));
        let said = run("echo out; echo err >&2; exit 3").unwrap();
        assert_eq!(
            (said.status.code(), &said.stdout[..], &said.stderr[..]),
            (Some(3), &b"out\n"[..], &b"err\n"[..])
        );
        let start = Instant::now();
        // Also one whose child keeps the pipes, and one that closes them and goes on.
        for endless in ["sleep 60", "sleep 60 & exit 0", "exec >&- 2>&-; sleep 60"] {
            assert!(run(endless).unwrap_err().contains("no end within"), "{endless}");
        }
        for loud in ["yes", "yes >&2"] {
            assert!(run(loud).unwrap_err().contains("more than 1000 bytes"), "{loud}");
        }
        assert!(start.elapsed() < Duration::from_secs(20));
    }
}
