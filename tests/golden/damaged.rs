//! A damaged fixture is rejected with its name and the command that makes it again.

use std::path::Path;

use nerf_oracle::proof::golden::{load, load_all};

/// A copy of one fixture, changed by `damage`, and what loading it says.
fn message(damage: impl Fn(&Path, &mut String)) -> String {
    let folder = tempfile::tempdir().unwrap();
    let target = folder.path().join("mse");
    std::fs::create_dir(&target).unwrap();
    let source = super::folder().join("mse");
    std::fs::copy(source.join("mpmath.npz"), target.join("mpmath.npz")).unwrap();
    let mut json = std::fs::read_to_string(source.join("mpmath.json")).unwrap();
    damage(&target.join("mpmath.npz"), &mut json);
    std::fs::write(target.join("mpmath.json"), json).unwrap();
    load(&target.join("mpmath.json")).map_or_else(|error| error.to_string(), |_| "loaded".into())
}

#[test]
fn an_unchanged_copy_loads() {
    assert_eq!(message(|_, _| {}), "loaded");
}

#[test]
fn a_changed_byte_a_schema_and_a_place_are_named() {
    let flipped = message(|npz, _| {
        let mut bytes = std::fs::read(npz).unwrap();
        let middle = bytes.len() / 2;
        bytes[middle] ^= 1;
        std::fs::write(npz, bytes).unwrap();
    });
    assert!(flipped.contains("mpmath.npz") && flipped.contains("sha256"), "{flipped}");
    let schema = message(|_, json| *json = json.replace("fixture/1", "fixture/2"));
    assert!(schema.contains("mpmath.json") && schema.contains("fixture/2"), "{schema}");
    let place = message(|_, json| *json = json.replace(r#""component": "mse""#, r#""component": "psnr""#));
    assert!(place.contains("psnr/mpmath"), "{place}");
    let convention = message(|_, json| {
        *json = json.replacen(r#""flags": []"#, r#""flags": [], "conventions": {"x": "y"}"#, 1)
    });
    assert!(convention.contains("conventions of batch"), "{convention}");
    for said in [flipped, schema, place, convention] {
        assert!(said.contains("python tools/golden.py --only mse"), "{said}");
    }
}

#[test]
fn a_folder_without_fixtures_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    assert!(load_all(folder.path()).unwrap_err().to_string().contains("python tools/golden.py"));
}
