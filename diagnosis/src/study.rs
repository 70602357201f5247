//! A run with its analysis, over the same samples; and the next run, computed in small portions beside the present one.

use std::sync::Arc;

use kalmanscope_core::Tape;
use kalmanscope_core::internals::{Revision, Spare, numbers};
use kalmanscope_core::scenario::cost;
use kalmanscope_core::{Record, Run, RunError, Scenario, Source, Update};

use crate::analysis::AnalysisSubject;
use crate::{Analysis, Wanted};

/// Keep the memory of at most this many samples for the next edit; return the rest to the system.
const KEPT_SPARE: usize = 100_000;

/// The least window: a part of it is forgotten, and a part is kept.
const LEAST_WINDOW: usize = 4;

/// A quarter stays at the limit of a window: all that stays is moved, and analysed again, within one frame.
fn forgotten_of(window: usize) -> usize {
    window - window / 4
}

/// A run and its analysis, which make one picture. It can be extended, or replaced by one that a [`Job`] has computed beside it.
pub struct Study {
    run: Run,
    analysis: Analysis,
    spare: Spare,
    window: usize,
}

impl Study {
    /// A study before the first sample. At `window` samples of a simulated run it forgets the first three quarters of them.
    ///
    /// # Errors
    /// [`RunError`] where the scenario is impossible, or the source does not fit it.
    pub fn new(scenario: impl Into<Arc<Scenario>>, source: Source, window: usize) -> Result<Self, RunError> {
        let run = Run::from_source(scenario, source)?;
        Ok(Self { run, analysis: Analysis::default(), spare: Spare::default(), window: window.max(LEAST_WINDOW) })
    }

    /// The run.
    pub fn run(&self) -> &Run {
        &self.run
    }

    /// Its analysis.
    pub fn analysis(&self) -> &Analysis {
        &self.analysis
    }

    /// Takes in a live record that has more samples now, as [`Run::lengthen`] does, for [`Self::advance_to`] to continue.
    pub fn lengthen(&mut self, record: Arc<Record>) -> bool {
        self.run.lengthen(record)
    }

    /// Limits the samples of a simulated run that are kept from now on.
    pub fn keep(&mut self, window: usize) {
        self.window = window.max(LEAST_WINDOW);
    }

    /// Sets the results to compute from now on, in addition to the estimates.
    pub fn want(&mut self, wanted: Wanted) {
        self.analysis.want(wanted);
    }

    /// Puts off the diagnoses of new samples and [`Job`]s, or no longer: while a number is dragged, nobody can read them.
    pub fn put_off_diagnoses(&mut self, wait: bool) {
        self.analysis.waits = wait;
    }

    /// Whether diagnoses are put off. Once they no longer are, [`Self::advance_to`] makes them.
    pub fn puts_off_diagnoses(&self) -> bool {
        self.analysis.waits
    }

    /// Returns unused memory to the system until `while_time`, called after each piece, is false. Returns whether all is done.
    pub fn free(&mut self, while_time: &mut dyn FnMut() -> bool) -> bool {
        while self.analysis.waste.free_one() {
            if !while_time() {
                return false;
            }
        }
        true
    }

    /// Runs all filters side by side until `samples` samples, counted from the beginning, are done, and the analysis with them, or
    /// until `while_time`, called about every millisecond, is false. Returns whether everything is done.
    pub fn advance_to(&mut self, samples: usize, while_time: &mut dyn FnMut() -> bool) -> bool {
        if !self.free(while_time) {
            return false;
        }
        let Self { run, analysis, spare, window } = self;
        while spare.samples() > KEPT_SPARE && spare.free_one() {
            if !while_time() {
                return false;
            }
        }
        if !analysis.advance(&AnalysisSubject::of(run), while_time) {
            return false;
        }
        let scenario = run.scenario();
        let costs = scenario.filters.iter().map(|filter| filter.time_of_step(scenario));
        let chunk = cost::chunk(cost::OF_RECORD + costs.sum::<f64>());
        let is_measured = run.source().is_measured();
        while run.done() < samples.min(run.samples()) {
            let end = if is_measured { usize::MAX } else { run.record().forgotten().saturating_add(*window) };
            if run.done() >= end {
                run.forget(forgotten_of(*window));
                analysis.forget_before(run.record().forgotten());
                continue;
            }
            let goal = samples.min(run.done() + chunk).min(end);
            if !run.simulate(goal, while_time) {
                return false;
            }
            // Where one sample of all filters takes long, each filter is a piece of work.
            if chunk == 1 && !run.prepare(while_time) {
                return false;
            }
            run.advance_to(goal);
            if !analysis.advance(&AnalysisSubject::of(run), while_time) || !while_time() {
                break;
            }
        }
        run.done() >= samples.min(run.samples()) && analysis.advance(&AnalysisSubject::of(run), while_time)
    }
}

