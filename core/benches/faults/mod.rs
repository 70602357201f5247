//! Situations with one fault or two, of the truth, of the record or of the filter, drawn at random.

#[path = "../drawn/mod.rs"]
mod drawn;
mod fault;
mod plants;
mod record;

use std::sync::Arc;

use kalmanscope_core::signal::{Ramp, Sine as Wave, Step as Jump};
use kalmanscope_core::{
    Channel, FilterKind, FilterSettings, Force, PlantKind, Quantity, Record, Run, RunError, Scenario, Sensor, Signal,
};

pub(crate) use drawn::without_truth;
pub(crate) use fault::{FOR_LIMITS, FRESH, Fault, UNTOUCHED};

use drawn::Draw;

/// A record and a filter that would be well tuned without the faults.
pub(crate) struct Situation {
    /// The filter's scenario.
    pub(crate) told: Scenario,
    /// The record with the truth.
    pub(crate) record: Arc<Record>,
}

/// The oscillator of a situation.
struct Base {
    wn: f64,
    zeta: f64,
    /// Root mean square of the displacement \[m\], about.
    size: f64,
}

impl Situation {
    /// The situation of a seed with some faults.
    ///
    /// # Errors
    /// [`RunError`] where the scenario is impossible.
    pub(crate) fn new(faults: &[Fault], seed: u64) -> Result<Self, RunError> {
        Self::drawn(faults, seed, faults)
    }

    /// The same oscillator, force and noise without the faults: what a perfect remedy can reach.
    ///
    /// # Errors
    /// [`RunError`] where the scenario is impossible.
    pub(crate) fn without_faults(faults: &[Fault], seed: u64) -> Result<Self, RunError> {
        Self::drawn(faults, seed, &[])
    }

    /// The situation that is drawn for some faults, with those that act.
    fn drawn(faults: &[Fault], seed: u64, acting: &[Fault]) -> Result<Self, RunError> {
        let mut draw = Draw::new(seed, 0xfa17);
        let own_plant = faults.iter().any(|fault| matches!(fault, Fault::Friction | Fault::Drag));
        // Friction and drag have sizes that go with these.
        let wn = if own_plant { draw.uniform(5.0, 7.0) } else { draw.log_uniform(1.5, 60.0) };
        let zeta = draw.log_uniform(0.01, 0.08);
        let dt = draw.log_uniform(0.04, 0.12) / wn;
        let samples = draw.log_uniform(1500.0, 4000.0);
        let duration = samples.round() * dt;
        let strength = if own_plant { 10.0 } else { draw.log_uniform(1.0, 20.0) };
        let force = match draw.unit() {
            u if u < 0.5 || own_plant => Force::WhiteNoise { std: strength },
            u if u < 0.8 => {
                Force::Chirp { amplitude: 0.5 * strength, from: 0.3 * wn, to: 3.0 * wn, sweep: 0.3 * duration }
            }
            _ => Force::ImpulseTrain { impulse: strength * 0.6 / wn, period: draw.uniform(6.0, 15.0) / wn },
        };
        let power = drawn::power(&force, wn, dt);
        let base = Base { wn, zeta, size: (power / (4.0 * zeta * wn)).sqrt() / wn };
        let mut truth = Scenario { seed, dt, duration, force, filters: Vec::new(), ..Scenario::default() };
        truth.plant.kind = PlantKind::SDOF;
        truth.plant.set(Channel::NATURAL_FREQUENCY, wn);
        truth.plant.set(Channel::DAMPING_RATIO, zeta);
        let (x, v, a) = ((Quantity::DISPLACEMENT, 0), (Quantity::VELOCITY, 1), (Quantity::ACCELERATION, 2));
        let several = faults.contains(&Fault::Scale) || faults.contains(&Fault::Bias);
        let sets: &[&[(Quantity, i32)]] = &[&[x, v], &[x, a], &[x, v, a], &[x], &[v], &[a]];
        let set = draw.choice(if several { &sets[..3] } else { sets });
        let relative = draw.log_uniform(0.02, 0.1);
        let noise = |(measures, rate): (Quantity, i32)| Sensor::new(measures, relative * base.size * wn.powi(rate));
        truth.sensors = set.iter().map(|&one| noise(one)).collect();
        truth.plant.disturbance_std = draw.log_uniform(0.05, 0.2) * (power / dt).sqrt();
        let mut filter = Self::well_tuned(&truth, &mut draw, &base);
        acting.iter().for_each(|&fault| disturb(fault, &mut truth, &mut filter, &mut draw, &base));
        let mut told = truth.clone();
        told.set_plant(PlantKind::SDOF);
        told.filters = vec![filter];
        let mut run = Run::new(&truth)?;
        run.finish();
        let mut record = run.record().clone();
        for &fault in acting {
            record = record::disturbed(fault, &record, &truth, &mut draw);
        }
        Ok(Self { told, record: Arc::new(record) })
    }

