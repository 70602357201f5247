//! A filter of the engine for one run, reporting its samples.

use crate::data::record::Parts;
use crate::mathematics::engine::belief::Belief;
use crate::mathematics::engine::columns::mirror;
use crate::mathematics::engine::design::Method;
use crate::mathematics::engine::filter::Filter;
use crate::mathematics::engine::level::{Baseline, Known, Level};
use crate::mathematics::engine::update::UpdateResult;
use crate::mathematics::filter::Gaussian;
use crate::mathematics::lists::{mapped, sort_numbers};
use crate::samples::estimator::setup::{Setup, filter};
use crate::samples::estimator::update::{InUnits, Update};
use crate::samples::estimator::{Estimator, State};
use crate::samples::sink::{AssumedNoise, Sample, Sink};
use crate::{Channel, FilterError, FilterSettings};

struct AtLevel<L> {
    level: L,
    followed: FollowedEngine,
}

struct FollowedEngine {
    filter: Filter<f64>,
    /// The place of each sensor that the model has, among all sensors.
    places: Vec<usize>,
    measured: Vec<f64>,
    /// The belief before the update, where it is wanted.
    prior: Belief<f64>,
    update: Update,
    /// One of several updates within a sample.
    part: Update,
    /// Where the state has logarithms.
    in_units: Option<Box<InUnits>>,
    learnt: LearntNoise,
    plucks: Plucks,
    sample: usize,
}

/// The parts of a step, for what is in the program once for all levels.
trait EngineSteps {
    fn predict(&self, filter: &mut Filter<f64>, share: f64, forces: [f64; 2]);

    fn update(&self, filter: &mut Filter<f64>, force: f64, measured: &[f64]) -> UpdateResult<f64>;
}

impl<L: Level> EngineSteps for L {
    #[inline(always)]
    fn predict(&self, filter: &mut Filter<f64>, share: f64, forces: [f64; 2]) {
        filter.predict_share(*self, share, forces);
    }

    #[inline(always)]
    fn update(&self, filter: &mut Filter<f64>, force: f64, measured: &[f64]) -> UpdateResult<f64> {
        let result = filter.update(*self, force, measured);
        if result.holds {
            filter.complete(*self);
        }
        result
    }
}

/// What a filter learns, for all sensors: one that the model lacks keeps its R. The memory of a report.
#[derive(Clone)]
struct LearntNoise {
    process: Vec<f64>,
    sensors: Vec<f64>,
    uncertainty: Vec<f64>,
    weights: Vec<f64>,
}

pub(crate) fn estimator(setup: &Setup, settings: &FilterSettings) -> Box<dyn Estimator> {
    fn boxed<L: Level + Send + 'static>(level: L, followed: FollowedEngine) -> Box<dyn Estimator> {
        Box::new(AtLevel { level, followed })
    }
    let followed = FollowedEngine::new(setup, settings);
    let model = &setup.design.model;
    let is_linearised = matches!(setup.design.method, Method::Linearised(..));
    match (model.size, model.moving()) {
        _ if matches!(setup.design.method, Method::SquareRoot(_)) => boxed(Baseline, followed),
        (4, 2) => boxed(Known::<_, 4, 2>(Baseline), followed),
        (5, 2) => boxed(Known::<_, 5, 2>(Baseline), followed),
        // A page leaves these out, to be smaller.
        #[cfg(not(target_arch = "wasm32"))]
        (8, 3) => boxed(Known::<_, 8, 3>(Baseline), followed),
        _ if !is_linearised => boxed(Baseline, followed),
        #[cfg(not(target_arch = "wasm32"))]
        (7, 4) => boxed(Known::<_, 7, 4>(Baseline), followed),
        #[cfg(not(target_arch = "wasm32"))]
        (10, 6) => boxed(Known::<_, 10, 6>(Baseline), followed),
        _ => boxed(Baseline, followed),
    }
}

