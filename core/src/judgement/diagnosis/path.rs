//! Causes that are repaired one after the other.

use super::cause::LikelyCause;
use super::ranking::Ranked;
use super::remedy::Remedy;
use super::verdict::Verdict;
use crate::data::setting::Edit;
use crate::{Channel, Scenario};

/// The key of the edit with a list as its value: each cause appends to it.
const AUGMENT: &str = "augment";

/// Causes that are repaired one after the other, and the resulting filter.
#[derive(Clone, Debug)]
pub(super) struct Path {
    steps: Vec<Step>,
    /// The scenario with all edits made.
    pub(super) scenario: Scenario,
    /// The gain that sorts it.
    pub(super) rank: f64,
    /// The gain of the filter with all edits made, less the price of the numbers that they fit.
    pub(super) gain: f64,
    /// The verdict on the resulting filter.
    pub(super) after: Option<Verdict>,
    /// Whether causes of the remaining misfit have been tried.
    pub(super) is_tried: bool,
}

/// One cause and the augmentations that its edits add.
#[derive(Clone, Debug)]
struct Step {
    likely: LikelyCause,
    added: Vec<Channel>,
}

impl Path {
    /// No cause yet, of the only filter of a scenario.
    pub(super) fn new(scenario: &Scenario) -> Self {
        Self { steps: Vec::new(), scenario: scenario.clone(), rank: 0.0, gain: 0.0, after: None, is_tried: true }
    }

    /// The number of causes.
    pub(super) fn len(&self) -> usize {
        self.steps.len()
    }

    /// The numbers that its edits fit.
    pub(super) fn fitted(&self) -> f64 {
        self.steps.iter().map(|step| step.likely.fitted).sum()
    }

    /// The same with one more cause. It replaces an earlier cause of the same kind if it makes all of that one's edits
    /// again; the price of the replaced numbers, `price` each, is then given back.
    pub(super) fn then(&self, next: &Ranked, price: f64) -> Option<Self> {
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

    /// The same without the cause at a place, from the scenario without any; its gain and its verdict are not known yet.
    pub(super) fn without(&self, place: usize, origin: &Scenario) -> Option<Self> {
        let mut path = Self { rank: self.rank, is_tried: true, ..Self::new(origin) };
        for (_, step) in self.steps.iter().enumerate().filter(|(i, _)| *i != place) {
            let mut step = step.clone();
            let augment = &path.scenario.filters.first()?.augment;
            let keys: Vec<String> = augment.iter().chain(&step.added).map(|one| one.key().to_owned()).collect();
            let is_list = |edit: &&mut Edit| edit.key.ends_with(&format!(".{AUGMENT}"));
            step.likely.edits.iter_mut().filter(is_list).for_each(|edit| edit.value = keys.clone().into());
            path.scenario = Edit::apply_all(&step.likely.edits, &path.scenario).ok()?;
            path.steps.push(step);
        }
        Some(path)
    }

    /// Whether one of its causes has a key.
    pub(super) fn has(&self, key: &str) -> bool {
        self.steps.iter().any(|step| step.likely.cause.key == key)
    }

    /// The keys of its causes, sorted.
    pub(super) fn causes(&self) -> Vec<&'static str> {
        let mut keys: Vec<_> = self.steps.iter().map(|step| step.likely.cause.key).collect();
        keys.sort_unstable();
        keys
    }

    /// Whether it has only some of another path's causes, explains as much and ends in as good a verdict: the other
    /// causes are needless.
    pub(super) fn is_enough_for(&self, other: &Self) -> bool {
        let (causes, all) = (self.causes(), other.causes());
        let precedence = |path: &Self| path.remedy().map(|remedy| remedy.precedence());
        causes.len() < all.len()
            && causes.iter().all(|key| all.contains(key))
            && self.gain >= other.gain
            && precedence(self) >= precedence(other)
    }

    /// The path as a remedy. `None` if it has no cause.
    pub(super) fn remedy(&self) -> Option<Remedy> {
        let mut edits: Vec<Edit> = Vec::new();
        for edit in self.steps.iter().flat_map(|step| &step.likely.edits) {
            edits.retain(|other| other.key != edit.key);
            edits.push(edit.clone());
        }
        let mut told = self.steps.iter().map(|step| &step.likely).filter(|likely| !likely.sentence.is_empty());
        let likely = told.next()?.clone();
        Some(Remedy { first: likely, then: told.cloned().collect(), edits, gain: self.gain, after: self.after.clone() })
    }
}
