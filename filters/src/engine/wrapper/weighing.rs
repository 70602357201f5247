//! Measurements that are weighed by how well they fit.

use super::{Learnt, Readings, Recursion, Wrapper};
use crate::engine::belief::GaussianBelief;
use crate::engine::columns::{factor, square};
use crate::engine::dynamics::Dynamics;
use crate::engine::filter::GaussianFilter;
use crate::engine::number::{Mask, Number};
use crate::engine::robust::Robust;
use crate::engine::update::{Update, UpdateResult};
use crate::engine::weights::Weights;

/// A filter that weighs its readings. A lane whose weights have settled keeps them while others iterate, and so the same update.
pub struct Weighing<T> {
    weights: Weights<T>,
    before: GaussianBelief<T>,
    before_root: Vec<T>,
    /// S with the R of the settings, m × m, and its factor in the end.
    claimed: Vec<T>,
}

impl<T: Number> Weighing<T> {
    pub fn of<P: Dynamics>(rule: Robust, filter: &GaussianFilter<T, P>) -> Option<Box<dyn Wrapper<T, P>>> {
        let weights = Weights::new(rule, filter.noise.sensors.len());
        let (before, before_root, claimed) = (filter.belief.clone(), Vec::new(), Vec::new());
        rule.is_on().then(|| Box::new(Self { weights, before, before_root, claimed }) as _)
    }

    /// The result is that of S with the R of the settings. A reading of next to no weight is no sample of it.
    fn claim(&mut self, filter: &mut GaussianFilter<T, impl Dynamics>, result: UpdateResult<T>) -> UpdateResult<T> {
        let Self { weights, claimed, .. } = self;
        let GaussianFilter { update, checks, noise, .. } = filter;
        let variances = &noise.sensors[..];
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

impl<T: Number, P: Dynamics> Wrapper<T, P> for Weighing<T> {
    fn update(&mut self, inner: &mut dyn Recursion<T, P>, readings: Readings<'_, T>) -> UpdateResult<T> {
        let Self { weights, before, before_root, .. } = self;
        let filter = inner.filter();
        before.copy_from(&filter.belief);
        if let Some(rows) = filter.root_rows() {
            before_root.clone_from(rows);
        }
        let mut result = inner.update(readings);
        let filter = inner.filter();
        if filter.update.active.is_empty() {
            weights.clear();
            return result;
        }
        weights.begin(&filter.update.innovations(), &filter.noise.sensors, readings.measured);
        let mut settled = !filter.checks.but_likely();
        for _ in 0..weights.rule.info().passes {
            let filter = inner.filter();
            settled = settled | !weights.weigh(&filter.update.innovations(), &filter.noise.sensors, settled);
            if settled.all() {
                break;
            }
            filter.belief.copy_from(before);
            if let Some(rows) = filter.root_rows() {
                rows.copy_from_slice(before_root);
            }
            let Weights { measured, variances, .. } = &*weights;
            result = inner.update(Readings { measured, variances: Some(variances), ..readings });
            settled = settled | !inner.filter().checks.but_likely();
        }
        self.claim(inner.filter(), result)
    }

    fn report<'a>(&'a self, learnt: &mut Learnt<'a, T>) {
        learnt.weights = Some(&self.weights.weights);
    }

    fn memory(&self) -> &[T] {
        &self.weights.usual
    }

    fn restore(&mut self, memory: &[T]) {
        self.weights.usual.copy_from_slice(memory);
    }
}
