//! Suggestions that are tried out: the making of a [`Suggestion`], a slice after the other.

use kalmanscope_records::task::{Progress, pause};
use kalmanscope_records::{Record, Work};

use super::Suggestion;
use super::ambient::{Ambient, has_no_input};
use super::conditioning::{Course, FILLING, LostReadings, Plucked, has_open_course, likeliest_course};
use super::initial::Search;
use super::likeliest::{first_alone, frequency_error, likelihood, sizes, surprise, tried, tried_freely};
use crate::Scenario;

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

/// Begins to suggest settings for a scenario's filters on a measured record.
///
/// R comes from high frequencies, ωₙ, ζ and gain from the response to the input or the peak of the spectrum, the initial belief from
/// these, and Q from the likelihood of innovations; so do an input's course between samples and the exponent of a Bouc-Wen spring.
/// With a mapping, means and a large gain go there: read the record again then.
///
/// Other parameters of a typed equation are searched if there is an input. Other plants without a natural frequency get R and Q.
pub fn begin(scenario: &Scenario, record: Record) -> Work<Suggestion> {
    let (longest, plucked) = Plucked::of(&record).unzip();
    let (scenario, record) = (scenario.clone(), longest.unwrap_or(record));
    let replaceable = vec![String::new(); scenario.sensors.len() + 1];
    let suggestion = Suggestion { scenario, reasons: Vec::new(), problem: None, replaceable };
    Work::new(|progress| Maker { suggestion, record, plucked, course: None, ambient: None, progress }.made())
}

struct Maker {
    suggestion: Suggestion,
    record: Record,
    plucked: Option<Plucked>,
    course: Option<(Course, Option<String>)>,
    ambient: Option<Ambient>,
    progress: Progress,
}

/// Parts of the work, for its progress: searches, courses, the shares, white force, free run, model error.
const STAGES: f64 = (SHARES.len() + 5) as f64;

impl Maker {
    async fn made(mut self) -> Suggestion {
        if self.guess().await && self.choose_noise().await {
            self.compare_free_runs().await;
        }
        let kept = std::mem::take(&mut self.suggestion.replaceable).into_iter().filter(|reason| !reason.is_empty());
        self.suggestion.reasons.extend(kept.chain(self.course.and_then(|(_, sentence)| sentence)));
        self.plucked.iter().for_each(|plucked| plucked.apply(&mut self.suggestion));
        self.suggestion
    }

    fn at(&self, stage: usize, share: f64) {
        self.progress.set((stage as f64 + share) / STAGES);
    }

    /// From the data, then by searches, and again where the input has another course between samples. Returns false without a filter.
    async fn guess(&mut self) -> bool {
        loop {
            let (record, given) = (self.record.clone(), self.suggestion.clone());
            let is_decay = self.begin(None);
            if let Some(Plucked { whole, .. }) = self.plucked.take_if(|_| !is_decay) {
                // A motion that continues through the pauses is one part.
                (self.record, self.suggestion) = (whole, given);
                continue;
            }
            if self.suggestion.scenario.filters.is_empty() {
                return false;
            }
            pause().await;
            // Without a guess, no filter can know the motion in a gap.
            let can_fill = self.suggestion.problem.is_none() && self.suggestion.has_frequency();
            if let Some(lost) = LostReadings::of(&record).filter(|_| can_fill) {
                let scenario = self.suggestion.with_share(FILLING);
                let run = tried(&scenario, &self.record, self.record.len()).await;
                if let Some(filled) = run.and_then(|run| lost.filled(&run, &record)) {
                    (self.suggestion, self.record) = (given.clone(), filled);
                    self.begin(Some(&lost));
                    lost.lose(&mut self.record);
                }
            }
            if let Some((Course::BandLimited, _)) = self.course {
                self.take_course(Course::BandLimited);
            }
            self.search().await;
            if self.course.is_some() || !has_open_course(&record, &given.scenario) {
                return true;
            }
            let found = likeliest_course(&self.suggestion, &self.record, |share| self.at(1, share)).await;
            let course = self.course.insert(found).0;
            if course == Course::Linear {
                return true;
            }
            (self.record, self.suggestion) = (record, given);
            if course == Course::Held {
                self.take_course(course);
            }
        }
    }

