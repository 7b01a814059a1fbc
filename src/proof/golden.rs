//! Fixtures: what mpmath, torch and kornia say about a component, read from `fixtures/<component>/<basis>.{json,npz}`.
//!
//! `fixtures/README.md` has the format. `tools/golden.py` makes the files; nothing here needs Python. The truth of an mpmath
//! fixture is `hi + lo`, and an error counts in ULP of the largest term that an element sums (the element itself where no sum
//! cancels).

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use ndarray::ArrayD;
use serde::Deserialize;
use sha2::{Digest, Sha256};

use crate::contract::arrays::Arrays;
use crate::contract::component::{Component, Port};
use crate::convention::{CS180, Conventions};
use crate::error::{Error, Input, Result};
use crate::files::npz::{Array, Npz};

/// The format that this module reads.
pub const SCHEMA: &str = "nerf-oracle/fixture/1";

/// One file of fixtures.
#[derive(Clone, Debug)]
pub struct Fixture {
    /// Its component, or the name of several in a row (`loss_gradient`, ...).
    pub component: String,
    /// `mpmath`, `torch` or `kornia`.
    pub basis: String,
    /// Its cases.
    pub cases: Vec<Golden>,
    /// What the basis does differently on purpose.
    pub known_differences: Vec<Difference>,
}

/// One case.
#[derive(Clone, Debug)]
pub struct Golden {
    /// Unique within the file; ends in the id of the hard case that it is, if it is one.
    pub name: String,
    /// Whether the outputs are gradients.
    pub vjp: bool,
    /// The default profile with the case's changes.
    pub conventions: Conventions,
    /// Numbers of the quirks that the basis adds, by name.
    pub quirks: BTreeMap<String, serde_json::Value>,
    /// Inputs, and `grad_<output>` for a VJP.
    pub inputs: Arrays,
    /// What should come out.
    pub outputs: BTreeMap<String, Expected>,
}

/// One output of a case.
#[derive(Clone, Debug)]
pub struct Expected {
    /// The value, rounded to f64.
    pub hi: ArrayD<f64>,
    /// The remainder of the rounding; zeros where the basis itself computes in f64.
    pub lo: ArrayD<f64>,
    /// One ULP of each element's largest term.
    pub ulp: ArrayD<f64>,
    /// The basis' own largest error in these ULP: 0 for mpmath.
    pub own: f64,
}

/// A known difference.
#[derive(Clone, Debug, Deserialize)]
pub struct Difference {
    /// A convention as `key=value`, or a quirk.
    pub name: String,
    /// Why it is there.
    pub reason: String,
    /// Names of the cases that have it.
    pub cases: Vec<String>,
}

#[derive(Deserialize)]
struct Note {
    schema: String,
    component: String,
    basis: String,
    npz: Sum,
    cases: Vec<CaseNote>,
    known_differences: Vec<Difference>,
}

#[derive(Deserialize)]
struct Sum {
    sha256: String,
}

#[derive(Deserialize)]
struct CaseNote {
    name: String,
    kind: String,
    flags: Vec<String>,
    #[serde(default)]
    conventions: BTreeMap<String, String>,
    #[serde(default)]
    quirks: BTreeMap<String, serde_json::Value>,
    #[serde(default)]
    outputs: BTreeMap<String, Recorded>,
}

#[derive(Deserialize)]
struct Recorded {
    ulp: f64,
    unit: f64,
}

impl Expected {
    /// The error of each element in ULP of its largest term; infinite for NaN or another shape. Equal infinities agree.
    pub fn errors(&self, got: &ArrayD<f64>) -> Vec<f64> {
        if got.shape() != self.hi.shape() {
            return vec![f64::INFINITY; self.hi.len().max(1)];
        }
        let truth = self.hi.iter().zip(&self.lo).zip(&self.ulp);
        got.iter()
            .zip(truth)
            .map(|(&got, ((&hi, &lo), &ulp))| {
                if got == hi && lo == 0.0 {
                    return 0.0;
                }
                let error = if got == hi { lo.abs() } else { (got - hi - lo).abs() } / ulp;
                if error.is_nan() { f64::INFINITY } else { error }
            })
            .collect()
    }
}

/// One unit in the last place of x: the distance to the next larger f64.
pub fn ulp(x: f64) -> f64 {
    x.abs().next_up() - x.abs()
}

/// Every fixture under `folder`, by component and basis.
///
/// # Errors
/// The first file that isn't what its JSON says; a folder without fixtures.
pub fn load_all(folder: &Path) -> Result<Vec<Fixture>> {
    let mut notes = Vec::new();
    for component in std::fs::read_dir(folder).map_err(Error::reading(folder))?.flatten() {
        if component.path().is_dir() {
            let files = std::fs::read_dir(component.path()).map_err(Error::reading(&component.path()))?;
            let json = |path: &PathBuf| path.extension().is_some_and(|end| end == "json");
            notes.extend(files.flatten().map(|file| file.path()).filter(json));
        }
    }
    notes.sort();
    if notes.is_empty() {
        let remedy = "Make them with: python tools/golden.py";
        return Err(Error::input(Input {
            file: folder.display(),
            field: "fixtures",
            found: "none",
            expected: "<component>/<basis>.json",
            remedy,
        }));
    }
    notes.iter().map(|path| load(path)).collect()
}

