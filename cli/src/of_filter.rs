//! The commands about one filter: `kalmanscope-cli tune` and `kalmanscope-cli posterior`.

use std::fmt::Write as _;
use std::path::Path;
use std::sync::Arc;

use kalmanscope_cli::{harmless, run_scenario, significant, with_spread};
use kalmanscope_core::setting::Address;
use kalmanscope_core::{Axis, Estimates, Scenario, Task as _, simulate};
use kalmanscope_lab::posterior::{Posterior, Sampled};
use kalmanscope_lab::tune::{Goal, Tuned, Tuner};

use crate::args::{PosteriorArgs, TuneArgs};
use crate::files::{InputError, places, print_beside, write_text};
use crate::prepared::scenario_and_record;

pub(crate) fn tune(args: &TuneArgs) -> Result<(), InputError> {
    let TuneArgs { input, turn, filter, goal, out } = args;
    let file = &input.scenario;
    let (scenario, imported) = scenario_and_record(input, &places("--out", out))?;
    let place = place_of(file, &scenario, filter.as_deref())?;
    let axes = turn.iter().map(|text| axis(text, &scenario).map_err(|reason| InputError::bad(file, &reason)));
    let axes = axes.collect::<Result<Vec<_>, _>>()?;
    let record = imported.map_or_else(|| simulate(&scenario), |imported| imported.record);
    let tuner = Tuner::new(scenario, place, Arc::new(record), axes.clone(), *goal);
    let tuned = tuner.map_err(|error| InputError::bad(file, &error))?.run();
    print_beside(&places("--out", out), &tuning_in_words(&tuned, &axes, *goal))?;
    if let Some(out) = out {
        let toml = tuned.scenario.to_toml().map_err(|error| InputError::Scenario { file: file.clone(), error })?;
        write_text(out, &toml)?;
    }
    Ok(())
}

/// The place of the filter with a name, or of the first one.
///
/// # Errors
/// [`InputError`] where the scenario has none.
fn place_of(file: &Path, scenario: &Scenario, name: Option<&str>) -> Result<usize, InputError> {
    let Some(name) = name else {
        let first = (!scenario.filters.is_empty()).then_some(0);
        return first.ok_or_else(|| InputError::bad(file, &"the scenario has no filter"));
    };
    let place = scenario.filters.iter().position(|filter| filter.name == name);
    let unknown = || format!("the scenario has no filter `{name}`{}", scenario.filters_in_words());
    place.ok_or_else(|| InputError::bad(file, &unknown()))
}

/// The range of a setting, written as `KEY`, `KEY=FROM:TO` or `KEY=FROM:TO:log`.
fn axis(text: &str, scenario: &Scenario) -> Result<Axis, String> {
    let Some((key, range)) = text.rsplit_once('=') else {
        let setting = Address::parse(scenario, text).map_err(|error| error.to_string())?;
        return Ok(Axis { key: text.to_owned(), ..Axis::usual(&setting, scenario, 2) });
    };
    let counted = match range.strip_suffix(":log") {
        Some(range) => format!("{key}={range}:2:log"),
        None => format!("{key}={range}:2"),
    };
    Axis::parse(&counted)
        .map_err(|_| format!("`{text}` is not a range: write KEY=FROM:TO, and :log behind it for equal ratios"))
}

fn tuning_in_words(tuned: &Tuned, axes: &[Axis], goal: Goal) -> String {
    let mut text = String::new();
    let score = |score: f64| significant(score, 7, 9);
    let name = match goal {
        Goal::Likelihood => "log likelihood".to_owned(),
        Goal::FreeRun(sensor) => format!("-ln of the free run's error in {}", sensor.name()),
        Goal::Consistency => "-|ln| of the mean NIS".to_owned(),
    };
    if let (Some(before), Some(after)) = (tuned.path.first(), tuned.path.last()) {
        let _ =
            writeln!(text, "{name}: {} before, {} after {} runs", score(before.score), score(after.score), tuned.runs);
        for (place, (axis, (before, after))) in axes.iter().zip(before.values.iter().zip(&after.values)).enumerate() {
            let band = tuned.bands.as_ref().and_then(|bands| bands.get(place));
            let band = band.map(|band| band.map(number));
            let band = band.map_or(String::new(), |[low, high]| format!(", ±2σ from {low} to {high}"));
            let _ = writeln!(text, "{}: {} before, {} after{band}", axis.key, number(*before), number(*after));
        }
    }
    let _ = match tuned.verdict {
        Some(verdict) => writeln!(text, "verdict: {}", verdict.name()),
        None => writeln!(text, "no verdict: too few measurements"),
    };
    for remark in &tuned.remarks {
        let _ = writeln!(text, "{remark}");
    }
    text
}

