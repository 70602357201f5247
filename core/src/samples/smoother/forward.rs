//! A filter on its way forward, with all that a way back needs.

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
    pub(crate) fn new(settings: &FilterSettings, context: &FilterContext<'_>) -> Option<Self> {
        let setup = Setup::of(settings, context, (0..context.sensors.len()).collect())?;
        let mut followed = Followed::new(Baseline, &setup, settings);
        followed.filter.keep_passages();
        Some(Self {
            followed,
            truncation: Truncation::of(settings, &setup.channels),
            parts: context.is_timed.then(Box::default),
            delays: settings.delays(context.dt),
            sensors: context.sensors.to_vec(),
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
