//! Which of the models that filters assume is the likeliest.

use super::number::percent;
use super::phrase::{Phrase, Writer};
use crate::{Diagnostics, ModelClasses, PlantKind, Run};

/// From this probability on a model is found.
const FOUND: f64 = 0.95;

/// The likeliest model, if the filters assume plants of several kinds; nothing before there are readings.
pub(super) fn sentence(run: &Run, diagnostics: &[Diagnostics]) -> Option<Vec<Phrase>> {
    let truth = run.scenario().plant.kind;
    let plants: Vec<PlantKind> = run.scenario().filters.iter().map(|filter| filter.plant.unwrap_or(truth)).collect();
    let differ = plants.iter().any(|plant| *plant != plants[0]);
    if !differ || diagnostics.len() < plants.len() || diagnostics.iter().all(|d| d.log_likelihood() == 0.0) {
        return None;
    }
    let classes = ModelClasses::new(diagnostics.iter().map(Diagnostics::log_evidence));
    let best = classes.likeliest()?;
    let estimates = &run.estimates()[best];
    let p = classes.probabilities()[best];
    let text = Writer::default();
    if p < FOUND {
        let text = text.say("The readings do not tell the models apart so far: they give ");
        let text = text.result(percent(p)).say(" to ").filter(estimates.id(), estimates.name());
        return Some(text.say(".").done());
    }
    let text = text.say("Of these models the readings are for ").filter(estimates.id(), estimates.name());
    let certainty = ModelClasses::in_percent(p).replace('>', "more than");
    Some(text.say(", with a probability of ").result(certainty).say(".").done())
}
