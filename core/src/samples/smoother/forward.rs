//! A filter on its way forward, and its way back: the modified Bryson-Frazier smoother runs the adjoint of the filter backward.
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

use crate::data::record::{Delays, Parts};
use crate::mathematics::engine::level::Baseline;
use crate::mathematics::engine::passage;
use crate::mathematics::filter::{FilterError, Gaussian, kalman};
use crate::mathematics::linalg::{Ldl, Matrix, Vector, symmetric};
use crate::samples::estimator::FilterContext;
use crate::samples::estimator::bounded::{Truncating, Truncation};
use crate::samples::estimator::engine::Followed;
use crate::samples::estimator::setup::Setup;
use crate::samples::sink::Sample;
use crate::{Estimates, FilterSettings, Quantity, Record};

/// A filter whose beliefs are smoothed later.
pub(crate) struct Forward {
    followed: Followed<Baseline>,
    delays: Delays,
    sensors: Vec<Quantity>,
    truncation: Truncation,
    /// Memory for the parts of a step, of a filter that goes from one reading to the next.
    parts: Option<Box<Parts>>,
    /// The samples so far.
    count: usize,
}

/// The passage of a filter from one sample to the next.
#[derive(Clone, Debug)]
pub(crate) struct Passage {
    /// Φ, n × n.
    pub(super) transition: Matrix,
    /// The update at the latter sample. `None` if nothing was measured.
    pub(super) update: Option<Update>,
}

/// An update by m measurements.
#[derive(Clone, Debug)]
pub(super) struct Update {
    /// `I - K H`, n × n.
    pub(super) kept: Matrix,
    /// `Hᵀ S⁻¹ H`, n × n.
    pub(super) information: Matrix,
    /// `Hᵀ S⁻¹ e`, n numbers.
    pub(super) score: Vector,
}

impl Passage {
    /// From the engine's.
    ///
    /// # Errors
    /// Those of [`kalman::factor`].
    pub(crate) fn new(of: &passage::Passage<f64>) -> Result<Self, FilterError> {
        let (n, m) = (of.predicted.len().isqrt(), of.innovation.len());
        let update = if m > 0 { Some(Update::new(of, n, m)?) } else { None };
        Ok(Self { transition: Matrix::from_column_slice(n, n, &of.transition), update })
    }
}

impl Update {
    fn new(of: &passage::Passage<f64>, n: usize, m: usize) -> Result<Self, FilterError> {
        let innovation_cov = symmetric(Matrix::from_column_slice(m, m, &of.innovation_cov));
        let gain = Matrix::from_column_slice(n, m, &of.gain);
        let transposed = if of.jacobian.is_empty() {
            let predicted = symmetric(Matrix::from_column_slice(n, n, &of.predicted));
            Ldl::semidefinite(&predicted).divide(&(&innovation_cov * gain.transpose())).transpose()
        } else {
            Matrix::from_column_slice(m, n, &of.jacobian).transpose()
        };
        let weighted = kalman::factor(&innovation_cov)?.divide(&transposed);
        Ok(Self {
            kept: Matrix::identity(n, n) - gain * transposed.transpose(),
            information: &weighted * transposed.transpose(),
            score: weighted * Vector::from_column_slice(&of.innovation),
        })
    }
}

impl Forward {
    /// The filter with these settings before its first sample. `None` if it cannot begin, or is not of the engine.
    pub(crate) fn new(settings: &FilterSettings, context: &FilterContext) -> Option<Self> {
        let setup = Setup::of(settings, context, (0..context.sensors.len()).collect())?;
        let mut followed = Followed::new(Baseline, &setup, settings);
        followed.filter.keep_passages();
        Some(Self {
            followed,
            truncation: Truncation::of(settings, &setup.channels),
            parts: context.is_timed.then(Box::default),
            delays: settings.delays(context.dt),
            sensors: context.sensors.clone(),
            count: 0,
        })
    }

    /// The belief after the next sample, which is sample `k` of those that the record keeps, and the passages to it, one after the
    /// other: none for the first one, where the filter begins.
    ///
    /// # Errors
    /// Those of the filter.
    pub(crate) fn filter(&mut self, record: &Record, k: usize) -> Result<(Gaussian, Vec<Passage>), FilterError> {
        self.count += 1;
        let mut passages = Vec::new();
        if let Some(before) = self.count.checked_sub(2) {
            self.followed.pluck([before, before + 1].map(|sample| record.dt() * sample as f64));
            let Self { followed, delays, sensors, parts, .. } = self;
            if let Some(parts) = parts {
                let column = |quantity| record.sensors().iter().position(|other| other == quantity);
                let columns: Vec<usize> = sensors.iter().filter_map(column).collect();
                record.parts_to(k, delays, &columns, parts);
                for (part, readings) in parts.iter() {
                    passages.push(pass(followed, part.share, part.forces, part.force, readings)?);
                }
            } else {
                let forces = [k.saturating_sub(1), k].map(|k| record.delayed_force(k, delays.input));
                passages.push(pass(followed, 1.0, forces, forces[1], &record.sample(k, sensors, delays))?);
            }
        }
        Ok((self.followed.gaussian(), passages))
    }

    /// Appends a belief in the channels' units.
    pub(crate) fn report(&mut self, belief: &Gaussian, estimates: &mut Estimates) {
        let Self { followed, truncation, .. } = self;
        let sample = Sample::unmeasured(belief.mean.as_slice(), belief.cov.as_slice());
        followed.report_of(sample, &mut Truncating { truncation, sink: estimates });
    }
}

/// Takes a filter over a share of a step and its readings.
fn pass(
    followed: &mut Followed<Baseline>,
    share: f64,
    forces: [f64; 2],
    force: f64,
    readings: &[f64],
) -> Result<Passage, FilterError> {
    followed.filter.begin_passage();
    followed.predict(share, forces)?;
    followed.condition(force, readings)?;
    followed.filter.passage().map_or(Err(FilterError::NotFinite), Passage::new)
}

/// The information in all later measurements about a state: `λ`, n numbers, and `Λ`, n × n.
pub(crate) struct Adjoint {
    pub(super) score: Vector,
    pub(super) information: Matrix,
}

impl Adjoint {
    /// No later measurement, about a state of n components.
    pub(crate) fn nothing(n: usize) -> Self {
        Self { score: Vector::zeros(n), information: Matrix::zeros(n, n) }
    }

    /// Adds what it knows to the belief of a filter.
    pub(crate) fn tell(&self, Gaussian { mean, cov }: &mut Gaussian) {
        *mean -= &*cov * &self.score;
        let mut told = self.information.clone();
        congruence(&mut told, cov);
        *cov -= told;
        for i in 0..cov.nrows() {
            // Zero up to rounding.
            cov[(i, i)] = cov[(i, i)].max(0.0);
        }
    }

    /// Goes back over an update, then over the step before it.
    pub(crate) fn pass(&mut self, Passage { transition, update }: &Passage) {
        let Self { score, information } = self;
        if let Some(Update { kept, information: gained, score: told }) = update {
            *score = kept.tr_mul(score) - told;
            congruence(information, kept);
            *information += gained;
        }
        *score = transition.tr_mul(score);
        congruence(information, transition);
    }
}

/// Replaces the symmetric X by `Aᵀ X A`.
pub(super) fn congruence(x: &mut Matrix, a: &Matrix) {
    *x = symmetric(a.tr_mul(&(&*x * a)));
}
