//! Frequency and damping while it still swings: a filter that follows the readings as they come.

use kalmanscope_core::import::Decay;
use kalmanscope_core::record::{Input, Record};
use kalmanscope_core::suggest::{scenario_for, suggest};
use kalmanscope_core::{Channel, EventFilter, Hold, InputKind, Quantity};

/// The time between two looks at where the decay begins \[s\].
const LOOK: f64 = 1.0;

/// The estimates of a decay that goes on.
#[derive(Default)]
pub(super) struct Live {
    following: Option<Following>,
    /// The time of the reading at the last look \[s\].
    looked: Option<f64>,
    rests: bool,
}

/// A filter, and what it takes from a reading.
struct Following {
    filter: EventFilter,
    axis: [f64; 3],
    gravity: f64,
    /// The times of the decay's beginning and of the last reading that was taken \[s\].
    begin: f64,
    taken: f64,
}

/// An estimate with its band of two standard deviations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Band {
    pub(super) mean: f64,
    pub(super) band: f64,
}

impl Live {
    /// Takes in the new readings. A decay that begins elsewhere, as after another pluck, gets a new filter.
    pub(super) fn follow(&mut self, readings: &[[f64; 4]]) {
        let Some(now) = readings.last().map(|reading| reading[0]) else { return };
        if self.looked.is_none_or(|looked| now >= looked + LOOK) {
            self.looked = Some(now);
            let decay = Decay::of(readings).ok();
            self.rests = decay.as_ref().is_some_and(|decay| decay.rests);
            let begin = self.following.as_ref().map(|following| following.begin);
            if let Some(decay) = decay.filter(|decay| begin != Some(decay.begin)) {
                self.following = Following::new(&decay);
            }
        }
        if let Some(following) = &mut self.following
            && !following.take(readings)
        {
            self.following = None;
        }
    }

    /// Whether it has come to rest: there is nothing more to learn.
    pub(super) fn rests(&self) -> bool {
        self.rests
    }

    /// Natural frequency \[rad/s\] and damping ratio, if both are known by now.
    pub(super) fn estimates(&self) -> Option<[Band; 2]> {
        let Following { filter, .. } = self.following.as_ref()?;
        let (sample, n) = (filter.sample(), filter.channels().len());
        let of = |channel: Channel| {
            let place = filter.channels().iter().position(|one| *one == channel)?;
            let band = 2.0 * sample.cov.get(place * n + place)?.sqrt();
            Some(Band { mean: *sample.mean.get(place)?, band })
        };
        let [frequency, damping] = [of(Channel::NATURAL_FREQUENCY)?, of(Channel::DAMPING_RATIO)?];
        let is_known = frequency.mean > 0.0 && frequency.band < 0.2 * frequency.mean && damping.band.is_finite();
        is_known.then_some([frequency, damping])
    }
}

impl Following {
    /// A filter with the start values of a decay. `None` if the decay gives none.
    fn new(decay: &Decay) -> Option<Self> {
        let dt = decay.times.get(1)? - decay.times.first()?;
        let input = Input { kind: InputKind::Force, hold: Hold::First, values: vec![0.0; decay.times.len()] };
        let record = Record::new(dt, input, vec![(Quantity::ACCELERATION, decay.acceleration.clone())]).ok()?;
        let scenario = suggest(&scenario_for(&record), &record).scenario;
        let filter = EventFilter::new(&scenario, 0).ok()?;
        let Decay { axis, gravity, begin, .. } = *decay;
        Some(Self { filter, axis, gravity, begin, taken: f64::NEG_INFINITY })
    }

    /// Takes in the readings since the last one. Returns false if the filter has stopped.
    fn take(&mut self, readings: &[[f64; 4]]) -> bool {
        let Self { filter, axis, gravity, begin, taken } = self;
        let first = readings.partition_point(|reading| reading[0] <= *taken || reading[0] < *begin);
        for &[time, x, y, z] in &readings[first..] {
            let along = axis[0] * x + axis[1] * y + axis[2] * z - *gravity;
            match filter.take(time, f64::NAN, &[along]) {
                Ok(_) => *taken = time,
                Err(kalmanscope_core::EventError::Stopped { .. }) => return false,
                // A single reading that cannot be taken in is left out.
                Err(_) => {}
            }
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A swing of 6 rad/s with 1 % damping, with readings that come unevenly, and again from 20 s on.
    fn reading(k: usize) -> [f64; 4] {
        let noise = |n: usize| f64::from((n as u32).wrapping_mul(2_654_435_761) >> 8) / f64::from(1 << 24) - 0.5;
        let t = (k as f64 + 0.4 * noise(7 * k)) / 60.0;
        let since = if t < 20.0 { t - 2.0 } else { t - 20.0 };
        let a = if t < 2.0 { 0.0 } else { 2.0 * (-0.06 * since).exp() * (6.0 * since).cos() };
        [t, 0.3 + 0.6 * a + 0.06 * noise(3 * k + 1), 9.7 + 0.8 * a + 0.06 * noise(3 * k + 2), 0.06 * noise(3 * k + 3)]
    }

    #[test]
    fn the_estimates_follow_the_readings_and_begin_again_with_another_pluck() {
        let readings: Vec<[f64; 4]> = (0..2400).map(reading).collect();
        let mut live = Live::default();
        let mut known = Vec::new();
        for count in (1..=readings.len()).step_by(6) {
            live.follow(&readings[..count]);
            known.extend(live.estimates().map(|estimates| (readings[count - 1][0], estimates)));
        }
        let (first, _) = known[0];
        assert!((3.0..8.0).contains(&first), "known from {first} s on");
        for at in [12.0, 19.0, 39.0] {
            let (_, [frequency, damping]) = known.iter().rfind(|(time, _)| *time <= at).expect("it is known by then");
            assert!((frequency.mean / 6.0 - 1.0).abs() < 0.005, "{at} s: {frequency:?}");
            assert!((damping.mean - 0.01).abs() < 0.003, "{at} s: {damping:?}");
            assert!((damping.mean - 0.01).abs() < 2.5 * damping.band, "{at} s: {damping:?}");
        }
    }
}
