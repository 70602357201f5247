//! The command `kalmanscope-cli posterior`.

use std::fmt::Write as _;
use std::path::Path;

use kalmanscope_cli::{harmless, run_scenario, significant, with_spread};
use kalmanscope_core::{Estimates, Scenario};
use kalmanscope_lab::posterior::{Sampled, Target};

use crate::args::PosteriorArgs;
use crate::files::{InputError, places, print_beside, write_text};
use crate::prepared::scenario_and_record;
use crate::tune::{number, place_of};

pub(crate) fn posterior(args: &PosteriorArgs) -> Result<(), InputError> {
    let PosteriorArgs { input, filter, out } = args;
    let file = &input.scenario;
    let (scenario, imported) = scenario_and_record(input, &places("--out", out))?;
    let bad = |reason: &dyn ToString| InputError::bad(file, reason);
    let place = place_of(file, &scenario, filter.as_deref())?;
    let alone = Scenario { filters: vec![scenario.filters[place].clone()], ..scenario };
    let run = run_scenario(&alone, imported.map(|imported| imported.record)).map_err(|error| bad(&error))?;
    let target = Target::new(&alone, 0, run.record());
    let target = target.map_err(|reason| bad(&format!("there is no posterior: {reason}")))?;
    let sampled = target.sample().ok_or_else(|| bad(&"no guess within the initial belief explains the record"))?;
    let mut text = posterior_in_words(&sampled, &run.estimates()[0]);
    if sampled.is_stiller_than(&alone.filters[0], run.record().len()) {
        text += "the filter lets the parameters change; the posterior does not\n";
    }
    print_beside(&places("--out", out), &text)?;
    out.as_deref().map_or(Ok(()), |out: &Path| write_text(out, &csv(&sampled)))
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
