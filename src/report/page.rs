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
            td:first-child,th:first-child{text-align:left}";
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
