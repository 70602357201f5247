//! A run that forgets its first samples continues bit by bit, in constant memory.

use kalmanscope_core::{
    Adaptation, Channel, CramerRao, Diagnostics, Estimates, FilterKind, FilterSettings, Force, PlantKind, Quantity,
    Run, Scenario, Sensor, Update,
};

use crate::numbers::bits;
use crate::run::{bound, finished, finished_on, of_all_kinds, oscillator};

fn eventful() -> Scenario {
    let mut scenario = Scenario { duration: 9.0, ..Scenario::default() };
    scenario.plant.disturbance_std = 0.5;
    scenario.add_sensor(Sensor::new(Quantity::ACCELERATION, 0.5));
    let template = scenario.filters[0].clone();
    let learning = Adaptation { sensor_noise: true, process_noise: true, ..Adaptation::default() };
    scenario.filters = of_all_kinds(&template);
    let is_iterated = |filter: &&mut FilterSettings| filter.kind == FilterKind::IEKF;
    scenario.filters.iter_mut().filter(is_iterated).for_each(|filter| filter.log_parameters = true);
    scenario.filters.extend([
        FilterSettings { name: "learning".to_owned(), adaptation: learning, ..template.clone() },
        FilterSettings { name: "stopping".to_owned(), fading: 1e30, ..template.clone() },
        FilterSettings { name: "winding up".to_owned(), fading: 1.2, ..template.clone() },
        FilterSettings { name: "wrong".to_owned(), plant: Some(PlantKind::DUFFING), ..template },
    ]);
    scenario
}

fn assert_is_end_of(kept: &Estimates, all: &Estimates) {
    let (gone, name) = (kept.forgotten(), all.name());
    assert_eq!(kept.len(), all.len().saturating_sub(gone), "{name}");
    for k in 0..kept.len() {
        for of in [Estimates::mean, Estimates::cov, Estimates::innovation, Estimates::innovation_cov, Estimates::gain] {
            assert_eq!(bits(of(kept, k)), bits(of(all, gone + k)), "{name} at {k} after {gone}");
        }
        let likelihoods = [kept.log_likelihood(k), all.log_likelihood(gone + k)].map(f64::to_bits);
        assert_eq!(likelihoods[0], likelihoods[1], "{name} at {k} after {gone}");
    }
    for of in [Estimates::nis, Estimates::determinant, Estimates::effective_samples] {
        assert_eq!(bits(of(kept)), bits(of(all).get(gone..).unwrap_or_default()), "{name} after {gone}");
    }
    assert_eq!(kept.stop(), all.stop(), "{name}");
    let remarks: Vec<_> = all.remarks().iter().copied().filter(|remark| remark.last + 50 >= gone).collect();
    assert_eq!(kept.remarks(), remarks, "{name}");
    for place in 0..kept.channels().len() {
        assert_eq!(kept.initial_std(place).to_bits(), all.initial_std(place).to_bits());
    }
}

fn assert_is_end_of_run(kept: &Run, all: &Run) {
    let (record, whole) = (kept.record(), all.record());
    let gone = record.forgotten();
    assert_eq!((kept.done(), kept.samples()), (all.done(), all.samples()));
    assert_eq!((kept.len(), record.len()), (all.len() - gone, all.len() - gone));
    assert_eq!(bits(record.input()), bits(&whole.input()[gone..]));
    for sensor in 0..record.sensors().len() {
        assert_eq!(bits(record.measured(sensor)), bits(&whole.measured(sensor)[gone..]));
    }
    for &channel in Channel::all() {
        assert_eq!(record.truth(channel), whole.truth(channel).map(|truth| &truth[gone..]));
    }
    for k in 0..kept.len() {
        assert_eq!(record.time(k).to_bits(), whole.time(gone + k).to_bits());
    }
    assert_eq!(record.time_of(7).to_bits(), whole.time(7).to_bits());
    for (kept, all) in kept.estimates().iter().zip(all.estimates()) {
        assert_is_end_of(kept, all);
    }
}

#[test]
fn forgetting_changes_no_bit_of_what_is_kept() {
    let scenario = eventful();
    let mut all = Run::new(&scenario).unwrap();
    let mut kept = Run::new(&scenario).unwrap();
    for (forget, portion) in [(0, 1), (1, 1), (0, 99), (50, 1), (99, 1), (3, 120), (17, 330), (9999, 1), (9999, 999)] {
        assert!(kept.forget(forget));
        all.advance_to(all.done() + portion);
        kept.advance_to(kept.done() + portion);
        assert_is_end_of_run(&kept, &all);
    }
    assert_eq!((kept.done(), kept.samples()), (901, 901));
    let stops: Vec<&str> = all.estimates().iter().filter(|e| e.stop().is_some()).map(Estimates::name).collect();
    assert_eq!(stops, ["stopping"]);
    assert!(all.estimates().iter().filter(|e| !e.remarks().is_empty()).count() >= 2);
}

