//! Oscillators that are plucked several times.

use kalmanscope_core::free_decay::Decay;
use kalmanscope_core::import::read;
use kalmanscope_core::record::Record;
use kalmanscope_core::{
    Channel, EventFilter, FilterKind, FilterSettings, Hold, Identified, Quantity, Scenario, Sensor, Values,
};
use kalmanscope_diagnosis::{Summary, VerdictKind};
use nalgebra::{RowVector2, SMatrix, SVector, Vector2};

use crate::numbers::{ADAPTIVE, Random, transition};
use crate::phone::{Phone, USUAL};
use crate::run::{finished_on, forced, identified, values, with_times};

const DT: f64 = 0.02;
const NOISE: f64 = 0.05;
const OF: [f64; 2] = [6.0, 0.02];

fn record(seed: u64, pulls: &[usize], offset: f64) -> Record {
    let mut random = Random::new(seed);
    let mut state = Vector2::new(1.0, 0.0);
    let mut values = Vec::new();
    for k in 0..600 {
        if k > 0 {
            state = transition(OF, DT) * state;
        }
        if pulls.contains(&k) {
            state = Vector2::new(1.5 * random.normal(), 4.0 * random.normal());
        }
        let lost = pulls.iter().any(|&pull| k < pull && k + 25 > pull);
        values.push(if lost { f64::NAN } else { state[0] + offset + NOISE * random.normal() });
    }
    forced(DT, Hold::Zero, vec![0.0; values.len()], vec![(Quantity::DISPLACEMENT, values)])
}

fn scenario(kind: FilterKind, plucks: &[f64]) -> Scenario {
    let [wn, zeta] = if kind == FilterKind::KF { [0.0; 2] } else { [0.3, 0.01] };
    let filter = FilterSettings {
        kind,
        sensor_std: vec![NOISE],
        plucks: plucks.to_vec(),
        initial_mean: values([0.0, 0.0, OF[0], OF[1]]),
        initial_std: values([1.5, 6.0, wn, zeta]),
        process_std: Values::ZERO,
        ..FilterSettings::default()
    };
    let sensors = vec![Sensor::new(Quantity::DISPLACEMENT, NOISE)];
    Scenario { dt: DT, sensors, filters: vec![filter], ..Scenario::default() }
}

#[test]
fn a_kf_is_the_least_squares_of_all_parts() {
    let bias = Channel::from_key("bias_displacement").expect("there is one");
    for seed in [1, 2] {
        let record = record(seed, &[200, 410], 0.3);
        let mut scenario = scenario(FilterKind::KF, &[3.995, 8.19]);
        let filter = &mut scenario.filters[0];
        filter.augment = vec![bias];
        (filter.initial_mean[bias], filter.initial_std[bias], filter.process_std[bias]) = (0.0, 0.5, 0.0);
        filter.smoother = true;
        let run = finished_on(&scenario, record.clone());
        let prior = [1.5, 6.0, 1.5, 6.0, 1.5, 6.0, 0.5].map(|std: f64| std.powi(-2));
        let mut information = SMatrix::<f64, 7, 7>::from_diagonal(&SVector::from(prior));
        let mut score = SVector::<f64, 7>::zeros();
        // The step of the pluck begins at the sample before.
        let row = |k: usize| {
            let mut row = SMatrix::<f64, 1, 7>::zeros();
            for (place, begin) in [(0, 0), (2, 199), (4, 409)] {
                if k > begin || begin == 0 {
                    let of: RowVector2<f64> = transition(OF, DT * (k - begin) as f64).row(0).into_owned();
                    row.fixed_view_mut::<1, 2>(0, place).copy_from(&of);
                }
            }
            row[6] = 1.0;
            row
        };
        for k in 1..record.len() {
            let z = record.measured(0)[k];
            if !z.is_nan() {
                information += row(k).transpose() * row(k) / (NOISE * NOISE);
                score += row(k).transpose() * z / (NOISE * NOISE);
            }
        }
        let cov = information.try_inverse().expect("the prior is proper");
        let all = cov * score;
        let estimates = &run.estimates()[0];
        let (place, last) = (estimates.place(bias).expect("it is estimated"), estimates.len() - 1);
        let displacement = (row(last) * all)[0] - all[6];
        assert!((estimates.mean(last)[place] - all[6]).abs() < 1e-9, "{seed}");
        assert!((estimates.std(last, place) / cov[(6, 6)].sqrt() - 1.0).abs() < 1e-8, "{seed}");
        assert!((estimates.mean(last)[0] - displacement).abs() < 1e-8, "{seed}");
        let smoothed = run.smoothed()[0].clone();
        for k in [0, 150, 199, 200, 300, 409, 410, 599] {
            let expected = (row(k) * all)[0] - all[6];
            let found = smoothed.mean(k)[0];
            assert!((found - expected).abs() < 1e-7, "{seed}, {k}: {found} for {expected}");
            assert!((smoothed.std(k, place) / cov[(6, 6)].sqrt() - 1.0).abs() < 1e-6, "{seed}, {k}");
        }
    }
}

