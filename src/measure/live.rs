//! Frequency and damping while it still swings: a filter that follows the readings as they come.

use std::sync::Arc;

use kalmanscope_core::free_decay::{Decay, NoDecay};
use kalmanscope_core::import::{Mapping, read};
use kalmanscope_core::record::{Input, LiveRecord, Record};
use kalmanscope_core::suggest::{scenario_for, suggest};
use kalmanscope_core::{Channel, Hold, InputKind, Quantity, Run, Scenario, Source};

pub(super) const NAME: &str = "measured now";

/// The time between two looks at where decays begin and end \[s\].
const LOOK: f64 = 1.0;

/// A decay is the same if it begins at the same time \[s\], and its constants differ by this share of the noise, its axis by
/// this angle at most.
const SAME: f64 = 0.1;
const SLIGHT: f64 = 0.1;

/// Limits the samples for start values, and the readings that a frame takes in, so that no frame is long.
const LOOKED_AT: usize = 1500;
const AT_ONCE: usize = 1000;

const AGREES: f64 = 3.0;

#[derive(Default)]
pub(super) struct LiveFilter {
    following: Option<Following>,
    known: Option<[Band; 2]>,
    /// The time from which on the next decay is looked for, and that of the reading at the last look \[s\].
    from: Option<f64>,
    looked: Option<f64>,
    pub(super) rests: bool,
}

struct Following {
    decay: Decay,
    live: LiveRecord,
    record: Arc<Record>,
    scenario: Scenario,
    run: Run,
    taken: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Band {
    pub(super) mean: f64,
    pub(super) band: f64,
}

impl LiveFilter {
    pub(super) fn follow(&mut self, readings: &[[f64; 4]]) {
        let Some(now) = readings.last().map(|reading| reading[0]) else { return };
        if self.looked.is_none_or(|looked| now >= looked + LOOK) {
            self.looked = Some(now);
            self.estimate(readings, now);
        }
        if let Some(following) = &mut self.following {
            following.take(readings, AT_ONCE);
        }
    }

    fn estimate(&mut self, readings: &[[f64; 4]], now: f64) {
        let first = self.from.map_or(0, |from| readings.partition_point(|reading| reading[0] <= from));
        let decays = match Decay::all(&readings[first..]) {
            Ok(decays) => decays,
            Err(reason) => {
                self.rests &= !matches!(reason, NoDecay::Short { .. });
                return;
            }
        };
        for decay in decays {
            self.rests = decay.rests;
            let end = decay.begin + decay.seconds();
            if end < now - 1e-6 {
                self.known = self.after(decay, &readings[..readings.partition_point(|reading| reading[0] <= end)]);
                self.from = Some(end);
                self.following = None;
            } else if self.following.as_ref().is_none_or(|following| !following.is_on(&decay)) {
                self.following = Following::new(decay);
            }
        }
    }

    fn after(&self, decay: Decay, readings: &[[f64; 4]]) -> Option<[Band; 2]> {
        let estimates = Following::new(decay).and_then(|mut following| {
            following.take(readings, usize::MAX);
            following.estimates()
        });
        estimates.map_or(self.known, |estimates| Some(self.together(estimates)))
    }

    /// The mean of both decays' estimates, each weighted by its certainty, where they agree; else the later alone.
    fn together(&self, later: [Band; 2]) -> [Band; 2] {
        let Some(known) = self.known else { return later };
        // A band is 2σ: the difference may be three of its standard deviations.
        let agrees = |(a, b): (&Band, &Band)| (a.mean - b.mean).abs() <= 0.5 * AGREES * a.band.hypot(b.band);
        if !known.iter().zip(&later).all(agrees) {
            return later;
        }
        std::array::from_fn(|i| {
            let weights = [known[i], later[i]].map(|one| one.band.powi(-2));
            let sum = weights[0] + weights[1];
            Band { mean: (weights[0] * known[i].mean + weights[1] * later[i].mean) / sum, band: sum.sqrt().recip() }
        })
    }

    pub(super) fn watched(&self) -> Option<(&Scenario, &Arc<Record>)> {
        let following = self.following.as_ref()?;
        Some((&following.scenario, &following.record))
    }

    pub(super) fn estimates(&self) -> Option<[Band; 2]> {
        let later = self.following.as_ref().and_then(Following::estimates);
        later.map_or(self.known, |later| Some(self.together(later)))
    }
}

impl Following {
    fn is_on(&self, decay: &Decay) -> bool {
        let before = &self.decay;
        (before.begin - decay.begin).abs() < SAME
            && (before.gravity - decay.gravity).abs() < SLIGHT * decay.noise
            && before.cos(decay) > 1.0 - 0.5 * SLIGHT * SLIGHT
    }

