//! Trials: the filter runs again with an edit made, and its likelihood shows, without any truth, whether that was the cause.

use std::sync::Arc;

use kalmanscope_core::setting::Edit;
use kalmanscope_core::{Diagnostics, Estimates, FilterKind, FilterSettings, Pass, Record, RunError, Scenario, Scores};

use super::cause::LikelyCause;
use super::diagnosis::{Diagnosis, Verdict};

/// Limits the samples of a trial; it takes the last ones of the record.
const WINDOW: usize = 10_000;

/// Limits the samples of a trial between two checks of the time: half a millisecond of the slowest step.
const CHUNK: usize = 100;

const USUAL: usize = 30;

pub(super) struct Trials {
    pub(super) record: Arc<Record>,
    pub(super) steps: usize,
    pub(super) scenario: Scenario,
    origin: FilterSettings,
    /// `None` until the unchanged filter has run, if its likely causes follow from that run.
    likely_causes: Option<Vec<LikelyCause>>,
    current: Option<(Pass, Estimates, Arc<Record>)>,
    first: usize,
    unturned: Option<Estimates>,
    pub(super) before: Option<TrialOutcome>,
    outcomes: Vec<TrialOutcome>,
    /// The log likelihood of the filter itself over the window, if a UKF stands in for it.
    pub(super) own: Option<f64>,
}

#[derive(Clone, Debug)]
pub(super) struct TrialOutcome {
    pub(super) log_likelihood: f64,
    /// The log likelihood with the edit made; `log_likelihood` may be that of a filter that is restarted.
    pub(super) achieved: f64,
    pub(super) scaled: f64,
    /// The final estimate of the parameter whose sign counts, in standard deviations; NaN without one.
    pub(super) learnt: f64,
    pub(super) verdict: Option<Verdict>,
}

impl TrialOutcome {
    pub(super) fn is_good(&self) -> bool {
        self.verdict.as_ref().is_some_and(|verdict| verdict.kind.is_good())
    }
}

impl Trials {
    pub(super) fn new(
        scenario: &Scenario,
        place: usize,
        estimates: &Estimates,
        record: &Record,
        likely_causes: Vec<LikelyCause>,
    ) -> Result<Self, RunError> {
        let filter = scenario.filters.get(place).ok_or(RunError::NoFilter(place))?;
        let mut filter = filter.clone();
        filter.smoother = false;
        let first = estimates.len().min(record.len()).saturating_sub(WINDOW);
        if record.forgotten() + first > 0 && !estimates.is_empty() {
            begin_at(&mut filter, estimates, first);
        }
        let likelihoods = (first.max(1)..estimates.len()).map(|k| estimates.log_likelihood(k));
        let own = filter.kind.is_sampled().then(|| likelihoods.filter(|x| !x.is_nan()).sum());
        filter.kind = if own.is_some() { FilterKind::UKF } else { filter.kind };
        let mut scenario = Scenario { filters: vec![filter], ..scenario.clone() };
        scenario.dt = record.dt();
        let record = record.part(first..estimates.len().min(record.len()));
        // A scenario that cannot begin is an error now, not at the first trial.
        Pass::new(&scenario, 0, &record)?;
        let origin = scenario.filters[0].clone();
        let steps = steps_of(&scenario);
        let trials = Self::over((Arc::new(record), steps), scenario, origin, Some(likely_causes));
        Ok(Self { first, own, ..trials })
    }

    /// `origin` is the filter before other causes' edits. Without `likely_causes`, they follow from its run.
    pub(super) fn over(
        (record, steps): (Arc<Record>, usize),
        scenario: Scenario,
        origin: FilterSettings,
        likely_causes: Option<Vec<LikelyCause>>,
    ) -> Self {
        let (current, first, unturned, before, outcomes, own) = Default::default();
        Self { record, steps, scenario, origin, likely_causes, current, first, unturned, before, outcomes, own }
    }

    pub(super) fn advance(&mut self, while_time: &mut dyn FnMut() -> bool) -> bool {
        while !self.is_done() {
            let Some((mut pass, mut estimates, record)) = self.current.take().or_else(|| self.begin()) else {
                let (none, learnt, verdict) = (f64::NEG_INFINITY, f64::NAN, None);
                self.outcomes.push(TrialOutcome {
                    log_likelihood: none,
                    achieved: none,
                    scaled: none,
                    learnt,
                    verdict,
                });
                continue;
            };
            pass.follow(&record, pass.done() + CHUNK, &mut estimates);
            if pass.done() < record.len() && pass.stop.is_none() {
                self.current = Some((pass, estimates, record));
            } else {
                self.finish(estimates, &record);
            }
            if !while_time() {
                break;
            }
        }
        self.is_done()
    }

    pub(super) fn is_done(&self) -> bool {
        self.before.is_some() && self.likely_causes.as_ref().is_none_or(|all| self.outcomes.len() == all.len())
    }

    pub(super) fn progress(&self) -> f64 {
        let done = usize::from(self.before.is_some()) + self.outcomes.len();
        let all = self.likely_causes.as_ref().map_or(USUAL, Vec::len);
        (done as f64 / (1 + all) as f64).min(1.0)
    }

    pub(super) fn tried(&self) -> impl Iterator<Item = (&LikelyCause, &TrialOutcome)> {
        self.likely_causes.iter().flatten().zip(&self.outcomes)
    }

