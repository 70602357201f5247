//! Suggestions that are tried out: the making of a [`Suggestion`], a slice after the other.

use super::Suggestion;
use crate::in_slices::InSlices;
use crate::{FreeRun, Identified, Record, Run, Running, Scenario, Sensor};

/// The samples of which the likelihood is taken.
const LIKELY: usize = 4096;

/// Parts of the motion's size that are tried for its process noise per step.
pub(super) const SHARES: [f64; 11] = [0.0, 1e-6, 3e-6, 1e-5, 3e-5, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2];

/// The samples of which the free run is taken.
const FREE: usize = 16_384;

/// The making of suggested settings for a scenario's filters on a measured record: R from the high frequencies that the
/// input does not explain, ωₙ, ζ and gain from the response to the input (or the peak of the spectrum), the initial belief
/// from these, and Q by the likelihood of the innovations. Where the scenario has a mapping, means are removed and a large gain
/// goes into the mapping; the record is then to be read again.
///
/// Settings of plants without a natural frequency are left as they are, but for R and Q.
pub struct Suggest {
    suggestion: Suggestion,
    record: Record,
    stage: Stage,
    trial: Option<Run>,
    /// The free run of the trial's model.
    free: Option<Running>,
    likelihoods: Vec<(f64, f64)>,
    /// The errors of the free run with the settings so far, and those with other settings.
    errors: Vec<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// Noise, guess and spread are read from the spectra.
    Data,
    /// The likelihood with one of the shares.
    Likelihood(usize),
    /// The free run of the model so far.
    FreeRun,
    /// The free run of the model with larger R and no Q.
    ModelError,
    Done,
}

/// The samples of a trial between two looks at the clock.
const CHUNK: usize = 200;

impl Suggest {
    /// Suggestions for a scenario on a record, before the first look at it.
    pub fn new(scenario: &Scenario, record: Record) -> Self {
        let suggestion = Suggestion { scenario: scenario.clone(), reasons: Vec::new(), is_guessed: true };
        let (trial, free, likelihoods, errors) = Default::default();
        Self { suggestion, record, stage: Stage::Data, trial, free, likelihoods, errors }
    }
}

impl InSlices for Suggest {
    type Outcome = Suggestion;

    fn progress(&self) -> f64 {
        let all = (SHARES.len() + 3) as f64;
        match self.stage {
            Stage::Data => 0.0,
            Stage::Likelihood(place) => (1 + place) as f64 / all,
            Stage::FreeRun => (1 + SHARES.len()) as f64 / all,
            Stage::ModelError => (2 + SHARES.len()) as f64 / all,
            Stage::Done => 1.0,
        }
    }

    fn advance(&mut self, while_time: &mut dyn FnMut() -> bool) -> bool {
        while self.stage != Stage::Done {
            self.stage = match self.stage {
                Stage::Data => {
                    // Without a mapping the record stays as it is, and the filters know its offsets.
                    let as_it_is = self.suggestion.scenario.record.is_none().then(|| self.record.clone());
                    self.suggestion.remove_means(&mut self.record);
                    self.suggestion.sensor_noise(&self.record);
                    self.suggestion.motion(&mut self.record);
                    self.suggestion.substeps(&self.record);
                    if let Some(record) = as_it_is {
                        self.record = record;
                    }
                    if self.suggestion.scenario.filters.is_empty() { Stage::Done } else { Stage::Likelihood(0) }
                }
                Stage::Likelihood(place) => {
                    let share = SHARES[place];
                    let scenario = || self.suggestion.with_share(share);
                    match follow(&mut self.trial, scenario, &self.record, LIKELY, while_time) {
                        None => return false,
                        Some(run) => self.likelihoods.extend(run.and_then(|run| Some((share, likelihood(&run)?)))),
                    }
                    if place + 1 < SHARES.len() {
                        Stage::Likelihood(place + 1)
                    } else {
                        let best = self.likelihoods.iter().max_by(|a, b| a.1.total_cmp(&b.1));
                        if let Some(&(share, _)) = best {
                            self.suggestion.process_noise(share);
                        }
                        Stage::FreeRun
                    }
                }
                Stage::FreeRun => {
                    let scenario = || first_alone(&self.suggestion.scenario);
                    match follow_freely(&mut self.trial, &mut self.free, scenario, &self.record, while_time) {
                        None => return false,
                        // The errors of a default guess are no noise.
                        Some(Some((_, errors))) if self.suggestion.is_guessed => {
                            self.errors = errors;
                            Stage::ModelError
                        }
                        Some(_) => Stage::Done,
                    }
                }
                Stage::ModelError => {
                    let scenario = || first_alone(&self.suggestion.with_error(&self.errors));
                    match follow_freely(&mut self.trial, &mut self.free, scenario, &self.record, while_time) {
                        None => return false,
                        Some(after) => {
                            if let Some((run, after)) = after {
                                self.suggestion.model_error(&self.errors, &after, surprise(&run));
                            }
                            Stage::Done
                        }
                    }
                }
                Stage::Done => Stage::Done,
            };
            if !while_time() {
                break;
            }
        }
        self.stage == Stage::Done
    }

