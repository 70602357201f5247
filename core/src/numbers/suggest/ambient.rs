//! Records without an input: a white force moves the plant, and its size is one more thing to be found.

use super::ambient_fit::{AmbientFit, ambient_fit};
use super::climb::Climb;
use super::follow::first_alone;
use super::response::{Response, order};
use super::{Suggestion, moments, motion_sensor, rounded};
use crate::{Channel, FilterKind, Hold, Quantity, Record, Scenario};

/// The white force of a record without an input, and the noise of the scenario's sensors, before they are tried.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Sizes {
    /// s \[m/s²\]
    force: f64,
    /// In the sensors' order and units.
    noise: Vec<f64>,
    /// The course of the force from sample to sample.
    hold: Hold,
}

impl Sizes {
    /// These factors on the force and on the noise of each sensor.
    fn times(&self, factors: &[f64]) -> Self {
        let noise = self.noise.iter().zip(&factors[1..]).map(|(noise, by)| rounded(noise * by)).collect();
        Self { force: rounded(self.force * factors[0]), noise, ..*self }
    }

    /// The same with a force that is held from its sample to the next.
    fn held(&self) -> Self {
        Self { hold: Hold::Zero, ..self.clone() }
    }
}

/// Whether a record has no input: one that does not change moves nothing.
pub(super) fn has_no_input(record: &Record) -> bool {
    record.input().windows(2).all(|pair| pair[0] == pair[1])
}

/// The trials of a white force.
pub(super) struct Ambient {
    pub(super) suggestion: Suggestion,
    /// The sizes that factors of the climb multiply.
    sizes: Sizes,
    climb: Climb,
    /// The sensors that its filters do without.
    left_out: Vec<Quantity>,
    /// The best of the climb with a force that is held: its log likelihood, if it has one. None before it was tried.
    held: Option<Option<f64>>,
}

impl Ambient {
    /// The start values for a record without an input, from a suggestion without noise. `None` if the spectrum shows no
    /// oscillator.
    pub(super) fn new(mut suggestion: Suggestion, record: &mut Record) -> Option<Self> {
        let left_out = suggestion.felt_twice();
        left_out.iter().for_each(|quantity| suggestion.scenario.remove_sensor(*quantity));
        let sizes = suggestion.ambient(record)?;
        suggestion.is_guessed = true;
        suggestion.substeps(record.dt());
        let climb = Climb::new(1 + suggestion.scenario.sensors.len());
        Some(Self { suggestion, sizes, climb, left_out, held: None })
    }

    /// Takes the sensors out of a scenario that filters of the white force do without: likelihoods compare on equal readings.
    pub(super) fn leave_out(&self, scenario: &mut Scenario) {
        self.left_out.iter().for_each(|quantity| scenario.remove_sensor(*quantity));
    }

    /// The share that is done, from 0 to 1.
    pub(super) fn progress(&self) -> f64 {
        self.climb.progress()
    }

    /// The sizes of the next trial: those of the climb, then its best with a force that is held.
    pub(super) fn next(&self) -> Option<Sizes> {
        let Self { sizes, climb, held, .. } = self;
        let of_climb = || climb.next().map(|factors| sizes.times(&factors));
        let last = || climb.best().filter(|_| held.is_none()).map(|(factors, _)| sizes.times(factors).held());
        of_climb().or_else(last)
    }

    /// Takes in the log likelihood of the last trial, if there is one.
    pub(super) fn take(&mut self, likelihood: Option<f64>) {
        if self.climb.next().is_some() {
            self.climb.take(likelihood);
        } else {
            self.held = Some(likelihood);
        }
    }

    /// The best sizes and their log likelihood.
    pub(super) fn best(&self) -> Option<(Sizes, f64)> {
        let (factors, likelihood) = self.climb.best()?;
        let sizes = self.sizes.times(factors);
        let held = self.held.flatten().filter(|held| *held > likelihood);
        Some(held.map_or_else(|| (sizes.clone(), likelihood), |held| (sizes.held(), held)))
    }
}

impl Suggestion {
    /// The accelerometers beside a displacement or a velocity. One sensor gives ωₙ and ζ of an oscillator under an
    /// unknown force as well as both do. Together they also show the force's course between samples, which no filter
    /// can model exactly: an error of that course, or of the accelerometer's delay, then looks like an error of ζ.
    fn felt_twice(&mut self) -> Vec<Quantity> {
        let sensors = || self.scenario.sensors.iter().map(|sensor| sensor.measures);
        let is_other = sensors().any(|quantity| order(quantity) < 2);
        let left_out: Vec<Quantity> = sensors().filter(|quantity| is_other && order(*quantity) == 2).collect();
        for quantity in &left_out {
            self.reasons.push(format!(
                "the filters do without the {}: without a recorded force it tells nothing of ωₙ and ζ that the other sensor does \
                 not, and the course of the force between samples, which is not known, would count as damping",
                quantity.name()
            ));
        }
        left_out
    }

