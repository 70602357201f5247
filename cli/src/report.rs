//! The results of a run as one page, for a browser or a printer: no scripts, and nothing loaded from the network.

mod date;
mod filter;
mod html;

use kalmanscope_core::diagnosis::Remedy;
use kalmanscope_core::{Analysis, Diagnosis, Record, Run, ScenarioError, Story};

use crate::free_run;
use crate::number::plain;
use crate::remarks::remarks;
use crate::results::{FilterResults, Results};
use html::Html;

pub use date::day;

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
const STYLE: &str = include_str!("report/style.css");

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
    let results = Results::of_run(run, analysis, causes.to_vec());
    let Results { scenario, record, filters, smoothers, .. } = results;
    page.element("h2", "Filters");
    if filters.is_empty() {
        page.element("p", "There are no filters.");
    }
    for FilterResults { summary, diagnosis, causes, remarks: said, .. } in &filters {
        filter::section(&mut page, summary, diagnosis.as_ref(), causes, (record, &scenario));
        page.list(remarks(said, record));
    }
    for summary in &smoothers {
        filter::section(&mut page, summary, None, &[], (record, &scenario));
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
    for (name, record) in free_runs {
        page.element("h3", &format!("Over {name}: {} samples", record.len()));
        page.list(free_run::lines(run, record));
    }
    page.element("h2", "Scenario");
    page.element("p", "This file, given to kalmanscope-cli run, with its record if one was measured, repeats the run.");
    page.element("pre", &run.scenario().to_toml()?);
    page.element("footer", &format!("Kalmanscope {}", env!("CARGO_PKG_VERSION")));
    Ok(page.finish())
}

/// The day and the record in lines.
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
