//! The results of each filter of a run.

use std::sync::Arc;
use std::time::{Duration, Instant};

use kalmanscope_core::Length;
use kalmanscope_core::diagnosis::Remedy;
use kalmanscope_core::{
    Analysis, Channel, CramerRao, Diagnosis, Estimates, ModelClasses, Record, Remark, Run, RunError, Scenario, Summary,
    TruthStop, VerdictKind,
};

use crate::free_run::{FreeRuns, fits};

/// The results of all filters of a run, without their histories.
pub struct Results<'a> {
    /// The scenario with an id and a name for each filter.
    pub(crate) scenario: Scenario,
    pub(crate) record: &'a Record,
    pub(crate) truth_stop: Option<TruthStop>,
    pub(crate) filters: Vec<FilterResults>,
    pub(crate) smoothers: Vec<Summary>,
    pub(crate) free_runs: Vec<FreeRuns>,
}

pub(crate) struct FilterResults {
    pub(crate) summary: Summary,
    pub(crate) diagnosis: Option<Diagnosis>,
    pub(crate) causes: Vec<Remedy>,
    /// σ over its Cramér-Rao bound at the last sample, for the channels that have one.
    pub(crate) over_bound: Vec<(Channel, f64)>,
    pub(crate) remarks: Vec<Remark>,
    /// Time per step \[ns\], where it was measured.
    pub(crate) step_time: Option<f64>,
}

impl<'a> Results<'a> {
    /// The results of a finished run. `causes` are those of [`crate::causes()`], one list per filter, or empty to leave
    /// them out. Bounds are included if the analysis has them.
    pub fn of_run(run: &'a Run, analysis: &Analysis, mut causes: Vec<Vec<Remedy>>) -> Self {
        let record = run.record();
        causes.resize_with(run.estimates().len(), Vec::new);
        let filters = run.estimates().iter().zip(analysis.diagnostics()).zip(causes).enumerate();
        let filters = filters.map(|(place, ((estimates, diagnostics), causes))| {
            let diagnosis = analysis.diagnosis(place);
            FilterResults {
                summary: Summary::of(diagnostics, diagnosis, estimates, record),
                diagnosis: diagnosis.cloned(),
                causes,
                over_bound: analysis.bound(estimates.id()).map_or_else(Vec::new, |bound| over_bound(estimates, bound)),
                remarks: estimates.remarks().to_vec(),
                step_time: None,
            }
        });
        Self {
            filters: filters.collect(),
            smoothers: analysis.smoothed().iter().map(|smoothed| Summary::new(smoothed, record)).collect(),
            ..Self::empty(run.scenario().clone(), run)
        }
    }

    pub(crate) fn empty(scenario: Scenario, run: &'a Run) -> Self {
        Self {
            scenario,
            record: run.record(),
            truth_stop: run.truth_stop(),
            filters: Vec::new(),
            smoothers: Vec::new(),
            free_runs: Vec::new(),
        }
    }

    /// The same with the free runs of the final models over some records, each with its name.
    #[must_use]
    pub fn with_free_runs(mut self, run: &Run, records: &[(&str, &Record)]) -> Self {
        let of = |(name, record): &(&str, &Record)| FreeRuns { fits: fits(run, record), ..FreeRuns::new(name, record) };
        self.free_runs = records.iter().map(of).collect();
        self
    }

    /// The same with the time per step of each filter, measured now by running it alone over the beginning of the record.
    ///
    /// # Errors
    /// [`RunError`] where these are not the results of the scenario.
    pub fn timed(mut self, scenario: &Scenario) -> Result<Self, RunError> {
        let samples: Vec<usize> = self.filters.iter().map(|filter| filter.summary.samples).collect();
        let times = step_times(scenario, self.record, &samples)?;
        for (filter, time) in self.filters.iter_mut().zip(times) {
            filter.step_time = time;
        }
        Ok(self)
    }

    /// The probability of each filter as a model class; none of a single one.
    pub(crate) fn probabilities(&self) -> Vec<f64> {
        if self.filters.len() < 2 {
            return Vec::new();
        }
        let evidence = self.filters.iter().map(|filter| filter.summary.log_evidence());
        ModelClasses::new(evidence).probabilities().to_vec()
    }

    /// The name of each filter, and the kind of its verdict if there is one.
    pub fn verdicts(&self) -> impl Iterator<Item = (&str, Option<VerdictKind>)> {
        let of = |one: &Summary| one.verdict.as_ref().map(|verdict| verdict.kind);
        self.filters.iter().map(move |filter| (filter.summary.name.as_str(), of(&filter.summary)))
    }

    /// The causes of each filter's verdict, the likeliest first.
    pub fn causes(&self) -> impl Iterator<Item = &[Remedy]> {
        self.filters.iter().map(|filter| filter.causes.as_slice())
    }

    pub(crate) fn length(&self) -> Length {
        Length::of(self.scenario.record.as_ref())
    }

    /// Whether a filter has stopped before the end of the record.
    pub fn any_stopped(&self) -> bool {
        self.filters.iter().any(|filter| filter.summary.stop.is_some())
    }

    /// The free runs as text.
    pub fn free_runs(&self) -> String {
        let words = |runs: &FreeRuns| {
            let lines: String = runs.lines(self.length()).map(|line| format!("  {line}\n")).collect();
            format!("\nfree run of the final models over {}: {} samples\n{lines}", runs.name, runs.samples)
        };
        self.free_runs.iter().map(words).collect()
    }
}

pub(crate) fn over_bound(estimates: &Estimates, bound: &CramerRao) -> Vec<(Channel, f64)> {
    let Some(last) = estimates.len().min(bound.len()).checked_sub(1) else { return Vec::new() };
    let ratio = |(place, &channel): (usize, &Channel)| {
        let floor = bound.std(last, bound.place(channel)?);
        (floor > 0.0).then(|| (channel, estimates.std(last, place) / floor))
    };
    estimates.channels().iter().enumerate().filter_map(ratio).collect()
}

/// Limits the repetitions of a filter, together with [`PATIENCE`]; the shortest time counts.
const REPEATS: usize = 7;
const PATIENCE: Duration = Duration::from_millis(500);
const MOST: usize = 100_000;

/// Time per step of each filter \[ns\], measured by running it alone over the beginning of a record, as many samples as it has done;
/// `None` for a filter without a step.
fn step_times(scenario: &Scenario, record: &Record, samples: &[usize]) -> Result<Vec<Option<f64>>, RunError> {
    let record = Arc::new(record.part(0..record.len().min(MOST)));
    let mut times = Vec::new();
    for (filter, &samples) in scenario.filters.iter().zip(samples) {
        let samples = samples.min(record.len());
        if samples < 2 {
            times.push(None);
            continue;
        }
        let alone = Scenario { filters: vec![filter.clone()], ..scenario.clone() };
        let started = Instant::now();
        let mut best = Duration::MAX;
        for _ in 0..REPEATS {
            let mut run = Run::on_record(&alone, Arc::clone(&record))?;
            let begin = Instant::now();
            run.advance_to(samples);
            best = best.min(begin.elapsed());
            if started.elapsed() > PATIENCE {
                break;
            }
        }
        times.push(Some(best.as_secs_f64() * 1e9 / (samples - 1) as f64));
    }
    Ok(times)
}
