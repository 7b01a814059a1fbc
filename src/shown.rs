//! Text from files as it may be shown: a name can hold what moves a terminal's cursor, ends a line, or breaks an SVG.

use std::borrow::Cow;

/// The same text with control characters, line ends and marks that change the direction of reading written as `\u{1b}`.
pub fn shown(text: &str) -> Cow<'_, str> {
    if !text.contains(hidden) {
        return Cow::Borrowed(text);
    }
    Cow::Owned(
        text.chars().map(|c| if hidden(c) { c.escape_unicode().to_string() } else { c.into() }).collect(),
    )
}

/// The same, but with its line ends and tabs: of a text that has lines of its own.
pub fn lines(text: &str) -> Cow<'_, str> {
    let breaks = |c: char| matches!(c, '\n' | '\t');
    if !text.contains(|c| hidden(c) && !breaks(c)) {
        return Cow::Borrowed(text);
    }
    Cow::Owned(
        text.split_inclusive(breaks)
            .map(|line| {
                let (text, end) = line.split_at(line.len() - usize::from(line.ends_with(breaks)));
                shown(text).into_owned() + end
            })
            .collect(),
    )
}

/// JSON as it may be shown: the same object, with such characters in its strings as `\u009b`. (serde_json does so below space alone.)
pub fn json_escaped(json: &str) -> Cow<'_, str> {
    if !json.contains(hidden) {
        return Cow::Borrowed(json);
    }
    let escaped = |c: char| if hidden(c) { format!("\\u{:04x}", u32::from(c)) } else { c.into() };
    Cow::Owned(json.chars().map(escaped).collect())
}

/// Whether a character has no picture of its own but an effect on others.
fn hidden(c: char) -> bool {
    // Line and paragraph separators, embeddings, overrides and isolates; two that are no characters in XML.
    let marks = matches!(c, '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    c.is_control() || marks || matches!(c, '\u{feff}' | '\u{fffe}' | '\u{ffff}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_moves_a_cursor_is_written_out() {
        assert!(matches!(shown("a view, 7.5 dB"), Cow::Borrowed(_)));
        assert_eq!(shown("a\u{1b}[31m\nb\u{202e}c\u{9b}"), "a\\u{1b}[31m\\u{a}b\\u{202e}c\\u{9b}");
        assert_eq!(lines("a\tb\nc\r\n\u{7f}"), "a\tb\nc\\u{d}\n\\u{7f}");
        assert!(matches!(lines("a\nb\n"), Cow::Borrowed(_)));
        let object = serde_json::json!({ "a\u{9b}": "\n\u{7f}\u{202e}" });
        let text = json_escaped(&object.to_string()).into_owned();
        assert_eq!(text, r#"{"a\u009b":"\n\u007f\u202e"}"#);
        assert_eq!(serde_json::from_str::<serde_json::Value>(&text).unwrap(), object);
    }
}
