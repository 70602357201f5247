//! A filter of the engine for one run, reporting its samples.

use kalmanscope_filters::FilterError;
use kalmanscope_filters::engine::belief::GaussianBelief;
use kalmanscope_filters::engine::columns::mirror;
use kalmanscope_filters::engine::design::Method;
use kalmanscope_filters::engine::level::{Baseline, Known, Level};
use kalmanscope_filters::engine::wrapper::Span;
use kalmanscope_filters::filter::{Gaussian, Input};
use kalmanscope_filters::gaussian_likelihood::LogSum;
use kalmanscope_filters::lists::mapped;
use kalmanscope_records::record::Parts;

use crate::FilterSettings;
use crate::run::estimator::setup::{PlantFilter, Setup, filter};
use crate::run::estimator::update::{InUnits, SensorUpdate};
use crate::run::estimator::{Estimator, State};
use crate::run::forces::{Forces, PartInputs};
use crate::run::passage::Passage;
use crate::run::sink::{AssumedNoise, Sample, Sink};

struct AtLevel<L> {
    level: L,
    followed: FollowedEngine,
}

struct FollowedEngine {
    filter: PlantFilter<f64>,
    places: Vec<usize>,
    measured: Vec<f64>,
    prior: GaussianBelief<f64>,
    update: SensorUpdate,
    part: SensorUpdate,
    in_units: Option<Box<InUnits<f64>>>,
    learnt: LearntNoise,
    sample: usize,
}

