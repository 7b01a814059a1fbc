//! Live pages as a browser meets them: who is answered, what is told while a run trains, and that training doesn't notice.

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use nerf_oracle::files::npz;
use serde_json::Value;

/// A small network, fast to train.
const SMALL: [&str; 11] = [
    "train",
    "builtin:blob,size=32",
    "--model",
    "nerf",
    "--width",
    "16",
    "--rays",
    "64",
    "--samples",
    "8",
    "--quiet",
];

fn program() -> Command {
    Command::new(env!("CARGO_BIN_EXE_nerf-oracle"))
}

fn run(args: &[&str]) -> Output {
    program().args(args).output().expect("the program starts")
}

fn path(dir: &Path, name: &str) -> String {
    dir.join(name).display().to_string()
}

/// Trains a small run of so many steps.
fn trained(dir: &Path, steps: &str) -> String {
    let out = path(dir, "run");
    let ended = run(&[&SMALL[..], &["--out", &out, "--steps", steps]].concat());
    assert!(ended.status.success(), "{}", String::from_utf8_lossy(&ended.stderr));
    out
}

/// A program that serves; ended when it is dropped.
struct Serving {
    child: Child,
    port: u16,
}

impl Serving {
    fn start(args: &[&str]) -> Self {
        let mut child = program()
            .args(args)
            .stderr(Stdio::piped())
            .stdout(Stdio::null())
            .spawn()
            .expect("the program starts");
        let mut said = BufReader::new(child.stderr.take().expect("a pipe"));
        let mut line = String::new();
        said.read_line(&mut line).expect("a line");
        let port = line.trim_end().strip_prefix("see the run at http://127.0.0.1:");
        let port = port.and_then(|port| port.strip_suffix('/')).and_then(|port| port.parse().ok());
        // What else it says has to go somewhere.
        thread::spawn(move || said.read_to_end(&mut vec![]));
        Serving { port: port.unwrap_or_else(|| panic!("no port in {line:?}")), child }
    }

    /// Status, head and body; 0 where nobody answers any more.
    fn raw(&self, request: &str) -> (u16, String, Vec<u8>) {
        let mut answer = vec![];
        let asked = TcpStream::connect(("127.0.0.1", self.port)).and_then(|mut stream| {
            stream.set_read_timeout(Some(Duration::from_secs(60)))?;
            stream.write_all(request.as_bytes())?;
            stream.read_to_end(&mut answer)
        });
        let end = answer.windows(4).position(|four| four == b"\r\n\r\n");
        let (Ok(_), Some(end)) = (asked, end) else { return (0, String::new(), vec![]) };
        let head = String::from_utf8_lossy(&answer[..end]).into_owned();
        let status = head.split(' ').nth(1).and_then(|status| status.parse().ok()).expect("a status");
        (status, head.to_ascii_lowercase(), answer[end + 4..].to_vec())
    }

    fn ask(&self, target: &str, headers: &str) -> (u16, String, Vec<u8>) {
        let host = if headers.contains("Host:") {
            String::new()
        } else {
            format!("Host: 127.0.0.1:{}\r\n", self.port)
        };
        self.raw(&format!("GET {target} HTTP/1.1\r\n{host}{headers}Connection: close\r\n\r\n"))
    }

    fn state(&self) -> Option<Value> {
        let (status, _, body) = self.ask("/api/state", "");
        (status == 200).then(|| serde_json::from_slice(&body).expect("JSON"))
    }

    /// The step of a small view's parameters.
    fn view(&self) -> Option<u64> {
        let (status, head, body) = self.ask(VIEW, "");
        (status == 200).then(|| {
            assert_eq!(&body[1..4], b"PNG");
            let step = head.lines().find_map(|line| line.strip_prefix("x-step: ")).expect("a step");
            step.trim().parse().expect("a number")
        })
    }

