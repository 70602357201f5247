//! A filter on its way forward, with all that a way back needs.

use crate::data::record::{Delays, Parts};
use crate::mathematics::filter::correction::Last;
use crate::mathematics::filter::share::Share;
use crate::mathematics::filter::{Correction, Filter, FilterError, Gaussian, Part, kalman};
use crate::mathematics::linalg::{Ldl, Matrix, Vector};
use crate::samples::estimator::FilterContext;
use crate::samples::estimator::book::{InUnits, build_filter, initial_belief};
use crate::samples::estimator::bounded::Truncation;
use crate::samples::plucks::Plucks;
use crate::samples::sink::Sample;
use crate::{Estimates, FilterSettings, Quantity, Record};

/// A filter whose beliefs are smoothed later.
pub(crate) struct Forward {
    filter: Filter,
    delays: Delays,
    sensors: Vec<Quantity>,
    correction: Correction,
    in_units: InUnits,
    truncation: Truncation,
    /// Of a filter that goes from one reading to the next.
    timed: Option<Box<Timed>>,
    plucks: Plucks,
    /// The samples so far.
    count: usize,
}

/// What a filter needs that goes from one reading to the next.
struct Timed {
    of_share: Share,
    parts: Parts,
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
    /// By a transition and the update after it, with `predicted`, the covariance between them.
    ///
    /// # Errors
    /// Those of [`kalman::factor`].
    pub(crate) fn new(transition: Matrix, correction: &Correction, predicted: &Matrix) -> Result<Self, FilterError> {
        let is_updated = correction.innovation.iter().any(|e| !e.is_nan());
        Ok(Self { transition, update: if is_updated { Some(Update::new(correction, predicted)?) } else { None } })
    }
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

impl Forward {
    /// The filter with these settings before its first sample. `None` if it cannot begin.
    pub(crate) fn new(settings: &FilterSettings, context: &FilterContext<'_>) -> Option<Self> {
        let filter = build_filter(initial_belief(settings, context).ok()?, settings, context);
        let truncation = Truncation::of(settings, filter.model().channels());
        Some(Self {
            truncation,
            plucks: Plucks::new(settings, filter.model(), context.start),
            timed: context.is_timed.then(|| {
                let of_share = Share::new(filter.noise().clone(), filter.model().size());
                Box::new(Timed { of_share, parts: Parts::default() })
            }),
            filter: if settings.jump { filter.with_jump() } else { filter },
            delays: settings.delays(context.dt),
            sensors: context.sensors.to_vec(),
            correction: Correction::default(),
            in_units: InUnits::default(),
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
        let Some(before) = self.count.checked_sub(2) else {
            return Ok((self.filter.belief().gaussian().into_owned(), Vec::new()));
        };
        self.plucks.pass(&mut self.filter, [before, before + 1].map(|sample| record.dt() * sample as f64))?;
        let passages = match self.timed.take() {
            Some(mut timed) => {
                let passages = self.go_through(&mut timed, record, k);
                self.timed = Some(timed);
                passages?
            }
            None => vec![self.go_on(record, k)?],
        };
        Ok((self.filter.belief().gaussian().into_owned(), passages))
    }

    /// Goes through the parts of the step to a sample.
    fn go_through(&mut self, timed: &mut Timed, record: &Record, k: usize) -> Result<Vec<Passage>, FilterError> {
        let Self { filter, delays, sensors, correction, .. } = self;
        let Timed { of_share, parts } = timed;
        let columns: Vec<usize> =
            sensors.iter().filter_map(|quantity| record.sensors().iter().position(|other| other == quantity)).collect();
        record.parts_to(k, delays, &columns, parts);
        let n = filter.model().size();
        let mut passages = Vec::new();
        for (part, readings) in parts.iter() {
            let mut transition = Matrix::identity(n, n);
            filter.predict_share(part.share, part.forces, of_share, |model, belief, step| {
                transition = belief.transition(model, step)? * &transition;
                Ok(())
            })?;
            let predicted = filter.belief().gaussian().into_owned();
            filter.update(part.force, readings, correction)?;
            passages.push(Passage::new(transition, correction, &predicted.cov)?);
        }
        Ok(passages)
    }

    /// Goes on to a sample.
    fn go_on(&mut self, record: &Record, k: usize) -> Result<Passage, FilterError> {
        let Self { filter, delays, sensors, correction, .. } = self;
        let forces = [k.saturating_sub(1), k].map(|k| record.delayed_force(k, delays.input));
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
        filter.update(forces[1], &record.sample(k, sensors, delays), correction)?;
        Passage::new(transition, correction, &predicted.cov)
    }

    /// Appends a belief in the channels' units.
    pub(crate) fn report(&mut self, belief: &Gaussian, estimates: &mut Estimates) {
        let Self { filter, in_units, truncation, .. } = self;
        in_units.take(filter.model(), belief, &Matrix::zeros(belief.size(), 0));
        let (mean, cov) = truncation.apply(in_units.belief.mean.as_slice(), in_units.belief.cov.as_slice());
        estimates.append(&Sample::unmeasured(mean, cov));
    }
}
