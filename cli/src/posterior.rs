//! The command `kalmanscope-cli posterior`.

use std::fmt::Write as _;
use std::path::Path;

use kalmanscope_cli::{harmless, run_scenario, significant};
use kalmanscope_core::{Estimates, Scenario, Task as _};
use kalmanscope_lab::posterior::{Posterior, Sampled};

use crate::args::PosteriorArgs;
use crate::input::InputError;
use crate::places::{is_standard_output, places, print, say, write_text};
use crate::prepared::scenario_and_record;
use crate::tune::place_of;

/// Prints the posterior of a filter's parameters beside the filter's own belief, and writes its points.
pub(crate) fn posterior(args: &PosteriorArgs) -> Result<(), InputError> {
    let PosteriorArgs { scenario: file, filter, record, out } = args;
    let (scenario, imported) = scenario_and_record(file, record, &places("--out", out))?;
    let bad = |reason: &dyn ToString| InputError::Laboratory { file: file.clone(), reason: reason.to_string() };
    let place = place_of(file, &scenario, filter.as_deref())?;
    let alone = Scenario { filters: vec![scenario.filters[place].clone()], ..scenario };
    let run = run_scenario(&alone, imported.map(|imported| imported.record)).map_err(|error| bad(&error))?;
    let posterior = Posterior::new(&alone, 0, run.record());
    let posterior = posterior.map_err(|reason| bad(&format!("there is no posterior: {reason}")))?;
    let sampled = posterior.run().ok_or_else(|| bad(&"no guess within the initial belief explains the record"))?;
    let mut text = report(&sampled, &run.estimates()[0]);
    if sampled.is_stiller_than(&alone.filters[0], run.record().len()) {
        text += "the filter lets the parameters change, the posterior does not\n";
    }
    // Standard output is the file's that asks for it.
    if out.as_deref().is_some_and(is_standard_output) {
        say(&text.trim_end());
    } else {
        print(&text)?;
    }
    out.as_deref().map_or(Ok(()), |out: &Path| write_text(out, &csv(&sampled)))
}

fn report(sampled: &Sampled, estimates: &Estimates) -> String {
    let number = |value: f64| significant(value, 5, 9);
    let mut text = String::new();
    let (count, runs, evidence) = (sampled.points.len(), sampled.runs, sampled.log_evidence);
    let _ = writeln!(text, "{count} points of the posterior after {runs} runs, ln p(z) = {evidence:.2}");
    let last = estimates.len().checked_sub(1);
    for &channel in &sampled.channels {
        let Some([mean, std]) = sampled.moments(channel) else { continue };
        let unit = channel.unit();
        let _ = write!(text, "{}: {} ± {} (2σ) {unit}", channel.key(), number(mean), number(2.0 * std));
        if let Some((place, last)) = estimates.place(channel).zip(last) {
            let (own, own_std) = (estimates.canonical_mean(last, place), estimates.std(last, place));
            let ratio = significant(own_std / std, 3, 9);
            let name = estimates.name();
            let _ = write!(text, "; {name}: {} ± {}, {ratio} times as wide", number(own), number(2.0 * own_std));
        }
        text.push('\n');
    }
    if let Some((channel, solutions)) = sampled.solutions() {
        let [low, high] = solutions.means.map(number);
        let [one, other] = solutions.shares.map(|share| 100.0 * share);
        let _ = writeln!(text, "two solutions: {} {low} ({one:.0} %) or {high} ({other:.0} %)", channel.key());
    }
    text
}

/// The points, a row each.
fn csv(sampled: &Sampled) -> String {
    let keys: Vec<String> = sampled.channels.iter().map(|channel| harmless(channel.key()).into_owned()).collect();
    let row = |point: &Vec<f64>| point.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
    let rows: Vec<String> = std::iter::once(keys.join(",")).chain(sampled.points.iter().map(row)).collect();
    rows.join("\n") + "\n"
}
