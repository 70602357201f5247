//! A change of a run's scenario, computed beside the run.

use std::sync::Arc;

use kalmanscope_filters::lists::{mapped, sort_items, sorted_places};
use kalmanscope_records::Record;

use super::{Bank, Run, Update};
use crate::run::simulate::Recording;
use crate::run::simulate::lookahead;
use crate::run::tape::Tape;
use crate::run::waste::Spare;
use crate::scenario::cost;
use crate::{Estimates, FilterSettings, RunError, Scenario, Source};

/// The parts of a run that another scenario changes. The run stays as it is until [`Self::apply`].
pub struct Revision {
    recording: Option<Recording>,
    /// The samples of the new run.
    pub samples: usize,
    /// The filters; unchanged ones are empty places.
    pub bank: Bank,
    /// The place of each filter in the run, where it is unchanged.
    pub kept: Vec<Option<usize>>,
    /// The places of the changed filters, from the cheapest step to the costliest.
    pub order: Vec<usize>,
    /// The places of the changed filters that the caller computes.
    pub away: Vec<usize>,
    /// Whether the record, or the way in which it is read, changes.
    pub is_of_everything: bool,
}

impl Revision {
    /// The revision of a run by another scenario, with the record from this source.
    pub fn new(
        run: &Run,
        scenario: &Arc<Scenario>,
        source: Option<Source>,
        spare: &mut Spare,
    ) -> Result<Self, RunError> {
        scenario.validate()?;
        let same_filters = source.is_none() && same_filters(run, scenario);
        let same_record = source.is_none() && (same_filters || run.source().is_measured());
        let recording = (!same_record)
            .then(|| Recording::new(scenario, source.unwrap_or_else(|| run.source()), spare.record.take()));
        let current = recording.as_ref().unwrap_or(&run.recording);
        // A truth that has diverged has fewer samples than its scenario.
        let is_simulated = matches!(run.source(), Source::Simulated);
        let samples = if same_record && is_simulated { run.samples } else { current.samples(scenario) };
        let mut bank = Bank::new(Arc::clone(scenario), &current.record)?;
        let before = &run.scenario().filters;
        let kept: Vec<Option<usize>> = mapped(&bank.scenario.filters, &|filter| {
            let computes_as = |own: &FilterSettings| {
                *own == FilterSettings { name: own.name.clone(), color: own.color, ..filter.clone() }
            };
            before.iter().position(computes_as).filter(|_| same_filters)
        });
        for kept in &kept {
            let (samples, spare) = if kept.is_some() { (0, None) } else { (samples, spare.estimates.pop()) };
            bank.add(&current.record, samples, spare);
        }
        let cost = |place: usize| scenario.filters[place].time_of_step(scenario);
        let mut order = sorted_places(kept.len(), &|a, b| cost(a).total_cmp(&cost(b)));
        order.retain(|&place| kept[place].is_none());
        Ok(Self { recording, samples, bank, kept, order, away: Vec::new(), is_of_everything: !same_filters })
    }

    /// The new record, if it changes.
    pub fn own_record(&self) -> Option<&Record> {
        self.recording.as_ref().map(|recording| &*recording.record)
    }

    /// The source of the new record, if it changes.
    pub fn source(&self) -> Option<Source> {
        self.recording.as_ref().map(Recording::source)
    }

    /// Whether samples are still added to the new record; `None` if the record does not change.
    pub fn is_live(&self) -> Option<bool> {
        self.recording.as_ref().map(|recording| recording.is_live)
    }

    /// The samples of the new record that are there, if it changes.
    pub fn recorded(&self) -> Option<usize> {
        self.recording.as_ref().map(Recording::len)
    }

    /// The samples that a filter has passed.
    pub fn done(&self, place: usize) -> usize {
        self.bank.passes[place].done()
    }

    /// Takes the computed tape of a filter; `false` if it does not fit.
    pub fn take(&mut self, place: usize, tape: &Tape) -> bool {
        let Self { away, bank: Bank { passes, estimates, .. }, samples, .. } = self;
        away.contains(&place) && passes[place].take(tape, *samples, &mut estimates[place])
    }

