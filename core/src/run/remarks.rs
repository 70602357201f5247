//! Remarks: problems that a filter survives, but that make its estimates unreliable.

use kalmanscope_filters::lists::mapped;
use kalmanscope_filters::noise_scale;
use kalmanscope_filters::quantity::MAX_SENSORS;
use kalmanscope_filters::{Channel, Quantity};
use thiserror::Error;

use crate::run::sink::{AssumedNoise, Sample};
use crate::{FilterSettings, Model, Values};

/// A problem that does not stop the filter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum Trouble {
    /// A standard deviation exceeds a thousand times its initial and its usual value, scaled by the noise of the best sensor.
    #[error("the covariance winds up: the filter forgets the {} faster than it learns it", .0.name())]
    WindUp(Channel),
    /// The correlation of two channels exceeds 1 by more than rounding.
    #[error("rounding has made the covariance indefinite: {} and {} are correlated by more than 1", .0.name(), .1.name())]
    Indefinite(Channel, Channel),
    /// A sensor has had no measurement for ten samples or more.
    #[error("the sensor for {} delivers nothing", .0.key())]
    Missing(Quantity),
    /// The filter's plant lacks the quantity that the sensor measures.
    #[error("the filter ignores the sensor for {}: its plant has none", .0.key())]
    Unknown(Quantity),
    /// The record's readings have times of their own, and this option counts in samples.
    #[error("each reading counts at the sample after it, not at its own time, because the filter has {0}")]
    Moved(&'static str),
    /// A sensor is late by part of a step, and this option counts in samples.
    #[error("a late reading counts at the nearest sample, not at its own time, because the filter has {0}")]
    Rounded(&'static str),
    /// For ten measurements or more, one or two particles, or less than 2 % of them, have had nearly all the weight.
    #[error("the particles have collapsed: hardly any of them agrees with the measurements")]
    Collapse,
    /// The filter has jumped ([`FilterSettings::jump`]).
    #[error("its innovations grew suddenly, and it let its parameters change")]
    Widened,
    /// R has learnt a standard deviation a thousandth of the initial one.
    #[error("the learnt noise of the sensor for {} goes to zero", .0.key())]
    VanishingSensorNoise(Quantity),
    /// R has learnt a standard deviation a thousand times the initial one.
    #[error("the learnt noise of the sensor for {} grows without limit", .0.key())]
    GrowingSensorNoise(Quantity),
    /// Q may be beyond the scales of it that the filter has ([`FilterSettings::process_scales`]), for 200 samples or more.
    #[error(
        "the process noise may be outside the filter's scales of Q: from 1/{0} to {0} times √Q",
        noise_scale::REACH
    )]
    ScaleAtEnd,
    /// Q has learnt a standard deviation a thousandth of the initial one.
    #[error("the learnt process noise of the {} goes to zero", .0.name())]
    VanishingProcessNoise(Channel),
    /// Q has learnt a standard deviation a thousand times the initial one.
    #[error("the learnt process noise of the {} grows without limit", .0.name())]
    GrowingProcessNoise(Channel),
}

impl Trouble {
    /// Its word in text.
    pub const fn key(self) -> &'static str {
        match self {
            Self::WindUp(_) => "wind_up",
            Self::Indefinite(..) => "indefinite",
            Self::Missing(_) => "missing",
            Self::Unknown(_) => "unknown",
            Self::Moved(_) => "moved",
            Self::Rounded(_) => "rounded",
            Self::Collapse => "collapse",
            Self::Widened => "widened",
            Self::VanishingSensorNoise(_) => "vanishing_sensor_noise",
            Self::GrowingSensorNoise(_) => "growing_sensor_noise",
            Self::ScaleAtEnd => "scale_at_end",
            Self::VanishingProcessNoise(_) => "vanishing_process_noise",
            Self::GrowingProcessNoise(_) => "growing_process_noise",
        }
    }
}

/// A problem with the samples at which it occurred; a later occurrence is a new remark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Remark {
    /// The problem.
    pub what: Trouble,
    /// The first sample that has it, counted from the run's beginning.
    pub sample: usize,
    /// The last sample that has it so far.
    pub last: usize,
}

