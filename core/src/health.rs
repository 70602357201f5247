//! Troubles that a filter survives, but without which its estimates should not be read.

use thiserror::Error;

use crate::quantity::MAX_SENSORS;
use crate::sink::{AssumedNoise, Sample};
use crate::{Channel, FilterSettings, PlantKind, Quantity, Values};

/// Something to know about a filter that goes on all the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum Trouble {
    /// A standard deviation is a thousand times the larger of its initial and its usual size. The usual size of a motion is
    /// the larger, the noisier the best of the sensors is.
    #[error(
        "the covariance winds up: the filter forgets what it knew of the {} faster than the sensors tell it anew",
        .0.name()
    )]
    WindUp(Channel),
    /// Two channels are correlated beyond 1, by more than rounding explains.
    #[error("rounding has made the covariance indefinite: {} and {} are correlated by more than 1", .0.name(), .1.name())]
    Indefinite(Channel, Channel),
    /// A sensor has delivered nothing for ten samples or more.
    #[error("the sensor for {} delivers nothing", .0.key())]
    Missing(Quantity),
    /// The filter's plant has nothing that the sensor could measure.
    #[error("the filter's plant has no {}, so that its sensor is ignored", .0.key())]
    Unknown(Quantity),
    /// For ten measurements or more, one or two particles, or less than 2 % of them, have had nearly all the weight.
    #[error("the particles have collapsed: hardly any of them agrees with the measurements")]
    Collapse,
    /// R has learnt a standard deviation a thousandth of the initial one.
    #[error("the noise that the filter learns for the sensor for {} runs to zero", .0.key())]
    VanishingSensorNoise(Quantity),
    /// R has learnt a standard deviation a thousand times the initial one.
    #[error("the noise that the filter learns for the sensor for {} runs away", .0.key())]
    GrowingSensorNoise(Quantity),
    /// Q has learnt a standard deviation a thousandth of the initial one.
    #[error("the process noise that the filter learns for the {} runs to zero", .0.name())]
    VanishingProcessNoise(Channel),
    /// Q has learnt a standard deviation a thousand times the initial one.
    #[error("the process noise that the filter learns for the {} runs away", .0.name())]
    GrowingProcessNoise(Channel),
}

/// A trouble and when it was: one remark an occasion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Remark {
    /// The trouble.
    pub what: Trouble,
    /// The first sample that has it, by its number from the run's beginning.
    pub sample: usize,
    /// The last sample that has it, as far as the filter has come.
    pub last: usize,
}

/// What a thousand times too large or too small is, of a variance.
const FAR: f64 = 1e6;

/// The correlation that rounding no longer explains.
const BEYOND_ONE: f64 = 1.0 + 1e-6;

/// From this variance on, products of variances may overflow.
const HUGE: f64 = 1e150;

/// How many samples make a run of them.
const A_WHILE: usize = 10;

/// A trouble that comes back after no more samples than these is the same occasion.
const PAUSE: usize = 50;

/// Looks at every sample of one filter, and remarks.
#[derive(Clone, Debug)]
pub(crate) struct Watch {
    channels: Vec<Channel>,
    sensors: Vec<Quantity>,
    /// Which sensors the filter's plant knows.
    known: [bool; MAX_SENSORS],
    /// The variances at which the covariance is wound up.
    limits: Vec<f64>,
    /// The variances at which it is worth a closer look.
    suspicious: Vec<f64>,
    /// How long each sensor has delivered nothing.
    silent: [usize; MAX_SENSORS],
    any_silent: bool,
    fewest_particles: f64,
    collapsed: usize,
    /// Diagonals of R and Q at first.
    initial_noise: Option<(Vec<f64>, Vec<f64>)>,
    remarks: Vec<Remark>,
}

impl Watch {
    /// A watch over the filter of some settings, which takes the truth for `plant`.
    pub(crate) fn new(settings: &FilterSettings, channels: &[Channel], plant: PlantKind, sensors: &[Quantity]) -> Self {
        // The best sensor says how far apart states must be to be told apart.
        let noise = |(sensor, std): (&Quantity, &f64)| std / sensor.aspect().info().usual_noise;
        let noisier = sensors.iter().zip(&settings.sensor_std).map(noise).fold(f64::INFINITY, f64::min);
        let noisier = if noisier.is_finite() { noisier.max(1.0) } else { 1.0 };
        let limit = |&channel: &Channel| {
            let usual = Values::INITIAL_STD[channel] * if channel.is_parameter() { 1.0 } else { noisier };
            let size = settings.initial_std[channel].max(usual);
            FAR * size * size
        };
        let mut known = [true; MAX_SENSORS];
        for (known, sensor) in known.iter_mut().zip(sensors) {
            *known = plant.has(*sensor);
        }
        let particles = if settings.kind.has_own_likelihood() { settings.ensemble_size } else { 0 };
        let limits: Vec<f64> = channels.iter().map(limit).collect();
        Self {
            channels: channels.to_vec(),
            sensors: sensors.to_vec(),
            known,
            suspicious: limits.iter().map(|limit| limit.min(HUGE)).collect(),
            limits,
            silent: [0; MAX_SENSORS],
            any_silent: false,
            fewest_particles: (0.02 * particles as f64).max(2.0),
            collapsed: 0,
            initial_noise: None,
            remarks: Vec::new(),
        }
    }