/// The fixture whose JSON is at `path`; the npz lies beside it.
///
/// # Errors
/// Another schema, path or sha256 than the JSON's; an array of the wrong shape, missing, or holding NaN or, unless the case is
/// flagged `infinite`, an infinity. The message names the file and the command that makes it again.
pub fn load(path: &Path) -> Result<Fixture> {
    let text = std::fs::read_to_string(path).map_err(Error::reading(path))?;
    let folder = path.parent().and_then(Path::file_name).unwrap_or_default().to_string_lossy().to_string();
    let npz = path.with_extension("npz");
    let wrong = |file: &Path, field: &str, found: &dyn ToString, expected: &dyn ToString| {
        let remedy = format!("Make it again with: python tools/golden.py --only {folder}");
        Error::input(Input {
            file: file.display(),
            field,
            found: found.to_string(),
            expected: expected.to_string(),
            remedy,
        })
    };
    let note: Note = serde_json::from_str(&text)
        .map_err(|error| wrong(path, "JSON", &error, &"the fields of a fixture"))?;
    if note.schema != SCHEMA {
        return Err(wrong(path, "schema", &note.schema, &SCHEMA));
    }
    if note.component != folder || path.file_stem().is_none_or(|stem| stem.to_string_lossy() != note.basis) {
        return Err(wrong(
            path,
            "component and basis",
            &format!("{}/{}", note.component, note.basis),
            &"its path",
        ));
    }
    let bytes = std::fs::read(&npz).map_err(Error::reading(&npz))?;
    let sum: String = Sha256::digest(&bytes).iter().map(|byte| format!("{byte:02x}")).collect();
    if sum != note.npz.sha256 {
        return Err(wrong(&npz, "sha256", &sum, &note.npz.sha256));
    }
    let arrays = arrays_of(&npz)?;
    let cases = note.cases.iter().map(|case| {
        assemble(case, &arrays).map_err(|(field, found, expected)| wrong(&npz, &field, &found, &expected))
    });
    let cases = cases.collect::<Result<Vec<_>>>()?;
    if cases.is_empty() {
        return Err(wrong(path, "cases", &"none", &"at least one"));
    }
    Ok(Fixture {
        component: note.component,
        basis: note.basis,
        cases,
        known_differences: note.known_differences,
    })
}

/// The arrays of an npz by name, which must all be f64.
fn arrays_of(path: &Path) -> Result<Arrays> {
    let mut npz = Npz::open(path)?;
    let names: Vec<String> = npz.names().map(str::to_string).collect();
    let read = |name: String| match npz.array(&name)? {
        Array::F64(array) => Ok((name, array)),
        other => {
            let remedy = "Fixtures are written by tools/golden.py alone.";
            Err(Error::input(Input {
                file: path.display(),
                field: name,
                found: other.dtype(),
                expected: "f64",
                remedy,
            }))
        }
    };
    names.into_iter().map(read).collect()
}

/// (field, found, expected) of what is wrong.
type Wrong = (String, String, String);

/// One case from its note and the arrays `<case>.in.<name>` and `<case>.out.<name>`.
fn assemble(note: &CaseNote, arrays: &Arrays) -> Result<Golden, Wrong> {
    let infinite = note.flags.iter().any(|flag| flag == "infinite");
    let (mut inputs, mut outputs) = (Arrays::new(), BTreeMap::new());
    let prefix = format!("{}.in.", note.name);
    for (key, array) in arrays.range(prefix.clone()..).take_while(|(key, _)| key.starts_with(&prefix)) {
        check_finite(key, array, false)?;
        inputs.insert(key[prefix.len()..].to_string(), array.clone());
    }
    let prefix = format!("{}.out.", note.name);
    for (key, hi) in arrays.range(prefix.clone()..).take_while(|(key, _)| key.starts_with(&prefix)) {
        check_finite(key, hi, infinite)?;
        let name = &key[prefix.len()..];
        if !name.contains('.') {
            outputs.insert(name.to_string(), expected(note, name, hi, arrays)?);
        }
    }
    if inputs.is_empty() || outputs.is_empty() {
        return Err((note.name.clone(), "no arrays".into(), "inputs and outputs".into()));
    }
    let unknown =
        |error: Error| (format!("conventions of {}", note.name), error.to_string(), "known ones".into());
    let conventions = note.conventions.iter().try_fold(CS180, |c, (k, v)| c.with(k, v)).map_err(unknown)?;
    let vjp = note.kind == "vjp";
    Ok(Golden { name: note.name.clone(), vjp, conventions, quirks: note.quirks.clone(), inputs, outputs })
}

