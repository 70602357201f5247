//! A scenario, its run, and the position of playback.

mod before;
mod computing;
mod diagnosing;
mod free_runs;
mod library;
mod live;
mod long_filters;
mod playback;
mod spectrogram;
#[cfg(test)]
mod tests;
mod trials;

use std::collections::BTreeSet;
use std::rc::Rc;
use std::sync::Arc;

use diagnosing::{Hand, LiveVerdicts};
use free_runs::FreeRuns;
use kalmanscope_core::{Diagnostics, Estimates, Evidence, Quantity, Run, RunError, Scenario, Source};
use kalmanscope_diagnosis::{Hindsight, Job, Study};
use long_filters::LongFilters;
use serde::{Deserialize, Serialize};
use spectrogram::Spectrograms;
use trials::Trials;

use crate::team::{Frames, Team};

pub use crate::team::Budget;
pub use before::{Before, Version};
pub use free_runs::ModelTime;
pub use kalmanscope_diagnosis::{Bound, Wanted};
pub(crate) use library::is_same;
pub use library::{Library, RecordFile, name_of};
pub use trials::Attempt;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Mode {
    #[default]
    Live,
    Whole,
}

/// The scenario on screen with all its results.
///
/// The same engine serves both modes: live, the run is stepped to playback's time; whole, to its end. A change of the
/// scenario is computed beside the picture on screen, a slice of a frame after the other, and replaces it once it is
/// complete: the picture always follows from one scenario, that of its run.
///
/// Live, a record may be of any length: at most [`Self::KEPT`] samples are kept, chosen by the position of the run.
/// Samples are counted from the start, except for [`Self::index`] and all indices of the run's record.
pub struct Session {
    scenario: Arc<Scenario>,
    /// Stands for the opening since which only [`Self::edit`] has changed the scenario.
    opening: Arc<()>,
    changed: BTreeSet<String>,
    study: Study,
    job: Option<Job>,
    team: Rc<dyn Team>,
    long: LongFilters,
    slices: usize,
    waiting: bool,
    is_opened: bool,
    complete: bool,
    budget: Budget,
    wanted: Wanted,
    wanted_mode: Mode,
    can_be_whole: bool,
    playing: bool,
    speed: f64,
    clock: f64,
    generation: u64,
    problem: Option<String>,
    judged: LiveVerdicts,
    before: Option<Before>,
    other: Option<Version>,
    since_edit: f64,
    hand: Hand,
    trials: Trials,
    library: Library,
    free: FreeRuns,
    spectrograms: Spectrograms,
    /// Counts changes of the picture other than those of the run.
    drawn: u64,
}

impl Session {
    pub const SPEEDS: [f64; 7] = [0.1, 0.25, 0.5, 1.0, 2.0, 5.0, 10.0];

    pub const DEFAULT_SPEED: f64 = 2.0;

    /// Live mode keeps at most this many samples; then it forgets the first three quarters of them.
    pub const KEPT: usize = 100_000;

    /// A whole record is at most this many times dt long: a browser recomputes it in an instant, and keeps it in about 70 MB a
    /// filter.
    pub const LONGEST_WHOLE: usize = 200_000;

    pub fn new(scenario: Scenario) -> Result<Self, RunError> {
        Self::with_budget(scenario, Budget::Unlimited)
    }

    /// A session at the start of the scenario, playing, that computes no more at once than its budget.
    pub fn with_budget(mut scenario: Scenario, budget: Budget) -> Result<Self, RunError> {
        scenario.number_filters();
        scenario.keep_draws();
        let mut library = Library::default();
        let (source, problem) = match library.source(&scenario) {
            Ok(source) => (source, None),
            // A simulation is shown until the file comes.
            Err(reason) => (Source::Simulated, Some(reason)),
        };
        let study = Study::new(&scenario, source, Self::KEPT)?;
        let mut session = Self {
            can_be_whole: study.run().samples() <= Self::LONGEST_WHOLE + 1,
            job: None,
            team: Rc::new(Frames::FRAME),
            long: LongFilters::default(),
            slices: 0,
            waiting: false,
            is_opened: false,
            complete: false,
            budget,
            scenario: study.run().shared_scenario(),
            opening: Arc::default(),
            study,
            changed: BTreeSet::new(),
            wanted: Wanted::default(),
            wanted_mode: Mode::Live,
            playing: true,
            speed: Self::DEFAULT_SPEED,
            clock: 0.0,
            generation: 0,
            problem,
            judged: LiveVerdicts::default(),
            before: None,
            other: None,
            since_edit: f64::INFINITY,
            hand: Hand::default(),
            trials: Trials::default(),
            library,
            free: FreeRuns::default(),
            spectrograms: Spectrograms::default(),
            drawn: 0,
        };
        session.want_of_study();
        session.compute();
        Ok(session)
    }