impl FollowedEngine {
    fn new(setup: &Setup, settings: &FilterSettings) -> Self {
        let (n, sensors) = (setup.design.model.size, settings.sensor_std.len());
        let filter = filter(&|_| setup);
        let variances = mapped(&settings.sensor_std, &|std| std * std);
        let update = Update::nothing(n, sensors);
        Self {
            prior: filter.belief.clone(),
            filter,
            places: setup.columns.clone(),
            measured: vec![f64::NAN; setup.columns.len()],
            part: update.clone(),
            update,
            in_units: InUnits::new(&setup.design.model.logarithms, n, sensors),
            learnt: LearntNoise {
                process: Vec::new(),
                uncertainty: mapped(&variances, &|r| settings.adaptation.initial_uncertainty(*r)),
                sensors: variances,
                weights: vec![f64::NAN; if settings.robust.is_on() { sensors } else { 0 }],
            },
            plucks: Plucks::new(settings, &setup.channels, setup.start),
            sample: 0,
        }
    }

    fn next_sample(&mut self) {
        self.sample += 1;
        if !self.plucks.times.is_empty() {
            let dt = self.filter.design.dt;
            self.pluck([dt * (self.sample - 1) as f64, dt * self.sample as f64]);
        }
    }

    fn pluck(&mut self, between: [f64; 2]) {
        let Self { plucks, filter, .. } = self;
        if let Some(variances) = plucks.between(between) {
            filter.widen(variances);
        }
    }

    #[inline(always)]
    fn predict(
        &mut self,
        level: &(impl EngineSteps + ?Sized),
        share: f64,
        forces: [f64; 2],
    ) -> Result<(), FilterError> {
        // Where the force is held, its end does not count.
        if !self.filter.are_finite(forces) {
            return Err(FilterError::UndefinedForce);
        }
        level.predict(&mut self.filter, share, forces);
        Ok(())
    }

    fn keep_prior(&mut self) {
        let Self { filter, prior, .. } = self;
        filter.square();
        prior.copy_from(&filter.belief);
        mirror(Baseline, &mut prior.cov, prior.mean.len());
    }

    /// Conditions on readings of all sensors, and keeps the update.
    fn condition(&mut self, level: &dyn EngineSteps, force: f64, readings: &[f64]) -> Result<(), FilterError> {
        self.update.clear();
        self.learnt.weights.fill(f64::NAN);
        self.add(level, force, readings)
    }

    /// The same after earlier readings within the sample.
    fn add(&mut self, level: &dyn EngineSteps, force: f64, readings: &[f64]) -> Result<(), FilterError> {
        let Self { filter, places, measured, .. } = self;
        let [nis, determinant] = condition(level, filter, places, measured, force, readings)?;
        self.take_update([nis, determinant]);
        Ok(())
    }

    #[inline(never)]
    fn take_update(&mut self, squares: [f64; 2]) {
        let Self { filter, places, update, part, learnt, .. } = self;
        let active = &filter.update.active[..];
        part.clear();
        part.take(places, active, filter.update.parts());
        if let Some(weights) = filter.learnt().and_then(|learnt| learnt.weights) {
            if active.iter().any(|sensor| weights[*sensor] != 1.0) {
                part.claim(places, active, weights, &filter.noise.sensors);
            }
            for (&place, weight) in places.iter().zip(weights).filter(|(_, weight)| !weight.is_nan()) {
                learnt.weights[place] = *weight;
            }
        }
        [part.nis, part.determinant] = squares;
        update.add(part);
    }

    /// In the channels' units. Fails where a number overflows in them.
    fn report(&mut self, has_prior: bool, sink: &mut dyn Sink) -> Result<(), FilterError> {
        let Self { filter, places, update, prior, in_units, learnt, .. } = self;
        let sample = learnt.extend(update.sample(&filter.belief.mean, &filter.belief.cov), filter, places);
        push(if has_prior { sample.with_prior(prior) } else { sample }, in_units.as_deref_mut(), sink)
    }

    fn report_beginning(&self, sink: &mut dyn Sink) -> Result<(), FilterError> {
        let Self { filter, places, update, in_units, learnt, .. } = self;
        let mut learnt = learnt.clone();
        let sample = learnt.extend(update.sample(&filter.belief.mean, &filter.belief.cov), filter, places);
        let sample = if sink.wants_prior() { sample.with_prior(&filter.belief) } else { sample };
        push(sample, in_units.clone().as_deref_mut(), sink).map_err(|_| FilterError::TooLarge)
    }