/// The next run of a study, after an edit of its scenario or with another source. The study stays as it is until the
/// job is [finished](Self::finish), so that a screen always shows one complete picture. The bits are the same however the work is divided.
///
/// ```
/// use kalmanscope_core::{Scenario, Source};
/// use kalmanscope_diagnosis::{Job, Study};
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let mut scenario = Scenario { duration: 10.0, ..Scenario::default() };
/// let mut study = Study::new(&scenario, Source::Simulated, 100_000)?;
/// study.advance_to(1001, &mut || true);
/// scenario.filters[0].fading = 1.01;
/// let mut job = Job::new(&mut study, &scenario, None, 1001)?;
/// while !job.advance(&study, &mut || false).is_done() {
///     // Draw a frame of `study` here.
/// }
/// job.finish(&mut study);
/// assert_eq!(study.run().scenario(), &scenario);
/// # Ok(())
/// # }
/// ```
pub struct Job {
    revision: Revision,
    analysis: Analysis,
    /// The number of samples to compute.
    pub goal: usize,
    stage: usize,
    done: bool,
}

/// The progress of a job.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Progress {
    /// The share of each filter that is done, from 0 to 1, in the scenario's order.
    pub filters: Vec<f64>,
    /// The estimated share of the total time that has passed, from 0 to 1.
    pub all: f64,
    done: bool,
}

impl Progress {
    /// Whether everything is done.
    pub fn is_done(&self) -> bool {
        self.done
    }
}

impl Job {
    /// The job of `samples` samples of another scenario, maybe of another source. Of a study as long it reuses what the change leaves.
    ///
    /// # Errors
    /// [`RunError`] where the scenario is impossible, or the source does not fit it.
    pub fn new(
        study: &mut Study,
        scenario: impl Into<Arc<Scenario>>,
        source: Option<Source>,
        samples: usize,
    ) -> Result<Self, RunError> {
        let Study { run, analysis, spare, window } = study;
        let source = source.or_else(|| (run.done() != samples.min(run.samples())).then(|| run.source()));
        let revision = Revision::new(run, &scenario.into(), source, spare)?;
        let goal = samples.min(revision.samples);
        let is_simulated =
            revision.own_record().is_some() && !revision.source().is_some_and(|source| source.is_measured());
        let stage = if is_simulated { goal.min(*window) } else { goal };
        Ok(Self { revision, analysis: analysis.successor(), goal, stage, done: false })
    }

    /// The scenario.
    pub fn scenario(&self) -> &Scenario {
        &self.revision.bank.scenario
    }

    /// The number of samples of the whole run.
    pub fn samples(&self) -> usize {
        self.revision.samples
    }

    /// Time between samples \[s\].
    pub fn dt(&self, study: &Study) -> f64 {
        self.revision.own_record().unwrap_or(study.run.record()).dt()
    }

    /// Computes until `while_time`, called about every millisecond, returns false: the record, then the filters from the cheapest to the
    /// costliest, then the analysis. `study` is the one that the job was made for.
    pub fn advance(&mut self, study: &Study, while_time: &mut dyn FnMut() -> bool) -> Progress {
        while !self.done {
            let record = study.run.record();
            if !self.revision.advance_to(self.stage, record, while_time) {
                break;
            }
            let Self { revision, analysis, goal, stage, .. } = self;
            if !analysis.advance(&subject(revision, study, *stage, *goal), while_time) {
                break;
            }
            self.done = self.stage >= self.goal.min(revision.samples);
            if !self.done {
                let forgotten = forgotten_of(study.window);
                revision.forget(forgotten);
                self.stage = (self.stage + forgotten).min(self.goal);
            }
        }
        self.progress(study)
    }