#[test]
fn all_parts_together_know_more() {
    let pulls = [200, 400];
    for (place, kind) in ADAPTIVE.into_iter().enumerate() {
        let (mut inside, mut spoilt, mut narrower) = ([0, 0], 0, 0);
        for seed in 0..20 {
            let record = record(100 + 20 * place as u64 + seed, &pulls, 0.0);
            let [once, ignorant] =
                [&[3.99, 7.99][..], &[]].map(|plucks| finished_on(&scenario(kind, plucks), record.clone()));
            let estimates = &once.estimates()[0];
            let [first, last] = [199, estimates.len() - 1].map(|k| estimates.std(k, 2));
            narrower += usize::from(last < 0.9 * first);
            assert!(last < first, "{kind:?} {seed}: {last} after {first}");
            for (i, inside) in inside.iter_mut().enumerate() {
                let error = estimates.mean(599)[2 + i] - OF[i];
                *inside += usize::from(error.abs() < 2.0 * estimates.std(599, 2 + i));
            }
            let other = &ignorant.estimates()[0];
            spoilt += usize::from((other.mean(599)[2] - OF[0]).abs() > 2.0 * other.std(599, 2));
        }
        assert!(inside.iter().all(|inside| *inside >= 16), "{kind:?}: {inside:?} of 20 inside");
        assert!(narrower >= 16, "{kind:?}: {narrower} of 20 know more");
        assert!(spoilt >= 15, "{kind:?}: {spoilt} of 20 are wrong where nobody tells of the plucks");
    }
}

#[test]
fn readings_with_times_have_the_same_plucks() {
    let even = record(5, &[200, 410], 0.0);
    let scenario = scenario(FilterKind::EKF, &[3.99, 8.19]);
    let run = finished_on(&scenario, even.clone());
    let there: Vec<usize> = (1..even.len()).filter(|&k| !even.measured(0)[k].is_nan()).collect();
    let timed = finished_on(&scenario, with_times(&even, |_, k| k));
    let mut by_its_clock = scenario.clone();
    by_its_clock.filters[0].plucks.iter_mut().for_each(|time| *time += 7.0);
    let mut events = EventFilter::new(&by_its_clock, 0).expect("it can follow events");
    events.take(7.0, 0.0, &[f64::NAN]).expect("it begins");
    for &k in &there {
        events.take(7.0 + DT * k as f64, f64::NAN, &[even.measured(0)[k]]).expect("it is taken in");
    }
    let mut later = scenario.clone();
    later.filters[0].plucks.iter_mut().for_each(|time| *time += 2.5);
    let later = finished_on(&later, even.starting_at(2.5));
    let std = run.estimates()[0].std(599, 2);
    let mean = run.estimates()[0].mean(599)[2];
    assert!((timed.estimates()[0].mean(599)[2] - mean).abs() < 1e-8 * std);
    assert!((events.sample().mean[2] - mean).abs() < 1e-6 * std, "{} {mean} {std}", events.sample().mean[2]);
    assert_eq!(later.checksum(), run.checksum(), "the times are those of the record");
}

#[test]
fn a_phone_that_is_plucked_twice_knows_more() {
    let (mut inside, mut narrower, mut consistent) = ([0, 0], 0, 0);
    for seed in 40..60 {
        let phone = Phone { again: Some(16.0), damping: 0.008, seconds: 32.0, seed, ..USUAL };
        let decays = Decay::alike(&phone.readings()).expect("it swings");
        assert_eq!(decays.len(), 2, "{seed}");
        let table = |decays: &[Decay]| read(Decay::file(decays).into_bytes(), None).expect("it is a table");
        let (both, run) = identified(&table(&decays));
        assert_eq!(run.scenario().filters[0].plucks.len(), 1, "{seed}");
        let verdict = Summary::new(&run.estimates()[0], run.record()).verdict.map(|verdict| verdict.kind);
        consistent += usize::from(verdict == Some(VerdictKind::Consistent));
        let alone = decays.iter().map(|decay| identified(&table(std::slice::from_ref(decay))).0[1].1);
        narrower += usize::from(alone.fold(f64::INFINITY, f64::min) > 1.1 * both[1].1);
        for ((inside, (found, std)), truth) in inside.iter_mut().zip(both).zip([phone.frequency, phone.damping]) {
            *inside += usize::from((found - truth).abs() < 2.0 * std);
        }
    }
    println!("inside {inside:?}, narrower {narrower}, consistent {consistent} of 20");
    assert!(consistent >= 17, "{consistent} of 20 are consistent");
    assert!(inside.iter().all(|inside| *inside >= 16) && narrower >= 18, "{inside:?} inside, {narrower} narrower");
}

#[test]
fn a_free_run_begins_anew() {
    let record = record(9, &[200, 410], 0.0);
    for (plucks, is_good) in [(&[3.995, 8.19][..], true), (&[], false)] {
        let scenario = scenario(FilterKind::EKF, plucks);
        let run = finished_on(&scenario, record.clone());
        let model = Identified::at(&scenario, &scenario.filters[0], &run.estimates()[0], 599);
        let free = model.run(run.record(), 0..600);
        let fit = free.fits[0].expect("there are readings");
        assert_eq!(fit.rms < 1.2 * NOISE, is_good, "{fit:?}");
        assert!(!is_good || free.predicted[0].iter().all(|x| x.is_finite()));
    }
}
