//! The largest motion and force so far.

pub(super) use kalmanscope_core::channel::MAX_MASSES;

use kalmanscope_core::{Channel, Record, Run};

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Peak {
    /// Displacement of any mass \[m\].
    pub(super) reach: f64,
    /// Stretch of any link \[m\].
    pub(super) drift: f64,
    /// Mean force over mass within [`SPELL`] \[m/s²\].
    pub(super) force: f64,
}

impl Peak {
    /// The largest values up to sample `k` of the true motion of `masses`.
    pub(super) fn up_to(record: &Record, masses: usize, k: usize) -> Self {
        let to = (k + 1).min(record.len());
        let mut peak = Self::default();
        let mut before: Option<&[f64]> = None;
        for mass in 0..masses {
            let Some(x) = record.truth(displacement(mass)).and_then(|x| x.get(..to)) else { break };
            // `max` ignores NaN.
            peak.reach = x.iter().fold(peak.reach, |reach, x| reach.max(x.abs()));
            peak.drift = match before {
                Some(before) => {
                    x.iter().zip(before).fold(peak.drift, |drift, (x, before)| drift.max((x - before).abs()))
                }
                None => peak.reach,
            };
            before = Some(x);
        }
        let window = window(record);
        let force = record.input().get(..to).unwrap_or_default().chunks_exact(window);
        peak.force = force.map(|f| f.iter().sum::<f64>().abs() / window as f64).fold(0.0, f64::max);
        peak
    }
}

pub(super) fn displacement(mass: usize) -> Channel {
    Channel::displacement(mass.min(MAX_MASSES - 1))
}

pub(super) fn masses(run: &Run) -> usize {
    let known = |mass: usize| run.record().truth(displacement(mass)).is_some();
    let there = |mass: &usize| if known(0) { known(*mass) } else { run.channels().contains(&displacement(*mass)) };
    (0..MAX_MASSES).take_while(there).count().max(1)
}

/// Duration over which the arrow averages the force, because an arrow that followed white noise would flicker \[s\].
pub(super) const SPELL: f64 = 0.1;

/// The number of samples in a [`SPELL`], at least one.
pub(super) fn window(record: &Record) -> usize {
    (SPELL / record.dt()).round().clamp(1.0, 1e5) as usize
}

/// The mean force over mass within the [`SPELL`] that ends with sample `k` \[m/s²\].
pub(super) fn recent(record: &Record, k: usize) -> f64 {
    let first = (k + 1).saturating_sub(window(record));
    let force = record.input().get(first..=k).unwrap_or_default();
    force.iter().sum::<f64>() / window(record) as f64
}

#[cfg(test)]
mod tests {
    use kalmanscope_core::{PlantKind, Run, Scenario};

    use super::*;

    fn record(masses: usize, seed: u64) -> Record {
        let mut scenario = Scenario { duration: 30.0, seed, ..Scenario::default() };
        scenario.plant.kind = if masses == 3 { PlantKind::SHEAR_3 } else { PlantKind::SDOF };
        scenario.filters.clear();
        let mut run = Run::new(&scenario).unwrap();
        run.finish();
        run.record().clone()
    }

    fn whole(record: &Record, masses: usize, k: usize) -> (f64, f64) {
        let mut all = (0.0, 0.0);
        for j in 0..=k {
            let mut before = 0.0;
            for mass in 0..masses {
                let x = record.truth(displacement(mass)).unwrap()[j];
                all = (x.abs().max(all.0), (x - before).abs().max(all.1));
                before = x;
            }
        }
        all
    }

    #[test]
    fn they_are_those_of_all_samples_wherever_playback_goes() {
        for masses in [1, 3] {
            for seed in [1, 2] {
                let record = record(masses, seed);
                for k in [0, 3, 511, 512, 2900, 700, 0, 1900, 3000] {
                    let peak = Peak::up_to(&record, masses, k);
                    assert_eq!((peak.reach, peak.drift), whole(&record, masses, k), "{masses} {seed} {k}");
                }
            }
        }
    }
}
