//! The prediction of KF and EKF: the mean moves, and the covariance with the derivative of its step.

use super::belief::GaussianBelief;
use super::columns::{add_times, apply, combine, congruence, multiply, product};
use super::coupled::Coupled;
use super::design::Propagation;
use super::dynamics::Dynamics;
use super::exponential::{Exponential, Impulse};
use super::level::{Level, apart};
use super::model::{Derivatives, Input, StateModel, Step};
use super::number::Number;

#[derive(Clone, Debug)]
pub(crate) struct Linearised<T> {
    derivatives: Derivatives<T>,
    /// The upper rows of Φ, column by column; the others are those of an identity.
    pub rows: Vec<T>,
    /// Memory for T P, or for a part of a step's derivative.
    half: Vec<T>,
    effect: Vec<T>,
    exponential: Exponential<T>,
    coupled: Option<Coupled<T>>,
    /// The state that a step began with, a stage of it, and the derivative of the stage before.
    begun: Vec<T>,
    stage: Vec<T>,
    before: Vec<T>,
}

impl<T: Number> Linearised<T> {
    pub(crate) fn new(model: &StateModel<impl Dynamics>) -> Self {
        let (moving, zero) = (model.moving(), T::of(0.0));
        let coupled = model.coupling().map(|[masses, reach]| Coupled::new(masses, reach));
        Self {
            derivatives: Derivatives::new(model),
            rows: vec![zero; moving * model.size],
            half: vec![zero; moving * model.size],
            effect: vec![zero; moving],
            exponential: Exponential::new(if model.is_oscillator() || coupled.is_some() { 0 } else { moving }),
            coupled,
            begun: vec![zero; model.size],
            stage: vec![zero; model.size],
            before: vec![zero; moving * model.size],
        }
    }

    /// Carries a belief over a step: `P⁻ = Φ P Φᵀ`.
    #[inline(always)]
    pub(crate) fn advance<L: Level>(
        &mut self,
        level: L,
        propagation: Propagation,
        model: &StateModel<impl Dynamics>,
        belief: &mut GaussianBelief<T>,
        step: &Step<'_, T>,
    ) {
        self.step(level, propagation, model, &mut belief.mean, step);
        apart!(level, {
            // Inside the closure: the compiler does not know the values of captured variables.
            let (n, moving) = (level.size(model.size), level.moving(model.moving()));
            let (rows, half) = (&self.rows[..moving * n], &mut self.half[..moving * n]);
            congruence(rows, &mut belief.cov[..n * n], half, n, moving);
        });
    }

    #[inline(always)]
    pub(crate) fn step<L: Level>(
        &mut self,
        level: L,
        propagation: Propagation,
        model: &StateModel<impl Dynamics>,
        mean: &mut [T],
        step: &Step<'_, T>,
    ) {
        match propagation {
            Propagation::LocalLinearisation => self.linearise(level, model, mean, step),
            Propagation::Euler => self.euler(level, model, mean, step),
            Propagation::RungeKutta => self.runge_kutta(level, model, mean, step),
        }
    }

    /// One step of local linearisation. A force that is not held has a slope ḟ.
    ///
    /// ```text
    /// y⁻ = y + Γ₁ g(y, F) + Γ₂ b g ḟ,  Φ = exp(A dt),  A = ∂g/∂y,  b = ∂g/∂F
    /// ```
    ///
    /// The column of an input gain g in A is `b f` and changes with the force: its column of Φ is `Γ₁ b f + Γ₂ b ḟ`.
    /// Only moving components need an exponential:
    ///
    /// ```text
    /// A = [F, C; 0, 0],  exp(A dt) = [exp(F dt), Γ₁ C; 0, I],  Γ₁ and Γ₂ of F
    /// ```
    ///
    /// Source: Huang and Yuen (2023), *Bayesian Real-Time System Identification*, with `dt φ₁(A dt)` for `A⁻¹(exp(A dt) - I)`:
    /// A may be singular; Van Loan (1978), Computing integrals involving the matrix exponential.
    #[inline(always)]
    fn linearise<L: Level>(&mut self, level: L, model: &StateModel<impl Dynamics>, mean: &mut [T], step: &Step<'_, T>) {
        self.derivatives.take(level, model, mean, &step.inputs[0]);
        if level.moving(model.moving()) == 2 && model.is_oscillator() {
            apart!(level, self.swing(level, model, mean, step));
            return;
        }
        let moving = level.moving(model.moving());
        let block = &self.derivatives.columns[..moving * moving];
        if let Some(coupled) = self.coupled.as_mut().filter(|_| moving.is_multiple_of(2)) {
            coupled.compute(level, block, step.dt, step.has_slope());
            apart!(level, self.swing_together(level, model, mean, step));
        } else {
            self.exponential.compute(level, block, moving, step.dt, step.has_slope());
            apart!(level, self.flow(level, model, mean, step));
        }
    }

