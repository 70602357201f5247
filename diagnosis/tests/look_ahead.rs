//! Smoothers with a fixed look-ahead.

use std::sync::Arc;

use kalmanscope_core::{
    Channel, Estimates, FilterKind, FilterSettings, Hold, PlantKind, Record, Run, Scenario, Source, simulate, smoothed,
};
use kalmanscope_diagnosis::{Hindsight, Study, Wanted};

use crate::numbers::apart;
use crate::run::finished;

fn scenarios() -> Vec<Scenario> {
    let base = FilterSettings { smoother: true, ..Scenario::default().filters[0].clone() };
    let filters = [
        FilterSettings { kind: FilterKind::EKF, fading: 1.01, ..base.clone() },
        FilterSettings { kind: FilterKind::UKF, log_parameters: true, input_delay: 3, ..base.clone() },
        FilterSettings { kind: FilterKind::SR_UKF, augment: vec![Channel::INPUT_GAIN], ..base.clone() },
        FilterSettings { kind: FilterKind::IEKF, augment: vec![Channel::WHITE_FORCE], ..base.clone() },
        FilterSettings { kind: FilterKind::CKF, jump: true, ..base },
    ];
    let of = |kind| {
        let mut scenario = Scenario { duration: 4.0, hold: Hold::First, ..Scenario::default() };
        (scenario.plant.kind, scenario.filters) = (kind, filters.to_vec());
        scenario.number_filters();
        scenario
    };
    [PlantKind::SDOF, PlantKind::DUFFING, PlantKind::SHEAR_2].map(of).into()
}

fn record(scenario: &Scenario) -> Record {
    simulate(scenario).with_gaps(|sensor, k| k > 0 && (k % (11 + sensor) == 3 || (150..170).contains(&k)))
}

#[test]
fn each_sample_knows_what_comes_within_the_look_ahead() {
    for scenario in scenarios() {
        let record = record(&scenario);
        let mut run = Run::on_record(&scenario, Arc::new(record.clone())).unwrap();
        let mut whole: Vec<Vec<Estimates>> = Vec::new();
        while run.step() {
            whole.push(run.smoothed());
        }
        for lag in [1, 2, 7, 60, 1000] {
            for place in 0..scenario.filters.len() {
                let mut scenario = scenario.clone();
                scenario.filters[place].look_ahead = lag as f64 * record.dt();
                let lagged = smoothed(&scenario, place, &record).unwrap();
                assert_eq!(lagged.len(), whole.last().unwrap()[place].len());
                for k in 0..lagged.len() {
                    let then = &whole[(k + lag).min(whole.len() - 1)][place];
                    let far = apart((&lagged, k), (then, k));
                    assert!(far < 1e-6, "{} {lag} of {k}: {far}", lagged.name());
                }
            }
        }
    }
}

#[test]
fn it_goes_along_with_a_run() {
    let mut scenario = Scenario { filters: scenarios()[0].filters.clone(), ..Scenario::default() };
    scenario.filters.iter_mut().for_each(|filter| filter.look_ahead = 0.37);
    scenario.filters[1].look_ahead = 0.0;
    let lagged = Wanted { smoothed: Hindsight::Lagged, ..Wanted::NOTHING };
    let all = finished(&scenario).smoothed();
    for window in [usize::MAX, 300, 40] {
        let mut study = Study::new(&scenario, Source::Simulated, window).unwrap();
        study.want(lagged);
        let mut longest = 0;
        for done in (0..2000).step_by(13) {
            while !study.advance_to(done, &mut || false) {}
            let there = study.analysis().smoothed();
            assert_eq!(there.len(), if done > 0 { 4 } else { there.len() }, "that of the whole record waits");
            for estimates in there {
                let same = all.iter().find(|of| of.id() == estimates.id()).unwrap();
                let forgotten = study.run().record().forgotten();
                assert_eq!(estimates.forgotten(), forgotten);
                assert_eq!(estimates.len(), study.run().done().saturating_sub(37 + forgotten));
                for k in 0..estimates.len() {
                    assert_eq!(apart((estimates, k), (same, forgotten + k)), 0.0);
                }
                longest = longest.max(estimates.len());
            }
        }
        assert!(longest > 0 || window == 40, "{window}");
    }
}

