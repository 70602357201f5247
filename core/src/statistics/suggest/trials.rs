//! Suggestions that are tried out: the making of a [`Suggestion`], a slice after the other.

use kalmanscope_records::{Record, Task};

use super::ambient::{Ambient, has_no_input};
use super::conditioning::{Course, CourseTrials, FILLING, LostReadings, Plucked};
use super::initial::Search;
use super::likeliest::{Trial, first_alone, frequency_error, likelihood, sizes, surprise};
use super::{Suggestion, first_for_trial};
use crate::{Run, Scenario};

const LIKELY: usize = 4096;

/// The same without an input: the size of an unknown force takes more samples to estimate.
const LIKELY_AMBIENT: usize = 8192;

/// For a motion that needs no noise, such as a decay, a white force must gain this much log likelihood.
const CLEARLY: f64 = 10.0;

/// Innovations of these sizes over their expected ones do not ask for another R.
const NEARLY: std::ops::Range<f64> = 0.99..1.01;

const BETTER: f64 = 0.5;

/// Parts of the motion's size that are tried for its process noise per step.
pub(super) const SHARES: [f64; 11] = [0.0, 1e-6, 3e-6, 1e-5, 3e-5, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2];

/// The making of suggested settings for a scenario's filters on a measured record: R from the high frequencies that the
/// input does not explain, ωₙ, ζ and gain from the response to the input (or the peak of the spectrum), the initial belief
/// from these, and Q by the likelihood of the innovations. So is the course of an input between its samples: linear as it was taken, held
/// or band-limited; and the exponent of a Bouc-Wen spring. R takes the size of the innovations where that is likelier. Without an input, a white force that moves the plant
/// ([`kalmanscope_filters::filter::White`]) is tried too. Where the scenario has a mapping, means are removed and a large gain
/// goes into the mapping; the record is then to be read again.
///
/// Of an equation that a user typed, the parameters that spectra do not tell are searched where there is an input: a filter begins
/// from points in their ranges. Settings of other plants without a natural frequency are left as they are, but for R and Q.
pub struct Suggest {
    suggestion: Suggestion,
    record: Record,
    plucked: Option<Plucked>,
    given: Option<(Record, Suggestion)>,
    lost: Option<LostReadings>,
    stage: TrialStage,
    trial: Trial,
    searches: Vec<Search>,
    between: Option<CourseTrials>,
    course: Option<(Course, Option<String>)>,
    likelihoods: Vec<(f64, f64, Vec<f64>)>,
    quieter: Option<(Suggestion, f64, f64)>,
    ambient: Option<Ambient>,
    timed: Option<Record>,
    errors: Vec<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum TrialStage {
    Data,
    GapTreatment,
    Search,
    CourseTrials,
    Likelihood(usize),
    WhiteForce,
    FreeRun,
    ModelError,
    Done,
}

impl Suggest {
    /// Suggestions for a scenario on a record, none made yet.
    pub fn new(scenario: &Scenario, record: Record) -> Self {
        let (longest, plucked) = Plucked::of(&record).unzip();
        Self {
            suggestion: Suggestion::new(scenario.clone()),
            record: longest.unwrap_or(record),
            plucked,
            stage: TrialStage::Data,
            given: None,
            lost: None,
            trial: Trial::default(),
            searches: Vec::new(),
            between: None,
            course: None,
            likelihoods: Vec::new(),
            quieter: None,
            ambient: None,
            timed: None,
            errors: Vec::new(),
        }
    }

    fn begin(&mut self, lost: Option<&LostReadings>) -> bool {
        let as_it_is = self.suggestion.scenario.record.is_none().then(|| self.record.clone());
        if self.suggestion.knows_zero() {
            let reason = "the means of input and readings stay: a nonlinear equation defines its own zero";
            self.suggestion.reasons.push(reason.to_owned());
        } else {
            self.suggestion.remove_means(&mut self.record);
        }
        let before = has_no_input(&self.record).then(|| self.suggestion.clone());
        self.suggestion.sensor_noise(&self.record, lost);
        let steps = self.course.as_ref().map_or(1, |(course, _)| course.steps());
        let decay = self.suggestion.motion(&mut self.record, steps);
        self.suggestion.substeps(self.record.dt() / steps as f64, None);
        self.ambient = before.filter(|_| decay != Some(true)).and_then(|before| {
            Ambient::new(
                Suggestion { reasons: before.reasons, replaceable: before.replaceable, ..self.suggestion.clone() },
                &mut self.record,
            )
        });
        if let Some(record) = as_it_is {
            self.record = record;
        }
        decay.is_some()
    }

    fn fill(&mut self, run: Option<&Run>) {
        let (Some(lost), Some((record, given))) = (self.lost.take(), &self.given) else { return };
        let Some(filled) = run.and_then(|run| lost.filled(run, record)) else { return };
        (self.suggestion, self.record) = (given.clone(), filled);
        self.begin(Some(&lost));
        lost.lose(&mut self.record);
    }

