//! A scenario and its run, and where playback stands in it.

use kalmanscope_core::{CramerRao, Diagnostics, Estimates, Quantity, Run, RunError, Scenario};
use serde::{Deserialize, Serialize};

/// What is shown of the record.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Mode {
    /// The record grows as time goes on.
    #[default]
    Live,
    /// All of it, at once.
    Whole,
}

/// A Cramér-Rao bound and the places of the filters that it is for.
pub struct Bound {
    /// The bound.
    pub bound: CramerRao,
    /// The filters' places in the scenario.
    pub places: Vec<usize>,
}

/// The scenario on screen with everything that follows from it.
///
/// The same engine serves both modes: live, the run is stepped to where playback stands; whole, to its end. A change of
/// the scenario starts the run anew and takes it to the same place, so that what is shown always follows from the
/// scenario alone.
pub struct Session {
    scenario: Scenario,
    run: Run,
    diagnostics: Vec<Diagnostics>,
    /// Whether the diagnostics are still those of an earlier run.
    fresh: bool,
    bounds: Vec<Bound>,
    with_bounds: bool,
    smoothed: Vec<(usize, Estimates)>,
    mode: Mode,
    playing: bool,
    speed: f64,
    clock: f64,
    generation: u64,
    problem: Option<String>,
}

impl Session {
    /// Simulated seconds per second that playback can have.
    pub const SPEEDS: [f64; 7] = [0.1, 0.25, 0.5, 1.0, 2.0, 5.0, 10.0];

    /// The speed at first: brisk enough to see a change half-way through a minute without waiting for it.
    pub const DEFAULT_SPEED: f64 = 2.0;

