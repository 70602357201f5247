//! The filter of a scenario, as plain numbers for a lane.

use kalmanscope_filters::engine::belief;
use kalmanscope_filters::engine::design::{Course, Design};
use kalmanscope_filters::engine::filter::GaussianFilter;
use kalmanscope_filters::engine::number::Number;
use kalmanscope_filters::engine::wrapper::{Adapting, Considering, Jumping, Restarting, Weighing, Wrapped};
use kalmanscope_filters::filter::{Algorithm, Gaussian, Noise, White};
use kalmanscope_filters::linalg::{Matrix, Vector};
use kalmanscope_filters::lists::{mapped, numbers, places, sort_numbers};
use kalmanscope_filters::{Channel, FilterKind, Hold, Quantity};
use kalmanscope_records::Record;
use kalmanscope_records::record::Delays;

use crate::plant::dynamics::EnginePlant;
use crate::run::estimator::FilterContext;
use crate::run::run_error::sensor_places;
use crate::{FilterSettings, Model, RunError, Scenario, Values};

pub(crate) type PlantFilter<T> = Wrapped<T, EnginePlant>;

/// Limits the components of filters side by side: beyond ten masses, eight lanes of a matrix leave the caches.
pub(crate) const MOST: usize = 32;

/// A filter of a scenario before its first sample.
#[derive(Clone, Debug)]
pub struct Setup {
    /// The part that is the same for all runs of a batch.
    pub design: Design<EnginePlant>,
    /// The components of the state.
    pub channels: Vec<Channel>,
    /// The initial mean.
    pub mean: Vec<f64>,
    /// The initial variances.
    pub variance: Vec<f64>,
    /// The diagonal of Q.
    pub process: Vec<f64>,
    /// Q, n × n, where it is not diagonal; else empty.
    pub matrix: Vec<f64>,
    /// The diagonal of R.
    pub sensors: Vec<f64>,
    /// The fading factor λ.
    pub fading: f64,
    /// The variance of the white force.
    pub white: f64,
    /// The record's column for each sensor.
    pub columns: Vec<usize>,
    /// The delays of the input, and of each sensor by its place among the columns.
    pub delays: Delays,
    /// Whether it goes from one reading of the record to the next, at the times that they have.
    pub is_timed: bool,
    /// The time of the first sample \[s\].
    pub start: f64,
    pub(crate) settings: FilterSettings,
    pub(crate) of_batch: FilterSettings,
}

impl Setup {
    /// The filter at `place` over a record, if lanes serve it: a KF, EKF, UKF or CKF of up to [`MOST`] components, with one guess,
    /// no walk and nothing that it considers.
    ///
    /// # Errors
    /// Those of [`Pass::new`](crate::Pass::new).
    pub fn new(scenario: &Scenario, place: usize, record: &Record) -> Result<Option<Self>, RunError> {
        Self::unless(scenario, place, record, |settings, _| !settings.is_single())
    }

    /// The same for filters with a textbook's update and a diagonal Q, without logarithms, over readings at the samples' times.
    pub fn of_any(scenario: &Scenario, place: usize, record: &Record) -> Result<Option<Self>, RunError> {
        let setup = Self::unless(scenario, place, record, |settings, context| {
            let is_late = context.is_timed || settings.delays(context.dt).is_of_sensors();
            settings.log_parameters || is_late || !settings.has_plain_update()
        })?;
        Ok(setup.filter(|setup| setup.matrix.is_empty()))
    }

    fn unless(
        scenario: &Scenario,
        place: usize,
        record: &Record,
        is_left: impl Fn(&FilterSettings, &FilterContext) -> bool,
    ) -> Result<Option<Self>, RunError> {
        scenario.validate()?;
        let settings = scenario.filters.get(place).ok_or(RunError::NoFilter(place))?;
        let columns = sensor_places(scenario, record)?;
        let context = FilterContext::over(record, scenario, settings);
        // The lanes of a square-root filter differ from the run alone where variances underflow; an iterated one iterates by itself.
        let goes_alone = settings.kind == FilterKind::SR_UKF || settings.kind == FilterKind::IEKF;
        if goes_alone || is_left(settings, &context) || !is_finite(record, &columns) {
            return Ok(None);
        }
        Ok(Self::of(settings, &context, columns).filter(|setup| setup.channels.len() <= MOST))
    }

