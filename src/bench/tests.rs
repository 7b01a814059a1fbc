//! The check comes first; frontier, exponents and peers on made-up figures.

use std::collections::BTreeSet;

use serde_json::{Value, json};

use super::dense::{self, CeilingCandidate, Dense, Layers, WorkCount};
use super::report::{Row, compare};
use super::scaling::exponent;
use super::suites::SUITES;
use super::truth::Truth;
use super::{Kernel, Options, Suite, Tolerance, Variant, frontier, kernel, run};
use crate::contract::Dtype;
use crate::contract::arrays::{Arrays, array, arrays, values};
use crate::contract::testing::one_in;

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

const fn variant(name: &'static str, tolerance: Tolerance, prepare: super::Prepare) -> Variant {
    Variant { name, about: "", dtype: Dtype::F32, tolerance, prepare }
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
        variant("off", Tolerance::exact().stored(1e-3), |a| times(a, 2.0 * (1.0 + 5e-4))),
        variant("wrong", Tolerance::exact().stored(1e-3), |a| times(a, 2.1)),
        variant("shapeless", Tolerance::exact().within(1e9), |a| {
            let x = values(a, "x");
            kernel(x, 0, |_| {}, |_| arrays([("y", array(&[1], vec![2.0]))]))
        }),
        variant("nan", Tolerance::exact().within(1e9), |a| times(a, f64::NAN)),
    ],
};

fn options() -> Options {
    Options { rounds: 5, least: 0.0, quick: true, ..Options::default() }
}

/// A variant that exceeds its tolerance is rejected: no seconds, a reason. The others are measured.
#[test]
fn the_check_comes_first() {
    let report = run(&[DOUBLE], &[], &[], &options(), |_| {}).unwrap();
    let row = |name: &str| report.rows.iter().find(|row| row.text("variant") == name).unwrap();
    for name in ["wrong", "shapeless", "nan"] {
        assert!(!row(name).text("refused").is_empty() && row(name).number("seconds").is_none(), "{name}");
        assert_eq!(row(name).0["on_frontier"], json!(false));
    }
    assert_eq!(report.refused(), 3);
    let off = row("off");
    // 2 (1 + 5e-4) x against 2 x: relative error and bias 5e-4 everywhere, half of the tolerance.
    for field in ["max_relative_error", "p99_relative_error", "bias"] {
        assert!((off.number(field).unwrap() - 5e-4).abs() < 1e-12, "{field}");
    }
    assert!((off.number("tolerance_used").unwrap() - 0.5).abs() < 1e-9);
    // 5e-4 in ULP of f32, which is 2^-24 to 2^-23 of a number: 4,194 to 8,389.
    assert!((4194.0..8389.0).contains(&off.number("max_ulp").unwrap()));
    assert_eq!((off.number("items"), off.number("rounds")), (Some(64.0), Some(5.0)));
    assert_eq!(row("oracle").number("max_relative_error"), Some(0.0));
    assert_eq!(row("oracle").number("speedup"), Some(1.0));
    assert!(report.text().contains("refused: double wrong"));
}

