//! Trials: the filter runs again with a knob turned, and what it then makes of the record tells whether that was the cause.
//! No truth is needed.

use super::Diagnosis;
use super::cause::Suspect;
use super::knob::Knob;
use super::verdict::Verdict;
use super::window::window;
use crate::sorting::sort_short_by;
use crate::{Diagnostics, Estimates, FilterKind, Pass, Record, RunError, Scenario, Scores};

/// Limits the samples of a trial, which are the last ones of the record.
const WINDOW: usize = 10_000;

/// Limits the samples of a trial between two checks of the time: half a millisecond of the slowest step.
const CHUNK: usize = 100;

/// Limits the gain in log likelihood, less what its numbers would gain by chance, below which no cause is named.
const WORTH: f64 = 8.0;

/// Limits a parameter whose sign is said from below, in standard deviations.
const SIGNIFICANT: f64 = 4.0;

/// A cause explains a record better than noise where its log likelihood is larger by this.
const BEYOND: f64 = 20.0;

/// Whether a suspect is noise that the filter takes to be too small or too large.
fn is_noise(suspect: &Suspect) -> bool {
    matches!(suspect.cause.key, "sensor_noise" | "process_noise" | "felt_disturbance")
}

/// A cause, and what its knob does to the filter.
#[derive(Clone, Debug)]
pub struct Finding {
    /// The cause, its evidence and its knob.
    pub suspect: Suspect,
    /// The log likelihood that the knob gains over the window, less half the logarithm of the number of samples for each
    /// number that is fitted (the Bayesian information criterion); NaN where it has not been tried.
    ///
    /// Source: Schwarz (1978), Estimating the dimension of a model, *The Annals of Statistics* 6.
    pub gain: f64,
    /// The verdict on the filter with the knob turned, over the window.
    pub after: Option<Verdict>,
}

/// The trials of all suspects of one filter, which can be cut into slices of time.
pub struct Trials {
    record: Record,
    /// The scenario with that one filter, as it begins at the window's first sample.
    scenario: Scenario,
    suspects: Vec<Suspect>,
    current: Option<(Pass, Estimates)>,
    /// The sample of the run's record at which the window begins.
    first: usize,
    /// The estimates and likelihoods of the filter with no knob turned, for filters that begin anew.
    unturned: Option<Estimates>,
    /// The result without any knob turned.
    before: Option<Outcome>,
    outcomes: Vec<Outcome>,
    /// The log likelihood of the filter itself over the window, where another one stands in for it.
    own: Option<f64>,
}

/// The result of one trial.
#[derive(Clone, Debug)]
struct Outcome {
    log_likelihood: f64,
    /// The same with all covariances scaled by what makes the log likelihood largest.
    scaled: f64,
    /// The parameter whose sign decides what to say, at last, in standard deviations; NaN where there is none.
    learnt: f64,
    verdict: Option<Verdict>,
}

impl Outcome {
    const NOTHING: Self =
        Self { log_likelihood: f64::NEG_INFINITY, scaled: f64::NEG_INFINITY, learnt: f64::NAN, verdict: None };

    /// Whether the filter with the knob turned is to be believed.
    fn is_good(&self) -> bool {
        self.verdict.as_ref().is_some_and(|verdict| verdict.kind.is_good())
    }
}

impl Trials {
    /// The trials of the suspects of the filter at `place` of a scenario, whose estimates on a record these are. Where the
    /// filter is a sampled one, a UKF stands in for it.
    ///
    /// # Errors
    /// [`RunError`] where the scenario has no such filter, or the record is not one of such a scenario.
    pub fn new(
        scenario: &Scenario,
        place: usize,
        estimates: &Estimates,
        record: &Record,
        suspects: Vec<Suspect>,
    ) -> Result<Self, RunError> {
        let filter = scenario.filters.get(place).ok_or(RunError::NoFilter(place))?;
        let mut filter = filter.clone();
        filter.smoother = false;
        let first = estimates.len().min(record.len()).saturating_sub(WINDOW);
        if record.forgotten() + first > 0 && !estimates.is_empty() {
            for (channel_place, &channel) in estimates.channels().iter().enumerate() {
                if !filter.knows(channel) {
                    filter.initial_mean[channel] = estimates.mean(first)[channel_place];
                }
            }
        }
        let mut own = None;
        if filter.kind.is_sampled() {
            filter.kind = FilterKind::UKF;
            own = Some(
                (first.max(1)..estimates.len()).map(|k| estimates.log_likelihood(k)).filter(|x| !x.is_nan()).sum(),
            );
        }
        let mut scenario = Scenario { filters: vec![filter], ..scenario.clone() };
        scenario.dt = record.dt();
        let record = window(record, first..estimates.len().min(record.len()));
        let (outcomes, before) = (Vec::new(), None);
        let trials = Self { record, scenario, suspects, current: None, first, unturned: None, before, outcomes, own };
        // A scenario that cannot begin is an error now, not at the first trial.
        Pass::new(&trials.scenario, 0, &trials.record)?;
        Ok(trials)
    }

