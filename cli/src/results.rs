//! The results of each filter of a run.

use std::borrow::Cow;

use kalmanscope_core::{Channel, CramerRao, Estimates, Length, ModelClasses, Record, Remark, Run, Scenario, TruthStop};
use kalmanscope_diagnosis::Remedy;
use kalmanscope_diagnosis::{Analysis, Diagnosis, Story, Summary, VerdictKind};

use crate::free_run::{FreeRunResults, fits};

/// The results of all filters of a run, without their histories.
pub struct Results<'a> {
    /// The scenario with an id and a name for each filter.
    pub(crate) scenario: Scenario,
    pub(crate) record: Cow<'a, Record>,
    pub(crate) truth_stop: Option<TruthStop>,
    /// The run in a few sentences; empty without histories.
    pub(crate) story: String,
    pub(crate) filters: Vec<FilterResults>,
    pub(crate) smoothers: Vec<Summary>,
    pub(crate) free_runs: Vec<FreeRunResults>,
    pub(crate) command: String,
}

pub(crate) struct FilterResults {
    pub(crate) summary: Summary,
    pub(crate) diagnosis: Option<Diagnosis>,
    pub(crate) causes: Vec<Remedy>,
    /// σ over its Cramér-Rao bound at the last sample, for the channels that have one.
    pub(crate) over_bound: Vec<(Channel, f64)>,
    pub(crate) remarks: Vec<Remark>,
}

impl<'a> Results<'a> {
    /// The results of a finished run. `causes` are those of [`crate::causes()`], one list per filter, or empty to leave
    /// them out. Bounds are included if the analysis has them.
    pub fn of_run(run: &'a Run, analysis: &Analysis, mut causes: Vec<Vec<Remedy>>) -> Self {
        let record = run.record();
        let diagnoses: Vec<Option<&Diagnosis>> =
            (0..run.estimates().len()).map(|place| analysis.diagnosis(place)).collect();
        causes.resize_with(run.estimates().len(), Vec::new);
        let filters = run.estimates().iter().zip(analysis.diagnostics()).zip(causes).enumerate();
        let filters = filters.map(|(place, ((estimates, diagnostics), causes))| {
            let diagnosis = diagnoses[place];
            FilterResults {
                summary: Summary::of(diagnostics, diagnosis, estimates, record),
                diagnosis: diagnosis.cloned(),
                causes,
                over_bound: analysis.bound(estimates.id()).map_or_else(Vec::new, |bound| over_bound(estimates, bound)),
                remarks: estimates.remarks().to_vec(),
            }
        });
        Self {
            filters: filters.collect(),
            story: Story::of(run, analysis.diagnostics(), &diagnoses).to_string(),
            smoothers: analysis.smoothed().iter().map(|smoothed| Summary::new(smoothed, record)).collect(),
            ..Self::empty(run.scenario().clone(), run)
        }
    }

    pub(crate) fn empty(scenario: Scenario, run: &'a Run) -> Self {
        Self {
            scenario,
            record: Cow::Borrowed(run.record()),
            truth_stop: run.truth_stop(),
            story: String::new(),
            filters: Vec::new(),
            smoothers: Vec::new(),
            free_runs: Vec::new(),
            command: "kalmanscope-cli run SCENARIO.toml".to_owned(),
        }
    }

    /// The same with the free runs of the final models over some records, each with its name.
    #[must_use]
    pub fn with_free_runs(mut self, run: &Run, records: &[(&str, &Record)]) -> Self {
        let of = |(name, record): &(&str, &Record)| FreeRunResults {
            fits: fits(run, record),
            ..FreeRunResults::new(name, record, run.record())
        };
        self.free_runs = records.iter().map(of).collect();
        self
    }

    /// The same with the command that has run it, which the remedies name.
    #[must_use]
    pub fn by(self, command: String) -> Self {
        Self { command, ..self }
    }

    /// The same with its own copy of the record.
    #[must_use]
    pub fn into_owned(self) -> Results<'static> {
        let Self { scenario, record, truth_stop, story, filters, smoothers, free_runs, command } = self;
        let record = Cow::Owned(record.into_owned());
        Results { scenario, record, truth_stop, story, filters, smoothers, free_runs, command }
    }

    /// The probability of each filter as a model class; none of a single one.
    pub(crate) fn probabilities(&self) -> Vec<f64> {
        if self.filters.len() < 2 {
            return Vec::new();
        }
        let evidence = self.filters.iter().map(|filter| filter.summary.log_evidence());
        ModelClasses::new(evidence).probabilities
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
}

pub(crate) fn over_bound(estimates: &Estimates, bound: &CramerRao) -> Vec<(Channel, f64)> {
    let Some(last) = estimates.len().min(bound.len()).checked_sub(1) else { return Vec::new() };
    let ratio = |(place, &channel): (usize, &Channel)| {
        let floor = bound.std(last, bound.place(channel)?);
        (floor > 0.0).then(|| (channel, estimates.std(last, place) / floor))
    };
    estimates.channels().iter().enumerate().filter_map(ratio).collect()
}
