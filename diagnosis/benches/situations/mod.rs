//! Situations drawn at random: an oscillator, its force and sensors, a well-tuned filter, and faults of random sizes.

use std::sync::Arc;

use kalmanscope_core::filter::Normal;
use kalmanscope_core::signal::{Ramp, Sine, Step};
use kalmanscope_core::{
    Channel, Estimates, FilterKind, FilterSettings, Force, Hold, PlantKind, Quantity, Record, Run, RunError, Scenario,
    Sensor, Signal,
};
use kalmanscope_diagnosis::VerdictKind::{self, Diverged, Lost, Overconfident, Underconfident};

/// The first seed that no limit was set on.
pub(crate) const FIRST: u64 = 1_000_000;

pub(crate) fn seeds(number: u64) -> std::ops::Range<u64> {
    let numbers: Vec<u64> = std::env::args().skip(1).filter_map(|word| word.parse().ok()).collect();
    let first = numbers.first().copied().unwrap_or(FIRST);
    first..first + numbers.get(1).copied().unwrap_or(number)
}

pub(crate) fn is_asked_for(option: &str) -> bool {
    std::env::args().any(|word| word == option)
}

pub(crate) struct Situation {
    pub(crate) faults: Vec<Fault>,
    pub(crate) truth: Scenario,
    /// The filter's, over the truth's record.
    pub(crate) told: Scenario,
    pub(crate) note: String,
}

/// Quantities that sensors may measure together, with the power of ωₙ that makes one of a displacement; not an accelerometer alone.
const SETS: &[&[(Quantity, i32)]] = &[
    &[(Quantity::DISPLACEMENT, 0), (Quantity::VELOCITY, 1)],
    &[(Quantity::DISPLACEMENT, 0), (Quantity::ACCELERATION, 2)],
    &[(Quantity::DISPLACEMENT, 0), (Quantity::VELOCITY, 1), (Quantity::ACCELERATION, 2)],
    &[(Quantity::DISPLACEMENT, 0)],
    &[(Quantity::VELOCITY, 1)],
];

impl Situation {
    pub(crate) fn draw(seed: u64) -> Self {
        Self::with(Fault::ALL[(seed % Fault::ALL.len() as u64) as usize], seed)
    }

    pub(crate) fn with(fault: Fault, seed: u64) -> Self {
        Self::of(&[fault], seed)
    }

