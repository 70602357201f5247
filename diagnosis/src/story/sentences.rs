//! Sentences about a record, and about all filters together.

use std::f64::consts::{LN_2, PI, TAU};

use kalmanscope_core::diagnostics::ErrorSums;
use kalmanscope_core::internals::mapped;
use kalmanscope_core::{Channel, Diagnostics, ModelClasses, PlantKind, Run};

use super::outcome::FilterOutcome;
use super::{Phrase, Writer};
use crate::VerdictKind;
use crate::words::{percent_to_a_tenth, seconds, with_band};

pub(super) fn of_record(run: &Run) -> Vec<Phrase> {
    let (scenario, record) = (run.scenario(), run.record());
    let used: Vec<String> = mapped(&scenario.sensors, &|sensor| sensor.measures.name());
    let of = match used.split_last() {
        None => "nothing".to_owned(),
        Some((only, [])) => only.clone(),
        Some((last, rest)) => format!("{} and {last}", rest.join(", ")),
    };
    let length = record.dt() * run.samples().saturating_sub(1) as f64;
    let input = if has_input(run) { "" } else { ", and no input" };
    let (begin, so_far) = if run.is_live() { ("Live measurement: ", " so far") } else { ("A measured record: ", "") };
    let text = Writer::default().say(begin).result(seconds(length));
    text.say(format!(" of {of}{so_far}{input}.")).0
}

pub(super) fn has_input(run: &Run) -> bool {
    !run.record().is_free()
}

