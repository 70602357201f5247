//! Equal steps of time, and readings that are carried to them along the least-squares cubic through their neighbours.

use crate::mathematics::least_squares::NormalEquations;

/// Equal steps of time: the first one \[s\], the time between them \[s\] and their number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Steps {
    pub(crate) start: f64,
    pub(crate) dt: f64,
    pub(crate) count: usize,
}

impl Steps {
    /// The time from the first step to the last one \[s\].
    pub(crate) fn seconds(self) -> f64 {
        self.count.saturating_sub(1) as f64 * self.dt
    }

    /// The values at the steps; NaN at a step to which no reading goes.
    ///
    /// Each reading goes to the step to which `place` rounds its time in steps: the nearest of several, shifted by what the cubic
    /// through `side` readings to either side changes meanwhile.
    pub(crate) fn of(self, times: &[f64], values: &[f64], side: usize, place: impl Fn(f64) -> f64) -> Vec<f64> {
        let Self { start, dt, count } = self;
        let n = times.len();
        let side = side.min(n.saturating_sub(1) / 2);
        let mut nearest = vec![None; count];
        for (k, time) in times.iter().enumerate() {
            let steps = (time - start) / dt;
            let place = place(steps);
            if !(0.0..count as f64).contains(&place) {
                continue;
            }
            let (place, distance) = (place as usize, (steps - place).abs());
            if nearest[place].is_none_or(|(_, other)| distance < other) {
                nearest[place] = Some((k, distance));
            }
        }
        let at = |(place, reading): (usize, Option<(usize, f64)>)| {
            let Some((k, _)) = reading else { return f64::NAN };
            let first = k.saturating_sub(side).min(n - 1 - 2 * side);
            let around = first..=first + 2 * side;
            let shift = start + dt * place as f64 - times[k];
            let size = 0.5 * (times[first + 2 * side] - times[first]);
            let readings = times[around.clone()].iter().zip(&values[around]);
            values[k] + change(readings, times[k], shift, size)
        };
        nearest.into_iter().enumerate().map(at).collect()
    }
}

/// What the least-squares cubic through some values changes from a time to one that is `shift` later \[s\]; 0 if they do not
/// determine one. `size` is the time over which they lie, about \[s\].
///
/// A reading that is shifted so keeps its noise as white as it is, which it would not on a curve through the readings. Source:
/// Savitzky and Golay (1964), Smoothing and differentiation of data by simplified least squares procedures.
pub(crate) fn change<'a>(readings: impl Iterator<Item = (&'a f64, &'a f64)>, from: f64, shift: f64, size: f64) -> f64 {
    let mut equations = NormalEquations::<4>::new();
    for (time, value) in readings {
        let u = (time - from) / size;
        equations.add([1.0, u, u * u, u * u * u], *value, 1.0);
    }
    let u = shift / size;
    equations.solution().map_or(0.0, |[_, first, second, third]| u * (first + u * (second + u * third)))
}
