//! Lanes held to the same filters over plain numbers, and alone.

use kalmanscope_core::internals::engine::{self, Baseline, Setup};
use kalmanscope_core::score::Outcome;
use kalmanscope_core::{Hold, Record, Scenario};
use kalmanscope_lanes::{LaneRun, Level, outcomes_with};

use crate::outcome_bits::bits;

/// The outcome by the engine over plain numbers.
fn single(run: &LaneRun<'_>, samples: &[usize]) -> Outcome {
    let setup = Setup::new(run.scenario, run.place, run.record).unwrap().unwrap();
    let run = engine::Run { setup: &setup, record: run.record };
    engine::outcomes::<f64, _>(Baseline, &[run], samples).remove(0)
}

/// Holds every lane at every instruction set to the same filter over plain numbers. Returns their outcomes.
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

/// No filter that goes well estimates a number beyond this.
const FAR: f64 = 1e9;

/// Whether the book or the engine runs a filter that is alone, and no kernel, whose bits are others.
fn is_of_engine(scenario: &Scenario, place: usize, record: &Record) -> bool {
    let filter = &scenario.filters[place];
    let has_steps = filter.steps(scenario.plant.kind, scenario.input, record.dt()) > 1;
    let is_wide = !filter.augment.is_empty() || filter.log_parameters || has_steps;
    is_wide || record.clocks().is_some() || filter.robust.is_on() || scenario.hold == Hold::First
}

/// Holds the lanes of a scenario's filters to their runs alone, over a record without a truth. Returns how many were compared.
pub(crate) fn check_alone(scenario: &Scenario, record: &Record, what: &str) -> usize {
    let of_engine: Vec<usize> =
        (0..scenario.filters.len()).filter(|place| is_of_engine(scenario, *place, record)).collect();
    let runs: Vec<LaneRun<'_>> = of_engine.iter().map(|&place| LaneRun { scenario, place, record }).collect();
    for (lane, &place) in outcomes_with(Level::best(), &runs, &[]).unwrap().iter().zip(&of_engine) {
        let alone = Outcome::of(scenario, place, record).unwrap();
        // Where det S leaves the range of numbers, a history factorises S again, as far as rounding lets it. Such a filter has diverged.
        let mut lane = lane.clone();
        if lane.mean.iter().any(|mean| mean.abs() > FAR)
            && (lane.log_likelihood - alone.log_likelihood).abs() < 1e-6 * alone.log_likelihood.abs()
        {
            lane.log_likelihood = alone.log_likelihood;
        }
        assert_eq!(bits(&lane), bits(&alone), "{what}, filter {place}");
    }
    of_engine.len()
}
