//! Forces on single masses besides the input that acts on all of them.

use kalmanscope_core::import::{Mapping, build, read};
use kalmanscope_core::{
    Channel, FilterKind, Force, ForcedMass, Hold, InputKind, OnlineFilter, PlantKind, Propagation, Quantity, Record,
    Run, Scenario, Sensor, simulate,
};

use crate::numbers::farthest;
use crate::run::{finished_on, one_filter, run_on, simulated, truth, with_input, with_times};

fn on(mass: usize) -> ForcedMass {
    ForcedMass::new(mass).unwrap()
}

fn chain(kind: FilterKind, hold: Hold) -> Scenario {
    let mut scenario = Scenario { duration: 4.0, hold, ..one_filter(kind) };
    scenario.set_plant(PlantKind::SHEAR_3);
    scenario.set_sensors(
        &["displacement", "acceleration_2", "total_acceleration_3"].map(|key| Quantity::from_key(key).unwrap()),
    );
    (scenario.filters[0].fading, scenario.filters[0].ensemble_size) = (1.0, 60);
    scenario
}

/// The record whose force on all masses is one on each.
fn apart(record: &Record) -> Record {
    let forces = (0..3).map(|mass| (on(mass), record.input().to_vec())).collect();
    with_input(record, vec![0.0; record.len()]).with_forces(forces).unwrap()
}

#[test]
fn a_force_on_each_mass_is_one_on_all() {
    for (kind, hold) in FilterKind::ALL.into_iter().flat_map(|kind| [(kind, Hold::Zero), (kind, Hold::First)]) {
        let scenario = chain(kind, hold);
        let record = simulated(&scenario).without_truth();
        let late = |record: &Record| with_times(record, |sensor, k| (k - 0.3 * sensor as f64).max(0.0));
        let records = [&record, &apart(&record)];
        let pairs = [records.map(Record::clone), records.map(late)];
        let mut variants = vec![scenario.clone(), scenario.clone()];
        variants[1].filters[0].substeps = 3;
        variants[1].filters[0].input_delay = 2;
        if kind.info().has_propagation {
            variants.extend(Propagation::ALL.map(|propagation| {
                let mut other = scenario.clone();
                (other.filters[0].propagation, other.filters[0].eta) = (Some(propagation), 0.01);
                other
            }));
        }
        for (scenario, pair) in variants.iter().flat_map(|scenario| pairs.iter().map(move |pair| (scenario, pair))) {
            let runs = pair.each_ref().map(|record| run_on(scenario, record.clone()));
            let [one, other] = runs.each_ref().map(|run| &run.estimates()[0]);
            let error = farthest(one, other, 1);
            // A delay that the truth lacks amplifies rounding in filters that draw points.
            assert!(error < 1e-5, "{kind:?} {hold:?} {:?}: {error:e}", scenario.filters[0].propagation);
        }
    }
}

#[test]
fn a_truth_with_a_force_on_each_mass_is_one_with_a_force_on_all() {
    let sine = Force::Sine { amplitude: 4.0, frequency: 7.0 };
    for (kind, hold) in [PlantKind::SHEAR_3, PlantKind::DUFFING]
        .into_iter()
        .flat_map(|kind| [(kind.clone(), Hold::Zero), (kind, Hold::First)])
    {
        let mut all = Scenario { duration: 5.0, hold, force: sine, ..one_filter(FilterKind::EKF) };
        all.plant.input_delay = 3;
        all.set_plant(kind.clone());
        all.sensors = vec![Sensor::new(Quantity::ACCELERATION, 0.1)];
        let mut each = Scenario { force: Force::None, ..all.clone() };
        each.forces = (0..kind.masses()).map(|mass| (on(mass), sine)).collect();
        let [all, each] = [&all, &each].map(simulate);
        let largest = |of: &[f64]| of.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let channel = Channel::displacement(kind.masses() - 1);
        for [one, other] in [[&all, &each].map(|of| truth(of, channel)), [&all, &each].map(|of| of.measured(0))] {
            let difference: Vec<f64> = one.iter().zip(other).map(|(one, other)| one - other).collect();
            assert!(largest(&difference) < 1e-10 * largest(one), "{kind:?} {hold:?}: {}", largest(&difference));
        }
    }
}

