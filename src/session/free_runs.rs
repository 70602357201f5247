//! Free runs of the identified models over the record on screen.

use std::ops::Range;
use std::sync::Arc;

use kalmanscope_core::{Estimates, Fit, FreeRun, Identified, Task as _, Work};

use super::Session;
use crate::team::{Lost, Priority, RunningTask};

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ModelTime {
    #[default]
    Last,
    At(f64),
    Over(f64, f64),
}

type FreeRunKey = (u64, usize, ModelTime);

#[derive(Default)]
pub(super) struct FreeRuns {
    wanted: Option<ModelTime>,
    made: Vec<CachedFreeRun>,
    next: Option<NextFreeRun>,
    lost: Option<FreeRunKey>,
}

struct CachedFreeRun {
    filter: u32,
    of: FreeRunKey,
    run: FreeRun,
    held_out: Vec<Option<Fit>>,
}

struct NextFreeRun {
    filter: u32,
    of: FreeRunKey,
    runs: RunningTask<Work<(FreeRun, Vec<Option<Fit>>)>>,
}

impl FreeRuns {
    pub(super) fn forget(&mut self) {
        self.made.clear();
        (self.next, self.lost) = (None, None);
    }
}

impl Session {
    pub fn want_free_runs(&mut self, wanted: Option<ModelTime>) {
        self.free.wanted = wanted;
    }

    pub fn free_run(&self, place: usize) -> Option<&FreeRun> {
        Some(&self.made_free_run(place)?.run)
    }

    pub fn held_out_fit(&self, place: usize, sensor: usize) -> Option<Fit> {
        *self.made_free_run(place)?.held_out.get(sensor)?
    }

    fn made_free_run(&self, place: usize) -> Option<&CachedFreeRun> {
        let run = self.study.run();
        let id = run.estimates().get(place)?.id();
        let made = self.free.made.iter().find(|made| made.filter == id)?;
        // A run over another record is none over this one.
        let sensors = run.record().sensors().len();
        (made.run.part.len() == run.record().len() && made.run.predicted.len() == sensors).then_some(made)
    }

    pub(crate) fn is_free_run_behind_here(&self) -> bool {
        self.is_free_run_behind() && !self.free.next.as_ref().is_some_and(|next| next.runs.is_beside())
    }

    pub fn is_free_run_behind(&self) -> bool {
        self.free_due().is_some()
    }

    fn free_due(&self) -> Option<(usize, FreeRunKey)> {
        let run = self.study.run();
        // A record that grows is over by the time its free run is known.
        let is_still = run.done() == run.samples() && !run.is_live() && !self.behind() && run.record().forgotten() == 0;
        let wanted = self.free.wanted.filter(|_| is_still)?;
        let of = (self.generation, run.done(), wanted);
        // It is not begun again for the same picture: it would be lost in each frame.
        if self.free.lost == Some(of) {
            return None;
        }
        let is_due = |estimates: &Estimates| {
            let id = estimates.id();
            !estimates.is_empty() && !self.free.made.iter().any(|made| made.filter == id && made.of == of)
        };
        Some((run.estimates().iter().position(is_due)?, of))
    }

    pub(super) fn run_freely(&mut self) {
        let mut while_time = self.budget.slice();
        while let Some((place, of)) = self.free_due() {
            let filter = self.study.run().estimates()[place].id();
            let next = self.free.next.take().filter(|next| next.filter == filter && next.of == of);
            let Some(mut next) = next.or_else(|| self.begin_free_run(place, of)) else { return };
            let (run, held_out) = match next.runs.advance(&mut while_time) {
                Ok(Some(runs)) => runs,
                Ok(None) => return self.free.next = Some(next),
                Err(Lost) => return self.free.lost = Some(of),
            };
            let made = CachedFreeRun { filter, of, run, held_out };
            self.free.made.retain(|before| before.filter != filter);
            self.free.made.push(made);
            self.drawn += 1;
            if !while_time() {
                return;
            }
        }
    }

    fn begin_free_run(&self, place: usize, of: FreeRunKey) -> Option<NextFreeRun> {
        let run = self.study.run();
        let (settings, estimates) = (run.scenario().filters.get(place)?, run.estimates().get(place)?);
        let last = estimates.len().checked_sub(1)?;
        let at = |time: f64| self.sample_at(time).min(last);
        let samples: Range<usize> = match of.2 {
            ModelTime::Last => last..last + 1,
            ModelTime::At(time) => at(time)..at(time) + 1,
            ModelTime::Over(from, to) => at(from.min(to))..at(from.max(to)) + 1,
        };
        let model = Identified::over(run.scenario(), settings, estimates, samples);
        let given = run.source().record().map(Arc::clone);
        // A thread needs its own copy, but no model uses the truth.
        let record = given.unwrap_or_else(|| Arc::new(run.record().clone().without_truth()));
        let held_out = self.library.held_out().map(|(_, record)| Arc::clone(record));
        let runs = Work::new(|progress| async move {
            let run = model.run_in_pieces(&record, 0..record.len(), |share| progress.set(share)).await;
            let Some(held_out) = held_out else { return (run, Vec::new()) };
            (run, model.run_in_pieces(&held_out, 0..held_out.len(), |_| ()).await.fits)
        });
        let runs = RunningTask::begin(&*self.team, Priority::Hand, runs, Work::progress);
        Some(NextFreeRun { filter: estimates.id(), of, runs })
    }
}

#[cfg(test)]
mod tests {
    use kalmanscope_core::Scenario;

    use super::super::{Budget, Mode};
    use super::*;

    fn session(budget: Budget) -> Session {
        let text =
            "duration = 10.0\n[plant]\nkind = \"duffing\"\n[[filters]]\nkind = \"ekf\"\n[[filters]]\nkind = \"ukf\"\n";
        let mut session = Session::new(Scenario::from_toml(text).expect("it is valid")).expect("it can be run");
        session.set_mode(Mode::Whole);
        session.want_free_runs(Some(ModelTime::Last));
        session.set_budget(budget);
        session
    }

    #[test]
    fn free_runs_advance_by_slices_and_the_last_complete_ones_stay() {
        let mut at_once = session(Budget::Unlimited);
        at_once.advance(0.0);
        assert!(!at_once.is_free_run_behind());

        let mut session = session(Budget::Pieces(2));
        let mut slices = 0;
        while session.is_free_run_behind() {
            session.advance(0.0);
            slices += 1;
        }
        assert!(slices > 15, "{slices}");
        for place in 0..2 {
            assert!(session.free_run(place).is_some());
            assert_eq!(session.free_run(place), at_once.free_run(place));
        }
        let before = [0, 1].map(|place| session.free_run(place).cloned());
        session.want_free_runs(Some(ModelTime::At(0.5)));
        for _ in 0..3 {
            session.advance(0.0);
            assert!(session.is_free_run_behind());
            assert_eq!([0, 1].map(|place| session.free_run(place).cloned()), before);
        }
        while session.is_free_run_behind() {
            session.advance(0.0);
        }
        assert_ne!([0, 1].map(|place| session.free_run(place).cloned()), before);
    }
}
