//! The search for remedies of several causes. It repairs one cause, diagnoses the filter again, and tries causes of the
//! remaining misfit on the repaired filter.
//!
//! ```text
//! filter ──trials──▶ causes ──the best repaired──▶ filter ──trials──▶ causes ... until it is good or nothing pays
//! ```
//!
//! Each cause must gain more log likelihood than the price of the numbers that it fits. The last step removes causes
//! that a later one has made needless.

mod choice;

use super::law::{ForceInHindsight, Law};
use super::path::Path;
use super::ranking::{Ranked, WORTH, compare};
use super::remedy::Remedy;
use super::trial::Trials;
use super::verdict::Verdict;
use crate::Task;

/// Limits the causes of one remedy.
const STEPS: usize = 4;

/// Limits the filters on which causes are tried, with the first one: each takes some thirty runs over the window.
const FILTERS: usize = 6;

/// The share of the search before needless causes are left out.
const NEARLY: f64 = 0.99;

/// The key of the cause with a force to look at.
const UNKNOWN_FORCE: &str = "unknown_force";

/// A search in progress, which can be cut into slices of time.
pub struct Search {
    trials: Trials,
    stage: Stage,
    /// The causes that were tried alone.
    alone: Vec<Ranked>,
    before: Option<Verdict>,
    /// The log likelihood of the unchanged filter.
    likelihood: f64,
    /// The unchanged filter.
    origin: Path,
    paths: Vec<Path>,
    /// The filters on which causes were tried.
    filters: usize,
    /// The law that an unknown force follows, in words.
    law: Option<Law>,
}

/// The use of the trials that are under way.
enum Stage {
    /// Causes of the unchanged filter, or of the remaining misfit on a path.
    Causes(Option<usize>),
    /// A run of the path at a place without one of its causes.
    Without {
        path: usize,
        step: usize,
        shorter: Box<Path>,
    },
    /// The smoothed unknown force of a remedy, before the search goes on or at its end.
    Force {
        force: ForceInHindsight,
        is_last: bool,
    },
    Done,
}

impl Search {
    /// The search that begins with the trials of a filter's causes.
    pub(super) fn new(trials: Trials) -> Self {
        let origin = Path::new(trials.scenario());
        let (stage, filters) = (Stage::Causes(None), 1);
        let (alone, paths) = (Vec::new(), Vec::new());
        Self { trials, stage, alone, before: None, likelihood: f64::NAN, origin, paths, filters, law: None }
    }

    /// Whether there is nothing left to try.
    pub fn is_done(&self) -> bool {
        matches!(self.stage, Stage::Done)
    }

    /// The verdict on the unchanged filter over the window, once it is known.
    pub fn before(&self) -> Option<&Verdict> {
        self.before.as_ref().or_else(|| self.trials.before().filter(|_| matches!(self.stage, Stage::Causes(None))))
    }

    /// The remedies that have been found so far, each of one cause or several: those that end in a good verdict come
    /// first, then the likeliest. No two begin with the same cause, or have the same causes.
    pub fn remedies(&self) -> Vec<Remedy> {
        if matches!(self.stage, Stage::Causes(None)) {
            return self.trials.remedies();
        }
        let price = |key: &str, rank: f64| if key == UNKNOWN_FORCE { self.priced(rank) } else { rank };
        let alone = self
            .alone
            .iter()
            .map(|Ranked { remedy, rank, achieved }| (remedy.clone(), price(remedy.first.cause.key, *rank), *achieved));
        let mut all: Vec<(Remedy, f64, f64)> = alone.collect();
        for path in self.paths.iter().filter(|path| path.len() > 1 || path.is_tried) {
            if self.paths.iter().any(|fewer| fewer.is_enough_for(path)) {
                continue;
            }
            let Some(remedy) = path.remedy() else { continue };
            let (key, path_rank) = (remedy.first.cause.key, self.rank(path));
            match all.iter_mut().find(|(other, ..)| other.first.cause.key == key) {
                // Remedies that begin with the same cause are compared by their own gain, not by that with all noise
                // fitted.
                Some((other, rank, gain)) if compare((&remedy, path.gain), (other, *gain)).is_gt() => {
                    (*other, *rank, *gain) = (remedy, rank.max(path_rank), path.gain);
                }
                Some(_) => {}
                None => all.push((remedy, path_rank, path.gain)),
            }
        }
        all.sort_by(|(a, a_rank, _), (b, b_rank, _)| compare((b, *b_rank), (a, *a_rank)));
        let mut told: Vec<Vec<&str>> = Vec::new();
        let mut remedies: Vec<Remedy> = all.into_iter().map(|(remedy, ..)| remedy).collect();
        remedies.retain(|remedy| {
            let mut keys: Vec<&str> = remedy.causes().map(|likely| likely.cause.key).collect();
            keys.sort_unstable();
            let is_new = !told.contains(&keys);
            told.push(keys);
            is_new
        });
        if let Some(law) = &self.law {
            let causes = remedies.iter_mut().flat_map(Remedy::causes_mut);
            let forces = causes.filter(|likely| likely.cause.key == UNKNOWN_FORCE);
            forces.for_each(|likely| likely.sentence = format!("{}; {}", likely.sentence, law.text));
        }
        remedies
    }