    #[inline(always)]
    fn swing<L: Level>(&mut self, level: L, model: &StateModel<impl Dynamics>, mean: &mut [T], step: &Step<'_, T>) {
        let n = level.size(model.size);
        let Self { derivatives: Derivatives { rate, columns, .. }, rows, .. } = self;
        let (rate, columns, rows, mean) = (&rate[..2], &columns[..2 * n], &mut rows[..2 * n], &mut mean[..n]);
        let (a, b) = (columns[1], columns[3]);
        let Impulse { h, q, p } = Impulse::new(level, a, b, step.dt, step.has_slope());
        let (v, acceleration, aq) = (mean[1], rate[1], a * q);
        mean[0] = mean[0] + (h - b * q) * v + q * acceleration;
        mean[1] = mean[1] + aq * v + h * acceleration;
        rows[..4].copy_from_slice(&[aq + 1.0, a * h, h, aq + 1.0 + b * h]);
        for j in 2..n {
            rows[2 * j] = q * columns[2 * j + 1];
            rows[2 * j + 1] = h * columns[2 * j + 1];
        }
        if step.has_slope() {
            let push = step.slope() * model.by_force[1];
            self.effect[0] = p * push;
            self.effect[1] = q * push;
            self.push(level, model, mean);
            for (_, push) in step.slopes_on() {
                mean[0] = mean[0] + p * push;
                mean[1] = mean[1] + q * push;
            }
        }
    }

    #[inline(always)]
    fn swing_together<L: Level>(
        &mut self,
        level: L,
        model: &StateModel<impl Dynamics>,
        mean: &mut [T],
        step: &Step<'_, T>,
    ) {
        let Self { derivatives: Derivatives { rate, columns, .. }, rows, effect, coupled, .. } = self;
        let Some(coupled) = coupled else { return };
        let (n, m) = (level.size(model.size), level.moving(model.moving()) / 2);
        let [value, integral, second, displaced, pulled, kept] = coupled.parts(level);
        let (rate, columns, rows) = (&rate[..2 * m], &columns[..2 * m * n], &mut rows[..2 * m * n]);
        let (effect, free) = (&mut effect[..2 * m], &mut self.begun[..m]);

        // Γ₁ ẏ = [h v + q (a - C v); q K v + h a]
        let (velocity, acceleration) = rate.split_at(m);
        combine(free, &columns[2 * m * m..], [2 * m, m], m, velocity);
        for i in 0..m {
            free[i] = acceleration[i] - free[i];
        }
        let (x, v) = effect.split_at_mut(m);
        apply(x, value, m, velocity);
        apply(v, displaced, m, velocity);
        for l in 0..m {
            add_times(x, free[l], &integral[l * m..(l + 1) * m]);
            add_times(v, acceleration[l], &value[l * m..(l + 1) * m]);
        }
        for i in 0..2 * m {
            mean[i] = mean[i] + effect[i];
        }

        for j in 0..m {
            let own = j * m..(j + 1) * m;
            let (x, v) = rows[j * 2 * m..(j + 1) * 2 * m].split_at_mut(m);
            x.copy_from_slice(&displaced[own.clone()]);
            v.copy_from_slice(&pulled[own.clone()]);
            x[j] = x[j] + 1.0;
            let (x, v) = rows[(m + j) * 2 * m..(m + j + 1) * 2 * m].split_at_mut(m);
            x.copy_from_slice(&value[own.clone()]);
            v.copy_from_slice(&kept[own]);
            v[j] = v[j] + 1.0;
        }
        for k in 2 * m..n {
            let (x, v) = rows[k * 2 * m..(k + 1) * 2 * m].split_at_mut(m);
            let pushed = &columns[k * 2 * m + m..(k + 1) * 2 * m];
            apply(x, integral, m, pushed);
            apply(v, value, m, pushed);
        }
        if step.has_slope() {
            let push = step.slope();
            let by_force = &model.by_force[m..];
            let (x, v) = effect.split_at_mut(m);
            apply(x, second, m, (push, by_force));
            apply(v, integral, m, (push, by_force));
            for (place, push) in step.slopes_on() {
                let own = (place - m) * m..(place - m + 1) * m;
                add_times(&mut mean[..m], push, &second[own.clone()]);
                add_times(&mut mean[m..2 * m], push, &integral[own]);
            }
            self.push(level, model, mean);
        }
    }

