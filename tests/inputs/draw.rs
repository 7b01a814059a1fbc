//! Bad inputs made of good ones: bytes that are changed in named ways, for the table, and by lot.

use std::fs;
use std::io::{Cursor, Write};
use std::process::Command;

use nerf_oracle::random::{Key, Purpose};
use serde_json::{Value, json};
use zip::write::SimpleFileOptions;

use super::ground::{Ground, RUN, words};

/// An input that was drawn.
pub(crate) struct Input {
    /// What was done to which file, or the line of arguments.
    pub(crate) what: String,
    /// The arguments that hand it in.
    pub(crate) args: Vec<String>,
    /// The name that a refusal must have in it.
    pub(crate) name: String,
}

/// Files, and the command that reads each.
const READERS: [(&str, &str); 16] = [
    ("scene/transforms.json", "inspect scene --rays 1 --samples 1 --out out"),
    ("keys.json", "render run --path keys.json:1 --size 2x2 --out out/film.gif"),
    ("run/run.json", "render run --path orbit:1 --size 2x2 --out out/film.gif"),
    ("run/checkpoint.npz", "render run --path orbit:1 --size 2x2 --out out/film.gif"),
    ("colmap/sparse/0/cameras.bin", "inspect colmap --rays 1 --samples 1 --out out"),
    ("colmap/sparse/0/images.bin", "inspect colmap --rays 1 --samples 1 --out out"),
    ("colmap/sparse/0/points3D.bin", "inspect colmap --rays 1 --samples 1 --out out"),
    ("text/sparse/0/cameras.txt", "inspect text --rays 1 --samples 1 --out out"),
    ("text/sparse/0/images.txt", "inspect text --rays 1 --samples 1 --out out"),
    ("text/sparse/0/points3D.txt", "inspect text --rays 1 --samples 1 --out out"),
    ("llff/poses_bounds.npy", "inspect llff --rays 1 --samples 1 --out out"),
    ("cs180.npz", "inspect cs180.npz --rays 1 --samples 1 --out out"),
    ("tiny.npz", "inspect tiny.npz --rays 1 --samples 1 --out out"),
    ("photo.png", "fit-image photo.png --steps 1 --width 2 --layers 1 --batch 2 --size 4 --out out"),
    ("photo.jpg", "fit-image photo.jpg --steps 1 --width 2 --layers 1 --batch 2 --size 4 --out out"),
    ("photo.gif", "fit-image photo.gif --steps 1 --width 2 --layers 1 --batch 2 --size 4 --out out"),
];

/// Options with a number, each with a command that it belongs to.
const NUMBERS: [(&str, &[&str]); 5] = [
    (
        "train builtin:blob,size=4,views=2 --out out --steps 1",
        &[
            "--near",
            "--far",
            "--seconds",
            "--stop-at-psnr",
            "--rays",
            "--samples",
            "--fine",
            "--lr",
            "--holdout",
            "--scale",
            "--val-every",
            "--val-at",
            "--background",
            "--seed",
            "--threads",
            "--width",
        ],
    ),
    ("render run --out out/film.gif", &["--size", "--path", "--background", "--threads"]),
    ("inspect scene --out out", &["--near", "--far", "--rays", "--samples", "--holdout", "--seed"]),
    (
        "fit-image photo.png --out out",
        &["--size", "--steps", "--batch", "--levels", "--width", "--layers", "--lr", "--seed", "--threads"],
    ),
    (
        "sweep-image photo.png --out out",
        &["--size", "--steps", "--batch", "--levels", "--width", "--layers", "--lr", "--seed", "--threads"],
    ),
];

/// What is no number that any of them takes.
const NO_NUMBERS: [&str; 20] = [
    "NaN",
    "nan",
    "inf",
    "-inf",
    "infinity",
    "1e999",
    "",
    "x",
    "0x10",
    "1_000",
    "½",
    "1,x",
    "--",
    "true",
    "null",
    "1e-999x",
    "9e99999",
    "\u{1b}[31m1",
    "1\n2",
    "١",
];

/// What a JSON field may find in its place.
fn values() -> Vec<Value> {
    let deep = (0..100).fold(json!(0), |inner, _| json!([inner]));
    vec![
        json!(null),
        json!(true),
        json!(""),
        json!("0.5"),
        json!("\u{1b}]0;x\u{7}\u{202e}"),
        json!("a".repeat(5000)),
        json!([]),
        json!({}),
        json!([0]),
        json!({"a": 1}),
        json!(-1),
        json!(0.5),
        json!(1e300),
        json!(-1e300),
        json!(u64::MAX),
        json!(i64::MIN),
        json!(1e-320),
        json!([[1, 2], [3]]),
        json!(vec![0; 1000]),
        deep,
    ]
}

