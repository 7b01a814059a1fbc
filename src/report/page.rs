//! A page that shows pictures, curves and tables: plain HTML, no script, everything beside it in the same folder.

use std::fmt::Write;

use crate::shown::shown;

/// The look of all pages.
const STYLE: &str = include_str!("style.css");

/// Words that stand in a color of their own, and the color's name in the style.
const VERDICTS: [(&str, &str); 6] = [
    ("pass", "pass"),
    ("fail", "fail"),
    ("unproved", "doubt"),
    ("imprecise", "doubt"),
    ("edge", "doubt"),
    ("unsupported", "dim"),
];

/// A page under construction.
pub(crate) struct Page {
    html: String,
}

impl Page {
    /// A page with a title and a sentence under it.
    pub(crate) fn new(title: &str, lead: &str) -> Self {
        let (title, lead) = (escape(title), escape(lead));
        let html = format!(
            "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"><title>{title}</title>\n\
             <style>{STYLE}</style></head><body><main>\n<h1>{title}</h1>\n<p>{lead}</p>\n"
        );
        Page { html }
    }

    /// A heading.
    pub(crate) fn heading(&mut self, text: &str) -> &mut Self {
        let _ = writeln!(self.html, "<h2>{}</h2>", escape(text));
        self
    }

    /// A paragraph.
    pub(crate) fn paragraph(&mut self, text: &str) -> &mut Self {
        let _ = writeln!(self.html, "<p>{}</p>", escape(text));
        self
    }

    /// A picture as SVG, inside the page.
    pub(crate) fn figure(&mut self, svg: &str) -> &mut Self {
        let _ = writeln!(self.html, "<figure>{svg}</figure>");
        self
    }

    /// A picture file beside the page, `width` pixels wide, with a caption that is also its alternative text.
    pub(crate) fn picture(&mut self, file: &str, caption: &str, width: u32) -> &mut Self {
        let (file, caption) = (escape(file), escape(caption));
        let _ = writeln!(
            self.html,
            "<figure><img src=\"{file}\" alt=\"{caption}\" width=\"{width}\"><figcaption>{caption}</figcaption></figure>"
        );
        self
    }

    /// Pictures side by side that belong together, each with what it is; files beside the page, small ones enlarged without smoothing.
    pub(crate) fn pictures(&mut self, of: &str, pictures: &[(&str, &str)], width: u32) -> &mut Self {
        for (file, what) in pictures {
            let (file, what, of) = (escape(file), escape(what), escape(of));
            let _ = writeln!(
                self.html,
                "<figure><a href=\"{file}\"><img src=\"{file}\" alt=\"{of}: {what}\" width=\"{width}\" loading=\"lazy\" \
                 class=\"pixels\"></a><figcaption>{what}</figcaption></figure>"
            );
        }
        self
    }

    /// A heading one level below the others.
    pub(crate) fn part(&mut self, text: &str) -> &mut Self {
        let _ = writeln!(self.html, "<h3>{}</h3>", escape(text));
        self
    }

    /// Sentences of which a reader should know first of all; nothing where there is none.
    pub(crate) fn warnings(&mut self, sentences: &[String]) -> &mut Self {
        let items: String = sentences.iter().map(|text| format!("<li>{}</li>\n", escape(text))).collect();
        if !items.is_empty() {
            let _ = writeln!(self.html, "<ul class=\"warnings\">{items}</ul>");
        }
        self
    }

    /// A table; verdicts stand in their colors.
    pub(crate) fn table(&mut self, header: &[&str], rows: &[Vec<String>]) -> &mut Self {
        self.header("", header);
        for row in rows {
            let cells: String = row.iter().map(|cell| table_cell(cell)).collect();
            let _ = writeln!(self.html, "<tr>{cells}</tr>");
        }
        self.html.push_str("</table></div>\n");
        self
    }

    /// A table of sentences.
    pub(crate) fn text_table(&mut self, header: &[&str], rows: &[Vec<String>]) -> &mut Self {
        self.rows(header, rows.iter().map(|row| (None, &row[..])))
    }

    /// The same, with a file beside the page behind the first cell of each row.
    pub(crate) fn linked_table(&mut self, header: &[&str], rows: &[(String, Vec<String>)]) -> &mut Self {
        self.rows(header, rows.iter().map(|(file, row)| (Some(&file[..]), &row[..])))
    }

    fn rows<'a>(
        &mut self,
        header: &[&str],
        rows: impl Iterator<Item = (Option<&'a str>, &'a [String])>,
    ) -> &mut Self {
        self.header(" class=\"text\"", header);
        for (file, cells) in rows {
            let mut cells: Vec<String> = cells.iter().map(|cell| escape(cell)).collect();
            if let (Some(file), Some(first)) = (file, cells.first_mut()) {
                *first = format!("<a href=\"{}\">{first}</a>", escape(file));
            }
            let cells: String = cells.iter().map(|cell| format!("<td>{cell}</td>")).collect();
            let _ = writeln!(self.html, "<tr>{cells}</tr>");
        }
        self.html.push_str("</table></div>\n");
        self
    }

    /// A table's beginning.
    fn header(&mut self, class: &str, cells: &[&str]) {
        let cells: String =
            cells.iter().map(|cell| format!("<th scope=\"col\">{}</th>", escape(cell))).collect();
        let _ = writeln!(self.html, "{WIDE}<table{class}><tr>{cells}</tr>");
    }

    /// A list of sentences; nothing where there is none.
    pub(crate) fn list(&mut self, sentences: &[String]) -> &mut Self {
        let items: String = sentences.iter().map(|text| format!("<li>{}</li>\n", escape(text))).collect();
        if !items.is_empty() {
            let _ = writeln!(self.html, "<ul>{items}</ul>");
        }
        self
    }

    /// A text with lines of its own, as it is.
    pub(crate) fn verbatim(&mut self, text: &str) -> &mut Self {
        let lines: Vec<String> = text.lines().map(escape).collect();
        let _ = writeln!(self.html, "<pre tabindex=\"0\">{}</pre>", lines.join("\n"));
        self
    }

    /// The whole page.
    pub(crate) fn finish(&self) -> String {
        format!("{}</main></body></html>\n", self.html)
    }
}

/// What is wider than the screen is scrolled in its own box, also by keys.
const WIDE: &str = "<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"Table\">";

fn table_cell(text: &str) -> String {
    match VERDICTS.iter().find(|(verdict, _)| *verdict == text) {
        Some((verdict, class)) => format!("<td class=\"{class}\">{verdict}</td>"),
        None => format!("<td>{}</td>", escape(text)),
    }
}

/// Text as HTML and SVG show it.
pub(super) fn escape(text: &str) -> String {
    shown(text).replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_escaped() {
        let page = Page::new("a < b", "\"&\"").picture("x.png", "<i>", 10).finish();
        assert!(
            page.contains("a &lt; b")
                && page.contains("&quot;&amp;&quot;")
                && page.contains("alt=\"&lt;i&gt;\"")
        );
        // XML has no way to write most of them.
        assert_eq!(escape("a\u{1b}\u{0}<"), "a\\u{1b}\\u{0}&lt;");
    }

    #[test]
    fn verdicts_stand_in_their_colors_and_nothing_else_does() {
        let page = Page::new("a", "b").table(&["x"], &[vec!["fail".into()], vec!["failing".into()]]).finish();
        assert!(page.contains("<td class=\"fail\">fail</td>") && page.contains("<td>failing</td>"));
    }
}
