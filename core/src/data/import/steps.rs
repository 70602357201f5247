//! Readings at equal steps.

use crate::data::local_cubic::change;

/// Equal steps of time: the first one \[s\], the time between them \[s\] and their number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Steps {
    pub(super) start: f64,
    pub(super) dt: f64,
    pub(super) count: usize,
}

impl Steps {
    /// The values at the steps; NaN at a step to which no reading is nearest.
    ///
    /// Each reading goes to its nearest step, shifted by what the cubic through `side` readings to either side changes meanwhile.
    pub(super) fn of(self, times: &[f64], values: &[f64], side: usize) -> Vec<f64> {
        self.placed(times, values, side, libm::round)
    }

    /// The same, but each reading goes to the end of the step in which it falls, to which the last of several goes.
    pub(super) fn at_ends(self, times: &[f64], values: &[f64], side: usize) -> Vec<f64> {
        // Clocks are told in decimals.
        self.placed(times, values, side, |steps| libm::ceil(steps - 1e-6))
    }

    fn placed(self, times: &[f64], values: &[f64], side: usize, place: impl Fn(f64) -> f64) -> Vec<f64> {
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