    fn begin_search(&mut self) -> TrialStage {
        if let Some((Course::BandLimited, _)) = self.course {
            self.take_course(Course::BandLimited);
        }
        self.searches = Search::all(&self.suggestion);
        if has_no_input(&self.record) {
            self.searches.drain(..).take(1).for_each(|search| search.give_up(&mut self.suggestion));
        }
        TrialStage::Search
    }

    fn take_course(&mut self, course: Course) {
        if let Some(record) = course.of(&self.record) {
            self.record = record;
            course.set(&mut self.suggestion.scenario);
        }
    }

    fn choose_course(&mut self) -> TrialStage {
        self.timed = self.ambient.as_ref().and_then(|_| self.record.clocks()).map(|_| self.record.clone());
        if self.timed.is_some() {
            self.record = self.record.clone().at_samples();
        }
        let Some(between) = self.between.take() else { return TrialStage::Likelihood(0) };
        let course = self.course.insert(between.chosen()).0;
        if course == Course::Linear {
            return TrialStage::Likelihood(0);
        }
        if let Some((record, given)) = self.given.take() {
            (self.record, self.suggestion) = (record, given);
        }
        if course == Course::Held {
            self.take_course(course);
        }
        TrialStage::Data
    }

    fn likely(&self) -> usize {
        let steps = self.course.as_ref().map_or(1, |(course, _)| course.steps());
        steps * if self.ambient.is_some() { LIKELY_AMBIENT } else { LIKELY }
    }

    fn choose(&mut self) -> TrialStage {
        let best = self.likelihoods.drain(..).max_by(|a, b| a.1.total_cmp(&b.1));
        let likelihood = best.as_ref().map_or(f64::NEG_INFINITY, |(_, likelihood, _)| *likelihood);
        let lead = if best.as_ref().is_some_and(|(share, ..)| *share > 0.0) { 0.0 } else { CLEARLY };
        if let Some(mut ambient) = self.ambient.take()
            && let Some((sizes, _)) = ambient.best().filter(|(_, white)| *white > likelihood + lead)
        {
            ambient.suggestion.take_white_force(&sizes);
            self.suggestion = ambient.suggestion;
            let reason =
                "a white force counts in samples: its filters take each reading at a sample, not at its own time";
            self.suggestion.reasons.extend(self.timed.as_ref().map(|_| reason.to_owned()));
            return TrialStage::Done;
        }
        if let Some(timed) = self.timed.take() {
            self.record = timed;
            return TrialStage::Likelihood(0);
        }
        let before = self.quieter.take();
        let is_open = self.suggestion.problem.is_none() && !has_no_input(&self.record);
        match (before.filter(|(.., before)| likelihood < before + BETTER), best) {
            (Some((suggestion, share, _)), _) => {
                self.suggestion = suggestion;
                self.suggestion.process_noise(share);
            }
            (None, Some((share, likelihood, sizes))) if is_open && sizes.iter().any(|size| !NEARLY.contains(size)) => {
                self.quieter = Some((self.suggestion.clone(), share, likelihood));
                self.suggestion.resize_noise(&sizes);
                return TrialStage::Likelihood(0);
            }
            (None, Some((share, ..))) => self.suggestion.process_noise(share),
            (None, None) => {}
        }
        TrialStage::FreeRun
    }

