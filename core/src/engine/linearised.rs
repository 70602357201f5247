//! The prediction of KF and EKF: one step of local linearisation at the mean.

use super::belief::Belief;
use super::columns::{add_times, apply, congruence, multiply};
use super::exponential::Exponential;
use super::impulse::Impulse;
use super::level::Level;
use super::model::{Derivatives, Model};
use super::number::Number;
use super::step::Step;

/// The step from the mean, and memory to work in.
#[derive(Clone, Debug)]
pub struct Linearised<T> {
    derivatives: Derivatives<T>,
    /// The upper rows of Φ, column by column; the others are those of an identity.
    rows: Vec<T>,
    half: Vec<T>,
    /// The effect of what is constant, or of a slope.
    effect: Vec<T>,
    exponential: Exponential<T>,
}

impl<T: Number> Linearised<T> {
    /// Memory for a model.
    pub fn new(model: &Model) -> Self {
        let (motion, zero) = (model.motion(), T::of(0.0));
        Self {
            derivatives: Derivatives::new(model),
            rows: vec![zero; motion * model.size],
            half: vec![zero; motion * model.size],
            effect: vec![zero; motion],
            exponential: Exponential::new(if model.plant.is_oscillator() { 0 } else { motion }),
        }
    }

    /// Carries a belief over a step. A force that is not held has a slope ḟ.
    ///
    /// ```text
    /// y⁻ = y + Γ₁ g(y, F) + Γ₂ b g ḟ,  P⁻ = Φ P Φᵀ,  Φ = exp(A dt),  A = ∂g/∂y,  b = ∂g/∂F
    /// ```
    ///
    /// The column of an input gain g in A is `b f` and changes with the force: its column of Φ is `Γ₁ b f + Γ₂ b ḟ`. Only what
    /// moves needs an exponential:
    ///
    /// ```text
    /// A = [F, C; 0, 0],  exp(A dt) = [exp(F dt), Γ₁ C; 0, I],  Γ₁ and Γ₂ of F
    /// ```
    ///
    /// Source: Huang and Yuen (2023), *Bayesian Real-Time System Identification*; Van Loan (1978), Computing integrals involving
    /// the matrix exponential.
    #[inline(always)]
    pub fn advance<L: Level>(&mut self, level: L, model: &Model, belief: &mut Belief<T>, step: &Step<T>) {
        let (n, motion) = (model.size, model.motion());
        level.apart(
            #[inline(always)]
            || self.derivatives.take(model, &belief.mean, step.forces[0]),
        );
        if model.plant.is_oscillator() {
            level.apart(
                #[inline(always)]
                || self.swing(level, model, &mut belief.mean, step),
            );
        } else {
            let block = &self.derivatives.columns[..motion * motion];
            self.exponential.compute(level, block, motion, step.dt, step.has_slope);
            level.apart(
                #[inline(always)]
                || self.flow(model, &mut belief.mean, step),
            );
        }
        level.apart(
            #[inline(always)]
            || congruence(&self.rows, &mut belief.cov, &mut self.half, n, motion),
        );
    }

    /// Moves the mean of an oscillator, and takes the rows of Φ, by the closed form.
    #[inline(always)]
    fn swing<L: Level>(&mut self, level: L, model: &Model, mean: &mut [T], step: &Step<T>) {
        let Self { derivatives: Derivatives { rate, columns, .. }, rows, .. } = self;
        let (a, b) = (columns[1], columns[3]);
        let Impulse { h, q, p } = Impulse::new(level, a, b, step.dt, step.has_slope);
        let (v, acceleration, aq) = (mean[1], rate[1], a * q);
        mean[0] = mean[0] + (h - b * q) * v + q * acceleration;
        mean[1] = mean[1] + aq * v + h * acceleration;
        rows[..4].copy_from_slice(&[aq + 1.0, a * h, h, aq + 1.0 + b * h]);
        for j in 2..model.size {
            rows[2 * j] = q * columns[2 * j + 1];
            rows[2 * j + 1] = h * columns[2 * j + 1];
        }
        if step.has_slope {
            let push = step.slope() * model.by_force[1];
            self.effect[0] = p * push;
            self.effect[1] = q * push;
            self.push(model, mean);
        }
    }

    /// The same for any plant, by the exponential.
    #[inline(always)]
    fn flow(&mut self, model: &Model, mean: &mut [T], step: &Step<T>) {
        let Self { derivatives: Derivatives { rate, columns, .. }, rows, effect, exponential, .. } = self;
        let motion = model.motion();
        let Exponential { transition, constant, slope, .. } = exponential;
        apply(
            effect,
            constant,
            motion,
            #[inline(always)]
            |k| rate[k],
        );
        for i in 0..motion {
            mean[i] = mean[i] + effect[i];
        }
        let (own, others) = rows.split_at_mut(motion * motion);
        own.copy_from_slice(transition);
        multiply(others, constant, &columns[motion * motion..], motion, motion);
        if step.has_slope {
            let push = step.slope();
            apply(
                effect,
                slope,
                motion,
                #[inline(always)]
                |k| push * model.by_force[k],
            );
            self.push(model, mean);
        }
    }

    /// Adds the effect of a slope of the recorded force.
    #[inline(always)]
    fn push(&mut self, model: &Model, mean: &mut [T]) {
        let motion = model.motion();
        let gain = if let Some(place) = model.gain { mean[place] } else { T::of(1.0) };
        add_times(&mut mean[..motion], gain, &self.effect);
        if let Some(place) = model.gain {
            add_times(&mut self.rows[place * motion..(place + 1) * motion], T::of(1.0), &self.effect);
        }
    }
}