    /// A session at the start of the scenario, playing.
    ///
    /// # Errors
    /// [`RunError`] where the scenario is impossible.
    pub fn new(scenario: Scenario) -> Result<Self, RunError> {
        let mut session = Self {
            run: Run::new(&scenario)?,
            diagnostics: Vec::new(),
            fresh: true,
            bounds: Vec::new(),
            with_bounds: false,
            smoothed: Vec::new(),
            scenario,
            mode: Mode::Live,
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

    /// Its run, as far as it is shown.
    pub fn run(&self) -> &Run {
        &self.run
    }

    /// A number that changes whenever samples that were there before have other values, or other numbers.
    pub fn generation(&self) -> u64 {
        self.generation
    }

    /// What the estimates are worth, one a filter.
    pub fn diagnostics(&self) -> &[Diagnostics] {
        &self.diagnostics
    }

    /// The Cramér-Rao bounds, if they are wanted: filters that know as much at first share one.
    pub fn bounds(&self) -> &[Bound] {
        &self.bounds
    }

    /// Whether the Cramér-Rao bounds are to be computed: they cost as much as a filter.
    pub fn want_bounds(&mut self, wanted: bool) {
        if self.with_bounds != wanted {
            self.with_bounds = wanted;
            self.bounds.clear();
            self.catch_up();
        }
    }

    /// The estimates with hindsight of the whole record, with the places of their filters: of those that have a smoother.
    pub fn smoothed(&self) -> &[(usize, Estimates)] {
        &self.smoothed
    }

    /// What the run's sensors measure.
    pub fn sensors(&self) -> Vec<Quantity> {
        self.run.record().sensors().to_vec()
    }

    /// What is shown of the record.
    pub fn mode(&self) -> Mode {
        self.mode
    }

    /// Whether time goes on.
    pub fn playing(&self) -> bool {
        self.playing
    }

    /// Simulated seconds per second.
    pub fn speed(&self) -> f64 {
        self.speed
    }

    /// The next of [`Self::SPEEDS`] that is faster, or slower; the present one at the end of them.
    pub fn next_speed(&self, faster: bool) -> f64 {
        let mut speeds = Self::SPEEDS.into_iter();
        let next = if faster { speeds.find(|s| *s > self.speed) } else { speeds.rfind(|s| *s < self.speed) };
        next.unwrap_or(self.speed)
    }

    /// Why the scenario as edited cannot be run, if so; the last one that could stays on screen.
    pub fn problem(&self) -> Option<&str> {
        self.problem.as_deref()
    }

    /// The last sample's time after the start \[s\].
    pub fn end(&self) -> f64 {
        (self.run.samples() - 1) as f64 * self.run.record().dt()
    }

    /// The sample at which playback stands.
    pub fn position(&self) -> usize {
        // A clock that has been set to k dt must give k, whatever the rounding.
        ((self.clock / self.run.record().dt() + 1e-6) as usize).min(self.run.samples() - 1)
    }

    /// The time of [`Self::position`] \[s\].
    pub fn time(&self) -> f64 {
        self.run.record().time(self.position())
    }

    /// Lets `elapsed` seconds of real time pass.
    pub fn advance(&mut self, elapsed: f64) {
        if self.playing {
            self.clock += elapsed * self.speed;
            if self.clock >= self.end() {
                self.clock = self.end();
                self.playing = false;
            }
            self.catch_up();
        }
    }

    /// Plays or pauses; at the end, plays from the start.
    pub fn toggle_play(&mut self) {
        if !self.playing && self.clock >= self.end() {
            self.play_from_start();
        } else {
            self.playing = !self.playing;
        }
    }

    /// Plays from the first sample.
    pub fn play_from_start(&mut self) {
        self.seek(0.0);
        self.playing = true;
    }

    /// Pauses and goes one sample forward.
    pub fn step(&mut self) {
        self.playing = false;
        let next = (self.position() + 1) as f64 * self.run.record().dt();
        self.seek(next);
    }

    /// Pauses and goes one sample back.
    pub fn step_back(&mut self) {
        self.playing = false;
        let before = self.position().saturating_sub(1) as f64 * self.run.record().dt();
        self.seek(before);
    }

    /// Goes to a time after the start \[s\].
    pub fn seek(&mut self, time: f64) {
        self.clock = time.clamp(0.0, self.end());
        if self.mode == Mode::Live && self.run.len() > self.position() + 1 {
            self.start_anew();
        }
        self.catch_up();
    }

    /// Shows the record as it grows, or all of it.
    pub fn set_mode(&mut self, mode: Mode) {
        self.mode = mode;
        if mode == Mode::Live && self.run.len() > self.position() + 1 {
            self.start_anew();
        }
        self.catch_up();
    }

    /// Sets the simulated seconds per second; what is no positive number leaves them as they are.
    pub fn set_speed(&mut self, speed: f64) {
        if speed.is_finite() && speed > 0.0 {
            self.speed = speed;
        }
    }

    /// Takes over an edited scenario and recomputes what is shown. An impossible one is kept for editing, while the run
    /// stays that of the last possible one.
    pub fn set_scenario(&mut self, scenario: Scenario) {
        self.scenario = scenario;
        self.start_anew();
        self.clock = self.clock.min(self.end());
        self.catch_up();
    }

    fn start_anew(&mut self) {
        self.generation += 1;
        self.fresh = true;
        self.smoothed.clear();
        self.bounds.clear();
        self.problem = self.run.restart(&self.scenario).err().map(|error| error.to_string());
    }

    fn catch_up(&mut self) {
        match self.mode {
            Mode::Live => self.run.advance_to(self.position() + 1),
            Mode::Whole => self.run.finish(),
        }
        let Self { scenario, run, diagnostics, fresh, bounds, with_bounds, smoothed, mode, problem, .. } = self;
        let record = run.record();
        if *fresh {
            diagnostics.resize_with(run.estimates().len(), Diagnostics::default);
            for (diagnostics, estimates) in diagnostics.iter_mut().zip(run.estimates()) {
                diagnostics.restart(estimates, record);
            }
            *fresh = false;
        }
        for (diagnostics, estimates) in diagnostics.iter_mut().zip(run.estimates()) {
            diagnostics.follow(estimates, record);
        }
        match mode {
            Mode::Live => smoothed.clear(),
            Mode::Whole if smoothed.is_empty() && problem.is_none() => {
                let with = scenario.filters.iter().enumerate().filter(|(_, filter)| filter.smoother);
                *smoothed = with.map(|(place, _)| place).zip(run.smoothed()).collect();
            }
            Mode::Whole => {}
        }
        // The run of an impossible scenario is that of the last possible one, which has no bounds to be made from.
        if *with_bounds && problem.is_none() {
            if bounds.is_empty() {
                *bounds = bounds_of(scenario, record.dt());
            }
            for Bound { bound, .. } in bounds {
                bound.follow(record);
            }
        }
    }
}

/// The bounds of a scenario's filters, before the first sample.
fn bounds_of(scenario: &Scenario, dt: f64) -> Vec<Bound> {
    let mut bounds: Vec<Bound> = Vec::new();
    for place in 0..scenario.filters.len() {
        if let Some(same) = bounds.iter_mut().find(|b| b.bound.is_for(scenario, place)) {
            same.places.push(place);
        } else if let Some(bound) = CramerRao::new(scenario, place, dt) {
            bounds.push(Bound { bound, places: vec![place] });
        }
    }
    bounds
}

#[cfg(test)]
mod tests {
    use super::*;

    fn session() -> Session {
        Session::new(Scenario { duration: 4.0, ..Scenario::default() }).unwrap()
    }

    #[test]
    fn live_mode_shows_as_much_as_has_been_played() {
        let mut session = session();
        assert_eq!(session.run().len(), 1);
        session.advance(0.5);
        assert_eq!((session.position(), session.run().len()), (100, 101));
        session.advance(99.0);
        assert!(!session.playing());
        assert_eq!(session.run().len(), session.run().samples());
    }

    #[test]
    fn every_way_to_a_sample_shows_the_same() {
        let mut played = session();
        (0..40).for_each(|_| played.advance(0.025));
        let mut sought = session();
        sought.seek(3.0);
        sought.seek(2.0);
        let mut switched = session();
        switched.set_mode(Mode::Whole);
        switched.seek(2.0);
        switched.set_mode(Mode::Live);
        let mut stepped = session();
        (0..200).for_each(|_| stepped.step());
        for other in [sought, switched, stepped] {
            assert_eq!(other.position(), played.position());
            assert_eq!(other.run().checksum(), played.run().checksum());
        }
    }

    #[test]
    fn an_edit_takes_effect_at_once_and_an_impossible_one_does_no_harm() {
        let mut session = session();
        session.set_mode(Mode::Whole);
        let before = session.run().checksum();
        let mut edited = session.scenario().clone();
        edited.filters[0].fading = 1.02;
        session.set_scenario(edited.clone());
        let after = session.run().checksum();
        assert_ne!(before, after);
        edited.dt = -1.0;
        session.set_scenario(edited);
        assert!(session.problem().unwrap().contains("`dt`"));
        assert_eq!(session.run().checksum(), after);
        session.set_scenario(Scenario { duration: 2.0, ..Scenario::default() });
        assert_eq!((session.problem(), session.run().samples()), (None, 201));
    }

    #[test]
    fn play_at_the_end_begins_again() {
        let mut session = session();
        session.seek(99.0);
        session.advance(0.1);
        assert!(!session.playing());
        session.toggle_play();
        assert!(session.playing());
        assert_eq!(session.position(), 0);
    }
}
