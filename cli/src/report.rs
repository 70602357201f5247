//! The results of a run as one page, for a browser or a printer: no scripts, and nothing loaded from the network.

use std::fmt::Write as _;

use kalmanscope_core::diagnosis::Remedy;
use kalmanscope_core::{Analysis, Diagnosis, Record, Run, Scenario, ScenarioError, Story, Summary};
use kalmanscope_figures::escaped;

use crate::in_words::{are_models, evidence, likeliest, quality, remarks, unexplained};
use crate::number::plain;
use crate::results::{FilterResults, Results};
use crate::rows::{COLUMNS, rows};
use crate::table::heading;

/// The parts of a report besides the run.
#[derive(Clone, Copy, Debug, Default)]
pub struct Parts<'a> {
    /// Its title.
    pub title: &'a str,
    /// The day on which it is made; empty to leave it out.
    pub day: &'a str,
    /// The causes of each filter's verdict, as of [`crate::causes()`], or empty to leave them out.
    pub causes: &'a [Vec<Remedy>],
    /// The reasons of start values, one sentence each.
    pub reasons: &'a [String],
    /// The figures, as SVG.
    pub figures: &'a [String],
    /// The records over which the identified models run freely, each with its name.
    pub free_runs: &'a [(&'a str, &'a Record)],
}

/// The style: readable on paper, and on a light or a dark screen. Figures are drawn for a white ground; on a dark one their
/// brightness is turned over, and hues stay.
const STYLE: &str = include_str!("report.css");

/// A report on a finished run, as the text of an HTML file: the run in a few sentences, what was measured, each filter's verdict with
/// its evidence and causes, its last estimates and scores, the figures, free runs of the identified models, and the scenario. Text
/// from files appears as text, whatever it contains.
///
/// # Errors
/// [`ScenarioError`] where the scenario cannot be written.
pub fn report(run: &Run, analysis: &Analysis, parts: &Parts<'_>) -> Result<String, ScenarioError> {
    let Parts { title, day, causes, reasons, figures, free_runs } = *parts;
    let mut page = Html::page(title, STYLE);
    page.element("h1", title);
    let diagnoses: Vec<Option<&Diagnosis>> =
        (0..run.estimates().len()).map(|place| analysis.diagnosis(place)).collect();
    page.element("p", &Story::of(run, analysis.diagnostics(), &diagnoses).to_string());
    origin(&mut page, run, day);
    if !reasons.is_empty() {
        page.element("h2", "Start values");
        page.list(reasons.iter().cloned());
    }
    let results = Results::of_run(run, analysis, causes.to_vec()).with_free_runs(run, free_runs);
    let length = results.length();
    let Results { scenario, record, filters, smoothers, free_runs, .. } = results;
    page.element("h2", "Filters");
    if filters.is_empty() {
        page.element("p", "There are no filters.");
    }
    for FilterResults { summary, diagnosis, causes, remarks: said, .. } in &filters {
        section(&mut page, summary, diagnosis.as_ref(), causes, (record, &scenario));
        page.list(remarks(said, record));
    }
    for summary in &smoothers {
        section(&mut page, summary, None, &[], (record, &scenario));
    }
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
    for runs in &free_runs {
        page.element("h3", &format!("Over {}: {} samples", runs.name, runs.samples));
        page.list(runs.lines(length));
    }
    page.element("h2", "Scenario");
    page.element("p", "This file, given to kalmanscope-cli run, with its record if one was measured, repeats the run.");
    page.element("pre", &run.scenario().to_toml()?);
    page.element("footer", &format!("Kalmanscope {}", env!("CARGO_PKG_VERSION")));
    Ok(page.finish())
}