/// The commands of all good files.
pub(crate) fn commands(_: &Ground) -> Vec<Vec<String>> {
    let folder = |line: &str| words(&line.replace("out/film.gif", "out"));
    let readers = READERS.iter().map(|(_, line)| folder(line));
    readers.chain([words(&format!("train {RUN} --out out")), words("evaluate run")]).collect()
}

/// Draws numbers for one input.
struct Lot {
    key: Key,
    input: u64,
    drawn: u64,
}

impl Lot {
    /// A whole number below `n`.
    fn below(&mut self, n: usize) -> usize {
        self.drawn += 1;
        let u = self.key.four(self.input, self.drawn)[0];
        ((u * n as f64) as usize).min(n - 1)
    }

    fn of<'a, T>(&mut self, list: &'a [T]) -> &'a T {
        &list[self.below(list.len())]
    }
}

/// The `n`-th input: half of them JSON with another value, the others bytes, and one in eight a line of arguments.
pub(crate) fn input(ground: &Ground, n: u64) -> Input {
    let mut lot = Lot { key: Key::new(1, Purpose::Cases), input: n, drawn: 0 };
    if n % 8 == 0 {
        return line(&mut lot);
    }
    let json = n % 2 == 1;
    let (file, reader) = READERS[if json { lot.below(3) } else { lot.below(READERS.len()) }];
    let what = if json { replaced(ground, file, &mut lot) } else { damaged(ground, file, &mut lot) };
    // In the folder that the file lies in, any file may be the one that is found bad.
    let name = file.split('/').next().expect("a name").to_string();
    Input { what: format!("{file}: {what}"), args: words(reader), name }
}

/// A line of arguments in which one number is none.
fn line(lot: &mut Lot) -> Input {
    let (command, options) = *lot.of(&NUMBERS);
    let (option, value) = (*lot.of(options), *lot.of(&NO_NUMBERS));
    let mut args = words(command);
    args.push(format!("{option}={value}"));
    Input { what: format!("{command} {option}={value:?}"), args, name: option.trim_start_matches('-').into() }
}

/// Puts a value in the place of another, or beside it, or takes one away.
fn replaced(ground: &Ground, file: &str, lot: &mut Lot) -> String {
    let mut json = ground.json(file);
    let mut place = String::new();
    let mut at = &mut json;
    loop {
        let steps: Vec<String> = match at {
            Value::Object(object) => object.keys().cloned().collect(),
            Value::Array(list) => (0..list.len()).map(|n| n.to_string()).collect(),
            _ => vec![],
        };
        // Deeper with two of three draws, where there is anything.
        if steps.is_empty() || (!place.is_empty() && lot.below(3) == 0) {
            break;
        }
        let step = lot.of(&steps).clone();
        place += &format!("/{step}");
        at = match at {
            Value::Object(object) => object.get_mut(&step).expect("its own key"),
            Value::Array(list) => &mut list[step.parse::<usize>().expect("an index")],
            _ => unreachable!("others have no steps"),
        };
    }
    *at = lot.of(&values()).clone();
    let what = format!("{place} = {at:.60}");
    ground.write(file, json.to_string());
    what
}

/// Changes bytes: one or many, cut off, doubled, exchanged.
fn damaged(ground: &Ground, file: &str, lot: &mut Lot) -> String {
    let mut bytes = ground.bytes(file);
    let (at, to) = (lot.below(bytes.len()), lot.below(bytes.len()));
    let (at, to) = (at.min(to), at.max(to) + 1);
    let what = match lot.below(5) {
        0 => {
            bytes.truncate(at);
            format!("cut at {at}")
        }
        1 => {
            for n in 0..1 + bytes.len() / 50 {
                let at = (at + 37 * n) % bytes.len();
                bytes[at] ^= 1 << lot.below(8);
            }
            format!("bits from {at} on")
        }
        2 => {
            bytes.drain(at..to);
            format!("without {at}..{to}")
        }
        3 => {
            bytes[at..to].fill(*lot.of(&[0, 0xff, b'9', b'[', b'\n']));
            format!("{at}..{to} filled")
        }
        _ => {
            let again = bytes[at..to].to_vec();
            bytes.splice(at..at, again);
            format!("{at}..{to} twice")
        }
    };
    ground.write(file, bytes);
    what
}

