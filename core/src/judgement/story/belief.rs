//! Which filter to believe.

use super::outcome::Outcome;
use super::phrase::{Phrase, Writer};

/// Two bands that differ by less than this factor are equally wide.
const NARROWER: f64 = 1.1;

/// Which of some filters to believe; nothing before there are verdicts. `told` limits the filters that the story has told of.
pub(super) fn sentence(outcomes: &[Outcome<'_>], told: usize) -> Option<Vec<Phrase>> {
    let judged: Vec<&Outcome<'_>> = outcomes.iter().filter(|outcome| outcome.kind().is_some()).collect();
    if judged.len() < 2 || judged.len() < outcomes.len() {
        // The sentence of a filter alone says it already.
        return None;
    }
    if judged.iter().any(|outcome| outcome.is_early()) {
        return Some(Writer::default().say("It is too early to tell which to believe.").done());
    }
    let honest: Vec<&Outcome<'_>> = judged.iter().copied().filter(|outcome| outcome.is_honest()).collect();
    let text = Writer::default();
    let text = match (&honest[..], judged.len()) {
        ([], _) if judged.iter().all(|outcome| outcome.leaves_pattern()) => {
            text.say("Their bands may be too narrow: the verdicts say by how much.")
        }
        ([], _) if judged.iter().any(|outcome| outcome.ends_outside()) => {
            text.say("None is advised: an error may end outside its ±2σ band by chance, as one in twenty does; Monte Carlo runs show it.")
        }
        ([], 2) => text.say("Trust neither ±2σ band: the verdicts say why."),
        ([], _) => text.say("Trust none of the ±2σ bands: the verdicts say why."),
        ([only], _) => text.say("Believe ").filter(only.id(), only.name()).say("."),
        (several, all) => {
            let text = match several.len() {
                2 if all == 2 => text.say("Both can be believed"),
                count if count == all => text.say(format!("All {all} can be believed")),
                count => several.iter().enumerate().fold(text.say("Believe "), |text, (place, one)| {
                    let text = text.filter(one.id(), one.name());
                    let left = count - 1 - place;
                    text.say(["", " and ", ", "][left.min(2)])
                }),
            };
            match narrowest(several) {
                _ if several.iter().any(|one| one.is_undetermined()) => {
                    text.say(": their bands say what they do not know.")
                }
                Some(best) => {
                    let degree = if several.len() == 2 { "narrower" } else { "narrowest" };
                    text.say("; ").filter(best.id(), best.name()).say(format!(" has the {degree} band."))
                }
                None => text.say("."),
            }
        }
    };
    let more = outcomes.len().saturating_sub(told);
    Some(if more > 0 { text.say(format!(" {more} more are in the legend.")).done() } else { text.done() })
}

/// The filter whose band is clearly narrower than those of the others.
fn narrowest<'a, 'b>(several: &[&'a Outcome<'b>]) -> Option<&'a Outcome<'b>> {
    let band = |outcome: &&&'a Outcome<'b>| outcome.band().unwrap_or(f64::INFINITY);
    let best = several.iter().min_by(|a, b| band(a).total_cmp(&band(b)))?;
    let next =
        several.iter().filter(|other| other.id() != best.id()).map(|other| band(&other)).fold(f64::INFINITY, f64::min);
    (next.is_finite() && band(&best) > 0.0 && next > NARROWER * band(&best)).then_some(*best)
}
