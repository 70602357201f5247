//! The results of a run as one page, for a browser or a printer: no scripts, and nothing loaded from the network.

mod filter;
mod html;

use kalmanscope_core::diagnosis::Finding;
use kalmanscope_core::{Analysis, Record, Run, ScenarioError};
use thiserror::Error;

use crate::free_run;
use crate::number::plain;
use crate::plot::{PlotError, pages};
use crate::remarks::remarks;
use crate::results::{FilterResults, Results};
use html::Html;

/// The reason why a report could not be made.
#[derive(Debug, Error)]
pub enum ReportError {
    /// A figure could not be drawn.
    #[error(transparent)]
    Plot(#[from] PlotError),
    /// The scenario cannot be written as TOML.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
}

/// The style: readable on paper, and on a light or a dark screen. Figures are drawn for a white ground; on a dark one their
/// brightness is turned over, and hues stay.
const STYLE: &str = include_str!("report/style.css");

/// A report on a finished run, as the text of an HTML file: what was measured, each filter's verdict with its evidence and
/// causes, its last estimates and scores, the figures, free runs of the identified models, and the scenario.
///
/// `causes` are those of [`crate::causes()`], one list per filter, or empty to leave them out. `free_runs` are the records
/// over which the models run freely, each with its name. Text from files appears as text, whatever it contains.
///
/// # Errors
/// [`ReportError`] where a figure cannot be drawn, or the scenario cannot be written.
pub fn report(
    title: &str,
    run: &Run,
    analysis: &Analysis,
    causes: &[Vec<Finding>],
    free_runs: &[(&str, &Record)],
) -> Result<String, ReportError> {
    let mut page = Html::page(title, STYLE);
    page.element("h1", title);
    origin(&mut page, run);
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
    page.element("h2", "Figures");
    for picture in pages(run)? {
        page.figure(&picture);
    }
    page.element(
        "p",
        "Truth in dark grey, measurements as dots, each filter's estimate or prediction as a line over its ±2σ band.",
    );
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

/// The record in two lines.
fn origin(page: &mut Html, run: &Run) {
    let record = run.record();
    let (start, end) = (record.time(0), record.time(record.len().saturating_sub(1)));
    let [start, end, dt] = [start, end, record.dt()].map(plain);
    let mut lines = vec![format!("{} samples from {start} s to {end} s, {dt} s apart", record.len())];
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