/// Every second suite of the crate (all where `.ci/run` asks): no variant is rejected, and names are unique within a suite.
#[test]
fn every_variant_is_what_it_says() {
    let suites: Vec<&Suite> = SUITES.iter().step_by(one_in(2)).collect();
    let refused = crate::parallel::map(suites.len(), |n| {
        let suite = suites[n];
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
fn tolerances_add_up() {
    let y = arrays([("y", array(&[2], vec![-4.0, 1.0]))]);
    let component = arrays([("y", array(&[2], vec![0.5, 0.25]))]);
    let tolerance = Tolerance::f32().stored(0.5).of_largest(0.25).within(8.0);
    assert_eq!(values(&tolerance.bound(Some(&component), &y), "y"), [11.5, 9.75]);
    assert_eq!(values(&Tolerance::exact().bound(None, &y), "y"), [0.0, 0.0]);
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
    let report = run(&[DOUBLE], &[], &[], &options, |_| {}).unwrap();
    let row = report.rows.iter().find(|row| row.text("variant") == "p: v").unwrap();
    assert_eq!((row.number("items_per_second"), row.number("seconds")), (Some(128.0), Some(0.5)));
    assert!(row.number("speedup").is_some());
    let printed = report.peer.unwrap();
    assert_eq!(printed["objects"].as_array().unwrap().len(), 5);
    assert_eq!(printed["figures"]["step_seconds"]["median"], 2.0);
    for (bad, word) in [("exit 3", "3"), ("echo nothing", "no JSON"), ("echo '[1]'", "no JSON")] {
        let options = Options { peer: Some(bad.into()), ..options.clone() };
        let error = run(&[DOUBLE], &[], &[], &options, |_| {}).unwrap_err().to_string();
        assert!(error.contains("`peer`") && error.contains(word), "{error}");
    }
}

/// Layers whose seconds and flops are made up: 2e9 flops in half a second, a pass of 3e9 in two.
struct MadeUp(f64);

impl Layers for MadeUp {
    fn check(&mut self) -> f64 {
        self.0
    }

    fn work(&self) -> WorkCount {
        WorkCount { points: 10, products: 2e9, pass: 3e9 }
    }

    fn products(&mut self) -> f64 {
        0.5
    }

    fn pass(&mut self) -> f64 {
        2.0
    }
}

const MADE_UP: [Dense; 3] = [
    Dense { name: "right", about: "", prepare: |_| Box::new(MadeUp(0.9)) },
    Dense { name: "wrong", about: "", prepare: |_| Box::new(MadeUp(1.1)) },
    Dense { name: "nan", about: "", prepare: |_| Box::new(MadeUp(f64::NAN)) },
];

/// 4 GFLOP/s under a ceiling of 5 are 80%, 1.5 GFLOP/s 30%. What fails its check isn't timed.
#[test]
fn shares_of_a_made_up_ceiling() {
    let mut measured = dense::prepare(&MADE_UP, 0.0, true);
    measured.iter_mut().for_each(dense::Measured::round);
    let candidates = [("slow", 3.0), ("fast", 5.0), ("nan", f64::NAN), ("middle", 4.0)];
    let candidates = candidates.map(|(name, gflops)| CeilingCandidate { name: name.into(), gflops });
    let section = dense::section(&measured, &candidates, Some("one that was away".into()));
    assert_eq!((&section["ceiling_gflops"], &section["ceiling_of"]), (&json!(5.0), &json!("fast")));
    let row = &section["rows"][0];
    for (field, figure) in [
        ("products_gflops", 4.0),
        ("share_products", 0.8),
        ("best_share_products", 0.8),
        ("pass_gflops", 1.5),
        ("share_pass", 0.3),
        ("products_spread", 0.0),
    ] {
        assert!((row[field].as_f64().unwrap() - figure).abs() < 1e-12, "{field}");
    }
    for n in [1, 2] {
        let row = &section["rows"][n];
        assert!(row["refused"].is_string() && row["share_products"].is_null(), "{row}");
    }
    assert!(dense::ceiling_text(&section).contains("slow 3, fast 5") && dense::cells(row)[4] == "80.0%");
    let report = run(&[], &[], &MADE_UP, &options(), |_| {}).unwrap();
    assert_eq!(report.refused(), 2);
    assert!(report.text().contains("refused: wrong") && super::page::page(&report).contains("Dense layers"));
    assert!(run(&[], &[], &[], &options(), |_| {}).unwrap().dense.is_null());
}

/// A peer's product is a candidate if it ran on as many threads; otherwise the report says so.
#[test]
#[cfg(unix)]
fn a_peers_product_takes_part_in_the_ceiling() {
    let ceiling = |printed: &str| {
        let options = Options { peer: Some(format!("echo '{printed}'")), rounds: 1, ..options() };
        run(&[], &[], &MADE_UP, &options, |_| {}).unwrap().dense
    };
    let threads = crate::parallel::threads();
    let more = threads + 1;
    let dense = ceiling(&format!(
        r#"{{"program": "p", "threads": {threads}, "sgemm_gflops": 1e9, "sgemm_size": 64, "sgemm_library": "L"}}"#
    ));
    assert_eq!((&dense["ceiling_gflops"], &dense["ceiling_of"]), (&json!(1e9), &json!("p: L 64^3")));
    assert!(dense["ceiling_left_out"].is_null());
    for (printed, word) in [
        (r#"{"program": "p"}"#.into(), "sgemm_gflops"),
        (r#"{"program": "p", "sgemm_gflops": -1}"#.into(), "sgemm_gflops"),
        (format!(r#"{{"program": "p", "threads": {more}, "sgemm_gflops": 1e9}}"#), "threads"),
    ] {
        let dense = ceiling(&printed);
        assert!(dense["ceiling_left_out"].as_str().unwrap().contains(word), "{dense}");
        assert_eq!(dense["ceiling_candidates"].as_array().unwrap().len(), 2);
    }
}
