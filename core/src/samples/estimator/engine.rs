//! A filter of the engine for one run, reporting to its estimates.

use crate::FilterError;
use crate::data::record::Parts as PartsOfStep;
use crate::mathematics::engine::belief::Belief;
use crate::mathematics::engine::columns::mirror;
use crate::mathematics::engine::design::Method;
use crate::mathematics::engine::filter::{Filter, Parts};
use crate::mathematics::engine::level::{Baseline, Known, Level};
use crate::mathematics::filter::robust::Robust;
use crate::samples::estimator::Estimator;
use crate::samples::estimator::in_units::InUnits;
use crate::samples::estimator::setup::Setup;
use crate::samples::estimator::setup::filter;
use crate::samples::sink::{AssumedNoise, Sample, Sink};

/// A filter, and memory for its reports.
struct Followed<L> {
    filter: Filter<f64, L>,
    /// The place of each sensor that the model has, among all sensors.
    places: Vec<usize>,
    measured: Vec<f64>,
    /// The belief before the update, where the sink wants it.
    prior: Belief<f64>,
    /// Innovation, its covariance and the gain, of all sensors.
    told: Told,
    /// Where the state has logarithms.
    in_units: Option<Box<InUnits>>,
    /// The diagonal of Q, of a filter that learns its noise.
    process: Vec<f64>,
}

/// The result of an update, for all m sensors: e, m numbers; S, m × m; K, n × m.
struct Told {
    innovation: Vec<f64>,
    innovation_cov: Vec<f64>,
    gain: Vec<f64>,
}

/// The filter of a setup, on a record with `sensors` sensors.
pub(crate) fn estimator(setup: &Setup, sensors: usize) -> Box<dyn Estimator> {
    let model = &setup.design.model;
    if matches!(setup.design.method, Method::SquareRoot(_)) {
        return of(Baseline, setup, sensors);
    }
    match (model.size, model.moving()) {
        (4, 2) => of(Known::<_, 4, 2>(Baseline), setup, sensors),
        (5, 2) => of(Known::<_, 5, 2>(Baseline), setup, sensors),
        _ => of(Baseline, setup, sensors),
    }
}

fn of<L: Level + Send + 'static>(level: L, setup: &Setup, sensors: usize) -> Box<dyn Estimator> {
    let (n, nan) = (setup.design.model.size, f64::NAN);
    let filter = filter(level, |_| setup);
    Box::new(Followed {
        prior: filter.belief.clone(),
        filter,
        places: setup.columns.clone(),
        measured: vec![nan; setup.columns.len()],
        told: Told {
            innovation: vec![nan; sensors],
            innovation_cov: vec![nan; sensors * sensors],
            gain: vec![0.0; n * sensors],
        },
        in_units: InUnits::new(&setup.design.model.logarithms, n, sensors),
        process: Vec::new(),
    })
}

impl<L: Level + Send> Estimator for Followed<L> {
    fn begin(&self, sink: &mut dyn Sink) -> Result<(), FilterError> {
        let Self { filter, told, in_units, .. } = self;
        let (parts, mut process) = (filter.parts(), Vec::new());
        let unmeasured = told.sample(parts.belief, [f64::NAN; 2]);
        let sample = if sink.wants_prior() { unmeasured.with_prior(parts.belief) } else { unmeasured };
        let mut in_units = in_units.clone();
        push(sample.with_learnt(&parts, &mut process), in_units.as_deref_mut(), sink).map_err(|_| FilterError::TooLarge)
    }

