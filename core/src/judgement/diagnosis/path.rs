//! Causes that are repaired one after the other.

use super::cause::Suspect;
use super::finding::Finding;
use super::ranking::Ranked;
use super::verdict::Verdict;
use crate::data::setting::Edit;
use crate::{Channel, Scenario};

/// The key of the knob with a list as its value: each cause appends to it.
const AUGMENT: &str = "augment";

/// Causes that are repaired one after the other, and the resulting filter.
#[derive(Clone, Debug)]
pub(super) struct Path {
    steps: Vec<Step>,
    /// The scenario with all knobs turned.
    pub(super) scenario: Scenario,
    /// The gain that sorts it.
    pub(super) rank: f64,
    /// The gain of the filter with all knobs turned, less the price of the numbers that they fit.
    pub(super) gain: f64,
    /// The verdict on the resulting filter.
    pub(super) after: Option<Verdict>,
    /// Whether causes of the remaining misfit have been tried.
    pub(super) is_tried: bool,
}

/// One cause and the augmentations that its knobs add.
#[derive(Clone, Debug)]
struct Step {
    suspect: Suspect,
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

    /// The numbers that its knobs fit.
    pub(super) fn fitted(&self) -> f64 {
        self.steps.iter().map(|step| step.suspect.fitted).sum()
    }

    /// The same with one more cause. It replaces an earlier cause of the same kind if it turns all of that one's knobs
    /// again; the price of the replaced numbers, `price` each, is then given back.
    pub(super) fn then(&self, next: &Ranked, price: f64) -> Option<Self> {
        let Ranked { finding, rank, achieved } = next;
        let suspect = finding.suspect.clone();
        let scenario = Edit::apply_all(&suspect.knobs, &self.scenario).ok()?;
        let before = &self.scenario.filters.first()?.augment;
        let added = scenario.filters.first()?.augment.iter().copied().filter(|one| !before.contains(one)).collect();
        let is_again = |step: &Step| {
            let again = |knob: &Edit| suspect.knobs.iter().any(|other| other.key == knob.key);
            step.suspect.cause.key == suspect.cause.key && step.suspect.knobs.iter().all(again)
        };
        let mut steps: Vec<Step> = self.steps.iter().filter(|step| !is_again(step)).cloned().collect();
        let again = self.fitted() - steps.iter().map(|step| step.suspect.fitted).sum::<f64>();
        let paid = self.gain + price * again;
        steps.push(Step { suspect, added });
        let (rank, gain) = (paid + rank, paid + achieved);
        Some(Self { steps, scenario, rank, gain, after: finding.after.clone(), is_tried: false })
    }

    /// The same without the cause at a place, from the scenario without any; its gain and its verdict are not known yet.
    pub(super) fn without(&self, place: usize, origin: &Scenario) -> Option<Self> {
        let mut path = Self { rank: self.rank, is_tried: true, ..Self::new(origin) };
        for (_, step) in self.steps.iter().enumerate().filter(|(i, _)| *i != place) {
            let mut step = step.clone();
            let augment = &path.scenario.filters.first()?.augment;
            let keys: Vec<String> = augment.iter().chain(&step.added).map(|one| one.key().to_owned()).collect();
            let is_list = |knob: &&mut Edit| knob.key.ends_with(&format!(".{AUGMENT}"));
            step.suspect.knobs.iter_mut().filter(is_list).for_each(|knob| knob.value = keys.clone().into());
            path.scenario = Edit::apply_all(&step.suspect.knobs, &path.scenario).ok()?;
            path.steps.push(step);
        }
        Some(path)
    }

    /// Whether one of its causes has a key.
    pub(super) fn has(&self, key: &str) -> bool {
        self.steps.iter().any(|step| step.suspect.cause.key == key)
    }

    /// The keys of its causes, sorted.
    pub(super) fn causes(&self) -> Vec<&'static str> {
        let mut keys: Vec<_> = self.steps.iter().map(|step| step.suspect.cause.key).collect();
        keys.sort_unstable();
        keys
    }

    /// Whether it has only some of another path's causes, explains as much and ends in as good a verdict: the other
    /// causes are needless.
    pub(super) fn is_enough_for(&self, other: &Self) -> bool {
        let (causes, all) = (self.causes(), other.causes());
        let precedence = |path: &Self| path.finding().map(|finding| finding.precedence());
        causes.len() < all.len()
            && causes.iter().all(|key| all.contains(key))
            && self.gain >= other.gain
            && precedence(self) >= precedence(other)
    }

    /// The path as a finding. `None` if it has no cause.
    pub(super) fn finding(&self) -> Option<Finding> {
        let mut knobs: Vec<Edit> = Vec::new();
        for knob in self.steps.iter().flat_map(|step| &step.suspect.knobs) {
            knobs.retain(|other| other.key != knob.key);
            knobs.push(knob.clone());
        }
        let mut told = self.steps.iter().map(|step| &step.suspect).filter(|suspect| !suspect.sentence.is_empty());
        let suspect = told.next()?.clone();
        Some(Finding { suspect, then: told.cloned().collect(), knobs, gain: self.gain, after: self.after.clone() })
    }
}