    pub(crate) fn of(faults: &[Fault], seed: u64) -> Self {
        let any = |of: &[Fault]| faults.iter().any(|fault| of.contains(fault));
        let mut draw = Draw::new(seed, 0x5eed);
        let wn = draw.log_uniform(2.0, 20.0);
        let zeta = draw.log_uniform(0.02, 0.1);
        let dt = draw.log_uniform(0.03, 0.12) / wn;
        let samples = draw.log_uniform(1200.0, 3500.0);
        let needs_input = any(&[Fault::InputGain, Fault::InputDelay, Fault::InputHold, Fault::InputOffset]);
        let strength = draw.log_uniform(1.0, 20.0);
        let force = match draw.unit() {
            u if u < 0.65 => Force::WhiteNoise { std: strength },
            u if u < 0.85 || needs_input => Force::Chirp {
                amplitude: 0.5 * strength,
                from: 0.3 * wn,
                to: 3.0 * wn,
                sweep: draw.uniform(0.2, 0.5) * samples * dt,
            },
            _ => Force::ImpulseTrain { impulse: strength * 0.6 / wn, period: draw.uniform(6.0, 15.0) / wn },
        };
        let of_the_spring = [Fault::HardeningSpring, Fault::YieldingSpring, Fault::MissingMode];
        let is_sampled = any(&[Fault::CollapsedSample, Fault::LargeSample]);
        let is_linear = is_sampled || any(&of_the_spring);
        let kind = if !is_linear && draw.chance(0.15) { PlantKind::DUFFING } else { PlantKind::SDOF };
        let mut truth =
            Scenario { seed, dt, duration: samples.round() * dt, force, filters: Vec::new(), ..Scenario::default() };
        truth.plant.kind = kind.clone();
        truth.plant.set(Channel::NATURAL_FREQUENCY, wn);
        truth.plant.set(Channel::DAMPING_RATIO, zeta);
        // The response of a linear oscillator to this force, as if it were white noise.
        let power = power(&force, wn, dt);
        let size = (power / (4.0 * zeta * wn)).sqrt() / wn;
        truth.plant.set(Channel::CUBIC_STIFFNESS, draw.uniform(0.1, 0.6) * wn * wn / (9.0 * size * size));
        let relative = draw.log_uniform(0.02, 0.15);
        let needs_two = [Fault::SensorNoiseContrary, Fault::SensorBias, Fault::InputOffset];
        let set = draw.choice(if any(&[Fault::FeltDisturbance]) {
            &SETS[1..3]
        } else if any(&needs_two) {
            &SETS[..3]
        } else {
            SETS
        });
        let noise = |draw: &mut Draw, rate: i32| relative * draw.log_uniform(0.7, 1.4) * size * wn.powi(rate);
        truth.sensors = set.iter().map(|&(measures, rate)| Sensor::new(measures, noise(&mut draw, rate))).collect();
        let of_the_motion = [
            Fault::ProcessNoiseTooSmall,
            Fault::ProcessNoiseTooLarge,
            Fault::ProcessNoiseTenth,
            Fault::ProcessNoiseTenfold,
            Fault::FeltDisturbance,
        ];
        let is_free = any(&[Fault::NoExcitation, Fault::WindUp]);
        let disturbed = any(&of_the_motion) || !is_free && draw.chance(0.5);
        let share = draw.log_uniform(0.1, 0.4);
        if disturbed {
            truth.plant.disturbance_std = share * (power / dt).sqrt();
        }
        let mut note = String::new();
        for &fault in faults {
            disturb(fault, &mut truth, &mut draw, wn, size, power, &mut note);
        }

        let mut told = truth.clone();
        told.hold = Hold::Zero;
        told.plant.kind = kind;
        let filter_kind = if is_sampled { FilterKind::PF } else { draw.choice(&[FilterKind::EKF, FilterKind::UKF]) };
        told.filters = vec![Self::well_tuned(&truth, filter_kind, &mut draw, wn, zeta, size)];
        for &fault in faults {
            Self::disturb_filter(fault, &mut told, &mut draw, &mut note);
        }
        Self { faults: faults.to_vec(), truth, told, note }
    }

    fn well_tuned(
        truth: &Scenario,
        kind: FilterKind,
        draw: &mut Draw,
        wn: f64,
        zeta: f64,
        size: f64,
    ) -> FilterSettings {
        let mut filter =
            FilterSettings { kind, fading: 1.0, name: kind.name().to_owned(), id: 1, ..FilterSettings::default() };
        let (sensor_std, process_std) = truth.true_noise();
        (filter.sensor_std, filter.process_std) = (sensor_std, process_std);
        let cubic = truth.plant.parameter(Channel::CUBIC_STIFFNESS).map_or(0.0, |signal| signal.at(0.0));
        let beliefs = [
            (Channel::DISPLACEMENT, 0.0, 0.5 * size),
            (Channel::VELOCITY, 0.0, 0.5 * size * wn),
            (Channel::NATURAL_FREQUENCY, wn, 0.12 * wn),
            (Channel::DAMPING_RATIO, zeta, 0.4 * zeta),
            (Channel::CUBIC_STIFFNESS, cubic, 0.3 * cubic),
        ];
        draw.guess(&mut filter, &beliefs);
        filter
    }

