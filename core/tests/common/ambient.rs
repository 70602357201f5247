//! Records without an input, from a separate simulator, and the ends of filters on them.

use kalmanscope_core::suggest::{scenario_for, suggest};
use kalmanscope_core::{Channel, Hold, Quantity, Record};
use kalmanscope_diagnosis::VerdictKind;
use nalgebra::Vector2;

use crate::numbers::{Random, rms, transition};
use crate::run::{finished_on, forced, last, verdict};

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Accelerometer {
    /// It takes the mean from half a sample before to half a sample after.
    Mean,
    /// The force itself ends at the Nyquist frequency, and the sample is that of the instant.
    BandLimited,
    /// A Butterworth filter of fourth order at 0.4 of the rate comes before the sample.
    Filtered,
    /// Nothing keeps aliases away: the sample is that of the instant.
    #[allow(dead_code, reason = "the measurements take it, and the tests do not")]
    Instant,
    /// The force is held from its sample to the next, and the sample is that of the instant.
    Held,
}

#[derive(Clone, Debug)]
pub(crate) struct Ambient {
    /// ωₙ \[rad/s\] and ζ.
    pub(crate) natural_frequency: f64,
    pub(crate) damping_ratio: f64,
    /// Samples a second, and seconds.
    pub(crate) rate: f64,
    pub(crate) seconds: f64,
    pub(crate) sensors: Vec<Quantity>,
    pub(crate) accelerometer: Accelerometer,
    /// The noise of each sensor, relative to its signal.
    pub(crate) noise: f64,
    pub(crate) seed: u64,
}

const HALF: usize = 10;
/// The intensity of the force is that of 1 m/s² held for a sample.
const FORCE: f64 = 1.0;

impl Ambient {
    fn force(&self, samples: usize, random: &mut Random) -> Vec<f64> {
        let fine = 2 * HALF;
        if self.accelerometer == Accelerometer::Held {
            let held: Vec<f64> = (0..samples).map(|_| FORCE * random.normal()).collect();
            return (0..samples * fine).map(|k| held[k / fine]).collect();
        }
        if self.accelerometer != Accelerometer::BandLimited {
            let std = FORCE * (fine as f64).sqrt();
            return (0..samples * fine).map(|_| std * random.normal()).collect();
        }
        // Lanczos.
        const REACH: usize = 10;
        let at_samples: Vec<f64> = (0..samples + 2 * REACH).map(|_| FORCE * random.normal()).collect();
        let sinc = |x: f64| if x == 0.0 { 1.0 } else { (std::f64::consts::PI * x).sin() / (std::f64::consts::PI * x) };
        let kernel: Vec<Vec<f64>> = (0..fine)
            .map(|i| {
                let past = (i as f64 + 0.5) / fine as f64;
                (0..2 * REACH)
                    .map(|j| {
                        let away = past - (j as f64 - (REACH as f64 - 1.0));
                        sinc(away) * sinc(away / REACH as f64)
                    })
                    .collect()
            })
            .collect();
        (0..samples * fine)
            .map(|k| at_samples[k / fine..].iter().zip(&kernel[k % fine]).map(|(w, by)| w * by).sum())
            .collect()
    }

    pub(crate) fn record(&self) -> Record {
        let Self { natural_frequency: wn, damping_ratio: zeta, rate, .. } = *self;
        let mut random = Random::new(self.seed);
        let (samples, fine) = ((self.seconds * rate) as usize, 2 * HALF);
        let h = 1.0 / rate / fine as f64;
        // Ten time constants before the first sample.
        let before = (10.0 / (zeta * wn) * rate) as usize + 4;
        let force = self.force(before + samples + 1, &mut random);
        let transition = transition([wn, zeta], h);
        let mut low_pass =
            [Biquad::low_pass(0.4 / fine as f64, 0.541_196), Biquad::low_pass(0.4 / fine as f64, 1.306_563)];
        let mut state = Vector2::zeros();
        let (mut xs, mut vs, mut accelerations) = (Vec::new(), Vec::new(), Vec::new());
        let (mut halves, mut last) = (Vec::new(), 0.0);
        for (k, &f) in force.iter().enumerate() {
            let [x, v]: [f64; 2] = state.into();
            let acceleration = f - 2.0 * zeta * wn * v - wn * wn * x;
            let filtered = low_pass.iter_mut().fold(acceleration, |value, biquad| biquad.next(value));
            if k % fine == 0 && k / fine >= before {
                xs.push(x);
                vs.push(v);
                accelerations.push(match self.accelerometer {
                    Accelerometer::Filtered => filtered,
                    _ => acceleration,
                });
            }
            let rest = Vector2::new(f / (wn * wn), 0.0);
            state = transition * (state - rest) + rest;
            if (k + 1) % fine == HALF {
                if (k + 1) / fine >= before {
                    halves.push((state[1] - last) * rate);
                }
                last = state[1];
            }
        }
        if self.accelerometer == Accelerometer::Mean {
            accelerations = halves;
        }
        let columns = self.sensors.iter().map(|&quantity| {
            let signal = match quantity {
                q if q == Quantity::DISPLACEMENT => &xs,
                q if q == Quantity::VELOCITY => &vs,
                _ => &accelerations,
            };
            let signal = &signal[..samples];
            let size = rms(signal);
            (quantity, signal.iter().map(|y| y + self.noise * size * random.normal()).collect())
        });
        let columns = columns.collect();
        forced(1.0 / rate, Hold::First, vec![0.0; samples], columns)
    }
}