    /// Computes the filters that are away and not complete, from their first sample on.
    pub fn take_back(&mut self) {
        for place in std::mem::take(&mut self.away) {
            if self.done(place) < self.samples {
                self.bank.begin_again(place, self.samples);
            }
        }
    }

    /// Forgets the first samples, as the run did.
    pub fn forget(&mut self, samples: usize) {
        if let Some(recording) = &mut self.recording {
            recording.forget(samples);
            self.bank.forget(samples);
        }
    }

    /// First the record (`record` is the run's if it stays), then the filters, while `while_time`. Returns whether all is done.
    pub fn advance_to(&mut self, samples: usize, record: &Record, while_time: &mut dyn FnMut() -> bool) -> bool {
        let Self { recording, samples: all, bank, order, away, .. } = self;
        let goal = samples.min(*all);
        if let Some(recording) = recording
            && !recording.advance(goal + bank.lookahead(), all, while_time)
        {
            return false;
        }
        let goal = goal.min(*all);
        let record = recording.as_ref().map_or(record, |recording| &recording.record);
        for &place in order.iter().filter(|place| !away.contains(place)) {
            let step = bank.scenario.filters[place].time_of_step(&bank.scenario);
            let chunk = cost::chunk(step);
            while bank.passes[place].done() < goal {
                let next = (bank.passes[place].done() + chunk).min(goal);
                bank.follow_one(place, record, next);
                if !while_time() {
                    return order.iter().all(|&place| bank.passes[place].done() >= goal);
                }
            }
        }
        away.iter().all(|&place| bank.passes[place].done() >= goal)
    }

    /// Makes these parts those of the run.
    pub fn apply(self, run: &mut Run, done: usize, spare: &mut Spare) -> Update {
        let Self { recording, samples, mut bank, kept, mut order, away: _, is_of_everything } = self;
        for (place, before) in kept.into_iter().enumerate() {
            if let Some(before) = before {
                std::mem::swap(&mut bank.passes[place], &mut run.bank.passes[before]);
                std::mem::swap(&mut bank.estimates[place], &mut run.bank.estimates[before]);
                bank.estimates[place].call(&bank.scenario.filters[place]);
            }
        }
        sort_items(&mut order, Ord::cmp);
        let changed = order.into_iter().map(|place| bank.scenario.filters[place].id).collect();
        let old = std::mem::replace(&mut run.bank, bank);
        let record = recording.and_then(|new| std::mem::replace(&mut run.recording, new).into_simulated());
        run.samples = if run.is_live() { run.recording.samples(run.scenario()) } else { samples };
        run.done = done.min(run.samples);
        let estimates = old.estimates.into_iter().filter(|estimates| !estimates.is_empty()).collect();
        spare.take((record, estimates));
        if is_of_everything {
            return Update::Everything;
        }
        Update::Filters(changed)
    }

    /// The memory of the new record and of the new estimates.
    pub fn take_apart(self) -> (Option<Record>, Vec<Estimates>) {
        let estimates = self.bank.estimates.into_iter().filter(|estimates| !estimates.is_empty()).collect();
        (self.recording.and_then(Recording::into_simulated), estimates)
    }
}

fn same_filters(run: &Run, scenario: &Scenario) -> bool {
    let before = run.scenario();
    match run.source() {
        Source::Simulated => {
            let reaches = run.recording.len() >= (run.done() + lookahead(scenario, run.record().dt())).min(run.samples);
            // Laws are for populations: no run reads them.
            let (filters, draw) = (before.filters.clone(), before.draw.clone());
            run.record().forgotten() == 0 && reaches && *before == Scenario { filters, draw, ..scenario.clone() }
        }
        Source::Measured(_) | Source::Live(_) => {
            let read = |s: &Scenario| (s.seed, s.plant.kind.clone(), s.input, s.hold, s.measured());
            read(before) == read(scenario)
        }
    }
}