    fn disturb_filter(fault: Fault, told: &mut Scenario, draw: &mut Draw, note: &mut String) {
        let own: Vec<f64> = told.sensors.iter().map(|sensor| sensor.noise_std).collect();
        let filter = &mut told.filters[0];
        let motions = [Channel::DISPLACEMENT, Channel::VELOCITY];
        let sensors = filter.sensor_std.len();
        match fault {
            Fault::SensorNoiseTooLarge | Fault::SensorNoiseTooSmall => {
                let variance = draw.log_uniform(3.0, 100.0);
                let factor = if fault == Fault::SensorNoiseTooLarge { variance.sqrt() } else { 1.0 / variance.sqrt() };
                let place = draw.choice(&(0..sensors).collect::<Vec<_>>());
                let all = draw.chance(0.4);
                for (i, std) in filter.sensor_std.iter_mut().enumerate() {
                    *std *= if all || i == place { factor } else { 1.0 };
                }
                let which = if all { "all".to_owned() } else { place.to_string() };
                *note = format!("{which} variance times {:.3}", factor * factor);
            }
            Fault::SensorNoiseContrary => {
                let (a, b) = (draw.log_uniform(3.0, 30.0), draw.log_uniform(3.0, 30.0));
                let place = draw.choice(&(0..sensors).collect::<Vec<_>>());
                filter.sensor_std[place] *= a.sqrt();
                filter.sensor_std[(place + 1) % sensors] /= b.sqrt();
                *note = format!("{place} times {a:.1}, next over {b:.1}");
            }
            Fault::ProcessNoiseTooSmall
            | Fault::ProcessNoiseTooLarge
            | Fault::ProcessNoiseTenth
            | Fault::ProcessNoiseTenfold => {
                let factor = match fault {
                    Fault::ProcessNoiseTooSmall => 0.1,
                    Fault::ProcessNoiseTooLarge => 10.0,
                    Fault::ProcessNoiseTenth => 0.1_f64.sqrt(),
                    _ => 10.0_f64.sqrt(),
                };
                for channel in motions {
                    filter.process_std[channel] *= factor;
                }
            }
            Fault::WindUp => filter.fading = draw.uniform(1.005, 1.02),
            Fault::FeltDisturbance => filter.sensor_std = own,
            Fault::CollapsedSample => filter.ensemble_size = draw.choice(&[50, 100, 200]),
            Fault::LargeSample => filter.ensemble_size = draw.choice(&[1000, 3000]),
            _ => {}
        }
    }

    pub(crate) fn record(&self) -> Result<Arc<Record>, RunError> {
        let mut run = Run::new(&self.truth)?;
        run.finish();
        Ok(Arc::new(run.record().clone()))
    }
}

pub(crate) fn largest_error(estimates: &Estimates, record: &Record) -> f64 {
    let late = estimates.len() * 4 / 5..estimates.len();
    let of = |(place, &channel): (usize, &Channel)| {
        let truth = record.truth(channel).filter(|_| channel.is_parameter())?;
        let error = |k: usize| (estimates.canonical_mean(k, place) - truth[k]) / estimates.std(k, place);
        Some((late.clone().map(|k| error(k) * error(k)).sum::<f64>() / late.len() as f64).sqrt())
    };
    estimates.channels().iter().enumerate().filter_map(of).fold(0.0, f64::max)
}

pub(crate) fn without_truth(record: &Record) -> Arc<Record> {
    Arc::new(record.clone().without_truth())
}

