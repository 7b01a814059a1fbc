//! Another program, in the same rounds.
//!
//! The command runs once per round and prints one JSON object on stdout (other lines before it are ignored). Read from it are
//! `program`, its name; every number with `second` in its name; and, if present, `rows`, a list of objects with
//! `component`, `variant` and `seconds` or `items_per_second`, and anything else that our rows have. A program that knows its library's
//! speed in a large f32 product on as many threads as ours prints `sgemm_gflops`, the best that it measured (and `threads`, `sgemm_size`,
//! `sgemm_library`): it takes part in the ceiling of the dense layers. `tools/bench_torch.py` is such a program; with `--only sgemm` it
//! measures nothing else.

use std::collections::BTreeMap;

use serde_json::{Map, Value, json};

use super::dense::CeilingCandidate;
use super::report::Row;
use super::rounds::quantile;
use crate::error::{Error, Input, Result};
use crate::limits::{PEER_OUTPUT, PEER_TIME};
use crate::process::{self, shell};

/// Figures of `tools/bench_torch.py`: the field, the suite it belongs to, and how many of that suite's items its seconds are for.
const FIGURES: [(&str, &str, f64); 3] = [
    ("step_whole_batch_seconds", "training_step", 1024.0 * 64.0),
    ("step_accumulated_seconds", "training_step", 1024.0 * 64.0),
    ("forward_points_per_second", "nerf_mlp", 1.0),
];

/// A program that takes part.
pub struct Peer {
    command: String,
    objects: Vec<Map<String, Value>>,
}

impl Peer {
    /// A peer that hasn't run yet.
    pub fn new(command: &str) -> Peer {
        Peer { command: command.into(), objects: vec![] }
    }

    fn error(&self, found: impl ToString) -> Error {
        let remedy = "Run the command by itself; tools/bench_torch.py --rounds 1 is an example.";
        let expected = "one JSON object a run, and exit code 0";
        Error::input(Input { file: "`peer`", field: &self.command, found, expected, remedy })
    }

    /// Runs the program once.
    ///
    /// # Errors
    /// Where it can't be started, fails, takes too long, or prints too much or no object.
    pub fn round(&mut self) -> Result<()> {
        let output = process::run(shell(&self.command), PEER_TIME, PEER_OUTPUT)
            .map_err(|ended| self.error(ended.in_words(PEER_TIME, PEER_OUTPUT)))?;
        if !output.status.success() {
            let words = String::from_utf8_lossy(&output.stderr);
            let last = words.lines().last().unwrap_or("").to_string();
            return Err(self.error(format!("{}; {last}", output.status)));
        }
        let text = String::from_utf8_lossy(&output.stdout);
        let last = text.lines().rev().find(|line| line.trim_start().starts_with('{')).unwrap_or("");
        match serde_json::from_str(last) {
            Ok(Value::Object(object)) => {
                self.objects.push(object);
                Ok(())
            }
            _ => Err(self.error("no JSON object on stdout")),
        }
    }

    fn program(&self) -> &str {
        self.objects.first().and_then(|o| o.get("program")).and_then(Value::as_str).unwrap_or("peer")
    }

    /// The best of its large products, for the ceiling of dense layers; or why it isn't among the candidates.
    pub fn candidate(&self) -> Result<CeilingCandidate, String> {
        let number = |name: &'static str| self.objects.iter().filter_map(move |o| o.get(name)?.as_f64());
        let best = number("sgemm_gflops").filter(|&x| x > 0.0 && x.is_finite()).fold(0.0, f64::max);
        if best == 0.0 {
            return Err(format!("{}, which reports no sgemm_gflops", self.program()));
        }
        let ours = crate::parallel::threads();
        if let Some(threads) = number("threads").find(|&threads| threads != ours as f64) {
            return Err(format!("{}, which ran on {threads} threads", self.program()));
        }
        let library = self.objects.iter().find_map(|o| o.get("sgemm_library")?.as_str());
        let size = number("sgemm_size").next().map_or_else(String::new, |n| format!(" {n}^3"));
        let name = format!("{}: {}{size}", self.program(), library.unwrap_or("sgemm"));
        Ok(CeilingCandidate { name, gflops: best })
    }