    /// The belief before the update is that before the last reading.
    fn step_through(&mut self, level: &dyn EngineSteps, parts: &Parts, sink: &mut dyn Sink) -> Result<(), FilterError> {
        if parts.times.is_none() {
            self.next_sample();
        }
        let (wants_prior, mut has_prior, mut is_passed) = (sink.wants_prior(), false, false);
        self.update.clear();
        self.learnt.weights.fill(f64::NAN);
        for (place, (part, readings)) in parts.iter().enumerate() {
            if !part.forces.iter().all(|force| force.is_finite()) {
                return Err(FilterError::UndefinedForce);
            }
            if let Some(between) = parts.between(place) {
                self.pluck(between);
            }
            if part.share > 0.0 {
                self.predict(level, part.share, part.forces)?;
            }
            is_passed = readings.iter().any(|reading| !reading.is_nan());
            if is_passed && wants_prior {
                self.keep_prior();
                has_prior = true;
            }
            self.add(level, part.force, readings)?;
            if is_passed {
                pass(&mut self.filter, sink)?;
            }
        }
        if !is_passed {
            pass(&mut self.filter, sink)?;
        }
        if wants_prior && !has_prior {
            self.prior.copy_from(&self.filter.belief);
        }
        self.report(wants_prior, sink)
    }
}

impl<L: Level + Send> Estimator for AtLevel<L> {
    fn begin(&self, sink: &mut dyn Sink) -> Result<(), FilterError> {
        if let Some(passages) = sink.passages() {
            passages.begin(&self.followed.filter.belief);
        }
        self.followed.report_beginning(sink)
    }

    fn step(&mut self, before: f64, force: f64, measured: &[f64], sink: &mut dyn Sink) -> Result<(), FilterError> {
        let Self { level, followed } = self;
        followed.next_sample();
        followed.predict(level, 1.0, [before, force])?;
        let wants_prior = sink.wants_prior();
        if wants_prior {
            followed.keep_prior();
        }
        if followed.filter.learns() {
            followed.condition(level, force, measured)?;
            pass(&mut followed.filter, sink)?;
            return followed.report(wants_prior, sink);
        }
        let FollowedEngine { filter, places, measured: own, prior, update: all, in_units, .. } = followed;
        let [nis, determinant] = condition(level, filter, places, own, force, measured)?;
        pass(filter, sink)?;
        let m = all.innovation.len();
        let (belief, update) = (&filter.belief, &mut filter.update);
        let sample = if update.active.len() == m {
            let [innovation, innovation_cov, gain] = update.parts();
            let unmeasured = Sample::unmeasured(&belief.mean, &belief.cov);
            Sample { innovation, innovation_cov, gain, nis, determinant, ..unmeasured }
        } else {
            all.clear();
            all.take(places, &update.active, update.parts());
            (all.nis, all.determinant) = (nis, determinant);
            all.sample(&belief.mean, &belief.cov)
        };
        push(if wants_prior { sample.with_prior(prior) } else { sample }, in_units.as_deref_mut(), sink)
    }

    fn set_belief(&mut self, mean: &[f64], cov: &[f64]) -> Result<(), FilterError> {
        let FollowedEngine { filter, in_units, .. } = &mut self.followed;
        let Some(in_units) = in_units else { return filter.set_belief(mean, cov) };
        let Belief { mean, cov } = in_units.back(mean, cov);
        filter.set_belief(mean, cov)
    }

    fn step_through(&mut self, parts: &Parts, sink: &mut dyn Sink) -> Result<(), FilterError> {
        self.followed.step_through(&self.level, parts, sink)
    }

    fn keep_passages(&mut self) -> bool {
        self.followed.filter.keep_passages();
        self.followed.filter.begin_passage();
        true
    }

    fn state(&self) -> Option<State> {
        let filter = &self.followed.filter;
        let misfits = filter.usual_misfits().to_vec();
        Some(State { belief: Gaussian::of(&filter.belief), misfits })
    }

    fn restore(&mut self, State { belief, misfits }: &State) -> Result<(), FilterError> {
        let filter = &mut self.followed.filter;
        filter.set_usual_misfits(misfits);
        filter.set_belief(belief.mean.as_slice(), belief.cov.as_slice())?;
        filter.begin_passage();
        Ok(())
    }
}

