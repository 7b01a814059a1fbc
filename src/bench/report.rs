//! Rows of a report, as a table for people and as JSON.

use serde_json::{Map, Value, json};

use super::error::Errors;
use super::frontier::on_frontier;
use super::rounds::Timer;
use super::{Suite, Variant, dense};
use crate::report::table;

/// One variant's figures, as `bench --json` prints them.
#[derive(Clone, Debug)]
pub struct Row(pub Map<String, Value>);

/// The results of a call of `bench`.
#[derive(Clone, Debug)]
pub struct BenchReport {
    /// Variants and peers.
    pub rows: Vec<Row>,
    /// Time against size.
    pub scaling: Vec<Value>,
    /// Whole pictures of a trained run.
    pub system: Vec<Value>,
    /// Dense layers and their ceiling, see [`super::dense`]; null if they weren't requested.
    pub dense: Value,
    /// The machine's calibration in the same minutes.
    pub calibration: Value,
    /// The peer's own objects.
    pub peer: Option<Value>,
    /// How many rounds.
    pub rounds: usize,
}

impl Row {
    /// A row's figures: the number of items, and the factor from the seconds of one run to those of that many items.
    pub fn new(
        suite: &Suite,
        variant: &Variant,
        errors: &Errors,
        (items, scale): (usize, f64),
        timer: &Timer,
        calibration: &Value,
    ) -> Row {
        let seconds = scale * timer.median();
        let object = json!({
            "component": suite.component, "variant": variant.name, "dtype": variant.dtype.to_string(),
            "seconds": seconds, "spread": timer.spread(), "items_per_second": items as f64 / seconds,
            "speedup": null, "max_relative_error": errors.max, "p99_relative_error": errors.p99,
            "bias": errors.bias, "max_ulp": errors.max_ulp, "budget_used": errors.budget, "on_frontier": false,
            "item": suite.item, "items": items, "timed_items": (items as f64 / scale).round(), "rounds": timer.seconds.len(), "about": variant.about,
            "max_absolute_error": errors.absolute, "tolerance_used": errors.tolerance,
            "checked_items": suite.checked, "calibration": calibration,
        });
        let Value::Object(row) = object else { unreachable!("an object literal") };
        Row(row)
    }

    /// A variant that exceeds its tolerance: not timed.
    pub fn refused(suite: &Suite, variant: &Variant, why: String) -> Row {
        let object = json!({
            "component": suite.component, "variant": variant.name, "dtype": variant.dtype.to_string(),
            "seconds": null, "spread": null, "items_per_second": null, "speedup": null, "max_relative_error": null,
            "p99_relative_error": null, "bias": null, "max_ulp": null, "budget_used": null, "on_frontier": false,
            "item": suite.item, "about": variant.about, "refused": why,
        });
        let Value::Object(row) = object else { unreachable!("an object literal") };
        Row(row)
    }

    /// A number of the row.
    pub fn number(&self, field: &str) -> Option<f64> {
        self.0.get(field).and_then(Value::as_f64)
    }

    /// A text of the row.
    pub fn text(&self, field: &str) -> &str {
        self.0.get(field).and_then(Value::as_str).unwrap_or("")
    }
}

/// Fills in what compares rows of a component: `speedup` over its oracle, and `on_frontier`.
pub fn compare(rows: &mut [Row]) {
    let names: std::collections::BTreeSet<String> =
        rows.iter().map(|row| row.text("component").to_string()).collect();
    for name in names {
        let here: Vec<usize> = (0..rows.len()).filter(|&n| rows[n].text("component") == name).collect();
        let oracle = here.iter().find(|&&n| rows[n].text("variant") == "oracle");
        let baseline = oracle.and_then(|&n| rows[n].number("items_per_second"));
        let items = oracle.and_then(|&n| rows[n].number("items"));
        for &n in &here {
            // A peer's seconds, for as many items as ours.
            if let (true, Some(items), Some(rate)) =
                (rows[n].0.contains_key("peer"), items, rows[n].number("items_per_second"))
            {
                rows[n].0.insert("seconds".into(), json!(items / rate));
            }
        }
        let point = |&n: &usize| {
            let figure = |field| rows[n].number(field).unwrap_or(f64::NAN);
            (figure("seconds"), figure("max_relative_error"))
        };
        let frontier = on_frontier(&here.iter().map(point).collect::<Vec<_>>());
        for (&n, on) in here.iter().zip(frontier) {
            let speedup = rows[n].number("items_per_second").zip(baseline).map(|(rate, base)| rate / base);
            rows[n].0.insert("speedup".into(), json!(speedup));
            rows[n].0.insert("on_frontier".into(), json!(on));
        }
    }
}

impl BenchReport {
    /// Variants and dense layers that were refused.
    pub fn refused(&self) -> usize {
        let layers = self.dense_rows().iter().filter(|row| row["refused"].is_string()).count();
        self.rows.iter().filter(|row| row.0.contains_key("refused")).count() + layers
    }

    /// The rows of the dense layers.
    pub fn dense_rows(&self) -> &[Value] {
        self.dense["rows"].as_array().map_or(&[], |rows| rows)
    }

    /// Adds the calibration to the figures of whole pictures too.
    pub fn stamp(&mut self) {
        let rows = self.system.iter_mut().chain(&mut self.scaling);
        rows.for_each(|row| row["calibration"] = self.calibration.clone());
    }

