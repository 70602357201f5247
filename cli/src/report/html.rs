//! A page that is written from top to bottom. All text is escaped on its way into it.

use std::fmt::Write as _;

use kalmanscope_figures::escaped;

/// A page under way.
pub(super) struct Html(String);

impl Html {
    /// A page with a head. Its policy allows its own style and nothing else: no scripts, no pictures from other sites.
    pub(super) fn page(title: &str, style: &str) -> Self {
        Self(format!(
            "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'\">\n\
             <meta name=\"viewport\" content=\"width=device-width\">\n<meta name=\"color-scheme\" content=\"light dark\">\n\
             <title>{}</title>\n<style>\n{style}</style>\n</head>\n<body>\n",
            escaped(title)
        ))
    }

    /// An element with a text.
    pub(super) fn element(&mut self, tag: &str, text: &str) {
        self.line(&format!("<{tag}>{}</{tag}>", escaped(text)));
    }

    /// A list of texts; writes nothing if there are none.
    pub(super) fn list(&mut self, items: impl IntoIterator<Item = String>) {
        let items: String = items.into_iter().map(|item| format!("<li>{}</li>", escaped(&item))).collect();
        if !items.is_empty() {
            self.line(&format!("<ul>{items}</ul>"));
        }
    }

    /// A table with a row of headings, or without one if that is empty. The first cell of each row is its heading.
    pub(super) fn table(&mut self, headings: &[&str], rows: &[Vec<String>]) {
        let row = |tag: &str, cells: &mut dyn Iterator<Item = &str>| {
            let cells: String = cells.map(|cell| format!("<{tag}>{}</{tag}>", escaped(cell))).collect();
            cells
        };
        let mut text = "<div><table>".to_owned();
        if !headings.is_empty() {
            // Writing to a string cannot fail.
            let _ = write!(text, "<thead><tr>{}</tr></thead>", row("th", &mut headings.iter().copied()));
        }
        for cells in rows {
            let Some((first, others)) = cells.split_first() else { continue };
            let others = row("td", &mut others.iter().map(String::as_str));
            let _ = write!(text, "<tr><th scope=\"row\">{}</th>{others}</tr>", escaped(first));
        }
        self.line(&(text + "</table></div>"));
    }

    /// A picture of this program, which is markup.
    pub(super) fn figure(&mut self, svg: &str) {
        self.line(&format!("<figure>{svg}</figure>"));
    }

    /// The text of the page.
    pub(super) fn finish(mut self) -> String {
        self.0.push_str("</body>\n</html>\n");
        self.0
    }

    fn line(&mut self, markup: &str) {
        self.0.push_str(markup);
        self.0.push('\n');
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_never_markup() {
        let mut page = Html::page("</title><script>", "");
        page.element("p", "a < b & \"c\" 'd'\u{0}");
        page.table(&["<th>"], &[vec!["<b>".to_owned(), "</table>".to_owned()]]);
        page.list(["<li>".to_owned()]);
        let text = page.finish();
        assert!(!text.contains("<script>") && !text.contains("<b>"), "{text}");
        assert_eq!(text.matches("</table>").count(), 1);
        assert!(text.contains("<p>a &lt; b &amp; &quot;c&quot; &#39;d&#39;\u{fffd}</p>"), "{text}");
    }
}