    pub(crate) fn remarks(&self) -> &[Remark] {
        &self.remarks
    }

    /// Drops the remarks of occasions that are over before sample `first`, and that none after it belongs to.
    pub(crate) fn forget_before(&mut self, first: usize) {
        self.remarks.retain(|remark| remark.last + PAUSE >= first);
    }

    /// Looks at sample number `k`.
    #[inline(always)]
    pub(crate) fn look(&mut self, k: usize, sample: &Sample<'_>) {
        let Sample { mean, cov, innovation, effective_samples, noise, .. } = *sample;
        let n = mean.len();
        let wide = (0..n).zip(&self.suspicious).fold(false, |wide, (i, limit)| wide | (cov[i * n + i] > *limit));
        let mut beyond = false;
        for j in 0..n {
            for i in j + 1..n {
                // The smallest normal number forgives what underflows.
                let product = cov[i * n + i] * cov[j * n + j];
                beyond |= cov[j * n + i] * cov[j * n + i] > BEYOND_ONE * product + f64::MIN_POSITIVE;
            }
        }
        if wide | beyond {
            self.look_at_covariance(k, cov);
        }
        if self.any_silent | innovation.iter().fold(false, |any, e| any | e.is_nan()) {
            self.look_at_sensors(k, innovation);
        }
        if effective_samples < self.fewest_particles {
            self.collapsed += 1;
            if self.collapsed >= A_WHILE {
                self.note(Trouble::Collapse, k + 1 - self.collapsed, k);
            }
        } else if !effective_samples.is_nan() {
            self.collapsed = 0;
        }
        if let Some(noise) = noise {
            self.look_at_noise(k, noise);
        }
    }

    #[cold]
    fn look_at_covariance(&mut self, k: usize, cov: &[f64]) {
        let n = self.channels.len();
        let channels = self.channels.clone();
        for j in 0..n {
            if cov[j * n + j] > self.limits[j] {
                self.note(Trouble::WindUp(channels[j]), k, k);
            }
            for i in j + 1..n {
                let product = cov[i * n + i].sqrt() * cov[j * n + j].sqrt();
                if cov[j * n + i].abs() > BEYOND_ONE.sqrt() * product + f64::MIN_POSITIVE.sqrt() {
                    self.note(Trouble::Indefinite(channels[j], channels[i]), k, k);
                }
            }
        }
    }

    #[cold]
    fn look_at_sensors(&mut self, k: usize, innovation: &[f64]) {
        if k == 0 {
            return;
        }
        self.any_silent = false;
        for (place, value) in innovation.iter().enumerate() {
            if !value.is_nan() {
                self.silent[place] = 0;
                continue;
            }
            self.any_silent = true;
            self.silent[place] += 1;
            let (sensor, silent) = (self.sensors[place], self.silent[place]);
            if !self.known[place] {
                self.note(Trouble::Unknown(sensor), k, k);
            } else if silent >= A_WHILE {
                self.note(Trouble::Missing(sensor), k + 1 - silent, k);
            }
        }
    }

    /// Looks at the noise that an adaptive filter assumes by sample `k`.
    #[cold]
    fn look_at_noise(&mut self, k: usize, noise: AssumedNoise<'_>) {
        let AssumedNoise { process, .. } = noise;
        let Some((first_sensors, first_process)) = self.initial_noise.take() else {
            self.initial_noise = Some((noise.sensors.to_vec(), process.to_vec()));
            return;
        };
        for (place, (&now, &first)) in noise.sensors.iter().zip(&first_sensors).enumerate() {
            let sensor = self.sensors[place];
            self.compare(k, now, first, Trouble::VanishingSensorNoise(sensor), Trouble::GrowingSensorNoise(sensor));
        }
        for (place, (&now, &first)) in process.iter().zip(&first_process).enumerate() {
            let channel = self.channels[place];
            self.compare(k, now, first, Trouble::VanishingProcessNoise(channel), Trouble::GrowingProcessNoise(channel));
        }
        self.initial_noise = Some((first_sensors, first_process));
    }

    fn compare(&mut self, k: usize, now: f64, first: f64, vanishing: Trouble, growing: Trouble) {
        // A variance that was zero has no size to compare with.
        if first > 0.0 && now < first / FAR {
            self.note(vanishing, k, k);
        } else if first > 0.0 && now > first * FAR {
            self.note(growing, k, k);
        }
    }

    fn note(&mut self, what: Trouble, sample: usize, k: usize) {
        match self.remarks.iter_mut().rev().find(|remark| remark.what == what) {
            Some(remark) if k - remark.last <= PAUSE => remark.last = k,
            _ => self.remarks.push(Remark { what, sample, last: k }),
        }
    }
}