    /// For machines.
    pub fn json(&self) -> Value {
        json!({
            "version": env!("CARGO_PKG_VERSION"), "calibration": self.calibration, "rounds": self.rounds,
            "rows": self.rows.iter().map(|row| &row.0).collect::<Vec<_>>(), "scaling": self.scaling,
            "system": self.system, "dense": self.dense, "peer": self.peer,
        })
    }

    /// For people.
    pub fn text(&self) -> String {
        let mut text = machine(&self.calibration) + "\n\n";
        if !self.rows.is_empty() {
            text += &table::text(&HEADER, &self.rows.iter().map(cells).collect::<Vec<_>>());
        }
        for row in self.rows.iter().filter(|row| row.0.contains_key("refused")) {
            let (component, variant) = (row.text("component"), row.text("variant"));
            text += &format!("refused: {component} {variant}: {}\n", row.text("refused"));
        }
        if !self.scaling.is_empty() {
            text += "\n";
            text += &table::text(&SCALING, &self.scaling.iter().map(scaling_cells).collect::<Vec<_>>());
        }
        if !self.system.is_empty() {
            text += "\n";
            text += &table::text(&SYSTEM, &self.system.iter().map(system_cells).collect::<Vec<_>>());
        }
        if !self.dense.is_null() {
            text += &format!("\n{}\n\n", dense::ceiling_text(&self.dense));
            text +=
                &table::text(&dense::HEADER, &self.dense_rows().iter().map(dense::cells).collect::<Vec<_>>());
            for row in self.dense_rows().iter().filter(|row| row["refused"].is_string()) {
                let text_of = |field: &str| row[field].as_str().unwrap_or("");
                text += &format!("refused: {}: {}\n", text_of("network"), text_of("refused"));
            }
            text += &format!("{}\n", dense::NOTE);
        }
        if self.rows.is_empty() && self.scaling.is_empty() && self.system.is_empty() {
            return text;
        }
        text + "\n* on the frontier: nothing is both as fast and as accurate. Errors are relative; an element below a 1024th of\n  its output's largest counts as that large. budget: largest error over the component's bound in the row's type.\n"
    }
}

/// Columns of the variants' table.
pub const HEADER: [&str; 13] = [
    "component",
    "variant",
    "dtype",
    "seconds",
    "spread",
    "items/s",
    "speedup",
    "max error",
    "p99",
    "bias",
    "ULP",
    "budget",
    "",
];

/// Columns of the scaling table.
pub const SCALING: [&str; 6] = ["component", "against", "values", "seconds", "exponent", "memory exponent"];

/// Columns of the whole-system table.
pub const SYSTEM: [&str; 6] =
    ["variant", "seconds a view", "samples a ray", "PSNR dB", "max error", "mean error"];

/// The machine in a line.
pub fn machine(calibration: &Value) -> String {
    let (n, gflops) = (&calibration["sgemm_size"], calibration["sgemm_gflops"].as_f64().unwrap_or(f64::NAN));
    let reads = calibration["random_reads_per_second"].as_f64().unwrap_or(f64::NAN) / 1e6;
    format!(
        "{}, {} cores: sgemm {n}^3 at {gflops:.0} GFLOP/s, {reads:.0} million random 8-byte reads/s from 16 MB",
        calibration["cpu"].as_str().unwrap_or(""),
        calibration["cores"]
    )
}

fn figure(x: Option<f64>) -> String {
    match x {
        None => "-".into(),
        Some(0.0) => "0".into(),
        Some(x) if (0.01..1e4).contains(&x.abs()) => format!("{x:.3}"),
        Some(x) => format!("{x:.1e}"),
    }
}

/// A row as text.
pub fn cells(row: &Row) -> Vec<String> {
    let mut cells: Vec<String> =
        ["component", "variant", "dtype"].iter().map(|field| row.text(field).to_string()).collect();
    let fields = [
        "seconds",
        "spread",
        "items_per_second",
        "speedup",
        "max_relative_error",
        "p99_relative_error",
        "bias",
        "max_ulp",
        "budget_used",
    ];
    cells.extend(fields.iter().map(|field| figure(row.number(field))));
    cells.push(if row.0["on_frontier"] == true { "*".into() } else { String::new() });
    cells
}

fn list(values: &Value) -> String {
    let values = values.as_array().into_iter().flatten();
    values.map(|v| figure(v.as_f64())).collect::<Vec<_>>().join(" ")
}

/// A scaling row as text.
pub fn scaling_cells(row: &Value) -> Vec<String> {
    let text = |field: &str| row[field].as_str().unwrap_or("").to_string();
    vec![
        text("component"),
        text("parameter"),
        list(&row["values"]),
        list(&row["seconds"]),
        figure(row["exponent"].as_f64()),
        figure(row["memory_exponent"].as_f64()),
    ]
}

/// A whole-system row as text.
pub fn system_cells(row: &Value) -> Vec<String> {
    let number = |field: &str| figure(row[field].as_f64());
    let fields = ["seconds", "samples_a_ray", "psnr", "max_error", "mean_error"];
    let variant = row["variant"].as_str().unwrap_or("").to_string();
    std::iter::once(variant).chain(fields.iter().map(|f| number(f))).collect()
}
