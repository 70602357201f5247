//! Filters that learn from their innovations, lane by lane: they weigh measurements, estimate their noise, and jump.

use super::belief::{Belief, Noise};
use super::columns::{factor, square};
use super::design::Design;
use super::level::Level;
use super::number::{Mask, Number};
use super::square_root::may_have_root;
use super::update::{Checks, Observation, Target, Update, UpdateResult};
use super::weights::{Residuals, Weights};
use crate::mathematics::filter::jump::Jump;
use crate::mathematics::filter::robust::Robust;

#[derive(Clone, Debug)]
pub(super) struct Learning<T> {
    pub(super) weighing: Option<Weighing<T>>,
    /// One in each lane, or none.
    jumps: Vec<Jump>,
    /// The diagonal of Q before a jump.
    narrow: Vec<T>,
    shift: Vec<T>,
    residuals: Residuals<T>,
    uncertainty: Vec<T>,
    sample: usize,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Learnt<'a> {
    /// The weight of each sensor's reading; `None` of a filter that weighs none.
    pub(crate) weights: Option<&'a [f64]>,
    pub(crate) uncertainty: &'a [f64],
    pub(crate) has_widened: bool,
}

impl<T: Number> Learning<T> {
    /// The memory for filters that begin with this belief; `None` where they learn nothing. If they learn Q, it becomes a whole matrix.
    pub(super) fn new(design: &Design, belief: &Belief<T>, noise: &mut Noise<T>) -> Option<Box<Self>> {
        let Design { robust, adaptation, jumps, .. } = design;
        if !robust.is_on() && !adaptation.is_on() && !jumps {
            return None;
        }
        let n = belief.size();
        if adaptation.process_noise && noise.matrix.is_empty() {
            noise.fill_matrix();
        }
        let variances = |lane: usize| (0..n).map(|i| belief.cov[i * n + i].lane(lane)).collect();
        Some(Box::new(Self {
            weighing: robust.is_on().then(|| Weighing::new(*robust, belief, noise)),
            jumps: (0..if *jumps { T::LANES } else { 0 }).map(|lane| Jump::new(variances(lane))).collect(),
            narrow: vec![T::of(0.0); n],
            shift: vec![T::of(0.0); n],
            residuals: Residuals::default(),
            uncertainty: noise.sensors.iter().map(|r| adaptation.initial_uncertainty(*r)).collect(),
            sample: 0,
        }))
    }

    /// Begins the next sample, and adds the variances of jumps to Q for its prediction. Returns whether any lane jumps; then [`Self::narrow`] restores Q.
    pub(super) fn widen(&mut self, design: &Design, noise: &mut Noise<T>) -> bool {
        let Self { jumps, narrow, sample, .. } = self;
        *sample += 1;
        let mut has_widened = false;
        for (lane, jump) in jumps.iter_mut().enumerate() {
            let Some(widening) = jump.widening() else { continue };
            if !std::mem::replace(&mut has_widened, true) {
                narrow.iter_mut().enumerate().for_each(|(i, variance)| *variance = *noise.variance(i));
            }
            // A force that is drawn again at each sample always has its full variance.
            let is_kept = |i: usize| design.white.is_none_or(|(place, _)| place != i);
            for (i, more) in widening.enumerate().filter(|(i, _)| is_kept(*i)) {
                let variance = noise.variance(i);
                variance.set_lane(lane, variance.lane(lane) + more);
            }
        }
        has_widened
    }

    pub(super) fn narrow(&self, noise: &mut Noise<T>) {
        self.narrow.iter().enumerate().for_each(|(i, variance)| *noise.variance(i) = *variance);
    }

    pub(super) fn condition<L: Level>(
        &mut self,
        level: L,
        update: &mut Update<T>,
        target: &mut Target<'_, T>,
        noise: &mut Noise<T>,
        (force, measured): (T, &[T]),
    ) -> UpdateResult<T> {
        let (design, observation) = (target.design, Observation { force, measured, variances: &noise.sensors });
        let result = match &mut self.weighing {
            Some(weighing) => weighing.condition(level, update, target, observation),
            None => update.condition(level, target, observation),
        };
        let has_measured = T::of(0.0).lt(result.measured);
        let learns = design.adaptation.learns_at(self.sample, design.dt);
        if learns && design.adaptation.process_noise {
            self.adapt_process(design, noise, update, has_measured);
        }
        if learns && design.adaptation.sensor_noise {
            self.adapt_sensors(design, noise, measured, update);
        }
        for (lane, jump) in self.jumps.iter_mut().enumerate() {
            if has_measured.lane(lane) {
                jump.observe(result.nis.lane(lane), result.measured.lane(lane) as usize);
            }
        }
        result
    }

    /// `Q ← a Q + (1 - a) K e eᵀ Kᵀ`, as [`Adaptation`](crate::filter::Adaptation) has it.
    fn adapt_process(&mut self, design: &Design, noise: &mut Noise<T>, update: &Update<T>, has_measured: T::Mask) {
        let (shift, n) = (&mut self.shift, self.narrow.len());
        shift.fill(T::of(0.0));
        let [innovation, _, gain] = update.parts();
        for (&e, gain) in innovation.iter().zip(gain.chunks_exact(n)) {
            for i in 0..n {
                shift[i] = shift[i] + gain[i] * e;
            }
        }
        let keep = design.adaptation.forgetting;
        let white = design.white.map(|(place, _)| place);
        for j in 0..n {
            for i in j..n {
                let old = noise.matrix[j * n + i];
                let learnt = shift[i] * (shift[j] * (1.0 - keep)) + old * keep;
                let is_kept = white == Some(i) || white == Some(j);
                noise.matrix[j * n + i] = if is_kept { old } else { T::select(has_measured, learnt, old) };
            }
        }
    }

    /// `R ← a R + (1 - a) diag(ε εᵀ + H P Hᵀ)`, as [`Adaptation`](crate::filter::Adaptation) has it.
    fn adapt_sensors(&mut self, design: &Design, noise: &mut Noise<T>, measured: &[T], update: &Update<T>) {
        let Self { residuals, uncertainty, .. } = self;
        for (&sensor, &residual) in update.active.iter().zip(residuals.of(&update.innovations())) {
            let old = [noise.sensors[sensor], uncertainty[sensor]];
            let [r, variance] = design.adaptation.learn(old, residual);
            let is_there = measured[sensor].is_number();
            noise.sensors[sensor] = T::select(is_there, r, old[0]);
            uncertainty[sensor] = T::select(is_there, variance, old[1]);
        }
    }
}

impl Learning<f64> {
    pub(super) fn learnt(&self) -> Learnt<'_> {
        Learnt {
            weights: self.weighing.as_ref().map(|weighing| &weighing.weights.weights[..]),
            uncertainty: &self.uncertainty,
            has_widened: self.jumps.iter().any(|jump| jump.has_widened),
        }
    }
}

/// Updates that weigh measurements. A lane whose weights have settled keeps its measurements and R while others iterate, and so the same
/// update.
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