    /// Goes on for as long as `while_time` says that there is time, which is asked after each little piece of work. Returns
    /// whether all is done.
    pub fn advance(&mut self, while_time: &mut dyn FnMut() -> bool) -> bool {
        while !self.is_done() {
            let Some((mut pass, mut estimates)) = self.current.take().or_else(|| self.begin()) else {
                self.outcomes.push(Outcome::NOTHING);
                continue;
            };
            pass.follow(&self.record, pass.done() + CHUNK, &mut estimates);
            if pass.done() < self.record.len() && pass.stop().is_none() {
                self.current = Some((pass, estimates));
            } else {
                self.finish(estimates);
            }
            if !while_time() {
                break;
            }
        }
        self.is_done()
    }

    /// Whether there is nothing left to try.
    pub fn is_done(&self) -> bool {
        self.before.is_some() && self.outcomes.len() == self.suspects.len()
    }

    /// The share that is done, from 0 to 1.
    pub fn progress(&self) -> f64 {
        let done = usize::from(self.before.is_some()) + self.outcomes.len();
        done as f64 / (1 + self.suspects.len()) as f64
    }

    /// The verdict on the filter over the window as it is; none before it is known.
    pub fn before(&self) -> Option<&Verdict> {
        self.before.as_ref()?.verdict.as_ref()
    }

    /// The causes that have been found so far, each once: those whose knob makes the filter one to be believed come first,
    /// then the likeliest.
    pub fn findings(&self) -> Vec<Finding> {
        let Some(before) = &self.before else { return Vec::new() };
        let penalty = 0.5 * libm::log(self.record.len().max(2) as f64);
        let tried = || self.suspects.iter().zip(&self.outcomes);
        // A noise that is taken to be larger explains any misfit a little. Where another cause explains the record better than
        // any noise does, were all noise left open, that one comes first.
        let open = |suspect: &Suspect, outcome: &Outcome| {
            outcome.scaled - before.log_likelihood - penalty * (suspect.fitted + 1.0)
        };
        let of_noise =
            tried().filter(|(suspect, _)| is_noise(suspect)).map(|(suspect, outcome)| open(suspect, outcome));
        let of_noise = of_noise.fold(before.scaled - before.log_likelihood - penalty, f64::max);
        // Hysteresis fits more than a cubic part does, also where the spring hardens, which hysteresis does not.
        let hardens = |softening: &Outcome| {
            tried().any(|(suspect, outcome)| {
                suspect.sign.is_some()
                    && outcome.learnt > SIGNIFICANT
                    && outcome.log_likelihood - before.log_likelihood - penalty * suspect.fitted > WORTH
                    && (outcome.is_good() || !softening.is_good())
            })
        };
        let mut all: Vec<(f64, Finding)> = Vec::new();
        for (suspect, outcome) in tried().filter(|(suspect, outcome)| !(suspect.softens && hardens(outcome))) {
            let mut gain = outcome.log_likelihood - before.log_likelihood - penalty * suspect.fitted;
            if let Some(own) = self.own.filter(|_| suspect.cause.key == "collapsed_sample") {
                gain = before.log_likelihood - own;
            }
            let is_worth = suspect.certain || gain > WORTH;
            if !is_worth {
                continue;
            }
            let open = open(suspect, outcome);
            let is_beyond = !is_noise(suspect) && open > of_noise + BEYOND;
            let rank = if is_beyond { gain.max(open) } else { gain };
            let mut suspect = suspect.clone();
            if let Some(sign) = suspect.sign.filter(|_| outcome.learnt.abs() > SIGNIFICANT) {
                let sentence = if outcome.learnt > 0.0 { sign.positive } else { sign.negative };
                suspect.sentence = sentence.to_owned();
            }
            let finding = Finding { suspect, gain, after: outcome.verdict.clone() };
            match all.iter_mut().find(|(_, other)| other.suspect.cause.key == finding.suspect.cause.key) {
                Some((other, _)) if *other >= rank => {}
                Some(other) => *other = (rank, finding),
                None => all.push((rank, finding)),
            }
        }
        sort_short_by(&mut all, |(a, one), (b, other)| {
            // What ends good stands before what is only likelier.
            let key = |rank: f64, Finding { suspect, after, .. }: &Finding| {
                let ends_good = after.as_ref().is_some_and(|verdict| verdict.kind.is_good());
                (suspect.certain, !suspect.silences, ends_good, rank, suspect.weight)
            };
            key(*b, other).partial_cmp(&key(*a, one)).unwrap_or(std::cmp::Ordering::Equal)
        });
        all.into_iter().map(|(_, finding)| finding).collect()
    }

