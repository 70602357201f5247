//! The evidence for a verdict and the causes of it, in words.

use kalmanscope_core::Diagnosis;
use kalmanscope_core::diagnosis::{Evidence, Finding};
use kalmanscope_core::sorting::sort_short_by;

use crate::number::{fixed, legible};

/// The most pieces of evidence, and the most causes, that are told of a filter.
const MOST: (usize, usize) = (6, 3);

/// The evidence that counts, the weightiest first, each with its p-value.
pub(crate) fn evidence(diagnosis: &Diagnosis) -> Vec<String> {
    let mut counting: Vec<&Evidence> = diagnosis.evidence.iter().filter(|one| one.counts).collect();
    sort_short_by(&mut counting, |a, b| b.effect.total_cmp(&a.effect));
    let line = |one: &&Evidence| {
        let p =
            if one.p_value > 0.0 && one.p_value < 1.0 { format!(" (p = {:.0e})", one.p_value) } else { String::new() };
        format!("{}: {}{p}", one.test.name, one.sentence)
    };
    counting.iter().take(MOST.0).map(line).collect()
}

/// A cause in words.
pub(crate) struct CauseInWords {
    /// The cause, the gain in likelihood with the knob turned, and the verdict then.
    pub(crate) sentence: String,
    /// The lines to write into the scenario, or a hint where there is no setting to change.
    pub(crate) remedies: Vec<String>,
}

/// The likeliest causes, the first the likeliest.
pub(crate) fn likeliest(causes: &[Finding]) -> impl Iterator<Item = CauseInWords> {
    causes.iter().take(MOST.1).map(|finding| {
        let suspect = &finding.suspect;
        let mut told = Vec::new();
        if finding.gain.is_finite() {
            let sign = if finding.gain < 0.0 { "" } else { "+" };
            told.push(format!("log likelihood {sign}{}", fixed(finding.gain, 0)));
        }
        told.extend(finding.after.as_ref().map(|verdict| format!("then {}", verdict.kind.name())));
        let told = if told.is_empty() { String::new() } else { format!(" ({})", told.join(", ")) };
        let sentence = format!("{}: {}{told}", suspect.cause.name, suspect.sentence);
        let mut remedies = Vec::new();
        for knob in &suspect.knobs {
            let place = if knob.filter().is_some() { "in its [[filters]]" } else { "at the top" };
            remedies.push(format!("write {place}: {}", legible(&knob.rounded().toml_line())));
        }
        if suspect.knobs.is_empty() {
            remedies.push(suspect.cause.hint.to_owned());
        }
        CauseInWords { sentence, remedies }
    })
}
