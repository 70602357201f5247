//! Samples at even times; some may be missing.

/// Samples without a value.
pub(super) struct Missing {
    pub(super) first: usize,
    pub(super) count: usize,
}

/// Interpolates missing values linearly, or repeats the nearest at the ends.
pub(super) fn fill(values: &mut [f64]) -> Option<Missing> {
    let first = values.iter().position(|value| value.is_nan())?;
    let count = values.iter().filter(|value| value.is_nan()).count();
    let mut before: Option<usize> = None;
    for k in 0..=values.len() {
        if k < values.len() && values[k].is_nan() {
            continue;
        }
        let after = (k < values.len()).then_some(k);
        let gap = before.map_or(0, |before| before + 1)..k;
        let (from, to) = (before.map(|b| values[b]), after.map(|a| values[a]));
        let length = gap.len() as f64 + 1.0;
        for (i, place) in gap.enumerate() {
            let share = (i + 1) as f64 / length;
            values[place] = match (from, to) {
                (Some(from), Some(to)) => from + share * (to - from),
                (Some(known), None) | (None, Some(known)) => known,
                (None, None) => 0.0,
            };
        }
        before = after;
    }
    Some(Missing { first, count })
}

/// Moves values to earlier samples by `delay`, or to later ones where it is negative; the ends become missing.
pub(super) fn shift(values: &mut [f64], delay: i32) {
    let by = (delay.unsigned_abs() as usize).min(values.len());
    let n = values.len();
    if delay > 0 {
        values.rotate_left(by);
        values[n - by..].fill(f64::NAN);
    } else if delay < 0 {
        values.rotate_right(by);
        values[..by].fill(f64::NAN);
    }
}

/// The mean of the values that are not missing.
pub(super) fn mean(values: &[f64]) -> f64 {
    let (sum, count) = values
        .iter()
        .filter(|value| !value.is_nan())
        .fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    if count > 0.0 { sum / count } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_are_filled_from_both_sides() {
        let mut ends = [f64::NAN, 1.0, f64::NAN, f64::NAN, 4.0, f64::NAN];
        let missing = fill(&mut ends).unwrap();
        assert_eq!((missing.first, missing.count), (0, 4));
        assert_eq!(ends, [1.0, 1.0, 2.0, 3.0, 4.0, 4.0]);
        assert!(fill(&mut ends).is_none());
    }

    #[test]
    fn a_delay_leaves_the_other_end_missing() {
        let shifted = |delay| {
            let mut values = [1.0, 2.0, 3.0];
            shift(&mut values, delay);
            format!("{values:?}")
        };
        assert_eq!(shifted(1), "[2.0, 3.0, NaN]");
        assert_eq!(shifted(-2), "[NaN, NaN, 1.0]");
        assert_eq!([shifted(0), shifted(7)], ["[1.0, 2.0, 3.0]", "[NaN, NaN, NaN]"]);
    }

    #[test]
    fn the_mean_is_that_of_the_samples_that_are_there() {
        assert_eq!(mean(&[1.0, f64::NAN, 4.0]), 2.5);
        assert_eq!(mean(&[f64::NAN]), 0.0);
    }
}
