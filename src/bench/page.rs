//! The page: for each component a picture of speed against error, and the tables.

use serde_json::Value;

use super::dense;
use super::report::{BenchReport, HEADER, Row, SCALING, SYSTEM, cells, machine, scaling_cells, system_cells};
use crate::report::page::Page;
use crate::report::scatter::{self, Point};

/// `index.html`, whole.
pub fn page(report: &BenchReport) -> String {
    let lead = machine(&report.calibration);
    let mut page = Page::new("Speed against error", &lead);
    page.heading("What is what").paragraph(
        "Each variant was checked against the f64 oracle before it was timed. To the left is fast, below is accurate; the line is the \
         frontier: nothing below and to the left of it. The oracle's own error is 0 and stands on the lower edge. Point at a dot to \
         read its figures.",
    );
    let mut names: Vec<&str> = vec![];
    for row in &report.rows {
        if !names.contains(&row.text("component")) {
            names.push(row.text("component"));
        }
    }
    for name in names {
        let rows: Vec<&Row> = report.rows.iter().filter(|row| row.text("component") == name).collect();
        page.heading(name);
        page.figure(&picture(name, &rows));
        // The component's name stands above.
        page.table(&HEADER[1..], &rows.iter().map(|row| cells(row)[1..].to_vec()).collect::<Vec<_>>());
    }
    if !report.scaling.is_empty() {
        page.heading("Scaling");
        page.table(&SCALING, &report.scaling.iter().map(scaling_cells).collect::<Vec<_>>());
    }
    if !report.dense.is_null() {
        page.heading("Dense layers").paragraph(&dense::ceiling_text(&report.dense)).paragraph(dense::NOTE);
        page.table(&dense::HEADER, &report.dense_rows().iter().map(dense::cells).collect::<Vec<_>>());
    }
    if !report.system.is_empty() {
        page.heading("Whole pictures");
        page.figure(&system_picture(&report.system));
        page.table(&SYSTEM, &report.system.iter().map(system_cells).collect::<Vec<_>>());
    }
    page.finish()
}

fn system_picture(rows: &[Value]) -> String {
    let point = |row: &Value| {
        let figure = |field: &str| row[field].as_f64().unwrap_or(f64::NAN);
        let (x, y) = (figure("seconds"), figure("max_error"));
        let (name, about) = (row["variant"].as_str().unwrap_or(""), row["about"].as_str().unwrap_or(""));
        let hover = format!(
            "{name}: {x:.3e} s a view, {:.1} dB, largest error {y:.2e}, mean {:.2e}, {:.1} samples a ray. {about}",
            figure("psnr"),
            figure("mean_error"),
            figure("samples_a_ray")
        );
        Point { x, y, name: name.into(), hover, on_line: row["on_frontier"] == true }
    };
    let points: Vec<Point> = rows.iter().map(point).collect();
    scatter::svg("whole pictures", "seconds a view", "largest error of a color", &points)
}

fn picture(name: &str, rows: &[&Row]) -> String {
    let point = |row: &&Row| {
        let (x, y) = (row.number("seconds")?, row.number("max_relative_error")?);
        let about = row.text("about");
        let figures = format!(
            "{} ({}): {x:.3e} s, {:.3e} items/s, {:.2} times the oracle; largest error {y:.2e}, 99% below {:.2e}, bias {:.1e}. {about}",
            row.text("variant"),
            row.text("dtype"),
            row.number("items_per_second").unwrap_or(f64::NAN),
            row.number("speedup").unwrap_or(f64::NAN),
            row.number("p99_relative_error").unwrap_or(f64::NAN),
            row.number("bias").unwrap_or(f64::NAN),
        );
        let on_line = row.0["on_frontier"] == true;
        Some(Point { x, y, name: row.text("variant").into(), hover: figures, on_line })
    };
    let points: Vec<Point> = rows.iter().filter_map(point).collect();
    scatter::svg(name, "seconds", "largest relative error", &points)
}