/// Limits the ratio of a variance to its usual value: a thousand in the standard deviation.
const RATIO_LIMIT: f64 = 1e6;

/// Limits the square of a correlation, with a margin for rounding.
const CORRELATION_LIMIT: f64 = 1.0 + 1e-6;

/// Limits the variances, so that their products cannot overflow.
const PRODUCT_LIMIT: f64 = 1e150;

const LASTING: usize = 10;

/// A slow sensor counts as silent when it has read nothing for this many of its usual gaps.
const SILENT: usize = 3;

/// The number of successive samples at which the scale of Q may be beyond the end.
const LONG: usize = 200;

/// The scale of Q is not known at all while ln s is less certain than this.
const UNKNOWN: f64 = 1.0;

/// Limits the number of samples between two occurrences that belong to one remark.
const PAUSE: usize = 50;

#[derive(Clone, Debug, Default)]
pub(crate) struct Monitor {
    channels: Vec<Channel>,
    sensors: Vec<Quantity>,
    known: [bool; MAX_SENSORS],
    limits: Vec<f64>,
    suspicious: Vec<f64>,
    silent: [usize; MAX_SENSORS],
    lasting: Vec<usize>,
    /// Whether readings have times of their own: then a sensor may become slower than it was, and a record may grow.
    is_timed: bool,
    missing: [usize; MAX_SENSORS],
    any_silent: bool,
    fewest_particles: f64,
    collapsed: usize,
    at_end: usize,
    initial_noise: Vec<f64>,
    pub(crate) remarks: Vec<Remark>,
}

impl Monitor {
    pub(crate) fn new(settings: &FilterSettings, model: &Model, sensors: &[Quantity]) -> Self {
        let (plant, channels) = (model.plant(), model.channels());
        // The noise of the best sensor determines how well states can be distinguished.
        let noise = |(sensor, std): (&Quantity, &f64)| std / sensor.aspect().info().usual_noise;
        let noisier = sensors.iter().zip(&settings.sensor_std).map(noise).fold(f64::INFINITY, f64::min);
        let noisier = if noisier.is_finite() { noisier.max(1.0) } else { 1.0 };
        let limit = |&channel: &Channel| {
            let usual = Values::INITIAL_STD[channel] * if channel.is_parameter() { 1.0 } else { noisier };
            let size = settings.initial_std[channel].max(usual);
            RATIO_LIMIT * size * size
        };
        let particles = if settings.kind.has_own_likelihood() { settings.ensemble_size } else { 0 };
        let limits: Vec<f64> = mapped(channels, &limit);
        Self {
            channels: channels.to_vec(),
            sensors: sensors.to_vec(),
            known: std::array::from_fn(|place| sensors.get(place).is_none_or(|sensor| plant.has(*sensor))),
            suspicious: mapped(&limits, &|limit| limit.min(PRODUCT_LIMIT)),
            limits,
            lasting: vec![LASTING; sensors.len()],
            fewest_particles: (0.02 * particles as f64).max(2.0),
            ..Self::default()
        }
    }

    pub(crate) fn with_clocks(mut self, apart: Option<&[usize]>, trouble: Option<Trouble>) -> Self {
        if let Some(apart) = apart {
            self.lasting = mapped(apart, &|apart| LASTING.max(SILENT * apart));
            self.is_timed = true;
        }
        self.remarks.extend(trouble.map(|what| Remark { what, sample: 0, last: 0 }));
        self
    }

    /// Drops the remarks that are over before sample `first` and cannot be continued after it.
    pub(crate) fn forget_before(&mut self, first: usize) {
        self.remarks.retain(|remark| remark.last + PAUSE >= first);
    }

