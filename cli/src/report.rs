//! The results of a run as one page, for a browser or a printer: no scripts, and nothing loaded from the network.

use std::fmt::Write as _;

use kalmanscope_core::ScenarioError;
use kalmanscope_diagnosis::Summary;
use kalmanscope_figures::escaped;

use crate::in_words::{evidence, likeliest, quality, remarks, unexplained};
use crate::results::{FilterResults, Results};
use crate::rows::{COLUMNS, rows};
use crate::table::{NO_VERDICT, heading, origin, stop};

/// The parts of a report besides the results.
#[derive(Clone, Copy, Debug, Default)]
pub struct ReportParts<'a> {
    /// Its title.
    pub title: &'a str,
    /// The reasons of start values, one sentence each.
    pub reasons: &'a [String],
    /// The figures, as SVG.
    pub figures: &'a [String],
}

/// The style: readable on paper, and on a light or a dark screen. Figures are drawn for a white ground; on a dark one their
/// brightness is turned over, and hues stay.
const STYLE: &str = include_str!("report.css");

/// A report on the results of a run ([`Results::of_run`]), as the text of an HTML file: the run in a few sentences, what was
/// measured, each filter's verdict with its evidence and causes, its last estimates and scores, the figures, free runs of the
/// identified models, and the scenario. Text from files appears as text, whatever it contains.
///
/// # Errors
/// [`ScenarioError`] where the scenario cannot be written.
pub fn report(results: &Results<'_>, parts: &ReportParts<'_>) -> Result<String, ScenarioError> {
    let ReportParts { title, reasons, figures } = *parts;
    let Results { scenario, record, truth_stop, story, filters, smoothers, free_runs, command: _ } = results;
    let mut page = Html::page(title, STYLE);
    page.element("h1", title);
    page.element("p", story);
    page.list(origin(record, *truth_stop));
    if !reasons.is_empty() {
        page.element("h2", "Start values");
        page.list(reasons.iter().cloned());
    }
    page.element("h2", "Filters");
    if filters.is_empty() {
        page.element("p", "There are no filters.");
    }
    for filter in filters {
        section(&mut page, &filter.summary, Some(filter), results);
        page.list(remarks(&filter.remarks, record));
    }
    smoothers.iter().for_each(|summary| section(&mut page, summary, None, results));
    if !figures.is_empty() {
        page.element("h2", "Figures");
        figures.iter().for_each(|figure| page.figure(figure));
        page.element(
            "p",
            "Truth in dark grey, measurements as dots, each filter's estimate or prediction as a line over its ±2σ band.",
        );
    }
    if !free_runs.is_empty() {
        page.element("h2", "Free runs of the final models");
        page.element("p", "The identified model is given the input only, not the measurements.");
    }
    for runs in free_runs {
        page.element("h3", &format!("Over {}: {} samples", runs.name, runs.samples));
        page.list(runs.lines(results.length()));
    }
    page.element("h2", "Scenario");
    page.element("p", "kalmanscope-cli run repeats the run from this file, and from the record if one was measured.");
    page.element("pre", &scenario.to_toml()?);
    page.element("footer", &format!("Kalmanscope {}", env!("CARGO_PKG_VERSION")));
    Ok(page.finish())
}

const HEADINGS: [&str; COLUMNS] =
    ["", "quantity", "estimate", "±2σ", "unit", "error", "", "RMSE", "last third", "inside ±2σ", "settled"];

/// A smoother has no results but its summary.
fn section(page: &mut Html, summary: &Summary, filter: Option<&FilterResults>, results: &Results<'_>) {
    page.element("h3", &heading(&summary.name, summary.kind));
    match &summary.verdict {
        Some(verdict) => page.element("p", &verdict.to_string()),
        None if filter.is_some() => page.element("p", NO_VERDICT),
        None => {}
    }
    if let Some(FilterResults { diagnosis, causes, .. }) = filter {
        page.list(diagnosis.iter().flat_map(evidence));
        unexplained(causes, summary).into_iter().for_each(|line| page.element("p", &line));
        for cause in likeliest(causes, summary, results) {
            page.element("h4", &cause.sentence);
            page.list(cause.remedy.into_iter().chain([cause.trial]));
        }
    }
    let rows: Vec<[String; COLUMNS]> =
        summary.finals.iter().flat_map(|last| rows(last, results.scenario.record.as_ref())).collect();
    // A column that is empty in every row is left out.
    let kept: Vec<usize> = (0..COLUMNS).filter(|&i| rows.iter().any(|row| !row[i].is_empty())).collect();
    let headings: Vec<&str> = kept.iter().map(|&i| HEADINGS[i]).collect();
    let rows: Vec<Vec<String>> = rows.iter().map(|row| kept.iter().map(|&i| row[i].clone()).collect()).collect();
    page.table(&headings, &rows);
    let quality = quality(summary, filter.is_some());
    let rows: Vec<Vec<String>> = quality.into_iter().map(|(name, value)| vec![name.to_owned(), value]).collect();
    page.table(&[], &rows);
    stop(summary, &results.record).into_iter().for_each(|line| page.element("p", &line));
}

struct Html(String);

impl Html {
    /// A page with a head. Its policy allows its own style and nothing else: no scripts, no pictures from other sites.
    fn page(title: &str, style: &str) -> Self {
        Self(format!(
            "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'\">\n\
             <meta name=\"viewport\" content=\"width=device-width\">\n<meta name=\"color-scheme\" content=\"light dark\">\n\
             <title>{}</title>\n<style>\n{style}</style>\n</head>\n<body>\n",
            escaped(title)
        ))
    }

    fn element(&mut self, tag: &str, text: &str) {
        self.line(&format!("<{tag}>{}</{tag}>", escaped(text)));
    }

    /// A list of texts; writes nothing if there are none.
    fn list(&mut self, items: impl IntoIterator<Item = String>) {
        let items: String = items.into_iter().map(|item| format!("<li>{}</li>", escaped(&item))).collect();
        if !items.is_empty() {
            self.line(&format!("<ul>{items}</ul>"));
        }
    }

    fn table(&mut self, headings: &[&str], rows: &[Vec<String>]) {
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
    fn figure(&mut self, svg: &str) {
        self.line(&format!("<figure>{svg}</figure>"));
    }

    fn finish(mut self) -> String {
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
