//! The command `kalmanscope-cli tune`.

use std::fmt::Write as _;
use std::path::Path;
use std::sync::Arc;

use kalmanscope_cli::significant;
use kalmanscope_core::setting::Address;
use kalmanscope_core::{Axis, Scenario, Task as _, simulate};
use kalmanscope_lab::tune::{Goal, Tuned, Tuner};

use crate::args::TuneArgs;
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
    let tuner = Tuner::new(scenario, place, Arc::new(record), axes.clone(), *goal, None);
    let tuned = tuner.map_err(|error| InputError::bad(file, &error))?.run();
    print_beside(&places("--out", out), &tuning_in_words(&tuned, &axes, *goal))?;
    if let Some(out) = out {
        let toml = tuned.scenario.to_toml().map_err(|error| InputError::bad(file, &error))?;
        write_text(out, &toml)?;
    }
    Ok(())
}

/// The place of the filter with a name, or of the first one.
pub(crate) fn place_of(file: &Path, scenario: &Scenario, name: Option<&str>) -> Result<usize, InputError> {
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
    // An axis is written with a number of values; a search has two ends only.
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

pub(crate) fn number(value: f64) -> String {
    significant(value, 5, 9)
}
