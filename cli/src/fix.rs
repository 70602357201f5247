//! The scenario with a remedy.

use std::path::Path;

use kalmanscope_core::diagnosis::Remedy;
use kalmanscope_core::setting::Edit;

use crate::import::path_from;
use crate::input::InputError;
use crate::places::{say, write_text};
use crate::prepared::Prepared;
use crate::record::named;

/// Writes the scenario of a run with remedy `number` of each filter with a bad verdict, and names these filters.
/// `causes` are those of the run.
pub(crate) fn write_fixed<'a>(
    prepared: &Prepared,
    causes: impl Iterator<Item = &'a [Remedy]>,
    number: usize,
    out: &Path,
) -> Result<(), InputError> {
    let bad = |reason: String| InputError::Laboratory { file: prepared.file.clone(), reason };
    let mut fixed = prepared.scenario.clone();
    let mut said = Vec::new();
    for (place, causes) in causes.enumerate().filter(|(_, causes)| !causes.is_empty()) {
        let name = &prepared.scenario.filters[place].name;
        let Some(remedy) = causes.get(number - 1) else {
            let count = causes.len();
            return Err(bad(format!("--fix {number}: {name} has remedies 1 to {count}")));
        };
        if remedy.edits.is_empty() {
            let hint = remedy.first.cause.hint;
            return Err(bad(format!("--fix {number}: no setting of {name} takes this cause away. {hint}")));
        }
        let refused = |error| bad(format!("--fix {number}: {name}: {error}"));
        fixed = Edit::apply_all(&remedy.edits, &fixed).map_err(refused)?;
        let ends = remedy.after.as_ref().map_or("no better", |verdict| verdict.kind.name());
        let names: Vec<&str> = remedy.causes().map(|likely| likely.cause.name).collect();
        said.push(format!("{name}: the remedy against {} is written, then {ends}", names.join(" and then ")));
    }
    if said.is_empty() {
        let reason = "there is nothing to fix: no filter has a verdict with a cause that was found";
        return Err(bad(reason.to_owned()));
    }
    if let Some(mapping) = fixed.record.as_mut().filter(|mapping| !mapping.file.is_empty()) {
        mapping.file = path_from(Some(out), &named(&prepared.file, mapping));
    }
    write_text(out, &fixed.to_toml().map_err(|error| bad(error.to_string()))?)?;
    said.iter().for_each(|line| say(line));
    Ok(())
}
