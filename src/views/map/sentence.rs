//! The map in a sentence: its best setting, and the one on screen.

use kalmanscope_core::Measure;

use crate::laboratory::{Survey, setting_name};
use crate::text::significant;
use crate::view::ViewContext;

/// Limits the filters in the sentence.
const TOLD: usize = 2;

/// The sentence about each filter in a complete map. `None` while it is computed, and for a score without a best value.
pub(super) fn sentence(survey: &Survey, measure: Measure, context: &ViewContext<'_>) -> Option<String> {
    if !survey.sheet.is_complete() {
        return None;
    }
    let filters = survey.ensemble.scenario().filters.iter().enumerate().take(TOLD);
    let told: Vec<String> = filters
        .filter_map(|(place, filter)| {
            let best = best(survey, place, measure)?;
            Some(format!("{}: {}", filter.name, of_filter(survey, place, measure, best, context)))
        })
        .collect();
    (!told.is_empty()).then(|| told.join(" "))
}

fn best(survey: &Survey, filter: usize, measure: Measure) -> Option<usize> {
    let goal = measure.info().best;
    let distances =
        (0..survey.sheet.len()).filter_map(|cell| Some((cell, goal.distance(survey.value(cell, filter, measure)?)?)));
    distances.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(cell, _)| cell)
}

fn of_filter(survey: &Survey, filter: usize, measure: Measure, best: usize, context: &ViewContext<'_>) -> String {
    let scenario = survey.ensemble.scenario();
    let values = survey.ensemble.values(best);
    let axes = survey.axes();
    let setting =
        |at: usize, value: f64| format!("{} = {}", setting_name(&axes[at].key, scenario), significant(value, 3));
    let value = survey.value(best, filter, measure).unwrap_or(f64::NAN);
    let unit = context.unit(measure.unit());
    let value = format!("{} {unit}", significant(value, 3));
    let value = value.trim_end();
    let at = [0, 1].map(|at| setting(at, values[at])).join(" and ");
    let present = survey.present(context.session.scenario());
    let here = [0, 1].map(|at| axes[at].place_of(present[at]));
    let here = match here {
        [Some(x), Some(y)] => survey.value(survey.ensemble.cell(&[x, y]), filter, measure),
        _ => None,
    };
    let here = here.map_or_else(String::new, |here| format!("; on screen it is {}", significant(here, 3)));
    format!("{} is best, {value}, at {at}{here}.", measure.name())
}
