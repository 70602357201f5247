//! How a filter moves, where its settings leave that to its plant.

use super::FilterSettings;
use crate::PlantKind;
use crate::mathematics::filter::Propagation;
use crate::mathematics::linalg::Matrix;
use crate::mathematics::model::{InputKind, Model};

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

/// The number of steps over an angle `turn` \[rad\] that leave out little, if a record tells the frequency to a share `told`.
///
/// A step of fourth order over an angle h turns by a share of h⁴ / 120 too little, which must be small beside `told`. Source: Hairer,
/// Nørsett and Wanner (1993), *Solving Ordinary Differential Equations I*, section II.2 (the terms of the exponential that four
/// stages lack).
pub(crate) fn steps_over(turn: f64, told: Option<f64>) -> usize {
    let step = told.map_or(MOST, |told| libm::sqrt(libm::sqrt(120.0 * SMALL * told)).min(MOST));
    libm::ceil(turn / step).clamp(1.0, MOST_STEPS) as usize
}

impl FilterSettings {
    /// The propagation of the mean of a KF, EKF or IEKF of a truth of this kind: that of the settings, else local linearisation where
    /// it is exact, and Runge-Kutta steps for a plant that is not linear.
    pub fn propagation_for(&self, truth: PlantKind) -> Propagation {
        let is_linear = self.plant.unwrap_or(truth).info().is_linear;
        self.propagation.unwrap_or(if is_linear { Propagation::LocalLinearisation } else { Propagation::RungeKutta })
    }

    /// The number of steps from one sample to the next, `dt` \[s\] later: that of the settings, else as many as the error of a
    /// Runge-Kutta step asks for. A linear plant has one, so has the book's local linearisation, and a random sample errs by more.
    pub fn steps(&self, truth: PlantKind, input: InputKind, dt: f64) -> usize {
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
        let mean: Vec<f64> = model.channels().iter().map(|&channel| self.initial_mean[channel]).collect();
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
pub(crate) fn turn_at(model: &Model, values: &[f64], dt: f64) -> f64 {
    radius(&model.jacobian(model.to_state(values).0.as_slice(), 0.0), model.motion()) * dt
}

/// The largest absolute eigenvalue of the first `motion` rows and columns, by the root of a high power's size.
fn radius(a: &Matrix, motion: usize) -> f64 {
    /// Limits the power, 2 to this.
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
