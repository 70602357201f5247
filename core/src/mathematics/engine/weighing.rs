//! Updates that weigh measurements, lane by lane.
//!
//! A lane whose weights have settled keeps its measurements and R while others iterate, and so the same update.

use super::belief::{Belief, Noise};
use super::columns::{factor, square};
use super::fault::Checks;
use super::level::Level;
use super::number::{Mask, Number};
use super::square_root::may_have_root;
use super::update::{Observation, Target, Update, UpdateResult};
use super::weights::Weights;
use crate::mathematics::filter::robust::Robust;

#[derive(Clone, Debug)]
pub(super) struct Weighing<T> {
    pub(super) weights: Weights<T>,
    before: Belief<T>,
    before_root: Vec<T>,
    /// S with the R of the settings, m × m, and its factor in the end.
    claimed: Vec<T>,
}

impl<T: Number> Weighing<T> {
    pub(super) fn new(rule: Robust, belief: &Belief<T>, noise: &Noise<T>) -> Self {
        let weights = Weights::new(rule, noise.sensors.len());
        Self { weights, before: belief.clone(), before_root: Vec::new(), claimed: Vec::new() }
    }

    pub(super) fn condition<L: Level>(
        &mut self,
        level: L,
        update: &mut Update<T>,
        target: &mut Target<'_, T>,
        observation: Observation<'_, T>,
    ) -> UpdateResult<T> {
        self.before.copy_from(target.belief);
        if const { may_have_root::<T, L>() }
            && let Some(root) = &target.root
        {
            self.before_root.clear();
            self.before_root.extend_from_slice(&root.rows);
        }
        let mut result = update.condition(level, target, observation);
        if update.active.is_empty() {
            self.weights.clear();
            return result;
        }
        self.weights.begin(&update.innovations(), observation.variances, observation.measured);
        let mut settled = !target.checks.but_likely();
        for _ in 0..self.weights.rule.info().passes {
            settled = settled | !self.weights.weigh(&update.innovations(), observation.variances, settled);
            if settled.all() {
                break;
            }
            target.belief.copy_from(&self.before);
            if const { may_have_root::<T, L>() }
                && let Some(root) = &mut target.root
            {
                root.rows.copy_from_slice(&self.before_root);
            }
            let Weights { measured, variances, .. } = &self.weights;
            result = update.condition(level, target, Observation { measured, variances, ..observation });
            settled = settled | !target.checks.but_likely();
        }
        self.report(update, observation.variances, result, target.checks)
    }

    /// By S with the R of the settings, which is what they claim. A reading that counts next to nothing is no sample of it.
    fn report(
        &mut self,
        update: &mut Update<T>,
        variances: &[T],
        result: UpdateResult<T>,
        checks: &mut Checks<T::Mask>,
    ) -> UpdateResult<T> {
        let Self { weights, claimed, .. } = self;
        // Whether a sensor still measures, with whatever weight.
        let is_there = |sensor: usize| weights.measured[sensor].is_number();
        let weights = &weights.weights;
        let (one, zero) = (T::of(1.0), T::of(0.0));
        let Update { active, innovation_cov, factor: lower, innovation, white, .. } = update;
        let m = active.len();
        let is_weighed = active.iter().fold(T::Mask::of(false), |any, &sensor| {
            let is_one = weights[sensor].le(one) & one.le(weights[sensor]);
            any | (is_there(sensor) & !is_one)
        });
        if (!is_weighed).all() {
            return result;
        }
        claimed.clear();
        claimed.extend_from_slice(&innovation_cov[..m * m]);
        let mut counted = zero;
        for (row, &sensor) in active.iter().enumerate() {
            let (own, weight) = (variances[sensor], weights[sensor]);
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
        checks.is_likely = (is_weighed & nis.is_finite()) | (!is_weighed & checks.is_likely);
        UpdateResult {
            nis: T::select(is_weighed, nis, result.nis),
            determinant: T::select(is_weighed, determinant, result.determinant),
            measured: T::select(is_weighed, counted, result.measured),
            holds: checks.all(),
        }
    }
}