/// Changes a file in a way that has a name.
pub(crate) fn bytes(ground: &Ground, file: &str, put: &str) {
    let path = ground.touch(file);
    if let Some(cut) = put.strip_prefix("cut ") {
        // A percentage, or bytes from the end.
        let (good, cut) = (ground.bytes(file), cut.parse::<i64>().expect("a number"));
        let length = if cut < 0 { good.len() as i64 + cut } else { good.len() as i64 * cut / 100 };
        return ground.write(file, &good[..length as usize]);
    }
    let shell = |command: &str| {
        fs::remove_file(&path).expect("a file");
        let status = Command::new("sh").args(["-c", command, "sh"]).arg(&path).status().expect("a shell");
        assert!(status.success(), "{command}");
    };
    let text = || String::from_utf8(ground.bytes(file)).expect("text");
    match put {
        "gone" => fs::remove_file(&path).expect("a file"),
        "folder" => shell("mkdir \"$1\""),
        "fifo" => shell("mkfifo \"$1\""),
        "device" => shell("ln -s /dev/zero \"$1\""),
        "text" => ground.write(file, "This is no such file.\n"),
        "zeros" => ground.write(file, vec![0; 5000]),
        "twice" => ground.write(file, text().replacen('{', "{\"seed\": 1, \"seed\": 2, ", 1)),
        "deep" => ground.write(file, "[".repeat(1_000_000)),
        "list" => ground.write(file, "[]"),
        "nan" => ground.write(file, text().replacen("8.0", "NaN", 1)),
        "not utf-8" => ground.write(file, [&text().into_bytes()[..20], &[0xff, 0xfe]].concat()),
        "other size" => image::RgbImage::new(7, 4).save(&path).expect("written"),
        "huge png" => ground.write(file, png(60_000, 60_000)),
        "wrong checksum" => {
            let mut bytes = ground.bytes(file);
            bytes[29] ^= 1;
            ground.write(file, bytes);
        }
        other => match other.split_once(" = ") {
            // Bytes from a place on, in hexadecimal digits.
            Some((at, digits)) => {
                let mut bytes = ground.bytes(file);
                let at = at.parse::<usize>().expect("a place");
                let put = digits.as_bytes().chunks(2).map(|two| std::str::from_utf8(two).expect("digits"));
                let put: Vec<u8> = put.map(|two| u8::from_str_radix(two, 16).expect("digits")).collect();
                bytes[at..at + put.len()].copy_from_slice(&put);
                ground.write(file, bytes);
            }
            None => match other.split_once(" -> ") {
                Some((from, to)) => {
                    assert!(text().contains(from), "{from:?} isn't in {file}");
                    ground.write(file, text().replacen(from, to, 1));
                }
                None => ground.write(file, archive(other)),
            },
        },
    }
}

/// A PNG that says it is so large, of black bits.
fn png(width: u32, height: u32) -> Vec<u8> {
    let mut bytes = vec![];
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_depth(png::BitDepth::One);
    let mut writer = encoder.write_header().expect("written");
    writer.write_chunk(png::chunk::IDAT, &[0x78, 0x9c, 3, 0, 0, 0, 0, 1]).expect("written");
    drop(writer);
    bytes
}

/// An npz with a single array, `images_train` beside a good `focal` and poses, whose header or data is wrong in a way that has a name.
fn archive(wrong: &str) -> Vec<u8> {
    let header = |descr: &str, shape: &str| {
        let dict = format!("{{'descr': {descr}, 'fortran_order': False, 'shape': {shape}, }}");
        let length = (dict.len() as u16 + 1).to_le_bytes();
        [b"\x93NUMPY\x01\x00", &length[..], dict.as_bytes(), b"\n"].concat()
    };
    let images = match wrong {
        "pickled" => [header("'|O'", "(2,)"), vec![0; 16]].concat(),
        "long shape" => header("'|u1'", "(9999999999999, 9999999999999, 4, 3)"),
        "short data" => [header("'|u1'", "(2, 4, 6, 3)"), vec![0; 100]].concat(),
        "bomb" => header("'|u1'", "(20, 4000, 4000, 3)"),
        "integer bomb" => [header("'|i1'", "(15, 4000, 4000, 3)"), vec![0; 1000]].concat(),
        "text array" => [header("'<U4'", "(2,)"), vec![0; 32]].concat(),
        "no header" => b"\x93NUMPY\x01\x00\xff".to_vec(),
        "few nested brackets" => header(&"[".repeat(50), "(2,)"),
        "nested header" => header(&"[".repeat(5000), "(2,)"),
        other => panic!("{other}?"),
    };
    let pose = [0.0, 0.0, -1.0, 4.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0f64];
    let poses = [
        &header("'<f8'", "(2, 4, 4)")[..],
        &pose.repeat(2).iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>(),
    ]
    .concat();
    let focal = [&header("'<f8'", "()")[..], &8f64.to_le_bytes()].concat();
    let mut zip = zip::ZipWriter::new(Cursor::new(vec![]));
    for (name, bytes) in [("images_train", &images), ("c2ws_train", &poses), ("focal", &focal)] {
        zip.start_file(format!("{name}.npy"), SimpleFileOptions::default()).expect("written");
        zip.write_all(bytes).expect("written");
    }
    zip.finish().expect("written").into_inner()
}
