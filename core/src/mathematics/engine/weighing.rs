//! Updates that weigh measurements, lane by lane: those of [`Weighing`](crate::mathematics::filter) of a single filter.
//!
//! A lane whose weights have settled keeps its measurements and R through the passes of the others, and so has the same update
//! again.

use super::belief::{Belief, Noise};
use super::columns::{factor, square};
use super::design::Design;
use super::fault::Held;
use super::level::Level;
use super::number::{Mask, Number};
use super::update::{Observation, Told, Update};
use crate::mathematics::filter::robust::{FIRST_LEVEL, Misfit, Robust, SETTLED, usual_after};

/// A rule with its memory.
#[derive(Clone, Debug)]
pub(super) struct Weighing<T> {
    rule: Robust,
    /// The belief before the update.
    before: Belief<T>,
    /// Of each sensor: the measurement and R, weighed.
    measured: Vec<T>,
    noise: Noise<T>,
    weights: Vec<T>,
    /// Of each sensor: `e² / S` before any weight, and the usual one.
    predicted: Vec<T>,
    usual: Vec<T>,
    /// ε and `H P⁺ Hᵀ` of each measurement.
    residuals: Vec<[T; 2]>,
    inverse: Vec<T>,
    /// S with the R of the settings, m × m, and its factor in the end.
    claimed: Vec<T>,
}

impl<T: Number> Weighing<T> {
    /// The memory for a rule.
    pub(super) fn new(rule: Robust, belief: &Belief<T>, noise: &Noise<T>) -> Self {
        let sensors = noise.sensors.len();
        let numbers = |number: f64| vec![T::of(number); sensors];
        Self {
            rule,
            before: belief.clone(),
            measured: numbers(f64::NAN),
            noise: noise.clone(),
            weights: numbers(1.0),
            predicted: numbers(0.0),
            usual: numbers(FIRST_LEVEL),
            residuals: Vec::new(),
            inverse: Vec::new(),
            claimed: Vec::new(),
        }
    }

    /// Conditions a belief on measurements, weighed.
    #[expect(clippy::too_many_arguments, reason = "those of the update")]
    pub(super) fn condition<L: Level>(
        &mut self,
        level: L,
        design: &Design,
        belief: &mut Belief<T>,
        noise: &Noise<T>,
        observation: Observation<'_, T>,
        update: &mut Update<T>,
        held: &mut Held<T::Mask>,
    ) -> Told<T> {
        self.before.copy_from(belief);
        let mut told = update.condition(level, design, belief, None, noise, observation, held);
        self.begin(update, noise, observation.measured);
        let mut settled = !held.but_likely();
        for _ in 0..self.rule.info().passes {
            settled = settled | !self.weigh(update, noise, settled);
            if settled.all() {
                break;
            }
            belief.copy_from(&self.before);
            let Self { measured, noise, .. } = &*self;
            let observation = Observation { measured, ..observation };
            told = update.condition(level, design, belief, None, noise, observation, held);
            settled = settled | !held.but_likely();
        }
        self.report(update, noise, told, held)
    }

    /// Takes in the first update, without weights.
    fn begin(&mut self, update: &Update<T>, noise: &Noise<T>, measured: &[T]) {
        let m = update.active.len();
        self.measured.copy_from_slice(measured);
        self.noise.sensors.copy_from_slice(&noise.sensors);
        self.weights.fill(T::of(1.0));
        for (row, &sensor) in update.active.iter().enumerate() {
            let e = update.innovation[row];
            let predicted = e * e / update.innovation_cov[row * m + row];
            let usual = self.usual[sensor];
            let next = T::from_lanes(|lane| usual_after(usual.lane(lane), predicted.lane(lane)));
            self.predicted[sensor] = predicted;
            self.usual[sensor] = T::select(measured[sensor].is_number(), next, usual);
        }
    }

