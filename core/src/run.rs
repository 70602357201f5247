//! The one engine: a truth or a measured record, and the filters that follow it sample by sample.

pub(crate) mod revision;

use std::sync::Arc;

use crate::bank::Bank;
use crate::run_error::sensor_places;
use crate::simulate::TruthStop;
use crate::source::Recording;
use crate::spare::Spare;
use crate::{Channel, Estimates, Record, RunError, Scenario, Source};

use revision::Revision;

/// A scenario in progress.
///
/// A simulated run may forget its first samples ([`Self::forget`]), and can then go on for ever in the same memory. Counts
/// of all samples, [`Self::done`] and [`Self::samples`], are from the run's beginning; [`Self::len`] and every index into
/// [`Self::record`] and [`Self::estimates`] are of those that are kept.
pub struct Run {
    recording: Recording,
    samples: usize,
    done: usize,
    bank: Bank,
}

/// What [`Run::update`] has computed again.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Update {
    /// The truth, or the way in which a given record is read, and every filter.
    Everything,
    /// The filters with these ids; the truth and all other filters are as they were, but for those that are gone.
    Filters(Vec<u32>),
}

impl Run {
    /// A run over the scenario's own simulated record, before its first sample.
    ///
    /// # Errors
    /// [`RunError::Scenario`] where the scenario is impossible.
    pub fn new(scenario: &Scenario) -> Result<Self, RunError> {
        Self::from_source(scenario, Source::Simulated)
    }

    /// A run of the scenario's filters over a given record, whose `dt` counts instead of the scenario's.
    ///
    /// # Errors
    /// [`RunError::Scenario`] where the scenario is impossible, [`RunError::MissingSensor`] where the record lacks one
    /// of its sensors, [`RunError::InputKind`] where its input is of another kind.
    pub fn on_record(scenario: &Scenario, record: Arc<Record>) -> Result<Self, RunError> {
        Self::from_source(scenario, Source::Measured(record))
    }

    /// A run over either, before its first sample.
    ///
    /// # Errors
    /// As [`Self::on_record`].
    pub fn from_source(scenario: &Scenario, source: Source) -> Result<Self, RunError> {
        Self::over(scenario, source, &mut Spare::default())
    }

    fn over(scenario: &Scenario, source: Source, spare: &mut Spare) -> Result<Self, RunError> {
        scenario.validate()?;
        let recording = Recording::new(scenario, source, spare.record());
        let samples = recording.samples(scenario);
        let record = recording.record();
        let mut bank = Bank::new(scenario, record)?;
        for _ in &scenario.filters {
            bank.add(record, samples, spare.estimates());
        }
        Ok(Self { recording, samples, done: 0, bank })
    }

    /// Begins anew with another scenario over the same source, in the memory of this run.
    ///
    /// # Errors
    /// As [`Self::on_record`]; this run stays as it is then.
    pub fn restart(&mut self, scenario: &Scenario) -> Result<(), RunError> {
        scenario.validate()?;
        let source = self.source();
        if let Source::Measured(record) = &source {
            sensor_places(scenario, record)?;
        }
        let mut spare = Spare::default();
        spare.take(self.take_apart());
        *self = Self::over(scenario, source, &mut spare)?;
        Ok(())
    }

    /// Takes over another scenario as far as this run has come, as a new run of it would come there: with the same bits, but
    /// a truth and filters whose settings have not changed are not computed again, and a given record stays. Where the truth
    /// has changed, or a run has forgotten samples, begins anew.
    ///
    /// # Errors
    /// As [`Self::on_record`]; this run stays as it is then.
    pub fn update(&mut self, scenario: &Scenario) -> Result<Update, RunError> {
        let mut spare = Spare::default();
        let mut revision = Revision::new(self, scenario, None, &mut spare)?;
        if revision.is_of_everything() {
            self.restart(scenario)?;
            return Ok(Update::Everything);
        }
        while !revision.advance_to(self.done, self.record(), &mut || true) {}
        Ok(revision.apply(self, self.done, &mut spare))
    }

    /// Advances by one sample: the truth moves on, then every filter predicts and updates. The first step reports the
    /// initial beliefs. A filter that fails keeps its estimates so far and says why in [`Estimates::stop`]; the others go
    /// on. Returns whether there was a sample left; a truth that runs away ends the record early and says why in
    /// [`Self::truth_stop`].
    pub fn step(&mut self) -> bool {
        self.advance_to(self.done + 1) > 0
    }

