//! The diagnoses of the filters over the record so far.

use kalmanscope_diagnosis::{Analysis, Diagnosis};

use super::Session;

/// The least real time between two diagnoses of a growing record \[s\].
const EVERY: f64 = 0.3;

/// The least real time between two diagnoses while a number is dragged \[s\].
const EVERY_WHILE_HELD: f64 = 0.15;

/// Limits the samples of a diagnosis while a record grows: at most 6 ms a filter.
const MOST: usize = 20_000;

#[derive(Default)]
pub(super) struct LiveVerdicts {
    diagnoses: Vec<Option<Diagnosis>>,
    of: Option<(u64, usize)>,
    age: f64,
}

pub(super) struct Hand {
    is_down: bool,
    age: f64,
}

impl Default for Hand {
    fn default() -> Self {
        Self { is_down: false, age: f64::INFINITY }
    }
}

impl Hand {
    fn is_due(&self) -> bool {
        !self.is_down || self.age >= EVERY_WHILE_HELD
    }

    pub(super) fn puts_off(&mut self) -> bool {
        if self.is_due() {
            self.age = 0.0;
            return false;
        }
        true
    }
}

impl Session {
    /// Notes whether the user holds the pointer down. While a number is dragged, diagnoses of a whole record are made
    /// only a few times a second: nobody reads more of them, and each takes about as long as its filter.
    pub fn hold(&mut self, is_down: bool) {
        self.hand.is_down = is_down;
    }

    /// Whether diagnoses are put off while the pointer is down. Those on screen are of an earlier setting.
    pub(crate) fn owes_diagnoses(&self) -> bool {
        self.study.puts_off_diagnoses()
    }

    /// Lets real time pass \[s\] and makes the diagnoses that were put off, if it is time for that.
    pub(super) fn diagnose_in_time(&mut self, elapsed: f64) {
        self.hand.age += elapsed;
        if self.job.is_none() && self.owes_diagnoses() && self.hand.is_due() {
            self.hand.age = 0.0;
            self.study.put_off_diagnoses(false);
            self.complete = false;
            self.compute();
            // Bad parts are drawn.
            self.drawn += 1;
        }
    }

    /// Limits the time that live plots show \[s\].
    pub const LIVE_SPAN: f64 = 20.0;

    /// Over the whole record; while that grows, over the time on screen and up to 0.3 s old. `None` if not known.
    pub fn diagnosis(&self, place: usize) -> Option<&Diagnosis> {
        if self.is_whole() {
            return self.study.analysis().diagnosis(place);
        }
        self.judged.diagnoses.get(place)?.as_ref()
    }

    pub(super) fn diagnose(&mut self, elapsed: f64) {
        self.judged.age += elapsed;
        let (run, diagnostics) = (self.study.run(), self.study.analysis().diagnostics());
        if self.is_whole() || self.job.is_some() || !self.complete {
            return;
        }
        let now = (self.generation, run.done());
        let is_due = match self.judged.of {
            Some(before) if before == now => false,
            Some((generation, _)) if self.playing && generation == now.0 => self.judged.age >= EVERY,
            _ => true,
        };
        if is_due {
            let on_screen = (Self::LIVE_SPAN / run.record().dt()).ceil() as usize;
            let from = run.len().saturating_sub(on_screen.min(MOST));
            let of = |(estimates, diagnostics)| Diagnosis::over(from..run.len(), diagnostics, estimates, run.record());
            self.judged.diagnoses = run.estimates().iter().zip(diagnostics).map(of).collect();
            (self.judged.of, self.judged.age) = (Some(now), 0.0);
        }
    }

    pub(crate) fn whole_analysis(&self) -> Option<&Analysis> {
        self.is_whole().then(|| self.study.analysis())
    }

    fn is_whole(&self) -> bool {
        self.run().done() == self.run().samples() && !self.is_live()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::Mode;
    use kalmanscope_core::Scenario;
    use kalmanscope_diagnosis::Wanted;

    fn whole() -> Session {
        let mut session = Session::new(Scenario { duration: 10.0, ..Scenario::default() }).unwrap();
        session.set_mode(Mode::Whole);
        session.want(Wanted { diagnostics: true, ..Wanted::default() });
        session.advance(0.0);
        session
    }

    fn words(session: &Session) -> Vec<String> {
        (0..session.run().estimates().len()).map(|place| format!("{:?}", session.diagnosis(place))).collect()
    }

    fn drag(session: &mut Session, fading: f64) {
        let mut scenario = session.scenario().clone();
        scenario.filters[0].fading = fading;
        session.set_scenario(scenario);
        session.advance(0.01);
    }

    #[test]
    fn diagnoses_wait_while_a_number_is_dragged_and_come_when_it_is_let_go() {
        let (mut session, mut other) = (whole(), whole());
        session.hold(true);
        drag(&mut session, 1.02);
        let first = words(&session);
        drag(&mut session, 1.05);
        assert!(session.owes_diagnoses());
        let drawn = session.drawn();
        assert_eq!(words(&session), first, "the last ones stay");
        assert_eq!(session.run().scenario().filters[0].fading, 1.05);
        session.hold(false);
        session.advance(0.01);
        assert!(!session.owes_diagnoses() && !session.behind());
        assert_ne!(session.drawn(), drawn, "charts show the new bad parts");
        drag(&mut other, 1.05);
        assert_eq!(words(&session), words(&other));
        assert_ne!(words(&session), first);
    }

    #[test]
    fn a_run_of_another_length_has_no_diagnosis_of_the_one_before() {
        let mut session = whole();
        session.hold(true);
        drag(&mut session, 1.02);
        session.set_scenario(Scenario { duration: 5.0, ..session.scenario().clone() });
        session.advance(0.01);
        assert!(session.diagnosis(0).is_none());
        session.hold(false);
        session.advance(0.01);
        assert!(session.diagnosis(0).is_some());
    }
}