#[test]
fn the_memory_is_reused() {
    let mut run = Run::new(&Scenario { duration: 100.0, ..Scenario::default() }).unwrap();
    run.advance_to(1000);
    let places = |run: &Run| {
        let estimates = &run.estimates()[0];
        [run.record().input().as_ptr(), estimates.mean(0).as_ptr(), estimates.cov(0).as_ptr(), estimates.nis().as_ptr()]
    };
    let before = places(&run);
    while run.done() < run.samples() {
        run.forget(500);
        run.advance_to(run.done() + 500);
        assert!(run.len() <= 1000);
    }
    assert_eq!(places(&run), before);
}

#[test]
fn a_diverging_truth_stops_at_the_same_sample() {
    let mut scenario = Scenario { force: Force::None, ..Scenario::default() };
    scenario.set_plant(PlantKind::DUFFING);
    scenario.plant.set(Channel::CUBIC_STIFFNESS, -300.0);
    scenario.plant.initial.displacement = 0.5;
    let all = finished(&scenario);
    let mut kept = Run::new(&scenario).unwrap();
    kept.advance_to(10);
    kept.forget(8);
    kept.finish();
    assert!(all.truth_stop().is_some_and(|stop| stop.sample == all.len()));
    assert_eq!((kept.truth_stop(), kept.samples(), kept.done()), (all.truth_stop(), all.samples(), all.done()));
    assert_is_end_of_run(&kept, &all);
}

#[test]
fn diagnostics_and_bounds_cover_the_kept_samples() {
    let mut scenario = Scenario { duration: 40.0, plant: oscillator(6.0, 0.05), ..Scenario::default() };
    scenario.filters.push(FilterSettings { kind: FilterKind::KF, ..scenario.filters[0].clone() });
    let mut all = Run::new(&scenario).unwrap();
    let mut kept = Run::new(&scenario).unwrap();
    let mut following: Vec<Diagnostics> = kept.estimates().iter().map(|e| Diagnostics::new(e, kept.record())).collect();
    let mut bounds: Vec<CramerRao> = (0..3).filter_map(|i| CramerRao::new(&scenario, i, scenario.dt)).collect();
    for done in [700, 1500, 1501, 3000, 4001] {
        kept.forget(650);
        kept.advance_to(done);
        following.iter_mut().zip(kept.estimates()).for_each(|(d, e)| d.follow_to(e.len(), e, kept.record()));
        bounds.iter_mut().for_each(|bound| {
            bound.follow_to(kept.record().len(), kept.record());
        });
    }
    all.finish();
    let gone = kept.record().forgotten();
    assert_eq!(gone, 2150);
    for (place, (estimates, diagnostics)) in kept.estimates().iter().zip(&following).enumerate() {
        let whole = Diagnostics::new(&all.estimates()[place], all.record());
        let anew = Diagnostics::new(estimates, kept.record());
        assert_eq!((diagnostics.len(), diagnostics.stop), (estimates.len(), None));
        assert_eq!(bits(diagnostics.nees()), bits(&whole.nees()[gone..]));
        assert_eq!(diagnostics.log_likelihood().to_bits(), anew.log_likelihood().to_bits());
        let n = diagnostics.len();
        for range in [0..n, 0..n / 3, n / 2..n, n - 7..n] {
            let moved = range.start + gone..range.end + gone;
            let close = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-12, "{range:?}: {a} and {b}");
            close(anew.nis_within(range.clone()).sum, whole.nis_within(moved.clone()).sum);
            close(anew.nees_within(range.clone()).sum, whole.nees_within(moved.clone()).sum);
            for channel in anew.known() {
                let squares = |d: &Diagnostics, range| d.tally(channel, range).unwrap().squares;
                close(squares(&anew, range.clone()), squares(&whole, moved.clone()));
            }
        }
        for channel in diagnostics.known() {
            assert_eq!(diagnostics.error(channel), whole.error(channel));
            assert_eq!(diagnostics.settled(channel), whole.settled(channel), "{}", channel.name());
        }
        let bound = bound(&scenario, place, all.record());
        assert_eq!(bounds[place].len(), 4001 - gone);
        for (k, channel) in (0..bounds[place].len()).flat_map(|k| (0..4).map(move |channel| (k, channel))) {
            assert_eq!(bounds[place].std(k, channel).to_bits(), bound.std(gone + k, channel).to_bits());
        }
    }
    let frequency = following[0].settled(Channel::NATURAL_FREQUENCY).unwrap();
    assert!(frequency < gone, "the time of settling is not forgotten, but it is {frequency}");
    assert!(CramerRao::new(&scenario, 3, scenario.dt).is_none(), "there is no such filter");
    let late = bound(&scenario, 0, kept.record());
    assert!(late.is_empty(), "no bound without the beginning");
}

#[test]
fn a_smoother_needs_the_beginning_and_a_measured_record_is_not_forgotten() {
    let mut scenario = Scenario { duration: 3.0, ..Scenario::default() };
    scenario.filters[0].smoother = true;
    let mut run = finished(&scenario);
    assert_eq!(run.smoothed().len(), 1);
    let mut measured = finished_on(&scenario, run.record().clone());
    assert!(!measured.forget(100));
    assert_eq!((measured.len(), measured.estimates()[0].len()), (301, 301));
    run.forget(100);
    assert!(run.smoothed().is_empty());
    assert_eq!(run.update(&scenario), Ok(Update::Everything));
    assert_eq!((run.done(), run.record().forgotten(), run.estimates()[0].forgotten()), (0, 0, 0));
}
