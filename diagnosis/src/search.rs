//! The search for remedies of several causes, which are repaired one after the other.
//!
//! ```text
//! filter ──trials──▶ causes ──the best repaired──▶ filter ──trials──▶ causes ... until it is good or nothing pays
//! ```
//!
//! Each cause must gain more log likelihood than its numbers cost. The last step removes causes that a later one has made needless.

use std::sync::Arc;

use kalmanscope_core::internals::{mapped, sort_items, sort_numbers};
use kalmanscope_core::setting::Edit;
use kalmanscope_core::{Channel, Diagnostics, Estimates, Record, RunError, Scenario, Task};

use super::case::VerdictKind;
use super::cause::LikelyCause;
use super::diagnosis::{Diagnosis, Verdict};
use super::remedy::{Ranked, Remedy, UNKNOWN_FORCE, WORTH, compare};
use super::trial::{TrialOutcome, Trials};

const STEPS: usize = 4;

/// Limits the filters on which causes are tried, with the first one: each takes some thirty runs over the window.
const FILTERS: usize = 6;

const NEARLY: f64 = 0.99;

const FIRSTS: usize = 3;

const FILTERS_ENOUGH: usize = 4;

/// A force pays this share of its gain, since it fits any record.
const PRICE: f64 = 0.05;

/// The least gain of a path that is tried beside one with such a force, relative to that one's gain.
const FAR_BEHIND: f64 = 0.7;

/// A search in progress, which can be cut into slices of time.
pub struct Search {
    trials: Trials,
    stage: Stage,
    alone: Vec<Ranked>,
    before: Option<TrialOutcome>,
    origin: Path,
    paths: Vec<Path>,
    filters: usize,
}

enum Stage {
    /// Causes of the unchanged filter, or of the remaining misfit on a path.
    Causes(Option<usize>),
    /// The places of a path and of the step that is left out, and the shorter path.
    Without(usize, usize, Box<Path>),
    Done,
}

impl Diagnosis {
    /// The search for remedies of the filter at `place` of a scenario. The other arguments are those of [`Self::new`].
    ///
    /// # Errors
    /// [`RunError`] where the scenario has no such filter, or the record is not one of such a scenario.
    pub fn search(
        &self,
        scenario: &Scenario,
        place: usize,
        diagnostics: &Diagnostics,
        estimates: &Estimates,
        record: &Record,
    ) -> Result<Search, RunError> {
        let origin = scenario.filters.get(place).ok_or(RunError::NoFilter(place))?;
        let likely_causes = self.likely_causes(origin, scenario, place, diagnostics, estimates, record);
        let trials = Trials::new(scenario, place, estimates, record, likely_causes)?;
        let origin = Path::new(&trials.scenario);
        let (stage, alone, paths) = (Stage::Causes(None), Vec::new(), Vec::new());
        Ok(Search { trials, stage, alone, before: None, origin, paths, filters: 1 })
    }
}

impl Search {
    /// Whether there is nothing left to try.
    pub fn is_done(&self) -> bool {
        matches!(self.stage, Stage::Done)
    }

    /// The verdict on the unchanged filter over the window, once it is known.
    pub fn before(&self) -> Option<&Verdict> {
        let is_first = matches!(self.stage, Stage::Causes(None));
        if is_first { &self.trials.before } else { &self.before }.as_ref()?.verdict.as_ref()
    }

