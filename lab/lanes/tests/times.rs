//! Filters side by side over readings with their own times: every lane has the bits of a single number and of the filter alone.

use crate::draw::{Draw, ensemble};
use crate::held::{check, check_alone};
use kalmanscope_core::filter::Adaptation;
use kalmanscope_core::internals::engine::Setup;
use kalmanscope_core::record::{Clocks, Timed};
use kalmanscope_core::score::Outcome;
use kalmanscope_core::{Channel, Record, simulate};
use kalmanscope_lanes::LaneRun;

/// The record with readings that come up to half a step early or late, of which some are missing and some come twice, and an input
/// with a slower clock or with the samples' times.
fn with_own_times(record: Record, draw: &mut Draw) -> Record {
    let reading = |column: usize, draw: &mut Draw| {
        let mut timed = Timed::default();
        for (k, value) in record.measured(column).iter().enumerate().filter(|(_, value)| value.is_finite()) {
            let times = if draw.once_in(5) { draw.below(3) } else { 1 };
            for nth in 0..times {
                let time = k as f64 - 0.5 + 0.5 * nth as f64 + draw.between(0.0, 0.4);
                if timed.times.last().is_none_or(|last| *last < time) && time > 0.0 {
                    timed.times.push(time);
                    timed.values.push(value * (1.0 + 0.01 * nth as f64));
                }
            }
        }
        timed
    };
    let readings = (0..record.sensors().len()).map(|column| reading(column, draw)).collect();
    let input = draw.once_in(2).then(|| {
        let apart = draw.between(0.4, 2.5);
        let times: Vec<f64> = (0..).map(|k| apart * f64::from(k)).take_while(|t| *t < record.len() as f64).collect();
        let values = times.iter().map(|time| record.input()[*time as usize]).collect();
        Timed { times, values }
    });
    record.with_clocks(Clocks { input, readings }).unwrap()
}

#[test]
fn lanes_have_the_bits_of_a_single_number_and_of_the_filter_alone() {
    let (mut together, mut alone, mut stopped, mut twice) = (0, 0, 0, 0);
    for seed in 3000..3100 {
        let mut scenario = ensemble(seed);
        let mut draw = Draw(seed);
        let delay = scenario.filters.first().map_or(0, |filter| filter.input_delay);
        for filter in &mut scenario.filters {
            // Both count in samples.
            filter.adaptation = Adaptation::default();
            filter.augment.retain(|channel| *channel != Channel::WHITE_FORCE);
        }
        if draw.once_in(2) {
            scenario.filters.iter_mut().for_each(|filter| filter.input_delay = delay);
        }
        let record = with_own_times(simulate(&scenario), &mut draw);
        let run = |place| LaneRun { scenario: &scenario, place, record: &record };
        let setup = |run: &LaneRun<'_>| Setup::new(run.scenario, run.place, run.record).unwrap();
        let runs: Vec<LaneRun<'_>> =
            (0..scenario.filters.len()).map(run).filter(|run| setup(run).is_some_and(|setup| setup.is_timed)).collect();
        if runs.is_empty() {
            continue;
        }
        let what = format!("seed {seed} {:?} {:?}", scenario.plant.kind, scenario.filters[0]);
        let outcomes = check(&runs, &what);

        alone += check_alone(&scenario, &record, &what);
        together += outcomes.len();
        stopped += outcomes.iter().filter(|outcome| outcome.stop.is_some()).count();
        let readings: usize = record.clocks().unwrap().readings.iter().map(|timed| timed.times.len()).sum();
        let told = |outcome: &Outcome| outcome.nis.degrees as usize == readings;
        twice += usize::from(outcomes.iter().any(|outcome| outcome.stop.is_none() && told(outcome)));
    }
    assert!(together > 400, "{together} runs go in lanes");
    assert!(alone > 400, "{alone} filters are compared with themselves alone");
    assert!(stopped > together / 30 && stopped < together / 2, "{stopped} of {together} runs stop");
    assert!(twice > 10, "all readings count in {twice} records");
}