macro_rules! faults {
    ($($(#[$doc:meta])* $name:ident: [$($cause:literal),*],)*) => {
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        pub(crate) enum Fault {
            $($(#[$doc])* $name,)*
        }

        impl Fault {
            pub(crate) const ALL: &[Self] = &[$(Self::$name),*];

            pub(crate) fn causes(self) -> &'static [&'static str] {
                match self {
                    $(Self::$name => &[$($cause),*],)*
                }
            }
        }
    };
}
faults! {
    WellTuned: [],
    SensorNoiseTooLarge: ["sensor_noise"],
    SensorNoiseTooSmall: ["sensor_noise"],
    SensorNoiseContrary: ["sensor_noise"],
    ProcessNoiseTooSmall: ["process_noise"],
    ProcessNoiseTooLarge: ["process_noise"],
    ProcessNoiseTenth: ["process_noise"],
    ProcessNoiseTenfold: ["process_noise"],
    HardeningSpring: ["spring"],
    YieldingSpring: ["spring"],
    MissingMode: ["missing_mode"],
    WindUp: ["wind_up"],
    SuddenChange: ["sudden_change"],
    SlowDrift: ["slow_drift", "sudden_change"],
    InputGain: ["input_gain"],
    InputOffset: ["input_offset", "sensor_bias"],
    InputDelay: ["input_delay", "input_hold"],
    InputHold: ["input_hold", "input_delay"],
    SensorBias: ["sensor_bias"],
    FeltDisturbance: ["felt_disturbance"],
    NoExcitation: ["no_excitation"],
    CollapsedSample: ["collapsed_sample"],
    LargeSample: [],
    /// A slow force that nobody records; one in three is a wave.
    UnknownForce: ["unknown_force", "periodic_force"],
}

impl Fault {
    pub(crate) fn contrary(self) -> &'static [VerdictKind] {
        match self {
            Self::SensorNoiseTooLarge | Self::ProcessNoiseTooLarge | Self::ProcessNoiseTenfold => {
                &[Overconfident, Diverged, Lost]
            }
            Self::SensorNoiseTooSmall
            | Self::ProcessNoiseTooSmall
            | Self::ProcessNoiseTenth
            | Self::SuddenChange
            | Self::SlowDrift => &[Underconfident],
            _ => &[],
        }
    }
}

/// `size` is the root mean square of the displacement \[m\], `power` the density of the force \[m²/s³\].
fn disturb(fault: Fault, truth: &mut Scenario, draw: &mut Draw, wn: f64, size: f64, power: f64, note: &mut String) {
    let rms_force = (power / truth.dt).sqrt();
    match fault {
        Fault::HardeningSpring => {
            truth.plant.kind = PlantKind::DUFFING;
            let share = draw.uniform(0.3, 1.0);
            truth.plant.set(Channel::CUBIC_STIFFNESS, share * wn * wn / (3.0 * size * size));
            *note = format!("cubic part {share:.2} of the linear at 1.7 rms");
        }
        Fault::YieldingSpring => {
            truth.plant.kind = PlantKind::BOUC_WEN;
            for channel in PlantKind::BOUC_WEN.parameters() {
                truth.plant.set(channel, channel.usual_truth());
            }
            truth.plant.set(Channel::NATURAL_FREQUENCY, wn);
            let yielding = draw.uniform(0.7, 1.5) * size;
            for channel in PlantKind::BOUC_WEN.parameters() {
                if [Channel::HYSTERESIS_BETA, Channel::HYSTERESIS_GAMMA].contains(&channel) {
                    truth.plant.set(channel, 0.5 / (yielding * yielding));
                }
            }
            *note = format!("yields at {:.2} rms", yielding / size);
        }
        Fault::MissingMode => {
            truth.plant.kind = PlantKind::SHEAR_2;
            let stiffness = wn * wn * 2.6;
            for channel in PlantKind::SHEAR_2.parameters() {
                if channel.key().starts_with("stiffness") {
                    let value = stiffness * draw.uniform(0.8, 1.3);
                    truth.plant.set(channel, value);
                } else {
                    truth.plant.set(channel, 0.05 * wn);
                }
            }
        }
        Fault::WindUp | Fault::NoExcitation => truth.force = Force::None,
        Fault::SuddenChange => {
            let (to, at) = (wn * draw.uniform(0.75, 0.92), truth.duration * draw.uniform(0.4, 0.93));
            truth.plant.set(Channel::NATURAL_FREQUENCY, Signal::Step(Step { from: wn, to, at }));
            *note = format!("to {:.2} at {:.2}", to / wn, at / truth.duration);
        }
        Fault::SlowDrift => {
            let to = wn * draw.uniform(0.8, 0.93);
            let drift = Ramp { from: wn, to, start: 0.0, end: truth.duration };
            truth.plant.set(Channel::NATURAL_FREQUENCY, Signal::Ramp(drift));
            *note = format!("to {:.2}", to / wn);
        }
        Fault::InputGain => {
            let gain = if draw.chance(0.5) { draw.uniform(0.5, 0.85) } else { draw.uniform(1.18, 1.8) };
            truth.plant.set(Channel::INPUT_GAIN, gain);
            *note = format!("gain {gain:.2}");
        }
        Fault::InputOffset => {
            let offset = draw.sign() * draw.log_uniform(0.5, 2.0) * size * wn * wn;
            truth.plant.set(Channel::INPUT_OFFSET, offset);
            *note = format!("offset {:.2} of the rms force", offset / rms_force);
        }
        Fault::UnknownForce => {
            let force = draw.log_uniform(0.5, 2.0) * size * wn * wn;
            let duration = truth.duration;
            let signal = match draw.choice(&[0, 1, 2]) {
                0 => {
                    let period = draw.log_uniform(4.0, 20.0) * std::f64::consts::TAU / wn;
                    Signal::Sine(Sine { mean: 0.0, amplitude: force, period })
                }
                1 => Signal::Step(Step { from: 0.0, to: force, at: duration * draw.uniform(0.2, 0.8) }),
                _ => Signal::Ramp(Ramp { from: -force, to: force, start: 0.0, end: duration }),
            };
            truth.plant.set(Channel::UNKNOWN_FORCE, signal);
            *note = format!("{:.2} of the spring's rms force, {signal:?}", force / (size * wn * wn));
        }
        Fault::InputDelay => {
            truth.plant.input_delay = draw.choice(&[-3, -2, -1, 1, 2, 3]);
            *note = format!("{} samples", truth.plant.input_delay);
        }
        Fault::InputHold => truth.hold = Hold::First,
        Fault::SensorBias => {
            let sensor = draw.choice(&truth.sensors);
            let bias = draw.sign() * draw.log_uniform(1.0, 6.0) * sensor.noise_std;
            let drifts = draw.chance(0.3);
            let drift = Ramp { from: -bias, to: bias, start: 0.0, end: truth.duration };
            let signal = if drifts { Signal::Ramp(drift) } else { Signal::Constant(bias) };
            truth.plant.set(sensor.measures.bias(), signal);
            let (key, size, drifts) =
                (sensor.measures.key(), bias / sensor.noise_std, if drifts { ", drifts" } else { "" });
            *note = format!("{key} {size:.1} of noise{drifts}");
        }
        _ => {}
    }
}

struct Draw(Normal);

impl Draw {
    fn new(seed: u64, kind: u64) -> Self {
        Self(Normal::from_seed(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ kind))
    }

    /// From 0 to 1.
    fn unit(&mut self) -> f64 {
        self.0.uniform()
    }

    fn uniform(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * self.unit()
    }

    fn log_uniform(&mut self, from: f64, to: f64) -> f64 {
        libm::exp(self.uniform(libm::log(from), libm::log(to)))
    }

    fn choice<T: Copy>(&mut self, of: &[T]) -> T {
        of[((self.unit() * of.len() as f64) as usize).min(of.len() - 1)]
    }

    fn chance(&mut self, p: f64) -> bool {
        self.unit() < p
    }

    fn sign(&mut self) -> f64 {
        if self.chance(0.5) { 1.0 } else { -1.0 }
    }

    fn normal(&mut self) -> f64 {
        self.0.sample()
    }

    fn guess(&mut self, filter: &mut FilterSettings, beliefs: &[(Channel, f64, f64)]) {
        for &(channel, mean, std) in beliefs {
            filter.initial_std[channel] = std;
            filter.initial_mean[channel] =
                if channel.is_parameter() { mean + std * self.normal().clamp(-2.0, 2.0) } else { mean };
            if channel.is_parameter() {
                filter.process_std[channel] = 1e-5 * mean;
            }
        }
    }
}

/// The density of a force \[m²/s³\] about ωₙ, as if it were white noise.
fn power(force: &Force, wn: f64, dt: f64) -> f64 {
    match *force {
        Force::WhiteNoise { std } => std * std * dt,
        Force::Chirp { amplitude, .. } => amplitude * amplitude / (5.4 * wn) * std::f64::consts::PI,
        Force::ImpulseTrain { impulse, period } => impulse * impulse / period,
        _ => 0.0,
    }
}