/// The noise that a filter learns, for all sensors: one that the model lacks keeps its R.
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
        let update = SensorUpdate::nothing(n, sensors);
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
            sample: 0,
        }
    }

    fn next_sample(&mut self) -> [f64; 2] {
        self.sample += 1;
        [self.sample - 1, self.sample].map(|sample| self.filter.design.dt * sample as f64)
    }

    #[inline(always)]
    fn predict(&mut self, level: impl Level, span: Span<'_, f64>) -> Result<(), FilterError> {
        // Where the force is held, its end does not count.
        if !self.filter.are_finite(span.inputs) {
            return Err(FilterError::UndefinedForce);
        }
        self.filter.predict(level, span);
        Ok(())
    }

    fn keep_prior(&mut self) {
        let Self { filter, prior, .. } = self;
        filter.square();
        prior.copy_from(&filter.belief);
        mirror(Baseline, &mut prior.cov, prior.mean.len());
    }

    fn clear(&mut self) {
        self.update.clear();
        self.learnt.weights.fill(f64::NAN);
    }

    fn add(&mut self, level: impl Level, input: Input<'_>, readings: &[f64]) -> Result<(), FilterError> {
        let Self { filter, places, measured, .. } = self;
        let [nis, determinant] = condition(level, filter, places, measured, input, readings)?;
        self.take_update([nis, determinant]);
        Ok(())
    }

    #[inline(never)]
    fn take_update(&mut self, squares: [f64; 2]) {
        let Self { filter, places, update, part, learnt, .. } = self;
        let active = &filter.update.active[..];
        part.clear();
        part.take(places, active, filter.update.parts());
        if let Some(weights) = filter.learnt().weights {
            if active.iter().any(|sensor| weights[*sensor] != 1.0) {
                part.claim(places, active, weights, &filter.noise.sensors);
            }
            for (&place, weight) in places.iter().zip(weights).filter(|(_, weight)| !weight.is_nan()) {
                learnt.weights[place] = *weight;
            }
        }
        [part.nis, part.determinant] = squares;
        update.add(part);
        if !part.nis.is_nan() {
            let logs = update.logs.get_or_insert(LogSum::ZERO);
            logs.add(part.determinant, || filter.update.ln_determinant(0));
        }
    }

    /// In the channels' units. Fails where a number overflows in them.
    fn report(&mut self, has_prior: bool, sink: &mut dyn Sink) -> Result<(), FilterError> {
        let Self { filter, places, update, prior, in_units, learnt, .. } = self;
        let sample = learnt.extend(update.sample(&filter.belief.mean, &filter.belief.cov), filter, places);
        push(if has_prior { sample.with_prior(prior) } else { sample }, in_units.as_deref_mut(), sink)
    }

    /// The belief before the update is that before the last reading.
    fn step_through(
        &mut self,
        level: impl Level,
        parts: &Parts,
        forces: &Forces,
        sink: &mut dyn Sink,
    ) -> Result<(), FilterError> {
        let mut whole = if parts.times.is_none() { self.next_sample() } else { [0.0; 2] };
        let (wants_prior, mut has_prior, mut is_passed) = (sink.wants_prior(), false, false);
        self.clear();
        for (place, PartInputs { share, ends, now, readings }) in forces.through(parts).enumerate() {
            if !ends.iter().all(|input| input.force.is_finite()) {
                return Err(FilterError::UndefinedForce);
            }
            // A step without times has its plucks in its first part.
            let times = parts.between(place).unwrap_or(whole);
            if share > 0.0 {
                self.predict(level, Span { share, inputs: ends, times })?;
                whole = [whole[1]; 2];
            }
            is_passed = readings.iter().any(|reading| !reading.is_nan());
            if is_passed && wants_prior {
                self.keep_prior();
                has_prior = true;
            }
            self.add(level, now, readings)?;
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
    fn begin(&mut self, sink: &mut dyn Sink) -> Result<(), FilterError> {
        let followed = &mut self.followed;
        if let Some(passages) = sink.passages() {
            passages.begin(&followed.filter.belief);
        }
        followed.prior.copy_from(&followed.filter.belief);
        followed.report(sink.wants_prior(), sink).map_err(|_| FilterError::TooLarge)
    }

    fn step(&mut self, force: [f64; 2], forces: &Forces, z: &[f64], sink: &mut dyn Sink) -> Result<(), FilterError> {
        let Self { level, followed } = self;
        let level = *level;
        let times = followed.next_sample();
        followed.predict(level, Span { share: 1.0, inputs: forces.over(force), times })?;
        let wants_prior = sink.wants_prior();
        if wants_prior {
            followed.keep_prior();
        }
        if followed.filter.has_options() {
            followed.clear();
            followed.add(level, forces.now(force[1]), z)?;
            pass(&mut followed.filter, sink)?;
            return followed.report(wants_prior, sink);
        }
        let FollowedEngine { filter, places, measured: own, prior, update: all, in_units, .. } = followed;
        let [nis, determinant] = condition(level, filter, places, own, forces.now(force[1]), z)?;
        pass(filter, sink)?;
        let m = all.innovation.len();
        let (belief, update) = (&filter.belief, &filter.update);
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
        let GaussianBelief { mean, cov } = in_units.back(mean, cov);
        filter.set_belief(mean, cov)
    }

    fn step_through(&mut self, parts: &Parts, forces: &Forces, sink: &mut dyn Sink) -> Result<(), FilterError> {
        self.followed.step_through(self.level, parts, forces, sink)
    }

    fn keep_passages(&mut self) -> bool {
        self.followed.filter.keep_passages();
        self.followed.filter.begin_passage();
        true
    }

    fn state(&self) -> Option<State> {
        let filter = &self.followed.filter;
        Some(State { belief: Gaussian::of(&filter.belief), memory: filter.memory() })
    }

    fn restore(&mut self, State { belief, memory }: &State) -> Result<(), FilterError> {
        let filter = &mut self.followed.filter;
        filter.restore(memory);
        filter.set_belief(belief.mean.as_slice(), belief.cov.as_slice())?;
        filter.begin_passage();
        Ok(())
    }
}

#[inline(always)]
fn pass(filter: &mut PlantFilter<f64>, sink: &mut dyn Sink) -> Result<(), FilterError> {
    if let Some(passage) = filter.passage()
        && let Some(passages) = sink.passages()
    {
        passages.all.push(Passage::new(passage)?);
        passages.begin(&filter.belief);
        filter.begin_passage();
    }
    Ok(())
}

/// By the measurements of all sensors; `own` takes those that the model has. Returns NIS and det S, NaN without any.
#[inline(always)]
fn condition(
    level: impl Level,
    filter: &mut PlantFilter<f64>,
    places: &[usize],
    own: &mut [f64],
    input: Input<'_>,
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
    let result = filter.update(level, input, own);
    if !result.holds {
        return Err(filter.reason(0));
    }
    filter.complete(level);
    Ok(if result.measured > 0.0 { [result.nis, result.determinant] } else { [f64::NAN; 2] })
}

#[inline(always)]
pub(super) fn push(
    sample: Sample<'_>,
    in_units: Option<&mut InUnits<f64>>,
    sink: &mut dyn Sink,
) -> Result<(), FilterError> {
    match in_units {
        Some(in_units) => match in_units.take(sample) {
            (sample, true) => sink.push(&sample),
            (_, false) => return Err(FilterError::NotFinite),
        },
        None => sink.push(&sample),
    }
    Ok(())
}

impl LearntNoise {
    fn extend<'a>(&'a mut self, sample: Sample<'a>, filter: &PlantFilter<f64>, places: &[usize]) -> Sample<'a> {
        let (learnt, Self { process, sensors, uncertainty, weights }) = (filter.learnt(), self);
        let noise = learnt.uncertainty.map(|learnt| {
            process.clear();
            process.extend(filter.noise.diagonal());
            filter.design.white.into_iter().for_each(|(place, _)| process[place] = filter.white);
            for (own, &place) in places.iter().enumerate() {
                (sensors[place], uncertainty[place]) = (filter.noise.sensors[own], learnt[own]);
            }
            AssumedNoise { process, sensors, uncertainty, process_scale: [f64::NAN; 2] }
        });
        Sample { noise, weights, has_widened: learnt.has_widened, ..sample }
    }
}

impl<'a> Sample<'a> {
    pub(super) fn with_prior(self, prior: &'a GaussianBelief<f64>) -> Self {
        Self { prior_mean: &prior.mean, prior_cov: &prior.cov, ..self }
    }
}