struct Biquad {
    b: [f64; 3],
    a: [f64; 2],
    state: [f64; 2],
}

impl Biquad {
    fn low_pass(share: f64, quality: f64) -> Self {
        let w = std::f64::consts::TAU * share;
        let (sin, cos) = w.sin_cos();
        let alpha = sin / (2.0 * quality);
        let a0 = 1.0 + alpha;
        let b = (1.0 - cos) / a0;
        Self { b: [0.5 * b, b, 0.5 * b], a: [-2.0 * cos / a0, (1.0 - alpha) / a0], state: [0.0; 2] }
    }

    fn next(&mut self, value: f64) -> f64 {
        let out = self.b[0] * value + self.state[0];
        self.state = [self.b[1] * value - self.a[0] * out + self.state[1], self.b[2] * value - self.a[1] * out];
        out
    }
}

pub(crate) struct End {
    pub(crate) errors: [f64; 2],
    pub(crate) sigmas: [f64; 2],
    pub(crate) guess: [f64; 2],
    pub(crate) is_white: bool,
    pub(crate) verdict: VerdictKind,
    pub(crate) text: String,
    pub(crate) reasons: String,
}

pub(crate) fn end(ambient: &Ambient, place: usize) -> End {
    end_on(&ambient.record(), [ambient.natural_frequency, ambient.damping_ratio], place)
}

pub(crate) fn end_on(record: &Record, truth: [f64; 2], place: usize) -> End {
    let suggestion = suggest(&scenario_for(record), record);
    let filter = &suggestion.scenario.filters[place];
    let force = filter.augment.contains(&Channel::WHITE_FORCE).then(|| filter.process_std[Channel::WHITE_FORCE]);
    let channels = [Channel::NATURAL_FREQUENCY, Channel::DAMPING_RATIO];
    let guess = [0, 1].map(|i| filter.initial_mean[channels[i]] / truth[i] - 1.0);
    let run = finished_on(&suggestion.scenario, record.clone());
    let ends = channels.map(|channel| last(&run.estimates()[place], channel));
    let errors = [0, 1].map(|i| ends[i].0 / truth[i] - 1.0);
    let stds = [0, 1].map(|i| ends[i].1 / truth[i]);
    let verdict = verdict(&run, place);
    let text = format!(
        "guess {:+.2} % {:+.0} %, end {:+.2} % {:+.0} % (σ {:.2} % {:.0} %), {:?}, force {force:?}, R {:?}, {}",
        100.0 * guess[0],
        100.0 * guess[1],
        100.0 * errors[0],
        100.0 * errors[1],
        100.0 * stds[0],
        100.0 * stds[1],
        suggestion.scenario.hold,
        filter.sensor_std,
        verdict.name(),
    );
    let is_white = force.is_some();
    let (sigmas, reasons) = ([0, 1].map(|i| errors[i] / stds[i]), suggestion.reasons.join("\n"));
    End { errors, sigmas, guess, verdict, is_white, text, reasons }
}

pub(crate) fn building(rate: f64, sensors: &[Quantity], accelerometer: Accelerometer, seed: u64) -> Ambient {
    Ambient {
        natural_frequency: std::f64::consts::TAU * 1.2,
        damping_ratio: 0.04,
        rate,
        seconds: if rate < 30.0 { 1200.0 } else { 600.0 },
        sensors: sensors.to_vec(),
        accelerometer,
        noise: 0.01,
        seed,
    }
}

pub(crate) const SETS: [&[Quantity]; 4] = [
    &[Quantity::DISPLACEMENT],
    &[Quantity::VELOCITY],
    &[Quantity::ACCELERATION],
    &[Quantity::DISPLACEMENT, Quantity::ACCELERATION],
];

pub(crate) fn mass(accelerometer: Accelerometer, rate: f64, seed: u64) -> Ambient {
    Ambient {
        natural_frequency: 19.478,
        damping_ratio: 0.02,
        rate,
        seconds: 180.0,
        sensors: vec![Quantity::ACCELERATION],
        accelerometer,
        noise: 0.02,
        seed,
    }
}
