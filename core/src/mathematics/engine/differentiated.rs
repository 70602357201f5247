//! Steps of a mean with their derivative by the state: those of Euler and of Runge and Kutta.

use super::columns::{add_times, multiply};
use super::level::Level;
use super::linearised::Linearised;
use super::model::Model;
use super::number::Number;
use super::step::Step;

impl<T: Number> Linearised<T> {
    /// `y⁻ = y + dt g(y, f)` and `Φ = I + A dt`.
    #[inline(always)]
    pub(super) fn euler<L: Level>(&mut self, level: L, model: &Model, mean: &mut [T], step: &Step<T>) {
        level.apart(
            #[inline(always)]
            || {
                let Self { derivatives, rows, .. } = self;
                let (moving, dt) = (model.moving(), T::of(step.dt));
                derivatives.take(level, model, mean, step.forces[0]);
                add_times(&mut mean[..moving], dt, &derivatives.rate);
                begin(rows, moving);
                add_times(rows, dt, &derivatives.columns);
            },
        );
    }

    /// One Runge-Kutta step, and its derivative by the state that it starts from: the chain rule, stage by stage.
    ///
    /// ```text
    /// kₛ = g(y + aₛ dt kₛ₋₁),  Kₛ = Aₛ (I + aₛ dt Kₛ₋₁),  y⁻ = y + dt Σ bₛ kₛ,  Φ = I + dt Σ bₛ Kₛ
    /// ```
    #[inline(always)]
    pub(super) fn runge_kutta<L: Level>(&mut self, level: L, model: &Model, mean: &mut [T], step: &Step<T>) {
        let moving = model.moving();
        let [begin_force, middle_force, end_force] = step.thrice();
        self.begun.copy_from_slice(mean);
        begin(&mut self.rows, moving);
        self.half.fill(T::of(0.0));
        self.derivatives.rate.fill(T::of(0.0));
        let stages =
            [(0.0, 1.0, begin_force), (0.5, 2.0, middle_force), (0.5, 2.0, middle_force), (1.0, 1.0, end_force)];
        for (share, weight, force) in stages {
            level.apart(
                #[inline(always)]
                || self.pass(level, model, mean, [share * step.dt, weight * step.dt / 6.0], force),
            );
        }
    }

    /// A stage after some time \[s\], which counts for some time \[s\].
    #[inline(always)]
    fn pass<L: Level>(&mut self, level: L, model: &Model, mean: &mut [T], [after, counts]: [f64; 2], force: T) {
        let Self { derivatives, rows, half: slope, begun, stage, before, .. } = self;
        let moving = model.moving();
        stage.copy_from_slice(begun);
        add_times(&mut stage[..moving], T::of(after), &derivatives.rate);
        derivatives.take(level, model, stage, force);
        add_times(&mut mean[..moving], T::of(counts), &derivatives.rate);
        let a = &derivatives.columns;
        before.copy_from_slice(slope);
        multiply(slope, &a[..moving * moving], before, moving, moving);
        for (slope, direct) in slope.iter_mut().zip(a) {
            *slope = *slope * after + *direct;
        }
        add_times(rows, T::of(counts), slope);
    }
}

/// The rows of an identity.
#[inline(always)]
fn begin<T: Number>(rows: &mut [T], moving: usize) {
    rows.fill(T::of(0.0));
    for i in 0..moving {
        rows[i * moving + i] = T::of(1.0);
    }
}
