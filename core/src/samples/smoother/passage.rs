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

use crate::mathematics::engine::belief::Belief;
use crate::mathematics::engine::{self, passage};
use crate::mathematics::filter::{FilterError, Gaussian, kalman};
use crate::mathematics::linalg::{Ldl, Matrix, Vector, symmetric};
use crate::samples::estimator::FilterContext;
use crate::samples::estimator::bounded::{Truncating, Truncation};
use crate::samples::estimator::in_units::InUnits;
use crate::samples::sink::{Sample, Sink};
use crate::{Estimates, FilterSettings, Pass, Record, Stop};

/// A filter whose beliefs are smoothed later: a pass over the record, which keeps its passages.
pub(crate) struct Forward {
    pass: Pass,
    sink: Passages,
    hindsight: Hindsight,
}

/// The passages of a filter from one sample to the next, and its belief there.
#[derive(Default)]
pub struct Passages {
    pub(crate) belief: Option<Gaussian>,
    /// Each part of the step that ends with a reading, and its last one.
    pub(crate) all: Vec<Passage>,
    stop: Option<Stop>,
}

/// Smoothed beliefs in the units of the channels, between their bounds.
pub(crate) struct Hindsight {
    in_units: Option<Box<InUnits>>,
    truncation: Truncation,
}

impl Forward {
    /// The filter with these settings before its first sample, over sensors in these columns of a record. `None` if it has no passages.
    pub(crate) fn new(settings: &FilterSettings, context: &FilterContext, sensors: Vec<usize>) -> Option<Self> {
        let one = FilterSettings { guesses: 1, process_scales: 1, walk: 0.0, ..settings.clone() };
        let pass = Pass::with_passages(&one, context, sensors)?;
        Some(Self { pass, sink: Passages::default(), hindsight: Hindsight::new(settings, context) })
    }

    /// The belief after the next sample, and the passages to it, one after the other: none for the first one, where the filter begins.
    ///
    /// # Errors
    /// Where and why the filter stops.
    pub(crate) fn filter(&mut self, record: &Record) -> Result<(Gaussian, Vec<Passage>), Stop> {
        let Self { pass, sink, .. } = self;
        pass.follow(record, pass.done() + 1, sink);
        let passages = std::mem::take(&mut sink.all);
        match (sink.stop, sink.belief.take()) {
            (None, Some(belief)) => Ok((belief, passages)),
            (stop, _) => Err(stop.unwrap_or(Stop { sample: pass.done(), reason: FilterError::NotFinite })),
        }
    }

    /// Appends a belief in the channels' units.
    pub(crate) fn report(&mut self, belief: &Gaussian, estimates: &mut Estimates) {
        self.hindsight.report(belief, estimates);
    }
}

impl Hindsight {
    pub(crate) fn new(settings: &FilterSettings, context: &FilterContext) -> Self {
        let model = context.model(settings);
        let in_units = InUnits::new(&engine::model::Model::of(&model).logarithms, model.size(), 0);
        Self { in_units, truncation: Truncation::of(settings, model.channels()) }
    }

    /// Hands a belief to a sink, whatever its numbers are in the channels' units.
    pub(crate) fn report(&mut self, Gaussian { mean, cov }: &Gaussian, sink: &mut dyn Sink) {
        let Self { in_units, truncation } = self;
        let sample = Sample::unmeasured(mean.as_slice(), cov.as_slice());
        let mut sink = Truncating { truncation, sink };
        match in_units.as_deref_mut() {
            Some(in_units) => sink.push(&in_units.take(sample).0),
            None => sink.push(&sample),
        }
    }
}

impl Passages {
    pub(crate) fn begin(&mut self, belief: &Belief<f64>) {
        self.belief = Some(Gaussian::of(belief));
    }

    /// Adds the passage to a belief.
    ///
    /// # Errors
    /// Those of [`kalman::factor`].
    pub(crate) fn add(&mut self, passage: &passage::Passage<f64>, belief: &Belief<f64>) -> Result<(), FilterError> {
        self.all.push(Passage::new(passage)?);
        self.begin(belief);
        Ok(())
    }
}

impl Sink for Passages {
    fn push(&mut self, _: &Sample<'_>) {}

    fn stop_at(&mut self, stop: Stop) {
        self.stop = Some(stop);
    }

    fn passages(&mut self) -> Option<&mut Passages> {
        Some(self)
    }
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
    fn new(of: &passage::Passage<f64>) -> Result<Self, FilterError> {
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
