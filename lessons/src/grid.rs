//! The scenarios of a grid over some settings.

use kalmanscope_core::setting::Address;
use kalmanscope_core::{Axis, Scenario};

use crate::LessonError;

/// Limits the values on one axis: a check runs the scenario for each.
const MOST: usize = 256;

/// The axis in a text, with 2 to 256 values.
///
/// # Errors
/// [`LessonError::Axis`] where the text is none.
pub(crate) fn axis(text: &str) -> Result<Axis, LessonError> {
    let axis = Axis::parse(text).ok().filter(|axis| (2..=MOST).contains(&axis.count));
    axis.ok_or_else(|| LessonError::Axis(text.to_owned()))
}

/// The scenarios of all cells of a grid, those of the last axis next to each other.
///
/// # Errors
/// [`LessonError`] where the scenario has no such setting, or a cell is impossible.
pub(crate) fn cells(scenario: &Scenario, axes: &[Axis]) -> Result<Vec<Scenario>, LessonError> {
    let mut cells = vec![scenario.clone()];
    for axis in axes {
        let address = Address::parse(scenario, &axis.key)?;
        let with = |cell: &Scenario, place: usize| {
            let mut cell = cell.clone();
            address.set(&mut cell, axis.value(place));
            cell
        };
        cells = cells.iter().flat_map(|cell| (0..axis.count).map(move |place| with(cell, place))).collect();
    }
    cells.iter().try_for_each(Scenario::validate)?;
    Ok(cells)
}

/// Checks that the corners of a grid are possible scenarios.
///
/// # Errors
/// As [`cells`].
pub(crate) fn check_corners(scenario: &Scenario, axes: &[Axis]) -> Result<(), LessonError> {
    let ends: Vec<Axis> = axes.iter().map(|axis| Axis { count: 2, ..axis.clone() }).collect();
    cells(scenario, &ends).map(|_| ())
}

#[cfg(test)]
mod tests {
    use super::*;
    use kalmanscope_core::Channel;

    #[test]
    fn axes_of_too_few_or_too_many_values_are_refused() {
        for text in ["x", "x=0:1:1", "x=0:1:257", "x=0:1:5:log"] {
            assert_eq!(axis(text), Err(LessonError::Axis(text.to_owned())));
        }
    }

    #[test]
    fn a_grid_has_every_combination_once() {
        let axes = ["filters.*.initial_mean.natural_frequency=5:7:3", "seed=1:2:2"].map(|text| axis(text).unwrap());
        let cells = cells(&Scenario::default(), &axes).unwrap();
        let of = |s: &Scenario| (s.filters[1].initial_mean[Channel::NATURAL_FREQUENCY], s.seed);
        let found: Vec<_> = cells.iter().map(of).collect();
        assert_eq!(found, [(5.0, 1), (5.0, 2), (6.0, 1), (6.0, 2), (7.0, 1), (7.0, 2)]);
    }

    #[test]
    fn settings_that_are_missing_or_impossible_are_named() {
        let error = |text: &str| check_corners(&Scenario::default(), &[axis(text).unwrap()]).unwrap_err().to_string();
        assert_eq!(
            error("filters.KF.fading=1:2:2"),
            "the scenario has no number `filters.KF.fading` to vary; its filters are `EKF` and `UKF`"
        );
        assert!(error("filters.EKF.fading=0.5:2:9").contains("filters[0].fading"));
    }
}
