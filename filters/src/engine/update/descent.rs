//! The update of the iterated EKF: a Gauss-Newton descent to the most probable state.
//!
//! ```text
//! yᵢ₊₁ = y⁻ + Kᵢ (z - h(yᵢ) - Hᵢ (y⁻ - yᵢ)),  y₀ = y⁻
//! ```
//!
//! Innovation, S, NIS and likelihood that are reported are those of the first step, at y⁻; gain and covariance are those of the last.
//!
//! Source: Huang and Yuen (2023), *Bayesian Real-Time System Identification*; Gelb, ed. (1974), *Applied Optimal Estimation*, section
//! 6.1; Bell and Cathey (1993), The iterated Kalman filter update as a Gauss-Newton method.

use super::{MeasuredReadings, Target, Update, UpdateResult};
use crate::engine::belief::GaussianBelief;
use crate::engine::design::{Design, Method};
use crate::engine::dynamics::Dynamics;
use crate::engine::level::Level;
use crate::engine::number::{Mask, Number};

/// The step of an iteration counts as none when it is this small, squared, against the variance: a millionth of σ.
const CONVERGED: f64 = 1e-12;

#[derive(Clone, Debug)]
pub(super) struct Descent<T> {
    pub(super) prior: GaussianBelief<T>,
    /// The state in which the sensors are linearised.
    pub(super) at: Vec<T>,
    /// Innovation, S and the factor of S of the first step.
    pub(super) first: [Vec<T>; 3],
}

impl<T: Number> Descent<T> {
    pub(super) fn new(n: usize) -> Self {
        let zeros = |count: usize| vec![T::of(0.0); count];
        let prior = GaussianBelief { mean: zeros(n), cov: zeros(n * n) };
        Self { prior, at: zeros(n), first: [const { Vec::new() }; 3] }
    }
}

impl<T: Number> Update<T> {
    /// The same, with further steps of an iterated EKF, and a note for the smoother.
    #[inline(never)]
    pub(super) fn descend<L: Level>(
        &mut self,
        level: L,
        target: &mut Target<'_, T, impl Dynamics>,
        observation: MeasuredReadings<'_, T>,
    ) -> UpdateResult<T> {
        let (design, mut descent) = (target.design, self.descent.take());
        if let Some(Descent { prior, .. }) = descent.as_deref_mut() {
            prior.copy_from(target.belief);
        }
        let mut result = self.condition_once(level, target, observation);
        let m = self.active.len();
        let reads_rates = !self.active.iter().all(|&sensor| design.readings[sensor].is_of_components());
        if let (Some(descent), Method::Linearised(_, iterations), true) =
            (descent.as_deref_mut(), design.method, reads_rates)
        {
            let parts = [&self.innovation[..m], &self.innovation_cov[..m * m], &self.factor[..m * m]];
            for (kept, part) in descent.first.iter_mut().zip(parts) {
                kept.clear();
                kept.extend_from_slice(part);
            }
            for _ in 1..iterations {
                if !result.holds.all() {
                    break;
                }
                let Target { design, belief, checks, .. } = &mut *target;
                descent.at.copy_from_slice(&belief.mean);
                belief.copy_from(&descent.prior);
                let Self { expected, active, .. } = self;
                expected.derivatives.take(level, &design.model, &descent.at, &observation.input);
                expected.linearise(level, m, design, belief, active, observation.input.force, Some(&descent.at));
                let number = self.compare(level, m, observation);
                result.holds = self.correct(level, m, design, belief, number, checks).holds;
                // No component has moved by more than 1e-6 of its standard deviation.
                let has_converged = (0..belief.size()).all(|i| {
                    let moved = belief.mean[i] - descent.at[i];
                    (moved * moved).le(belief.cov[i * (belief.size() + 1)] * CONVERGED).all()
                });
                if has_converged {
                    break;
                }
            }
        }
        self.note(design);
        if let Some(Descent { first: [innovation, innovation_cov, factor], .. }) =
            descent.as_deref().filter(|_| reads_rates)
        {
            self.innovation[..m].copy_from_slice(innovation);
            self.innovation_cov[..m * m].copy_from_slice(innovation_cov);
            self.factor[..m * m].copy_from_slice(factor);
        }
        self.descent = descent;
        result
    }

    fn note(&mut self, design: &Design<impl Dynamics>) {
        let Some(mut passage) = self.passage.take() else { return };
        let [innovation, innovation_cov, gain] = self.parts();
        for (own, part) in [
            (&mut passage.innovation, innovation),
            (&mut passage.innovation_cov, innovation_cov),
            (&mut passage.gain, gain),
        ] {
            own.clear();
            own.extend_from_slice(part);
        }
        passage.jacobian.clear();
        if self.expected.is_linear {
            passage.jacobian.resize(gain.len(), T::of(0.0));
            for (row, &sensor) in self.active.iter().enumerate() {
                let out = passage.jacobian.iter_mut().skip(row).step_by(self.active.len());
                self.expected.row_into(&design.readings[sensor], row, out);
            }
        }
        self.passage = Some(passage);
    }
}
