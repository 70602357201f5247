//! Computes the scenario's picture, a slice of time after the other.

use std::sync::Arc;

use kalmanscope_diagnosis::Job;

use super::library::is_same;
use super::{Mode, Session};

/// An edit waits for at most this many slices for the picture before it, so that dragging shows some of the pictures that
/// take longer than a frame.
const PATIENCE: usize = 6;

impl Session {
    /// Whether [`Self::advance`] has something to compute: the next picture, or missing parts of this one.
    pub fn behind(&self) -> bool {
        self.job.is_some() || !self.complete
    }

    /// The computed share, from 0 to 1, of the next picture or of the samples up to playback's time. `None` if nothing
    /// is to be computed.
    pub fn progress(&self) -> Option<f64> {
        if let Some(job) = &self.job {
            return Some(job.progress(&self.study).all);
        }
        (!self.complete).then(|| (self.run().done() as f64 / (self.position() + 1) as f64).min(1.0))
    }

    pub fn cancel(&mut self) -> bool {
        if !self.behind() {
            return false;
        }
        self.give_up_job();
        self.is_opened = false;
        let run = self.study.run();
        self.scenario = run.shared_scenario();
        self.can_be_whole = run.samples() <= Self::LONGEST_WHOLE + 1;
        self.problem = None;
        if self.wanted_mode == Mode::Whole && (run.done() < run.samples() || run.record().forgotten() > 0) {
            self.wanted_mode = Mode::Live;
        }
        let last = run.done().saturating_sub(1) as f64 * run.record().dt();
        self.clock = self.clock.min(last);
        self.playing = false;
        self.compute();
        true
    }

    fn give_up_job(&mut self) {
        self.long.end();
        if let Some(job) = self.job.take() {
            job.cancel(&mut self.study);
        }
        self.waiting = false;
    }

    pub(super) fn target(&self) -> (f64, usize) {
        match &self.job {
            None => (self.run().record().dt(), self.run().samples()),
            Some(job) => (job.dt(&self.study), job.samples()),
        }
    }

    pub(super) fn begin_job(&mut self) {
        self.give_up_job();
        self.slices = 0;
        let Self { scenario, study, clock, library, hand, .. } = self;
        let source = match library.source(scenario) {
            Ok(source) => source,
            Err(reason) => {
                self.problem = Some(reason);
                return;
            }
        };
        let (dt, samples) =
            source.record().map_or_else(|| (scenario.dt, scenario.samples()), |record| (record.dt(), record.len()));
        let other_source = (!is_same(&source, &study.run().source())).then_some(source);
        let can_be_whole = samples <= Self::LONGEST_WHOLE + 1;
        let is_whole = can_be_whole && self.wanted_mode == Mode::Whole;
        study.keep(if is_whole { Self::LONGEST_WHOLE + 1 } else { Self::KEPT });
        study.put_off_diagnoses(is_whole && hand.puts_off());
        let goal = if is_whole {
            samples
        } else {
            // Playback continues from here, by the samples that are already computed.
            let position = ((*clock / dt + 1e-6) as usize).saturating_add(1).min(samples);
            position.min(study.run().done().max(1))
        };
        match Job::new(study, Arc::clone(scenario), other_source, goal) {
            Ok(mut job) => {
                self.long.begin(&mut job, &*self.team);
                self.job = Some(job);
                self.can_be_whole = can_be_whole;
                self.problem = None;
                self.clock = self.clock.min(self.end());
            }
            Err(error) => self.problem = Some(error.to_string()),
        }
    }

    pub(super) fn go_back(&mut self) {
        let run = self.study.run();
        let position = self.position() + 1;
        let is_wrong = match (self.mode(), &self.job) {
            (Mode::Live, Some(job)) => job.goal > position,
            (Mode::Live, None) => run.done() > position,
            (Mode::Whole, Some(job)) => job.goal < job.samples(),
            (Mode::Whole, None) => run.record().forgotten() > 0 || run.done() < run.samples(),
        };
        if is_wrong {
            self.begin_job();
        }
    }

    pub(super) fn begin_again(&mut self) {
        let goal = self.run().done().max(1);
        if self.job.is_some() {
            return;
        }
        let source = self.run().source();
        self.slices = 0;
        // An impossible scenario has no run: the last possible one's stays.
        let scenario = self.run().shared_scenario();
        self.job = Job::new(&mut self.study, scenario, Some(source), goal).ok();
    }

    pub(super) fn edited(&mut self) {
        if let Err(error) = self.scenario.validate() {
            self.problem = Some(error.to_string());
        } else if self.job.is_some() && self.slices < PATIENCE {
            self.waiting = true;
            self.problem = None;
        } else {
            self.begin_job();
        }
    }

    pub(super) fn compute(&mut self) {
        let mut while_time = self.budget.slice();
        let shown = self.shown();
        while let Some(mut job) = self.job.take() {
            self.long.follow(&mut job, &self.study, &*self.team, &mut while_time);
            let is_done = self.study.free(&mut while_time) && job.advance(&self.study, &mut while_time).is_done();
            self.slices += 1;
            if is_done {
                self.long.end();
                self.is_opened = false;
                job.finish(&mut self.study);
                self.generation += 1;
                self.clock = self.clock.min(self.end());
            } else {
                self.job = Some(job);
            }
            if self.waiting && (is_done || self.slices >= PATIENCE) {
                self.begin_job();
            }
            let has_time = while_time();
            self.long.set_alone(has_time);
            if !is_done || !has_time {
                break;
            }
        }
        if self.job.is_none() {
            self.catch_up();
        }
        if self.job.is_none() {
            self.study.keep(if self.mode() == Mode::Whole { Self::LONGEST_WHOLE + 1 } else { Self::KEPT });
            let goal = match self.mode() {
                Mode::Live => self.position() + 1,
                Mode::Whole => usize::MAX,
            };
            self.complete = self.study.advance_to(goal, &mut while_time);
        }
        if self.shown() != shown {
            self.generation += 1;
        }
    }

    fn shown(&self) -> (usize, [bool; 3]) {
        let analysis = self.study.analysis();
        let there = [analysis.diagnostics().is_empty(), analysis.smoothed().is_empty(), analysis.bounds().is_empty()];
        (self.run().record().forgotten(), there)
    }
}