    /// The next trial at its first sample; none where its settings are not possible.
    fn begin(&self) -> Option<(Pass, Estimates)> {
        let scenario = match &self.before {
            None => self.scenario.clone(),
            Some(_) => {
                let knobs = &self.suspects[self.outcomes.len()].knobs;
                if knobs.is_empty() {
                    return None;
                }
                Knob::apply_all(knobs, &self.scenario).ok()?
            }
        };
        Some((Pass::new(&scenario, 0, &self.record).ok()?, Pass::history(&scenario, 0).ok()?))
    }

    fn finish(&mut self, estimates: Estimates) {
        let diagnostics = Diagnostics::new(&estimates, &self.record);
        let stopped = diagnostics.stop().is_some();
        let log_likelihood = if stopped { f64::NEG_INFINITY } else { diagnostics.log_likelihood() };
        let gains = self.before.as_ref().is_none_or(|before| log_likelihood > before.log_likelihood);
        let diagnosis = if gains { Diagnosis::new(&diagnostics, &estimates, &self.record, None) } else { None };
        let anew = self.suspects.get(self.outcomes.len()).filter(|one| self.before.is_some() && one.begins_anew);
        let anew = anew.and_then(|suspect| self.begun_anew(suspect.samples.as_ref()?.start.checked_sub(self.first)?));
        let log_likelihood = anew.map_or(log_likelihood, |anew| anew.max(log_likelihood));
        let scaled = if stopped { f64::NEG_INFINITY } else { scaled_log_likelihood(&diagnostics) };
        let learnt = self.learnt(&estimates);
        let verdict = diagnosis.and_then(|diagnosis| diagnosis.verdict);
        let outcome = Outcome { log_likelihood, scaled, learnt, verdict };
        match &self.before {
            None => (self.before, self.unturned) = (Some(outcome), Some(estimates)),
            Some(_) => self.outcomes.push(outcome),
        }
    }
}

impl Trials {
    /// The parameter whose sign decides what is said of the current suspect, at last, in standard deviations.
    fn learnt(&self, estimates: &Estimates) -> f64 {
        let suspect = self.suspects.get(self.outcomes.len()).filter(|_| self.before.is_some());
        let place = suspect.and_then(|suspect| estimates.place(suspect.sign?.channel));
        match (place, estimates.len().checked_sub(1)) {
            (Some(place), Some(last)) => estimates.canonical_mean(last, place) / estimates.std(last, place),
            _ => f64::NAN,
        }
    }

    /// The log likelihood of the filter as it is up to sample `at` of the window, and of one that begins anew there, with what
    /// it believes of the motion and as much doubt about the parameters as at first.
    fn begun_anew(&self, at: usize) -> Option<f64> {
        let unturned = self.unturned.as_ref().filter(|unturned| at > 0 && at < unturned.len())?;
        let mut scenario = self.scenario.clone();
        let filter = scenario.filters.first_mut()?;
        for (place, &channel) in unturned.channels().iter().enumerate() {
            if !filter.knows(channel) {
                filter.initial_mean[channel] = unturned.mean(at)[place];
            }
        }
        let rest = window(&self.record, at..self.record.len());
        let mut scores = Scores::new(&Pass::history(&scenario, 0).ok()?, &rest);
        let mut pass = Pass::new(&scenario, 0, &rest).ok()?;
        pass.follow(&rest, rest.len(), &mut scores.against(&rest));
        let before: f64 = (0..=at).map(|k| unturned.log_likelihood(k)).filter(|x| !x.is_nan()).sum();
        pass.stop().is_none().then(|| before + scores.log_likelihood())
    }
}

/// The log likelihood of a filter whose P, Q and R are all multiplied by one factor, at the best such factor s²: its gains, and
/// so its innovations, are the same.
///
/// ```text
/// s² = Σ NIS / n,  L(s²) = L + ½ Σ NIS - ½ n (1 + ln s²)
/// ```
///
/// Source: Durbin and Koopman (2012), *Time Series Analysis by State Space Methods*, section 2.10.2.
fn scaled_log_likelihood(diagnostics: &Diagnostics) -> f64 {
    let total = diagnostics.nis_within(0..diagnostics.len());
    let n = f64::from(total.degrees);
    if n == 0.0 || total.sum <= 0.0 {
        return diagnostics.log_likelihood();
    }
    diagnostics.log_likelihood() + 0.5 * total.sum - 0.5 * n * (1.0 + libm::log(total.sum / n))
}
