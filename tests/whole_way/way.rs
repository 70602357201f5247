//! The whole way of a scenario without a screen: record, run, diagnosis with causes, free run, table, report, picture.

use std::sync::Arc;

use kalmanscope_cli::{ReportParts, Results, causes, pages, report, run_scenario, svg, write_estimates};
use kalmanscope_core::suggest::{scenario_for, suggest};
use kalmanscope_core::{Record, Run, Scenario};
use kalmanscope_diagnosis::{Analysis, Wanted};

use crate::dice::Dice;
use crate::findings::{accepted, stage};
use crate::records::{Read, file, read_file};
use crate::scenarios::shortened;

pub(crate) struct Measured {
    pub(crate) bytes: Vec<u8>,
    pub(crate) read: Read,
    pub(crate) scenario: Scenario,
}

/// Reads the text of a scenario. `None` if it is refused.
pub(crate) fn scenario_of(text: &str) -> Option<Scenario> {
    let scenario = stage("reading the scenario", || accepted(Scenario::from_toml(text)))?;
    stage("writing the scenario", || {
        let again = scenario.to_toml().map(|text| Scenario::from_toml(&text));
        assert!(matches!(&again, Ok(Ok(again)) if *again == scenario), "it reads back as another: {again:?}");
    });
    Some(scenario)
}

pub(crate) fn go(scenario: &Scenario, dice: &mut Dice) -> Option<Measured> {
    let short = shortened(scenario);
    let run = stage("running", || accepted(run_scenario(&short, None)))?;
    results(&run);
    let bytes = stage("writing a measured file", || file(run.record(), dice));
    measured(bytes, &short, dice)
}

/// Imports a file, makes start values for it, and runs both the scenario and the one with the start values over it.
fn measured(bytes: Vec<u8>, scenario: &Scenario, dice: &mut Dice) -> Option<Measured> {
    let read = stage("reading the file", || accepted(read_file(&bytes, dice)))?;
    let record = Arc::new(stage("making the record", || accepted(read.record(scenario.hold)))?);
    let own = read.fit(scenario.clone());
    let suggested = stage("start values", || {
        let mut plain = scenario_for(&record);
        plain.record = Some(read.mapping.clone());
        plain.plant.kind = own.plant.kind.clone();
        let own = Scenario { filters: own.filters.iter().take(2).cloned().collect(), ..own.clone() };
        [suggest(&plain, &record).scenario, suggest(&own, &record).scenario]
    });
    for scenario in suggested.iter().chain([&own]) {
        let run = || accepted(run_scenario(scenario, Some(Record::clone(&record))));
        stage("running over the record", run).iter().for_each(results);
    }
    Some(Measured { bytes, read, scenario: own })
}

fn results(run: &Run) {
    let wanted = Wanted { bounds: true, ..Wanted::default() };
    let analysis = stage("analysis", || Analysis::new(run, wanted));
    let causes = stage("causes", || causes(run, &analysis));
    let records = [("its own record", run.record())];
    let results = stage("results", || Results::of_run(run, &analysis, causes).with_free_runs(run, &records));
    require_legible(&stage("table", || results.table(true)));
    let figures = stage("figures", || pages(run));
    let parts = ReportParts { title: "case", figures: &figures, ..ReportParts::default() };
    if let Some(page) = stage("report", || accepted(report(&results, &parts))) {
        // The scenario stands last, as it is in its file.
        require_legible(page.split("<h2>Scenario</h2>").next().unwrap_or_default());
    }
    require_legible(&stage("picture", || svg(run)));
    stage("estimates as CSV", || accepted(write_estimates(run, std::io::sink())));
    for estimates in run.estimates() {
        let finite = |k: usize| estimates.mean(k).iter().chain(estimates.cov(k)).all(|number| number.is_finite());
        let bad = (0..estimates.len()).find(|k| !finite(*k));
        assert!(bad.is_none(), "an estimate is no number: {bad:?}");
    }
}

/// Refuses numbers that nobody can read.
#[track_caller]
fn require_legible(text: &str) {
    for line in text.lines() {
        for word in line.split(|c: char| !(c.is_alphanumeric() || c == 'σ')) {
            let is_undefined = ["NaN", "nan", "inf", "infσ", "NaNσ"].contains(&word);
            let is_long = word.len() > 17 && word.bytes().all(|byte| byte.is_ascii_digit());
            assert!(!is_undefined && !is_long, "`{word}` in {}", line.chars().take(300).collect::<String>());
        }
    }
}
