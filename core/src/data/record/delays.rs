//! What comes late in a record, as a filter takes it to be.

/// The steps of dt by which the input and the readings of a filter's sensors tell of another time than that of their sample.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Delays {
    /// The number of samples after which the plant feels the recorded input.
    pub input: i32,
    /// The steps by which each sensor is late, in the order of the filter's sensors; empty where none is.
    pub sensors: Vec<f64>,
}

/// Delays are told in decimals: what differs by less than this share of a step from a whole number of steps is that.
const SAME: f64 = 1e-6;

impl Delays {
    /// Limits the steps by which a sensor is late or early.
    pub const MOST: f64 = 100_000.0;

    /// Those of an input and of sensors, which may be none, in steps; none of these are beyond [`Self::MOST`].
    pub(crate) fn new(input: i32, sensors: impl Iterator<Item = f64>) -> Self {
        let snapped = |steps: f64| if (steps - libm::round(steps)).abs() <= SAME { libm::round(steps) } else { steps };
        let mut sensors: Vec<f64> = sensors.map(|steps| snapped(steps.clamp(-Self::MOST, Self::MOST))).collect();
        if sensors.iter().all(|steps| *steps == 0.0) {
            sensors.clear();
        }
        Self { input, sensors }
    }

    /// The steps by which a sensor is late, by its place.
    pub(crate) fn of(&self, place: usize) -> f64 {
        self.sensors.get(place).copied().unwrap_or(0.0)
    }

    /// Whether a sensor is late or early.
    pub(crate) fn is_of_sensors(&self) -> bool {
        !self.sensors.is_empty()
    }

    /// The number of samples beyond its last one that a filter reads of a record.
    pub(crate) fn lookahead(&self) -> usize {
        let of_sensors = self.sensors.iter().fold(0.0, |most: f64, steps| most.max(*steps));
        (self.input.min(0).unsigned_abs() as usize).max(libm::ceil(of_sensors) as usize)
    }

    /// The number of samples before its last one that a filter reads of a record.
    pub(crate) fn reach(&self) -> usize {
        let of_sensors = self.sensors.iter().fold(0.0, |most: f64, steps| most.max(-*steps));
        (self.input.max(0) as usize).max(libm::ceil(of_sensors) as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_filter_reads_ahead_for_what_is_late_and_back_for_what_is_early() {
        let of = |input, sensors: &[f64]| Delays::new(input, sensors.iter().copied());
        assert_eq!(of(2, &[0.0, 0.0]), Delays { input: 2, sensors: Vec::new() });
        assert_eq!((of(0, &[]).lookahead(), of(0, &[]).reach()), (0, 0));
        assert_eq!((of(-3, &[1.5, 0.0]).lookahead(), of(-3, &[1.5, 0.0]).reach()), (3, 0));
        assert_eq!((of(1, &[4.2, -2.5]).lookahead(), of(1, &[4.2, -2.5]).reach()), (5, 3));
        assert_eq!(of(0, &[2.000_000_1, 0.25]).sensors, [2.0, 0.25]);
    }
}
