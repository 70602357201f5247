//! Filters of typed equations go side by side: with the bits of a single number, and the single filter's numbers to rounding.

use std::path::Path;

use crate::held::{check, check_alone};
use crate::outcome_bits::bits;
use kalmanscope_core::internals::engine::Baseline;
use kalmanscope_core::internals::engine::{self, Setup};
use kalmanscope_core::score::Outcome;
use kalmanscope_core::{FilterKind, PlantKind, Run, Scenario};
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

/// By default filters of plants that are not linear divide their steps: a map's cell has the bits of the run on screen.
#[test]
fn filters_that_divide_their_steps_have_the_bits_of_the_run_alone() {
    let mut all: Vec<(String, Scenario)> =
        gallery().into_iter().filter(|(_, scenario)| !scenario.plant.kind.info().is_linear).collect();
    assert!(all.len() > 4);
    for kind in [PlantKind::DUFFING, PlantKind::BOUC_WEN] {
        let mut scenario = Scenario { duration: 3.0, ..Scenario::default() };
        scenario.set_plant(kind);
        all.push((kind.key().to_owned(), scenario));
    }
    for (name, mut scenario) in all {
        let mut truth = Run::new(&Scenario { filters: Vec::new(), ..scenario.clone() }).unwrap();
        truth.finish();
        let record = truth.record().clone();
        let first = scenario.filters.remove(0);
        scenario.filters = [FilterKind::EKF, FilterKind::UKF, FilterKind::CKF]
            .map(|kind| kalmanscope_core::FilterSettings { kind, name: kind.name().to_owned(), ..first.clone() })
            .into();
        scenario.number_filters();
        let run = |place| LaneRun { scenario: &scenario, place, record: &record };
        check(&[run(0)], &name);
        assert_eq!(check_alone(&scenario, &record, &name), 3, "{name}");
    }
}
