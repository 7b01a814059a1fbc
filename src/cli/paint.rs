//! Colors for a terminal: of verdicts on stdout, of errors and warnings on stderr. Text that goes elsewhere, or where NO_COLOR is set,
//! has none.

use std::borrow::Cow;

use anstyle::{AnsiColor, Style};

const GOOD: Style = AnsiColor::Green.on_default();
const BAD: Style = AnsiColor::Red.on_default().bold();
const DOUBTFUL: Style = AnsiColor::Yellow.on_default().bold();
const NONE: Style = Style::new().dimmed();

/// Verdicts as pages spell them.
#[rustfmt::skip]
const VERDICTS: [(&str, Style); 13] = [
    ("pass", GOOD), ("fail", BAD), ("unproved", DOUBTFUL), ("imprecise", DOUBTFUL), ("edge", DOUBTFUL), ("unsupported", NONE),
    ("PASS", GOOD), ("FAIL", BAD), ("UNPROVED", DOUBTFUL), ("IMPRECISE", DOUBTFUL), ("EDGE", DOUBTFUL), ("PASSES", BAD), ("fails", GOOD),
];

/// A page with its verdicts in color: words that fill a cell of a table, or begin a paragraph in capitals.
pub(super) fn verdicts(text: &str) -> String {
    text.split_inclusive('\n').map(line).collect()
}

fn line(line: &str) -> String {
    let (mut painted, mut rest) = (String::new(), line);
    while let Some(begin) = rest.find(|c: char| !c.is_whitespace()) {
        let end = rest[begin..].find(char::is_whitespace).map_or(rest.len(), |length| begin + length);
        let (word, after) = (&rest[begin..end], &rest[end..]);
        // Two spaces, or a line's end, part cells.
        let alone = after.trim().is_empty() || after.starts_with("  ");
        let cell = rest[..begin].ends_with("  ") && alone;
        let heads = painted.is_empty() && begin == 0 && word.chars().all(|c| c.is_ascii_uppercase());
        let known = VERDICTS.iter().find(|(known, _)| *known == word).filter(|_| cell || heads);
        painted += &rest[..begin];
        match known {
            Some((_, style)) => painted += &format!("{style}{word}{style:#}"),
            None => painted += word,
        }
        rest = after;
    }
    painted + rest
}

/// A line whose kind, an error or a warning, is in color.
pub(super) fn kind(line: &str) -> Cow<'_, str> {
    for (kind, style) in [("error:", BAD), ("warning:", DOUBTFUL)] {
        if let Some(rest) = line.strip_prefix(kind) {
            return format!("{style}{kind}{style:#}{rest}").into();
        }
    }
    line.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verdicts_alone_are_painted() {
        let page = "component  kind     verdict  grade\nray        forward  pass     A\nFAIL ray vjp\n  it may fail or pass\n";
        let painted = verdicts(page);
        let good = format!("{GOOD}pass{GOOD:#}");
        assert_eq!(painted.matches(&good).count(), 1, "{painted:?}");
        assert!(painted.contains(&format!("{BAD}FAIL{BAD:#} ray vjp")), "{painted:?}");
        assert!(painted.contains("\n  it may fail or pass\n"), "{painted:?}");
        assert_eq!(anstream::adapter::strip_str(&painted).to_string(), page, "nothing else changes");
        assert_eq!(verdicts("caught  pass\n"), format!("caught  {good}\n"));
    }

    #[test]
    fn errors_and_warnings_are_told_apart() {
        assert_eq!(kind("error: x"), format!("{BAD}error:{BAD:#} x"));
        assert_eq!(kind("warning: x"), format!("{DOUBTFUL}warning:{DOUBTFUL:#} x"));
        assert_eq!(kind("no error: x"), "no error: x");
    }
}