    pub(crate) fn of(settings: &FilterSettings, context: &FilterContext, columns: Vec<usize>) -> Option<Self> {
        let Algorithm::Gaussian(method) = settings.kind.info().algorithm else { return None };
        let Beginning { model: book, initial, noise, white } = Beginning::of(settings, context);
        if !(initial.is_finite() && noise.is_finite()) {
            return None;
        }
        let (model, method) = (book.state.clone(), method(&settings.method(&context.plant), book.size()));
        let late = settings.delays(context.dt);
        let sensor = |(sensor, column): (usize, usize)| {
            Some((column, book.reading(context.sensors[sensor])?, noise.sensors[sensor], late.of(sensor)))
        };
        let sensors: Vec<_> = columns.into_iter().enumerate().filter_map(sensor).collect();
        let delays = Delays::new(late.input, sensors.iter().map(|&(.., late)| late));
        let is_diagonal = white.is_none_or(|white| white.course != Course::Continuous);
        let design = Design {
            model,
            method,
            dt: context.dt,
            has_slope: context.hold == Hold::First,
            substeps: context.steps(settings),
            readings: mapped(&sensors, &|(_, reading, ..)| reading.clone()),
            white: white.map(|white| (white.place, white.course)),
        };
        Some(Self {
            design,
            channels: book.channels().to_vec(),
            mean: initial.mean.as_slice().to_vec(),
            variance: initial.cov.diagonal().as_slice().to_vec(),
            process: noise.process.diagonal().as_slice().to_vec(),
            matrix: if is_diagonal { Vec::new() } else { noise.process.as_slice().to_vec() },
            sensors: mapped(&sensors, &|&(_, _, variance, _)| variance),
            fading: noise.fading,
            white: white.map_or(0.0, |white| white.variance),
            columns: mapped(&sensors, &|&(column, ..)| column),
            delays,
            is_timed: context.is_timed,
            start: context.start,
            settings: settings.clone(),
            of_batch: settings.of_batch(),
        })
    }

    fn in_options<T: Number>(&self, mut filter: GaussianFilter<T, EnginePlant>) -> PlantFilter<T> {
        let Self { settings, channels, start, .. } = self;
        let mut plucks = mapped(&settings.plucks, &|time| time - start);
        sort_numbers(&mut plucks);
        let moves = |channel: &Channel| !channel.is_parameter() && !channel.is_augmentation();
        let motion = places(channels.len(), &|place| moves(&channels[place]));
        let of_motion = mapped(&motion, &|&place| (place, settings.initial_std[channels[place]].powi(2)));
        let considered = settings.consider.iter().filter_map(|channel| channel.place_in(channels)).collect();
        let options = [
            Weighing::of(settings.robust, &filter),
            Adapting::of(settings.adaptation, &mut filter),
            Jumping::of(settings.jump, &filter),
            Considering::of(considered, &filter),
            Restarting::of(plucks, of_motion),
        ];
        Wrapped::new(filter, options)
    }
}

fn is_finite(record: &Record, columns: &[usize]) -> bool {
    // Without an early end, several numbers are looked at at once.
    let none = |values: &[f64], is_bad: fn(f64) -> bool| !values.iter().fold(false, |any, &value| any | is_bad(value));
    record.forgotten() == 0
        && !record.is_empty()
        && none(record.input(), |input| !input.is_finite())
        && columns.iter().all(|&column| none(record.measured(column), f64::is_infinite))
}

