//! A page that shows pictures, curves and tables: plain HTML, no script, everything beside it in the same folder.

use std::fmt::Write;

use crate::shown::shown;

/// A page under construction.
pub(crate) struct Page {
    html: String,
}

impl Page {
    /// A page with a title and a sentence under it.
    pub(crate) fn new(title: &str, lead: &str) -> Self {
        let style = "body{font:16px/1.5 system-ui,sans-serif;max-width:60rem;margin:2rem auto;padding:0 1rem;color:#222}\
            figure{margin:1rem 1rem 1rem 0;display:inline-block;vertical-align:top}\
            figcaption{font-size:.85rem;color:#555}img{max-width:100%;image-rendering:auto}\
            table{border-collapse:collapse;font-size:.85rem}td,th{padding:.2rem .5rem;white-space:nowrap;border-bottom:1px solid #ddd;text-align:right}\
            td:first-child,th:first-child{text-align:left}\
            table.text td,table.text th{text-align:left;vertical-align:top;white-space:normal}\
            pre{background:#f4f4f4;padding:.5rem;overflow-x:auto;font-size:.8rem}";
        let (title, lead) = (escape(title), escape(lead));
        let html = format!(
            "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{title}</title>\n\
             <style>{style}</style></head><body>\n<h1>{title}</h1>\n<p>{lead}</p>\n"
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

    /// A table.
    pub(crate) fn table(&mut self, header: &[&str], rows: &[Vec<String>]) -> &mut Self {
        let cells = |tag: &str, cells: &mut dyn Iterator<Item = &str>| {
            cells.map(|c| format!("<{tag}>{}</{tag}>", escape(c))).collect::<String>()
        };
        let _ = writeln!(self.html, "<table><tr>{}</tr>", cells("th", &mut header.iter().copied()));
        for row in rows {
            let _ = writeln!(self.html, "<tr>{}</tr>", cells("td", &mut row.iter().map(String::as_str)));
        }
        self.html.push_str("</table>\n");
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
        let header: String = header.iter().map(|cell| format!("<th>{}</th>", escape(cell))).collect();
        let _ = writeln!(self.html, "<table class=\"text\"><tr>{header}</tr>");
        for (file, cells) in rows {
            let mut cells: Vec<String> = cells.iter().map(|cell| escape(cell)).collect();
            if let (Some(file), Some(first)) = (file, cells.first_mut()) {
                *first = format!("<a href=\"{}\">{first}</a>", escape(file));
            }
            let cells: String = cells.iter().map(|cell| format!("<td>{cell}</td>")).collect();
            let _ = writeln!(self.html, "<tr>{cells}</tr>");
        }
        self.html.push_str("</table>\n");
        self
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
        let _ = writeln!(self.html, "<pre>{}</pre>", lines.join("\n"));
        self
    }

    /// The whole page.
    pub(crate) fn finish(&self) -> String {
        format!("{}</body></html>\n", self.html)
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
}