    /// The remedies so far: those that end in a good verdict come first, then the likeliest. No two begin with the same cause.
    pub fn remedies(&self) -> Vec<Remedy> {
        if matches!(self.stage, Stage::Causes(None)) {
            return self.trials.ranked().into_iter().map(|ranked| ranked.remedy).collect();
        }
        let with_price = |Ranked { remedy, rank, achieved }: &Ranked| {
            (remedy.clone(), priced(*rank, remedy.first.cause.key == UNKNOWN_FORCE), *achieved)
        };
        let mut all: Vec<(Remedy, f64, f64)> = mapped(&self.alone, &with_price);
        let is_needless = |path: &Path| self.paths.iter().any(|fewer| fewer.is_enough_for(path));
        let tried = self.paths.iter().filter(|path| path.steps.len() > 1 || path.is_tried);
        for (path, remedy) in tried.filter(|path| !is_needless(path)).filter_map(|path| Some((path, path.remedy()?))) {
            let (key, path_rank) = (remedy.first.cause.key, path.priced_rank());
            match all.iter_mut().find(|(other, ..)| other.first.cause.key == key) {
                // Remedies that begin with the same cause are compared by their own gain, not that with all noise fitted.
                Some((other, rank, gain)) if compare((&remedy, path.gain), (other, *gain)).is_gt() => {
                    (*other, *rank, *gain) = (remedy, rank.max(path_rank), path.gain);
                }
                Some(_) => {}
                None => all.push((remedy, path_rank, path.gain)),
            }
        }
        sort_items(&mut all, |(a, a_rank, _), (b, b_rank, _)| compare((b, *b_rank), (a, *a_rank)));
        let mut known = Vec::new();
        let mut remedies: Vec<Remedy> = all.into_iter().map(|(remedy, ..)| remedy).collect();
        remedies.retain(|remedy| {
            let keys = sorted_keys(remedy.causes());
            let is_new = !known.contains(&keys);
            known.push(keys);
            is_new
        });
        if let Some(first) = remedies.first_mut().filter(|remedy| remedy.changes_plant()) {
            let key = first.first.cause.key;
            let plants = self.alone.iter().map(|ranked| &ranked.remedy).filter(|one| one.changes_plant());
            let of = |one: &Remedy| format!("{} (log likelihood {:+.0})", one.first.sentence, one.gain);
            let others: Vec<String> = plants.filter(|one| one.first.cause.key != key).take(2).map(of).collect();
            if !others.is_empty() {
                first.first.sentence += &format!("; other plants that were tried: {}", others.join(", "));
            }
        }
        remedies
    }

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
                    self.before.clone_from(&self.trials.before);
                    self.alone = ranked;
                    // A filter to be believed is not searched further: it gets the likeliest model alone.
                    if self.before.as_ref().is_some_and(TrialOutcome::is_good) {
                        self.alone.truncate(1);
                        return;
                    }
                }
                self.try_next();
            }
            Stage::Without(path, step, mut shorter) => {
                if let (Some(outcome), Some(before)) = (&self.trials.before, &self.before) {
                    let price = self.trials.price() * shorter.fitted();
                    shorter.gain = outcome.log_likelihood - before.log_likelihood - price;
                    shorter.after = outcome.verdict.clone();
                    shorter.rank += shorter.gain - self.paths[path].gain;
                }
                let precedence = |path: &Path| path.remedy().map(|remedy| remedy.precedence());
                let whole = &mut self.paths[path];
                if shorter.gain >= whole.gain && precedence(&shorter) >= precedence(whole) {
                    *whole = *shorter;
                    self.shorten(path, 0);
                } else {
                    self.shorten(path, step + 1);
                }
            }
            Stage::Done => {}
        }
    }

    fn place_of(&self, remedy: &Remedy) -> Option<usize> {
        self.paths.iter().position(|path| path.remedy().is_some_and(|other| other.edits == remedy.edits))
    }

    fn shorten(&mut self, path: usize, step: usize) {
        let whole = &self.paths[path];
        let can = |step: &usize| whole.steps.len() > 1 && *step + 1 < whole.steps.len();
        let shorter =
            (step..).take_while(can).find_map(|step| Some((step, whole.without(step, &self.origin.scenario)?)));
        match shorter {
            Some((step, shorter)) => {
                self.run(&shorter, false);
                self.stage = Stage::Without(path, step, Box::new(shorter));
            }
            None => self.stage = Stage::Done,
        }
    }

    fn run(&mut self, path: &Path, with_causes: bool) {
        let likely_causes = if with_causes { None } else { Some(Vec::new()) };
        let Some(origin) = self.origin.scenario.filters.first().cloned() else { return };
        let record = (Arc::clone(&self.trials.record), self.trials.steps);
        self.trials = Trials::over(record, path.scenario.clone(), origin, likely_causes);
    }

    fn try_next(&mut self) {
        let ends_well = |path: &Path| path.after.as_ref().is_some_and(|verdict| verdict.kind.is_good());
        let best_of = |is: &dyn Fn(&Path) -> bool| {
            self.paths.iter().filter(|path| ends_well(path) && is(path)).map(Path::priced_rank).reduce(f64::max)
        };
        // A free force ends in a good verdict whatever the cause is: other paths not far behind are tried too.
        let well = best_of(&|path| !path.has(UNKNOWN_FORCE));
        let least = well.or_else(|| best_of(&|_| true).map(|rank| FAR_BEHIND * rank));
        let limit = if well.is_some() { FILTERS_ENOUGH } else { FILTERS };
        let is_open = |path: &Path| {
            !path.is_tried
                && path.steps.len() < STEPS
                && !ends_well(path)
                && least.is_none_or(|least| path.priced_rank() > least)
        };
        let open = || self.paths.iter().enumerate().filter(|(_, path)| is_open(path));
        // A path with more causes is likelier, even after a wrong one: so the best first causes are tried first.
        let single = || self.paths.iter().filter(|path| path.steps.len() == 1);
        let mut firsts: Vec<f64> = single().map(Path::priced_rank).collect();
        sort_numbers(&mut firsts);
        firsts.reverse();
        let least_first = firsts.get(FIRSTS - 1).or(firsts.last()).copied().unwrap_or(f64::INFINITY);
        let most = single().map(|path| path.gain).fold(f64::NEG_INFINITY, f64::max);
        let is_first = |path: &Path| path.steps.len() == 1 && (path.priced_rank() >= least_first || path.gain >= most);
        // A cause that the record shows without a model is listed first, so its remedy must be complete.
        let is_seen = |path: &Path| path.steps.len() == 1 && path.steps[0].likely.certain;
        let order = |path: &Path| (is_seen(path), is_first(path), path.priced_rank());
        let better = |a: &Path, b: &Path| order(a).partial_cmp(&order(b)).unwrap_or(std::cmp::Ordering::Equal);
        let best = open().max_by(|(_, a), (_, b)| better(a, b)).map(|(place, _)| place);
        match best.filter(|_| self.filters < limit).or_else(|| self.first_untried()) {
            Some(place) => {
                self.filters += 1;
                self.paths[place].is_tried = true;
                let path = self.paths[place].clone();
                self.run(&path, true);
                self.stage = Stage::Causes(Some(place));
            }
            None => match self.remedies().first().and_then(|first| self.place_of(first)) {
                Some(path) => self.shorten(path, 0),
                None => self.stage = Stage::Done,
            },
        }
    }

    /// The first remedy if it ends in a consistent filter, which may have a fault that the verdict does not see.
    fn first_untried(&self) -> Option<usize> {
        let place = self.place_of(self.remedies().first()?)?;
        let Path { is_tried, steps, after, .. } = &self.paths[place];
        let is_open = after.as_ref()?.kind == VerdictKind::Consistent && !is_tried && steps.len() < STEPS;
        (is_open && self.filters < FILTERS).then_some(place)
    }
}