    fn finish(self) -> Suggestion {
        self.suggestion
    }
}

/// Runs a trial on the first samples of a record. `None` while it is under way, `Some(None)` where it is impossible.
#[expect(clippy::option_option, reason = "a trial is under way, impossible or done")]
fn follow(
    trial: &mut Option<Run>,
    scenario: impl FnOnce() -> Scenario,
    record: &Record,
    samples: usize,
    while_time: &mut dyn FnMut() -> bool,
) -> Option<Option<Run>> {
    if trial.is_none() {
        let part = record.part(0..record.len().min(samples));
        *trial = Run::on_record(&scenario(), part.into()).ok();
    }
    let Some(run) = trial else { return Some(None) };
    while run.done() < run.samples() {
        run.advance_to(run.done() + CHUNK);
        if !while_time() && run.done() < run.samples() {
            return None;
        }
    }
    Some(trial.take())
}

/// Runs a trial, then its final model freely over the same samples, with the model's error for each of the scenario's
/// sensors. `None` while it is under way, `Some(None)` where it is impossible.
#[expect(clippy::option_option, reason = "a trial is under way, impossible or done")]
fn follow_freely(
    trial: &mut Option<Run>,
    free: &mut Option<Running>,
    scenario: impl FnOnce() -> Scenario,
    record: &Record,
    while_time: &mut dyn FnMut() -> bool,
) -> Option<Option<(Run, Vec<f64>)>> {
    if free.is_none() {
        *trial = follow(trial, scenario, record, FREE, while_time)?;
        *free = trial.as_ref().and_then(begin_freely);
    }
    if let (Some(running), Some(run)) = (free.as_mut(), &*trial)
        && !running.advance(run.record(), while_time)
    {
        return None;
    }
    let done = trial.take().zip(free.take());
    Some(done.and_then(|(run, running)| {
        let errors = errors(&run, &running.finish(run.record()))?;
        Some((run, errors))
    }))
}

/// The free run of the first filter's final model, before its first piece; none where the filter has stopped.
fn begin_freely(run: &Run) -> Option<Running> {
    let (scenario, record) = (run.scenario(), run.record());
    let estimates = run.estimates().first().filter(|estimates| estimates.stop().is_none())?;
    let model = Identified::at(scenario, &scenario.filters[0], estimates, estimates.len().checked_sub(1)?);
    Some(model.running(record, 0..record.len()))
}

/// The error of a free run for each of the scenario's sensors, if the model has not run away.
fn errors(run: &Run, free: &FreeRun) -> Option<Vec<f64>> {
    let of = |sensor: &Sensor| free.fit(run.record(), sensor.measures).map(|fit| fit.rms);
    let errors = run.scenario().sensors.iter().map(of).collect::<Option<Vec<f64>>>();
    errors.filter(|errors| errors.iter().all(|error| error.is_finite()))
}

/// The log likelihood of all innovations, if the filter went through.
fn likelihood(run: &Run) -> Option<f64> {
    let estimates = run.estimates().first().filter(|estimates| estimates.stop().is_none())?;
    let sum: f64 = (1..estimates.len()).map(|k| estimates.log_likelihood(k)).filter(|l| !l.is_nan()).sum();
    sum.is_finite().then_some(sum)
}

/// The size of the innovations over what the filter expects: 1 where they agree.
fn surprise(run: &Run) -> f64 {
    let Some(estimates) = run.estimates().first() else { return 1.0 };
    // The filter finds its parameters in the first half.
    let half = estimates.len() / 2..estimates.len();
    let measured = |k: usize| estimates.innovation(k).iter().filter(|e| !e.is_nan()).count();
    let (sum, count) = half
        .filter(|&k| !estimates.nis()[k].is_nan())
        .fold((0.0, 0), |(sum, count), k| (sum + estimates.nis()[k], count + measured(k)));
    let ratio = libm::sqrt(sum / f64::from(u32::try_from(count.max(1)).unwrap_or(u32::MAX)));
    if ratio.is_finite() { ratio.clamp(0.1, 10.0) } else { 1.0 }
}

/// The scenario with its first filter alone.
pub(super) fn first_alone(scenario: &Scenario) -> Scenario {
    Scenario { filters: scenario.filters.iter().take(1).cloned().collect(), ..scenario.clone() }
}
