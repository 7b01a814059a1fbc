//! The ten-line checkers in the README of the frozen vectors, as they stand there: each accepts a right kernel and rejects a wrong one. And
//! the schema of their index, by a validator that knows nothing of ours.

use std::fs;
use std::path::Path;
use std::process::Command;

use tempfile::TempDir;

use super::types::types;
use super::{ORACLE, available, ended, installed, succeeds};

const README: &str = include_str!("../../src/vectors/README.md");

/// The block of the README that begins with this mark.
fn block(mark: &str) -> &str {
    let begins = format!("```{mark}\n");
    let from = README.find(&begins).unwrap_or_else(|| panic!("no {mark}")) + begins.len();
    README[from..].split("\n```").next().expect("its end")
}

/// A folder with the vectors of volume rendering, and these files.
fn folder(layout: &str, files: &[(&str, &str)]) -> TempDir {
    let root = tempfile::tempdir().expect("a folder");
    let out = root.path().join("vectors");
    succeeds(Command::new(ORACLE).args(["vectors", "volume_render", "--layout", layout, "--out"]).arg(out));
    for (name, text) in files {
        fs::write(root.path().join(name), text).expect("written");
    }
    root
}

/// A kernel with the depth of the sample itself in place of that in front of it.
fn with_mistake(right: &str) -> String {
    let wrong = right.replace("-(depth)", "-(depth + x)");
    assert_ne!(wrong, right);
    wrong
}

/// Writes the kernel, right and then wrong, and checks it by these commands, of which the last is the checker.
fn tried(root: &Path, (name, kernel): (&str, &str), commands: &[&[&str]]) {
    for wrong in [false, true] {
        let text = if wrong { with_mistake(kernel) } else { kernel.into() };
        fs::write(root.join(name), text).expect("written");
        let (checker, before) = commands.split_last().expect("a checker");
        for words in before {
            succeeds(Command::new(words[0]).args(&words[1..]).current_dir(root));
        }
        let (code, said) = ended(Command::new(checker[0]).args(&checker[1..]).current_dir(root));
        assert_eq!(code != Some(0), wrong, "{name}, wrong: {wrong}: {said}");
        assert!(!wrong || said.contains("color"), "{said}");
    }
}

const PYTHON: &str = "
import numpy as np

def volume_render(sigmas, rgbs, deltas):
    x = sigmas * deltas
    depth = np.concatenate([np.zeros_like(x[:, :1]), np.cumsum(x, axis=1)[:, :-1]], axis=1)
    weights = np.exp(-(depth)) * -np.expm1(-x)
    colors = (weights[..., None] * rgbs).sum(axis=1)
    return colors, weights, weights.sum(axis=1), np.exp(-x.sum(axis=1))
";

#[test]
fn in_python() {
    if !available("python3", &["-c", "import numpy"]) {
        return;
    }
    let root =
        folder("npz", &[("check.py", block("python mine")), ("check_check.py", block("python check"))]);
    let run = ["python3", "-B", "check.py"];
    tried(root.path(), ("mine.py", PYTHON), &[&run]);
    succeeds(Command::new("python3").arg("check_check.py").current_dir(root.path()));
}

const RUST: &str = "
pub fn render(sigmas: &[f64], rgbs: &[f64], deltas: &[f64]) -> [f32; 3] {
    let (mut color, mut depth) = ([0f32; 3], 0f32);
    for i in 0..sigmas.len() {
        let x = sigmas[i] as f32 * deltas[i] as f32;
        let weight = (-(depth)).exp() * -(-x).exp_m1();
        (0..3).for_each(|a| color[a] += weight * rgbs[3 * i + a] as f32);
        depth += x;
    }
    color
}
";

#[test]
fn in_rust() {
    if !installed("rustc") {
        return;
    }
    let root = folder("raw", &[("check.rs", block("rust"))]);
    let compile = ["rustc", "--edition", "2024", "check.rs", "-o", "check"];
    tried(root.path(), ("mine.rs", RUST), &[&compile, &["./check"]]);
}

const C: &str = "
#include <math.h>