    fn step(
        &mut self,
        force_before: f64,
        force: f64,
        measured: &[f64],
        sink: &mut dyn Sink,
    ) -> Result<(), FilterError> {
        let Self { filter, places, measured: own, prior, told: all, in_units, .. } = self;
        // Where the force is held, its end does not count.
        if !filter.are_finite([force_before, force]) {
            return Err(FilterError::UndefinedForce);
        }
        filter.predict([force_before, force]);
        let wants_prior = sink.wants_prior();
        if wants_prior {
            keep(filter, prior);
        }
        let squares = update(filter, places, own, force, measured)?;
        if filter.learns() {
            return self.report_learnt(squares, sink);
        }
        let m = all.innovation.len();
        let (belief, update) = filter.told();
        let sample = if update.active().len() == m {
            update.complete();
            let [innovation, innovation_cov, gain] = update.parts();
            let unmeasured = Sample::unmeasured(&belief.mean, &belief.cov);
            let [nis, determinant] = squares;
            Sample { innovation, innovation_cov, gain, nis, determinant, ..unmeasured }
        } else {
            all.clear();
            all.add(places, update.active(), update.parts());
            all.sample(belief, squares)
        };
        push(if wants_prior { sample.with_prior(prior) } else { sample }, in_units.as_deref_mut(), sink)
    }

    /// The belief before the update is that before the last reading.
    fn step_through(&mut self, parts: &PartsOfStep, sink: &mut dyn Sink) -> Result<(), FilterError> {
        let Self { filter, places, measured: own, prior, told: all, in_units, .. } = self;
        let (wants_prior, mut has_prior) = (sink.wants_prior(), false);
        let (mut squares, mut earlier) = ([f64::NAN; 2], 0);
        all.clear();
        for (part, readings) in parts.iter() {
            if !part.forces.iter().all(|force| force.is_finite()) {
                return Err(FilterError::UndefinedForce);
            }
            filter.predict_share(part.share, part.forces);
            let is_read = readings.iter().any(|reading| !reading.is_nan());
            if is_read && wants_prior {
                keep(filter, prior);
                has_prior = true;
            }
            let [nis, determinant] = update(filter, places, own, part.force, readings)?;
            if !nis.is_nan() {
                let [all_nis, all_determinant] = squares;
                let is_first = all_nis.is_nan();
                squares = if is_first { [nis, determinant] } else { [all_nis + nis, all_determinant * determinant] };
                let (_, update) = filter.told();
                earlier += all.add(places, update.active(), update.parts());
            }
        }
        let (belief, _) = filter.told();
        if wants_prior && !has_prior {
            prior.copy_from(belief);
        }
        let sample = Sample { earlier, ..all.sample(belief, squares) };
        push(if wants_prior { sample.with_prior(prior) } else { sample }, in_units.as_deref_mut(), sink)
    }
}

/// Keeps the belief after a prediction.
fn keep<L: Level>(filter: &mut Filter<f64, L>, prior: &mut Belief<f64>) {
    filter.square();
    prior.copy_from(filter.told().0);
    mirror(Baseline, &mut prior.cov, prior.mean.len());
}

/// Updates by the measurements of all sensors, of which `own` takes those that the model has. Returns NIS and det S; NaN without a
/// measurement.
#[inline(always)]
fn update<L: Level>(
    filter: &mut Filter<f64, L>,
    places: &[usize],
    own: &mut [f64],
    force: f64,
    measured: &[f64],
) -> Result<[f64; 2], FilterError> {
    let mut is_infinite = false;
    for (own, &place) in own.iter_mut().zip(places) {
        *own = measured[place];
        is_infinite |= own.is_infinite();
    }
    if is_infinite && filter.is_predicted(0) {
        return Err(FilterError::InfiniteMeasurement);
    }
    let told = filter.update(force, own);
    if !told.holds {
        return Err(filter.reason(0));
    }
    filter.complete();
    Ok(if told.measured > 0.0 { [told.nis, told.determinant] } else { [f64::NAN; 2] })
}

impl<L: Level> Followed<L> {
    /// Hands over the update of a filter that weighs, learns or jumps, with its NIS and det S.
    #[inline(never)]
    fn report_learnt(&mut self, squares: [f64; 2], sink: &mut dyn Sink) -> Result<(), FilterError> {
        let Self { filter, places, prior, told, in_units, process, .. } = self;
        let parts = filter.parts();
        let active = parts.update.active();
        told.clear();
        told.add(places, active, parts.update.parts());
        let weights = parts.learnt.and_then(|learnt| learnt.weights);
        if let Some(weights) = weights.filter(|weights| active.iter().any(|sensor| weights[*sensor] != 1.0)) {
            told.claim(active, weights, &parts.noise.sensors);
        }
        let sample = told.sample(parts.belief, squares).with_learnt(&parts, process);
        push(if sink.wants_prior() { sample.with_prior(prior) } else { sample }, in_units.as_deref_mut(), sink)
    }
}

