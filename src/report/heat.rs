//! Where in an array errors sit: a cell an element, colored by how much of what is allowed its error takes.

use std::fmt::Write;

use super::page::escape;

/// Cells along either side; larger arrays are shown by the worst element of each block.
const MOST: usize = 64;
/// Width of the picture, and the largest side of a cell.
const WIDTH: f64 = 640.0;
const LARGEST: f64 = 26.0;
/// Left of the rows, above the columns, below them.
const FRAME: [f64; 3] = [56.0, 24.0, 40.0];

/// Colors of errors within what is allowed, up to 10 times, up to 1,000 times as large, and beyond: told apart by lightness too.
const STEPS: [(f64, &str, &str); 4] = [
    (1.0, "#4f9d69", "within what is allowed"),
    (10.0, "#f0b429", "up to 10 times"),
    (1e3, "#e0662f", "up to 1,000 times"),
    (f64::INFINITY, "#8c1d40", "more"),
];

fn color(used: f64) -> &'static str {
    // NaN is as wrong as can be.
    STEPS.iter().find(|(most, ..)| used <= *most).map_or(STEPS[3].1, |(_, color, _)| color)
}

/// Errors over what is allowed, of an array of this shape: its last axis from left to right, all others from top to bottom.
pub(crate) fn svg(title: &str, shape: &[usize], used: &[f64]) -> String {
    let columns = shape.last().copied().unwrap_or(1).max(1);
    let rows = used.len().div_ceil(columns).max(1);
    let (block_rows, block_columns) = (rows.div_ceil(MOST), columns.div_ceil(MOST));
    let (high, wide) = (rows.div_ceil(block_rows), columns.div_ceil(block_columns));
    let [left, top, below] = FRAME;
    let cell = ((WIDTH - left) / wide as f64).min(LARGEST);
    let (width, height) = (WIDTH, top + cell * high as f64 + below);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height:.1}\" width=\"{width}\" role=\"img\" fill=\"currentColor\" \
         font-family=\"system-ui,sans-serif\" font-size=\"12\">\n<title>{}</title>\n",
        escape(title)
    );
    for (row, column) in (0..high).flat_map(|row| (0..wide).map(move |column| (row, column))) {
        let inside = |n: usize, block: usize, end: usize| n * block..((n + 1) * block).min(end);
        let worst = inside(row, block_rows, rows)
            .flat_map(|i| inside(column, block_columns, columns).map(move |j| i * columns + j))
            .filter_map(|n| used.get(n))
            .fold(None, |worst: Option<f64>, &x| match worst {
                Some(worst) if worst >= x || worst.is_nan() => Some(worst),
                _ => Some(x),
            });
        let Some(worst) = worst else { continue };
        let (x, y) = (left + cell * column as f64, top + cell * row as f64);
        let _ = writeln!(
            svg,
            "<rect x=\"{x:.2}\" y=\"{y:.2}\" width=\"{cell:.2}\" height=\"{cell:.2}\" fill=\"{}\" stroke=\"#fff\" stroke-width=\"0.5\"/>",
            color(worst)
        );
    }
    let text = |x: f64, y: f64, anchor: &str, text: String| {
        format!("<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{}</text>\n", escape(&text))
    };
    svg += &text(left, top - 8.0, "start", "0".into());
    if columns > 1 {
        svg += &text(left + cell * wide as f64, top - 8.0, "end", format!("{}", columns - 1));
    }
    svg += &text(left - 8.0, top + cell.min(14.0), "end", "0".into());
    if rows > 1 {
        svg += &text(left - 8.0, top + cell * high as f64, "end", format!("{}", rows - 1));
    }
    for (n, (_, color, name)) in STEPS.iter().enumerate() {
        let x = left + 165.0 * n as f64;
        let _ = writeln!(
            svg,
            "<rect x=\"{x}\" y=\"{:.1}\" width=\"12\" height=\"12\" fill=\"{color}\"/>",
            height - 22.0
        );
        svg += &text(x + 17.0, height - 12.0, "start", (*name).into());
    }
    svg + "</svg>\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worst_of_a_block_is_shown() {
        let one = svg("a", &[2, 3], &[0.0, 0.5, 2.0, f64::NAN, 20.0, f64::INFINITY]);
        let count = |svg: &str, step: usize| svg.matches(STEPS[step].1).count() - 1;
        assert_eq!([0, 1, 2, 3].map(|step| count(&one, step)), [2, 1, 1, 2]);
        let mut many = vec![0.0; 1000 * 10];
        many[777 * 10 + 3] = 5.0;
        let many = svg("b", &[1000, 10], &many);
        assert_eq!((count(&many, 1), count(&many, 0)), (1, 63 * 10 - 1));
    }
}