/// hi, lo, ULP and own error of one output.
fn expected(note: &CaseNote, name: &str, hi: &ArrayD<f64>, arrays: &Arrays) -> Result<Expected, Wrong> {
    let key = format!("{}.out.{name}", note.name);
    let zeros = ArrayD::zeros(hi.shape());
    if let Some(recorded) = note.outputs.get(name) {
        let unit = ArrayD::from_elem(hi.shape(), recorded.unit);
        return Ok(Expected { hi: hi.clone(), lo: zeros, ulp: unit, own: recorded.ulp });
    }
    let part = |end: &str| match arrays.get(&format!("{key}.{end}")) {
        Some(part) if part.shape() != hi.shape() => {
            Err((format!("{key}.{end}"), format!("{:?}", part.shape()), format!("{:?}", hi.shape())))
        }
        part => Ok(part),
    };
    let lo =
        part("lo")?.ok_or_else(|| (format!("{key}.lo"), "nothing".to_string(), "an array".to_string()))?;
    let term = part("term")?.unwrap_or(hi);
    Ok(Expected { hi: hi.clone(), lo: lo.clone(), ulp: term.mapv(ulp), own: 0.0 })
}

/// Refuses NaN, and infinities where none belong.
fn check_finite(key: &str, array: &ArrayD<f64>, infinite: bool) -> Result<(), Wrong> {
    match array.iter().find(|x| x.is_nan() || (x.is_infinite() && !infinite)) {
        Some(x) => Err((key.to_string(), x.to_string(), "finite numbers".into())),
        None => Ok(()),
    }
}

/// The arrays of a case whose shape isn't the one that the registry states: array, found, expected.
pub fn misshapen(component: &Component, case: &Golden) -> Option<Wrong> {
    let mut sizes = BTreeMap::new();
    let outputs = case.outputs.iter().map(|(name, expected)| (name, &expected.hi));
    for (name, array) in case.inputs.iter().chain(outputs) {
        let of = name.strip_prefix("grad_").unwrap_or(name);
        let Some(port) = ports(component).find(|port| port.name == of) else { continue };
        let letters: Vec<&str> = port.shape.split(',').filter(|letter| !letter.is_empty()).collect();
        // `...` or an expression: a size that follows from the others.
        let fits = letters.len() == array.ndim()
            && letters.iter().zip(array.shape()).all(|(letter, &size)| match letter.parse::<usize>() {
                Ok(fixed) => fixed == size,
                Err(_) if letter.len() == 1 => *sizes.entry(letter.to_string()).or_insert(size) == size,
                Err(_) => true,
            });
        if !fits && !port.shape.contains("...") {
            return Some((name.clone(), format!("{:?}", array.shape()), port.shape.to_string()));
        }
    }
    None
}

/// All ports of a component.
fn ports(component: &Component) -> impl Iterator<Item = &'static Port> {
    component.inputs.iter().chain(component.outputs)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contract::arrays::{array, arrays};

    fn note(flags: &str) -> CaseNote {
        serde_json::from_str(&format!(r#"{{"name": "a", "kind": "forward", "flags": [{flags}]}}"#)).unwrap()
    }

    fn stored(x: f64, y: f64, lo: &[f64]) -> Arrays {
        arrays([
            ("a.in.x", array(&[1], vec![x])),
            ("a.out.y", array(&[1], vec![y])),
            ("a.out.y.lo", array(&[lo.len()], lo.to_vec())),
            ("ab.in.x", array(&[1], vec![f64::NAN])),
        ])
    }

    #[test]
    fn nan_infinity_and_other_shapes_are_refused() {
        let plain = note("");
        assert!(assemble(&plain, &stored(1.0, 2.0, &[0.0])).is_ok());
        assert_eq!(assemble(&plain, &stored(f64::NAN, 2.0, &[0.0])).unwrap_err().0, "a.in.x");
        assert_eq!(assemble(&plain, &stored(1.0, f64::NAN, &[0.0])).unwrap_err().0, "a.out.y");
        assert_eq!(assemble(&plain, &stored(1.0, f64::INFINITY, &[0.0])).unwrap_err().0, "a.out.y");
        assert_eq!(assemble(&plain, &stored(1.0, 2.0, &[0.0, 0.0])).unwrap_err().0, "a.out.y.lo");
        assert!(assemble(&note(r#""infinite""#), &stored(1.0, f64::INFINITY, &[0.0])).is_ok());
        assert!(assemble(&note(r#""infinite""#), &stored(1.0, f64::NAN, &[0.0])).is_err());
        assert!(assemble(&plain, &Arrays::new()).is_err());
    }

    #[test]
    fn errors_count_from_the_unrounded_truth() {
        let expected = assemble(&note(""), &stored(1.0, 2.0, &[f64::EPSILON])).unwrap().outputs["y"].clone();
        // 2 + eps lies half way between 2 and its successor 2 + 2 eps, whose distance is one ULP.
        assert_eq!(expected.errors(&array(&[1], vec![2.0])), [0.5]);
        assert_eq!(expected.errors(&array(&[1], vec![2.0f64.next_up()])), [0.5]);
        assert_eq!(expected.errors(&array(&[1], vec![f64::NAN])), [f64::INFINITY]);
        assert_eq!(expected.errors(&array(&[2], vec![2.0, 2.0])), [f64::INFINITY]);
    }
}