/// By Runge-Kutta steps of a hundredth of a sample, written out here.
#[test]
fn a_force_on_one_mass_moves_a_chain_as_its_equation_says() {
    for hold in [Hold::Zero, Hold::First] {
        let mut scenario = chain(FilterKind::KF, hold);
        (scenario.force, scenario.input) =
            (Force::Sine { amplitude: 2.0, frequency: 9.0 }, InputKind::GroundAcceleration);
        scenario.forces = [(on(2), Force::WhiteNoise { std: 5.0 }), (on(0), Force::WhiteNoise { std: 3.0 })].into();
        let record = simulated(&scenario);
        let forces = [0, 2].map(|mass| record.force_on(on(mass)).unwrap());
        assert!((0..3).all(|k| forces[0][k] != forces[1][k]), "each has noise of its own");
        let known = |channel| truth(&record, channel)[0];
        let (stiffness, damping) =
            ([0, 1, 2].map(|mass| known(Channel::stiffness(mass))), known(Channel::STOREY_DAMPING));
        let rate = |y: &[f64; 6], f: [f64; 3]| {
            let storey = |i: usize| {
                let (x, v) = if i > 0 { (y[i - 1], y[i + 2]) } else { (0.0, 0.0) };
                stiffness[i] * (y[i] - x) + damping * (y[i + 3] - v)
            };
            let s = [storey(0), storey(1), storey(2), 0.0];
            [y[3], y[4], y[5], f[0] - s[0] + s[1], f[1] - s[1] + s[2], f[2] - s[2] + s[3]]
        };
        let (mut y, steps) = ([0.0; 6], 100);
        y[0] = scenario.plant.initial.displacement;
        y[3] = scenario.plant.initial.velocity;
        let mut worst: f64 = 0.0;
        for k in 0..record.len() - 1 {
            worst = worst.max((y[2] - truth(&record, Channel::displacement(2))[k]).abs());
            let at = |values: &[f64], share: f64| match hold {
                Hold::Zero => values[k],
                Hold::First => values[k] + (values[k + 1] - values[k]) * share,
            };
            let force = |share: f64| {
                let ground = -at(record.input(), share);
                [ground + at(forces[0], share), ground, ground + at(forces[1], share)]
            };
            let h = record.dt() / f64::from(steps);
            for step in 0..steps {
                let share = |part: f64| (f64::from(step) + part) / f64::from(steps);
                let plus = |slope: &[f64; 6], by: f64| std::array::from_fn(|i| y[i] + by * slope[i]);
                let k1 = rate(&y, force(share(0.0)));
                let k2 = rate(&plus(&k1, 0.5 * h), force(share(0.5)));
                let k3 = rate(&plus(&k2, 0.5 * h), force(share(0.5)));
                let k4 = rate(&plus(&k3, h), force(share(1.0)));
                y = std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]));
            }
        }
        assert!(worst < 1e-9, "{hold:?}: {worst:e}");
    }
}

#[test]
fn twenty_storeys_are_found_from_ground_and_forces() {
    let mut scenario = Scenario { duration: 6.0, input: InputKind::GroundAcceleration, ..one_filter(FilterKind::EKF) };
    scenario.set_plant(PlantKind::SHEAR_20);
    scenario.set_sensors(
        &Quantity::all().iter().copied().filter(|of| of.aspect().info().keys[0] == "drift").collect::<Vec<_>>()[..20],
    );
    scenario.sensors.iter_mut().for_each(|sensor| sensor.noise_std = 1e-3);
    scenario.force = Force::WhiteNoise { std: 3.0 };
    scenario.forces = [0, 4, 17].map(|mass| (on(mass), Force::WhiteNoise { std: 20.0 })).into();
    let filter = &mut scenario.filters[0];
    (filter.fading, filter.sensor_std) = (1.0, vec![1e-3; 20]);
    let run = finished_on(&scenario, simulated(&scenario));
    let estimates = &run.estimates()[0];
    assert_eq!(estimates.stop(), None);
    for mass in 0..20 {
        let channel = Channel::stiffness(mass);
        let (place, last) = (estimates.place(channel).unwrap(), estimates.len() - 1);
        let error = estimates.mean(last)[place] - truth(run.record(), channel)[last];
        let std = estimates.std(last, place);
        assert!(error.abs() < 4.0 * std && std < 10.0, "{}: {error} ± {std}", channel.key());
    }
}

#[test]
fn forces_are_columns_of_a_file_and_what_cannot_take_them_says_so() {
    let mut scenario = chain(FilterKind::EKF, Hold::First);
    scenario.forces = [(on(1), Force::default())].into();
    let record = simulated(&scenario);
    let mut file = Vec::new();
    record.write_csv(&mut file).unwrap();
    let table = read(&file, None).unwrap();
    let (mapping, kind) = Mapping::guess(&table);
    assert_eq!(mapping.forces[&on(1)].column, "force_on_2");
    let built = build(&table, &mapping, kind, Hold::First, record.true_channels().as_slice()).unwrap().record;
    assert_eq!((built.force_on(on(1)), built.input()), (record.force_on(on(1)), record.input()));
    let again = Scenario::from_toml(&scenario.to_toml().unwrap()).unwrap();
    assert_eq!(again.forces, scenario.forces);

    let refused = |scenario: &Scenario| Run::new(scenario).err().map(|error| error.to_string());
    scenario.forces = [(on(3), Force::default())].into();
    assert_eq!(
        refused(&scenario).unwrap(),
        "`forces.force_on_4` is set, but must be on one of the 3 mass(es) of the plant"
    );
    scenario.forces = [(on(0), Force::WhiteNoise { std: -1.0 })].into();
    assert!(refused(&scenario).unwrap().starts_with("`forces.force_on_1.white_noise.std` is -1"));
    scenario.forces = [(on(0), Force::default())].into();
    let one = OnlineFilter::new(&scenario, 0).err().unwrap().to_string();
    assert_eq!(one, "readings that come one by one have one input: there can be no force on mass 1 besides it");
    let mut small = one_filter(FilterKind::EKF);
    small.set_sensors(&[Quantity::DISPLACEMENT]);
    let missing = Run::on_record(&small, std::sync::Arc::new(record)).err().unwrap().to_string();
    assert_eq!(missing, "the record has a force on mass 2, but the plant has no such mass");
}
