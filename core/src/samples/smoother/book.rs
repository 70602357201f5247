//! The modified Bryson-Frazier smoother: it runs the adjoint of the filter backward.
//!
//! ```text
//! Λ̂ₖ = Φᵀ Λ̃ₖ₊₁ Φ,                          λ̂ₖ = Φᵀ λ̃ₖ₊₁,  both zero at the last sample
//! Λ̃ₖ = Hᵀ S⁻¹ H + (I - K H)ᵀ Λ̂ₖ (I - K H),  λ̃ₖ = (I - K H)ᵀ λ̂ₖ - Hᵀ S⁻¹ e
//! Pₖˢ = Pₖ - Pₖ Λ̂ₖ Pₖ,                       yₖˢ = yₖ - Pₖ λ̂ₖ
//! ```
//!
//! In exact arithmetic it is the smoother of Rauch, Tung and Striebel, `G = Pₖ Φᵀ (P⁻ₖ₊₁)⁻¹`. But that one divides by a
//! covariance, which becomes singular where a motion dies out and has no process noise: G then grows as the motion
//! decays, so that the rounding of later samples grows backward until it is as large as the result. The adjoint decays
//! backward as the motion does forward, and needs no inverse but that of S.
//!
//! Φ and H are those that the filter linearises with. Those of sigma points are regressions on the state, of the next
//! state and of the readings: with them `cov(next, now) = Φ P` and `K S = P⁻ Hᵀ`, which is all that both smoothers
//! need. For an update without an H, division by P⁻ gives it; directions that P⁻ has lost are left out.
//!
//! Fading counts as process noise here: `P⁻ = λ Φ P Φᵀ + Q` is a step with the noise `(λ - 1) Φ P Φᵀ + Q`. So does what a
//! jump ([`crate::mathematics::filter::jump`]) adds to P⁻.
//!
//! Source: Bierman (1973), Fixed interval smoothing with discrete measurements; Rauch, Tung and Striebel (1965), Maximum
//! likelihood estimates of linear dynamic systems; Särkkä (2008), Unscented Rauch-Tung-Striebel smoother.

use crate::mathematics::filter::correction::Last;
use crate::mathematics::filter::kalman;
use crate::mathematics::filter::{Correction, Filter, FilterError, Gaussian, Part};
use crate::mathematics::linalg::{Ldl, Matrix, Vector, multiply, multiply_symmetric};
use crate::samples::estimator::FilterContext;
use crate::samples::estimator::book::{InUnits, build_filter, initial_belief};
use crate::samples::sink::Sample;
use crate::samples::smoother::Beliefs;
use crate::{Estimates, FilterSettings, Quantity, Record};

/// The beliefs of a filter with these settings. `None` if the filter cannot begin.
pub(crate) fn beliefs(settings: &FilterSettings, context: &FilterContext<'_>) -> Option<Box<dyn Beliefs>> {
    let filter = build_filter(initial_belief(settings, context).ok()?, settings, context);
    let filter = if settings.jump { filter.with_jump() } else { filter };
    let sensors = context.sensors.to_vec();
    Some(Box::new(Smoothed {
        filter,
        sensors,
        correction: Correction::default(),
        filtered: Vec::new(),
        steps: Vec::new(),
        adjoint: Adjoint { score: Vector::zeros(0), information: Matrix::zeros(0, 0) },
        in_units: InUnits::default(),
    }))
}

struct Smoothed {
    filter: Filter,
    sensors: Vec<Quantity>,
    correction: Correction,
    /// The belief after each sample: of the filter, then of the smoother.
    filtered: Vec<Gaussian>,
    /// From each sample to the next.
    steps: Vec<Passage>,
    adjoint: Adjoint,
    in_units: InUnits,
}

/// The passage of a filter from one sample to the next.
struct Passage {
    /// Φ, n × n.
    transition: Matrix,
    /// The update at the latter sample. `None` if nothing was measured.
    update: Option<Update>,
}

/// An update by m measurements.
struct Update {
    /// `I - K H`, n × n.
    kept: Matrix,
    /// `Hᵀ S⁻¹ H`, n × n.
    information: Matrix,
    /// `Hᵀ S⁻¹ e`, n numbers.
    score: Vector,
}

