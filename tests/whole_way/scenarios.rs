//! Scenarios to try: built-in ones and new ones, with hostile numbers.

use kalmanscope_core::scenario::{Between, Motion, option};
use kalmanscope_core::setting::{GUESSES, JUMP, PROCESS_SCALES, WALK};
use kalmanscope_core::signal::{Ramp, Sine, Step};
use kalmanscope_core::{
    Adaptation, Channel, FilterKind, FilterSettings, Force, Hold, InputKind, PlantKind, Propagation, Quantity, Robust,
    Scenario, Sensor, Signal,
};
use kalmanscope_lessons::BUILT_IN;

use crate::dice::{Dice, spoil};

const STEPS: [usize; 9] = [1, 2, 3, 5, 20, 60, 120, 250, 400];

pub(crate) fn text(dice: &mut Dice) -> Result<String, String> {
    let scenario = scenario(dice);
    let mut document = toml::Value::try_from(&scenario).map_err(|error| error.to_string())?;
    if !dice.one_in(8) {
        spoil(&mut document, dice);
    }
    toml::to_string(&document).map_err(|error| error.to_string())
}

/// A scenario without a measured record, of a few hundred samples.
fn scenario(dice: &mut Dice) -> Scenario {
    let mut scenario = match dice.pick(BUILT_IN).scenario() {
        Ok(scenario) if !dice.one_in(3) => scenario,
        _ => Scenario::default(),
    };
    scenario.record = None;
    if dice.one_in(2) {
        scenario.set_plant(dice.pick(&PlantKind::ALL));
    }
    for _ in 0..dice.below(6) {
        change(&mut scenario, dice);
    }
    scenario.duration = scenario.dt * dice.pick(&STEPS) as f64;
    for filter in &mut scenario.filters {
        filter.ensemble_size = filter.ensemble_size.min(50);
    }
    scenario
}

fn change(scenario: &mut Scenario, dice: &mut Dice) {
    match dice.below(12) {
        0 => Quantity::all().iter().for_each(|&quantity| scenario.remove_sensor(quantity)),
        1 => {
            let all: Vec<Quantity> = scenario.plant.kind.quantities().collect();
            for _ in 0..1 + dice.below(3) {
                scenario.add_sensor(Sensor::new(dice.pick(&all), 0.01));
            }
        }
        2 => scenario.filters.truncate(dice.below(2)),
        3 => scenario.force = Force::Sine { amplitude: 3.0, frequency: 6.0 },
        4 => scenario.hold = Hold::First,
        5 => scenario.input = InputKind::GroundAcceleration,
        6 => scenario.plant.initial = Motion { displacement: 0.1, velocity: -0.5 },
        7 => {
            let all: Vec<Channel> = Channel::all().iter().copied().filter(|channel| channel.is_parameter()).collect();
            let channel = dice.pick(&all);
            let before = scenario.plant.parameter(channel).map_or(1.0, |signal| signal.at(0.0));
            scenario.plant.set(channel, signal(before, dice));
        }
        8 => scenario.plant.input_delay = dice.pick(&[-100, -1, 1, 2, 100]),
        9 => scenario.seed = dice.pick(&[0, 2, 77, i64::MAX as u64]),
        _ => {
            let filter = filter(scenario, dice);
            scenario.filters.truncate(2);
            scenario.filters.push(filter);
            scenario.number_filters();
        }
    }
}

fn signal(before: f64, dice: &mut Dice) -> Signal {
    match dice.below(4) {
        0 => Signal::Constant(before),
        1 => Signal::Step(Step { from: before, to: 0.8 * before, at: 0.3 }),
        2 => Signal::Ramp(Ramp { from: before, to: 0.8 * before, start: 0.1, end: 0.4 }),
        _ => Signal::Sine(Sine { mean: before, amplitude: 0.2 * before, period: 1.0 }),
    }
}