    pub fn set_budget(&mut self, budget: Budget) {
        self.budget = budget;
    }

    pub(crate) fn budget(&self) -> Budget {
        self.budget
    }

    pub fn scenario(&self) -> &Scenario {
        &self.scenario
    }

    pub(crate) fn shared_scenario(&self) -> &Arc<Scenario> {
        &self.scenario
    }

    pub fn run(&self) -> &Run {
        self.study.run()
    }

    /// Changes whenever the sample at an index becomes another one: results from earlier samples are then invalid.
    pub fn generation(&self) -> u64 {
        self.generation
    }

    pub fn drawn(&self) -> u64 {
        self.drawn
    }

    pub fn diagnostics(&self) -> &[Diagnostics] {
        self.study.analysis().diagnostics()
    }

    pub fn evidence(&self) -> &[Evidence] {
        self.study.analysis().evidence()
    }

    /// The Cramér-Rao bounds, if they are wanted: filters that know as much at first share one.
    pub fn bounds(&self) -> &[Bound] {
        self.study.analysis().bounds()
    }

    pub fn want(&mut self, wanted: Wanted) {
        let before = std::mem::replace(&mut self.wanted, wanted);
        if wanted == before {
            return;
        }
        self.want_of_study();
        if wanted.bounds && !before.bounds && self.run().record().forgotten() > 0 {
            // They begin where the filters began.
            self.begin_again();
        }
        self.complete = false;
        self.compute();
    }

    fn want_of_study(&mut self) {
        let smoothed = if self.mode() == Mode::Whole { Hindsight::All } else { Hindsight::Lagged };
        self.study.want(Wanted { smoothed, ..self.wanted });
    }

    pub fn smoothed(&self) -> &[Estimates] {
        self.study.analysis().smoothed()
    }

    /// The quantities that the run's filters use, in the order of their innovations; a record may have more of them.
    pub fn sensors(&self) -> Vec<Quantity> {
        self.run().scenario().sensors.iter().map(|sensor| sensor.measures).collect()
    }

    pub fn mode(&self) -> Mode {
        if self.can_be_whole { self.wanted_mode } else { Mode::Live }
    }

    pub fn can_be_whole(&self) -> bool {
        self.can_be_whole
    }

    pub fn problem(&self) -> Option<&str> {
        self.problem.as_deref()
    }

    pub(crate) fn missing_record(&self) -> Option<&str> {
        self.problem.as_ref().and_then(|_| self.library.missing(&self.scenario))
    }

    pub(crate) fn shows_another_run(&self) -> bool {
        let shown = self.run().scenario();
        let is_other = shown.record != self.scenario.record || shown.plant.kind != self.scenario.plant.kind;
        self.job.is_some() && (self.is_opened || is_other)
    }

    pub fn library(&self) -> &Library {
        &self.library
    }

    pub fn keep_file(&mut self, file: Arc<RecordFile>) {
        self.library.insert(file);
        if self.scenario.record.is_some() && self.problem.is_some() {
            self.edited();
            self.compute();
        }
    }

    /// Keeps a file as the record on which the identified models are tested.
    ///
    /// # Errors
    /// A sentence if there is no measured record on screen, or the columns have other meanings.
    pub fn hold_out(&mut self, file: &RecordFile) -> Result<(), String> {
        self.library.hold_out(file, &self.scenario)?;
        self.drawn += 1;
        self.free.forget();
        Ok(())
    }

    pub fn explain(&mut self, reasons: Vec<String>, problem: Option<String>) {
        (self.library.reasons, self.library.problem) = (reasons, problem);
    }

    pub fn is_measured(&self) -> bool {
        self.run().source().is_measured()
    }

    pub fn set_mode(&mut self, mode: Mode) {
        self.wanted_mode = mode;
        self.want_of_study();
        self.go_back();
        self.compute();
    }

    pub fn set_scenario(&mut self, scenario: Scenario) {
        self.show(Version::opened(scenario));
    }

    fn show(&mut self, version: Version) {
        (self.scenario, self.opening) = (version.scenario, version.opening);
        self.edited();
        self.want_of_study();
        self.compute();
    }
}