    fn begin(&mut self, lost: Option<&LostReadings>) -> bool {
        let as_it_is = self.suggestion.scenario.record.is_none().then(|| self.record.clone());
        if self.suggestion.own_parameters().is_some_and(|(equation, _)| !equation.is_linear()) {
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
            let Suggestion { reasons, replaceable, .. } = before;
            Ambient::new(Suggestion { reasons, replaceable, ..self.suggestion.clone() }, &mut self.record)
        });
        if let Some(record) = as_it_is {
            self.record = record;
        }
        decay.is_some()
    }

    fn take_course(&mut self, course: Course) {
        if let Some(record) = course.of(&self.record, &mut self.suggestion.scenario) {
            self.record = record;
        }
    }

    async fn search(&mut self) {
        let mut searches = Search::all(&self.suggestion);
        if has_no_input(&self.record) {
            searches.into_iter().take(1).for_each(|search| search.give_up(&mut self.suggestion));
            return;
        }
        for search in &mut searches {
            let scenario = &self.suggestion.scenario;
            search.run(scenario, &self.record, self.likely(), |share| self.at(0, share)).await;
        }
        Search::choose(searches, &mut self.suggestion);
    }

    fn likely(&self) -> usize {
        let steps = self.course.as_ref().map_or(1, |(course, _)| course.steps());
        steps * if self.ambient.is_some() { LIKELY_AMBIENT } else { LIKELY }
    }

    async fn likeliest_share(&self) -> Option<(f64, f64, Vec<f64>)> {
        let mut all = Vec::new();
        for (place, share) in SHARES.into_iter().enumerate() {
            self.at(2 + place, 0.0);
            let mut scenario = self.suggestion.with_share(share);
            // Likelihoods compare on equal readings.
            let left_out = self.ambient.iter().flat_map(|ambient| &ambient.left_out);
            left_out.for_each(|quantity| scenario.remove_sensor(*quantity));
            let run = tried(&scenario, &self.record, self.likely()).await;
            all.extend(run.and_then(|run| Some((share, likelihood(&run)?, sizes(&run)))));
        }
        all.into_iter().max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Takes the likeliest of Q and R, or of a white force. Returns false for that: it leaves nothing to a free run.
    async fn choose_noise(&mut self) -> bool {
        let timed = self.ambient.as_ref().and_then(|_| self.record.clocks()).map(|_| self.record.clone());
        if timed.is_some() {
            // A white force drops the readings between samples: with these, Q would win by their number alone.
            self.record = self.record.clone().at_samples();
        }
        let mut best = self.likeliest_share().await;
        let likelihood = |best: &Option<(f64, f64, Vec<f64>)>| best.as_ref().map_or(f64::NEG_INFINITY, |best| best.1);
        let samples = self.likely();
        if let Some(mut ambient) = self.ambient.take() {
            let lead = if best.as_ref().is_some_and(|(share, ..)| *share > 0.0) { 0.0 } else { CLEARLY };
            let found = ambient.best(&self.record, samples, |share| self.at(2 + SHARES.len(), share)).await;
            if let Some((sizes, _)) = found.filter(|(_, white)| *white > likelihood(&best) + lead) {
                ambient.suggestion.take_white_force(&sizes);
                self.suggestion = ambient.suggestion;
                let reason =
                    "a white force counts in samples: its filters take each reading at a sample, not at its own time";
                self.suggestion.reasons.extend(timed.map(|_| reason.to_owned()));
                return false;
            }
        }
        if let Some(timed) = timed {
            self.record = timed;
            best = self.likeliest_share().await;
        }
        let is_open = self.suggestion.problem.is_none() && !has_no_input(&self.record);
        let is_other = |sizes: &[f64]| sizes.iter().any(|size| !NEARLY.contains(size));
        // R of a fifth of the spectrum is off by several percent, and verdicts mind innovations² that are off by 12 %.
        while let Some((share, before, sizes)) = best.take_if(|(.., sizes)| is_open && is_other(sizes)) {
            let quieter = self.suggestion.clone();
            self.suggestion.resize_noise(&sizes);
            best = self.likeliest_share().await;
            if likelihood(&best) < before + BETTER {
                self.suggestion = quieter;
                best = Some((share, before, sizes));
                break;
            }
        }
        best.iter().for_each(|(share, ..)| self.suggestion.process_noise(*share));
        true
    }

    async fn compare_free_runs(&mut self) {
        self.at(3 + SHARES.len(), 0.0);
        let scenario = first_alone(&self.suggestion.scenario);
        let Some((run, errors)) = tried_freely(&scenario, &self.record).await else { return };
        // As fine as σ of ωₙ at the end asks for: by the steps of the guess, a UKF ended up to nine σ off.
        self.suggestion.substeps(self.record.dt(), frequency_error(&run, self.record.len()));
        if run.estimates().first().is_some_and(|one| one.stop().is_some()) {
            self.suggestion.keep_from_rounding();
        }
        // The errors of a default guess are no noise.
        let Some(errors) = errors.filter(|_| self.suggestion.problem.is_none()) else { return };
        if errors.is_empty() {
            return;
        }
        self.at(4 + SHARES.len(), 0.0);
        let scenario = first_alone(&self.suggestion.with_error(&errors));
        if let Some((run, Some(after))) = tried_freely(&scenario, &self.record).await {
            self.suggestion.model_error(&errors, &after, surprise(&run));
        }
    }
}
