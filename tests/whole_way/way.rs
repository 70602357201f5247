//! The whole way of a scenario without a screen: record, run, diagnosis with causes, free run, table, report, picture.

use std::sync::Arc;

use kalmanscope_cli::{Parts, Results, causes, pages, report, run_scenario, svg, write_estimates};
use kalmanscope_core::suggest::{scenario_for, suggest};
use kalmanscope_core::{Analysis, Record, Run, Scenario, Wanted};

use crate::dice::Dice;
use crate::findings::Findings;
use crate::records::{Read, file, read_file};
use crate::scenarios::shortened;

pub(crate) struct Measured {
    pub(crate) bytes: Vec<u8>,
    pub(crate) read: Read,
    pub(crate) scenario: Scenario,
}

/// Reads the text of a scenario. None where it is refused, which must be in a sentence.
pub(crate) fn scenario_of(text: &str, findings: &mut Findings) -> Option<Scenario> {
    let scenario = match findings.stage("reading the scenario", || Scenario::from_toml(text))? {
        Ok(scenario) => scenario,
        Err(error) => {
            sentence("reading the scenario", &error.to_string(), findings);
            return None;
        }
    };
    let again = findings.stage("writing the scenario", || {
        let text = scenario.to_toml().map_err(|error| error.to_string())?;
        Scenario::from_toml(&text).map_err(|error| format!("{error}\n{text}"))
    })?;
    findings.require("writing the scenario", again.as_ref() == Ok(&scenario), "reads back as another", || {
        again.err().unwrap_or_default()
    });
    Some(scenario)
}

fn sentence(stage: &'static str, error: &str, findings: &mut Findings) {
    let is_one = error.split_whitespace().count() > 2 && !error.contains("panicked");
    findings.require(stage, is_one, "refuses without a sentence", || error.to_owned());
}

pub(crate) fn go(scenario: &Scenario, dice: &mut Dice, findings: &mut Findings) -> Option<Measured> {
    let short = shortened(scenario);
    let run = findings.stage("running", || run_scenario(&short, None))?;
    let run = match run {
        Ok(run) => run,
        Err(error) => {
            sentence("running", &error.to_string(), findings);
            return None;
        }
    };
    results(&run, findings);
    let bytes = findings.stage("writing a measured file", || file(run.record(), dice))?;
    measured(bytes, &short, dice, findings)
}

/// Imports a file, makes start values for it, and runs both the scenario and the one with the start values over it.
pub(crate) fn measured(
    bytes: Vec<u8>,
    scenario: &Scenario,
    dice: &mut Dice,
    findings: &mut Findings,
) -> Option<Measured> {
    let read = match findings.stage("reading the file", || read_file(&bytes, dice))? {
        Ok(read) => read,
        Err(error) => {
            sentence("reading the file", &error, findings);
            return None;
        }
    };
    let record = match findings.stage("making the record", || read.record(scenario.hold))? {
        Ok(record) => Arc::new(record),
        Err(error) => {
            sentence("making the record", &error, findings);
            return None;
        }
    };
    let own = read.fit(scenario.clone());
    let suggested = findings.stage("start values", || {
        let mut plain = scenario_for(&record);
        plain.record = Some(read.mapping.clone());
        plain.plant.kind = own.plant.kind.clone();
        let own = Scenario { filters: own.filters.iter().take(2).cloned().collect(), ..own.clone() };
        [suggest(&plain, &record).scenario, suggest(&own, &record).scenario]
    });
    for scenario in suggested.into_iter().flatten().chain([own.clone()]) {
        over(&scenario, &record, findings);
    }
    Some(Measured { bytes, read, scenario: own })
}

fn over(scenario: &Scenario, record: &Arc<Record>, findings: &mut Findings) {
    match findings.stage("running over the record", || run_scenario(scenario, Some(Record::clone(record)))) {
        Some(Ok(run)) => results(&run, findings),
        Some(Err(error)) => sentence("running over the record", &error.to_string(), findings),
        None => {}
    }
}

fn results(run: &Run, findings: &mut Findings) {
    let wanted = Wanted { bounds: true, ..Wanted::default() };
    let Some(analysis) = findings.stage("analysis", || Analysis::new(run, wanted)) else { return };
    let causes = findings.stage("causes", || causes(run, &analysis, &mut |_| {})).unwrap_or_default();
    let records = [("its own record", run.record())];
    let results = || Results::of_run(run, &analysis, causes).with_free_runs(run, &records);
    let Some(results) = findings.stage("results", results) else { return };
    if let Some(text) = findings.stage("table", || results.table(true)) {
        legible("table", &text, findings);
    }
    let figures = findings.stage("figures", || pages(run)).unwrap_or_default();
    let parts = Parts { title: "case", figures: &figures, ..Parts::default() };
    if let Some(page) = findings.stage("report", || report(&results, &parts)) {
        match page {
            Ok(page) => {
                // The scenario stands last, as it is in its file.
                let page = page.split("<h2>Scenario</h2>").next().unwrap_or_default();
                legible("report", page, findings);
            }
            Err(error) => sentence("report", &error.to_string(), findings),
        }
    }
    if let Some(picture) = findings.stage("picture", || svg(run)) {
        legible("picture", &picture, findings);
    }
    findings.stage("estimates as CSV", || write_estimates(run, std::io::sink()).is_ok());
    for estimates in run.estimates() {
        let finite = |k: usize| estimates.mean(k).iter().chain(estimates.cov(k)).all(|number| number.is_finite());
        let bad = (0..estimates.len()).find(|k| !finite(*k));
        findings.require("running", bad.is_none(), "an estimate is no number", || format!("{bad:?}"));
    }
}

/// Notes numbers that nobody can read.
fn legible(stage: &'static str, text: &str, findings: &mut Findings) {
    let words = || text.split(|c: char| !(c.is_alphanumeric() || c == 'σ'));
    let undefined = words().find(|word| ["NaN", "nan", "inf", "infσ", "NaNσ"].contains(word));
    let line =
        |word: &str| text.lines().find(|line| line.contains(word)).unwrap_or_default().chars().take(300).collect();
    findings.require(stage, undefined.is_none(), "has an undefined number", || line(undefined.unwrap_or_default()));
    let long = words().find(|word| word.len() > 17 && word.bytes().all(|byte| byte.is_ascii_digit()));
    findings.require(stage, long.is_none(), "has a number of too many digits", || line(long.unwrap_or_default()));
}
