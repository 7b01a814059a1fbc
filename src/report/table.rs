//! Tables for people: columns as wide as their widest entry, right-aligned.

use crate::shown::shown;

/// A table as text, a line a row, the header underlined.
pub(crate) fn text(header: &[&str], rows: &[Vec<String>]) -> String {
    let rows: Vec<Vec<String>> =
        rows.iter().map(|row| row.iter().map(|cell| shown(cell).into_owned()).collect()).collect();
    let width = |c: usize| {
        let cells = rows.iter().map(|row| row[c].chars().count());
        cells.chain([header[c].chars().count()]).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..header.len()).map(width).collect();
    let line = |cells: &[String]| {
        let padded = cells.iter().zip(&widths).map(|(cell, &w)| {
            let number = cell.starts_with(|c: char| c.is_ascii_digit() || c == '-' || c == '+');
            if number { format!("{cell:>w$}") } else { format!("{cell:<w$}") }
        });
        padded.collect::<Vec<_>>().join("  ").trim_end().to_string() + "\n"
    };
    let header: Vec<String> = header.iter().map(|h| h.to_string()).collect();
    let rule: String = widths.iter().map(|&w| "-".repeat(w)).collect::<Vec<_>>().join("  ") + "\n";
    line(&header) + &rule + &rows.iter().map(|row| line(row)).collect::<String>()
}

#[cfg(test)]
mod tests {
    #[test]
    fn numbers_stand_on_the_right() {
        let text = super::text(&["step", "PSNR"], &[vec!["1".into(), "12.5".into()]]);
        assert_eq!(text, "step  PSNR\n----  ----\n   1  12.5\n");
    }
}