fn sorted_keys<'a>(causes: impl Iterator<Item = &'a LikelyCause>) -> Vec<&'static str> {
    let mut keys: Vec<_> = causes.map(|likely| likely.cause.key).collect();
    sort_items(&mut keys, Ord::cmp);
    keys
}

fn priced(rank: f64, is_force: bool) -> f64 {
    if is_force && rank > 0.0 { (1.0 - PRICE) * rank } else { rank }
}

impl Task for Search {
    type Outcome = Vec<Remedy>;

    fn progress(&self) -> f64 {
        match self.stage {
            Stage::Causes(_) => NEARLY * (self.filters as f64 - 1.0 + self.trials.progress()) / FILTERS as f64,
            Stage::Without(..) => NEARLY,
            Stage::Done => 1.0,
        }
    }

    fn advance(&mut self, while_time: &mut dyn FnMut() -> bool) -> bool {
        while !self.is_done() && self.trials.advance(while_time) {
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

#[derive(Clone, Debug)]
struct Path {
    steps: Vec<Step>,
    scenario: Scenario,
    rank: f64,
    gain: f64,
    after: Option<Verdict>,
    is_tried: bool,
}

#[derive(Clone, Debug)]
struct Step {
    likely: LikelyCause,
    added: Vec<Channel>,
}

impl Path {
    fn new(scenario: &Scenario) -> Self {
        Self { steps: Vec::new(), scenario: scenario.clone(), rank: 0.0, gain: 0.0, after: None, is_tried: true }
    }

    fn fitted(&self) -> f64 {
        self.steps.iter().map(|step| step.likely.fitted).sum()
    }

    fn then(&self, next: &Ranked, price: f64) -> Option<Self> {
        let Ranked { remedy, rank, achieved } = next;
        let likely = remedy.first.clone();
        let scenario = Edit::apply_all(&likely.edits, &self.scenario).ok()?;
        let before = &self.scenario.filters.first()?.augment;
        let added = scenario.filters.first()?.augment.iter().copied().filter(|one| !before.contains(one)).collect();
        let is_again = |step: &Step| {
            let again = |edit: &Edit| likely.edits.iter().any(|other| other.key == edit.key);
            step.likely.cause.key == likely.cause.key && step.likely.edits.iter().all(again)
        };
        let mut steps: Vec<Step> = self.steps.iter().filter(|step| !is_again(step)).cloned().collect();
        let again = self.fitted() - steps.iter().map(|step| step.likely.fitted).sum::<f64>();
        let paid = self.gain + price * again;
        steps.push(Step { likely, added });
        let (rank, gain) = (paid + rank, paid + achieved);
        Some(Self { steps, scenario, rank, gain, after: remedy.after.clone(), is_tried: false })
    }

    fn without(&self, place: usize, origin: &Scenario) -> Option<Self> {
        let mut path = Self { rank: self.rank, is_tried: true, ..Self::new(origin) };
        for mut step in [&self.steps[..place], &self.steps[place + 1..]].concat() {
            let augment = &path.scenario.filters.first()?.augment;
            let keys: Vec<String> = augment.iter().chain(&step.added).map(|one| one.key().to_owned()).collect();
            let is_list = |edit: &&mut Edit| edit.inner() == "augment";
            step.likely.edits.iter_mut().filter(is_list).for_each(|edit| edit.value = keys.clone().into());
            path.scenario = Edit::apply_all(&step.likely.edits, &path.scenario).ok()?;
            path.steps.push(step);
        }
        Some(path)
    }

    fn priced_rank(&self) -> f64 {
        priced(self.rank, self.has(UNKNOWN_FORCE))
    }

    fn has(&self, key: &str) -> bool {
        self.steps.iter().any(|step| step.likely.cause.key == key)
    }

    fn causes(&self) -> Vec<&'static str> {
        sorted_keys(self.steps.iter().map(|step| &step.likely))
    }

    fn is_enough_for(&self, other: &Self) -> bool {
        let (causes, all) = (self.causes(), other.causes());
        let precedence = |path: &Self| path.remedy().map(|remedy| remedy.precedence());
        causes.len() < all.len()
            && causes.iter().all(|key| all.contains(key))
            && self.gain >= other.gain
            && precedence(self) >= precedence(other)
    }

    fn remedy(&self) -> Option<Remedy> {
        let mut edits: Vec<Edit> = Vec::new();
        for edit in self.steps.iter().flat_map(|step| &step.likely.edits) {
            edits.retain(|other| other.key != edit.key);
            edits.push(edit.clone());
        }
        let mut named = self.steps.iter().map(|step| &step.likely).filter(|likely| !likely.sentence.is_empty());
        let likely = named.next()?.clone();
        let (then, after) = (named.cloned().collect(), self.after.clone());
        Some(Remedy { first: likely, then, edits, gain: self.gain, after })
    }
}
