//! The map of a lesson's step, in the laboratory's terms.

use kalmanscope_core::{Axis, Scenario};
use kalmanscope_lessons::Map;

use crate::laboratory::Choice;
use crate::team::Precision;

/// The choice of axes, score and filters that a step asks for.
///
/// # Errors
/// A sentence where the map is impossible.
pub(super) fn choice(map: &Map, scenario: &Scenario) -> Result<Choice, String> {
    let Map { x, y, measure, filter, second } = map;
    let mut scenario = scenario.clone();
    scenario.number_filters();
    let id = |name: &String| {
        let filter = scenario.filters.iter().find(|filter| filter.name == *name);
        filter.map(|filter| filter.id).ok_or_else(|| format!("the scenario has no filter `{name}`"))
    };
    let axis = |text: &String| Axis::parse(text).map_err(|error| error.to_string());
    let choice = Choice {
        axes: [axis(x)?, axis(y)?],
        measure: *measure,
        filter: id(filter)?,
        second: second.as_ref().map(id).transpose()?,
        precision: Precision::default(),
    };
    choice.check(&scenario)?;
    Ok(choice)
}

#[cfg(test)]
mod tests {
    use super::*;
    use kalmanscope_core::{Channel, Measure};

    #[test]
    fn the_maps_of_all_lessons_are_possible() {
        let mut maps = 0;
        for lesson in kalmanscope_lessons::lessons() {
            let lesson = lesson.expect("a built-in lesson can be read");
            let scenarios = lesson.scenarios().expect("its changes are possible");
            for (step, scenario) in lesson.steps.iter().zip(&scenarios) {
                let Some(map) = &step.map else { continue };
                maps += 1;
                let choice = choice(map, scenario).unwrap_or_else(|error| panic!("{}: {error}", lesson.title));
                for axis in &choice.axes {
                    // Another filter's name would not change the map's own filter.
                    assert!(!axis.key.starts_with("filters.") || axis.key.starts_with("filters.*."), "{}", axis.key);
                }
            }
        }
        assert!(maps >= 8, "{maps} maps");
    }

    #[test]
    fn an_impossible_map_is_told() {
        let map = Map {
            x: "seed=1:9:9".to_owned(),
            y: "filters.*.fading=1:1.1:5".to_owned(),
            measure: Measure::rmse(Channel::NATURAL_FREQUENCY),
            filter: "EKF".to_owned(),
            second: Some("UKF".to_owned()),
        };
        let scenario = Scenario::default();
        let of = |map: &Map| choice(map, &scenario).map(|choice| (choice.filter, choice.second));
        assert!(of(&map).is_ok_and(|(first, second)| second.is_some_and(|second| second != first)));
        let error = |map: Map| of(&map).unwrap_err();
        assert!(error(Map { filter: "KF".to_owned(), ..map.clone() }).contains("no filter `KF`"));
        assert!(error(Map { y: map.x.clone(), ..map.clone() }).contains("both axes"));
        assert!(error(Map { x: "seed=1:999:999".to_owned(), ..map }).contains("may have 256"));
    }
}
