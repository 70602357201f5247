//! The evidence for a verdict and the causes of it, in words.

use kalmanscope_core::diagnosis::{Evidence, Remedy, in_percent};
use kalmanscope_core::setting::Edit;
use kalmanscope_core::{Diagnosis, Scenario};

use crate::number::{fixed, legible};

/// Limits the pieces of evidence, and the causes, that are printed for a filter.
const MOST: (usize, usize) = (6, 3);

/// The evidence that counts, the weightiest first, each with its p-value.
pub(crate) fn evidence(diagnosis: &Diagnosis) -> Vec<String> {
    let mut counting: Vec<&Evidence> = diagnosis.evidence.iter().filter(|one| one.counts).collect();
    counting.sort_by(|a, b| b.effect.total_cmp(&a.effect));
    let line = |one: &&Evidence| {
        let p =
            if one.p_value > 0.0 && one.p_value < 1.0 { format!(" (p = {:.0e})", one.p_value) } else { String::new() };
        format!("{}: {}{p}", one.test.name, one.sentence)
    };
    counting.iter().take(MOST.0).map(line).collect()
}

/// A cause in words, or several that are repaired one after the other.
pub(crate) struct CauseInWords {
    /// The causes in order, the probability of the first one, the gain in likelihood with all edits made, and the verdict then.
    pub(crate) sentence: String,
    /// The lines to write into the scenario, or a hint if there is no setting to change.
    pub(crate) remedies: Vec<String>,
}

/// The sentence before causes that do not explain the verdict. `None` if the first one explains it.
pub(crate) fn unexplained(causes: &[Remedy]) -> Option<String> {
    let best = causes.first().filter(|first| !first.explains())?;
    let ends = best.after.as_ref().map_or("no better", |verdict| verdict.kind.name());
    Some(format!("none of these causes explains it: with the best remedy it is still {ends}"))
}

/// The likeliest causes, the first the likeliest, for a filter of a scenario.
pub(crate) fn likeliest(causes: &[Remedy], scenario: &Scenario) -> Vec<CauseInWords> {
    let probabilities = Remedy::probabilities(causes);
    let words = |(number, remedy): (usize, &Remedy)| {
        let mut told = vec![format!("probability {}", in_percent(probabilities[number - 1]))];
        if remedy.gain.is_finite() {
            let sign = if remedy.gain < 0.0 { "" } else { "+" };
            told.push(format!("log likelihood {sign}{}", fixed(remedy.gain, 0)));
        }
        told.extend(remedy.after.as_ref().map(|verdict| format!("then {}", verdict.kind.name())));
        let told = format!(" ({})", told.join(", "));
        let each = remedy.causes().map(|likely| format!("{}: {}", likely.cause.name, likely.sentence));
        let sentence = each.collect::<Vec<_>>().join("; and then ") + &told;
        let remedies = if remedy.edits.is_empty() {
            vec![remedy.first.cause.hint.to_owned()]
        } else {
            let mut remedies = lines(&remedy.edits, scenario);
            remedies.push(format!("or have it written: kalmanscope-cli run ... --fix {number} --out FIXED.toml"));
            remedies
        };
        CauseInWords { sentence, remedies }
    };
    (1..).zip(causes).take(MOST.1).map(words).collect()
}

/// The lines of some edits.
fn lines(edits: &[Edit], scenario: &Scenario) -> Vec<String> {
    let line = |(filter, line): (Option<String>, String)| {
        let place = if filter.is_some() { "in its [[filters]]" } else { "at the top" };
        format!("write {place}: {}", legible(&line))
    };
    // A trial has made them: they can be made.
    Edit::toml_lines(edits, scenario).unwrap_or_default().into_iter().map(line).collect()
}
