//! The check comes first; frontier, exponents and peers on made-up figures.

use std::collections::BTreeSet;

use serde_json::{Value, json};

use super::report::{Row, compare};
use super::scaling::exponent;
use super::suites::SUITES;
use super::truth::Truth;
use super::{Kernel, Options, Promise, Suite, Variant, frontier, kernel, run};
use crate::verify::Dtype;
use crate::verify::component::{Arrays, array, arrays, values};

fn workload(items: usize) -> Arrays {
    arrays([("x", array(&[items], (0..items).map(|i| 1.0 + i as f64 / 8.0).collect()))])
}

/// y = factor x.
fn times(a: &Arrays, factor: f64) -> Box<dyn Kernel> {
    let x = values(a, "x");
    let y = vec![0.0; x.len()];
    let run = move |(x, y): &mut (Vec<f64>, Vec<f64>)| {
        x.iter().zip(y).for_each(|(x, y)| *y = factor * x);
    };
    kernel((x, y), 0, run, |(_, y)| arrays([("y", array(&[y.len()], y.clone()))]))
}

const fn variant(name: &'static str, promise: Promise, prepare: super::Prepare) -> Variant {
    Variant { name, about: "", dtype: Dtype::F32, promise, prepare }
}

const DOUBLE: Suite = Suite {
    component: "double",
    judged: false,
    item: "point",
    workload,
    // A quarter of these in a quick run.
    items: 256,
    checked: 16,
    oracle: |a| times(a, 2.0),
    variants: &[
        variant("off", Promise::exact().stored(1e-3), |a| times(a, 2.0 * (1.0 + 5e-4))),
        variant("wrong", Promise::exact().stored(1e-3), |a| times(a, 2.1)),
        variant("shapeless", Promise::exact().within(1e9), |a| {
            let x = values(a, "x");
            kernel(x, 0, |_| {}, |_| arrays([("y", array(&[1], vec![2.0]))]))
        }),
        variant("nan", Promise::exact().within(1e9), |a| times(a, f64::NAN)),
    ],
};

fn options() -> Options {
    Options { rounds: 5, least: 0.0, quick: true, ..Options::default() }
}

/// A variant that isn't what it says is refused: no seconds, a reason. The others are measured.
#[test]
fn the_check_comes_first() {
    let report = run(&[DOUBLE], &[], &options(), |_| {}).unwrap();
    let row = |name: &str| report.rows.iter().find(|row| row.text("variant") == name).unwrap();
    for name in ["wrong", "shapeless", "nan"] {
        assert!(!row(name).text("refused").is_empty() && row(name).number("seconds").is_none(), "{name}");
        assert_eq!(row(name).0["on_frontier"], json!(false));
    }
    assert_eq!(report.refused(), 3);
    let off = row("off");
    // 2 (1 + 5e-4) x against 2 x: relative error and bias 5e-4 everywhere, half of what was promised.
    for field in ["max_relative_error", "p99_relative_error", "bias"] {
        assert!((off.number(field).unwrap() - 5e-4).abs() < 1e-12, "{field}");
    }
    assert!((off.number("promise_used").unwrap() - 0.5).abs() < 1e-9);
    // 5e-4 in ULP of f32, which is 2^-24 to 2^-23 of a number: 4,194 to 8,389.
    assert!((4194.0..8389.0).contains(&off.number("max_ulp").unwrap()));
    assert_eq!((off.number("items"), off.number("rounds")), (Some(64.0), Some(5.0)));
    assert_eq!(row("oracle").number("max_relative_error"), Some(0.0));
    assert_eq!(row("oracle").number("speedup"), Some(1.0));
    assert!(report.text().contains("refused: double wrong"));
}

/// All suites of the crate: no variant is refused, and no two of a suite have one name.
#[test]
fn every_variant_is_what_it_says() {
    let refused = crate::parallel::map(SUITES.len(), |n| {
        let suite = &SUITES[n];
        let mut truth = Truth::new(suite);
        let all: Vec<Variant> = [suite.oracle_variant()].into_iter().chain(suite.variants.to_vec()).collect();
        let names: BTreeSet<&str> = all.iter().map(|variant| variant.name).collect();
        assert_eq!(names.len(), all.len(), "{}", suite.component);
        let check = |variant: &Variant| {
            let why = truth.check(suite, variant).err()?;
            Some(format!("{} {}: {why}", suite.component, variant.name))
        };
        all.iter().filter_map(check).collect::<Vec<_>>()
    });
    assert!(refused.concat().is_empty(), "{refused:?}");
}

