//! `bench` as a user meets it: fields, files, and how bad input ends. No figure is asserted that depends on the clock.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

fn run(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_nerf-oracle")).args(args).output().expect("the program starts")
}

fn path(dir: &Path, name: &str) -> String {
    dir.join(name).display().to_string()
}

/// The fields of the contract, and what they hold for a cheap component.
#[test]
fn a_component_is_checked_timed_and_drawn() {
    let dir = tempfile::tempdir().expect("a temporary folder");
    let out = path(dir.path(), "out");
    let output = run(&["bench", "spherical", "--out", &out, "--quick", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let printed: Value = serde_json::from_slice(&output.stdout).expect("one object on stdout");
    let text = fs::read_to_string(dir.path().join("out/bench.json")).expect("bench.json");
    assert_eq!(printed, serde_json::from_str::<Value>(&text).expect("the same object"));
    let rows = printed["rows"].as_array().expect("rows");
    let names: Vec<&str> = rows.iter().map(|row| row["variant"].as_str().expect("a name")).collect();
    assert_eq!(names, ["oracle", "plain_f32", "vectorized", "threaded", "bf16"]);
    for row in rows {
        assert_eq!(row["component"], "spherical_harmonics");
        assert!(row["dtype"].is_string() && row["on_frontier"].is_boolean());
        let figures = ["seconds", "items_per_second", "speedup"];
        assert!(figures.iter().all(|f| row[f].as_f64().is_some_and(|x| x > 0.0)), "{row}");
        let errors = ["spread", "max_relative_error", "p99_relative_error", "max_ulp", "budget_used"];
        assert!(errors.iter().all(|f| row[f].as_f64().is_some_and(|x| x >= 0.0)), "{row}");
        assert!(row["bias"].is_f64() && row["rounds"].as_u64().is_some_and(|n| n >= 5));
        assert!(row["budget_used"].as_f64() <= Some(1.0) && row["tolerance_used"].as_f64() <= Some(1.0));
        for figure in ["sgemm_gflops", "random_reads_per_second"] {
            assert!(row["calibration"][figure].as_f64().is_some_and(|x| x > 0.0), "{row}");
        }
    }
    let of = |n: usize, field: &str| rows[n][field].as_f64().expect("a number");
    assert_eq!((of(0, "max_relative_error"), of(0, "speedup")), (0.0, 1.0));
    // bf16 keeps 8 bits: half a unit of the last place, 2^-8 at most.
    assert!((0.4..=0.6).contains(&of(4, "max_ulp")) && of(4, "max_relative_error") < 0.004);
    assert!(of(4, "max_relative_error") > of(3, "max_relative_error"));
    let page = fs::read_to_string(dir.path().join("out/index.html")).expect("index.html");
    assert!(
        page.contains("<svg") && page.contains("class=\"frontier\"") && page.contains("<title>oracle (f64)")
    );
    let table = fs::read_to_string(dir.path().join("out/table.txt")).expect("table.txt");
    assert!(table.contains("spherical_harmonics") && table.contains("GFLOP/s"));
}

/// The section of dense layers, and what a quick report says about its ceiling.
#[test]
fn dense_layers_have_a_share_of_the_ceiling() {
    let dir = tempfile::tempdir().expect("a temporary folder");
    let out = path(dir.path(), "out");
    let output = run(&["bench", "dense", "--out", &out, "--quick", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let printed: Value = serde_json::from_slice(&output.stdout).expect("one object on stdout");
    let dense = &printed["dense"];
    let number = |value: &Value, field: &str| value[field].as_f64().unwrap_or(f64::NAN);
    let candidates = dense["ceiling_candidates"].as_array().expect("a list");
    let names: Vec<&str> = candidates.iter().map(|c| c["name"].as_str().expect("a name")).collect();
    assert_eq!(names, ["gemm 1024^3 (quick: not 4096^3)", "gemm 1024x256x256, one a thread"]);
    let most = candidates.iter().map(|c| number(c, "gflops")).fold(0.0, f64::max);
    assert!(number(dense, "ceiling_gflops") == most && most > 0.0);
    assert!(dense["ceiling_left_out"].as_str().is_some_and(|why| why.contains("peer")));
    let rows = dense["rows"].as_array().expect("rows");
    assert!(rows.iter().map(|row| row["network"].as_str()).eq([Some("nerf_mlp"), Some("compact")]));
    for row in rows {
        for part in ["products", "pass"] {
            let [flops, seconds, best] =
                ["flops", "seconds", "best_seconds"].map(|f| number(row, &format!("{part}_{f}")));
            assert!(flops > 0.0 && best > 0.0 && best <= seconds, "{row}");
            let share = flops / seconds / 1e9 / most;
            assert!((number(row, &format!("share_{part}")) / share - 1.0).abs() < 1e-9, "{row}");
            assert!(number(row, &format!("best_share_{part}")) >= share * (1.0 - 1e-9), "{row}");
        }
        assert!((0.0..=1.0).contains(&number(row, "check_used")), "{row}");
    }
    let calibration = &printed["calibration"];
    assert!(number(calibration, "sgemm_best_gflops") >= number(calibration, "sgemm_gflops"));
    assert!(number(calibration, "sgemm_layer_best_gflops") >= number(calibration, "sgemm_layer_gflops"));
    assert!(calibration["quick"] == true && calibration["sgemm_layer_shape"][1] == 256);
    let table = fs::read_to_string(dir.path().join("out/table.txt")).expect("table.txt");
    assert!(table.contains("share products") && table.contains("quick: not 4096^3"));
    let page = fs::read_to_string(dir.path().join("out/index.html")).expect("index.html");
    assert!(page.contains("Dense layers") && page.contains("share pass"));
}

#[test]
fn bad_input_ends_with_two() {
    let dir = tempfile::tempdir().expect("a temporary folder");
    let (out, none) = (path(dir.path(), "out"), path(dir.path(), "no_run"));
    let cases: [(&[&str], &[&str]); 8] = [
        (&["bench"], &["--out"]),
        (&["bench", "nothing", "--out", &out], &["FILTER", "nothing", "volume_render", "dense"]),
        (&["bench", "--out", &out, "--rounds", "2"], &["--rounds", "at least 5"]),
        (&["bench", "--out", &out, "--run", &none], &["run.json", "Train first"]),
        (&["bench", "system", "--out", &out], &["--run"]),
        (&["bench", "nerf_step", "--out", &out], &["--run"]),
        (&["bench", "spherical", "--quick", "--out", &out, "--peer", "exit 3"], &["--peer", "exit 3"]),
        (&["bench", "spherical", "--quick", "--out", &out, "--peer", "echo hello"], &["no JSON object"]),
    ];
    for (args, words) in cases {
        let output = run(args);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{args:?}: {message}");
        assert!(output.stdout.is_empty() && !message.contains("panicked"), "{args:?}: {message}");
        assert!(words.iter().all(|word| message.contains(word)), "{args:?}: {message}");
    }
    assert!(!dir.path().join("out").exists(), "nothing is written before everything is measured");
}
