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
pub(super) struct Said {
    pub(super) status: ExitStatus,
    pub(super) stdout: Vec<u8>,
    pub(super) stderr: Vec<u8>,
}

/// Runs a shell's command, which is stopped with all that it has started when it takes longer than `time` or prints more than `most`
/// bytes to stdout or to stderr. Err says what happened.
pub(super) fn run(command: &str, time: Duration, most: u64) -> Result<Said, String> {
    let shell = if cfg!(windows) { ["cmd", "/C"] } else { ["sh", "-c"] };
    let mut program = Command::new(shell[0]);
    program.args([shell[1], command]).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut program, 0);
    let mut child = program.spawn().map_err(|error| error.to_string())?;
    let said = listen(&mut child, Instant::now() + time, most);
    if said.is_err() {
        stop(&mut child);
    }
    said.map_err(|what| match what {
        End::TooLong => format!("no end within {:.0} s", time.as_secs_f64()),
        End::TooMuch => format!("more than {most} bytes of output"),
        End::Other(error) => error.to_string(),
    })
}

/// Why a program wasn't heard to its end.
enum End {
    TooLong,
    TooMuch,
    Other(std::io::Error),
}

fn listen(child: &mut Child, until: Instant, most: u64) -> Result<Said, End> {
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
            RecvTimeoutError::Timeout => End::TooLong,
            RecvTimeoutError::Disconnected => End::Other(std::io::ErrorKind::BrokenPipe.into()),
        })?;
        said[n] = bytes.map_err(End::Other)?;
        if said[n].len() as u64 > most {
            return Err(End::TooMuch);
        }
    }
    loop {
        match child.try_wait().map_err(End::Other)? {
            Some(status) => {
                let [stdout, stderr] = said;
                return Ok(Said { status, stdout, stderr });
            }
            None if Instant::now() > until => return Err(End::TooLong),
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
        let run = |command: &str| run(command, Duration::from_millis(700), 1000);
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