impl Update {
    /// The last update of `correction`, with `predicted`, the covariance before it.
    ///
    /// # Errors
    /// Those of [`kalman::factor`].
    fn new(correction: &Correction, predicted: &Matrix) -> Result<Self, FilterError> {
        let Last { innovation, innovation_cov, gain, jacobian, has_jacobian, .. } = &correction.last;
        let transposed = if *has_jacobian {
            jacobian.transpose()
        } else {
            Ldl::semidefinite(predicted).divide(&(innovation_cov * gain.transpose())).transpose()
        };
        let weighted = kalman::factor(innovation_cov)?.divide(&transposed);
        let n = predicted.nrows();
        Ok(Self {
            kept: Matrix::identity(n, n) - gain * transposed.transpose(),
            information: &weighted * transposed.transpose(),
            score: weighted * innovation,
        })
    }
}

/// The information in all later measurements about a state: `λ`, n numbers, and `Λ`, n × n.
struct Adjoint {
    score: Vector,
    information: Matrix,
}

impl Adjoint {
    /// Goes back over an update, then over the step before it.
    fn pass(&mut self, Passage { transition, update }: &Passage) {
        let Self { score, information } = self;
        let mut work = Matrix::zeros(0, 0);
        if let Some(Update { kept, information: gained, score: told }) = update {
            *score = kept.tr_mul(score) - told;
            congruence(information, kept, &mut work);
            *information += gained;
        }
        *score = transition.tr_mul(score);
        congruence(information, transition, &mut work);
    }
}

/// Replaces the symmetric X by `Aᵀ X A`; `work` is scratch memory.
fn congruence(x: &mut Matrix, a: &Matrix, work: &mut Matrix) {
    multiply(work, x, a);
    let transposed = a.transpose();
    multiply_symmetric(x, 1.0, &transposed, &work.transpose());
    x.fill_upper_triangle_with_lower_triangle();
}

impl Beliefs for Smoothed {
    fn len(&self) -> usize {
        self.filtered.len()
    }

    fn filter(&mut self, forces: [f64; 2], record: &Record, k: usize) -> Result<(), FilterError> {
        let Self { filter, sensors, correction, filtered, steps, .. } = self;
        if k == 0 {
            // Reserves memory now: growing a large vector copies it, which takes long.
            filtered.reserve(record.len());
            steps.reserve(record.len());
        } else {
            let n = filter.model().size();
            let mut transition = Matrix::identity(n, n);
            filter.predict_by(forces, |model, belief, part| {
                match part {
                    Part::Step(step) => transition = belief.transition(model, step)? * &transition,
                    Part::Renewal(place) => transition.row_mut(place).fill(0.0),
                }
                Ok(())
            })?;
            let predicted = filter.belief().gaussian().into_owned();
            filter.update(forces[1], &record.sample(k, sensors), correction)?;
            let is_updated = correction.innovation.iter().any(|e| !e.is_nan());
            let update = if is_updated { Some(Update::new(correction, &predicted.cov)?) } else { None };
            steps.push(Passage { transition, update });
        }
        filtered.push(filter.belief().gaussian().into_owned());
        Ok(())
    }

    fn smooth(&mut self, k: usize) {
        let Self { filtered, steps, adjoint, .. } = self;
        if k + 1 == steps.len() {
            let n = filtered[k].size();
            *adjoint = Adjoint { score: Vector::zeros(n), information: Matrix::zeros(n, n) };
        }
        adjoint.pass(&steps[k]);
        let Gaussian { mean, cov } = &mut filtered[k];
        *mean -= &*cov * &adjoint.score;
        let mut told = adjoint.information.clone();
        congruence(&mut told, cov, &mut Matrix::zeros(0, 0));
        *cov -= told;
        for i in 0..cov.nrows() {
            // Zero up to rounding.
            cov[(i, i)] = cov[(i, i)].max(0.0);
        }
    }

    fn free(&mut self, samples: usize) -> bool {
        let Self { filtered, steps, .. } = self;
        let end = filtered.len().saturating_sub(samples);
        let had_any = !filtered.is_empty();
        filtered.truncate(end);
        steps.truncate(end);
        had_any
    }

    fn report(&self, k: usize, estimates: &mut Estimates) {
        let mut in_units = self.in_units.clone();
        in_units.take(self.filter.model(), &self.filtered[k], &Matrix::zeros(self.filtered[k].size(), 0));
        let Gaussian { mean, cov } = &in_units.belief;
        estimates.append(&Sample::unmeasured(mean.as_slice(), cov.as_slice()));
    }
}