    fn follow(&mut self, while_time: &mut dyn FnMut() -> bool) -> Option<TrialStage> {
        Some(match self.stage {
            TrialStage::Data => {
                let (record, given) = (self.record.clone(), self.suggestion.clone());
                let is_decay = self.begin(None);
                if let Some(Plucked { whole, .. }) = self.plucked.take_if(|_| !is_decay) {
                    // A motion that continues through the pauses is one part.
                    (self.record, self.suggestion) = (whole, given);
                    return Some(TrialStage::Data);
                }
                if self.course.is_none() {
                    self.between = CourseTrials::of(&record, &given.scenario);
                }
                // Without a guess, no filter can know the motion in a gap.
                let can_fill = self.suggestion.problem.is_none() && self.suggestion.has_frequency();
                self.lost = LostReadings::of(&record).filter(|_| can_fill);
                self.given = Some((record, given));
                match (self.suggestion.scenario.filters.is_empty(), &self.lost) {
                    (true, _) => TrialStage::Done,
                    (false, None) => self.begin_search(),
                    (false, Some(_)) => TrialStage::GapTreatment,
                }
            }
            TrialStage::GapTreatment => {
                let scenario = || self.suggestion.with_share(FILLING);
                let run = self.trial.follow(scenario, &self.record, self.record.len(), while_time)?;
                self.fill(run.as_ref());
                self.begin_search()
            }
            TrialStage::Search => {
                let (samples, scenario) = (self.likely(), &self.suggestion.scenario);
                let Some(search) = self.searches.iter_mut().find(|search| !search.is_done()) else {
                    Search::choose(std::mem::take(&mut self.searches), &mut self.suggestion);
                    return Some(TrialStage::CourseTrials);
                };
                let run = self.trial.follow(|| search.scenario(scenario), &self.record, samples, while_time)?;
                search.take(run.as_ref());
                TrialStage::Search
            }
            TrialStage::CourseTrials => {
                let next = self.between.as_mut().and_then(|between| between.next(&self.suggestion, &self.record));
                if let Some((part, scenario)) = next {
                    let run = self.trial.follow(|| scenario, part, part.len(), while_time)?;
                    self.between.iter_mut().for_each(|between| between.take(run.as_ref()));
                    TrialStage::CourseTrials
                } else {
                    self.choose_course()
                }
            }
            TrialStage::Likelihood(place) => {
                let (share, samples) = (SHARES[place], self.likely());
                let scenario = || {
                    let mut scenario = self.suggestion.with_share(share);
                    self.ambient.iter().for_each(|ambient| ambient.leave_out(&mut scenario));
                    scenario
                };
                let run = self.trial.follow(scenario, &self.record, samples, while_time)?;
                self.likelihoods.extend(run.and_then(|run| Some((share, likelihood(&run)?, sizes(&run)))));
                if place + 1 < SHARES.len() { TrialStage::Likelihood(place + 1) } else { TrialStage::WhiteForce }
            }
            TrialStage::WhiteForce => {
                let samples = self.likely();
                if let Some(ambient) = &mut self.ambient
                    && let Some(sizes) = ambient.next()
                {
                    let scenario = || first_for_trial(&ambient.suggestion.with_white_force(&sizes));
                    let run = self.trial.follow(scenario, &self.record, samples, while_time)?;
                    ambient.take(run.and_then(|run| likelihood(&run)));
                    TrialStage::WhiteForce
                } else {
                    self.choose()
                }
            }
            TrialStage::FreeRun => {
                let scenario = || first_alone(&self.suggestion.scenario);
                let (run, errors) = self.trial.follow_freely(scenario, &self.record, while_time)?;
                if let Some(run) = run {
                    self.suggestion.substeps(self.record.dt(), frequency_error(&run, self.record.len()));
                    if run.estimates().first().is_some_and(|one| one.stop().is_some()) {
                        self.suggestion.keep_from_rounding();
                    }
                }
                // The errors of a default guess are no noise.
                self.errors = errors.filter(|_| self.suggestion.problem.is_none()).unwrap_or_default();
                if self.errors.is_empty() { TrialStage::Done } else { TrialStage::ModelError }
            }
            TrialStage::ModelError => {
                let scenario = || first_alone(&self.suggestion.with_error(&self.errors));
                let (run, after) = self.trial.follow_freely(scenario, &self.record, while_time)?;
                if let Some((run, after)) = run.zip(after) {
                    self.suggestion.model_error(&self.errors, &after, surprise(&run));
                }
                TrialStage::Done
            }
            TrialStage::Done => TrialStage::Done,
        })
    }
}

impl Task for Suggest {
    type Outcome = Suggestion;

    fn progress(&self) -> f64 {
        let all = (SHARES.len() + 4) as f64;
        match self.stage {
            TrialStage::Data | TrialStage::GapTreatment | TrialStage::Search if self.course.is_some() => 2.0 / all,
            TrialStage::Data | TrialStage::GapTreatment => 0.0,
            TrialStage::Search => self.searches.last().map_or(1.0, Search::progress) / all,
            TrialStage::CourseTrials => (1.0 + self.between.as_ref().map_or(1.0, CourseTrials::progress)) / all,
            TrialStage::Likelihood(place) => (2 + place) as f64 / all,
            TrialStage::WhiteForce => {
                let done = self.ambient.as_ref().map_or(1.0, |ambient| ambient.climb.progress());
                ((1 + SHARES.len()) as f64 + done) / all
            }
            TrialStage::FreeRun => (2 + SHARES.len()) as f64 / all,
            TrialStage::ModelError => (3 + SHARES.len()) as f64 / all,
            TrialStage::Done => 1.0,
        }
    }

    fn advance(&mut self, while_time: &mut dyn FnMut() -> bool) -> bool {
        while self.stage != TrialStage::Done {
            let Some(next) = self.follow(while_time) else { return false };
            self.stage = next;
            if !while_time() {
                break;
            }
        }
        self.stage == TrialStage::Done
    }

    fn finish(mut self) -> Suggestion {
        let kept = std::mem::take(&mut self.suggestion.replaceable).into_iter().filter(|reason| !reason.is_empty());
        self.suggestion.reasons.extend(kept.chain(self.course.and_then(|(_, sentence)| sentence)));
        self.plucked.iter().for_each(|plucked| plucked.apply(&mut self.suggestion));
        self.suggestion
    }
}
