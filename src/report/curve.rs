//! A curve or several as SVG.

use std::path::Path;

use plotters::prelude::*;

use crate::error::Result;
use crate::files;

/// One named line.
pub struct Series {
    /// Shown in the legend.
    pub name: String,
    /// (x, y), in the order of x; points that aren't finite are left out.
    pub points: Vec<(f64, f64)>,
}

/// Writes a line chart: title, names of both axes, one color a series.
///
/// # Errors
/// Where the file can't be written.
pub fn write(path: &Path, title: &str, x_name: &str, y_name: &str, series: &[Series]) -> Result<()> {
    files::write(path, svg(title, x_name, y_name, series))
}

/// The chart as SVG text.
pub fn svg(title: &str, x_name: &str, y_name: &str, series: &[Series]) -> String {
    let mut text = String::new();
    {
        let root = SVGBackend::with_string(&mut text, (720, 440)).into_drawing_area();
        draw(&root, title, x_name, y_name, series).expect("drawing into memory can't fail");
        root.present().expect("drawing into memory can't fail");
    }
    text
}

type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;
type DrawError<'a> = DrawingAreaErrorKind<<SVGBackend<'a> as DrawingBackend>::ErrorType>;

fn draw<'a>(
    root: &Area<'a>,
    title: &str,
    x_name: &str,
    y_name: &str,
    series: &[Series],
) -> Result<(), DrawError<'a>> {
    root.fill(&WHITE)?;
    let finite = |p: &&(f64, f64)| p.0.is_finite() && p.1.is_finite();
    let all = || series.iter().flat_map(|s| s.points.iter().filter(finite));
    let (x0, x1) = range(all().map(|p| p.0));
    let (y0, y1) = range(all().map(|p| p.1));
    let mut chart = ChartBuilder::on(root)
        .caption(title, ("sans-serif", 20))
        .margin(12)
        .x_label_area_size(44)
        .y_label_area_size(56)
        .build_cartesian_2d(x0..x1, y0..y1)?;
    chart
        .configure_mesh()
        .x_desc(x_name)
        .y_desc(y_name)
        .light_line_style(WHITE)
        .bold_line_style(RGBColor(225, 225, 225))
        .draw()?;
    for (n, s) in series.iter().enumerate() {
        let color = Palette99::pick(n).to_rgba();
        let points: Vec<(f64, f64)> = s.points.iter().filter(finite).copied().collect();
        chart.draw_series(points.iter().map(|&p| Circle::new(p, 2, color.filled())))?;
        chart
            .draw_series(LineSeries::new(points, color.stroke_width(2)))?
            .label(&s.name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], color.stroke_width(2)));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::LowerRight)
        .background_style(WHITE.mix(0.85))
        .border_style(RGBColor(200, 200, 200))
        .draw()
}

/// The range of the values with a margin, never empty.
fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    if low > high {
        return (0.0, 1.0);
    }
    let margin = if high > low { 0.05 * (high - low) } else { 0.5 };
    (low - margin, high + margin)
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
