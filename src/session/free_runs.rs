//! Free runs of the identified models over the record on screen.

use std::ops::Range;

use kalmanscope_core::{Fit, FreeRun, Identified};

use super::Session;

/// The estimates that make the model of a free run, as times \[s\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ModelTime {
    /// The last ones.
    #[default]
    Last,
    /// Those at a time.
    At(f64),
    /// The mean of those between two times.
    Over(f64, f64),
}

/// Free runs, one for each filter.
#[derive(Default)]
pub(super) struct FreeRuns {
    wanted: Option<ModelTime>,
    /// The picture's number, the samples that were done and the model.
    of: Option<(u64, usize, ModelTime)>,
    runs: Vec<Option<FreeRun>>,
    /// The fits of each filter's model on the record that was held out, one a sensor.
    held_out: Vec<Vec<Option<Fit>>>,
}

impl FreeRuns {
    /// Forgets what has been made.
    pub(super) fn forget(&mut self) {
        self.of = None;
    }
}

impl Session {
    /// Says of which models free runs are wanted, if of any.
    pub fn want_free_runs(&mut self, wanted: Option<ModelTime>) {
        self.free.wanted = wanted;
    }

    /// The free run of the filter at a place, once it is known.
    pub fn free_run(&self, place: usize) -> Option<&FreeRun> {
        self.free.runs.get(place)?.as_ref()
    }

    /// The fit of the free run of the filter at a place to a sensor of the record that was held out.
    pub fn held_out_fit(&self, place: usize, sensor: usize) -> Option<Fit> {
        *self.free.held_out.get(place)?.get(sensor)?
    }

    /// Whether a free run is yet to be made.
    pub fn is_free_run_behind(&self) -> bool {
        self.free_due().is_some()
    }

    /// The picture and the model of the free runs that are still to be made; none if all are there.
    fn free_due(&self) -> Option<(u64, usize, ModelTime)> {
        let run = self.study.run();
        // A record that grows is over by the time its free run is known.
        let is_still = run.done() == run.samples() && !self.behind() && run.record().forgotten() == 0;
        let wanted = self.free.wanted.filter(|_| is_still)?;
        let due = (self.generation, run.done(), wanted);
        let is_there = self.free.of == Some(due) && self.free.runs.len() == run.estimates().len();
        (!is_there).then_some(due)
    }

    /// Makes the free run of the next filter.
    pub(super) fn run_freely(&mut self) {
        let Some(due) = self.free_due() else {
            if self.free.wanted.is_none() || self.behind() {
                self.free.of = None;
            }
            return;
        };
        if self.free.of != Some(due) {
            (self.free.of, self.free.runs) = (Some(due), Vec::new());
            self.free.held_out.clear();
        }
        let place = self.free.runs.len();
        let run = self.study.run();
        let (Some(settings), Some(estimates)) = (run.scenario().filters.get(place), run.estimates().get(place)) else {
            return;
        };
        let record = run.record();
        let last = estimates.len().checked_sub(1);
        let model = last.map(|last| {
            let at = |time: f64| self.sample_at(time).min(last);
            let samples: Range<usize> = match due.2 {
                ModelTime::Last => last..last + 1,
                ModelTime::At(time) => at(time)..at(time) + 1,
                ModelTime::Over(from, to) => at(from.min(to))..at(from.max(to)) + 1,
            };
            Identified::over(run.scenario(), settings, estimates, samples)
        });
        let free = model.as_ref().map(|model| model.run(record, 0..record.len()));
        let other = model.zip(self.library.held_out()).map(|(model, (_, other))| model.run(other, 0..other.len()).fits);
        self.free.held_out.push(other.unwrap_or_default());
        self.free.runs.push(free);
        self.drawn += 1;
    }
}
