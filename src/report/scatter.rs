//! Points in a log-log picture, a frontier drawn through some of them, figures as hover text.

use std::fmt::Write;

use super::chart::{Axis, Chart};
use super::page::escape;

/// One dot.
#[derive(Clone, Debug)]
pub(crate) struct Point {
    /// x, above 0.
    pub x: f64,
    /// y; 0 is drawn on the lower edge.
    pub y: f64,
    /// Written beside it.
    pub name: String,
    /// Shown where the mouse is.
    pub hover: String,
    /// Whether the frontier goes through it.
    pub on_line: bool,
}

const WIDTH: f64 = 860.0;
const HEIGHT: f64 = 420.0;
/// Left, right, top, bottom of the plot.
const PLOT: [f64; 4] = [76.0, 690.0, 16.0, 366.0];

/// Decades from the one below the smallest value to the one above the largest.
fn decades(values: impl Iterator<Item = f64>) -> (i32, i32) {
    let logs = values.filter(|v| *v > 0.0 && v.is_finite()).map(f64::log10);
    let (low, high) = logs.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    if low > high {
        return (-1, 0);
    }
    let (low, high) = (low.floor() as i32, high.ceil() as i32);
    (low, high.max(low + 1))
}

/// The picture. Points whose x isn't a number above 0, or whose y isn't one of at least 0, are left out.
pub(crate) fn svg(title: &str, x_name: &str, y_name: &str, points: &[Point]) -> String {
    let shown = |p: &&Point| p.x > 0.0 && p.x.is_finite() && p.y >= 0.0 && p.y.is_finite();
    let points: Vec<&Point> = points.iter().filter(shown).collect();
    let (x0, x1) = decades(points.iter().map(|p| p.x));
    let (mut y0, y1) = decades(points.iter().map(|p| p.y));
    if points.iter().any(|p| p.y == 0.0) {
        y0 -= 1;
    }
    // At most a dozen names.
    let step = ((y1 - y0) / 12 + 1) as usize;
    let axes = (Axis::decades(x_name, (x0, x1), 1), Axis::decades(y_name, (y0, y1), step));
    let mut chart = Chart::new(title, (WIDTH, HEIGHT), PLOT, axes.0, axes.1);
    let places: Vec<(f64, f64)> = points.iter().map(|p| (chart.x(p.x), chart.y(p.y))).collect();
    let on_line = points.iter().zip(&places).filter(|(p, _)| p.on_line);
    let mut line: Vec<(f64, f64)> = on_line.map(|(_, place)| *place).collect();
    line.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Steps: between two points of the frontier nothing better is known than the faster one's error.
    let mut path = String::new();
    for (n, (px, py)) in line.iter().enumerate() {
        let _ = if n == 0 { write!(path, "M{px:.1} {py:.1}") } else { write!(path, "H{px:.1}V{py:.1}") };
    }
    let _ = writeln!(
        chart.svg,
        "<path class=\"frontier\" d=\"{path}\" fill=\"none\" stroke=\"#2a6fb0\" stroke-width=\"1.5\"/>"
    );
    for ((p, label), (px, py)) in points.iter().zip(spread(&places)).zip(places) {
        let fill = if p.on_line { "#2a6fb0" } else { "#9aa4ad" };
        let _ = writeln!(
            chart.svg,
            "<g><title>{}</title><line x1=\"{px:.1}\" y1=\"{py:.1}\" x2=\"{:.1}\" y2=\"{label:.1}\" class=\"grid\" stroke=\"#dfe3e7\"/>\
             <circle cx=\"{px:.1}\" cy=\"{py:.1}\" r=\"5\" fill=\"{fill}\"/>\
             <text x=\"{:.1}\" y=\"{:.1}\">{}</text></g>",
            escape(&p.hover),
            px + 8.0,
            px + 10.0,
            label + 4.0,
            escape(&p.name)
        );
    }
    chart.finish()
}

/// Heights of labels beside dots, moved apart where they would overlap: the lower ones move.
fn spread(dots: &[(f64, f64)]) -> Vec<f64> {
    const LINE: f64 = 14.0;
    /// Labels this far apart along x don't overlap.
    const LONG: f64 = 170.0;
    let mut order: Vec<usize> = (0..dots.len()).collect();
    order.sort_by(|&a, &b| dots[a].1.total_cmp(&dots[b].1));
    let mut heights = vec![0.0; dots.len()];
    for (n, &i) in order.iter().enumerate() {
        let mut at: f64 = dots[i].1;
        loop {
            let near =
                |&&j: &&usize| (dots[i].0 - dots[j].0).abs() < LONG && (heights[j] - at).abs() < LINE - 1e-6;
            match order[..n].iter().find(near) {
                Some(&j) => at = heights[j] + LINE,
                None => break,
            }
        }
        heights[i] = at;
    }
    // What would hang below the picture moves up as a whole.
    let low = heights.iter().fold(0.0f64, |m, h| m.max(*h));
    let up = (low - (HEIGHT - 40.0)).max(0.0);
    if up > 0.0 { heights.iter().map(|h| h - up).collect() } else { heights }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(x: f64, y: f64, name: &str, on_line: bool) -> Point {
        Point { x, y, name: name.into(), hover: format!("{name} <hover>"), on_line }
    }

    #[test]
    fn dots_have_names_hover_text_and_a_line() {
        let points = [
            point(1e-3, 1e-7, "fast", true),
            point(1.0, 0.0, "oracle", true),
            point(f64::NAN, 1.0, "lost", false),
        ];
        let text = svg("exp", "seconds", "error", &points);
        assert!(text.contains("<title>fast &lt;hover&gt;</title>") && text.contains(">oracle</text>"));
        assert!(!text.contains("lost") && !text.contains("NaN") && !text.contains("inf"));
        // Two points: one move, one step.
        let path = text.split("class=\"frontier\" d=\"").nth(1).unwrap().split('"').next().unwrap();
        assert_eq!((path.matches('M').count(), path.matches('H').count()), (1, 1), "{path}");
        // The fast one is left of the oracle; the exact one stands on the lower edge.
        assert!(text.contains(&format!("cx=\"{:.1}\" cy=\"{:.1}\"", PLOT[1], PLOT[3])));
    }

    #[test]
    fn labels_don_t_overlap() {
        let heights = spread(&[(0.0, 50.0), (10.0, 51.0), (20.0, 49.0), (400.0, 50.0)]);
        for i in 0..3 {
            for j in 0..i {
                assert!((heights[i] - heights[j]).abs() >= 13.9, "{heights:?}");
            }
        }
        assert_eq!(heights[3], 50.0);
        assert!(svg("empty", "x", "y", &[]).ends_with("</svg>\n"));
    }
}
