//! The steps that filters take from sample to sample, and estimates of computing time.

use kalmanscope_filters::InputKind;
use kalmanscope_filters::filter::Propagation;
use kalmanscope_filters::linalg::Matrix;
use kalmanscope_filters::lists::numbers;

use super::{FilterSettings, Plant};
use crate::{Model, PlantKind, Scenario};

/// Limits the time between two checks of the clock; a browser is two to three times slower than this \[ns\].
const CHUNK: f64 = 1e6;

/// Time to simulate one sample of a record, to within a factor of three \[ns\].
pub const OF_RECORD: f64 = 500.0;

/// Time of an ensemble's member for one sample, by its components and their square: `cargo bench --bench measurements -- largest` \[ns\].
const OF_COMPONENT: f64 = 250.0;
const OF_COVARIANCE: f64 = 12.0;

/// Limits the time for one sample of an ensemble, which nothing divides; a browser is three to four times slower \[ns\].
const LONGEST: f64 = 0.25e9;

pub(crate) fn largest_ensemble(components: usize, substeps: usize) -> usize {
    let n = components.max(1) as f64;
    (LONGEST / (OF_COMPONENT * n * substeps.max(1) as f64 + OF_COVARIANCE * n * n)) as usize
}

/// The steps of this many nanoseconds between two checks of the time.
pub fn chunk(step: f64) -> usize {
    (CHUNK / step).clamp(1.0, 1e5) as usize
}

/// The angle by which a motion should turn at most in one step \[rad\].
const MOST: f64 = 0.2;

/// Limits the error of a step, relative to the error of a frequency from a record.
const SMALL: f64 = 0.03;

/// Limits the steps from one sample to the next that are not set by hand.
const MOST_STEPS: f64 = 40.0;

/// The relative error of a frequency from a good record. Steps of nonlinear plants are fine enough for it.
const USUAL: f64 = 1e-6;

/// Limits the steps of a plant that is not linear from below: a larger motion than the initial belief knows can be stiffer.
const LEAST: usize = 4;

/// The initial standard deviations from the initial mean at which a motion may be: the slopes of its forces count there too.
const REACH: f64 = 2.0;

/// The number of steps over an angle `turn` \[rad\] that leave out little, if a record has the frequency to a relative `accuracy`.
/// A step of fourth order over an angle h turns by a share of h⁴ / 120 too little, which must be small beside `accuracy`. Source: Hairer,
/// Nørsett and Wanner (1993), *Solving Ordinary Differential Equations I*, section II.2.
pub(crate) fn steps_over(turn: f64, accuracy: Option<f64>) -> usize {
    let step = accuracy.map_or(MOST, |accuracy| libm::sqrt(libm::sqrt(120.0 * SMALL * accuracy)).min(MOST));
    libm::ceil(turn / step).clamp(1.0, MOST_STEPS) as usize
}

impl FilterSettings {
    /// The time that it takes for one sample on an ordinary processor, to within a factor of three, for portions of work \[ns\].
    pub fn time_of_step(&self, scenario: &Scenario) -> f64 {
        let &Scenario { plant: Plant { kind: ref truth, .. }, input, dt, .. } = scenario;
        let one = (self.kind.info().time)(&self.method(truth), self.model(truth, input).size());
        let filters = self.guesses.max(1) * self.process_scales.max(1) * if self.walk > 0.0 { 2 } else { 1 };
        one * (self.steps(truth, input, dt) * filters) as f64
    }

    /// The propagation of the mean: that of the settings, else local linearisation for a linear plant, and Runge-Kutta steps for others.
    pub fn propagation_for(&self, truth: &PlantKind) -> Propagation {
        let is_linear = self.plant.as_ref().unwrap_or(truth).info().is_linear;
        // Elsewhere local linearisation errs by the cube of a step: a Duffing spring's parameters were up to 13 σ off.
        self.propagation.unwrap_or(if is_linear { Propagation::LocalLinearisation } else { Propagation::RungeKutta })
    }

    /// The steps from one sample to the next, `dt` \[s\] later: those of the settings, else as many as a Runge-Kutta step's error asks for.
    pub fn steps(&self, truth: &PlantKind, input: InputKind, dt: f64) -> usize {
        if self.substeps > 0 {
            return self.substeps;
        }
        let model = self.model(truth, input);
        let moves_by_stages =
            !self.kind.info().has_propagation || self.propagation_for(truth) == Propagation::RungeKutta;
        if model.is_linear() || !moves_by_stages || self.kind.is_sampled() {
            return 1;
        }
        steps_over(self.turn(&model, dt), Some(USUAL)).max(LEAST)
    }

    /// The largest angle \[rad\] by which a motion near the initial mean turns in `dt` \[s\], and also that over which it decays or grows.
    pub(crate) fn turn(&self, model: &Model, dt: f64) -> f64 {
        let mean = numbers(model.size(), &|i| self.initial_mean[model.channels()[i]]);
        let motion = model.motion();
        let mut near = vec![mean.clone()];
        for (place, channel) in model.channels()[..motion].iter().enumerate() {
            for side in [-REACH, REACH] {
                let mut other = mean.clone();
                other[place] += side * self.initial_std[*channel];
                near.push(other);
            }
        }
        let turns = near.iter().map(|values| turn_at(model, values, dt));
        turns.filter(|turn| turn.is_finite()).fold(0.0, f64::max)
    }
}

/// The same where the components have these values, in the units of their channels.
pub fn turn_at(model: &Model, values: &[f64], dt: f64) -> f64 {
    radius(&model.jacobian(model.to_state(values).0.as_slice(), 0.0), model.motion()) * dt
}

/// The largest absolute eigenvalue of the first `motion` rows and columns, by the root of a high power's size.
fn radius(a: &Matrix, motion: usize) -> f64 {
    const SQUARINGS: i32 = 5;
    let mut power = a.view((0, 0), (motion, motion)).into_owned();
    let mut logarithm = 0.0;
    for squaring in 0..=SQUARINGS {
        let size = power.iter().fold(0.0_f64, |most, entry| most.max(entry.abs()));
        if size == 0.0 {
            return 0.0;
        }
        logarithm += libm::log(size) / f64::from(1 << squaring);
        power /= size;
        power = &power * &power;
    }
    libm::exp(logarithm)
}
