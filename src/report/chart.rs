//! The frame that every chart stands in: an SVG with two named axes and a grid. SVG by hand, so that a figure can hang on every dot.

use std::fmt::Write;

use super::page::escape;

/// Ink and paper as the reader's system says, whether the file stands alone or in a page; without styles, black on nothing.
const STYLE: &str = "svg.chart{color:#1f2328;background:#fff}svg.chart .grid{stroke:#dfe3e7}\
    @media(prefers-color-scheme:dark){svg.chart{color:#e6e9ec;background:#14181c}svg.chart .grid{stroke:#3a444e}}";

/// One axis.
pub(super) struct Axis {
    name: String,
    /// Values at its ends; their decades where `log`.
    low: f64,
    high: f64,
    log: bool,
    /// Grid lines: value and label, as SVG.
    ticks: Vec<(f64, String)>,
}

impl Axis {
    /// Over the decades from 10^`low` to 10^`high`, a name at every `step`-th.
    pub(super) fn decades(name: &str, (low, high): (i32, i32), step: usize) -> Axis {
        let power = |n: i32| format!("10<tspan dy=\"-5\" font-size=\"9\">{n}</tspan>");
        let ticks = (low..=high).step_by(step).map(|n| (10f64.powi(n), power(n))).collect();
        Axis { name: name.into(), low: low.into(), high: high.into(), log: true, ticks }
    }

    /// Over the finite values with a margin, never empty; grid lines at 1, 2 or 5 times a power of ten, at most eight.
    pub(super) fn linear(name: &str, values: impl Iterator<Item = f64>) -> Axis {
        let (low, high) = values
            .filter(|v| v.is_finite())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        let (low, high) = if low > high { (0.0, 1.0) } else { (low, high) };
        let margin = if high > low { 0.05 * (high - low) } else { 0.5 };
        let (low, high) = (low - margin, high + margin);
        let power = 10f64.powf(((high - low) / 8.0).log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|m| m * power).into_iter().find(|s| (high - low) / s <= 8.0);
        let step = step.unwrap_or(high - low);
        let digits = (-step.log10().floor()).max(0.0) as usize;
        let ticks = ((low / step).ceil() as i64..=(high / step).floor() as i64)
            .map(|n| (n as f64 * step, format!("{:.digits$}", n as f64 * step)))
            .collect();
        Axis { name: name.into(), low, high, log: false, ticks }
    }

    /// Where a value stands, from 0 to 1.
    fn share(&self, v: f64) -> f64 {
        let v = if self.log { v.log10() } else { v };
        ((v - self.low) / (self.high - self.low)).clamp(0.0, 1.0)
    }
}

/// A chart under construction.
pub(super) struct Chart {
    /// What has been drawn.
    pub svg: String,
    x: Axis,
    y: Axis,
    /// Left, right, top, bottom of the plot.
    plot: [f64; 4],
}

impl Chart {
    /// The frame, (width, height) in size: title (shown where the mouse is), grid, names of ticks and axes.
    pub(super) fn new(title: &str, (width, height): (f64, f64), plot: [f64; 4], x: Axis, y: Axis) -> Chart {
        let [left, right, top, bottom] = plot;
        let svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" role=\"img\" \
             class=\"chart\" fill=\"currentColor\" font-family=\"system-ui,sans-serif\" font-size=\"12\">\n\
             <title>{}: {} against {}</title>\n<style>{STYLE}</style>\n",
            escape(title),
            escape(&y.name),
            escape(&x.name)
        );
        let mut chart = Chart { svg, x, y, plot };
        for (value, name) in &chart.x.ticks {
            let at = chart.x(*value);
            let _ = writeln!(
                chart.svg,
                "<line x1=\"{at:.1}\" y1=\"{top}\" x2=\"{at:.1}\" y2=\"{bottom}\" class=\"grid\" stroke=\"#dfe3e7\"/>\
                 <text x=\"{at:.1}\" y=\"{}\" text-anchor=\"middle\">{name}</text>",
                bottom + 18.0,
            );
        }
        for (value, name) in &chart.y.ticks {
            let at = chart.y(*value);
            let _ = writeln!(
                chart.svg,
                "<line x1=\"{left}\" y1=\"{at:.1}\" x2=\"{right}\" y2=\"{at:.1}\" class=\"grid\" stroke=\"#dfe3e7\"/>\
                 <text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{name}</text>",
                left - 8.0,
                at + 4.0,
            );
        }
        let _ = writeln!(
            chart.svg,
            "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n\
             <text transform=\"translate(16 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
            (left + right) / 2.0,
            height - 12.0,
            escape(&chart.x.name),
            (top + bottom) / 2.0,
            escape(&chart.y.name)
        );
        chart
    }

    /// Where a value stands along x.
    pub(super) fn x(&self, v: f64) -> f64 {
        let [left, right, ..] = self.plot;
        left + self.x.share(v) * (right - left)
    }

    /// Where a value stands along y.
    pub(super) fn y(&self, v: f64) -> f64 {
        let [_, _, top, bottom] = self.plot;
        bottom + self.y.share(v) * (top - bottom)
    }

    /// The SVG text.
    pub(super) fn finish(self) -> String {
        self.svg + "</svg>\n"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_numbers_inside_of_the_axis() {
        for (low, high) in [(0.0, 1.0), (21.7, 34.2), (0.0, 30_000.0), (-3e-3, 2e-3), (5.0, 5.0)] {
            let axis = Axis::linear("x", [low, high, f64::NAN, f64::INFINITY].into_iter());
            assert!((2..=9).contains(&axis.ticks.len()), "{low} to {high}: {:?}", axis.ticks);
            for (value, name) in &axis.ticks {
                assert!(axis.low <= *value && *value <= axis.high);
                assert!((name.parse::<f64>().unwrap() - value).abs() <= 1e-9 * value.abs(), "{name}");
            }
        }
    }
}