    /// Takes in the results of the trials, and begins the next ones.
    fn conclude(&mut self) {
        match std::mem::replace(&mut self.stage, Stage::Done) {
            Stage::Causes(on) => {
                let ranked = self.trials.ranked();
                let base = on.map_or(&self.origin, |place| &self.paths[place]);
                let then = |one: &Ranked| {
                    let likely = &one.remedy.first;
                    let path = base.then(one, self.trials.price())?;
                    let pays = path.gain - base.gain > WORTH || likely.certain && path.gain.is_finite();
                    (pays && !likely.edits.is_empty() && !likely.silences).then_some(path)
                };
                let next: Vec<Path> = ranked.iter().filter_map(then).collect();
                for path in next {
                    let causes = path.causes();
                    let is_known = |other: &Path| other.causes() == causes && other.gain >= path.gain;
                    if on.is_none() || !self.paths.iter().any(is_known) {
                        self.paths.push(path);
                    }
                }
                if on.is_none() {
                    self.before = self.trials.before().cloned();
                    self.likelihood = self.trials.outcome_before().map_or(f64::NAN, |before| before.log_likelihood);
                    self.alone = ranked;
                    return self.look_at_force(false);
                }
                self.try_next();
            }
            Stage::Without { path, step, mut shorter } => {
                if let Some(outcome) = self.trials.outcome_before() {
                    let price = self.trials.price() * shorter.fitted();
                    shorter.gain = outcome.log_likelihood - self.likelihood - price;
                    shorter.after = outcome.verdict.clone();
                    shorter.rank += shorter.gain - self.paths[path].gain;
                }
                let precedence = |path: &Path| path.remedy().map(|remedy| remedy.precedence());
                let is_better =
                    shorter.gain >= self.paths[path].gain && precedence(&shorter) >= precedence(&self.paths[path]);
                if is_better {
                    self.paths[path] = *shorter;
                    self.shorten(path, 0);
                } else {
                    self.shorten(path, step + 1);
                }
            }
            Stage::Force { force, is_last } => {
                self.law = force.law(self.trials.record().dt());
                if !is_last {
                    self.try_next();
                }
            }
            Stage::Done => {}
        }
    }

    /// Begins to leave out needless causes of the remedy that stands first.
    fn shorten_first(&mut self) {
        match self.remedies().first().and_then(|first| self.place_of(first)) {
            Some(path) => self.shorten(path, 0),
            None => self.look_at_force(true),
        }
    }

    /// The place of the path that a remedy came from.
    fn place_of(&self, remedy: &Remedy) -> Option<usize> {
        let is_it = |path: &Path| path.remedy().is_some_and(|other| other.edits == remedy.edits);
        self.paths.iter().position(is_it)
    }

    /// Looks at the unknown force of the first remedy that has one, and then goes on or ends.
    fn look_at_force(&mut self, is_last: bool) {
        let has_force = |remedy: &Remedy| remedy.causes().any(|likely| likely.cause.key == UNKNOWN_FORCE);
        let place = self.remedies().iter().find(|one| has_force(one)).and_then(|remedy| self.place_of(remedy));
        let place = place.filter(|_| self.law.is_none());
        let force = place.and_then(|path| ForceInHindsight::new(&self.paths[path].scenario, self.trials.record()));
        match force {
            Some(force) => self.stage = Stage::Force { force, is_last },
            None if is_last => self.stage = Stage::Done,
            None => self.try_next(),
        }
    }

    /// Tries a path without its cause at `step`, or without a later one.
    fn shorten(&mut self, path: usize, step: usize) {
        let whole = &self.paths[path];
        let can = |step: &usize| whole.len() > 1 && *step + 1 < whole.len();
        let shorter =
            (step..).take_while(can).find_map(|step| Some((step, whole.without(step, &self.origin.scenario)?)));
        match shorter {
            Some((step, shorter)) => {
                self.run(&shorter, false);
                self.stage = Stage::Without { path, step, shorter: Box::new(shorter) };
            }
            None => self.look_at_force(true),
        }
    }

    /// Runs the filter of a path, and tries its causes if asked to.
    fn run(&mut self, path: &Path, with_causes: bool) {
        let likely_causes = if with_causes { None } else { Some(Vec::new()) };
        let Some(origin) = self.origin.scenario.filters.first().cloned() else { return };
        self.trials = Trials::over(self.trials.record().clone(), path.scenario.clone(), origin, likely_causes);
    }
}

impl Task for Search {
    type Outcome = Vec<Remedy>;

    /// An estimate of the share that is done, from 0 to 1.
    fn progress(&self) -> f64 {
        match self.stage {
            Stage::Causes(_) => NEARLY * (self.filters as f64 - 1.0 + self.trials.progress()) / FILTERS as f64,
            Stage::Without { .. } | Stage::Force { is_last: true, .. } => NEARLY,
            Stage::Force { is_last: false, .. } => NEARLY / FILTERS as f64,
            Stage::Done => 1.0,
        }
    }

    fn advance(&mut self, while_time: &mut dyn FnMut() -> bool) -> bool {
        while !self.is_done() {
            let is_ready = match &mut self.stage {
                Stage::Force { force, .. } => force.advance(self.trials.record(), while_time),
                _ => self.trials.advance(while_time),
            };
            if !is_ready {
                break;
            }
            self.conclude();
            if !while_time() {
                break;
            }
        }
        self.is_done()
    }

    fn finish(self) -> Vec<Remedy> {
        self.remedies()
    }
}