fn origin(page: &mut Html, run: &Run, day: &str) {
    let record = run.record();
    let (start, end) = (record.time(0), record.time(record.len().saturating_sub(1)));
    let [start, end, dt] = [start, end, record.dt()].map(plain);
    let made = (!day.is_empty()).then(|| format!("made on {day}"));
    let mut lines: Vec<String> = made.into_iter().collect();
    lines.push(format!("{} samples from {start} s to {end} s, {dt} s apart", record.len()));
    let sensors: Vec<String> = record.sensors().iter().map(|sensor| sensor.name()).collect();
    lines.push(if sensors.is_empty() {
        "measured: nothing".to_owned()
    } else {
        format!("measured: {}", sensors.join(", "))
    });
    if let Some(stop) = run.truth_stop() {
        lines.push(format!("the record ends before sample {}: {}", stop.sample, stop.reason));
    }
    page.list(lines);
}

const HEADINGS: [&str; COLUMNS] =
    ["", "quantity", "estimate", "±2σ", "unit", "error", "", "RMSE", "last third", "inside ±2σ", "settled"];

/// Writes the verdict with evidence and causes, the last estimates with their scores, and consistency in numbers.
/// `diagnosis` is none for a smoother. `mapping` is that of a measured
/// record.
fn section(
    page: &mut Html,
    summary: &Summary,
    diagnosis: Option<&Diagnosis>,
    causes: &[Remedy],
    (record, scenario): (&Record, &Scenario),
) {
    page.element("h3", &heading(&summary.name, summary.kind));
    match &summary.verdict {
        Some(verdict) => page.element("p", &verdict.to_string()),
        None if diagnosis.is_some() => page.element("p", "no verdict: fewer than 20 measurements"),
        None => {}
    }
    page.list(diagnosis.into_iter().flat_map(evidence));
    unexplained(causes, summary).into_iter().for_each(|line| page.element("p", &line));
    let what = if are_models(summary) { "Likelier model" } else { "Cause" };
    for (number, cause) in (1..).zip(likeliest(causes, summary, scenario)) {
        page.element("h4", &format!("{what} {number}: {}", cause.sentence));
        page.list(cause.remedies);
    }
    let rows: Vec<[String; COLUMNS]> =
        summary.finals.iter().flat_map(|last| rows(last, scenario.record.as_ref())).collect();
    // A column that is empty in every row is left out.
    let kept: Vec<usize> = (0..COLUMNS).filter(|&i| rows.iter().any(|row| !row[i].is_empty())).collect();
    let headings: Vec<&str> = kept.iter().map(|&i| HEADINGS[i]).collect();
    let rows: Vec<Vec<String>> = rows.iter().map(|row| kept.iter().map(|&i| row[i].clone()).collect()).collect();
    page.table(&headings, &rows);
    let quality = quality(summary, diagnosis.is_some());
    let rows: Vec<Vec<String>> = quality.into_iter().map(|(name, value)| vec![name.to_owned(), value]).collect();
    page.table(&[], &rows);
    if let Some(stop) = summary.stop {
        let time = plain(record.time_of(stop.sample));
        page.element("p", &format!("stopped at sample {} (t = {time} s): {}", stop.sample, stop.reason));
    }
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

/// The day of a time in seconds since 1970, UTC: `2026-11-25`.
///
/// Source: Hinnant (2013), chrono-compatible low-level date algorithms, `civil_from_days`.
pub fn day(seconds: f64) -> String {
    let days = (seconds / 86_400.0).floor() as i64 + 719_468;
    let (era, of_era) = (days.div_euclid(146_097), days.rem_euclid(146_097));
    let year = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year + year / 4 - year / 100);
    let shifted = (5 * of_year + 2) / 153;
    let (day, month) = (of_year - (153 * shifted + 2) / 5 + 1, if shifted < 10 { shifted + 3 } else { shifted - 9 });
    let year = year + 400 * era + i64::from(month <= 2);
    format!("{year}-{month:02}-{day:02}")
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

    #[test]
    fn days_are_those_of_the_calendar() {
        for (seconds, expected) in [
            (0.0, "1970-01-01"),
            (-1.0, "1969-12-31"),
            (951_782_400.0, "2000-02-29"),
            (951_868_800.0, "2000-03-01"),
            (1_795_564_800.0, "2026-11-25"),
        ] {
            assert_eq!(day(seconds), expected);
        }
    }
}