    /// Waits until something is so.
    fn until<T>(&self, what: &str, mut found: impl FnMut(&Self) -> Option<T>) -> T {
        let began = Instant::now();
        loop {
            if let Some(found) = found(self) {
                return found;
            }
            assert!(began.elapsed() < Duration::from_secs(120), "never {what}");
            thread::sleep(Duration::from_millis(50));
        }
    }
}

impl Drop for Serving {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

const VIEW: &str = "/api/view?eye=0,-4,1&target=0,0,0&up=0,0,1&angle=0.6&width=12&height=8";

#[test]
fn only_the_page_itself_is_answered() {
    let dir = tempfile::tempdir().expect("a folder");
    let out = trained(dir.path(), "3");
    let serving = Serving::start(&["view", &out, "--port", "0"]);
    let port = serving.port;
    let status = |target: &str, headers: &str| serving.ask(target, headers).0;
    assert_eq!(status("/", ""), 200);
    assert_eq!(status("/", &format!("Host: localhost:{port}\r\n")), 200);
    for host in
        ["evil.example", &format!("evil.example:{port}"), "127.0.0.1", &format!("10.0.0.1:{port}"), ""]
    {
        for target in ["/", "/api/state", VIEW, "/views/3/0", "/photographs/0"] {
            assert_eq!(status(target, &format!("Host: {host}\r\n")), 403, "{host} {target}");
        }
    }
    for origin in ["http://evil.example", "null", &format!("https://127.0.0.1:{port}")] {
        assert_eq!(status("/api/state", &format!("Origin: {origin}\r\n")), 403, "{origin}");
    }
    assert_eq!(status("/api/state", &format!("Origin: http://127.0.0.1:{port}\r\n")), 200);
    assert_eq!(status("/photographs/0", "Sec-Fetch-Site: cross-site\r\nSec-Fetch-Mode: no-cors\r\n"), 403);
    assert_eq!(serving.raw("GET / HTTP/1.0\r\n\r\n").0, 403, "no Host at all");
    for method in ["POST", "PUT", "DELETE", "OPTIONS"] {
        let request = format!(
            "{method} / HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nContent-Length: 0\r\nConnection: close\r\n\r\n"
        );
        assert_eq!(serving.raw(&request).0, 405, "{method}");
    }
    let (_, head, page) = serving.ask("/", "");
    for part in ["default-src 'none'", "frame-ancestors 'none'", "nosniff", "no-store", "same-origin"] {
        assert!(head.contains(part), "no {part} in {head}");
    }
    assert!(!head.contains("access-control-allow"), "{head}");
    assert!(String::from_utf8_lossy(&page).contains("<title>nerf-oracle"));
}

#[test]
fn nothing_but_the_run_is_served() {
    let dir = tempfile::tempdir().expect("a folder");
    let out = trained(dir.path(), "3");
    fs::write(dir.path().join("secret.png"), "secret").expect("written");
    let serving = Serving::start(&["view", &out, "--port", "0"]);
    for target in [
        "/../secret.png",
        "/views/../../secret.png",
        "/views/3/..%2f..%2fsecret.png",
        "/views/%2e%2e/secret",
        "/views/3/0.png",
        "/views/3/-1",
        "/views/3/99",
        "/views/99999999999999999999999/0",
        "/photographs/99",
        "/photographs/..%2f..%2fsecret.png",
        "/run.json",
        "/checkpoint.npz",
        "//etc/passwd",
    ] {
        let (status, _, body) = serving.ask(target, "");
        assert_eq!(status, 404, "{target}");
        assert!(!String::from_utf8_lossy(&body).contains("secret"), "{target}");
    }
    for target in ["/views/3/0", "/photographs/0"] {
        let (status, _, body) = serving.ask(target, "");
        assert_eq!((status, &body[1..4]), (200, &b"PNG"[..]), "{target}");
    }
    for (from, to, word) in [
        ("width=12", "width=99999", "width"),
        ("angle=0.6", "angle=nan", "angle"),
        ("eye=0,-4,1", "eye=0,-4", "eye"),
        ("&height=8", "", "height"),
        ("up=0,0,1", "up=inf,0,0", "up"),
    ] {
        let (status, _, body) = serving.ask(&VIEW.replace(from, to), "");
        assert_eq!(status, 400, "{to}");
        assert!(String::from_utf8_lossy(&body).contains(word), "{to}");
    }
    let key: Value = serde_json::from_slice(&serving.ask(&VIEW.replace("view", "key"), "").2).expect("JSON");
    fs::write(dir.path().join("keys.json"), serde_json::json!({"frames": [key]}).to_string())
        .expect("written");
    let film = path(dir.path(), "film.png");
    let keys = path(dir.path(), "keys.json:1");
    let rendered = run(&["render", &out, "--out", &film, "--path", &keys, "--size", "12x8"]);
    assert!(rendered.status.success(), "{}", String::from_utf8_lossy(&rendered.stderr));
    // What was seen is what is rendered from the key.
    let of = |bytes: Vec<u8>| image_of(&bytes);
    let (seen, frame) = (of(serving.ask(VIEW, "").2), of(fs::read(&film).expect("a film")));
    assert_eq!(seen.len(), frame.len());
    assert!(seen.iter().zip(&frame).all(|(a, b)| a.abs_diff(*b) <= 1), "another view");
    assert!(seen.iter().any(|&x| x != seen[0]), "something is to be seen");
}

/// The pixels of a PNG's first picture.
fn image_of(bytes: &[u8]) -> Vec<u8> {
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().expect("a PNG");
    let mut pixels = vec![0; reader.output_buffer_size().expect("a size")];
    reader.next_frame(&mut pixels).expect("a frame");
    pixels
}

/// Figures and views follow the training, the whole state is told again to a page that is loaded again, and the server ends with it.
#[test]
fn a_page_follows_the_training() {
    let dir = tempfile::tempdir().expect("a folder");
    let out = path(dir.path(), "run");
    let args = ["--out", &out, "--seconds", "8", "--val-every", "20", "--serve", "0"];
    let mut serving = Serving::start(&[&SMALL[..], &args].concat());
    let first = serving
        .until("a measurement", |serving| serving.state().filter(|state| state["step"].as_u64() > Some(20)));
    assert_eq!((&first["live"], first["left"].as_f64().is_some()), (&true.into(), true), "{first}");
    let seen = serving.until("a view of a trained model", |serving| serving.view().filter(|&step| step > 0));
    let later = serving.until("a later view", |serving| serving.view().filter(|&step| step > seen));
    let state = serving.state().expect("a state");
    assert!(state["step"].as_u64() >= Some(later) && later > seen, "{later} {state}");
    let steps = |state: &Value| -> Vec<u64> {
        state["log"].as_array().expect("a log").iter().filter_map(|point| point["step"].as_u64()).collect()
    };
    let again = serving.state().expect("a state");
    assert!(steps(&again).starts_with(&steps(&first)), "a page that is loaded again knows all of it");
    let after = format!("/api/state?after={}", first["step"]);
    let newer: Value = serde_json::from_slice(&serving.ask(&after, "").2).expect("JSON");
    assert!(steps(&newer).iter().all(|&step| step > first["step"].as_u64().expect("a step")));
    assert!(state["views"]["rows"].as_array().is_some_and(|rows| !rows.is_empty()), "{state}");
    let (status, head, curve) = serving.ask("/api/curve", "");
    assert!(
        status == 200
            && head.contains("image/svg+xml")
            && String::from_utf8_lossy(&curve).contains("<polyline")
    );
    assert!(serving.child.wait().expect("an end").success());
    assert_eq!(serving.ask("/", "").0, 0, "nobody answers any more");
}

/// A connection that never ends its request doesn't keep the program from ending.
#[cfg(unix)]
#[test]
fn it_ends_when_told_whoever_is_connected() {
    let dir = tempfile::tempdir().expect("a folder");
    let out = trained(dir.path(), "2");
    let mut serving = Serving::start(&["view", &out, "--port", "0"]);
    assert_eq!(serving.ask("/", "").0, 200);
    let mut idle = TcpStream::connect(("127.0.0.1", serving.port)).expect("connected");
    idle.write_all(b"GET / HT").expect("sent");
    let told = Command::new("kill").args(["-INT", &serving.child.id().to_string()]).status();
    assert!(told.expect("kill").success());
    let began = Instant::now();
    assert_eq!(serving.child.wait().expect("an end").code(), Some(130));
    assert!(began.elapsed() < Duration::from_secs(10));
}

#[test]
fn a_served_run_has_the_bits_of_any_other() {
    let dir = tempfile::tempdir().expect("a folder");
    let (alone, watched) = (path(dir.path(), "alone"), path(dir.path(), "watched"));
    let steps = ["--steps", "1500", "--val-every", "500"];
    let ended = run(&[&SMALL[..], &["--out", &alone], &steps].concat());
    assert!(ended.status.success(), "{}", String::from_utf8_lossy(&ended.stderr));
    let mut serving = Serving::start(&[&SMALL[..], &["--out", &watched, "--serve", "0"], &steps].concat());
    let mut seen = vec![];
    while serving.child.try_wait().expect("a child").is_none() {
        seen.extend(serving.view());
    }
    assert!(seen.iter().any(|&step| step > 0 && step < 1500), "views were taken while it trained: {seen:?}");
    let bits = |run: &str| {
        let mut arrays = npz::read(&Path::new(run).join("checkpoint.npz")).expect("a checkpoint");
        arrays.remove("seconds").expect("its time");
        arrays
    };
    let (alone, watched) = (bits(&alone), bits(&watched));
    assert!(alone.len() > 10 && alone == watched);
}

#[test]
fn a_run_that_goes_on_elsewhere_is_seen() {
    let dir = tempfile::tempdir().expect("a folder");
    let out = trained(dir.path(), "2");
    let serving = Serving::start(&["view", &out, "--port", "0"]);
    assert_eq!(serving.view(), Some(2));
    assert_eq!(serving.state().expect("a state")["live"], false);
    let more = run(&[&SMALL[..], &["--out", &out, "--steps", "9", "--resume"]].concat());
    assert!(more.status.success(), "{}", String::from_utf8_lossy(&more.stderr));
    assert_eq!(serving.view(), Some(9));
    assert_eq!(serving.state().expect("a state")["step"], 9);
}

#[test]
fn what_cannot_be_shown_is_named() {
    let dir = tempfile::tempdir().expect("a folder");
    let out = trained(dir.path(), "2");
    let taken = TcpListener::bind(("127.0.0.1", 0)).expect("a port");
    let port = taken.local_addr().expect("an address").port().to_string();
    let refused = |args: &[&str], words: &[&str]| {
        let ended = run(args);
        let message = String::from_utf8_lossy(&ended.stderr).into_owned();
        assert_eq!(ended.status.code(), Some(2), "{args:?}: {message}");
        words.iter().for_each(|word| assert!(message.contains(word), "{args:?}: no {word:?} in {message}"));
    };
    refused(&["view", &out, "--port", &port], &["--port", &port, "another program", "0 for any"]);
    let other = path(dir.path(), "other");
    refused(
        &[&SMALL[..], &["--out", &other, "--serve", &port]].concat(),
        &["--serve", &port, "another program"],
    );
    assert!(!Path::new(&other).exists(), "nothing has begun");
    refused(&["view", &path(dir.path(), "none")], &["run.json", "Train first"]);
    fs::remove_file(Path::new(&out).join("checkpoint.npz")).expect("removed");
    refused(&["view", &out], &["checkpoint.npz", "try again"]);
}
