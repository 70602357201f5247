//! A search and a map with some of its settings as axes: the map's best cell, and the path of the search in the map.

use kalmanscope_core::setting::Address;
use kalmanscope_core::{Axis, Scenario};
use kalmanscope_lab::tune::Try;

use super::TuneChoice;
use crate::laboratory::survey::Survey;

/// The filter's place in the map, and the places of the map's axes among those of a search. `None` if the search lacks
/// one of them or the map lacks the filter.
fn places(survey: &Survey, choice: &TuneChoice) -> Option<(usize, [usize; 2])> {
    let filter = survey.filters().iter().position(|id| *id == choice.filter)?;
    let place = |key: &str| choice.axes.iter().position(|axis| axis.key == key);
    let [x, y] = survey.axes();
    Some((filter, [place(&x.key)?, place(&y.key)?]))
}

/// For each axis of the map, the ratio of the map's number to the search's number. A factor is relative to the numbers at the
/// beginning, and map and search begin at different times.
fn ratios(survey: &Survey, part: &Scenario) -> [f64; 2] {
    let present = survey.present(part);
    let settings = survey.ensemble().settings();
    [0, 1].map(|at| if settings.get(at).is_some_and(Address::is_factor) { present[at] } else { 1.0 })
}

/// The values of the tuned settings in the best cell of a map: its own settings must be among them. The others stay as they
/// are.
pub(super) fn best_of_map(survey: &Survey, choice: &TuneChoice, part: &Scenario) -> Option<Vec<f64>> {
    let (filter, places) = places(survey, choice)?;
    let score = |cell: usize| {
        let score = choice.goal.score(survey.value(cell, filter, choice.goal.measure())?);
        score.is_finite().then_some((cell, score))
    };
    let (best, _) = (0..survey.ensemble().cells()).filter_map(score).max_by(|(_, a), (_, b)| a.total_cmp(b))?;
    let present = |axis: &Axis| Address::parse(part, &axis.key).map_or(f64::NAN, |setting| setting.get(part));
    let mut values: Vec<f64> = choice.axes.iter().map(present).collect();
    let ratios = ratios(survey, part);
    for ((at, value), ratio) in places.into_iter().zip(survey.ensemble().values(best)).zip(ratios) {
        values[at] = value / ratio;
    }
    values.iter().all(|value| value.is_finite()).then_some(values)
}

/// The place in the map of the filter of a search that began with a scenario, and the points of its path on the map's axes.
pub(super) fn path_on_map(
    survey: &Survey,
    choice: &TuneChoice,
    part: &Scenario,
    path: &[Try],
) -> Option<(usize, Vec<[f64; 2]>)> {
    let (filter, places) = places(survey, choice)?;
    let ratios = ratios(survey, part);
    let point = |tried: &Try| [0, 1].map(|at| ratios[at] * tried.values.get(places[at]).copied().unwrap_or(f64::NAN));
    Some((filter, path.iter().map(point).collect()))
}
