//! A curve or several as SVG.

use std::fmt::Write;
use std::path::Path;

use super::chart::{Axis, Chart};
use super::page::escape;
use crate::error::Result;
use crate::files;

/// One named line.
pub(crate) struct Series {
    /// Shown in the legend.
    pub name: String,
    /// (x, y), in the order of x; points that aren't finite are left out.
    pub points: Vec<(f64, f64)>,
}

const SIZE: (f64, f64) = (720.0, 440.0);
/// Left, right, top, bottom of the plot.
const PLOT: [f64; 4] = [68.0, 704.0, 44.0, 384.0];
/// Told apart without red against green.
const COLORS: [&str; 6] = ["#2a6fb0", "#d9822b", "#7a4fa3", "#2f9e8f", "#b3446c", "#6b7280"];

/// Writes a line chart: title, names of both axes, one color a series.
///
/// # Errors
/// Where the file can't be written.
pub(crate) fn write(path: &Path, title: &str, x_name: &str, y_name: &str, series: &[Series]) -> Result<()> {
    files::write(path, svg(title, x_name, y_name, series))
}

/// The chart as SVG text.
pub(crate) fn svg(title: &str, x_name: &str, y_name: &str, series: &[Series]) -> String {
    let finite = |p: &&(f64, f64)| p.0.is_finite() && p.1.is_finite();
    let all = || series.iter().flat_map(|s| s.points.iter().filter(finite));
    let (x, y) = (Axis::linear(x_name, all().map(|p| p.0)), Axis::linear(y_name, all().map(|p| p.1)));
    let mut chart = Chart::new(title, SIZE, PLOT, x, y);
    let [left, right, _, bottom] = PLOT;
    let _ = writeln!(
        chart.svg,
        "<text x=\"{}\" y=\"26\" text-anchor=\"middle\" font-size=\"18\">{}</text>",
        (left + right) / 2.0,
        escape(title)
    );
    for (n, s) in series.iter().enumerate() {
        let color = COLORS[n % COLORS.len()];
        let places: Vec<(f64, f64)> =
            s.points.iter().filter(finite).map(|p| (chart.x(p.0), chart.y(p.1))).collect();
        let line: Vec<String> = places.iter().map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
        let line = line.join(" ");
        let _ = writeln!(
            chart.svg,
            "<polyline points=\"{line}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"2\"/>"
        );
        for (x, y) in places {
            let _ = writeln!(chart.svg, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"2\" fill=\"{color}\"/>");
        }
        let at = bottom - 12.0 - 18.0 * (series.len() - 1 - n) as f64;
        let _ = writeln!(
            chart.svg,
            "<line x1=\"{}\" y1=\"{at}\" x2=\"{}\" y2=\"{at}\" stroke=\"{color}\" stroke-width=\"2\"/>\
             <text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>",
            right - 26.0,
            right - 8.0,
            right - 32.0,
            at + 4.0,
            escape(&s.name)
        );
    }
    chart.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chart_names_its_axes_and_skips_what_is_not_finite() {
        let points = vec![(1.0, 10.0), (2.0, f64::INFINITY), (3.0, 20.0)];
        let text = svg("PSNR", "step", "dB", &[Series { name: "val".into(), points }]);
        assert!(
            text.contains("PSNR") && text.contains("step") && text.contains("dB") && text.contains("val")
        );
        assert!(!text.contains("inf") && !text.contains("NaN"));
        assert!(svg("empty", "x", "y", &[]).starts_with("<svg"));
    }
}
