//! `grade`: a class of answers and of Python, broken ones among them.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use nerf_oracle::contract::Dtype;
use nerf_oracle::contract::arrays::Arrays;
use nerf_oracle::contract::check::Kind;
use nerf_oracle::convention::CS180;
use nerf_oracle::files::npz;
use nerf_oracle::judge::Exam;
use serde_json::{Value, json};

fn run(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_nerf-oracle")).args(args).output().expect("the program starts")
}

/// A folder with submissions, a rubric and results.
struct Class {
    root: tempfile::TempDir,
}

impl Class {
    fn new(rubric: &Value) -> Class {
        let class = Class { root: tempfile::tempdir().expect("a folder") };
        fs::create_dir(class.submissions()).expect("made");
        class.rubric(rubric);
        class
    }

    fn rubric(&self, rubric: &Value) {
        fs::write(self.root.path().join("rubric.json"), rubric.to_string()).expect("written");
    }

    fn submissions(&self) -> PathBuf {
        self.root.path().join("submissions")
    }

    fn out(&self, name: &str) -> PathBuf {
        self.root.path().join("out").join(name)
    }

    fn read(&self, name: &str) -> String {
        fs::read_to_string(self.out(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    fn write(&self, file: &str, text: &str) {
        let path = self.submissions().join(file);
        fs::create_dir_all(path.parent().expect("a folder")).expect("made");
        fs::write(path, text).expect("written");
    }

    fn output(&self, more: &[&str]) -> Output {
        let [submissions, rubric, out] = ["submissions", "rubric.json", "out"]
            .map(|name| self.root.path().join(name).display().to_string());
        run(&[&["grade", &submissions, "--rubric", &rubric, "--out", &out], more].concat())
    }

    /// The class as `--json` prints it.
    fn grade(&self, more: &[&str]) -> Value {
        let output = self.output(&[&["--json"], more].concat());
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{message}");
        assert!(!message.contains("panicked"), "{message}");
        serde_json::from_slice(&output.stdout).expect("one JSON object")
    }

    /// Answers to every case, with mistakes in rows by name.
    fn answer(&self, name: &str, wrong: &[(&str, &str)]) {
        for question in &exam().questions {
            let direction = question.component.direction(question.kind).expect("its direction");
            let row = question.component.name;
            let mistakes: Vec<&str> = wrong.iter().filter(|(of, _)| *of == row).map(|(_, m)| *m).collect();
            for case in &question.cases {
                let outputs = (direction.wrong)(&case.inputs, &CS180, &mistakes);
                write(&self.submissions().join(name).join(question.path(case) + ".npz"), &outputs);
            }
        }
    }
}

fn exam() -> Exam {
    let rows = [("volume_render", Kind::Forward), ("composite_background", Kind::Forward)];
    Exam::of(&rows, Dtype::F32, None).expect("rows of the contract")
}

fn write(path: &Path, arrays: &Arrays) {
    let arrays = arrays.iter().map(|(name, x)| (name.clone(), x.mapv(|x| x as f32).into())).collect();
    npz::write(path, &arrays, false).expect("written");
}

fn rubric() -> Value {
    json!({
        "schema": "nerf-oracle/rubric/1", "title": "A <b>class</b>", "timeout_s": 8, "memory_mib": 1024, "output_mib": 2,
        "rows": [
            { "component": "volume_render", "points": 10, "points_if_only_edge_cases_fail": 7.5, "edge_cases": ["VR9"] },
            { "component": "composite_background", "points": 0.3 },
        ],
    })
}

/// The submission of this name.
fn of<'a>(class: &'a Value, name: &str) -> &'a Value {
    let all = class["submissions"].as_array().expect("a list");
    all.iter().find(|s| s["name"] == name).unwrap_or_else(|| panic!("no {name} in {class}"))
}

#[test]
fn answers_become_points_and_pages() {
    let class = Class::new(&rubric());
    class.answer("ada", &[]);
    class.answer("bob/archive", &[("volume_render", "inclusive_transmittance")]);
    let graded = class.grade(&[]);
    let (ada, bob) = (of(&graded, "ada"), of(&graded, "bob"));
    assert_eq!((&ada["points"], &ada["state"]), (&json!(10.3), &json!("graded")), "{ada}");
    assert_eq!((&bob["points"], &bob["rows"][0]["verdict"]), (&json!(0.3), &json!("fail")), "{bob}");
    assert_eq!(bob["rows"][0]["explanations"][0]["mistakes"], json!(["inclusive_transmittance"]));
    let page = class.read("pages/bob.html");
    for words in
        ["inclusive_transmittance", "The line to look for", "To follow by hand", "wrong in", "0.3 of 10.3"]
    {
        assert!(page.contains(words), "{words:?} isn't in {page}");
    }
    assert!(!page.contains("ada") && !page.contains("To fix it"), "{page}");
    assert!(page.contains("A &lt;b&gt;class&lt;/b&gt;") && !page.contains("<b>"), "{page}");
    class.grade(&["--reveal"]);
    assert!(class.read("pages/bob.html").contains("To fix it"));
    let csv = class.read("grades.csv");
    let lines: Vec<&str> = csv.lines().collect();
    assert!(lines[0].starts_with("submission,state,points,of,volume_render forward points,"), "{csv}");
    assert_eq!(lines[1], "ada,graded,10.3,10.3,10,pass,,0.3,pass,,");
    let junit = class.read("junit.xml");
    for words in [
        r#"tests="4" skipped="0" failures="1" errors="0""#,
        r#"<testsuite name="bob""#,
        "inclusive_transmittance",
    ] {
        assert!(junit.contains(words), "{words} isn't in {junit}");
    }
}

#[test]
fn what_is_broken_is_a_row_with_its_reason() {
    let class = Class::new(&rubric());
    class.answer("right", &[]);
    class.answer("cut", &[]);
    let file = class.submissions().join("cut/volume_render/forward-VR9_underflow.npz");
    let bytes = fs::read(&file).expect("an answer");
    fs::write(&file, &bytes[..bytes.len() / 2]).expect("cut");
    class.answer("gap", &[]);
    fs::remove_file(class.submissions().join("gap/volume_render/forward-VR9_underflow.npz"))
        .expect("removed");
    class.answer("extra", &[]);
    class.write("extra/README.txt", "hello");
    class.write(
        "extra/answers.json",
        r#"{"schema": "nerf-oracle/answers/1", "rows": {"mlp/forward": {"takes": ["x"]}}}"#,
    );
    class.answer("declares", &[]);
    class.write("declares/answers.json", "{");
    class.write("empty/.DS_Store", "");
    class.write("notebook/p.ipynb", "{}");
    class.write("<img src=x onerror=alert(1)>/a.txt", "x");
    class.write("=1+cmd/a.txt", "x");
    class.write("stray.txt", "x");
    #[cfg(unix)]
    {
        use std::os::unix::fs::symlink;
        class.answer("link", &[]);
        let file = class.submissions().join("link/volume_render/forward-VR9_underflow.npz");
        fs::remove_file(&file).expect("removed");
        symlink(class.submissions().join("right/volume_render/forward-VR9_underflow.npz"), &file)
            .expect("a link");
        symlink(class.submissions().join("right"), class.submissions().join("thief")).expect("a link");
        assert!(Command::new("mkfifo").arg(class.submissions().join("empty/pipe")).status().is_ok());
    }
    let graded = class.grade(&[]);
    let reason = |name: &str| of(&graded, name)["reason"].as_str().expect("text").to_string();
    // A damaged file and an absent one cost their own row alone, and an absent one no more than the rubric says.
    assert_eq!(of(&graded, "right")["points"], 10.3);
    assert_eq!(of(&graded, "cut")["points"], 0.3);
    let why = of(&graded, "cut")["rows"][0]["why"].as_str().expect("text");
    assert!(why.starts_with("volume_render/forward-VR9_underflow.npz: "), "{why}");
    assert_eq!(of(&graded, "gap")["points"], 7.8, "{}", of(&graded, "gap"));
    assert_eq!(of(&graded, "extra")["points"], 10.3);
    assert_eq!(of(&graded, "extra")["notes"], json!(["not used, as no case asks for it: README.txt"]));
    assert!(reason("declares").contains("answers.json: JSON: found EOF"), "{}", reason("declares"));
    assert!(reason("notebook").contains("p.ipynb is a notebook"), "{}", reason("notebook"));
    for name in ["declares", "notebook", "<img src=x onerror=alert(1)>", "=1+cmd"] {
        assert_eq!(
            (&of(&graded, name)["state"], &of(&graded, name)["points"]),
            (&json!("broken"), &json!(0.0))
        );
    }
    if cfg!(unix) {
        assert!(reason("link").contains("is a link"), "{}", reason("link"));
        assert!(reason("thief").contains("a link"), "{}", reason("thief"));
        assert!(reason("empty").contains("pipe is no regular file"), "{}", reason("empty"));
    }
    assert_eq!(graded["about"][0], "not graded, as they are no folders: stray.txt");
    let (index, csv) = (class.read("index.html"), class.read("grades.csv"));
    assert!(index.contains("&lt;img src=x") && !index.contains("<img"), "{index}");
    assert!(csv.contains("\n'=1+cmd,") && !csv.contains("\n=1"), "{csv}");
    for entry in graded["submissions"].as_array().expect("a list") {
        let page = entry["page"].as_str().expect("a path");
        assert!(class.out(page).is_file() && index.contains(&format!("href=\"{page}\"")), "{page}");
    }
}

#[test]
fn what_has_not_changed_is_not_graded_again() {
    let class = Class::new(&rubric());
    class.answer("ada", &[]);
    class.answer("bob", &[("volume_render", "inclusive_transmittance")]);
    class.answer("copy", &[]);
    let files = ["index.html", "grades.csv", "grades.json", "junit.xml", "pages/bob.html", "marks/bob.json"];
    let first = class.grade(&["--threads", "1"]);
    let bytes = files.map(|file| class.read(file));
    assert_eq!(
        (&first["new"], &first["about"][0]),
        (&json!(3), &json!("the same, byte for byte: ada, copy"))
    );
    assert_eq!(class.grade(&[])["new"], 0);
    assert_eq!(files.map(|file| class.read(file)), bytes);
    // Graded again by other threads: the same bytes.
    assert_eq!(class.grade(&["--again", "--threads", "3"])["new"], 3);
    assert_eq!(files.map(|file| class.read(file)), bytes);
    class.answer("bob", &[]);
    let third = class.grade(&[]);
    assert_eq!((&third["new"], &of(&third, "bob")["points"]), (&json!(1), &json!(10.3)));
    // Marks that were cut off, and another rubric.
    fs::write(class.out("marks/ada.json"), "{").expect("written");
    assert_eq!(class.grade(&[])["new"], 1);
    let mut other = rubric();
    other["rows"][0]["points"] = json!(20);
    class.rubric(&other);
    let fourth = class.grade(&[]);
    assert_eq!((&fourth["new"], &of(&fourth, "ada")["points"]), (&json!(3), &json!(20.3)));
}

#[test]
fn rubrics_that_cannot_be_used_are_refused() {
    let class = Class::new(&rubric());
    class.write("ada/a.txt", "");
    let refused = |pointer: &str, value: Value, words: &[&str]| {
        let mut bad = rubric();
        let (parent, field) = pointer.rsplit_once('/').expect("a field");
        bad.pointer_mut(parent).expect("its parent")[field] = value;
        class.rubric(&bad);
        let output = class.output(&[]);
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{pointer}: {message}");
        for word in ["rubric.json"].iter().chain(words) {
            assert!(message.contains(word), "{pointer}: no {word:?} in {message}");
        }
    };
    refused("/schema", json!("x"), &["schema: found x"]);
    refused("/tittle", json!("x"), &["unknown field", "tittle"]);
    refused("/title", json!(3), &["title: found", "expected a string"]);
    refused("/dtype", json!("f8"), &["dtype: found f8"]);
    refused("/profile", json!("cs18"), &["profile: found cs18", "cs180"]);
    refused("/timeout_s", json!(0), &["timeout_s: found 0"]);
    refused("/memory_mib", json!(1), &["memory_mib: found 1"]);
    refused("/rows", json!([]), &["rows", "one row at least"]);
    refused("/rows/0/component", json!("volume"), &["rows[0].component: found volume", "volume_render"]);
    refused("/rows/0/direction", json!("back"), &["rows[0].direction: found back", "vjp"]);
    refused("/rows/0/points", json!(-1), &["rows[0].points: found -1"]);
    refused("/rows/0/points", json!("1"), &["rows[0].points", "expected f64"]);
    refused(
        "/rows/0/points_if_imprecise",
        json!(11),
        &["rows[0].points_if_imprecise: found 11", "10 points"],
    );
    refused("/rows/0/edge_cases", json!(["XX99"]), &["rows[0].edge_cases: found XX99", "VR9"]);
    refused("/rows/0/outputs", json!(["color"]), &["rows[0].outputs: found color", "colors"]);
    refused("/rows/0/function", json!("../a.py:f"), &["rows[0].function: found ../a.py"]);
    refused("/rows/0/parameters", json!({"s": "sigma"}), &["rows[0].parameters: found sigma", "sigmas"]);
    refused("/rows/1/component", json!("volume_render"), &["rows[1]: found volume_render forward", "once"]);
}

#[test]
fn folders_that_cannot_be_used_are_refused() {
    let class = Class::new(&rubric());
    let refused = |output: &Output, words: &[&str]| {
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(words.iter().all(|word| message.contains(word)), "{message}");
    };
    refused(&class.output(&[]), &["submissions", "no sub-folder"]);
    class.write("ada/f.py", "");
    refused(&class.output(&["--python", "no-such-python"]), &["--python", "no-such-python", "numpy"]);
    let [submissions, rubric, inside] = ["submissions", "rubric.json", "submissions/ada/out"]
        .map(|name| class.root.path().join(name).display().to_string());
    refused(
        &run(&["grade", &submissions, "--rubric", &rubric, "--out", &submissions]),
        &["--out", "of the submissions"],
    );
    refused(
        &run(&["grade", &submissions, "--rubric", &rubric, "--out", &inside]),
        &["--out", "the submission ada"],
    );
}

/// A Python with numpy, or a note that there is none.
fn python() -> Option<String> {
    let python = std::env::var("NERF_ORACLE_PYTHON").unwrap_or_else(|_| "python3".into());
    let there = Command::new(&python).args(["-c", "import numpy"]).output();
    if there.is_ok_and(|output| output.status.success()) {
        return Some(python);
    }
    // Past the test harness, which would keep it to itself.
    let _ = writeln!(
        std::io::stderr(),
        "skipped: {python} with numpy isn't there (NERF_ORACLE_PYTHON names one)"
    );
    None
}

#[test]
fn the_example_is_graded_as_it_says() {
    let Some(python) = python() else { return };
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("tools/examples/grading");
    let out = tempfile::tempdir().expect("a folder");
    let [submissions, rubric, out_dir] =
        [example.join("submissions"), example.join("rubric.json"), out.path().join("out")]
            .map(|p| p.display().to_string());
    let output = run(&["grade", &submissions, "--rubric", &rubric, "--out", &out_dir, "--python", &python]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let found = fs::read_to_string(out.path().join("out/grades.csv")).expect("a table");
    let expected = fs::read_to_string(example.join("grades.csv")).expect("the example's table");
    assert_eq!(found, expected);
}

/// What a submission can do to those who run it.
#[test]
fn python_that_misbehaves_is_stopped_and_told() {
    let Some(python) = python() else { return };
    let class = Class::new(&rubric());
    let right = "def composite_background(colors, opacity, background):\n    return colors + (1 - opacity)[:, None] * background\n";
    let with = |name: &str, more: &str| class.write(&format!("{name}/f.py"), &format!("{right}{more}"));
    let body = |text: &str| format!("def volume_render(sigmas, rgbs, deltas):\n    {text}\n");
    with("endless", &body("while True: pass"));
    with("import", "def volume_render(sigmas): pass\nwhile True: pass\n");
    with("loud", &body("while True: print('x' * 1000)"));
    with("hungry", &body("return [bytearray(1 << 31)]"));
    with("quits", &body("import os; os._exit(0)"));
    with("exits", &body("raise SystemExit(3)"));
    with("raises", &body("raise ValueError('</li><script>alert(1)</script>')"));
    with("cheats", "from nerf_oracle.oracle import volume_render\n");
    with("writes", &body("open('big', 'wb').write(b'0' * (64 << 20))"));
    with("child", &body("import subprocess; subprocess.Popen(['sleep', '60']); import time; time.sleep(60)"));
    with("moved", &body("import os; os.rename('../answers', '../gone'); os.symlink('gone', '../answers')"));
    let peek = format!("import os; raise ValueError(str(len(os.listdir({:?}))))", class.submissions());
    with("peeks", &body(&peek));
    with("calls", &body("import socket; socket.create_connection(('1.1.1.1', 53), 2)"));
    let outside = class.root.path().join("defaced").display().to_string();
    with("defaces", &body(&format!("open({outside:?}, 'w')")));
    with("secret", &body("import os; raise ValueError(os.environ.get('COURSE_TOKEN', 'none'))"));
    with(
        "forges",
        "import json, sys\nopen(json.load(open(sys.argv[1]))['log'], 'a').write('{\"done\": 1, \"places\": 3}\\n[]\\n' + '9' * 9 + '\\n')\n",
    );
    class.write("syntax/f.py", &format!("{right}def volume_render(:\n"));
    class.write("nothing/f.py", right);
    class.write("twice/a.py", &body("return 1"));
    class.write("twice/b.py", &body("return 2"));
    let start = std::time::Instant::now();
    let graded = class.grade(&["--python", &python]);
    assert!(start.elapsed().as_secs() < 120, "{:?}", start.elapsed());
    let said = |name: &str| {
        let all = of(&graded, name);
        format!("{} {} {}", all["state"], all["reason"], all["rows"][0]["why"])
    };
    for (name, words) in [
        ("endless", &["stopped", "no end within 8 s", "running volume_render"][..]),
        ("loud", &["stopped", "more than 2 MiB of output"]),
        ("hungry", &["MemoryError"]),
        ("quits", &["stopped", "ended by itself"]),
        ("exits", &["SystemExit(3)"]),
        ("raises", &["ValueError", "</li>"]),
        ("cheats", &["nerf_oracle"]),
        ("writes", &["File too large"]),
        ("child", &["stopped", "no end within 8 s"]),
        ("moved", &["broken"]),
        ("syntax", &["f.py, line 3"]),
        ("import", &["stopped", "importing f.py"]),
        ("nothing", &["no function volume_render"]),
        ("twice", &["a.py and in b.py"]),
        ("forges", &["no function volume_render"]),
        ("secret", &["ValueError: none"]),
    ] {
        for word in words {
            assert!(said(name).contains(word), "{name}: no {word:?} in {}", said(name));
        }
    }
    // What was right before it, or beside it, counts.
    for name in
        ["endless", "loud", "hungry", "quits", "exits", "raises", "writes", "child", "nothing", "forges"]
    {
        assert_eq!(of(&graded, name)["points"], 0.3, "{}", of(&graded, name));
    }
    let import = of(&graded, "import")["rows"].as_array().expect("rows");
    assert!(import.iter().all(|row| row["why"] == "no end within 8 s, while importing f.py"), "{import:?}");
    assert!(!class.read("pages/raises.html").contains("<script>"));
    let about = graded["about"].to_string();
    if about.contains("without network") {
        assert!(said("peeks").contains("ValueError: 0"), "{}", said("peeks"));
        assert!(
            said("defaces").contains("Read-only") && !Path::new(&outside).exists(),
            "{}",
            said("defaces")
        );
        assert!(
            said("calls").contains("OSError") || said("calls").contains("unreachable"),
            "{}",
            said("calls")
        );
    } else {
        assert!(about.contains("NOT CUT OFF"), "{about}");
    }
}
