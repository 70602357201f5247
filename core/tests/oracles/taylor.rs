//! Nonlinear truths by Taylor series, a method of any order that stops at every kink.

use kalmanscope_core::scenario::Motion;
use kalmanscope_core::signal::{Ramp, Sine};
use kalmanscope_core::simulate;
use kalmanscope_core::{Channel, Force, PlantKind, Record, Run, Scenario, Signal};

const TERMS: usize = 26;
type Series = [f64; TERMS];

/// Displacement, velocity and hysteretic displacement of
/// `ẍ + 2ζωₙẋ + ωₙ²(α x + (1 - α) z) + μ x³ = f,  ż = ẋ - β |ẋ| |z| z - γ ẋ z²`
/// and the present parameters.
#[derive(Clone, Copy)]
struct Oscillator {
    x: f64,
    v: f64,
    z: f64,
    wn: f64,
    zeta: f64,
    mu: f64,
    alpha: f64,
    beta: f64,
    gamma: f64,
}

fn product(a: &Series, b: &Series, n: usize) -> f64 {
    (0..=n).map(|k| a[k] * b[n - k]).sum()
}

fn at(series: &Series, t: f64) -> f64 {
    series.iter().rev().fold(0.0, |sum, c| sum * t + c)
}

fn sign(series: &[f64]) -> f64 {
    series.iter().find(|c| **c != 0.0).map_or(1.0, |c| c.signum())
}

impl Oscillator {
    fn series(&self, force: f64) -> [Series; 3] {
        let Self { wn, zeta, mu, alpha, beta, gamma, .. } = *self;
        let (mut x, mut v, mut z) = ([0.0; TERMS], [0.0; TERMS], [0.0; TERMS]);
        let (mut x_square, mut z_square) = ([0.0; TERMS], [0.0; TERMS]);
        (x[0], v[0], z[0]) = (self.x, self.v, self.z);
        let mut side = 1.0;
        for n in 0..TERMS - 1 {
            x_square[n] = product(&x, &x, n);
            z_square[n] = product(&z, &z, n);
            let spring = wn * wn * (alpha * x[n] + (1.0 - alpha) * z[n]) + mu * product(&x_square, &x, n);
            let push = if n == 0 { force } else { 0.0 };
            let by = 1.0 / (n + 1) as f64;
            x[n + 1] = v[n] * by;
            v[n + 1] = (push - 2.0 * zeta * wn * v[n] - spring) * by;
            if n == 0 {
                // Where z = 0 it begins to move like x, and where v = 0 like the acceleration.
                side = sign(&v[..2]) * if self.z == 0.0 { sign(&v[..2]) } else { self.z.signum() };
            }
            // β |v| |z| z + γ v z² = (β sign(v z) + γ) v z², a polynomial between kinks.
            z[n + 1] = (v[n] - (beta * side + gamma) * product(&z_square, &v, n)) * by;
        }
        [x, v, z]
    }

    fn advance(&mut self, force: f64, dt: f64) {
        let mut left = dt;
        while left > 0.0 {
            let [x, v, z] = self.series(force);
            let mut step = left.min(2.5e-3);
            let mut kink = None;
            if self.beta != 0.0 {
                for (which, series) in [(0, &v), (1, &z)] {
                    let before = sign(series);
                    if at(series, step) * before < 0.0 {
                        let (mut low, mut high) = (0.0, step);
                        for _ in 0..80 {
                            let middle = 0.5 * (low + high);
                            if at(series, middle) * before > 0.0 { low = middle } else { high = middle }
                        }
                        (step, kink) = (high, Some(which));
                    }
                }
            }
            (self.x, self.v, self.z) = (at(&x, step), at(&v, step), at(&z, step));
            match kink {
                Some(0) => self.v = 0.0,
                Some(_) => self.z = 0.0,
                None => {}
            }
            left -= step;
        }
    }
}

fn simulated(scenario: &Scenario) -> Record {
    let record = simulate(scenario);
    assert_eq!(record.len(), scenario.samples());
    record
}

/// The largest deviation of the record's truth from Taylor's, relative to the largest value of each channel.
fn deviation(record: &Record) -> f64 {
    let truth = |channel: Channel, otherwise: f64| {
        record.truth(channel).map_or_else(|| vec![otherwise; record.len()], <[f64]>::to_vec)
    };
    let [x, v, z] = [Channel::DISPLACEMENT, Channel::VELOCITY, Channel::HYSTERETIC_DISPLACEMENT].map(|c| truth(c, 0.0));
    let [wn, zeta, mu] =
        [Channel::NATURAL_FREQUENCY, Channel::DAMPING_RATIO, Channel::CUBIC_STIFFNESS].map(|c| truth(c, 0.0));
    let alpha = truth(Channel::POST_YIELD_RATIO, 1.0);
    let [beta, gamma] = [Channel::HYSTERESIS_BETA, Channel::HYSTERESIS_GAMMA].map(|c| truth(c, 0.0));
    let largest = |values: &[f64]| values.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let scale = [&x, &v, &z].map(|values| largest(values).max(f64::MIN_POSITIVE));
    assert!(scale[0] > 0.005, "it moves");

    let mut state =
        Oscillator { x: x[0], v: v[0], z: z[0], wn: 0.0, zeta: 0.0, mu: 0.0, alpha: 0.0, beta: 0.0, gamma: 0.0 };
    let mut worst = 0.0_f64;
    for k in 0..record.len() - 1 {
        (state.wn, state.zeta, state.mu) = (wn[k], zeta[k], mu[k]);
        (state.alpha, state.beta, state.gamma) = (alpha[k], beta[k], gamma[k]);
        state.advance(record.force(k), record.dt());
        let found = [x[k + 1], v[k + 1], z[k + 1]];
        let expected = [state.x, state.v, if beta[k] == 0.0 { 0.0 } else { state.z }];
        for i in 0..3 {
            worst = worst.max((found[i] - expected[i]).abs() / scale[i]);
        }
    }
    worst
}