#[test]
fn promises_add_up() {
    let y = arrays([("y", array(&[2], vec![-4.0, 1.0]))]);
    let component = arrays([("y", array(&[2], vec![0.5, 0.25]))]);
    let promise = Promise::f32().stored(0.5).of_largest(0.25).within(8.0);
    assert_eq!(values(&promise.bound(Some(&component), &y), "y"), [11.5, 9.75]);
    assert_eq!(values(&Promise::exact().bound(None, &y), "y"), [0.0, 0.0]);
}

/// By hand: c is slower and worse than a, d equals b (both stay), e isn't a number.
#[test]
fn the_frontier_of_a_made_up_list() {
    let list = [(1.0, 0.5), (2.0, 0.1), (3.0, 0.5), (2.0, 0.1), (f64::NAN, 0.0), (9.0, 0.0), (1.0, 0.6)];
    assert_eq!(frontier::on_frontier(&list), [true, true, false, true, false, true, false]);
}

#[test]
fn rows_are_compared_within_their_component() {
    let row = |component: &str, variant: &str, rate: f64, error: f64| {
        let object = json!({
            "component": component, "variant": variant, "seconds": 1.0 / rate, "items_per_second": rate, "items": 1,
            "max_relative_error": error,
        });
        let Value::Object(row) = object else { unreachable!("an object literal") };
        Row(row)
    };
    let mut rows = vec![row("a", "oracle", 2.0, 0.0), row("a", "fast", 8.0, 0.1), row("b", "fast", 1.0, 0.9)];
    compare(&mut rows);
    assert_eq!(rows[1].number("speedup"), Some(4.0));
    assert_eq!(rows[2].number("speedup"), None, "b has no oracle here");
    assert!(rows.iter().all(|row| row.0["on_frontier"] == true));
}

#[test]
fn exponents_of_known_data() {
    let x = [1.0, 2.0, 5.0, 10.0, 40.0];
    for p in [-1.0, 0.0, 0.5, 2.0] {
        let y = x.map(|x: f64| 3.0 * x.powf(p));
        assert!((exponent(&x, &y).unwrap() - p).abs() < 1e-12, "{p}");
    }
    // By hand, in powers of 2: (0, 0), (1, 2), (2, 1): slope (2 * 1) / 2 / 2 = 1/2.
    assert!((exponent(&[1.0, 2.0, 4.0], &[1.0, 4.0, 2.0]).unwrap() - 0.5).abs() < 1e-12);
    assert_eq!(exponent(&[1.0], &[1.0]), None);
}

#[test]
#[cfg(unix)]
fn a_peer_takes_part_in_every_round() {
    let peer = r#"echo warming up; echo '{"program": "p", "step_seconds": 2, "rows": [{"component": "double", "variant": "v", "seconds": 0.5, "items": 64}]}'"#;
    let options = Options { peer: Some(peer.into()), ..options() };
    let report = run(&[DOUBLE], &[], &options, |_| {}).unwrap();
    let row = report.rows.iter().find(|row| row.text("variant") == "p: v").unwrap();
    assert_eq!((row.number("items_per_second"), row.number("seconds")), (Some(128.0), Some(0.5)));
    assert!(row.number("speedup").is_some());
    let printed = report.peer.unwrap();
    assert_eq!(printed["objects"].as_array().unwrap().len(), 5);
    assert_eq!(printed["figures"]["step_seconds"]["median"], 2.0);
    for (bad, word) in [("exit 3", "3"), ("echo nothing", "no JSON"), ("echo '[1]'", "no JSON")] {
        let options = Options { peer: Some(bad.into()), ..options.clone() };
        let error = run(&[DOUBLE], &[], &options, |_| {}).unwrap_err().to_string();
        assert!(error.contains("--peer") && error.contains(word), "{error}");
    }
}
