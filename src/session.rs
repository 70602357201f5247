//! A scenario and its run, and where playback stands in it.

mod analysis;
mod playback;
#[cfg(test)]
mod tests;

use kalmanscope_core::{Diagnostics, Estimates, Quantity, Run, RunError, Scenario, Update};
use serde::{Deserialize, Serialize};

use analysis::Analysis;
pub use analysis::{Bound, Wanted};

/// The part of the record that is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Mode {
    /// The record grows as time goes on.
    #[default]
    Live,
    /// All of it, at once.
    Whole,
}

/// The scenario on screen with everything that follows from it.
///
/// The same engine serves both modes: live, the run is stepped to where playback stands; whole, to its end. A change of
/// the scenario starts the run anew and takes it to the same place, so that what is shown always follows from the
/// scenario alone.
///
/// Live, a record may be of any length: no more than [`Self::KEPT`] samples are kept, and which ones follows from where the
/// run stands. Samples are counted from the start, but for [`Self::index`] and all indices of the run's record.
pub struct Session {
    scenario: Scenario,
    run: Run,
    analysis: Analysis,
    wanted: Mode,
    can_be_whole: bool,
    playing: bool,
    speed: f64,
    clock: f64,
    generation: u64,
    problem: Option<String>,
}

/// The run takes at most this many samples at once, so that no frame freezes.
const PORTION: usize = 20_000;

impl Session {
    /// Simulated seconds per second that playback can have.
    pub const SPEEDS: [f64; 7] = [0.1, 0.25, 0.5, 1.0, 2.0, 5.0, 10.0];

    /// The speed at first: brisk enough to see a change half-way through a minute without waiting for it.
    pub const DEFAULT_SPEED: f64 = 2.0;

    /// Live mode keeps at most this many samples; then it forgets the first half of them.
    pub const KEPT: usize = 100_000;

    /// A whole record is at most this many times dt long: a browser recomputes it in an instant, and keeps it in about 70 MB a
    /// filter.
    pub const LONGEST_WHOLE: usize = 200_000;

    /// A session at the start of the scenario, playing.
    ///
    /// # Errors
    /// [`RunError`] where the scenario is impossible.
    pub fn new(mut scenario: Scenario) -> Result<Self, RunError> {
        scenario.number_filters();
        let run = Run::new(&scenario)?;
        let mut session = Self {
            can_be_whole: run.samples() <= Self::LONGEST_WHOLE + 1,
            run,
            analysis: Analysis::default(),
            scenario,
            wanted: Mode::Live,
            playing: true,
            speed: Self::DEFAULT_SPEED,
            clock: 0.0,
            generation: 0,
            problem: None,
        };
        session.catch_up();
        Ok(session)
    }

    /// The scenario on screen.
    pub fn scenario(&self) -> &Scenario {
        &self.scenario
    }

    /// Its run, as far as it is shown and kept.
    pub fn run(&self) -> &Run {
        &self.run
    }

    /// A number that changes whenever the sample at an index becomes another one: with a new run, and when samples have been
    /// forgotten. What has been computed from samples before is worth nothing then.
    pub fn generation(&self) -> u64 {
        self.generation
    }

    /// The diagnostics of the estimates that are kept, one a filter, if they are wanted.
    pub fn diagnostics(&self) -> &[Diagnostics] {
        self.analysis.diagnostics()
    }

    /// The Cramér-Rao bounds, if they are wanted: filters that know as much at first share one.
    pub fn bounds(&self) -> &[Bound] {
        self.analysis.bounds()
    }

    /// Says what is to be computed beside the estimates.
    pub fn want(&mut self, wanted: Wanted) {
        let before = self.analysis.wanted();
        if wanted == before {
            return;
        }
        self.analysis.want(wanted);
        if wanted.bounds && !before.bounds && self.run.record().forgotten() > 0 {
            // They begin where the filters began.
            self.start_anew();
            self.catch_up();
        } else {
            self.follow();
        }
    }

    /// The estimates with hindsight of the whole record, of the filters that have a smoother.
    pub fn smoothed(&self) -> &[Estimates] {
        self.analysis.smoothed()
    }

    /// The quantities that the run's sensors measure.
    pub fn sensors(&self) -> Vec<Quantity> {
        self.run.record().sensors().to_vec()
    }

    /// What is shown of the record. One that is too long to be shown as a whole is live, whatever is wanted.
    pub fn mode(&self) -> Mode {
        if self.can_be_whole { self.wanted } else { Mode::Live }
    }

    /// Whether the record is short enough to be shown as a whole.
    pub fn can_be_whole(&self) -> bool {
        self.can_be_whole
    }

    /// Why the scenario as edited cannot be run, if so; the last one that could stays on screen.
    pub fn problem(&self) -> Option<&str> {
        self.problem.as_deref()
    }

    /// Whether the run has yet to come to where playback stands. Playback waits for it, and every [`Self::advance`] brings
    /// it nearer.
    pub fn behind(&self) -> bool {
        self.run.done() < (self.position() + 1).min(self.run.samples())
    }

    /// Shows the record as it grows, or all of it, as soon as it is short enough for that.
    pub fn set_mode(&mut self, mode: Mode) {
        self.wanted = mode;
        self.go_back();
        self.catch_up();
    }

    /// Takes over an edited scenario and recomputes what is shown. An impossible one is kept for editing, while the run
    /// stays that of the last possible one.
    pub fn set_scenario(&mut self, mut scenario: Scenario) {
        scenario.number_filters();
        self.scenario = scenario;
        self.generation += 1;
        let result = self.run.update(&self.scenario);
        match &result {
            Ok(Update::Everything) => self.analysis.begin_anew(),
            Ok(Update::Filters(ids)) => self.analysis.begin_filters_anew(ids),
            Err(_) => {}
        }
        self.note_outcome(result.err());
        self.clock = self.clock.min(self.end());
        self.catch_up();
    }

    fn start_anew(&mut self) {
        self.generation += 1;
        self.analysis.begin_anew();
        let result = self.run.restart(&self.scenario);
        self.note_outcome(result.err());
    }

    /// Notes why a new scenario cannot be run, if so, and else how long its record is.
    fn note_outcome(&mut self, problem: Option<RunError>) {
        self.problem = problem.map(|error| error.to_string());
        if self.problem.is_none() {
            self.can_be_whole = self.run.samples() <= Self::LONGEST_WHOLE + 1;
        }
    }

    /// Starts anew where the run has samples that are not to be shown, or has forgotten some that are.
    fn go_back(&mut self) {
        let back = match self.mode() {
            Mode::Live => self.run.done() > self.position() + 1,
            Mode::Whole => self.run.record().forgotten() > 0,
        };
        if back {
            self.start_anew();
        }
    }

    fn catch_up(&mut self) {
        match self.mode() {
            Mode::Live => {
                let goal = (self.position() + 1).min(self.run.done() + PORTION);
                while goal > self.run.record().forgotten() + Self::KEPT && self.run.forget(Self::KEPT / 2) {
                    self.generation += 1;
                }
                self.run.advance_to(goal);
            }
            Mode::Whole => self.run.finish(),
        }
        self.follow();
    }

    /// Takes in what is new of the run, before any of it is forgotten.
    fn follow(&mut self) {
        let whole = self.mode() == Mode::Whole && self.run.done() == self.run.samples();
        let Self { scenario, run, analysis, problem, .. } = self;
        // The run of an impossible scenario is that of the last possible one, whose settings are gone.
        analysis.follow(Some(&*scenario).filter(|_| problem.is_none()), run, whole);
    }
}