    /// Takes the weights that follow from the last update, but for lanes that have settled. Returns the lanes in which one has
    /// changed.
    fn weigh(&mut self, update: &Update<T>, noise: &Noise<T>, settled: T::Mask) -> T::Mask {
        let Self { rule, measured, noise: own, weights, predicted, usual, residuals, inverse, .. } = self;
        update.residuals_into(inverse, residuals);
        let mut changed = T::Mask::of(false);
        for (&sensor, &[residual, uncertainty]) in update.active.iter().zip(&*residuals) {
            let unweighed = noise.sensors[sensor];
            let (residual, uncertainty) = (residual * residual / unweighed, uncertainty / unweighed);
            let is_weighed = measured[sensor].is_number() & !settled;
            let weight = T::from_lanes(|lane| {
                let misfit = Misfit {
                    predicted: predicted[sensor].lane(lane),
                    residual: residual.lane(lane),
                    uncertainty: uncertainty.lane(lane),
                };
                if is_weighed.lane(lane) { rule.weight(misfit, usual[sensor].lane(lane)) } else { f64::NAN }
            });
            // A sensor without noise has no misfit to weigh by.
            let is_weighed = is_weighed & weight.is_finite() & T::of(0.0).lt(unweighed);
            let old = weights[sensor];
            changed = changed | (is_weighed & (old * SETTLED).lt((weight - old).abs()));
            weights[sensor] = T::select(is_weighed, weight, old);
        }
        for &sensor in &update.active {
            let (weight, nan) = (weights[sensor], T::of(f64::NAN));
            own.sensors[sensor] = T::select(changed, noise.sensors[sensor] / weight, own.sensors[sensor]);
            measured[sensor] = T::select(changed & !T::of(0.0).lt(weight), nan, measured[sensor]);
        }
        changed
    }

    /// The scores by S with the R of the settings, which is what they claim. A reading that counts next to nothing is no sample of
    /// it.
    fn report(&mut self, update: &mut Update<T>, noise: &Noise<T>, told: Told<T>, held: &mut Held<T::Mask>) -> Told<T> {
        let Self { measured, weights, claimed, .. } = self;
        let (one, zero) = (T::of(1.0), T::of(0.0));
        let Update { active, innovation_cov, factor: lower, innovation, white, .. } = update;
        let m = active.len();
        let is_there = |sensor: usize| measured[sensor].is_number();
        let is_weighed = active.iter().fold(T::Mask::of(false), |any, &sensor| {
            let is_one = weights[sensor].le(one) & one.le(weights[sensor]);
            any | (is_there(sensor) & !is_one)
        });
        if (!is_weighed).all() {
            return told;
        }
        claimed.clear();
        claimed.extend_from_slice(&innovation_cov[..m * m]);
        let mut counted = zero;
        for (row, &sensor) in active.iter().enumerate() {
            let (own, weight) = (noise.sensors[sensor], weights[sensor]);
            let counts = is_there(sensor) & T::of(Robust::LEFT_OUT).le(weight);
            counted = counted + T::select(counts, one, zero);
            innovation[row] = T::select(counts | !is_weighed, innovation[row], zero);
            for other in 0..m {
                for at in [row * m + other, other * m + row] {
                    claimed[at] = T::select(counts, claimed[at], zero);
                }
            }
            let variance = claimed[row * m + row] + (own - own / weight);
            claimed[row * m + row] = T::select(counts, variance, one);
        }
        white[..m].copy_from_slice(&innovation[..m]);
        let (determinant, _) = factor(claimed, m);
        let nis = square(claimed, m, &mut white[..m]);
        for (lower, claimed) in lower.iter_mut().zip(&*claimed) {
            *lower = T::select(is_weighed, *claimed, *lower);
        }
        held.is_likely = (is_weighed & nis.is_finite()) | (!is_weighed & held.is_likely);
        Told {
            nis: T::select(is_weighed, nis, told.nis),
            determinant: T::select(is_weighed, determinant, told.determinant),
            measured: T::select(is_weighed, counted, told.measured),
            holds: held.all(),
        }
    }
}
