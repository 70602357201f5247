//! Values of one setting, equally spaced: an axis of a map or of a check's grid.

use kalmanscope_core::Scenario;
use toml::{Table, Value};

use crate::{LessonError, adjustment, path};

/// Equally spaced values of one setting, both ends included.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Axis {
    key: String,
    values: Vec<f64>,
}

impl Axis {
    /// The most values on one axis: a check runs the scenario for each.
    const MOST: usize = 256;

    /// The axis written as `KEY=FROM:TO:COUNT`, with `:log` behind it for equal ratios.
    ///
    /// # Errors
    /// [`LessonError::Axis`] where the text is none.
    pub(crate) fn parse(text: &str) -> Result<Self, LessonError> {
        Self::read(text).ok_or_else(|| LessonError::Axis(text.to_owned()))
    }

    fn read(text: &str) -> Option<Self> {
        let (key, range) = text.rsplit_once('=')?;
        let parts: Vec<&str> = range.split(':').map(str::trim).collect();
        let (from, to, count, is_log) = match parts[..] {
            [from, to, count] => (from, to, count, false),
            [from, to, count, "log"] => (from, to, count, true),
            _ => return None,
        };
        let (from, to): (f64, f64) = (from.parse().ok()?, to.parse().ok()?);
        let count = count.parse().ok().filter(|count| (2..=Self::MOST).contains(count))?;
        let is_possible = from.is_finite() && to.is_finite() && (!is_log || from.min(to) > 0.0);
        let at = |place: usize| {
            let (place, last) = (place as f64, (count - 1) as f64);
            // With equal differences, multiplies first: this keeps seeds whole.
            if is_log { from * libm::pow(to / from, place / last) } else { from + place * (to - from) / last }
        };
        is_possible.then(|| Self { key: key.trim().to_owned(), values: (0..count).map(at).collect() })
    }

    /// The key of the setting, as in a change.
    pub(crate) fn key(&self) -> &str {
        &self.key
    }

    /// Sets a value in the table of a scenario.
    fn set(&self, file: &mut Table, value: f64, scenario: &Scenario) -> Result<(), LessonError> {
        // A seed is a whole number; other settings take one too.
        let value = if value.fract() == 0.0 { Value::Integer(value as i64) } else { Value::Float(value) };
        let is_set = path::set(file, &self.key, &value);
        is_set.then_some(()).ok_or_else(|| LessonError::unknown_path(&self.key, scenario))
    }
}

/// The scenarios of all cells of a grid, those of the last axis next to each other.
///
/// # Errors
/// [`LessonError`] where the scenario has no such setting, or a cell is impossible.
pub(crate) fn cells(scenario: &Scenario, axes: &[Axis]) -> Result<Vec<Scenario>, LessonError> {
    let mut files = vec![adjustment::written(scenario)?];
    for axis in axes {
        let mut finer = Vec::with_capacity(files.len() * axis.values.len());
        for file in &files {
            for &value in &axis.values {
                let mut file = file.clone();
                axis.set(&mut file, value, scenario)?;
                finer.push(file);
            }
        }
        files = finer;
    }
    files.iter().map(adjustment::read).collect()
}

/// Checks that the corners of a grid are possible scenarios.
///
/// # Errors
/// As [`cells`].
pub(crate) fn check_corners(scenario: &Scenario, axes: &[Axis]) -> Result<(), LessonError> {
    let ends = |axis: &Axis| {
        let values = [axis.values.first(), axis.values.last()].into_iter().flatten().copied().collect();
        Axis { key: axis.key.clone(), values }
    };
    cells(scenario, &axes.iter().map(ends).collect::<Vec<_>>()).map(|_| ())
}

#[cfg(test)]
mod tests {
    use super::*;
    use kalmanscope_core::Channel;

    #[test]
    fn values_run_from_end_to_end() {
        let axis = |text: &str| Axis::parse(text).unwrap();
        assert_eq!(axis("a.b=2:4:5").values, [2.0, 2.5, 3.0, 3.5, 4.0]);
        assert_eq!(axis("filters.A = b.fading = -1:1:2").key(), "filters.A = b.fading");
        let ratios = axis("x=0.01:1:3:log").values;
        assert!(ratios.iter().zip([0.01, 0.1, 1.0]).all(|(a, b)| (a - b).abs() < 1e-12), "{ratios:?}");
    }

    #[test]
    fn texts_that_are_no_axes_are_refused() {
        for text in ["x", "x=1", "x=0:1:5:log", "x=0:inf:5", "x=0:1:1", "x=0:1:257", "x=0:1:3:lin", "x=a:1:3"] {
            assert_eq!(Axis::parse(text), Err(LessonError::Axis(text.to_owned())));
        }
    }

    #[test]
    fn a_grid_has_every_combination_once() {
        let axes =
            ["filters.*.initial_mean.natural_frequency=5:7:3", "seed=1:2:2"].map(|text| Axis::parse(text).unwrap());
        let cells = cells(&Scenario::default(), &axes).unwrap();
        let of = |s: &Scenario| (s.filters[1].initial_mean[Channel::NATURAL_FREQUENCY], s.seed);
        let found: Vec<_> = cells.iter().map(of).collect();
        assert_eq!(found, [(5.0, 1), (5.0, 2), (6.0, 1), (6.0, 2), (7.0, 1), (7.0, 2)]);
    }

    #[test]
    fn settings_that_are_missing_or_impossible_are_named() {
        let error = |text: &str| {
            let axes = [Axis::parse(text).unwrap()];
            check_corners(&Scenario::default(), &axes).unwrap_err().to_string()
        };
        assert_eq!(
            error("filters.KF.fading=1:2:2"),
            "the scenario has no setting `filters.KF.fading`; its filters are `EKF` and `UKF`"
        );
        assert!(error("filters.EKF.fading=0.5:2:9").contains("filters[0].fading"));
    }
}