    fn new(decay: Decay) -> Option<Self> {
        let live = decay.live();
        let first = decay.acceleration[..decay.acceleration.len().min(LOOKED_AT)].to_vec();
        // Once the hand is gone, nothing drives it.
        let input = Input { kind: InputKind::Force, hold: Hold::First, values: vec![0.0; first.len()] };
        let record = Record::new(live.record().dt(), input, vec![(Quantity::ACCELERATION, first)]).ok()?;
        let mut scenario = suggest(&scenario_for(&record), &record).scenario;
        let record = live.so_far();
        let run = Run::from_source(&scenario, Source::Live(Arc::clone(&record))).ok()?;
        let table = read(Decay::file(std::slice::from_ref(&decay)).into_bytes(), None).ok()?;
        scenario.record = Some(Mapping { file: NAME.to_owned(), ..Mapping::guess(&table).0 });
        Some(Self { decay, live, record, scenario, run, taken: f64::NEG_INFINITY })
    }

    fn take(&mut self, readings: &[[f64; 4]], most: usize) {
        let Self { decay, live, record, run, taken, .. } = self;
        let first = readings.partition_point(|reading| reading[0] <= *taken || reading[0] < decay.begin);
        for reading in readings[first..].iter().take(most) {
            // Refused readings are reported elsewhere, and stay in the file.
            let _ = live.take(reading[0], f64::NAN, &[decay.along(*reading)]);
            *taken = taken.max(reading[0]);
        }
        if live.update(record) {
            run.lengthen(Arc::clone(record));
            run.advance_to(usize::MAX);
        }
    }

    fn estimates(&self) -> Option<[Band; 2]> {
        let estimates = self.run.estimates().first()?;
        let last = estimates.len().checked_sub(1).filter(|_| estimates.stop().is_none())?;
        let of = |channel: Channel| {
            let place = estimates.place(channel)?;
            Some(Band { mean: estimates.canonical_mean(last, place), band: 2.0 * estimates.std(last, place) })
        };
        let [frequency, damping] = [of(Channel::NATURAL_FREQUENCY)?, of(Channel::DAMPING_RATIO)?];
        let is_known = frequency.mean > 0.0 && frequency.band < 0.2 * frequency.mean && damping.band.is_finite();
        is_known.then_some([frequency, damping])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn readings(again: f64, size: f64) -> Vec<[f64; 4]> {
        let noise = |n: usize| f64::from((n as u32).wrapping_mul(2_654_435_761) >> 8) / f64::from(1 << 24) - 0.5;
        let reading = |k: usize| {
            let t = (k as f64 + 0.4 * noise(7 * k)) / 60.0;
            let (since, size) = if t < again { (t - 2.0, 2.0) } else { (t - again, size) };
            let a = if t < 2.0 { 0.0 } else { size * (-0.06 * since).exp() * (6.0 * since).cos() };
            let [x, y, z] = [1, 2, 3].map(|axis| 0.06 * noise(3 * k + axis));
            [t, 0.3 + 0.6 * a + x, 9.7 + 0.8 * a + y, z]
        };
        (0..2400).map(reading).collect()
    }

    #[test]
    fn the_estimates_follow_the_readings_and_go_on_with_another_pluck() {
        for (again, size) in [(20.0, 2.0), (15.0, 1.8), (25.2, 5.0)] {
            let readings = readings(again, size);
            let mut live = LiveFilter::default();
            let mut known = Vec::new();
            for count in (1..=readings.len()).step_by(6) {
                live.follow(&readings[..count]);
                known.extend(live.estimates().map(|estimates| (readings[count - 1][0], estimates)));
            }
            let (first, _) = known[0];
            assert!((3.0..8.0).contains(&first), "known from {first} s on");
            let mut bands = Vec::new();
            for at in [10.0, again - 0.5, again + 3.0, again + 8.0, 39.0] {
                let (_, [frequency, damping]) =
                    known.iter().rfind(|(time, _)| *time <= at).expect("it is known by then");
                let name = format!("{again}, {size}, {at} s: {frequency:?} {damping:?}");
                assert!((frequency.mean / 6.0 - 1.0).abs() < 0.005, "{name}");
                assert!((damping.mean - 0.01).abs() < 0.003, "{name}");
                assert!((damping.mean - 0.01).abs() < 2.5 * damping.band, "{name}");
                bands.push(damping.band);
            }
            assert!(bands[4] < 0.85 * bands[1], "both plucks together know more: {bands:?}");
        }
    }
}
