//! The truth of shear chains against matrix exponentials, and that of others against Taylor series that stop at every kink.

use kalmanscope_core::signal::{Ramp, Sine, Step};
use kalmanscope_core::{Channel, Force, PlantKind, Record, Scenario, Signal};

use super::plants::{Plant, with_jacobian};
use super::textbook::held;
use crate::numbers::largest;
use crate::run::{simulated, truth};

const CHAINS: [(PlantKind, usize); 3] = [(PlantKind::SHEAR_2, 2), (PlantKind::SHEAR_3, 3), (PlantKind::SHEAR_4, 4)];

fn chain(kind: PlantKind) -> Scenario {
    let mut scenario = Scenario { duration: 20.0, ..Scenario::default() };
    scenario.set_plant(kind);
    scenario
}

fn state_at(record: &Record, kind: &PlantKind, k: usize) -> Vec<f64> {
    kind.channels().iter().map(|&c| truth(record, c)[k]).collect()
}

#[test]
fn unequal_and_changing_storeys_are_matrix_exponentials() {
    for (kind, masses) in CHAINS {
        let mut scenario = Scenario { dt: 0.02, duration: 10.0, ..chain(kind.clone()) };
        scenario.plant.set(Channel::stiffness(1), Signal::Step(Step { from: 180.0, to: 90.0, at: 4.0 }));
        let record = simulated(&scenario);
        let plant = Plant { kind: kind.clone(), eta: 0.0, log: false };
        let mut state = state_at(&record, &kind, 0);
        for k in 0..record.len() - 1 {
            let parameters = state_at(&record, &kind, k);
            state[2 * masses..].copy_from_slice(&parameters[2 * masses..]);
            let (rate, a) = with_jacobian(|y| plant.rate(y, record.force(k)), &state);
            let moving = 2 * masses;
            let a = a.view((0, 0), (moving, moving)).into_owned();
            let (_, shift) = held(&a, &rate.as_slice()[..moving], record.dt());
            state.iter_mut().zip(&shift).for_each(|(x, shift)| *x += shift);
            for (i, &channel) in kind.channels()[..moving].iter().enumerate() {
                let error = (state[i] - truth(&record, channel)[k + 1]).abs() / largest(truth(&record, channel));
                assert!(error < 1e-10, "{kind:?}, {channel:?} at {k}: {error}");
            }
        }
    }
}

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

/// The largest difference of a motion from its series, relative to its size; `disturbance` pushes besides the force.
pub(crate) fn deviation(record: &Record, disturbance: &[f64]) -> f64 {
    let or = |otherwise: f64| {
        move |channel: Channel| record.truth(channel).map_or_else(|| vec![otherwise; record.len()], <[f64]>::to_vec)
    };
    let [x, v, z] = [Channel::DISPLACEMENT, Channel::VELOCITY, Channel::HYSTERETIC_DISPLACEMENT].map(or(0.0));
    let [wn, zeta, mu] = [Channel::NATURAL_FREQUENCY, Channel::DAMPING_RATIO, Channel::CUBIC_STIFFNESS].map(or(0.0));
    let alpha = or(1.0)(Channel::POST_YIELD_RATIO);
    let [beta, gamma] = [Channel::HYSTERESIS_BETA, Channel::HYSTERESIS_GAMMA].map(or(0.0));
    let scale = [&x, &v, &z].map(|values| largest(values).max(f64::MIN_POSITIVE));
    assert!(scale[0] > 0.005, "it moves");

    let mut state =
        Oscillator { x: x[0], v: v[0], z: z[0], wn: 0.0, zeta: 0.0, mu: 0.0, alpha: 0.0, beta: 0.0, gamma: 0.0 };
    let mut worst = 0.0_f64;
    for k in 0..record.len() - 1 {
        (state.wn, state.zeta, state.mu) = (wn[k], zeta[k], mu[k]);
        (state.alpha, state.beta, state.gamma) = (alpha[k], beta[k], gamma[k]);
        state.advance(record.force(k) + disturbance.get(k).unwrap_or(&0.0), record.dt());
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
                let mut scenario = Scenario { force: Force::WhiteNoise { std }, ..shaken(kind.clone(), dt) };
                if std > 50.0 {
                    // Such a strong force makes the cubic spring chaotic: rounding grows a millionfold in 20 s.
                    scenario.duration = 4.0;
                }
                let deviation = deviation(&simulated(&scenario), &[]);
                assert!(deviation < 1e-9, "{kind:?}, dt {dt}, force {std}: {deviation}");
            }
        }
    }
}

#[test]
fn parameters_may_change() {
    use PlantKind as Plant;
    for (kind, dt) in [(Plant::SDOF, 0.01), (Plant::SDOF, 0.1), (Plant::DUFFING, 0.01), (Plant::BOUC_WEN, 0.01)] {
        let mut scenario = shaken(kind.clone(), dt);
        scenario.plant.set(Channel::NATURAL_FREQUENCY, Signal::Sine(Sine { mean: 6.0, amplitude: 2.0, period: 7.0 }));
        scenario.plant.set(Channel::DAMPING_RATIO, Signal::Ramp(Ramp { from: 0.02, to: 0.3, start: 3.0, end: 15.0 }));
        let softening = Ramp { from: 800.0, to: -50.0, start: 3.0, end: 15.0 };
        scenario.plant.set(Channel::CUBIC_STIFFNESS, Signal::Ramp(softening));
        scenario.plant.set(Channel::HYSTERESIS_BETA, Signal::Sine(Sine { mean: 80.0, amplitude: 60.0, period: 5.0 }));
        let deviation = deviation(&simulated(&scenario), &[]);
        assert!(deviation < 1e-9, "{kind:?}: {deviation}");
    }
}