fn shaken(kind: PlantKind, dt: f64) -> Scenario {
    let mut scenario = Scenario { dt, duration: 20.0, ..Scenario::default() };
    scenario.set_plant(kind);
    scenario.plant.set(Channel::NATURAL_FREQUENCY, Signal::Constant(6.0));
    scenario
}

#[test]
fn the_truth_of_nonlinear_plants_is_their_taylor_series() {
    for kind in [PlantKind::DUFFING, PlantKind::BOUC_WEN] {
        for dt in [0.002, 0.01, 0.05, 0.1] {
            for std in [1.0, 10.0, 60.0] {
                let mut scenario = Scenario { force: Force::WhiteNoise { std }, ..shaken(kind, dt) };
                if std > 50.0 {
                    // Such a strong force makes the cubic spring chaotic: rounding grows a millionfold in 20 s.
                    scenario.duration = 4.0;
                }
                let deviation = deviation(&simulated(&scenario));
                println!("{kind:?}, dt {dt}, force {std}: {deviation:.1e}");
                assert!(deviation < 1e-9, "{kind:?}, dt {dt}, force {std}: {deviation}");
            }
        }
    }
}

#[test]
fn nonlinear_plants_may_change() {
    for kind in [PlantKind::DUFFING, PlantKind::BOUC_WEN] {
        let mut scenario = shaken(kind, 0.01);
        scenario.plant.set(Channel::NATURAL_FREQUENCY, Signal::Sine(Sine { mean: 6.0, amplitude: 2.0, period: 7.0 }));
        scenario.plant.set(Channel::DAMPING_RATIO, Signal::Ramp(Ramp { from: 0.02, to: 0.3, start: 3.0, end: 15.0 }));
        scenario
            .plant
            .set(Channel::CUBIC_STIFFNESS, Signal::Ramp(Ramp { from: 800.0, to: -50.0, start: 3.0, end: 15.0 }));
        scenario.plant.set(Channel::HYSTERESIS_BETA, Signal::Sine(Sine { mean: 80.0, amplitude: 60.0, period: 5.0 }));
        let deviation = deviation(&simulated(&scenario));
        assert!(deviation < 1e-9, "{kind:?}: {deviation}");
    }
}

#[test]
fn free_vibration_without_damping_keeps_its_energy() {
    for (wn, mu) in [(6.0, 0.0), (6.0, 300.0), (2.0, 5000.0), (6.0, -100.0)] {
        let mut scenario = Scenario { force: Force::None, duration: 60.0, ..shaken(PlantKind::DUFFING, 0.01) };
        scenario.plant.set(Channel::NATURAL_FREQUENCY, Signal::Constant(wn));
        scenario.plant.set(Channel::DAMPING_RATIO, Signal::Constant(0.0));
        scenario.plant.set(Channel::CUBIC_STIFFNESS, Signal::Constant(mu));
        scenario.plant.initial = Motion { displacement: 0.4, velocity: 0.3 };
        let record = simulated(&scenario);
        let energy = |k: usize| {
            let [x, v] = [Channel::DISPLACEMENT, Channel::VELOCITY].map(|c| record.truth(c).unwrap()[k]);
            0.5 * v * v + 0.5 * wn * wn * x * x + 0.25 * mu * x.powi(4)
        };
        let worst = (0..record.len()).map(|k| (energy(k) / energy(0) - 1.0).abs()).fold(0.0, f64::max);
        println!("ωₙ {wn}, μ {mu}: {worst:.1e}");
        assert!(worst < 1e-9, "ωₙ {wn}, μ {mu}: {worst}");
    }
}

/// Beyond `|x| = ωₙ/√-μ` a softening spring pushes outwards.
#[test]
fn a_plant_that_runs_away_ends_its_record() {
    for dt in [0.001, 0.01, 0.1, 0.5] {
        let mut scenario = Scenario { dt, ..shaken(PlantKind::DUFFING, 0.01) };
        scenario.plant.set(Channel::CUBIC_STIFFNESS, Signal::Constant(-300.0));
        scenario.plant.initial.displacement = 0.36;
        scenario.add_sensor(kalmanscope_core::Sensor::new(kalmanscope_core::Quantity::ACCELERATION, 0.5));
        let mut run = Run::new(&scenario).unwrap();
        while run.step() {}
        let stop = run.truth_stop().unwrap().sample;
        assert!(0 < stop && stop < scenario.samples() && !run.step());
        assert_eq!((stop, stop, stop), (run.len(), run.samples(), run.record().len()));
        for k in 0..stop {
            let truth = run.record().sensors().iter().enumerate().map(|(i, _)| run.record().measured(i)[k]);
            assert!(
                truth
                    .chain([Channel::DISPLACEMENT, Channel::VELOCITY].map(|c| run.record().truth(c).unwrap()[k]))
                    .all(f64::is_finite),
                "at {k} of {stop}, dt {dt}"
            );
        }
        for estimates in run.estimates() {
            assert_eq!(estimates.len(), estimates.stop().map_or(stop, |stop| stop.sample), "{}", estimates.name());
        }
    }
}
