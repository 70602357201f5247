//! The part of a report about one filter, or one smoother.

use kalmanscope_core::diagnosis::Remedy;
use kalmanscope_core::{Diagnosis, Record, Scenario, Summary};

use super::html::Html;
use crate::in_words::{evidence, likeliest, unexplained};
use crate::number::plain;
use crate::quality::quality;
use crate::rows::{COLUMNS, rows};
use crate::table::heading;

/// The headings of [`rows`].
const HEADINGS: [&str; COLUMNS] =
    ["", "quantity", "estimate", "±2σ", "unit", "error", "", "RMSE", "last third", "inside ±2σ", "settled"];

/// Writes the verdict with evidence and causes, the last estimates with their scores, and consistency in numbers.
/// `diagnosis` is none for a smoother. `mapping` is that of a measured
/// record.
pub(super) fn section(
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
    unexplained(causes).into_iter().for_each(|line| page.element("p", &line));
    for (number, cause) in (1..).zip(likeliest(causes, scenario)) {
        page.element("h4", &format!("Cause {number}: {}", cause.sentence));
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