    #[inline(always)]
    pub(crate) fn check(&mut self, k: usize, sample: &Sample<'_>) {
        let Sample { mean, cov, innovation, effective_samples, noise, has_widened, .. } = *sample;
        let n = mean.len();
        let wide = (0..n).zip(&self.suspicious).fold(false, |wide, (i, limit)| wide | (cov[i * n + i] > *limit));
        let mut beyond = false;
        for j in 0..n {
            for i in j + 1..n {
                // The smallest normal number tolerates underflow.
                let product = cov[i * n + i] * cov[j * n + j];
                beyond |= cov[j * n + i] * cov[j * n + i] > CORRELATION_LIMIT * product + f64::MIN_POSITIVE;
            }
        }
        if wide | beyond {
            self.check_covariance(k, cov);
        }
        if k > 0 && self.any_silent | innovation.iter().fold(false, |any, e| any | e.is_nan()) {
            self.check_sensors(k, innovation);
        }
        if effective_samples < self.fewest_particles {
            self.collapsed += 1;
            if self.collapsed >= LASTING {
                self.note(Trouble::Collapse, k + 1 - self.collapsed, k);
            }
        } else if !effective_samples.is_nan() {
            self.collapsed = 0;
        }
        if let Some(noise) = noise {
            self.check_noise(k, noise);
        }
        if has_widened {
            self.note(Trouble::Widened, k, k);
        }
    }

    #[cold]
    fn check_covariance(&mut self, k: usize, cov: &[f64]) {
        let n = self.channels.len();
        let channels = self.channels.clone();
        for j in 0..n {
            if cov[j * n + j] > self.limits[j] {
                self.note(Trouble::WindUp(channels[j]), k, k);
            }
            for i in j + 1..n {
                let product = cov[i * n + i].sqrt() * cov[j * n + j].sqrt();
                if cov[j * n + i].abs() > CORRELATION_LIMIT.sqrt() * product + f64::MIN_POSITIVE.sqrt() {
                    self.note(Trouble::Indefinite(channels[j], channels[i]), k, k);
                }
            }
        }
    }

    #[cold]
    fn check_sensors(&mut self, k: usize, innovation: &[f64]) {
        self.any_silent = false;
        for (place, value) in innovation.iter().enumerate() {
            if !value.is_nan() {
                self.silent[place] = 0;
                continue;
            }
            self.any_silent = true;
            self.silent[place] += 1;
            self.missing[place] += 1;
            let (sensor, silent) = (self.sensors[place], self.silent[place]);
            // Of the gaps that it usually had until its last reading, where readings have times of their own.
            let read = k - self.missing[place];
            let usual_gaps = if self.is_timed { SILENT * (k - silent) / read.max(1) } else { 0 };
            if !self.known[place] {
                self.note(Trouble::Unknown(sensor), k, k);
            } else if silent >= self.lasting[place].max(usual_gaps) {
                self.note(Trouble::Missing(sensor), k + 1 - silent, k);
            }
        }
    }

    #[cold]
    fn check_noise(&mut self, k: usize, noise: AssumedNoise<'_>) {
        let AssumedNoise { process, process_scale: [mean, std], .. } = noise;
        let is_at_end = std < UNKNOWN && mean.abs() + 2.0 * std > libm::log(noise_scale::REACH);
        self.at_end = if is_at_end { self.at_end + 1 } else { 0 };
        if self.at_end >= LONG {
            self.note(Trouble::ScaleAtEnd, k + 1 - self.at_end, k);
        }
        if self.initial_noise.is_empty() {
            self.initial_noise.extend(noise.sensors.iter().chain(process));
            return;
        }
        for (place, &now) in noise.sensors.iter().chain(process).enumerate() {
            let first = self.initial_noise[place];
            let (vanishing, growing) =
                (first > 0.0 && now < first / RATIO_LIMIT, first > 0.0 && now > first * RATIO_LIMIT);
            if vanishing || growing {
                let what = match (self.sensors.get(place), vanishing) {
                    (Some(sensor), true) => Trouble::VanishingSensorNoise(*sensor),
                    (Some(sensor), false) => Trouble::GrowingSensorNoise(*sensor),
                    (None, true) => Trouble::VanishingProcessNoise(self.channels[place - self.sensors.len()]),
                    (None, false) => Trouble::GrowingProcessNoise(self.channels[place - self.sensors.len()]),
                };
                self.note(what, k, k);
            }
        }
    }

    fn note(&mut self, what: Trouble, sample: usize, k: usize) {
        match self.remarks.iter_mut().rev().find(|remark| remark.what == what) {
            Some(remark) if k - remark.last <= PAUSE => remark.last = k,
            _ => self.remarks.push(Remark { what, sample, last: k }),
        }
    }
}