    /// The progress.
    pub fn progress(&self, study: &Study) -> Progress {
        let Self { revision, analysis, goal, stage, done } = self;
        let scenario = self.scenario();
        let goal = (*goal).min(revision.samples).max(1);
        let share = |samples: usize| (samples as f64 / goal as f64).min(1.0);
        let one = |place: usize| if revision.kept[place].is_some() { 1.0 } else { share(revision.done(place)) };
        let filters: Vec<f64> = numbers(scenario.filters.len(), &one);
        let (mut so_far, mut all) = analysis.work(&subject(revision, study, *stage, goal));
        if let Some(recorded) = revision.recorded() {
            so_far += share(recorded) * cost::OF_RECORD * goal as f64;
            all += cost::OF_RECORD * goal as f64;
        }
        for &place in &revision.order {
            let cost = goal as f64 * scenario.filters[place].time_of_step(scenario);
            so_far += filters[place] * cost;
            all += cost;
        }
        let all = if *done || all == 0.0 { 1.0 } else { (so_far / all).min(1.0) };
        Progress { filters, all, done: *done }
    }

    /// Replaces the study's run by the finished job's.
    pub fn finish(self, study: &mut Study) -> Update {
        let Self { revision, analysis, goal, .. } = self;
        let Study { run, analysis: old, spare, .. } = study;
        let update = revision.apply(run, goal, spare);
        old.replace(analysis, &update, run);
        update
    }

    /// Gives the job up; the study stays as it is and the memory is reused by the next job.
    pub fn cancel(self, study: &mut Study) {
        study.spare.take(self.revision.take_apart());
        study.analysis.recycle(self.analysis);
    }

    /// Leaves the changed filters that take longer than `seconds` to the caller, if all samples are kept. Returns their places.
    pub fn leave_long(&mut self, seconds: f64) -> Vec<usize> {
        let Self { revision, goal, stage, .. } = self;
        let is_whole = *goal == revision.samples && *stage == *goal;
        let scenario = &revision.bank.scenario;
        let time = |place: usize| 1e-9 * *goal as f64 * scenario.filters[place].time_of_step(scenario);
        let is_long = |place: &usize| is_whole && revision.done(*place) == 0 && time(*place) > seconds;
        let places: Vec<usize> = revision.order.iter().copied().filter(is_long).collect();
        revision.away.clone_from(&places);
        places
    }

    /// The whole record, once it is complete. `study` is the study that the job was made for.
    pub fn whole_record<'a>(&'a self, study: &'a Study) -> Option<&'a Record> {
        let revision = &self.revision;
        let is_there = revision.recorded().is_none_or(|recorded| recorded >= revision.samples);
        is_there.then(|| revision.own_record().unwrap_or(study.run.record()))
    }

    /// Takes in the next samples of a filter that was left to the caller. Returns false if they are not its own.
    pub fn take(&mut self, place: usize, tape: &Tape) -> bool {
        self.revision.take(place, tape)
    }

    /// Computes the filters that were left to the caller and are not complete, from their first sample on.
    pub fn take_back(&mut self) {
        self.revision.take_back();
    }
}

fn subject<'a>(revision: &'a Revision, study: &'a Study, stage: usize, goal: usize) -> AnalysisSubject<'a> {
    let done = stage.min(revision.samples);
    let record = revision.own_record().unwrap_or(study.run.record());
    let bounds = if revision.is_of_everything { &[][..] } else { &study.analysis.bounds };
    let is_live = revision.is_live().unwrap_or(study.run.is_live());
    let whole = done >= goal.min(revision.samples) && done == revision.samples && !is_live;
    AnalysisSubject { bank: &revision.bank, record, done, whole, known: &revision.kept, bounds }
}
