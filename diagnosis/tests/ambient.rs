//! Records without an input, from a separate simulator, and the ends of filters on them.

use kalmanscope_core::suggest::{scenario_for, suggest};
use kalmanscope_core::{Channel, Hold, Quantity, Record};
use kalmanscope_diagnosis::VerdictKind;

use crate::numbers::{Random, motion, rms};
use crate::run::{finished_on, forced, last};
use crate::verdict;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Accelerometer {
    /// It takes the mean from half a sample before to half a sample after.
    Mean,
    /// The force itself ends at the Nyquist frequency, and the sample is that of the instant.
    BandLimited,
    /// A Butterworth filter of fourth order at 0.4 of the rate comes before the sample.
    Filtered,
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
        let motion = motion([wn, zeta], h, Hold::Zero, &force, [0.0; 2]);
        let mut low_pass =
            [Biquad::low_pass(0.4 / fine as f64, 0.541_196), Biquad::low_pass(0.4 / fine as f64, 1.306_563)];
        let filtered: Vec<f64> =
            motion.iter().map(|of| low_pass.iter_mut().fold(of[2], |value, biquad| biquad.next(value))).collect();
        let reading = |quantity: Quantity, at: usize| match (quantity, self.accelerometer) {
            (quantity, _) if quantity == Quantity::DISPLACEMENT => motion[at][0],
            (quantity, _) if quantity == Quantity::VELOCITY => motion[at][1],
            (_, Accelerometer::Filtered) => filtered[at],
            (_, Accelerometer::Mean) => (motion[at + HALF][1] - motion[at - HALF][1]) * rate,
            _ => motion[at][2],
        };
        let columns = self.sensors.iter().map(|&quantity| {
            let signal: Vec<f64> = (before..before + samples).map(|k| reading(quantity, k * fine)).collect();
            let size = rms(&signal);
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
        "guess {guess:.4?}, end {errors:.4?} ± {stds:.4?}, {:?}, force {force:?}, R {:?}, {verdict:?}",
        suggestion.scenario.hold, filter.sensor_std
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

pub(crate) fn mass(accelerometer: Accelerometer, rate: f64, seed: u64) -> Ambient {
    let building = building(rate, &[Quantity::ACCELERATION], accelerometer, seed);
    Ambient { natural_frequency: 19.478, damping_ratio: 0.02, seconds: 180.0, noise: 0.02, ..building }
}