/// None before there are verdicts. `told` limits the filters to those of the story.
pub(super) fn of_belief(outcomes: &[FilterOutcome<'_>], told: usize) -> Option<Vec<Phrase>> {
    let judged: Vec<&FilterOutcome<'_>> = outcomes.iter().filter(|outcome| outcome.kind.is_some()).collect();
    if judged.len() < 2 || judged.len() < outcomes.len() {
        // The sentence of a filter alone says it already.
        return None;
    }
    if judged.iter().any(|outcome| outcome.is_early()) {
        return Some(Writer::default().say("It is too early to say which to trust.").0);
    }
    let honest: Vec<&FilterOutcome<'_>> = judged.iter().copied().filter(|outcome| outcome.is_honest()).collect();
    let text = Writer::default();
    let text = match (&honest[..], judged.len()) {
        ([], _) if judged.iter().all(|outcome| outcome.kind == Some(VerdictKind::PatternLeft)) => {
            text.say("Their bands may be too narrow: the verdicts say by how much.")
        }
        ([], _) if judged.iter().any(|outcome| outcome.ends_outside()) => {
            text.say("No advice: one error in twenty is outside its ±2σ band by chance. Monte Carlo runs show more.")
        }
        ([], 2) => text.say("Trust neither ±2σ band yet."),
        ([], _) => text.say("Trust none of the ±2σ bands yet."),
        ([only], _) => text.say("Trust ").filter(only.filter.id, only.name).say("."),
        (several, all) => {
            let text = match several.len() {
                2 if all == 2 => text.say("Trust both"),
                count if count == all => text.say(format!("Trust all {all}")),
                count => several.iter().enumerate().fold(text.say("Trust "), |text, (place, one)| {
                    let text = text.filter(one.filter.id, one.name);
                    let left = count - 1 - place;
                    text.say(["", " and ", ", "][left.min(2)])
                }),
            };
            match narrowest(several) {
                _ if several.iter().any(|one| one.kind == Some(VerdictKind::NotIdentifiable)) => {
                    text.say(": their bands show what is unknown.")
                }
                Some(best) => {
                    let degree = if several.len() == 2 { "narrower" } else { "narrowest" };
                    text.say("; ").filter(best.filter.id, best.name).say(format!(" has the {degree} band."))
                }
                None => text.say("."),
            }
        }
    };
    let more = outcomes.len().saturating_sub(told);
    Some(if more > 0 { text.say(format!(" {more} more are in the legend.")).0 } else { text.0 })
}

fn narrowest<'a, 'b>(several: &[&'a FilterOutcome<'b>]) -> Option<&'a FilterOutcome<'b>> {
    let band = |outcome: &&&'a FilterOutcome<'b>| outcome.main.as_ref().map_or(f64::INFINITY, |main| main.std);
    let best = several.iter().min_by(|a, b| band(a).total_cmp(&band(b)))?;
    let others = several.iter().filter(|other| other.filter.id != best.filter.id);
    let next = others.map(|other| band(&other)).fold(f64::INFINITY, f64::min);
    (next.is_finite() && band(&best) > 0.0 && next > 1.1 * band(&best)).then_some(*best)
}

pub(super) fn of_classes(run: &Run, diagnostics: &[Diagnostics]) -> Option<Vec<Phrase>> {
    let truth = &run.scenario().plant.kind;
    let plants: Vec<&PlantKind> = mapped(&run.scenario().filters, &|filter| filter.plant.as_ref().unwrap_or(truth));
    let differ = plants.iter().any(|plant| **plant != *plants[0]);
    if !differ || diagnostics.len() < plants.len() || diagnostics.iter().all(|d| d.log_likelihood() == 0.0) {
        return None;
    }
    let classes = ModelClasses::new(diagnostics.iter().map(Diagnostics::log_evidence));
    let best = classes.likeliest()?;
    let estimates = &run.estimates()[best];
    let p = classes.probabilities[best];
    let text = Writer::default();
    if p < 0.95 {
        let text = text.say("The readings do not separate the models yet: the probability is ");
        let text = text.result(percent_to_a_tenth(p)).say(" for ").filter(estimates.id(), estimates.name());
        return Some(text.say(".").0);
    }
    let text = text.say("The likeliest model is that of ").filter(estimates.id(), estimates.name());
    let certainty = ModelClasses::in_percent(p).replace('>', "more than");
    Some(text.say(", with a probability of ").result(certainty).say(".").0)
}

const EQUAL: f64 = 1.05;

pub(super) fn of_comparison(words: &str, filters: &[(u32, &str, &Diagnostics, &Diagnostics)]) -> Option<Vec<Phrase>> {
    let compared = filters.iter().filter_map(|(id, name, before, now)| {
        let channel = now.known().find(|channel| channel.is_parameter())?;
        let ratio = lately(before, channel)? / lately(now, channel)?;
        (ratio.is_finite() && ratio > 0.0).then_some((*id, *name, channel, ratio))
    });
    let words = filters.first().and_then(|one| words.strip_prefix(&format!("{} ", one.1))).unwrap_or(words);
    let begin = if words.starts_with("with") { "Before, " } else { "With " };
    let mut text = Writer::default().say(format!("{begin}{words}"));
    for (place, (id, name, channel, ratio)) in compared.take(2).enumerate() {
        let begin = [", the error of ", ", and that of "][place.min(1)];
        text = text.say(begin).filter(id, name).say(format!(" in {} was ", channel.symbol()));
        text = match ratio {
            ratio if ratio > EQUAL => text.result(times(ratio)).say(" times larger"),
            ratio if ratio < 1.0 / EQUAL => text.result(times(1.0 / ratio)).say(" times smaller"),
            _ => text.say("the same"),
        };
    }
    (text.0.len() > 1).then(|| text.say(".").0)
}

fn lately(diagnostics: &Diagnostics, channel: Channel) -> Option<f64> {
    diagnostics.tally(channel, diagnostics.last_third()).map(ErrorSums::rmse).filter(|error| *error > 0.0)
}

fn times(ratio: f64) -> String {
    if ratio < 9.95 { format!("{ratio:.1}") } else { format!("{ratio:.0}") }
}

/// Below this period nobody counts swings \[s\].
const QUICK: f64 = 0.05;

/// By the first filter whose band is wide enough, or else by the first. `None` if none knows both parameters well enough.
/// ```text
/// T = 2π / (ωₙ √(1 - ζ²)),  t½ = ln 2 / (ζ ωₙ),  Q = 1 / (2 ζ),  δ = ζ ωₙ T
/// ```
/// Source: Clough and Penzien (2003), *Dynamics of Structures*, section 2.6.
pub(super) fn of_swing(outcomes: &[FilterOutcome<'_>]) -> Option<Vec<Phrase>> {
    let may_be_believed =
        |outcome: &&FilterOutcome<'_>| outcome.is_honest() || outcome.kind == Some(VerdictKind::Underconfident);
    let believable_first = outcomes.iter().filter(may_be_believed).chain(outcomes);
    let [(frequency, spread), (damping, doubt)] = believable_first.into_iter().find_map(FilterOutcome::swing)?;
    let (shares, zeta) = ([2.0 * spread / frequency, 2.0 * doubt / damping], damping);
    if !(frequency > 0.0 && zeta > 0.0 && zeta < 1.0 && shares.iter().all(|share| (0.0..0.5).contains(share))) {
        return None;
    }
    let damped = libm::sqrt(1.0 - zeta * zeta);
    let period = TAU / (frequency * damped);
    let half = LN_2 / (zeta * frequency);
    let text = if period < QUICK {
        Writer::default().say("Its frequency is ").result(with_band(period.recip(), shares[0] / period, "Hz"))
    } else {
        Writer::default().say("Its period is ").result(with_band(period, shares[0] * period, "s"))
    };
    let band = libm::hypot(shares[0], shares[1]) * half;
    let text = text.say(", and its amplitude halves in ").result(with_band(half, band, "s"));
    let text = text.say(": Q = ").result(with_band(0.5 / zeta, 0.5 * shares[1] / zeta, ""));
    let decrement = 2.0 * PI * zeta / damped;
    let text = text.say(", logarithmic decrement ").result(with_band(decrement, shares[1] * decrement, ""));
    Some(text.say(".").0)
}
