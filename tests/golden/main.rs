//! The reference against its fixtures: mpmath (the truth), torch and kornia.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use nerf_oracle::COMPONENTS;
use nerf_oracle::contract::arrays::Arrays;
use nerf_oracle::proof::golden::{Fixture, Golden, load, load_all, misshapen};
use nerf_oracle::proof::own_error::{OWN_ERRORS, fault, limit};

mod answer;
mod damaged;

use answer::{Change, SYSTEMS, answer, component};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures")
}

/// All fixtures of some bases. A damaged file stops the test with its name and the command that makes it again.
fn fixtures(bases: &[&str]) -> Vec<Fixture> {
    let all = load_all(&folder()).unwrap_or_else(|error| panic!("{error}"));
    let found: Vec<_> = all.into_iter().filter(|f| bases.contains(&f.basis.as_str())).collect();
    assert!(!found.is_empty(), "no fixtures of {bases:?}");
    found
}

/// The largest error of a case in ULP of the largest term, and which output has it.
fn worst(case: &Golden, got: &Arrays) -> (f64, String) {
    let errors = case.outputs.iter().map(|(name, expected)| {
        let got = got.get(name).unwrap_or_else(|| panic!("{}: no output {name}", case.name));
        (expected.errors(got).into_iter().fold(0.0, f64::max), name.clone())
    });
    errors.max_by(|a, b| a.0.total_cmp(&b.0)).expect("a case has outputs")
}

#[test]
fn the_table_of_own_errors_is_true() {
    let mut measured: BTreeMap<(String, bool), (f64, String)> = BTreeMap::new();
    for fixture in fixtures(&["mpmath"]) {
        for case in &fixture.cases {
            let (error, output) = worst(case, &answer(&fixture.component, case, &Change::None));
            let row = measured.entry((fixture.component.clone(), case.vjp)).or_default();
            if error >= row.0 {
                *row = (error, format!("{} {output}", case.name));
            }
        }
    }
    let mut wrong = Vec::new();
    for ((name, vjp), (error, at)) in &measured {
        let direction = if *vjp { "vjp" } else { "forward" };
        println!("{name:22} {direction:8} {error:9.3} ULP at {at}");
        wrong.extend(fault(name, *vjp, *error).map(|fault| format!("{fault} ({at})")));
    }
    assert!(wrong.is_empty(), "OWN_ERRORS in src/proof/own_error.rs:\n{}", wrong.join("\n"));
}

#[test]
fn torch_and_kornia_agree_within_their_own_error_and_ours() {
    for fixture in fixtures(&["torch", "kornia"]) {
        for case in &fixture.cases {
            let excess = excess(&fixture.component, case, &Change::None);
            assert!(
                excess <= 1.0,
                "{}/{} {}: {excess} of the budget",
                fixture.component,
                fixture.basis,
                case.name
            );
        }
    }
}

/// The largest error over budget, where the budget is the basis' own error and the reference's.
fn excess(name: &str, case: &Golden, change: &Change) -> f64 {
    let got = answer(name, case, change);
    let outputs = case.outputs.iter().map(|(output, expected)| {
        let budget = expected.own + limit(name, case.vjp);
        let error = expected.errors(&got[output]).into_iter().fold(0.0, f64::max);
        if error == 0.0 { 0.0 } else { error / budget }
    });
    outputs.fold(0.0, f64::max)
}

#[test]
fn every_known_difference_is_needed() {
    for fixture in fixtures(&["kornia"]) {
        for difference in &fixture.known_differences {
            assert!(difference.reason.len() > 20, "{}: {} has no reason", fixture.component, difference.name);
            for case in fixture.cases.iter().filter(|case| difference.cases.contains(&case.name)) {
                let change = Change::Without(&difference.name);
                let excess = excess(&fixture.component, case, &change);
                let (name, case) = (&fixture.component, &case.name);
                assert!(
                    excess > 1.0,
                    "{name} {case} agrees without its known difference {}",
                    difference.name
                );
            }
        }
    }
}

#[test]
fn registry_and_fixtures_hold_the_same_components() {
    let all = fixtures(&["mpmath", "torch", "kornia"]);
    for basis in ["mpmath", "torch"] {
        let found: BTreeSet<&str> =
            all.iter().filter(|f| f.basis == basis).map(|f| f.component.as_str()).collect();
        let registered = COMPONENTS.iter().map(|c| c.name);
        let expected: BTreeSet<&str> = registered.chain(SYSTEMS.iter().copied()).collect();
        let missing: Vec<_> = expected.difference(&found).collect();
        assert!(
            missing.is_empty(),
            "{basis}: no fixtures of {missing:?}: python tools/golden.py --only NAME"
        );
        let gone: Vec<_> = found.difference(&expected).collect();
        assert!(gone.is_empty(), "{basis}: fixtures of {gone:?}, which src/registry.rs lacks: delete them");
    }
    let rows: BTreeSet<&str> = OWN_ERRORS.iter().map(|row| row.component).collect();
    let found: BTreeSet<&str> = all.iter().map(|f| f.component.as_str()).collect();
    assert_eq!(rows, found, "rows of OWN_ERRORS (left), components with fixtures (right)");
    for component in COMPONENTS {
        for basis in ["mpmath", "torch"] {
            let fixture = all.iter().find(|f| f.component == component.name && f.basis == basis).unwrap();
            let vjps = fixture.cases.iter().filter(|case| case.vjp).count();
            assert_eq!(
                vjps > 0,
                component.vjp.is_some(),
                "{} in {basis}: cases with gradients",
                component.name
            );
        }
    }
}

#[test]
fn shapes_are_those_of_the_registry() {
    for fixture in fixtures(&["mpmath", "torch", "kornia"]) {
        let Some(component) = component(&fixture.component) else { continue };
        for case in &fixture.cases {
            let wrong = misshapen(component, case);
            assert!(wrong.is_none(), "{}/{} {}: {wrong:?}", fixture.component, fixture.basis, case.name);
        }
    }
}

#[test]
fn fixtures_are_small() {
    for fixture in fixtures(&["mpmath", "torch", "kornia"]) {
        let path = folder().join(&fixture.component).join(format!("{}.npz", fixture.basis));
        let bytes = std::fs::metadata(&path).unwrap().len();
        assert!(bytes < 1_000_000, "{}: {bytes} bytes", path.display());
        assert!(load(&path.with_extension("json")).is_ok());
    }
}
