//! The smoothed estimates of a run's filters.

use kalmanscope_core::internals::{Smoother, Waste, sort_items};
use kalmanscope_core::scenario::cost;
use kalmanscope_core::{Estimates, FilterSettings};

use super::{AnalysisSubject, Hindsight, is_known};

#[derive(Default)]
pub(super) struct Smoothing {
    estimates: Vec<Estimates>,
    smoothers: Vec<Option<Box<dyn Smoother>>>,
    is_complete: bool,
}

impl Smoothing {
    /// The estimates; while some wait for the end of the run, none until all are complete.
    pub(super) fn estimates(&self) -> &[Estimates] {
        let go_along = self.smoothers.iter().flatten().all(|smoother| smoother.goes_along());
        if self.is_complete || go_along { &self.estimates } else { &[] }
    }

    pub(super) fn follow(
        &mut self,
        subject: &AnalysisSubject<'_>,
        wanted: Hindsight,
        waste: &mut Waste,
        while_time: &mut dyn FnMut() -> bool,
    ) -> bool {
        let AnalysisSubject { bank, record, done, known, whole, .. } = *subject;
        self.is_complete = false;
        let scenario = &bank.scenario;
        let wanted_of = |of: &Estimates| {
            scenario.filters.iter().any(|filter| filter.id == of.id() && is_wanted(filter, subject, wanted))
        };
        if !self.estimates.iter().all(wanted_of) {
            self.keep(waste, wanted_of);
        }
        let is_due = |place: usize, filter: &_| !is_known(known, place) && is_wanted(filter, subject, wanted);
        for (place, filter) in scenario.filters.iter().enumerate().filter(|(place, filter)| is_due(*place, *filter)) {
            let at = self.estimates.iter().position(|of| of.id() == filter.id).or_else(|| {
                (record.forgotten() == 0).then(|| self.begin(bank.smoother(place, record), bank.smoothed(place), done))
            });
            let Some(at) = at else { continue };
            let Some(smoother) = &mut self.smoothers[at] else { continue };
            let chunk = cost::chunk(2.0 * filter.time_of_step(scenario));
            while !smoother.advance(record, done, whole, chunk, &mut self.estimates[at]) {
                if !while_time() {
                    return false;
                }
            }
            if !smoother.goes_along() {
                waste.extend(self.smoothers[at].take());
            }
        }
        self.is_complete = true;
        true
    }

    /// Returns the place of a filter here. One that cannot begin has no estimates.
    fn begin(&mut self, smoother: Option<Box<dyn Smoother>>, mut estimates: Estimates, samples: usize) -> usize {
        // Memory that grows is copied, which takes as long as a frame.
        estimates.recycle(None, samples);
        self.estimates.push(estimates);
        self.smoothers.push(smoother);
        self.estimates.len() - 1
    }

    pub(super) fn forget_before(&mut self, sample: usize) {
        for estimates in &mut self.estimates {
            estimates.forget(sample.saturating_sub(estimates.forgotten()));
        }
    }

    pub(super) fn discard(&mut self, waste: &mut Waste) {
        self.keep(waste, |_| false);
        self.is_complete = false;
    }

    pub(super) fn take_over(&mut self, mut old: Self, filters: &[FilterSettings], changed: &[u32], waste: &mut Waste) {
        let place = |of: &Estimates| filters.iter().position(|filter| filter.id == of.id());
        old.keep(waste, |of| place(of).is_some() && !changed.contains(&of.id()));
        let all = self.estimates.drain(..).zip(self.smoothers.drain(..));
        let mut all: Vec<_> = all.chain(old.estimates.into_iter().zip(old.smoothers)).collect();
        sort_items(&mut all, |(one, _), (other, _)| place(one).cmp(&place(other)));
        (self.estimates, self.smoothers) = all.into_iter().unzip();
        for estimates in &mut self.estimates {
            if let Some(place) = place(estimates) {
                estimates.call(&filters[place]);
            }
        }
        self.is_complete = false;
    }

    fn keep(&mut self, waste: &mut Waste, is_kept: impl Fn(&Estimates) -> bool) {
        for (estimates, smoother) in self.estimates.drain(..).zip(self.smoothers.drain(..)).collect::<Vec<_>>() {
            if is_kept(&estimates) {
                self.estimates.push(estimates);
                self.smoothers.push(smoother);
            } else {
                waste.extend([estimates]);
                waste.extend(smoother);
            }
        }
    }

    /// The work for a filter that is done and the whole work, in nanoseconds.
    pub(super) fn work(&self, filter: &FilterSettings, subject: &AnalysisSubject<'_>, wanted: Hindsight) -> (f64, f64) {
        if !is_wanted(filter, subject, wanted) || !filter.kind.is_gaussian() {
            return (0.0, 0.0);
        }
        let cost = 2.0 * subject.done as f64 * filter.time_of_step(&subject.bank.scenario);
        let share = match self.estimates.iter().position(|of| of.id() == filter.id) {
            None => 0.0,
            Some(at) => self.smoothers[at].as_ref().map_or(1.0, |smoother| smoother.progress(subject.done)),
        };
        (share * cost, cost)
    }
}

fn is_wanted(filter: &FilterSettings, subject: &AnalysisSubject<'_>, wanted: Hindsight) -> bool {
    let is_possible = match filter.lag(subject.record.dt()) {
        Some(_) => wanted >= Hindsight::Lagged,
        None => wanted == Hindsight::All && subject.whole && subject.record.forgotten() == 0,
    };
    filter.smoother && is_possible
}
