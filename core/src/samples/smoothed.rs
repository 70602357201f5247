//! Smoothed estimates of one filter over a whole record, at once.

use crate::samples::bank::Bank;
use crate::{Estimates, Pass, Record, RunError, Scenario};

/// The smoothed estimates of the filter at `place` of a scenario, given a whole record: those of
/// [`Run::smoothed`](crate::Run::smoothed), to the bit, whether or not the filter's settings ask for a smoother. They have
/// means and covariances, but no innovations.
///
/// If the filter stops, the smoother gets the samples before; [`Estimates::stop`] gives the sample and the reason.
///
/// ```
/// use kalmanscope_core::{Run, Scenario, smoothed};
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let scenario = Scenario { duration: 5.0, ..Scenario::default() };
/// let mut run = Run::new(&scenario)?;
/// run.finish();
/// let (filter, smoother) = (&run.estimates()[0], smoothed(&scenario, 0, run.record())?);
/// assert!(smoother.std(0, 2) < filter.std(0, 2), "the whole record tells of the first sample");
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// [`RunError::NoFilter`] where there is no such filter; [`RunError::Scenario`] where the scenario is impossible or the
/// filter has no smoother: a sampled one, or one with several guesses; [`RunError::MissingSensor`] and
/// [`RunError::InputKind`] where the record does not fit the scenario; [`RunError::Forgotten`] where it lacks its first
/// samples.
///
/// Source: Rauch, Tung and Striebel (1965), Maximum likelihood estimates of linear dynamic systems, in the form that
/// [`Run::smoothed`](crate::Run::smoothed) computes.
pub fn smoothed(scenario: &Scenario, place: usize, record: &Record) -> Result<Estimates, RunError> {
    let mut scenario = scenario.clone();
    scenario.filters.get_mut(place).ok_or(RunError::NoFilter(place))?.smoother = true;
    scenario.validate()?;
    if record.forgotten() > 0 {
        return Err(RunError::Forgotten(record.forgotten()));
    }
    let bank = Bank::new(&scenario, record)?;
    let mut estimates = bank.smoothed(place);
    match bank.smoother(place, record) {
        Some(mut smoother) => while !smoother.advance(record, record.len(), true, usize::MAX, &mut estimates) {},
        // A filter that cannot begin says why at its first sample.
        None => Pass::new(&scenario, place, record)?.follow(record, 1, &mut estimates),
    }
    Ok(estimates)
}