pub(crate) fn filter<'a, T: Number>(setup: &dyn Fn(usize) -> &'a Setup) -> PlantFilter<T> {
    let numbers = |count: usize, of_setup: &dyn Fn(&Setup) -> &[f64]| -> Vec<T> {
        (0..count).map(|i| T::from_lanes(|lane| of_setup(setup(lane))[i])).collect()
    };
    let design = setup(0).design.clone();
    let (n, sensors) = (design.model.size, design.readings.len());
    let mut belief = belief::GaussianBelief { mean: numbers(n, &|setup| &setup.mean), cov: vec![T::of(0.0); n * n] };
    for (i, variance) in numbers(n, &|setup| &setup.variance).into_iter().enumerate() {
        belief.cov[i * n + i] = variance;
    }
    let noise = belief::FilterNoise {
        process: numbers(n, &|setup| &setup.process),
        matrix: numbers(setup(0).matrix.len(), &|setup| &setup.matrix),
        sensors: numbers(sensors, &|setup| &setup.sensors),
        fading: T::from_lanes(|lane| setup(lane).fading),
    };
    let white = T::from_lanes(|lane| setup(lane).white);
    setup(0).in_options(GaussianFilter::new(design, belief, noise, white))
}

pub(crate) struct Beginning {
    pub(crate) model: Model,
    pub(crate) initial: Gaussian,
    /// Q, without the row and the column of a white force; R; λ.
    pub(crate) noise: Noise,
    pub(crate) white: Option<White>,
}

impl Beginning {
    pub(crate) fn of(settings: &FilterSettings, context: &FilterContext) -> Self {
        let model = context.model(settings);
        // The unit of a logarithm is one over the initial mean: it stays the same when the estimate moves.
        let (mean, unit) = model.to_state(&numbers(model.size(), &|i| settings.initial_mean[model.channels()[i]]));
        let initial =
            Gaussian::independent(mean.clone(), &spread(&model, settings, &settings.initial_std).component_mul(&unit));
        let process = spread(&model, settings, &settings.process_std).component_mul(&unit);
        let mut process = Matrix::from_diagonal(&process.component_mul(&process));
        let white = white_force(&model, settings.process_std[Channel::WHITE_FORCE], context.hold, &context.sensors);
        if let Some(white) = white {
            add_rest(white, &model, mean.as_slice(), context.dt, &mut process);
            white.leave_out(&mut process);
        }
        let sensors = mapped(&settings.sensor_std, &|std| std * std);
        Self { model, initial, noise: Noise { process, sensors, fading: settings.fading }, white }
    }
}

fn spread(model: &Model, settings: &FilterSettings, std: &Values) -> Vector {
    let of = |&channel| if settings.knows(channel) { 0.0 } else { std[channel] };
    Vector::from_iterator(model.size(), model.channels().iter().map(of))
}

fn white_force(model: &Model, std: f64, hold: Hold, sensors: &[Quantity]) -> Option<White> {
    let place = model.place(Channel::WHITE_FORCE)?;
    let feels = |quantity: &Quantity| model.reading(*quantity).is_some_and(|reading| reading.is_of_rates());
    let course = match hold {
        Hold::Zero => Course::Held,
        Hold::First if sensors.iter().any(feels) => Course::Centred,
        Hold::First => Course::Continuous,
    };
    Some(White { place, variance: std * std, course })
}

/// Adds the effect of the force's deviation from its mean over a sample, which enters through the plant's input.
fn add_rest(white: White, model: &Model, state: &[f64], dt: f64, process: &mut Matrix) {
    if white.course != Course::Continuous {
        return;
    }
    let by_force = model.by_force(state);
    let moved = |place: usize| {
        let velocity = model.channels()[place].rate()?;
        Some((place, by_force[model.place(velocity)?]))
    };
    let moved: Vec<(usize, f64)> = (0..model.motion()).filter_map(moved).collect();
    let variance = white.variance * dt * dt * dt * dt / 12.0;
    for &(i, a) in &moved {
        for &(j, b) in &moved {
            process[(i, j)] += variance * a * b;
        }
    }
}