    /// A filter that knows all that can be known, and begins with a guess as good as it says.
    fn well_tuned(truth: &Scenario, draw: &mut Draw, base: &Base) -> FilterSettings {
        let Base { wn, zeta, size } = *base;
        let kind = draw.choice(&[FilterKind::EKF, FilterKind::UKF]);
        let mut filter = FilterSettings { kind, name: kind.name().to_owned(), id: 1, ..FilterSettings::default() };
        (filter.sensor_std, filter.process_std) = truth.true_noise();
        let beliefs = [
            (Channel::DISPLACEMENT, 0.0, 0.5 * size),
            (Channel::VELOCITY, 0.0, 0.5 * size * wn),
            (Channel::NATURAL_FREQUENCY, wn, 0.1 * wn),
            (Channel::DAMPING_RATIO, zeta, 0.4 * zeta),
        ];
        draw.guess(&mut filter, &beliefs);
        filter
    }
}

/// Gives the truth or the filter a fault.
fn disturb(fault: Fault, truth: &mut Scenario, filter: &mut FilterSettings, draw: &mut Draw, base: &Base) {
    let &Base { wn, size, .. } = base;
    let duration = truth.duration;
    let spring = size * wn * wn;
    match fault {
        Fault::Gain => {
            let gain = if draw.sign() > 0.0 { draw.uniform(0.55, 0.85) } else { draw.uniform(1.2, 1.7) };
            truth.plant.set(Channel::INPUT_GAIN, gain);
        }
        Fault::Offset => {
            let offset = draw.sign() * draw.log_uniform(0.5, 2.0) * spring;
            truth.plant.set(Channel::INPUT_OFFSET, offset);
        }
        Fault::Delay => truth.plant.input_delay = draw.choice(&[-3, -2, -1, 1, 2, 3]),
        Fault::Bias => {
            let sensor = draw.choice(&truth.sensors);
            let bias = draw.sign() * draw.log_uniform(1.5, 6.0) * sensor.noise_std;
            truth.plant.set(sensor.measures.bias(), bias);
        }
        Fault::SmallR => filter.sensor_std.iter_mut().for_each(|std| *std /= 5.0_f64.sqrt()),
        Fault::LargeR => filter.sensor_std.iter_mut().for_each(|std| *std *= 6.0_f64.sqrt()),
        Fault::SmallQ => {
            for channel in [Channel::DISPLACEMENT, Channel::VELOCITY] {
                filter.process_std[channel] *= 0.1;
            }
        }
        Fault::Step => {
            let (to, at) = (wn * draw.uniform(0.75, 0.92), duration * draw.uniform(0.5, 0.85));
            truth.plant.set(Channel::NATURAL_FREQUENCY, Signal::Step(Jump { from: wn, to, at }));
        }
        Fault::Drift => {
            let to = wn * draw.uniform(0.8, 0.93);
            let signal = Signal::Ramp(Ramp { from: wn, to, start: 0.0, end: duration });
            truth.plant.set(Channel::NATURAL_FREQUENCY, signal);
        }
        Fault::Swing => {
            let (amplitude, period) = (wn * draw.uniform(0.03, 0.08), duration * draw.uniform(0.3, 0.7));
            truth.plant.set(Channel::NATURAL_FREQUENCY, Signal::Sine(Wave { mean: wn, amplitude, period }));
        }
        Fault::Hardening => {
            truth.plant.kind = PlantKind::DUFFING;
            let cubic = draw.uniform(0.3, 1.0) * wn * wn / (3.0 * size * size);
            truth.plant.set(Channel::CUBIC_STIFFNESS, cubic);
        }
        Fault::Sine => {
            let (amplitude, frequency) = (spring * draw.log_uniform(0.2, 1.0), wn * draw.uniform(0.6, 1.4));
            let period = std::f64::consts::TAU / frequency;
            truth.plant.set(Channel::UNKNOWN_FORCE, Signal::Sine(Wave { mean: 0.0, amplitude, period }));
        }
        Fault::Friction => truth.plant.kind = draw.choice(&plants::DRY_FRICTION),
        Fault::Drag => truth.plant.kind = draw.choice(&plants::DRAG),
        _ => {}
    }
}