    #[inline(always)]
    fn flow<L: Level>(&mut self, level: L, model: &StateModel<impl Dynamics>, mean: &mut [T], step: &Step<'_, T>) {
        let Self { derivatives: Derivatives { rate, columns, .. }, rows, effect, exponential, .. } = self;
        let (n, moving) = (level.size(model.size), level.moving(model.moving()));
        let (rate, columns, rows) = (&rate[..moving], &columns[..moving * n], &mut rows[..moving * n]);
        let effect = &mut effect[..moving];
        let Exponential { transition, constant, slope, .. } = exponential;
        apply(effect, constant, moving, rate);
        for i in 0..moving {
            mean[i] = mean[i] + effect[i];
        }
        let (own, others) = rows.split_at_mut(moving * moving);
        own.copy_from_slice(transition);
        multiply(others, constant, &columns[moving * moving..], moving, moving);
        if step.has_slope() {
            let push = step.slope();
            apply(effect, slope, moving, (push, &model.by_force[..]));
            for (place, push) in step.slopes_on() {
                add_times(&mut mean[..moving], push, &slope[place * moving..(place + 1) * moving]);
            }
            self.push(level, model, mean);
        }
    }

    #[inline(always)]
    fn push<L: Level>(&mut self, level: L, model: &StateModel<impl Dynamics>, mean: &mut [T]) {
        let moving = level.moving(model.moving());
        let gain = if let Some(place) = model.gain { mean[place] } else { T::of(1.0) };
        add_times(&mut mean[..moving], gain, &self.effect);
        if let Some(place) = model.gain {
            add_times(&mut self.rows[place * moving..(place + 1) * moving], T::of(1.0), &self.effect);
        }
    }

    /// `y⁻ = y + dt g(y, f)` and `Φ = I + A dt`.
    #[inline(always)]
    fn euler<L: Level>(&mut self, level: L, model: &StateModel<impl Dynamics>, mean: &mut [T], step: &Step<'_, T>) {
        apart!(level, {
            let Self { derivatives, rows, .. } = self;
            let (moving, dt) = (model.moving(), T::of(step.dt));
            derivatives.take(level, model, mean, &step.inputs[0]);
            add_times(&mut mean[..moving], dt, &derivatives.rate);
            begin(rows, moving);
            add_times(rows, dt, &derivatives.columns);
        });
    }

    /// One Runge-Kutta step, and its derivative by the state that it starts from: the chain rule, stage by stage.
    ///
    /// ```text
    /// kₛ = g(y + aₛ dt kₛ₋₁),  Kₛ = Aₛ (I + aₛ dt Kₛ₋₁),  y⁻ = y + dt Σ bₛ kₛ,  Φ = I + dt Σ bₛ Kₛ
    /// ```
    #[inline(always)]
    fn runge_kutta<L: Level>(
        &mut self,
        level: L,
        model: &StateModel<impl Dynamics>,
        mean: &mut [T],
        step: &Step<'_, T>,
    ) {
        let moving = level.moving(model.moving());
        let [at_begin, at_middle, at_end] = step.thrice();
        self.begun.copy_from_slice(mean);
        self.stage.copy_from_slice(mean);
        begin(&mut self.rows, moving);
        self.half.fill(T::of(0.0));
        self.derivatives.rate.fill(T::of(0.0));
        let stages = [(0.0, 1.0, at_begin), (0.5, 2.0, at_middle), (0.5, 2.0, at_middle), (1.0, 1.0, at_end)];
        for (share, weight, input) in stages {
            apart!(level, self.pass(level, model, mean, [share * step.dt, weight * step.dt / 6.0], input));
        }
    }

    #[inline(always)]
    fn pass<L: Level>(
        &mut self,
        level: L,
        model: &StateModel<impl Dynamics>,
        mean: &mut [T],
        [after, counts]: [f64; 2],
        input: Input<'_, T>,
    ) {
        let (n, moving) = (level.size(model.size), level.moving(model.moving()));
        std::mem::swap(&mut self.half, &mut self.before);
        let Self { derivatives, rows, half: slope, begun, stage, before, .. } = self;
        for i in 0..moving {
            stage[i] = begun[i] + derivatives.rate[i] * after;
        }
        derivatives.take(level, model, stage, &input);
        add_times(&mut mean[..moving], T::of(counts), &derivatives.rate);
        let (a, slope) = (&derivatives.columns[..moving * n], &mut slope[..moving * n]);
        product(slope, &a[..moving * moving], &before[..moving * n], moving, moving);
        for (slope, direct) in slope.iter_mut().zip(a) {
            *slope = *slope * after + *direct;
        }
        add_times(&mut rows[..moving * n], T::of(counts), slope);
    }
}

#[inline(always)]
fn begin<T: Number>(rows: &mut [T], moving: usize) {
    rows.fill(T::of(0.0));
    for i in 0..moving {
        rows[i * moving + i] = T::of(1.0);
    }
}
