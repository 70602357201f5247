//! Filters of typed equations go side by side: with the bits of a single number, and the single filter's numbers to rounding.

use std::path::Path;

use crate::outcome_bits::bits;
use kalmanscope_core::internals::engine::Baseline;
use kalmanscope_core::internals::engine::{self, Setup};
use kalmanscope_core::score::Outcome;
use kalmanscope_core::{FilterKind, Run, Scenario};
use kalmanscope_lanes::{LaneRun, Level, outcomes_with, serves};

/// The scenarios of the gallery, with their names.
fn gallery() -> Vec<(String, Scenario)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/equations");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let read = |path: std::path::PathBuf| {
        let scenario = Scenario::from_toml(&std::fs::read_to_string(&path).unwrap()).unwrap();
        (path.display().to_string(), Scenario { duration: 3.0, ..scenario })
    };
    files.map(read).collect()
}

#[test]
fn filters_of_equations_go_side_by_side() {
    let gallery = gallery();
    assert_eq!(gallery.len(), 12);
    for (name, mut scenario) in gallery {
        let mut truth = Run::new(&Scenario { filters: Vec::new(), ..scenario.clone() }).unwrap();
        truth.finish();
        let record = truth.record().clone();
        let first = scenario.filters.remove(0);
        for kind in [FilterKind::EKF, FilterKind::UKF] {
            scenario.filters = (0..8).map(|_| first.clone()).collect();
            for (i, filter) in scenario.filters.iter_mut().enumerate() {
                (filter.kind, filter.id, filter.name) = (kind, i as u32 + 1, format!("{i}"));
                for channel in scenario.plant.kind.parameters() {
                    filter.initial_mean[channel] *= 1.0 + 0.02 * i as f64;
                }
            }
            let run = |place| LaneRun { scenario: &scenario, place, record: &record };
            let runs: Vec<LaneRun<'_>> = (0..8).map(run).collect();
            assert!(runs.iter().all(|run| serves(run).unwrap()), "{name}");
            let setups: Vec<Setup> =
                (0..8).map(|place| Setup::new(&scenario, place, &record).unwrap().unwrap()).collect();
            let single =
                |setup| engine::outcomes::<f64, _>(Baseline, &[engine::Run { setup, record: &record }], &[]).remove(0);
            let singles: Vec<Outcome> = setups.iter().map(single).collect();
            for level in Level::available() {
                for (lane, single) in outcomes_with(level, &runs, &[]).unwrap().iter().zip(&singles) {
                    assert_eq!(bits(lane), bits(single), "{name} {kind:?} at {level:?}");
                }
            }
            for (place, one) in singles.iter().enumerate() {
                let book = Outcome::of(&scenario, place, &record).unwrap();
                assert_eq!((one.stop, book.stop), (None, None), "{name} {kind:?}");
                for i in 0..one.mean.len() {
                    let off = (one.mean[i] - book.mean[i]).abs() / book.std[i].max(1e-12);
                    assert!(off < 1e-7, "{name} {kind:?} {place}: component {i} is {off:e} standard deviations off");
                }
            }
        }
    }
}
