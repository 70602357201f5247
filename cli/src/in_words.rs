//! The evidence for a verdict and its causes, the consistency of a filter and remarks on it, in words.

use kalmanscope_core::diagnostics::MeanSquare;
use kalmanscope_core::{Record, Remark, Trouble};
use kalmanscope_diagnosis::{Diagnosis, Summary};
use kalmanscope_diagnosis::{Evidence, Remedy, in_percent};

use crate::number::{fixed, plain, scientific, short};
use crate::results::Results;

const MOST: (usize, usize) = (6, 3);

/// A smaller probability is only said to be smaller.
const LEAST_P: f64 = 1e-16;

/// The evidence that counts, the weightiest first, each with its p-value.
pub(crate) fn evidence(diagnosis: &Diagnosis) -> Vec<String> {
    let mut counting: Vec<&Evidence> = diagnosis.evidence.iter().filter(|one| one.counts).collect();
    counting.sort_by(|a, b| b.effect.total_cmp(&a.effect));
    let line = |one: &&Evidence| {
        // A rule has no probability: its p is 0 or 1, and is not printed.
        let p = match one.p_value {
            p if p > 0.0 && p < LEAST_P => format!(" (p < {LEAST_P:e})"),
            p if p > 0.0 && p < 1.0 => format!(" (p = {p:.0e})"),
            _ => String::new(),
        };
        format!("{}: {}{p}", one.test.name, one.sentence)
    };
    let more = counting.len().saturating_sub(MOST.0);
    let more = (more > 0).then(|| format!("and {more} more"));
    counting.iter().take(MOST.0).map(line).chain(more).collect()
}

pub(crate) struct CauseInWords {
    /// Its number, its probability, and the causes in order.
    pub(crate) sentence: String,
    /// The edits and the gain in likelihood by them. `None` if no setting takes the cause away.
    pub(crate) remedy: Option<String>,
    /// The command that tries the remedy and the verdict then, or a hint.
    pub(crate) trial: String,
}

/// Whether the remedies of a filter are other models, which are likelier than one that is to be trusted.
pub(crate) fn are_models(summary: &Summary) -> bool {
    summary.verdict.as_ref().is_some_and(|verdict| verdict.kind.is_good())
}

/// The sentence before causes that do not explain the verdict. `None` if the first one explains it.
pub(crate) fn unexplained(causes: &[Remedy], summary: &Summary) -> Option<String> {
    if are_models(summary) || summary.verdict.is_none() {
        return None;
    }
    let Some(best) = causes.first() else { return Some("no known cause explains it".to_owned()) };
    if best.explains() {
        return None;
    }
    let after = after(best, summary).unwrap_or_else(|| "no better".to_owned());
    Some(format!("none of these causes explains it: even with the best remedy it is {after}"))
}

fn after(remedy: &Remedy, summary: &Summary) -> Option<String> {
    let kind = remedy.after.as_ref()?.kind;
    let is_same = summary.verdict.as_ref().is_some_and(|verdict| verdict.kind == kind);
    Some(if is_same && !kind.is_good() { format!("still {}", kind.name()) } else { kind.name().to_owned() })
}

pub(crate) fn sentence(remedy: &Remedy) -> String {
    let each = remedy.causes().map(|likely| format!("{}: {}", likely.cause.name, likely.sentence));
    each.collect::<Vec<_>>().join("; and then ")
}

/// The likeliest causes, the first the likeliest, for a filter of a scenario; or the likelier models of one that is to be trusted.
pub(crate) fn likeliest(causes: &[Remedy], summary: &Summary, results: &Results<'_>) -> Vec<CauseInWords> {
    let words = |(number, (remedy, probability)): (usize, (&Remedy, f64))| {
        let what = if are_models(summary) {
            format!("likelier model {number}")
        } else {
            format!("cause {number} ({})", in_percent(probability))
        };
        let edits: Vec<String> = remedy.edits.iter().map(|edit| edit.in_words(&results.scenario)).collect();
        let gain = match remedy.gain {
            gain if !gain.is_finite() => String::new(),
            gain if gain < 0.0 => format!("; the log likelihood falls by {}", fixed(-gain, 0)),
            gain => format!("; the log likelihood rises by {}", fixed(gain, 0)),
        };
        let then = after(remedy, summary).map_or_else(String::new, |after| format!(" (then {after})"));
        let trial = format!("try it{then}: {} --fix {number} --out fixed.toml", results.command);
        CauseInWords {
            sentence: format!("{what}: {}", sentence(remedy)),
            trial: if edits.is_empty() { remedy.first.cause.hint.to_owned() } else { trial },
            remedy: (!edits.is_empty()).then(|| format!("remedy: {}{gain}", edits.join(", "))),
        }
    };
    (1..).zip(causes.iter().zip(Remedy::probabilities(causes))).take(MOST.1).map(words).collect()
}

pub(crate) fn quality(summary: &Summary, has_innovations: bool) -> Vec<(&'static str, String)> {
    let mut rows = Vec::new();
    match &summary.nis {
        Some(nis) => rows.push(("mean NIS", placed(nis, "interval"))),
        None if has_innovations => rows.push(("mean NIS", "– (no measurement)".to_owned())),
        None => {}
    }
    if let Some(nees) = &summary.nees {
        rows.push(("mean NEES", placed(nees, "interval for one sample")));
    }
    if let Some(share) = summary.share_in_ellipsoid {
        rows.push(("truth", format!("in the 95 % ellipsoid in {} % of the samples", fixed(100.0 * share, 1))));
    }
    let tests = summary.ljung_box.iter().filter_map(|(quantity, test)| {
        let test = test.as_ref()?;
        Some(format!("{} Q = {}, p {}", quantity.symbol(), short(test.statistic), p_value(test.p_value)))
    });
    let tests: Vec<String> = tests.collect();
    if !tests.is_empty() {
        rows.push(("Ljung-Box", tests.join("; ")));
    }
    match &summary.nis {
        Some(_) => rows.push(("log likelihood", fixed(summary.log_likelihood, 2))),
        None if has_innovations => rows.push(("log likelihood", "–".to_owned())),
        None => {}
    }
    rows
}

fn p_value(p: f64) -> String {
    if p < 5e-4 { "< 0.001".to_owned() } else { format!("= {}", fixed(p, 3)) }
}

fn placed(square: &MeanSquare, interval: &str) -> String {
    let MeanSquare { mean, interval: range, .. } = square;
    let place = if range.contains(mean) {
        "inside"
    } else if mean < range.start() {
        "below"
    } else {
        "above"
    };
    let [mean, low, high] =
        [mean, range.start(), range.end()].map(|x| if *x < 1e6 { format!("{x:.3}") } else { scientific(*x, 3) });
    format!("{mean}, {place} its χ² 95 % {interval} {low} to {high}")
}

/// Troubles that a filter has survived and changes that it has made, each with its time.
pub(crate) fn remarks(remarks: &[Remark], record: &Record) -> Vec<String> {
    let line = |remark: &Remark| {
        let [from, to] = [remark.sample, remark.last].map(|number| plain(record.time_of(number)));
        match remark.what {
            Trouble::Widened => format!("let its parameters move at {from} s, when its innovations suddenly grew"),
            what @ (Trouble::Moved(_) | Trouble::Rounded(_)) => what.to_string(),
            what if from == to => format!("at {from} s: {what}"),
            what => format!("from {from} s to {to} s: {what}"),
        }
    };
    remarks.iter().map(line).collect()
}