    pub(super) fn price(&self) -> f64 {
        // A number must gain this much log likelihood, by Schwarz (1978).
        0.5 * libm::log(self.record.len().max(2) as f64)
    }

    fn current(&self) -> Option<&LikelyCause> {
        self.before.as_ref()?;
        self.likely_causes.as_ref()?.get(self.outcomes.len())
    }

    fn record_of(&self, scenario: &Scenario) -> Option<Arc<Record>> {
        match steps_of(scenario) / self.steps {
            0 | 1 => Some(Arc::clone(&self.record)),
            steps => self.record.as_ref().clone().with_hold(scenario.hold).finer(steps).map(Arc::new),
        }
    }

    fn begin(&self) -> Option<(Pass, Estimates, Arc<Record>)> {
        let scenario = match &self.before {
            None => self.scenario.clone(),
            Some(_) => {
                let edits = &self.current()?.edits;
                if edits.is_empty() {
                    return None;
                }
                Edit::apply_all(edits, &self.scenario).ok()?
            }
        };
        let record = self.record_of(&scenario)?;
        Some((Pass::new(&scenario, 0, &record).ok()?, Pass::history(&scenario, 0).ok()?, record))
    }

    fn finish(&mut self, estimates: Estimates, record: &Record) {
        let diagnostics = Diagnostics::new(&estimates, record);
        let stopped = diagnostics.stop.is_some();
        let log_likelihood = if stopped { f64::NEG_INFINITY } else { diagnostics.log_likelihood() };
        // A diagnosis takes time: only trials that gain get one.
        let gains = self.before.as_ref().is_none_or(|before| log_likelihood > before.log_likelihood);
        let diagnosis = if gains { Diagnosis::new(&diagnostics, &estimates, record) } else { None };
        let achieved = log_likelihood;
        let anew = self.current().filter(|one| one.begins_anew);
        let anew = anew.and_then(|likely| self.begun_anew(likely.samples.as_ref()?.start.checked_sub(self.first)?));
        let log_likelihood = anew.map_or(log_likelihood, |anew| anew.max(log_likelihood));
        let scaled = if stopped { f64::NEG_INFINITY } else { scaled_log_likelihood(&diagnostics) };
        let learnt = self.learnt(&estimates);
        if self.likely_causes.is_none() {
            let Self { scenario, origin, .. } = &*self;
            let of =
                |diagnosis: &Diagnosis| diagnosis.likely_causes(origin, scenario, 0, &diagnostics, &estimates, record);
            self.likely_causes = Some(diagnosis.as_ref().map_or_else(Vec::new, of));
        }
        let verdict = diagnosis.and_then(|diagnosis| diagnosis.verdict);
        let outcome = TrialOutcome { log_likelihood, achieved, scaled, learnt, verdict };
        match &self.before {
            None => (self.before, self.unturned) = (Some(outcome), Some(estimates)),
            Some(_) => self.outcomes.push(outcome),
        }
    }

    fn learnt(&self, estimates: &Estimates) -> f64 {
        let place = self.current().and_then(|likely| estimates.place(likely.sign?.0));
        match (place, estimates.len().checked_sub(1)) {
            (Some(place), Some(last)) => estimates.canonical_mean(last, place) / estimates.std(last, place),
            _ => f64::NAN,
        }
    }

    /// The log likelihood up to `at`, plus that of a filter restarted there with its means and initial standard deviations.
    fn begun_anew(&self, at: usize) -> Option<f64> {
        let unturned = self.unturned.as_ref().filter(|unturned| at > 0 && at < unturned.len())?;
        let mut scenario = self.scenario.clone();
        begin_at(scenario.filters.first_mut()?, unturned, at);
        let record = self.record_of(&scenario)?;
        let rest = record.part(at..record.len());
        let mut scores = Scores::new(&Pass::history(&scenario, 0).ok()?, &rest);
        let mut pass = Pass::new(&scenario, 0, &rest).ok()?;
        pass.follow(&rest, rest.len(), &mut scores.against(&rest));
        let before: f64 = (0..=at).map(|k| unturned.log_likelihood(k)).filter(|x| !x.is_nan()).sum();
        pass.stop.is_none().then(|| before + scores.outcome().log_likelihood)
    }
}

fn begin_at(filter: &mut FilterSettings, estimates: &Estimates, sample: usize) {
    for (&channel, mean) in estimates.channels().iter().zip(estimates.mean(sample)) {
        if !filter.knows(channel) {
            filter.initial_mean[channel] = *mean;
        }
    }
}

fn steps_of(scenario: &Scenario) -> usize {
    scenario.record.as_ref().map_or(1, |mapping| mapping.interpolate.max(1))
}

/// The factor changes neither gains nor innovations:
/// ```text
/// s² = Σ NIS / n,  L(s²) = L + ½ Σ NIS - ½ n (1 + ln s²)
/// ```
/// Source: Durbin and Koopman (2012), *Time Series Analysis by State Space Methods*, section 2.10.2.
fn scaled_log_likelihood(diagnostics: &Diagnostics) -> f64 {
    let total = diagnostics.nis_within(0..diagnostics.len());
    let n = f64::from(total.degrees);
    if n == 0.0 || total.sum <= 0.0 {
        return diagnostics.log_likelihood();
    }
    diagnostics.log_likelihood() + 0.5 * total.sum - 0.5 * n * (1.0 + libm::log(total.sum / n))
}