/// Hands a sample to the sink, in the channels' units.
#[inline(always)]
fn push(sample: Sample<'_>, in_units: Option<&mut InUnits>, sink: &mut dyn Sink) -> Result<(), FilterError> {
    let sample =
        if let Some(in_units) = in_units { in_units.convert(sample).ok_or(FilterError::NotFinite)? } else { sample };
    sink.push(&sample);
    Ok(())
}

impl<'a> Sample<'a> {
    /// With what a filter that learns tells besides. `process` is memory.
    fn with_learnt(self, parts: &Parts<'a>, process: &'a mut Vec<f64>) -> Self {
        let Some(learnt) = parts.learnt else { return self };
        let noise = parts.is_adaptive.then(|| {
            process.clear();
            process.extend(parts.noise.diagonal());
            parts.white.into_iter().for_each(|(place, variance)| process[place] = variance);
            AssumedNoise {
                process,
                sensors: &parts.noise.sensors,
                uncertainty: learnt.uncertainty,
                process_scale: [f64::NAN; 2],
            }
        });
        Self { noise, weights: learnt.weights.unwrap_or_default(), has_widened: learnt.has_widened, ..self }
    }

    pub(super) fn with_prior(self, prior: &'a Belief<f64>) -> Self {
        Self { prior_mean: &prior.mean, prior_cov: &prior.cov, ..self }
    }
}

impl Told {
    /// No update.
    fn clear(&mut self) {
        self.innovation.fill(f64::NAN);
        self.innovation_cov.fill(f64::NAN);
        self.gain.fill(0.0);
    }

    /// Takes in an update by some sensors, each in its place, after those that it has, of which it is independent. Returns how many of
    /// the sensors were in them.
    #[inline(never)]
    fn add(&mut self, places: &[usize], active: &[usize], [innovation, innovation_cov, gain]: [&[f64]; 3]) -> u32 {
        let m = self.innovation.len();
        let (count, n) = (active.len(), self.gain.len() / m.max(1));
        let mut earlier = 0;
        for (i, &row) in active.iter().enumerate() {
            let row = places[row];
            earlier += u32::from(!self.innovation[row].is_nan());
            self.innovation[row] = innovation[i];
            self.gain[row * n..(row + 1) * n].copy_from_slice(&gain[i * n..(i + 1) * n]);
            for other in (0..m).filter(|other| !self.innovation[*other].is_nan()) {
                (self.innovation_cov[other * m + row], self.innovation_cov[row * m + other]) = (0.0, 0.0);
            }
        }
        for (i, &row) in active.iter().enumerate() {
            for (j, &column) in active.iter().enumerate() {
                let entry = innovation_cov[i.min(j) * count + i.max(j)];
                self.innovation_cov[places[column] * m + places[row]] = entry;
            }
        }
        earlier
    }

    /// S with the R of the settings, which is what they claim. A reading that counts next to nothing is reported as none.
    fn claim(&mut self, active: &[usize], weights: &[f64], variances: &[f64]) {
        let m = self.innovation.len();
        for &sensor in active {
            let (own, weight) = (variances[sensor], weights[sensor]);
            if weight >= Robust::LEFT_OUT {
                self.innovation_cov[sensor * (m + 1)] += own - own / weight;
                continue;
            }
            self.innovation[sensor] = f64::NAN;
            for other in 0..m {
                self.innovation_cov[sensor * m + other] = f64::NAN;
                self.innovation_cov[other * m + sensor] = f64::NAN;
            }
        }
    }

    fn sample<'a>(&'a self, belief: &'a Belief<f64>, [nis, determinant]: [f64; 2]) -> Sample<'a> {
        let Self { innovation, innovation_cov, gain } = self;
        let unmeasured = Sample::unmeasured(&belief.mean, &belief.cov);
        Sample { innovation, innovation_cov, gain, nis, determinant, ..unmeasured }
    }
}