    /// The median and spread over rounds of every number that `figures` finds in the objects, by name.
    fn figures(&self) -> BTreeMap<String, Vec<f64>> {
        let mut figures: BTreeMap<String, Vec<f64>> = BTreeMap::new();
        for (name, value) in self.objects.iter().flatten() {
            if let Some(x) = value.as_f64().filter(|_| name.contains("second")) {
                figures.entry(name.clone()).or_default().push(x);
            }
        }
        figures
    }

    /// Rows beside ours.
    pub fn rows(&self, calibration: &Value) -> Vec<Row> {
        let mut rows: Vec<Row> = vec![];
        let figures = self.figures();
        for (field, component, items) in FIGURES {
            let Some(values) = figures.get(field) else { continue };
            let (middle, spread) = summary(values);
            let rate = if field.ends_with("_seconds") { items / middle } else { middle };
            let variant = format!("{}: {}", self.program(), field.trim_end_matches("_seconds"));
            rows.push(self.row(component, &variant, rate, spread, &Map::new(), calibration));
        }
        // The peer's own rows: those of one name, over all rounds.
        let mut own: BTreeMap<(String, String), (Vec<f64>, Map<String, Value>)> = BTreeMap::new();
        for row in self.objects.iter().filter_map(|o| o.get("rows")?.as_array()).flatten() {
            let text = |field: &str| row[field].as_str().map(String::from);
            let rate = row["items_per_second"]
                .as_f64()
                .or_else(|| row["seconds"].as_f64().map(|s| row["items"].as_f64().unwrap_or(1.0) / s));
            if let (Some(component), Some(variant), Some(rate), Some(object)) =
                (text("component"), text("variant"), rate, row.as_object())
            {
                let entry = own.entry((component, variant)).or_insert_with(|| (vec![], object.clone()));
                entry.0.push(rate);
            }
        }
        for ((component, variant), (rates, object)) in &own {
            let (rate, spread) = summary(rates);
            let variant = format!("{}: {variant}", self.program());
            rows.push(self.row(component, &variant, rate, spread, object, calibration));
        }
        rows
    }

    fn row(
        &self,
        component: &str,
        variant: &str,
        rate: f64,
        spread: f64,
        given: &Map<String, Value>,
        calibration: &Value,
    ) -> Row {
        let of = |field: &str| given.get(field).cloned().unwrap_or(Value::Null);
        let object = json!({
            "component": component, "variant": variant,
            "dtype": given.get("dtype").and_then(Value::as_str).unwrap_or("f32"),
            "seconds": null, "spread": spread, "items_per_second": rate, "speedup": null,
            "max_relative_error": of("max_relative_error"), "p99_relative_error": of("p99_relative_error"),
            "bias": of("bias"), "max_ulp": of("max_ulp"), "budget_used": of("budget_used"), "on_frontier": false,
            "rounds": self.objects.len(), "peer": self.program(), "calibration": calibration,
        });
        let Value::Object(row) = object else { unreachable!("an object literal") };
        Row(row)
    }

    /// What the program printed, all rounds, with medians.
    pub fn json(&self) -> Value {
        let median = |(name, values): (String, Vec<f64>)| {
            let (middle, spread) = summary(&values);
            (name, json!({ "median": middle, "spread": spread }))
        };
        let figures: Map<String, Value> = self.figures().into_iter().map(median).collect();
        json!({ "command": self.command, "program": self.program(), "figures": figures, "objects": self.objects })
    }
}

/// Median, and the distance of the quartiles over it.
fn summary(values: &[f64]) -> (f64, f64) {
    let middle = quantile(values, 0.5);
    (middle, (quantile(values, 0.75) - quantile(values, 0.25)) / middle)
}