/// Prints the posterior of a filter's parameters beside the filter's own belief, and writes its points.
pub(crate) fn posterior(args: &PosteriorArgs) -> Result<(), InputError> {
    let PosteriorArgs { input, filter, out } = args;
    let file = &input.scenario;
    let (scenario, imported) = scenario_and_record(input, &places("--out", out))?;
    let bad = |reason: &dyn ToString| InputError::bad(file, reason);
    let place = place_of(file, &scenario, filter.as_deref())?;
    let alone = Scenario { filters: vec![scenario.filters[place].clone()], ..scenario };
    let run = run_scenario(&alone, imported.map(|imported| imported.record)).map_err(|error| bad(&error))?;
    let posterior = Posterior::new(&alone, 0, run.record());
    let posterior = posterior.map_err(|reason| bad(&format!("there is no posterior: {reason}")))?;
    let sampled = posterior.run().ok_or_else(|| bad(&"no guess within the initial belief explains the record"))?;
    let mut text = posterior_in_words(&sampled, &run.estimates()[0]);
    if sampled.is_stiller_than(&alone.filters[0], run.record().len()) {
        text += "the filter lets the parameters change; the posterior does not\n";
    }
    print_beside(&places("--out", out), &text)?;
    out.as_deref().map_or(Ok(()), |out: &Path| write_text(out, &csv(&sampled)))
}

fn number(value: f64) -> String {
    significant(value, 5, 9)
}

fn posterior_in_words(sampled: &Sampled, estimates: &Estimates) -> String {
    let mut text = String::new();
    let (count, runs, evidence) = (sampled.points.len(), sampled.runs, sampled.log_evidence);
    let _ = writeln!(text, "{count} points of the posterior after {runs} runs, ln p(z) = {evidence:.2}");
    let last = estimates.len().checked_sub(1);
    for &channel in &sampled.channels {
        let Some([mean, std]) = sampled.moments(channel) else { continue };
        let unit = channel.unit();
        let spread = |mean: f64, std: f64| {
            let (value, spread) = with_spread(mean, std);
            format!("{value} ± {spread} {unit}").trim_end().to_owned()
        };
        let _ = write!(text, "{}: {} (2σ)", channel.name(), spread(mean, std));
        if let Some((place, last)) = estimates.place(channel).zip(last) {
            let (own, own_std) = (estimates.canonical_mean(last, place), estimates.std(last, place));
            let ratio = significant(own_std / std, 3, 9);
            let _ = write!(text, "; {}: {}, {ratio} times as wide", estimates.name(), spread(own, own_std));
        }
        text.push('\n');
    }
    if let Some((channel, solutions)) = sampled.solutions() {
        let [low, high] = solutions.means.map(number);
        let [one, other] = solutions.shares.map(|share| 100.0 * share);
        let _ = writeln!(text, "two solutions: {} {low} ({one:.0} %) or {high} ({other:.0} %)", channel.name());
    }
    text
}

fn csv(sampled: &Sampled) -> String {
    let keys: Vec<String> = sampled.channels.iter().map(|channel| harmless(channel.key()).into_owned()).collect();
    let row = |point: &Vec<f64>| point.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
    let rows: Vec<String> = std::iter::once(keys.join(",")).chain(sampled.points.iter().map(row)).collect();
    rows.join("\n") + "\n"
}
