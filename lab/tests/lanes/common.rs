//! Random ensembles of filters that the engine serves, from seeds; lanes held to the same filters over plain numbers, and alone.

use kalmanscope_core::channel::augment;
use kalmanscope_core::filter::{Adaptation, Robust};
use kalmanscope_core::internals::engine::{self, Baseline, Setup};
use kalmanscope_core::score::Outcome;
use kalmanscope_core::{
    Channel, FilterKind, FilterSettings, Hold, InputKind, PlantKind, Propagation, Quantity, Record, Scenario, Signal,
};
use kalmanscope_lanes::{InstructionSet, LaneRun, outcomes};

pub(crate) struct Draw(pub(crate) u64);

impl Draw {
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * ((self.0 >> 11) as f64 / (1_u64 << 53) as f64)
    }

    pub(crate) fn below(&mut self, limit: usize) -> usize {
        self.between(0.0, limit as f64) as usize
    }

    pub(crate) fn once_in(&mut self, times: usize) -> bool {
        self.below(times) == 0
    }

    pub(crate) fn one<T: Clone>(&mut self, of: &[T]) -> T {
        of[self.below(of.len())].clone()
    }
}

pub(crate) const PLANTS: [PlantKind; 9] = [
    PlantKind::SDOF,
    PlantKind::DUFFING,
    PlantKind::BOUC_WEN,
    PlantKind::BOUC_WEN_1,
    PlantKind::SHEAR_2,
    PlantKind::SHEAR_3,
    PlantKind::SHEAR_4,
    PlantKind::SHEAR_5,
    PlantKind::SHEAR_8,
];

pub(crate) fn truth(plant: PlantKind, quantities: &[Quantity], augment: &[Channel], hold: Hold) -> Scenario {
    let mut scenario = Scenario { filters: vec![FilterSettings::default()], hold, ..Scenario::default() };
    scenario.filters[0].augment = augment.to_vec();
    scenario.set_plant(plant);
    scenario.set_sensors(quantities);
    for (nth, &channel) in augment.iter().enumerate().filter(|(_, channel)| **channel != Channel::WHITE_FORCE) {
        let usual = channel.usual();
        scenario.plant.set(channel, Signal::Constant(usual.mean + 0.3 * usual.std * (nth as f64 - 1.0)));
    }
    scenario
}

pub(crate) fn ensemble(seed: u64) -> Scenario {
    let mut draw = Draw(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15));
    draw.below(2);
    let (plant, hold) = (draw.one(&PLANTS), draw.one(&[Hold::Zero, Hold::First]));
    let mut quantities: Vec<Quantity> = plant.quantities().collect();
    while quantities.len() > 4 || (!quantities.is_empty() && draw.once_in(3)) {
        quantities.remove(draw.below(quantities.len()));
    }
    let room = 32 - plant.channels().len();
    let mut augment: Vec<Channel> = augment::of_all(quantities.iter().copied()).collect();
    while augment.len() > room || (!augment.is_empty() && draw.once_in(2)) {
        augment.remove(draw.below(augment.len()));
    }
    let mut scenario = truth(plant.clone(), &quantities, &augment, hold);
    scenario.seed = seed;
    scenario.input = draw.one(&[InputKind::Force, InputKind::GroundAcceleration]);
    scenario.dt = 10_f64.powf(draw.between(-2.5, -1.3));
    scenario.duration = scenario.dt * draw.between(20.0, 90.0).floor();
    let good = scenario.filters.remove(0);
    use FilterKind as Kind;
    let kind = draw.one(&[Kind::KF, Kind::EKF, Kind::EKF, Kind::UKF, Kind::UKF, Kind::CKF]);
    for _ in 0..1 + draw.below(12) {
        let filter = FilterSettings { kind, ..good.clone() };
        scenario.filters.push(changed(filter, &plant, &augment, &mut draw));
    }
    let substeps = 1 + draw.below(3);
    let propagation = draw.one(&[None, Some(Propagation::RungeKutta), Some(Propagation::LocalLinearisation)]);
    let (robust, adapts, logs) =
        (draw.one(&[[Robust::NONE; 3].as_slice(), &Robust::ALL].concat()), draw.one(&ADAPTS), draw.once_in(4));
    let training = draw.one(&[0.0, 0.2]);
    for filter in &mut scenario.filters {
        filter.robust = robust;
        let (sensor_noise, process_noise) = (adapts[0] && !robust.is_on(), adapts[1]);
        filter.adaptation = Adaptation { sensor_noise, process_noise, training, forgetting: 0.9 };
        filter.log_parameters = logs;
        (filter.substeps, filter.propagation) = (substeps, propagation);
    }
    if logs {
        // A logarithm has a sign.
        let is_negative = |filter: &FilterSettings| {
            plant.channels().iter().any(|&c| c.is_parameter() && filter.initial_mean[c] <= 0.0)
        };
        scenario.filters.retain(|filter| !is_negative(filter));
    }
    scenario
}

