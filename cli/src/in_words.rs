//! The evidence for a verdict and its causes, the consistency of a filter and remarks on it, in words.

use kalmanscope_core::diagnosis::{Evidence, Remedy, in_percent};
use kalmanscope_core::diagnostics::MeanSquare;
use kalmanscope_core::setting::Edit;
use kalmanscope_core::{Diagnosis, Record, Remark, Scenario, Summary, Trouble};

use crate::number::{fixed, legible, plain, scientific, short};

const MOST: (usize, usize) = (6, 3);

/// A smaller probability is told as smaller.
const LEAST_P: f64 = 1e-16;

/// The evidence that counts, the weightiest first, each with its p-value.
pub(crate) fn evidence(diagnosis: &Diagnosis) -> Vec<String> {
    let mut counting: Vec<&Evidence> = diagnosis.evidence.iter().filter(|one| one.counts).collect();
    counting.sort_by(|a, b| b.effect.total_cmp(&a.effect));
    let line = |one: &&Evidence| {
        let p = match one.p_value {
            p if p > 0.0 && p < LEAST_P => format!(" (p < {LEAST_P:e})"),
            p if p > 0.0 && p < 1.0 => format!(" (p = {p:.0e})"),
            _ => String::new(),
        };
        format!("{}: {}{p}", one.test.name, one.sentence)
    };
    counting.iter().take(MOST.0).map(line).collect()
}

pub(crate) struct CauseInWords {
    /// The causes in order, the probability of the first one, the gain in likelihood with all edits made, and the verdict then.
    pub(crate) sentence: String,
    /// The lines to write into the scenario, or a hint if there is no setting to change.
    pub(crate) remedies: Vec<String>,
}

/// Whether the remedies of a filter are other models, which are likelier than one that is to be believed.
pub(crate) fn are_models(summary: &Summary) -> bool {
    summary.verdict.as_ref().is_some_and(|verdict| verdict.kind.is_good())
}

/// The sentence before causes that do not explain the verdict. `None` if the first one explains it.
pub(crate) fn unexplained(causes: &[Remedy], summary: &Summary) -> Option<String> {
    if are_models(summary) || summary.verdict.is_none() {
        return None;
    }
    let Some(best) = causes.first() else { return Some("none of the causes that are known explains it".to_owned()) };
    if best.explains() {
        return None;
    }
    let ends = best.after.as_ref().map_or("no better", |verdict| verdict.kind.name());
    Some(format!("none of these causes explains it: with the best remedy it is still {ends}"))
}

/// The likeliest causes, the first the likeliest, for a filter of a scenario; or the likelier models of one that is to be believed.
pub(crate) fn likeliest(causes: &[Remedy], summary: &Summary, scenario: &Scenario) -> Vec<CauseInWords> {
    let probabilities = Remedy::probabilities(causes);
    let words = |(number, remedy): (usize, &Remedy)| {
        let probability = format!("probability {}", in_percent(probabilities[number - 1]));
        let mut told = if are_models(summary) { Vec::new() } else { vec![probability] };
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

fn lines(edits: &[Edit], scenario: &Scenario) -> Vec<String> {
    let line = |(filter, line): (Option<String>, String)| {
        let place = if filter.is_some() { "in its [[filters]]" } else { "at the top" };
        format!("write {place}: {}", legible(&line))
    };
    // A trial has made them: they can be made.
    Edit::toml_lines(edits, scenario).unwrap_or_default().into_iter().map(line).collect()
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
        Some(format!("{} Q = {}, p = {}", quantity.symbol(), short(test.statistic), fixed(test.p_value, 3)))
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
    format!("{mean}, {place} its χ² 95 % {interval} {low} … {high}")
}

/// Troubles that a filter has survived and changes that it has made, each with its time.
pub(crate) fn remarks(remarks: &[Remark], record: &Record) -> Vec<String> {
    let line = |remark: &Remark| {
        let [from, to] = [remark.sample, remark.last].map(|number| plain(record.time_of(number)));
        match remark.what {
            Trouble::Widened => format!("let its parameters move at {from} s, where its innovations grew at once"),
            what @ (Trouble::Moved(_) | Trouble::Rounded(_)) => what.to_string(),
            what => format!("from {from} s to {to} s: {what}"),
        }
    };
    remarks.iter().map(line).collect()
}
