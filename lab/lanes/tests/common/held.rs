//! Lanes held to the same filters over plain numbers, and alone.

use kalmanscope_core::internals::engine::{self, Baseline, Setup};
use kalmanscope_core::score::Outcome;
use kalmanscope_core::{Record, Scenario};
use kalmanscope_lanes::{LaneRun, Level, outcomes_with};

fn single(run: &LaneRun<'_>, samples: &[usize]) -> Outcome {
    let setup = Setup::new(run.scenario, run.place, run.record).unwrap().unwrap();
    let run = engine::Run { setup: &setup, record: run.record };
    engine::outcomes::<f64, _>(Baseline, &[run], samples).remove(0)
}

pub(crate) fn check(runs: &[LaneRun<'_>], what: &str) -> Vec<Outcome> {
    let last = runs[0].record.len() - 1;
    let samples = [0, 0, 1, 2, last / 3, last / 2, last, last, last + 3];
    let singles: Vec<Outcome> = runs.iter().map(|run| single(run, &samples)).collect();
    for level in Level::available() {
        let lanes = outcomes_with(level, runs, &samples).unwrap();
        assert_eq!(lanes.len(), singles.len());
        for (place, (lane, single)) in lanes.iter().zip(&singles).enumerate() {
            assert_eq!(bits(lane), bits(single), "{what}, run {place} at {level:?}\n{lane:?}\n{single:?}");
        }
    }
    singles
}

pub(crate) fn check_alone(scenario: &Scenario, record: &Record, what: &str) -> usize {
    let runs: Vec<LaneRun<'_>> = (0..scenario.filters.len()).map(|place| LaneRun { scenario, place, record }).collect();
    for (place, lane) in outcomes_with(Level::best(), &runs, &[]).unwrap().iter().enumerate() {
        let alone = Outcome::of(scenario, place, record).unwrap();
        assert_eq!(bits(lane), bits(&alone), "{what}, filter {place}");
    }
    runs.len()
}

/// Every number of an outcome, bit by bit; all NaNs count as equal.
pub(crate) fn bits(outcome: &Outcome) -> (Vec<u64>, String) {
    let Outcome { samples, nees, nis, log_likelihood, stop, diverged, channels, mean, std, sample_scores } = outcome;
    let mut numbers = vec![nees.sum, nis.sum, *log_likelihood];
    numbers.extend(mean.iter().chain(std));
    for (_, score) in channels {
        numbers.extend([score.error, score.std, score.rmse, score.coverage]);
    }
    for look in sample_scores {
        numbers.extend([look.nees, look.nis]);
        numbers.extend(look.channels.as_flattened());
    }
    let settled: Vec<_> = channels.iter().map(|(channel, score)| (channel.key(), score.settled)).collect();
    let counts = [nees.degrees, nees.samples, nis.degrees, nis.samples];
    let rest = format!("{samples} {counts:?} {stop:?} {diverged} {settled:?}");
    (numbers.iter().map(|x| if x.is_nan() { u64::MAX } else { x.to_bits() }).collect(), rest)
}
