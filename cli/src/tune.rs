//! The command `kalmanscope-cli tune`.

use std::fmt::Write as _;
use std::path::Path;
use std::sync::Arc;

use kalmanscope_core::setting::Address;
use kalmanscope_core::simulate;
use kalmanscope_core::{Axis, Scenario, Task as _};
use kalmanscope_lab::tune::{Goal, Tuned, Tuner};

use crate::args::TuneArgs;
use crate::input::InputError;
use crate::places::{is_standard_output, places, print, say, write_text};
use crate::prepared::scenario_and_record;

/// Tunes a filter, prints the result, and writes the scenario.
pub(crate) fn tune(args: &TuneArgs) -> Result<(), InputError> {
    let TuneArgs { scenario: file, turn, filter, goal, record, out } = args;
    let (scenario, imported) = scenario_and_record(file, record, &places("--out", out))?;
    let place = place_of(file, &scenario, filter.as_deref())?;
    let axes = turn.iter().map(|text| axis(text, &scenario).map_err(|reason| bad(file, reason)));
    let axes = axes.collect::<Result<Vec<_>, _>>()?;
    let record = imported.map_or_else(|| simulate(&scenario), |imported| imported.record);
    let tuner = Tuner::new(scenario, place, Arc::new(record), axes.clone(), *goal);
    let tuned = tuner.map_err(|error| bad(file, error.to_string()))?.run();
    let text = report(&tuned, &axes, *goal);
    // Standard output is the file's that asks for it.
    if out.as_deref().is_some_and(is_standard_output) {
        say(&text.trim_end());
    } else {
        print(&text)?;
    }
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
pub(crate) fn place_of(file: &Path, scenario: &Scenario, name: Option<&str>) -> Result<usize, InputError> {
    let Some(name) = name else {
        let first = (!scenario.filters.is_empty()).then_some(0);
        return first.ok_or_else(|| bad(file, "the scenario has no filter".to_owned()));
    };
    let place = scenario.filters.iter().position(|filter| filter.name == name);
    place.ok_or_else(|| bad(file, format!("the scenario has no filter `{name}`{}", scenario.filters_in_words())))
}

fn bad(file: &Path, reason: String) -> InputError {
    InputError::Laboratory { file: file.to_owned(), reason }
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

fn report(tuned: &Tuned, axes: &[Axis], goal: Goal) -> String {
    let mut text = String::new();
    let name = match goal {
        Goal::Likelihood => "log likelihood".to_owned(),
        Goal::FreeRun(sensor) => format!("-ln of the free run's error in {}", sensor.name()),
        Goal::Consistency => "-|ln| of the mean NIS".to_owned(),
    };
    if let (Some(before), Some(after)) = (tuned.path.first(), tuned.path.last()) {
        let _ = writeln!(text, "{name}: {:.6} before, {:.6} after {} runs", before.score, after.score, tuned.runs);
        for (place, (axis, (before, after))) in axes.iter().zip(before.values.iter().zip(&after.values)).enumerate() {
            let band = tuned.bands.as_ref().and_then(|bands| bands.get(place));
            let band = band.map_or(String::new(), |[low, high]| format!(", ±2σ from {low:.4e} to {high:.4e}"));
            let _ = writeln!(text, "{}: {before:.6e} before, {after:.6e} after{band}", axis.key);
        }
    }
    let verdict = tuned.verdict.map_or("not enough measurements for one", kalmanscope_core::VerdictKind::name);
    let _ = writeln!(text, "verdict: {verdict}");
    for remark in &tuned.remarks {
        let _ = writeln!(text, "{remark}");
    }
    text
}