#[test]
fn it_grows_with_a_live_record_and_has_all_of_it_at_the_end() {
    let mut scenario = scenarios().remove(0);
    scenario.filters.iter_mut().for_each(|filter| (filter.input_delay, filter.look_ahead) = (0, 0.2));
    let record = record(&scenario);
    let part = |length: usize| Arc::new(record.part(0..length));
    let mut study = Study::new(&scenario, Source::Live(part(10)), 1000).unwrap();
    study.want(Wanted { smoothed: Hindsight::All, ..Wanted::NOTHING });
    for length in [10, 30, 31, 200, 401] {
        assert!(length == 10 || study.lengthen(part(length)));
        study.advance_to(usize::MAX, &mut || true);
        let there = study.analysis().smoothed();
        assert_eq!(there.len(), 5);
        assert!(there.iter().all(|of| of.len() == length.saturating_sub(20)), "{length}");
    }
    let mut ended = Study::new(&scenario, Source::Measured(part(401)), 1000).unwrap();
    ended.advance_to(usize::MAX, &mut || true);
    let (live, ended) = (study.analysis().smoothed(), ended.analysis().smoothed());
    for (live, ended) in live.iter().zip(ended) {
        assert_eq!((live.len(), ended.len()), (381, 401));
        assert!((0..381).all(|k| apart((live, k), (ended, k)) == 0.0), "{}", live.name());
    }
}

#[test]
fn it_stays_at_the_end_of_a_run() {
    let mut scenario = Scenario { duration: 5.0, ..Scenario::default() };
    (scenario.filters[0].smoother, scenario.filters[0].look_ahead) = (true, 0.5);
    let mut study = Study::new(&scenario, Source::Simulated, 1000).unwrap();
    study.want(Wanted { smoothed: Hindsight::Lagged, ..Wanted::NOTHING });
    let there = |study: &mut Study| {
        study.advance_to(usize::MAX, &mut || true);
        let [one] = study.analysis().smoothed() else { panic!("one filter has a smoother") };
        (one.len(), one.nis().as_ptr())
    };
    let first = there(&mut study);
    assert_eq!(first.0, 501);
    assert_eq!(first, there(&mut study));
}

#[test]
fn it_ends_where_its_filter_stops() {
    let mut scenario = Scenario { duration: 5.0, ..Scenario::default() };
    let filter = &mut scenario.filters[0];
    (filter.smoother, filter.look_ahead, filter.fading) = (true, 0.5, 1e30);
    let run = finished(&scenario);
    let stop = run.estimates()[0].stop().expect("so much fading is too much");
    let [lagged] = &run.smoothed()[..] else { panic!("one filter has a smoother") };
    assert_eq!((lagged.stop(), lagged.len()), (Some(stop), stop.sample));
}

#[test]
fn a_look_ahead_is_at_least_a_step() {
    let mut scenario = Scenario { duration: 1.0, ..Scenario::default() };
    scenario.filters[0].smoother = true;
    let of = |look_ahead: f64| {
        let mut scenario = scenario.clone();
        scenario.filters[0].look_ahead = look_ahead;
        finished(&scenario).smoothed().pop().unwrap()
    };
    let endless = of(1e300);
    let [least, step, long, whole] = [1e-9, 0.01, 100.0, 0.0].map(of);
    assert_eq!(apart((&least, 50), (&step, 50)), 0.0);
    assert!(apart((&long, 50), (&whole, 50)) < 1e-6 && apart((&step, 50), (&whole, 50)) > 1e-3);
    assert_eq!(apart((&endless, 50), (&long, 50)), 0.0);
}