const ADAPTS: [[bool; 2]; 5] = [[false; 2], [false; 2], [true, false], [false, true], [true; 2]];
fn changed(mut filter: FilterSettings, plant: &PlantKind, augment: &[Channel], draw: &mut Draw) -> FilterSettings {
    filter.fading = draw.one(&[1.0, 1.002, 1.05]);
    filter.input_delay = draw.below(6) as i32 - 2;
    if draw.once_in(6) {
        // In seconds: whole steps and parts of them, at some dt.
        filter.sensor_delay = filter.sensor_std.iter().map(|_| draw.one(&[0.0, 0.01, 0.0337, -0.02])).collect();
    }
    filter.sensor_std.iter_mut().for_each(|std| *std *= 10_f64.powf(draw.between(-0.5, 0.5)));
    for &channel in plant.channels().iter().chain(augment) {
        filter.initial_mean[channel] *= draw.between(0.7, 1.4);
        filter.initial_std[channel] *= if draw.once_in(9) { 0.0 } else { draw.between(0.3, 2.0) };
        filter.process_std[channel] *= if draw.once_in(9) { 0.0 } else { draw.between(0.1, 3.0) };
    }
    if draw.once_in(8) {
        let fast = [Channel::NATURAL_FREQUENCY, Channel::stiffness(0)];
        let factor = draw.one(&[-1.0, 10.0, 300.0]);
        let known = fast.into_iter().filter(|channel| plant.channels().contains(channel));
        known.for_each(|channel| filter.initial_mean[channel] *= factor);
    }
    if draw.once_in(12) {
        // Their squares are zero.
        filter.sensor_std.fill(1e-170);
    }
    filter
}

pub(crate) fn runs_of<'a>(scenario: &'a Scenario, record: &'a Record) -> Vec<LaneRun<'a>> {
    (0..scenario.filters.len()).map(|place| LaneRun { scenario, place, record }).collect()
}

pub(crate) fn check(runs: &[LaneRun<'_>], what: &str) -> Vec<Outcome> {
    let last = runs[0].record.len() - 1;
    let samples = [0, 0, 1, 2, last / 3, last / 2, last, last, last + 3];
    let single = |run: &LaneRun<'_>| {
        let setup = Setup::new(run.scenario, run.place, run.record).unwrap().unwrap();
        let run = engine::SetupRun { setup: &setup, record: run.record };
        engine::outcomes::<f64, _>(Baseline, &[run], &samples).remove(0)
    };
    let singles: Vec<Outcome> = runs.iter().map(single).collect();
    for level in InstructionSet::available() {
        let lanes = outcomes(level, runs, &samples).unwrap();
        assert_eq!(lanes.len(), singles.len());
        for (place, (lane, single)) in lanes.iter().zip(&singles).enumerate() {
            assert_eq!(bits(lane), bits(single), "{what}, run {place} at {level:?}\n{lane:?}\n{single:?}");
        }
    }
    singles
}

/// Returns the samples that their NEES count.
pub(crate) fn check_alone(scenario: &Scenario, record: &Record, what: &str) -> Vec<u32> {
    let (runs, last) = (runs_of(scenario, record), record.len() - 1);
    let samples = [0, 1.min(last), 9.min(last), 500.min(last), last];
    let check = |(place, lane): (usize, Outcome)| {
        let alone = Outcome::at(scenario, place, record, &samples).unwrap();
        assert_eq!(bits(&lane), bits(&alone), "{what}, filter {place}\n{lane:?}\n{alone:?}");
        alone.nees.samples
    };
    outcomes(InstructionSet::best(), &runs, &samples).unwrap().into_iter().enumerate().map(check).collect()
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