    /// The start values of filters that assume a white force as the input, and the first guess of its size. `None` if
    /// no filter has a frequency, or the spectrum shows none.
    fn ambient(&mut self, record: &mut Record) -> Option<Sizes> {
        if !self.has_frequency() {
            return None;
        }
        let (quantity, measured) = motion_sensor(record)?;
        let band = self.scenario.record.as_ref().and_then(|mapping| mapping.band);
        let fit = ambient_fit(record, quantity, measured, band)?;
        let AmbientFit { natural_frequency, damping_ratio, force, noise, edge, .. } = fit;
        let noises = self.scenario.sensors.iter().enumerate().map(|(place, sensor)| {
            let measured = record.measured_quantity(sensor.measures)?;
            let (_, std) = moments(measured);
            // At high frequencies an accelerometer reads the force; all other sensors read only noise.
            let own = || if sensor.measures == quantity { Some(noise) } else { None };
            let fitted = || own().or_else(|| Some(ambient_fit(record, sensor.measures, measured, band)?.noise));
            let noise = if order(sensor.measures) < 2 { None } else { fitted() };
            Some(noise.unwrap_or(self.scenario.sensors[place].noise_std).max(1e-4 * std))
        });
        let noise = noises.collect::<Option<Vec<f64>>>()?;
        let found = Response { natural_frequency, damping_ratio, gain: None };
        self.begin_at(record, quantity, &found, "fitted to the spectrum as that of an oscillator under a white force");
        if order(quantity) == 2 {
            self.keep_to_spectrum(&fit);
        }
        if let Some(edge) = edge {
            self.reasons.push(format!(
                "above {} Hz the readings have less power than a white force gives, as behind a logger's low-pass filter: their \
                 innovations are correlated, so that the verdict is *overconfident*, but ωₙ and ζ of the spectrum below are right",
                rounded(edge / std::f64::consts::TAU)
            ));
        }
        // An unrecorded force acts on both sides of each sample.
        Some(Sizes { force, noise, hold: Hold::First })
    }

    /// Sets the initial σ of ωₙ and ζ to the errors of the spectrum's fit. An accelerometer also reads the unknown
    /// force, so that it hardly limits x: with a small error in R or in the force's course, ζ would go far wrong.
    fn keep_to_spectrum(&mut self, fit: &AmbientFit) {
        let AmbientFit { natural_frequency, damping_ratio, errors, .. } = *fit;
        for filter in self.filters() {
            filter.initial_std[Channel::NATURAL_FREQUENCY] = rounded(natural_frequency * errors[0]);
            filter.initial_std[Channel::DAMPING_RATIO] = rounded(damping_ratio * errors[1]);
        }
        self.reasons.push(
            "σ of ωₙ and ζ begin as small as the spectrum tells them, because an accelerometer alone tells an unknown force from \
             the motion only if both are known well"
                .to_owned(),
        );
    }

    /// The scenario with a white force in every filter, and noise of the sensors, of these sizes.
    fn with_white_force(&self, sizes: &Sizes) -> Scenario {
        let Sizes { force, noise, hold } = sizes;
        let (mut scenario, force) = (self.scenario.clone(), *force);
        let kind = scenario.plant.kind;
        scenario.hold = *hold;
        for (sensor, noise) in scenario.sensors.iter_mut().zip(noise) {
            sensor.noise_std = *noise;
        }
        for filter in &mut scenario.filters {
            for &channel in kind.channels().iter().filter(|channel| !channel.is_parameter()) {
                filter.process_std[channel] = 0.0;
            }
            if !filter.augment.contains(&Channel::WHITE_FORCE) {
                filter.augment.push(Channel::WHITE_FORCE);
            }
            filter.initial_mean[Channel::WHITE_FORCE] = 0.0;
            filter.initial_std[Channel::WHITE_FORCE] = force;
            filter.process_std[Channel::WHITE_FORCE] = force;
            filter.sensor_std.clone_from(noise);
        }
        scenario
    }

    /// The first filter of [`Self::with_white_force`] alone.
    pub(super) fn trial_of_white_force(&self, sizes: &Sizes) -> Scenario {
        let mut scenario = first_alone(&self.with_white_force(sizes));
        for filter in scenario.filters.iter_mut().filter(|filter| filter.kind.is_sampled()) {
            filter.kind = FilterKind::EKF;
        }
        scenario
    }

    /// Takes these sizes for good.
    pub(super) fn take_white_force(&mut self, sizes: &Sizes) {
        self.scenario = self.with_white_force(sizes);
        let Some(filter) = self.scenario.filters.first() else { return };
        let force = sizes.force;
        let unit = self.unit("m/s²");
        let lasts = if sizes.hold == Hold::Zero { ", and that lasts until the next" } else { "" };
        self.reasons.push(format!(
            "there is no input: the filters take a white force for the cause of the motion, of {force} {unit} at a sample, which an \
             accelerometer feels too{lasts}"
        ));
        for (sensor, noise) in self.scenario.sensors.iter().zip(&filter.sensor_std) {
            let (name, unit) = (sensor.measures.name(), self.unit(sensor.measures.unit()));
            self.reasons.push(format!("R of the {name}: {noise} {unit}, the most likely together with that force"));
        }
    }
}