/// Adds the passage since the last one to those of a smoother's sink.
#[inline(always)]
fn pass(filter: &mut Filter<f64>, sink: &mut dyn Sink) -> Result<(), FilterError> {
    if let Some(passage) = filter.passage()
        && let Some(passages) = sink.passages()
    {
        passages.add(passage, &filter.belief)?;
        filter.begin_passage();
    }
    Ok(())
}

/// By the measurements of all sensors; `own` takes those that the model has. Returns NIS and det S, NaN without any.
#[inline(always)]
fn condition(
    level: &(impl EngineSteps + ?Sized),
    filter: &mut Filter<f64>,
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
    let result = level.update(filter, force, own);
    if !result.holds {
        return Err(filter.reason(0));
    }
    Ok(if result.measured > 0.0 { [result.nis, result.determinant] } else { [f64::NAN; 2] })
}

#[inline(always)]
fn push(sample: Sample<'_>, in_units: Option<&mut InUnits>, sink: &mut dyn Sink) -> Result<(), FilterError> {
    match in_units {
        Some(in_units) => sink.push(&in_units.convert_finite(sample).ok_or(FilterError::NotFinite)?),
        None => sink.push(&sample),
    }
    Ok(())
}

impl LearntNoise {
    fn extend<'a>(&'a mut self, sample: Sample<'a>, filter: &Filter<f64>, places: &[usize]) -> Sample<'a> {
        let Some(learnt) = filter.learnt() else { return sample };
        let noise = filter.design.adaptation.is_on().then(|| {
            let Self { process, sensors, uncertainty, .. } = &mut *self;
            process.clear();
            process.extend(filter.noise.diagonal());
            filter.design.white.into_iter().for_each(|(place, _)| process[place] = filter.white);
            for (own, &place) in places.iter().enumerate() {
                (sensors[place], uncertainty[place]) = (filter.noise.sensors[own], learnt.uncertainty[own]);
            }
        });
        let noise = noise.map(|()| AssumedNoise {
            process: &self.process,
            sensors: &self.sensors,
            uncertainty: &self.uncertainty,
            process_scale: [f64::NAN; 2],
        });
        Sample { noise, weights: &self.weights, has_widened: learnt.has_widened, ..sample }
    }
}

impl<'a> Sample<'a> {
    pub(super) fn with_prior(self, prior: &'a Belief<f64>) -> Self {
        Self { prior_mean: &prior.mean, prior_cov: &prior.cov, ..self }
    }
}

/// Widens a belief of the motion where a plant is plucked: parameters and augmentations are what they were.
///
/// ```text
/// P ← P + P₀ of displacements, velocities and hidden states, before the prediction over the time of a pluck
/// ```
///
/// The pull is an unknown force over a short time: it adds to the motion whatever was there before, about which nothing is known but its size.
#[derive(Clone, Debug, Default)]
struct Plucks {
    /// In rising order \[s\].
    times: Vec<f64>,
    /// Places in the state, and the variances that are added there.
    variances: Vec<(usize, f64)>,
}

impl Plucks {
    fn new(settings: &FilterSettings, channels: &[Channel], start: f64) -> Self {
        let mut times = mapped(&settings.plucks, &|time| time - start);
        sort_numbers(&mut times);
        let of = |(place, channel): (usize, &Channel)| {
            let moves = !channel.is_parameter() && !channel.is_augmentation();
            moves.then(|| (place, settings.initial_std[*channel].powi(2)))
        };
        let variances =
            if times.is_empty() { Vec::new() } else { channels.iter().enumerate().filter_map(of).collect() };
        Self { times, variances }
    }

    /// The places and the variances to add for a step from one time to a later one \[s\], if the plant was plucked meanwhile.
    fn between(&self, [from, to]: [f64; 2]) -> Option<impl Iterator<Item = (usize, f64)>> {
        let count = self.times.partition_point(|time| *time <= to) - self.times.partition_point(|time| *time <= from);
        let widened = move |&(place, variance): &(usize, f64)| (place, count as f64 * variance);
        (count > 0).then(|| self.variances.iter().map(widened))
    }
}