fn filter(scenario: &Scenario, dice: &mut Dice) -> FilterSettings {
    let kind = dice.pick(&FilterKind::ALL);
    let augmentations: Vec<Channel> =
        Channel::all().iter().copied().filter(|channel| channel.is_augmentation()).collect();
    let mut augment: Vec<Channel> = Vec::new();
    while dice.one_in(3) {
        let channel = dice.pick(&augmentations);
        if !augment.contains(&channel) {
            augment.push(channel);
        }
    }
    let mut filter = FilterSettings {
        kind,
        name: format!("{} tried", kind.name()),
        plant: dice.one_in(4).then(|| dice.pick(&PlantKind::ALL)),
        augment,
        input_delay: if dice.one_in(4) { dice.pick(&[-100, -2, -1, 1, 3, 100]) } else { 0 },
        log_parameters: dice.one_in(4),
        propagation: [None, Some(dice.pick(&Propagation::ALL))][dice.below(2)],
        substeps: dice.below(4),
        iterations: 1 + dice.below(5),
        ensemble_size: 2 + dice.below(40),
        adaptation: Adaptation {
            sensor_noise: dice.one_in(4),
            process_noise: dice.one_in(4),
            forgetting: dice.pick(&[0.99, 0.9, 0.5]),
            training: dice.pick(&[0.0, 0.0, 1e-9, 0.3, 1e9]),
        },
        smoother: !kind.is_sampled() && dice.one_in(3),
        fading: dice.pick(&[1.0, 1.0, 1.005, 1.1, 3.0]),
        eta: dice.pick(&[0.0, 0.0, 0.01, 10.0]),
        sensor_std: scenario.sensors.iter().map(|sensor| sensor.noise_std.max(1e-9)).collect(),
        sensor_delay: if dice.one_in(5) {
            scenario.sensors.iter().map(|_| dice.pick(&[0.0, 0.01, -0.013, 0.5, 10.0])).collect()
        } else {
            Vec::new()
        },
        ..FilterSettings::default()
    };
    more(&mut filter, &scenario.plant.kind, dice);
    filter
}

/// What not every filter may have.
fn more(filter: &mut FilterSettings, truth: &PlantKind, dice: &mut Dice) {
    if filter.can(&option::WEIGHED) && dice.one_in(3) {
        filter.robust = dice.pick(&Robust::ALL);
    }
    filter.jump = dice.one_in(5) && (JUMP.serves)(filter, truth);
    if dice.one_in(5) && (WALK.serves)(filter, truth) {
        filter.walk = dice.pick(&[1e-6, 0.1, 10.0]);
    }
    if dice.one_in(5) && (GUESSES.serves)(filter, truth) {
        filter.guesses = 2 + dice.below(4);
    }
    if dice.one_in(5) && filter.can(&option::PLUCKED) {
        filter.plucks = dice.pick(&[&[0.05][..], &[-1.0, 0.2, 0.201], &[0.3, 1e9]]).to_vec();
    }
    if dice.one_in(6) && (PROCESS_SCALES.serves)(filter, truth) {
        filter.process_scales = dice.pick(&[2, 3, 9]);
    }
    filter.look_ahead = if filter.smoother { dice.pick(&[0.0, 0.0, 1e-9, 0.3, 1e6]) } else { 0.0 };
    let channels: Vec<Channel> = filter.considerable(truth).collect();
    let (considers, is_bounded) = (filter.can(&option::CONSIDERED), filter.can(&option::BOUNDED));
    for channel in channels {
        if considers && dice.one_in(6) {
            filter.consider.push(channel);
        }
        if is_bounded && dice.one_in(6) {
            let (mean, far) = (filter.initial_mean[channel], dice.pick(&[0.0, 1e-12, 0.1, 1e9]));
            let least = (!dice.one_in(3)).then_some(mean - far);
            filter.bounds.set(channel, Between { least, most: (!dice.one_in(3)).then_some(mean + 0.1 + far) });
        }
    }
}

/// The same scenario with no more work than a case may take: fewer samples, smaller ensembles, fewer repetitions.
pub(crate) fn shortened(scenario: &Scenario) -> Scenario {
    let mut scenario = scenario.clone();
    if scenario.samples() > 401 {
        scenario.duration = 400.0 * scenario.dt;
    }
    for filter in &mut scenario.filters {
        filter.ensemble_size = filter.ensemble_size.min(100);
        filter.iterations = filter.iterations.min(10);
        filter.substeps = filter.substeps.min(5);
    }
    scenario
}