void render(long samples, const double *sigmas, const double *rgbs, const double *deltas, float color[3]) {
    float depth = 0;
    color[0] = color[1] = color[2] = 0;
    for (long i = 0; i < samples; i++) {
        float x = (float)sigmas[i] * (float)deltas[i];
        float weight = expf(-(depth)) * -expm1f(-x);
        for (int a = 0; a < 3; a++) color[a] += weight * (float)rgbs[3 * i + a];
        depth += x;
    }
}
";

#[test]
fn in_c() {
    if !installed("cc") {
        return;
    }
    let root = folder("raw", &[("check.c", block("c"))]);
    let compile =
        ["cc", "-std=c99", "-Wall", "-Wextra", "-Werror", "check.c", "mine.c", "-o", "check", "-lm"];
    tried(root.path(), ("mine.c", C), &[&compile, &["./check"]]);
}

const JAVASCRIPT: &str = "
export function render(sigmas, rgbs, deltas) {
  const color = new Float32Array(3);
  let depth = 0;
  sigmas.forEach((sigma, i) => {
    const x = Math.fround(sigma * deltas[i]);
    const weight = Math.exp(-(depth)) * -Math.expm1(-x);
    for (let a = 0; a < 3; a++) color[a] += weight * rgbs[3 * i + a];
    depth += x;
  });
  return color;
}
";

#[test]
fn in_javascript() {
    if !installed("node") {
        return;
    }
    let root = folder("raw", &[("check.mjs", block("js"))]);
    tried(root.path(), ("mine.mjs", JAVASCRIPT), &[&["node", "check.mjs"]]);
}

const JULIA: &str = "
function render(sigmas, rgbs, deltas)
    color, depth = zeros(Float32, 3), 0f0
    for i in eachindex(sigmas)
        x = Float32(sigmas[i]) * Float32(deltas[i])
        weight = exp(-(depth)) * -expm1(-x)
        color .+= weight .* Float32.(rgbs[:, i])
        depth += x
    end
    color
end
";

#[test]
fn in_julia() {
    if !installed("julia") {
        return;
    }
    let root = folder("raw", &[("check.jl", block("julia"))]);
    tried(root.path(), ("mine.jl", JULIA), &[&["julia", "check.jl"]]);
}

/// Validates the index, and then an index in which something is wrong, for each of these.
const SCHEMA: &str = r#"
import copy, json, jsonschema

schema, index = (json.load(open(f"vectors/{name}.json")) for name in ("schema", "index"))
jsonschema.Draft202012Validator.check_schema(schema)
validator = jsonschema.Draft202012Validator(schema)
validator.validate(index)
for path, value in [
    (["schema"], "nerf-oracle/vectors/2"),
    (["layout"], "zip"),
    (["cases"], []),
    (["cases", 0], {}),
    (["cases", 0, "result"], "acceptable"),
    (["cases", 0, "result"], "invalid"),
    (["cases", 0, "answer"], "wrong.sign"),
    (["cases", 0, "file"], "../x.npz"),
    (["cases", 0, "dtypes"], ["bf16"]),
    (["cases", 0, "dtypes"], []),
    (["cases", 0, "inputs", "sigmas"], [-1]),
    (["cases", 0, "more"], 1),
    (["rows", 0, "outputs"], []),
    (["flags", "VR9"], {"title": "x"}),
    (["left_out", "x"], 1),
]:
    other = copy.deepcopy(index)
    place = other
    for key in path[:-1]:
        place = place[key]
    place[path[-1]] = value
    assert not validator.is_valid(other), path
"#;

#[test]
fn the_index_is_as_its_schema_says() {
    if !available("python3", &["-c", "import jsonschema"]) {
        return;
    }
    for &layout in types(&["raw"], &["npz", "raw"]) {
        let root = folder(layout, &[("validate.py", SCHEMA)]);
        succeeds(Command::new("python3").arg("validate.py").current_dir(root.path()));
    }
    // Every row, not volume rendering's alone.
    let root = tempfile::tempdir().expect("a folder");
    succeeds(Command::new(ORACLE).args(["vectors", "--out", "vectors"]).current_dir(root.path()));
    fs::write(root.path().join("validate.py"), SCHEMA.replace("\"sigmas\"", "\"c2w\"")).expect("written");
    succeeds(Command::new("python3").arg("validate.py").current_dir(root.path()));
}