    /// Steps until `samples` samples, from the run's beginning, are done or there are none left. Returns how many steps that
    /// took.
    pub fn advance_to(&mut self, samples: usize) -> usize {
        let Self { recording, samples: all, done, bank } = self;
        let begin = *done;
        let goal = samples.min(*all);
        if !recording.advance_to((goal + bank.lookahead()).min(*all)) {
            *all = recording.len();
        }
        *done = goal.min(*all).max(begin);
        bank.follow(recording.record(), *done);
        *done - begin
    }

    /// Forgets the first `samples` of those that are kept, or all but the last, and whatever has been told of them, without
    /// giving memory back. What comes after is the same to the last bit. Only a simulated record can be forgotten; returns
    /// whether it is one.
    pub fn forget(&mut self, samples: usize) -> bool {
        let samples = samples.min(self.len().saturating_sub(1 + self.bank.reach()));
        let forgets = self.recording.forget(samples);
        if forgets {
            self.bank.forget(samples);
        }
        forgets
    }

    /// Steps to the end of the record.
    pub fn finish(&mut self) {
        self.advance_to(self.samples);
    }

    /// The scenario.
    pub fn scenario(&self) -> &Scenario {
        self.bank.scenario()
    }

    /// Where its samples come from.
    pub fn source(&self) -> Source {
        self.recording.source()
    }

    /// The number of samples done, from the run's beginning.
    pub fn done(&self) -> usize {
        self.done
    }

    /// The number of samples done that are kept: all, unless some have been forgotten.
    pub fn len(&self) -> usize {
        self.done - self.record().forgotten()
    }

    /// Whether no sample is done yet.
    pub fn is_empty(&self) -> bool {
        self.done == 0
    }

    /// The number of samples of the whole record, from the run's beginning, kept or not.
    pub fn samples(&self) -> usize {
        self.samples
    }

    /// Where the simulated truth stopped and why, if it had no numbers left before the record was complete.
    pub fn truth_stop(&self) -> Option<TruthStop> {
        self.recording.stop()
    }

    /// The record: as far as it is simulated and kept, or all of a measured one.
    pub fn record(&self) -> &Record {
        self.recording.record()
    }

    /// The estimates so far, as far as they are kept, one a filter.
    pub fn estimates(&self) -> &[Estimates] {
        &self.bank.estimates
    }

    /// The estimates of every filter with a smoother in the light of all samples so far. They have means and
    /// covariances, but no innovations. A smoother begins where the filter did: a run that has forgotten samples has none.
    ///
    /// Source: Rauch, Tung and Striebel (1965), Maximum likelihood estimates of linear dynamic systems.
    pub fn smoothed(&self) -> Vec<Estimates> {
        let record = self.record();
        if record.forgotten() > 0 {
            return Vec::new();
        }
        let of = |place: usize| {
            let wants = self.scenario().filters[place].smoother;
            let mut smoothed = wants.then(|| self.bank.smoothed(place))?;
            if let Some(mut smoother) = self.bank.smoother(place, record.dt()) {
                while !smoother.advance(record, self.done, usize::MAX, &mut smoothed) {}
            }
            Some(smoothed)
        };
        (0..self.scenario().filters.len()).filter_map(of).collect()
    }

    /// Every channel that the truth or a filter has.
    pub fn channels(&self) -> Vec<Channel> {
        let known =
            |c: &Channel| self.record().truth(*c).is_some() || self.estimates().iter().any(|e| e.place(*c).is_some());
        Channel::all().iter().copied().filter(known).collect()
    }

    /// Checksum of all estimates that are kept, to compare platforms with.
    pub fn checksum(&self) -> u64 {
        self.estimates().iter().fold(0, |sum: u64, e| sum.rotate_left(1) ^ e.checksum())
    }

    pub(crate) fn bank(&self) -> &Bank {
        &self.bank
    }

    /// The memory of what is kept. The run is of no use before it has been given other things.
    fn take_apart(&mut self) -> (Option<Record>, Vec<Estimates>) {
        let empty = Recording::Measured(Arc::new(self.record().emptied()));
        let record = std::mem::replace(&mut self.recording, empty).into_simulated();
        (record, std::mem::take(&mut self.bank.estimates))
    }
}
